"""Laws that are one formula of the sliding speed each. Depends on: law, parameters."""

from typing import Any

import numpy as np

from squealbox.law import NEVER_STICKS, FrictionLaw
from squealbox.parameters import ParameterError, parameter


def _limit(static: float | np.ndarray, beyond: float | np.ndarray) -> Any:
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

    @classmethod
    def guess(cls, speeds: np.ndarray, values: np.ndarray) -> dict[str, float]:
        return {"static": float(np.mean(values))}

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

    mu = kinetic + (static - kinetic) exp(-|v|/speed). Source: Bo and Pavelescu 1982, Wear 82, 277-289.

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

    @classmethod
    def guess(cls, speeds: np.ndarray, values: np.ndarray) -> dict[str, float]:
        return {**super().guess(speeds, values), "speed": float(np.max(speeds))}

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
