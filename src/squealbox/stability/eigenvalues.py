"""Complex eigenvalues of steady sliding: the question every brake study starts with.

q = u exp(lambda t) in M q'' + C_eff q' + K_eff q = 0 gives 2n eigenvalues lambda = growth + i omega. The problem is
solved as the eigenproblem of the (2n, 2n) state matrix [[0, I], [-M^-1 K, -M^-1 C]]; time enters as exp(lambda t), so a
positive real part grows.
"""

from typing import Any

import numpy as np

from squealbox.result import COMPLETED, Outcome, Result, quantity
from squealbox.system import Linearised, System, as_system, linearise
