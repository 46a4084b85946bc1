"""Tables of measured points as series: the polynomial of the interval in which a step begins; a knot ends the step.

A friction law's knots are watched like any other choice that the state makes; the instants of a schedule are ends of
pieces already, so its choice looks a little ahead.
"""

from typing import Any

from squealbox.compiled import Given, Lanes, where
from squealbox.transient.lanes.series import AHEAD, Series, above, at, plus, times

FAR = 1e300  # where there is no further knot


def law_of_points(x: Any, p: Given) -> Any:
    """`friction.table` on a series of the speed, or on speeds."""
    count, here = p[1], at(x, 0)
    first, last = p[2], p[1 + count]
    low, high, at_ends = _ends(here, p, 2, count)
    (y0, y1), (left, right) = (at_ends(2 + k * count) for k in (1, 2))
    below, beyond = here < first, here >= last
    inside = where(below | beyond, 0.0, 1.0)
    width, rise = high - low, y1 - y0
    left, right, rise = inside * left * width, inside * right * width, inside * rise
    s = (x - low) * (1.0 / width)
    if isinstance(x, Series):  # watched are the knots on both sides; zero speed is an event, no knot
        unwatched = below | ((first <= 0.0) & (low <= first))
        above(where(beyond, last, where(unwatched, -FAR, low)), x)
        above(where(beyond, FAR, where(below, first, high)), x)
    steeper = s * (left + right - 2.0 * rise) + (3.0 * rise - 2.0 * left - right)
    return s * (s * steeper + left) + where(beyond, y1, y0)


def line_of_points(t: Series, p: Given) -> Series:
    """`schedules.table` on the series of time."""
    slope, low, value = _line(t, p)
    return (t - low) * slope + value


def slope_of_points(t: Series, p: Given) -> Lanes:
    """`schedules.table_rate` there."""
    return _line(t, p)[0]


def _line(t: Series, p: Given) -> tuple[Lanes, Any, Any]:
    """Slope of the line on which a step begins, where that begins, and its value there."""
    count, here = p[0], plus(at(t, 0), times(at(t, 1), AHEAD))
    low, high, at_ends = _ends(here, p, 1, count)
    y0, y1 = at_ends(1 + count)
    outside = (here < p[1]) | (here >= p[count])
    return where(outside, 0.0, (y1 - y0) / (high - low)), low, where(here >= p[count], y1, y0)


def _ends(here: Lanes, p: Given, first: int, count: int) -> tuple[Lanes, Lanes, Any]:
    """Both ends of the interval, the first or last where there is none, and what gives the coefficients at both."""
    found = p.last_below(here, first, count - 1)

    def at_ends(place: int) -> tuple[Lanes, Lanes]:
        return p.of(found, place), p.of(found, place + 1)

    return *at_ends(first), at_ends
