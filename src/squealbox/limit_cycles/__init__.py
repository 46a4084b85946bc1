"""What does the motion settle to?

Depends on: transient, stability, continuation, system, friction, schedules, result, parameters.
"""

from squealbox.limit_cycles.basins import Basin, basin, dangerous_push
from squealbox.limit_cycles.branches import Branch, branch
from squealbox.limit_cycles.cycle import Cycle
from squealbox.limit_cycles.estimates import averaged_limit, averaged_swings, describing_function
from squealbox.limit_cycles.harmonic_balance import harmonic_balance
from squealbox.limit_cycles.hopf import HopfPoint, hopf_point
from squealbox.limit_cycles.sections import lyapunov_exponents, maxima
from squealbox.limit_cycles.shooting import shooting

__all__ = [
    "Basin",
    "Branch",
    "Cycle",
    "HopfPoint",
    "averaged_limit",
    "averaged_swings",
    "basin",
    "branch",
    "dangerous_push",
    "describing_function",
    "harmonic_balance",
    "hopf_point",
    "lyapunov_exponents",
    "maxima",
    "shooting",
]
