"""A law as slow motion meets it under fast dither. Depends on: averages, law, parameters, and the formulas beside."""

import inspect
import re
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.averages import WIDTHS, in_text, mean_over_phase, summed
from squealbox.friction.curves import Coulomb, Cubic, Hyperbolic, LinearSlope, Stribeck, Table
from squealbox.law import NEVER_STICKS, FrictionLaw
from squealbox.parameters import ParameterError, parameter


class Averaged(FrictionLaw):
    """A law as slow motion meets it under fast dither: mean over a period of mu(|u|) sgn(u), u = v + w sin(phase).

    With w = `velocity`, mu0 = mu(0+), h(u) = (mu(|u|) - mu0) sgn(u): mu0 (2/pi) asin(min(v/w, 1)) + E[h(v + w sin)],
    in closed form for `Coulomb`, `LinearSlope` without a floor and `Cubic`, below the sliding speed (w <= v) for
    `Stribeck` (the fall times I0(w/speed)) and `Hyperbolic`; by Gauss-Legendre in the phase, graded towards the
    reversal, for all others. It does not stick; its slope is infinite at v = w. Source: Fidlin 1999.

    >>> round(float(Averaged(Coulomb(0.4), 1.0).mu(0.5)), 12)
    0.133333333333
    """

    law: FrictionLaw
    velocity: float = parameter("m/s", 0.0, low_open=True, meaning="amplitude of the dither's velocity")

    def __post_init__(self) -> None:
        if not isinstance(self.law, FrictionLaw):
            raise ParameterError("Averaged", "law", self.law, "a friction law")
        if self.law.has_memory:
            raise ParameterError(
                "Averaged", "law", self.law, "a law of the speed alone: one with memory is not averaged"
            )
        _ = self.texts  # says what is no formula
        super().__post_init__()

    def coefficients(self) -> tuple[Any, ...]:
        """No static limit, the dither's velocity; mu0, a1, a3 of mu0 (2/pi) asin(v/w) + a1 v + a3 v^3, or of a sum."""
        lead = np.broadcast_shapes(np.shape(self.velocity), *(np.shape(c) for c in self.law.coefficients()))
        more = self._polynomial() or (*in_text(self._edges()), *self.law.coefficients())
        return (np.full(lead, NEVER_STICKS)[()], self.velocity, *more)

    def mu(self, velocity: float | np.ndarray) -> Any:
        base = self.law.mu(0.0)
        v, w, _ = np.broadcast_arrays(np.abs(velocity), self.velocity, base)
        return base * 2.0 / np.pi * np.arcsin(np.minimum(v / w, 1.0)) + self._rest(v, w, base, slope=False)

    def slope_at(self, velocity: float | np.ndarray) -> Any:
        base = self.law.mu(0.0)
        v, w, _ = np.broadcast_arrays(np.abs(velocity), self.velocity, base)
        with np.errstate(divide="ignore"):
            turning = np.where(v <= w, 2.0 / np.pi / np.sqrt(np.maximum(w * w - v * v, 0.0)), 0.0)
        return base * turning + self._rest(v, w, base, slope=True)

    @property
    def texts(self) -> tuple[str, str] | None:
        """Sources of law and slope for the compiled engines; None for a law that is not a formula itself.

        In closed form where that is a polynomial; else a sum over the phase, to 1e-11 for a law that varies over at
        least a thousandth of the dither's velocity.
        """
        if self._polynomial() is not None:
            return _AVERAGED_MU, _AVERAGED_SLOPE
        own: tuple[str, str] | None = getattr(self.law, "texts", None)
        if own is None and not hasattr(type(self.law), "formula"):
            return None
        known = {1: len(self.law.speeds)} if isinstance(self.law, Table) else {}
        text = inspect.getsource(type(self.law).formula) if own is None else own[0]
        try:
            return summed(re.sub(r": Any| -> Any", "", text), len(self._edges()), known)
        except ValueError as error:
            raise ParameterError("Averaged", "law", type(self.law).__name__, f"a formula: {error}") from error

    def _edges(self) -> list[Any]:
        """Speeds [m/s], from 0, between which the law is smooth, or ever wider parts of the dither's velocity."""
        w, kinks = np.asarray(self.velocity, dtype=float), _kinks(self.law)
        kinks = [np.where(np.asarray(kink) > 0.0, kink, w)[()] for kink in kinks]
        return [0.0, *kinks] if kinks else [(share * w)[()] for share in WIDTHS]

    def _polynomial(self) -> tuple[Any, Any, Any] | None:
        """mu0, a1, a3 of the laws whose h is a cubic polynomial."""
        law, w = self.law, self.velocity
        if isinstance(law, Coulomb):
            return law.mu(0.0), 0.0, 0.0
        if isinstance(law, LinearSlope) and law.floor is None:
            return law.static, law.slope, 0.0
        if isinstance(law, Cubic):
            fall = 1.5 * (law.static - law.kinetic) / law.speed
            third = fall / (3.0 * law.speed * law.speed)
            return law.static, -fall + 1.5 * third * w * w, third
        return None

    def _rest(self, v: np.ndarray, w: np.ndarray, base: float | np.ndarray, slope: bool) -> Any:
        """E[h(v + w sin)], or its derivative by v, E[h']."""
        cubic_part = self._polynomial()
        if cubic_part is not None:
            _, a1, a3 = cubic_part
            return a1 + 3.0 * a3 * v * v if slope else v * (a1 + a3 * v * v)
        if not np.any(w > v) and isinstance(self.law, (Stribeck, Hyperbolic)):
            return _slow_dither(self.law, v, w, slope)
        return _mean_over_phase(self.law, v, w, base, slope)


def averaged(law: FrictionLaw, velocity: Any) -> FrictionLaw:
    """The law that slow motion meets when dither moves the contact with `velocity` [m/s]; the law itself for 0.

    >>> round(float(averaged(Stribeck(0.4, 0.25, 0.3), 0.4).mu(0.5)), 9)
    0.29239317
    """
    return law if np.ndim(velocity) == 0 and velocity == 0.0 else Averaged(law, velocity)


_AVERAGED_MU = """def mu(v, p):
    r = np.minimum(v / p[1], 1.0)
    turned = np.arctan(r / (1.0 + np.sqrt(np.maximum(1.0 - r * r, 0.0))))
    return p[2] * turned * 1.2732395447351628 + v * (p[3] + p[4] * v * v)
"""
_AVERAGED_SLOPE = """def slope(v, p):
    inside = np.sqrt(np.maximum(p[1] * p[1] - v * v, 1e-24 * p[1] * p[1]))
    return p[2] * 0.6366197723675814 / inside * (v < p[1]) + p[3] + 3.0 * p[4] * v * v
"""


def _slow_dither(law: Stribeck | Hyperbolic, v: np.ndarray, w: np.ndarray, slope: bool) -> Any:
    """E[h] or E[h'] where the sliding never reverses, w <= v."""
    if isinstance(law, Stribeck):
        from scipy.special import ive

        fall = (law.static - law.kinetic) * np.exp((w - v) / law.speed) * ive(0, w / law.speed)
        return -fall / law.speed if slope else fall - (law.static - law.kinetic)
    one = 1.0 + law.delta * v
    root = np.sqrt(one * one - (law.delta * w) ** 2)
    return -law.static * law.delta * one / root**3 if slope else law.static * (1.0 / root - 1.0)


def _mean_over_phase(law: FrictionLaw, v: np.ndarray, w: np.ndarray, base: ArrayLike, slope: bool) -> Any:
    def at(u: np.ndarray) -> Any:
        values = _spread(law, np.abs(u), slope)
        return values if slope else (values - np.asarray(base)[..., None, None]) * np.sign(u)

    return mean_over_phase(at, v, w, _kinks(law))


def _spread(law: FrictionLaw, u: np.ndarray, slope: bool) -> Any:
    """mu or its slope at speeds (..., pieces, nodes), the coefficients' leading axes in front."""
    if not hasattr(type(law), "formula"):
        return law.slope_at(u) if slope else law.mu(u)
    p = tuple(c[..., None, None] if np.ndim(c) else c for c in law.coefficients())
    return (type(law).slope_formula if slope else type(law).formula)(u, p)


def _kinks(law: FrictionLaw) -> list[Any]:
    """Speeds at which the law is not smooth."""
    if isinstance(law, Table):
        return [float(speed) for speed in law.speeds if speed > 0.0]
    if isinstance(law, LinearSlope) and law.floor is not None:
        with np.errstate(divide="ignore", invalid="ignore"):
            reached = (np.asarray(law.floor) - law.static) / np.asarray(law.slope)
        return [np.where(np.isfinite(reached) & (reached > 0.0), reached, 0.0)]
    return []
