"""Friction laws: the coefficient mu(|v|) at sliding speed |v|, and its slope dmu/d|v|.

Each law is one plain formula ``law(v, p)`` and its derivative ``law_slope(v, p)`` of the speed v >= 0 and the law's
coefficients p. The same functions serve NumPy arrays here and are compiled by the transient engine, so they use only
arithmetic and NumPy functions. By convention p[0] is the static limit, the coefficient a sticking contact can reach.
"""

import inspect
import re
from typing import Any

import numpy as np

from squealbox.averages import WIDTHS, in_text, mean_over_phase, summed
from squealbox.bristles import Dahl, ElastoPlastic, LuGre
from squealbox.law import NEVER_STICKS, FrictionLaw
from squealbox.parameters import ParameterError, parameter


def _limit(static: Any, beyond: Any) -> Any:
    """The static limit; of a law that rises from 0 the one that is not mistaken for no friction at all."""
    if isinstance(static, float) and isinstance(beyond, float):  # a tenth of the time, where laws are asked most
        return NEVER_STICKS if static == 0.0 < beyond else static
    rises = (np.asarray(static) == 0.0) & (np.asarray(beyond) > 0.0)
    return np.where(rises, NEVER_STICKS, static)[()] if np.any(rises) else static


def coulomb(v: Any, p: Any) -> Any:
    """mu = kinetic, p = (static, kinetic)."""
    return p[1] + 0.0 * v


def coulomb_slope(v: Any, p: Any) -> Any:
    """dmu/dv = 0."""
    return 0.0 * v + 0.0 * p[1]


class Coulomb(FrictionLaw):
    """Constant friction while sliding, mu = kinetic, by default that of sticking, static, which may be higher.

    >>> float(Coulomb(0.4, 0.25).mu(1.0))
    0.25
    """

    static: float = parameter("-", 0.0, 10.0, meaning="static limit; kinetic when that is left out")
    kinetic: float | None = parameter("-", 0.0, 10.0, default=None, optional=True, meaning="coefficient while sliding")

    level = "kinetic"
    formula = staticmethod(coulomb)
    slope_formula = staticmethod(coulomb_slope)

    def coefficients(self) -> tuple[Any, ...]:
        return (self.static, self.static if self.kinetic is None else self.kinetic)


def linear_slope(v: Any, p: Any) -> Any:
    """mu = max(static + slope v, floor), p = (static, slope, floor)."""
    return np.maximum(p[0] + p[1] * v, p[2])


def linear_slope_slope(v: Any, p: Any) -> Any:
    """dmu/dv = slope above the floor, 0 on it."""
    return p[1] * (p[0] + p[1] * v > p[2])


class LinearSlope(FrictionLaw):
    """mu = static + slope |v|, clipped at `floor` when one is given.

    Source: Eq. (2) of the drum-brake paper of 2011 (Journal of Vibroengineering 13(2), paper 632) with slope = -alpha.
    Without a floor the coefficient turns negative beyond |v| = -static/slope: the formula as printed.

    >>> float(LinearSlope(0.45, -0.05).mu(1.0))
    0.4
    """

    static: float = parameter("-", 0.0, 10.0, meaning="coefficient at zero sliding speed")
    slope: float = parameter("s/m", meaning="dmu/d|v|; negative = weakening with speed")
    floor: float | None = parameter("-", 0.0, 10.0, default=None, optional=True, meaning="least coefficient, if any")

    level = "floor"
    formula = staticmethod(linear_slope)
    slope_formula = staticmethod(linear_slope_slope)

    def coefficients(self) -> tuple[Any, ...]:
        return (_limit(self.static, self.slope), self.slope, -np.inf if self.floor is None else self.floor)


def stribeck(v: Any, p: Any) -> Any:
    """mu = kinetic + (static - kinetic) exp(-v/speed), p = (static, kinetic, speed)."""
    return p[1] + (p[0] - p[1]) * np.exp(-v / p[2])


def stribeck_slope(v: Any, p: Any) -> Any:
    """dmu/dv = -(static - kinetic)/speed exp(-v/speed)."""
    return -(p[0] - p[1]) / p[2] * np.exp(-v / p[2])


class Stribeck(FrictionLaw):
    """Exponential decay from static to kinetic over the Stribeck speed.

    mu = kinetic + (static - kinetic) exp(-|v|/speed).

    >>> round(float(Stribeck(0.5, 0.3, 0.1).mu(0.1)), 6)
    0.373576
    """

    static: float = parameter("-", 0.0, 10.0, meaning="coefficient at zero sliding speed")
    kinetic: float = parameter("-", 0.0, 10.0, meaning="coefficient at high sliding speed")
    speed: float = parameter("m/s", 0.0, low_open=True, meaning="Stribeck speed, over which friction falls by 1/e")

    formula = staticmethod(stribeck)
    slope_formula = staticmethod(stribeck_slope)

    def coefficients(self) -> tuple[Any, ...]:
        return (_limit(self.static, self.kinetic), self.kinetic, self.speed)


def hyperbolic(v: Any, p: Any) -> Any:
    """mu = static/(1 + delta v), p = (static, delta)."""
    return p[0] / (1.0 + p[1] * v)


def hyperbolic_slope(v: Any, p: Any) -> Any:
    """dmu/dv = -static delta/(1 + delta v)^2."""
    return -p[0] * p[1] / ((1.0 + p[1] * v) * (1.0 + p[1] * v))


class Hyperbolic(FrictionLaw):
    """mu = static/(1 + delta |v|). Source: Leine and others 1998, Nonlinear Dynamics 16, 41-54.

    >>> float(Hyperbolic(1.0, 3.0).mu(1.0))
    0.25
    """

    static: float = parameter("-", 0.0, 10.0, meaning="coefficient at zero sliding speed")
    delta: float = parameter("s/m", 0.0, meaning="decay of friction with speed")

    formula = staticmethod(hyperbolic)
    slope_formula = staticmethod(hyperbolic_slope)

    def coefficients(self) -> tuple[Any, ...]:
        return (self.static, self.delta)


def cubic(v: Any, p: Any) -> Any:
    """mu = static - 3/2 (static - least) (r - r^3/3), r = v/speed, p = (static, least, speed)."""
    r = v / p[2]
    return p[0] - 1.5 * (p[0] - p[1]) * (r - r * r * r / 3.0)


def cubic_slope(v: Any, p: Any) -> Any:
    """dmu/dv = -3/2 (static - least) (1 - r^2)/speed."""
    r = v / p[2]
    return -1.5 * (p[0] - p[1]) * (1.0 - r * r) / p[2]


class Cubic(FrictionLaw):
    """Cubic curve with its least value at `speed`; friction rises again beyond it.

    mu = static - 3/2 (static - kinetic) (r - r^3/3) with r = |v|/speed, so mu(speed) = kinetic, above static a maximum.
    Source: Thomsen and Fidlin 2003, International Journal of Non-Linear Mechanics 38, 389-403, Eq. (2).

    >>> round(float(Cubic(0.4, 0.25, 0.5).mu(0.5)), 12)
    0.25
    """

    static: float = parameter("-", 0.0, 10.0, meaning="coefficient at zero sliding speed")
    kinetic: float = parameter("-", 0.0, 10.0, meaning="least coefficient, at `speed`; greatest where above static")
    speed: float = parameter("m/s", 0.0, low_open=True, meaning="sliding speed of least friction")

    formula = staticmethod(cubic)
    slope_formula = staticmethod(cubic_slope)

    def coefficients(self) -> tuple[Any, ...]:
        return (_limit(self.static, self.kinetic), self.kinetic, self.speed)


def table(v: Any, p: Any) -> Any:
    """Monotone cubic through points, a clipped sum over intervals; p = (mu at v=0, count, speeds, values, slopes)."""
    count = int(p[1])
    mu = p[2 + count] + 0.0 * v
    for i in range(count - 1):
        width = p[3 + i] - p[2 + i]
        rise = p[3 + count + i] - p[2 + count + i]
        left = width * p[2 + 2 * count + i]
        right = width * p[3 + 2 * count + i]
        s = np.minimum(np.maximum((v - p[2 + i]) / width, 0.0), 1.0)
        mu = mu + s * (left + s * (3.0 * rise - 2.0 * left - right + s * (left + right - 2.0 * rise)))
    return mu


def table_slope(v: Any, p: Any) -> Any:
    """Derivative of the monotone cubic; 0 outside the measured range."""
    count = int(p[1])
    slope = 0.0 * v
    for i in range(count - 1):
        width = p[3 + i] - p[2 + i]
        rise = p[3 + count + i] - p[2 + count + i]
        left = width * p[2 + 2 * count + i]
        right = width * p[3 + 2 * count + i]
        s = (v - p[2 + i]) / width
        inside = (left + s * (2.0 * (3.0 * rise - 2.0 * left - right) + s * 3.0 * (left + right - 2.0 * rise))) / width
        slope = slope + inside * ((s >= 0.0) & (s < 1.0))
    return slope


class Table(FrictionLaw):
    """Measured points, joined by the monotone cubic of Fritsch and Carlson; constant beyond the first and last point.

    Slopes at the points are those of `scipy.interpolate.PchipInterpolator`: no overshoot is invented between them.

    >>> float(Table([0.0, 1.0, 2.0], [0.5, 0.4, 0.3]).mu(1.0))
    0.4
    """

    speeds: Any = parameter("m/s", 0.0, meaning="sliding speeds of the measured points, increasing")
    values: Any = parameter("-", 0.0, 10.0, meaning="measured coefficients, one for each speed")

    formula = staticmethod(table)
    slope_formula = staticmethod(table_slope)

    def _check_start(self) -> None:
        speeds, values = np.atleast_1d(self.speeds), np.atleast_1d(self.values)
        if speeds.ndim != 1 or speeds.size < 2 or np.any(np.diff(speeds) <= 0):
            raise ParameterError("Table", "speeds", self.speeds, "two or more increasing speeds in m/s")
        if values.shape != speeds.shape:
            raise ParameterError("Table", "values", self.values, f"{speeds.size} coefficients, one for each speed")

    def coefficients(self) -> tuple[Any, ...]:
        from scipy.interpolate import PchipInterpolator

        slopes = PchipInterpolator(self.speeds, self.values).derivative()(self.speeds)
        start = _limit(float(self.values[0]), np.max(self.values))
        return tuple(float(x) for x in (start, len(slopes), *self.speeds, *self.values, *slopes))


LAWS: tuple[type[FrictionLaw], ...] = (
    Coulomb, LinearSlope, Stribeck, Hyperbolic, Cubic, Table, LuGre, Dahl, ElastoPlastic,
)  # fmt: skip


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

    def mu(self, velocity: Any) -> Any:
        base = self.law.mu(0.0)
        v, w, _ = np.broadcast_arrays(np.abs(velocity), self.velocity, base)
        return base * 2.0 / np.pi * np.arcsin(np.minimum(v / w, 1.0)) + self._rest(v, w, base, slope=False)

    def slope_at(self, velocity: Any) -> Any:
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

    def _rest(self, v: Any, w: Any, base: Any, slope: bool) -> Any:
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


def _slow_dither(law: Any, v: Any, w: Any, slope: bool) -> Any:
    """E[h] or E[h'] where the sliding never reverses, w <= v."""
    if isinstance(law, Stribeck):
        from scipy.special import ive

        fall = (law.static - law.kinetic) * np.exp((w - v) / law.speed) * ive(0, w / law.speed)
        return -fall / law.speed if slope else fall - (law.static - law.kinetic)
    one = 1.0 + law.delta * v
    root = np.sqrt(one * one - (law.delta * w) ** 2)
    return -law.static * law.delta * one / root**3 if slope else law.static * (1.0 / root - 1.0)


def _mean_over_phase(law: FrictionLaw, v: Any, w: Any, base: Any, slope: bool) -> Any:
    def at(u: Any) -> Any:
        values = _spread(law, np.abs(u), slope)
        return values if slope else (values - np.asarray(base)[..., None, None]) * np.sign(u)

    return mean_over_phase(at, v, w, _kinks(law))


def _spread(law: FrictionLaw, u: Any, slope: bool) -> Any:
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
