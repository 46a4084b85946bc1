"""Truncated Taylor series whose coefficients are `Lanes`: a formula run once on them writes its recurrences.

A series gives its coefficient k when it is asked for, and keeps it. So an equation of motion can be written down before
its solution is known: coefficient k of the acceleration asks for no more than coefficient k of the velocity, of which
it is the next one. The recurrences are those of Moore, Methods and Applications of Interval Analysis (1979), chapter 3;
a coefficient that is zero in every lane is None and costs nothing.
"""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from typing import Any

from squealbox import compiled as vectors
from squealbox.compiled import Group, Lanes, Truth, Wider, fused, spread

LEFT = 1e-15  # of the sizes of what is compared, by which a choice is left
AHEAD = 1e-9  # by which a choice looks ahead in time, in units of the series: an instant may lie on a kink
DECISIONS: ContextVar[list[Any]] = ContextVar("differences whose sign chose a branch")


class Series(Wider):
    """The series of `known` coefficients, then of those that `rule` gives; `clock` if it depends on time alone."""

    __array_ufunc__ = None
    __slots__ = ("clock", "known", "rule")

    def __init__(self, rule: Callable[[int], Any], known: tuple[Any, ...] = (), clock: bool = False) -> None:
        self.rule, self.known, self.clock = rule, list(known), clock

    def __getitem__(self, k: int) -> Any:
        while len(self.known) <= k:
            self.known.append(self.rule(len(self.known)))
        return self.known[k]

    def __add__(self, other: Any) -> "Series":
        if isinstance(other, Multiple):
            return Series(lambda k: plus_product(self[k], other.base[k], other.factor), clock=steady(self, other))
        return Series(lambda k: plus(self[k], at(other, k)), clock=steady(self, other))

    __radd__ = __add__

    def __sub__(self, other: Any) -> "Series":
        return self + -other

    def __rsub__(self, other: Any) -> "Series":
        return -self + other

    def __neg__(self) -> "Series":
        return Series(lambda k: None if self[k] is None else -self[k], clock=self.clock)

    def __mul__(self, other: Any) -> "Series":
        if isinstance(other, Truth):
            return where(other, self, 0.0)
        if isinstance(other, Series):
            return Series(lambda k: convolution(self, other, k), clock=steady(self, other))
        return Multiple(self, other)

    __rmul__ = __mul__

    def __truediv__(self, other: Any) -> "Series":
        return quotient(self, other) if isinstance(other, Series) else self * (1.0 / other)

    def __rtruediv__(self, other: Any) -> "Series":
        return quotient(other, self)

    def __pow__(self, exponent: int) -> Any:
        return Lanes.__pow__(self, exponent)  # type: ignore[operator]

    def __abs__(self) -> "Series":
        return where(self < 0.0, -self, self)

    def __gt__(self, other: Any) -> Truth:
        return above(self, other)

    def __lt__(self, other: Any) -> Truth:
        return above(other, self)

    def __ge__(self, other: Any) -> Truth:
        return ~above(other, self)

    def __le__(self, other: Any) -> Truth:
        return ~above(self, other)

    def __eq__(self, other: Any) -> Any:
        return NotImplemented

    __hash__ = None  # type: ignore[assignment]


class Multiple(Series):
    """A series times a factor, which is multiplied and added at once where it is part of a sum."""

    __slots__ = ("base", "factor")

    def __init__(self, base: Series, factor: Any) -> None:
        super().__init__(lambda k: times(base[k], factor), clock=base.clock)
        self.base, self.factor = base, factor

    def __add__(self, other: Any) -> Series:
        if isinstance(other, Multiple):
            return super().__add__(other)
        return Series(lambda k: plus_product(at(other, k), self.base[k], self.factor), clock=steady(self, other))

    __radd__ = __add__

    def __neg__(self) -> Series:
        return Multiple(self.base, -self.factor)


@contextmanager
def deciding() -> Iterator[list[Any]]:
    """The differences whose signs chose a branch meanwhile; the choice holds until one of them vanishes."""
    token = DECISIONS.set([])
    try:
        yield DECISIONS.get()
    finally:
        DECISIONS.reset(token)


def above(a: Any, b: Any) -> Truth:
    """Whether a begins above b; where time alone tells, it is looked at a little later, for pieces begin on a kink.

    The choice is left by some units of the last place only: a brake may slide on a kink.
    """
    difference = a - b
    if difference.clock:
        return plus(difference[0], times(difference[1], AHEAD)) > 0.0
    here = difference[0] > 0.0
    size: Any = plus(*(None if at(x, 0) is None else abs(at(x, 0)) for x in (a, b)))
    DECISIONS.get().append(difference if size is None else difference + where(here, LEFT * size, -LEFT * size))
    return here


def stored(group: Group, place: int, apart: int, count: int) -> Series:
    """The series of so many coefficients in memory, one double of each, spread over all lanes."""
    return Series(lambda k: None, tuple(spread(group, place + k * apart) for k in range(count)))


def time_series(start: Lanes, unit: Lanes) -> Series:
    """The instant itself, where the series counts in `unit` [s]."""
    return Series(lambda k: None, (start, unit), clock=True)


def steady(*parts: Any) -> bool:
    """Whether none depends on the state."""
    return all(part.clock for part in parts if isinstance(part, Series))


def at(x: Any, k: int) -> Any:
    """Coefficient k of a series or of a constant."""
    return x[k] if isinstance(x, Series) else x if k == 0 else None


def plus(a: Any, b: Any) -> Any:
    """a + b."""
    return b if a is None else a if b is None else a + b


def times(a: Any, b: Any) -> Any:
    """a b; a plain 0.0 is nothing."""
    nothing = a is None or b is None or any(isinstance(x, (int, float)) and x == 0.0 for x in (a, b))
    return None if nothing else a * b


def plus_product(c: Any, a: Any, b: Any) -> Any:
    """c + a b, rounded once."""
    if c is None or a is None or b is None or not any(isinstance(x, Lanes) for x in (a, b)):
        return plus(c, times(a, b))
    return fused(a, b, c)


def convolution(a: Any, b: Any, k: int) -> Any:
    """Coefficient k of a b. The newest coefficients come last, for the others are known long before them."""
    total = None
    for i in (*range(1, k), k, 0) if k else (0,):
        total = plus_product(total, a[i], b[k - i])
    return total


def quotient(a: Any, b: Series) -> Series:
    """a / b."""
    inverse: list[Any] = []

    def rule(k: int) -> Any:
        if not inverse:
            inverse.append(1.0 / b[0])
        done = None
        for i in range(k):
            done = plus_product(done, out[i], b[k - i])
        return times(plus(at(a, k), times(done, -1.0)), inverse[0])

    out = Series(rule, clock=steady(a, b))
    return out


def derivative(x: Series) -> Series:
    """dx/dt in the unit of the series."""
    return Series(lambda k: times(x[k + 1], float(k + 1)), clock=x.clock)


def integral(x: Series) -> Series:
    """The integral from the start, in the unit of the series."""
    return Series(lambda k: None if k == 0 else times(x[k - 1], 1.0 / k), clock=x.clock)


def _grown(x: Series, start: Any, factor: Callable[[], Series], sign: float = 1.0) -> Series:
    """y with y(0) = start(x(0)) and y' = sign x' factor."""
    slope = derivative(x)

    def rule(k: int) -> Any:
        return start(x[0]) if k == 0 else times(convolution(slope, factor(), k - 1), sign / k)

    return Series(rule, clock=x.clock)


def _elementary(name: str, of_lanes: Callable[[Any], Any], of_series: Callable[[Series], Series]) -> Callable[..., Any]:
    def function(x: Any) -> Any:
        return of_series(x) if isinstance(x, Series) else of_lanes(x)

    function.__name__, function.__doc__ = name, f"{name} of lanes or of a series of them."
    return function


def _exp(x: Series) -> Series:
    out = _grown(x, vectors.exp, lambda: out)
    return out


def _tanh(x: Series) -> Series:
    out = _grown(x, vectors.lane_tanh, lambda: rest)
    rest = 1.0 - out * out
    return out


def _sine_and_cosine(x: Series) -> tuple[Series, Series]:
    sine = _grown(x, vectors.sin, lambda: cosine)
    cosine = _grown(x, vectors.cos, lambda: sine, -1.0)
    return sine, cosine


def _arctan(x: Series) -> Series:
    slope = 1.0 / (1.0 + x * x)
    return _grown(x, vectors.arctan, lambda: slope)


def _log(x: Series) -> Series:
    slope = 1.0 / x
    return _grown(x, vectors.log, lambda: slope)


def _sqrt(x: Series) -> Series:
    out = _grown(x, vectors.sqrt, lambda: slope)
    slope = 0.5 / out
    return out


exp = _elementary("exp", vectors.exp, _exp)
lane_tanh = _elementary("tanh", vectors.lane_tanh, _tanh)
sin = _elementary("sin", vectors.sin, lambda x: _sine_and_cosine(x)[0])
cos = _elementary("cos", vectors.cos, lambda x: _sine_and_cosine(x)[1])
arctan = _elementary("arctan", vectors.arctan, _arctan)
log = _elementary("log", vectors.log, _log)
sqrt = _elementary("sqrt", vectors.sqrt, _sqrt)


def where(truth: Any, yes: Any, no: Any) -> Any:
    """`yes` in the lanes where it is true, else `no`, coefficient by coefficient."""
    if not (isinstance(yes, Series) or isinstance(no, Series)):
        return vectors.where(truth, yes, no)

    def rule(k: int) -> Any:
        one, other = at(yes, k), at(no, k)
        if one is None and other is None:
            return None
        return vectors.where(truth, 0.0 if one is None else one, 0.0 if other is None else other)

    return Series(rule, clock=steady(yes, no))


def minimum(a: Any, b: Any) -> Any:
    """The smaller of two at the start; a series where the other is plain infinity."""
    if not (isinstance(a, Series) or isinstance(b, Series)):
        return vectors.minimum(a, b)
    if endless(b, 1.0) or endless(a, 1.0):
        return a if endless(b, 1.0) else b
    return where(a < b, a, b)


def maximum(a: Any, b: Any) -> Any:
    """The larger of two at the start; a series where the other is plain minus infinity."""
    if not (isinstance(a, Series) or isinstance(b, Series)):
        return vectors.maximum(a, b)
    if endless(b, -1.0) or endless(a, -1.0):
        return a if endless(b, -1.0) else b
    return where(a > b, a, b)


def endless(x: Any, sign: float) -> bool:
    """Whether it is the plain number inf of that sign."""
    return isinstance(x, float) and x == sign * float("inf")


def from_zero(x: Any) -> Any:
    """The series with a start that is not below zero: a speed of slipping may begin at zero with round-off."""
    if not isinstance(x, Series):
        return vectors.maximum(x, 0.0)
    return Series(lambda k: vectors.maximum(x[0], 0.0) if k == 0 else at(x, k))


def constant(x: Any, like: Lanes) -> Any:
    """A coefficient as lanes, where None is zero."""
    return 0.0 * like if x is None else x


def value(x: Any, t: Any, order: int) -> Any:
    """x(t) by Horner's rule."""
    total = None
    for k in range(order, -1, -1):
        total = plus_product(at(x, k), total, t)
    return 0.0 * t if total is None else total


def value_and_slope(x: Any, t: Any, order: int) -> tuple[Any, Any]:
    """x(t) and x'(t)."""
    total = slope = None
    for k in range(order, -1, -1):
        slope = plus_product(total, slope, t)
        total = plus_product(at(x, k), total, t)
    zero = 0.0 * t
    return zero if total is None else total, zero if slope is None else slope
