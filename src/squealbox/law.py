"""What a friction law is: the coefficient mu(|v|) of steady sliding, its slope, and what a law with memory adds.

The force of a law with memory is N grip(v, z, z'), z' = creep(v, z), z its one state; mu(|v|) is then what |grip| comes
to in steady sliding. Depends on: parameters.
"""

from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np

from squealbox.parameters import DataSheet, ParameterError

Formula = Callable[..., Any]
NEVER_STICKS = 1e-200  # static limit of a law that rises from 0: it reverses like any other, and cannot stick


class FrictionLaw(DataSheet):
    """Base of the laws: `mu`, `slope` and `coefficients`; a subclass names its two formulas.

    One rule holds for all: sliding begins with no more friction than the contact sticks with, mu(0+) <= static limit. A
    push between the two could neither hold the contact nor move it. Friction may rise with speed from there on. A law
    with memory does not stick: its state carries what a sticking contact would.
    """

    formula: ClassVar[Formula]
    slope_formula: ClassVar[Formula]
    level: ClassVar[str] = "static"  # the parameter at fault where the rule is broken
    grip_formula: ClassVar[Formula | None] = None  # of a law whose force is smooth in its speed and its memory
    creep_formula: ClassVar[Formula | None] = None  # of a law with memory

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.has_memory:
            self._check_start()

    def _check_start(self) -> None:
        limit, start = self.static_limit, self.mu(0.0)
        if np.any(start > np.asarray(limit) + 1e-12 * (1.0 + np.asarray(limit))):
            expected = f"at least mu(0) = {start}" if self.level == "static" else f"at most static = {limit}"
            expected += "; what pushes between the two could neither hold the contact nor move it"
            raise ParameterError(type(self).__name__, self.level, getattr(self, self.level, limit), expected)

    def coefficients(self) -> tuple[Any, ...]:
        """The coefficients p of the formula; p[0] is the static limit. Scalars, or arrays with leading axes."""
        raise NotImplementedError

    def mu(self, velocity: Any) -> Any:
        """Friction coefficient [-] at sliding velocity [m/s] of either sign; array in, array out."""
        return type(self).formula(self._speed(velocity), self.coefficients())

    def slope_at(self, velocity: Any) -> Any:
        """Slope dmu/d|v| [s/m] at sliding velocity [m/s] of either sign; negative means weakening."""
        return type(self).slope_formula(self._speed(velocity), self.coefficients())

    def _speed(self, velocity: Any) -> Any:
        try:
            return np.abs(velocity)
        except TypeError as error:
            raise ParameterError(type(self).__name__, "velocity", velocity, "numbers [m/s]") from error

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
