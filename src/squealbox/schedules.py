"""What varies in time: a speed V(t), a normal force N(t), a load f(t).

A schedule is a data sheet with one plain formula ``value(t, p)`` and its rate, run by NumPy here and compiled by the
transient engine. `breaks` names the instants at which the formula has a kink, so an integrator can step onto them.
A formula, elementary by definition, and its rate take instants t [s], array in, array out. Schedules add, and multiply
by a number or an array: ``load1 * [sin, -cos] + load2 * [-sin, cos]`` is a load vector.
"""

from collections.abc import Callable, Iterable
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from squealbox.parameters import DataSheet, ParameterError, parameter
from squealbox.registers import name_of

Formula = Callable[..., Any]
MOVES = (
    "{} oscillates, so the brake moves even without vibration and has no steady sliding; the modes of one instant say "
    "nothing of its stability. forced_cycle() finds the motion it repeats, with its Floquet multipliers"
)


class Schedule(DataSheet):
    """Base of the schedules: `value`, `rate`, `breaks`, and the arithmetic of loads."""

    formula: ClassVar[Formula]
    rate_formula: ClassVar[Formula]

    def coefficients(self) -> tuple[Any, ...]:
        """The coefficients p of the formula."""
        raise self._lacks("coefficients", "a method that gives p of the formulas")

    def value(self, time: ArrayLike) -> Any:
        """The value at `time` [s]."""
        return self._of("formula", "value", time)

    def rate(self, time: ArrayLike) -> Any:
        """The time derivative at `time` [s]; at a kink, the one from the right."""
        return self._of("rate_formula", "rate", time)

    def _of(self, name: str, method: str, time: ArrayLike) -> Any:
        formula = getattr(type(self), name, None)
        if formula is None:
            raise self._lacks(name, f"a function of (t, p), or a method {method}(time)")
        return formula(np.asarray(time, dtype=float), self.coefficients())

    def _lacks(self, name: str, expectation: str) -> ParameterError:
        return ParameterError(type(self).__name__, name, None, expectation)

    def breaks(self) -> tuple[Any, ...]:
        """Instants [s] at which the formula is not smooth; arrays where parameters are."""
        return ()

    def angular_frequency(self) -> Any:
        """Highest angular frequency [rad/s] with which it swings between two breaks; 0 when it does not."""
        return 0.0

    def terms(self) -> tuple[tuple[Any, "Schedule"], ...]:
        """The schedule as a sum of factor times simple schedule."""
        return ((1.0, self),)

    def __mul__(self, factor: "ArrayLike | Schedule") -> "Sum":
        if isinstance(factor, Schedule):
            raise ParameterError(
                type(self).__name__, "factor", factor, "a number or an array: products of schedules are not compiled"
            )
        factor = np.asarray(factor, dtype=float)
        return Sum(tuple((weight * factor, part) for weight, part in self.terms()))

    __rmul__ = __mul__

    def __add__(self, other: "ArrayLike | Schedule") -> "Sum":
        return Sum((*self.terms(), *as_schedule(other).terms()))

    __radd__ = __add__

    def __neg__(self) -> "Sum":
        return self * -1.0


class Sum(Schedule):
    """A sum of factor times schedule; made by ``+`` and ``*``. The factors may be arrays: a load vector."""

    parts: tuple[tuple[Any, Schedule], ...]

    def __post_init__(self) -> None:
        parts = tuple((np.asarray(weight, dtype=float), part) for weight, part in self.parts)
        object.__setattr__(self, "parts", parts)

    def value(self, time: ArrayLike) -> Any:
        return sum(weight * part.value(time) for weight, part in self.parts)

    def rate(self, time: ArrayLike) -> Any:
        return sum(weight * part.rate(time) for weight, part in self.parts)

    def breaks(self) -> tuple[Any, ...]:
        return tuple(kinks(part for _, part in self.parts))

    def angular_frequency(self) -> Any:
        fastest = np.zeros(())
        for _, part in self.parts:
            fastest = np.maximum(fastest, part.angular_frequency())
        return fastest

    def terms(self) -> tuple[tuple[Any, Schedule], ...]:
        return self.parts


def constant(t: Any, p: Any) -> Any:
    """p = (value,)."""
    return p[0] + 0.0 * t


def constant_rate(t: Any, p: Any) -> Any:
    """0."""
    return 0.0 * t + 0.0 * p[0]


class Constant(Schedule):
    """The same value at all times.

    >>> float(Constant(0.2).value(1.0))
    0.2
    """

    level: float = parameter("", meaning="the value")

    formula = staticmethod(constant)
    rate_formula = staticmethod(constant_rate)

    def coefficients(self) -> tuple[Any, ...]:
        return (self.level,)


def ramp(t: Any, p: Any) -> Any:
    """start + slope * clip(t - begin, 0, length), p = (start, slope, begin, length)."""
    return p[0] + p[1] * np.minimum(np.maximum(t - p[2], 0.0), p[3])


def ramp_rate(t: Any, p: Any) -> Any:
    """slope between begin and begin + length, else 0."""
    return p[1] * ((t >= p[2]) & (t < p[2] + p[3]))


class Ramp(Schedule):
    """Braking: from `start` with a constant rate until `stop` (standstill) is reached, then constant.

    ``stop=None`` lets it run on through zero; so does a start at `stop` itself. A slope that leads away from `stop` is
    refused.

    >>> [round(float(x), 12) for x in Ramp(start=0.2, slope=-4.0).value([0.0, 0.02, 0.06])]
    [0.2, 0.12, 0.0]
    """

    start: float = parameter("", meaning="value before the ramp begins")
    slope: float = parameter("/s", meaning="rate of change per second; negative brakes")
    stop: float | None = parameter("", default=0.0, optional=True, meaning="value at which it stays; 0 is standstill")
    begin: float = parameter("s", default=0.0, meaning="instant at which the ramp begins")

    formula = staticmethod(ramp)
    rate_formula = staticmethod(ramp_rate)

    def coefficients(self) -> tuple[Any, ...]:
        return (self.start, self.slope, self.begin, self.length)

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.stop is not None and np.any((np.asarray(self.start) - self.stop) * self.slope > 0.0):
            expected = (
                f"a slope from start = {self.start} towards stop = {self.stop}, where it stays constant, or stop = None"
            )
            raise ParameterError("Ramp", "slope", self.slope, expected)

    @property
    def length(self) -> Any:
        """How long the ramp runs [s], as its parameters in shape; inf where it never reaches `stop`."""
        slope = np.asarray(self.slope, dtype=float)
        way = (np.nan if self.stop is None else np.asarray(self.stop, dtype=float)) - np.asarray(self.start)
        there = (way != 0.0) & (way * slope > 0.0)
        return np.where(there, way, np.inf) / np.where(there, slope, 1.0)

    def breaks(self) -> tuple[Any, ...]:
        ends = [np.asarray(end, dtype=float) for end in (self.begin, self.begin + self.length)]
        return tuple(np.where(np.isfinite(t), t, self.begin)[()] for t in ends if np.any(np.isfinite(t)))


def sinusoid(t: Any, p: Any) -> Any:
    """mean + amplitude sin(2 pi frequency t + phase), p = (mean, amplitude, frequency, phase)."""
    return p[0] + p[1] * np.sin(2.0 * np.pi * p[2] * t + p[3])


def sinusoid_rate(t: Any, p: Any) -> Any:
    """2 pi frequency amplitude cos(2 pi frequency t + phase)."""
    return 2.0 * np.pi * p[2] * p[1] * np.cos(2.0 * np.pi * p[2] * t + p[3])


class Sinusoid(Schedule):
    """Dither or run-out: a mean with a harmonic on top.

    >>> round(float(Sinusoid(mean=1.0, amplitude=0.5, frequency=50.0).value(0.005)), 12)
    1.5
    """

    mean: float = parameter("", meaning="mean value")
    amplitude: float = parameter("", meaning="amplitude of the harmonic")
    frequency: float = parameter("Hz", 0.0, meaning="frequency of the harmonic")
    phase: float = parameter("rad", default=0.0, meaning="phase at t = 0")

    formula = staticmethod(sinusoid)
    rate_formula = staticmethod(sinusoid_rate)

    def coefficients(self) -> tuple[Any, ...]:
        return (self.mean, self.amplitude, self.frequency, self.phase)

    def angular_frequency(self) -> Any:
        return 2.0 * np.pi * np.asarray(self.frequency, dtype=float)


def table(t: Any, p: Any) -> Any:
    """Straight lines through points; p = (count, times, values)."""
    count = int(p[0])
    value = p[1 + count] + 0.0 * t
    for i in range(count - 1):
        s = np.minimum(np.maximum((t - p[1 + i]) / (p[2 + i] - p[1 + i]), 0.0), 1.0)
        value = value + s * (p[2 + count + i] - p[1 + count + i])
    return value


def table_rate(t: Any, p: Any) -> Any:
    """Slope of the line the instant lies on; 0 outside."""
    count = int(p[0])
    rate = 0.0 * t
    for i in range(count - 1):
        line = (p[2 + count + i] - p[1 + count + i]) / (p[2 + i] - p[1 + i])
        rate = rate + line * ((t >= p[1 + i]) & (t < p[2 + i]))
    return rate


class Table(Schedule):
    """Measured points joined by straight lines; constant before the first and after the last.

    >>> float(Table([0.0, 1.0], [0.0, 2.0]).value(0.25))
    0.5
    """

    times: Any = parameter("s", meaning="instants of the points, increasing")
    values: Any = parameter("", meaning="value at each instant")

    formula = staticmethod(table)
    rate_formula = staticmethod(table_rate)

    def __post_init__(self) -> None:
        super().__post_init__()
        times, values = np.atleast_1d(self.times), np.atleast_1d(self.values)
        if times.ndim != 1 or times.size < 2 or np.any(np.diff(times) <= 0):
            raise ParameterError("Table", "times", self.times, "two or more increasing instants in s")
        if values.shape != times.shape:
            raise ParameterError("Table", "values", self.values, f"{times.size} values, one for each instant")

    def value(self, time: ArrayLike) -> Any:
        return np.interp(np.asarray(time, dtype=float), self.times, self.values)

    def rate(self, time: ArrayLike) -> Any:
        lines = np.r_[0.0, np.diff(self.values) / np.diff(self.times), 0.0]
        return lines[np.searchsorted(self.times, np.asarray(time, dtype=float), side="right")]

    def coefficients(self) -> tuple[Any, ...]:
        return (float(len(self.times)), *np.asarray([self.times, self.values], dtype=float).ravel().tolist())

    def breaks(self) -> tuple[float, ...]:
        return tuple(float(t) for t in self.times)


def polynomial(t: Any, p: Any) -> Any:
    """sum_k w_k x^k, x = (t - middle) pace, p = (middle, pace, w_0 ... w_7)."""
    x = (t - p[0]) * p[1]
    return p[2] + x * (p[3] + x * (p[4] + x * (p[5] + x * (p[6] + x * (p[7] + x * (p[8] + x * p[9]))))))


def polynomial_rate(t: Any, p: Any) -> Any:
    """pace sum_k k w_k x^(k - 1)."""
    x = (t - p[0]) * p[1]
    steep = 4.0 * p[6] + x * (5.0 * p[7] + x * (6.0 * p[8] + x * (7.0 * p[9])))
    return p[1] * (p[3] + x * (2.0 * p[4] + x * (3.0 * p[5] + x * steep)))


class Polynomial(Schedule):
    """A smooth course: weights[0] + weights[1] x + weights[2] x^2 ..., x = (t - middle) pace, with up to 8 weights.

    >>> float(Polynomial([1.0, 0.0, -2.0], middle=1.0, pace=0.5).value(2.0))
    0.5
    """

    weights: Any = parameter("", meaning="weights of x^0, x^1, ..., x^7; those left out are 0")
    middle: float = parameter("s", default=0.0, meaning="instant of x = 0")
    pace: float = parameter("1/s", default=1.0, meaning="x per second")

    formula = staticmethod(polynomial)
    rate_formula = staticmethod(polynomial_rate)

    def __post_init__(self) -> None:
        super().__post_init__()
        if np.ndim(self.weights) != 1 or not 1 <= np.size(self.weights) <= 8:
            raise ParameterError("Polynomial", "weights", self.weights, "one to eight numbers")

    def coefficients(self) -> tuple[Any, ...]:
        weights = np.zeros(8)
        weights[: np.size(self.weights)] = self.weights
        return (self.middle, self.pace, *(float(w) for w in weights))


SCHEDULES: tuple[type[Schedule], ...] = (Constant, Ramp, Sinusoid, Table, Polynomial)
SCHEDULE_NAMES: dict[str, type[Schedule]] = {name_of(schedule): schedule for schedule in SCHEDULES}


def as_schedule(value: Any) -> Schedule:
    """A schedule as it is; a number or array becomes `Constant`."""
    return value if isinstance(value, Schedule) else Constant(value)


def kinks(parts: Iterable[Schedule]) -> list[Any]:
    """The instants [s] at which some have a kink, in order and each once; behind them those that are arrays."""
    found = [instant for part in parts for instant in part.breaks()]
    return [*sorted({float(t) for t in found if np.ndim(t) == 0}), *(t for t in found if np.ndim(t) > 0)]


def never_settles(schedule: Schedule) -> bool:
    """True where a schedule goes on swinging for ever: a `Sinusoid`, or a sum with one; ramps and tables end.

    >>> never_settles(Sinusoid(1.0, 0.5, 50.0)), never_settles(Ramp(1.0, -1.0))
    (True, False)
    """
    for weight, part in schedule.terms():
        swings = isinstance(part, Sinusoid) and np.any(part.amplitude) and np.any(part.frequency)
        if np.any(weight) and swings:
            return True
    return False


def swinging(parts: dict[str, list[Any]]) -> list[str]:
    """Names of the values, numbers or schedules, of which one goes on swinging."""
    return [name for name, values in parts.items() if any(isinstance(v, Schedule) and never_settles(v) for v in values)]


def value_at(value: ArrayLike | Schedule, time: ArrayLike) -> Any:
    """The value of a number or a schedule at `time` [s]; array in, array out."""
    return value.value(time) if isinstance(value, Schedule) else value
