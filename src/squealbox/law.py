"""What a friction law is: the coefficient mu(|v|) of steady sliding, its slope, and what a law with memory adds.

The force of a law with memory is N grip(v, z, z'), z' = creep(v, z), z its one state; mu(|v|) is then what |grip| comes
to in steady sliding. Depends on: parameters.
"""

from collections.abc import Callable
from typing import Any, ClassVar, Self

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

    @classmethod
    def kind(cls) -> str:
        """The name a file knows it by: all laws of the house are of `friction`, whichever module defines them."""
        place = super().kind()
        return f"friction.{cls.__name__}" if place.startswith(("friction.", "bristles.")) else place

    @classmethod
    def required(cls) -> tuple[str, ...]:
        """The names of the numbers that are not left out."""
        return tuple(name for name in cls.parameters() if not hasattr(cls, name))

    @classmethod
    def like(cls, law: "FrictionLaw", speed: float) -> Self | None:
        """The law of this kind that continues `law`: same static limit, and near `speed` [m/s] about the same fall.

        By the names of its numbers; None for a law with others, whose kind then cannot be chosen in place of another.

        >>> from squealbox import Hyperbolic, LinearSlope
        >>> Hyperbolic.like(LinearSlope(0.4, -0.05), 0.2)
        Hyperbolic(static=0.4, delta=0.125)
        """
        static, speed = float(law.static_limit), abs(speed) or 1.0
        slope = float(law.slope_at(speed))
        known = {"static": static, "kinetic": min(max(float(law.mu(speed)), 0.0), static), "speed": speed,
                 "slope": slope, "delta": max(-slope, 0.0) / static if static else 0.0,
                 "stiffness": float(getattr(law, "stiffness", 1e5))}  # fmt: skip
        if not set(cls.required()) <= set(known):
            return None
        least = {name: 1e-3 if about.low_open and about.unit == "-" else -np.inf  # bristles need friction to bend
                 for name, about in cls.parameters().items() if name in known}  # fmt: skip
        return cls(**{name: max(known[name], low) for name, low in least.items()})

    @classmethod
    def guess(cls, speeds: np.ndarray, values: np.ndarray) -> dict[str, float]:
        """Where a fit to measured points (speeds [m/s], coefficients) begins, by name of each number that is fitted.

        By the names of its numbers; empty for a law with others, which is then not fitted.
        """
        fall = {"static": float(np.max(values)), "kinetic": float(np.min(values)), "speed": float(np.ptp(speeds)) / 3.0,
                "slope": 0.0, "delta": 1.0 / float(np.max(speeds))}  # fmt: skip
        return {name: fall[name] for name in cls.required()} if set(cls.required()) <= set(fall) else {}

    def coefficients(self) -> tuple[Any, ...]:
        """The coefficients p of the formula; p[0] is the static limit. Scalars, or arrays with leading axes."""
        raise NotImplementedError

    def mu(self, velocity: float | np.ndarray) -> Any:
        """Friction coefficient [-] at sliding velocity [m/s] of either sign; array in, array out."""
        return type(self).formula(self._speed(velocity), self.coefficients())

    def slope_at(self, velocity: float | np.ndarray) -> Any:
        """Slope dmu/d|v| [s/m] at sliding velocity [m/s] of either sign; negative means weakening."""
        return type(self).slope_formula(self._speed(velocity), self.coefficients())

    def _speed(self, velocity: float | np.ndarray) -> Any:
        try:
            return np.abs(velocity)
        except TypeError as error:
            raise ParameterError(type(self).__name__, "velocity", velocity, "numbers [m/s]") from error

    def direct_slope(self, velocity: float | np.ndarray) -> Any:
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
