"""Laws whose force is a smooth function of speed and memory: no event, no stick; their numbers in the compiled code.

A kink of such a law ends a Taylor step and is left to the error control of the others. Depends on: friction, limited.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.bristles import Dahl, ElastoPlastic, LuGre
from squealbox.law import FrictionLaw
from squealbox.parameters import parameter
from squealbox.system import Contact


def saturation_grip(v: Any, z: Any, rate: Any, p: Any) -> Any:
    """sat(v) at -limit and limit."""
    return np.minimum(np.maximum(v, -p[1]), p[1])


class Saturation(FrictionLaw):
    """sat(v): the force of a loop as a law with N = 1 N, where v is what the loop commands.

    >>> [float(Saturation(2.0).mu(v)) for v in (1.0, 10.0)]
    [1.0, 2.0]
    """

    limit: float = parameter("-", 0.0, low_open=True, meaning="largest value")

    grip_formula = staticmethod(saturation_grip)

    def coefficients(self) -> tuple[Any, ...]:
        return (0.0, self.limit)

    def mu(self, velocity: ArrayLike) -> Any:
        return np.minimum(np.abs(velocity), self.limit)

    def slope_at(self, velocity: ArrayLike) -> Any:
        return 1.0 * (np.abs(velocity) < self.limit)

    @property
    def texts(self) -> tuple[str, str]:
        """The source of the law and its slope, for the compiled engines."""
        mu = "def mu(v, p):\n    return np.minimum(v, p[1])\n"
        return mu, "def slope(v, p):\n    return 1.0 * (v < p[1])\n"


SMOOTH: tuple[type[FrictionLaw], ...] = (LuGre, Dahl, ElastoPlastic, Saturation)


def smooth_kinds(contacts: Sequence[Contact]) -> tuple[int, ...]:
    """0 for a contact that sticks and slips, else one more than the place of its law in `SMOOTH`."""
    return tuple(1 + SMOOTH.index(type(c.law)) if type(c.law) in SMOOTH else 0 for c in contacts)
