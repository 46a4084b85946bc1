"""What a friction law is: the coefficient mu(|v|) of steady sliding, its slope, and what a law with memory adds.

The force of a law with memory is N grip(v, z, z'), z' = creep(v, z), z its one state; mu(|v|) is then what |grip| comes
to in steady sliding. Depends on: parameters.
"""

from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np

from squealbox.parameters import DataSheet

Formula = Callable[..., Any]
NEVER_STICKS = 1e-200  # static limit of a law that rises from 0: it reverses like any other, and cannot stick


class FrictionLaw(DataSheet):
    """Base of the laws: `mu`, `slope` and `coefficients`; a subclass names its two formulas."""

    formula: ClassVar[Formula]
    slope_formula: ClassVar[Formula]
    grip_formula: ClassVar[Formula | None] = None  # of a law whose force is smooth in its speed and its memory
    creep_formula: ClassVar[Formula | None] = None  # of a law with memory

    def coefficients(self) -> tuple[Any, ...]:
        """The coefficients p of the formula; p[0] is the static limit. Scalars, or arrays with leading axes."""
        raise NotImplementedError

    def mu(self, velocity: Any) -> Any:
        """Friction coefficient [-] at sliding velocity [m/s] of either sign; array in, array out."""
        return type(self).formula(np.abs(velocity), self.coefficients())

    def slope_at(self, velocity: Any) -> Any:
        """Slope dmu/d|v| [s/m] at sliding velocity [m/s] of either sign; negative means weakening."""
        return type(self).slope_formula(np.abs(velocity), self.coefficients())

    def direct_slope(self, velocity: Any) -> Any:
        """What the force follows the speed with at once [s/m]; all of the slope where there is no memory."""
        return self.slope_at(velocity)

    @property
    def has_memory(self) -> bool:
        """Whether friction depends on a state of the contact, z' = creep(v, z), beside its speed."""
        return type(self).creep_formula is not None

    @property
    def static_limit(self) -> Any:
        """The largest |friction force| / normal force a sticking contact can carry [-]."""
        return self.coefficients()[0]
