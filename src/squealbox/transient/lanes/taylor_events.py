"""Where a Taylor step must end: the first root of any event function inside it, found on the series in all lanes.

The step is looked at in PARTS equal parts. In each a function is the cubic of its values and slopes at both ends; it
has no root there while the cubic's Bernstein coefficients exceed what the cubic may err by. The first part in which
this fails for one function alone, and with a change of sign, holds one root of that function, which Newton's rule finds
on the series itself. Where it fails otherwise, the step ends before that part, and the next one looks closer.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

from squealbox.transient.lanes.series import Series, at, constant, value, value_and_slope, where
from squealbox.transient.lanes.shape import PARTS
from squealbox.transient.lanes.vectors import Lanes, Truth, if_any, maximum, minimum, sqrt
from squealbox.transient.lanes.vectors import where as pick

NEAR_ZERO = 1e-9  # share of its size at which a function starts at zero: its contact has just begun to slip
TINY = 1e-6  # angle of the highest frequency over a step in which nothing turns: the signs at the ends tell
BEYOND = 1e-9  # by this angle a step goes beyond a kink of a law, so that the next one begins on its far side


@dataclass
class Part:
    """A function in a part of the step: values and slopes, per part, at its ends, and what is said of its roots."""

    number: int
    ends: tuple[Any, Any, Any, Any]
    doubtful: Any
    crosses: Any
    leaves: Any


class Found(NamedTuple):
    """length of the step in units of the series; 1 where an event is there, and of which function; 1 where the whole
    step was free of roots; how long the next one may be.
    """

    end: Lanes
    event: Lanes
    target: Lanes
    whole: Lanes
    next_limit: Lanes


def step_end(
    functions: tuple[Any, ...], kinks: list[Series], safe: Truth, x: Lanes, longest: Lanes, order: int
) -> Found:
    """Look at a step of length x in the lanes that are not safe. A kink of a law only ends the step."""
    zero = 0.0 * x
    clear = Found(x, zero, zero, zero + 1.0, longest)
    if not functions and not kinks:
        return clear
    moving = x > 0.0 if kinks else (x > 0.0) & ~safe  # a contact that surely slips may still pass a kink
    return Found(*if_any(moving, lambda: _looked_at(functions, kinks, moving, clear, order), clear))


def _looked_at(
    functions: tuple[Any, ...], kinks: list[Series], moving: Truth, clear: Found, order: int
) -> tuple[Lanes, ...]:
    watched = [*functions, *(where(d[0] > 0.0, d, -d) for d in kinks)]
    part = clear.end * (1.0 / PARTS)
    tiny = clear.end < TINY
    parts = _parts(watched, len(functions), part, moving, tiny, order)
    doubtful = parts[0][0].doubtful
    for each in [each for row in parts for each in row][1:]:
        doubtful = doubtful | each.doubtful
    return if_any(doubtful, lambda: _ended(watched, len(functions), parts, part, tiny, clear, order), clear)


def _parts(watched: list[Any], events: int, part: Lanes, moving: Truth, tiny: Truth, order: int) -> list[list[Part]]:
    """For each part of the step, each function; a kink that is never left, as of what rests, is none."""
    out: list[list[Part]] = [[] for _ in range(PARTS)]
    for number, function in enumerate(watched):
        if not isinstance(function, Series):
            continue  # a constant, which has no root
        zero = 0.0 * part
        f0, g0, bend = (constant(at(function, k), zero) for k in range(3))
        slack = NEAR_ZERO * (abs(g0) + abs(bend))
        for i in range(1, PARTS + 1):
            f1, g1 = value_and_slope(function, part * float(i), order)
            ends = (f0, g0 * part, f1, g1 * part)
            sure, crosses, leaves = _surely(*ends, part, tiny, slack if i == 1 else None)
            if number >= events:
                sure = sure | (abs(f0) + abs(g0) + abs(f1) + abs(g1) <= 0.0)
            out[i - 1].append(Part(number, ends, ~sure & moving, crosses, leaves))
            f0, g0 = f1, g1
    return out


def _ended(
    watched: list[Any], events: int, parts: list[list[Part]], part: Lanes, tiny: Truth, clear: Found, order: int
) -> tuple[Lanes, ...]:
    """Where the step ends in the lanes in doubt."""
    first = _first(parts, part)
    root, sharp = _root(watched, first, part, order)
    doubt = first.count > 0.5
    lone = doubt & first.crosses & (((first.count < 1.5) & sharp) | tiny)
    kink = lone & (first.which > events - 0.5)
    end = pick(doubt, pick(lone, root, first.low), clear.end)
    end = pick(kink, root + BEYOND, end)
    closer = pick(first.low > 0.0, part, 0.25 * part)
    return Found(end, 1.0 * (lone & ~kink), first.which, 1.0 * ~doubt, pick(doubt & ~lone, closer, clear.next_limit))


@dataclass
class First:
    """The first part of the step that is in doubt: where it begins, how many functions are, and the first of them."""

    low: Any
    count: Any
    which: Any
    ends: Any
    crosses: Any
    leaves: Any


def _first(parts: list[list[Part]], part: Lanes) -> First:
    """From the last part to the first, and in each from the last function to the first, so the first one stays."""
    zero = 0.0 * part
    false = part != part
    first = First(zero, zero, zero, (zero, zero, zero, zero), false, false)
    for i, row in reversed(list(enumerate(parts))):
        count = zero
        for each in reversed(row):
            bad = each.doubtful
            count = count + 1.0 * bad
            first.which = pick(bad, float(each.number), first.which)
            first.ends = tuple(pick(bad, a, b) for a, b in zip(each.ends, first.ends, strict=True))
            first.crosses = (bad & each.crosses) | (~bad & first.crosses)
            first.leaves = (bad & each.leaves) | (~bad & first.leaves)
        here = count > 0.5
        first.low = pick(here, float(i) * part, first.low)
        first.count = pick(here, count, first.count)
    return first


def _surely(f0: Any, g0: Any, f1: Any, g1: Any, part: Any, tiny: Any, slack: Any) -> tuple[Truth, Truth, Truth]:
    """Whether the function has no root in the part; just one; and starts as a root itself. Slopes are per part.

    The cubic errs by h^4 f'''' x^2 (1 - x)^2 / 24, and f'''' is at most the square of the highest frequency times f'':
    so `part`, an angle of that frequency, tells by how much. Four times that is taken.
    """
    left, right = f0 + g0 * (1.0 / 3.0), f1 - g1 * (1.0 / 3.0)
    bend = maximum(abs(f0 - 2.0 * left + right), abs(left - 2.0 * right + f1))
    bend = maximum(bend, (0.5 / 3.0) * part * maximum(abs(g0), abs(g1)))
    room = 0.0625 * part * part * bend
    least = minimum(minimum(left, right), f1)
    sure = (least > room) | (tiny & (f1 > 0.0))
    crosses = (f1 <= 0.0) & ~((left <= 0.0) & (right > 0.0))
    if slack is None:
        return sure, crosses, f1 > f1
    leaves = _leaves(f0, left, right, f1, slack)
    return sure | (leaves & (right > 0.0) & (f1 > 0.0)), crosses | (leaves & (f1 <= 0.0)), leaves


def _leaves(f0: Any, left: Any, right: Any, f1: Any, slack: Any) -> Truth:
    """Whether a function that is zero at the start, but for round-off, rises from there: with a slope or a bend."""
    small = NEAR_ZERO * maximum(maximum(abs(left), abs(right)), abs(f1))
    return (abs(f0) <= slack) & ((left > small) | ((left > -small) & (right > small)))


def _root(watched: list[Any], first: First, part: Lanes, order: int) -> tuple[Any, Truth]:
    """The root of the doubtful function in its part, and whether Newton's rule has settled on it."""
    chosen = Series(lambda k: _select(watched, first.which, k))
    f0, g0, f1, g1 = first.ends
    left, right = f0 + g0 * (1.0 / 3.0), f1 - g1 * (1.0 / 3.0)
    c1, c2, c3 = g0, 3.0 * (f0 - 2.0 * left + right), f1 - 3.0 * right + 3.0 * left - f0
    fall = f0 - f1
    share = pick(first.leaves, _second_root(c1, c2, c3), f0 / pick(fall > 0.0, fall, 1.0))
    for _ in range(2):
        slope = c1 + share * (2.0 * c2 + share * 3.0 * c3)
        f = f0 + share * (c1 + share * (c2 + share * c3))
        share = _within(share - f / pick(slope < 0.0, slope, -1e300), 0.0, 1.0)
    low, high = first.low, first.low + part
    t = low + share * part
    for _ in range(2):
        f, slope = value_and_slope(chosen, t, order)
        falls = slope < 0.0
        inverse = 1.0 / pick(falls, slope, -1e300)
        t = _within(t - f * inverse, low, high)
    step = value(chosen, t, order) * inverse
    return _within(t - step, low, high), (falls & (abs(step) <= 1e-7 * part)) | ((f0 <= 0.0) & ~first.leaves)


def _second_root(c1: Any, c2: Any, c3: Any) -> Any:
    """Where s (c1 + c2 s + c3 s^2), which rises from zero, comes back to it; the form that does not cancel."""
    root = sqrt(maximum(c2 * c2 - 4.0 * c1 * c3, 0.0))
    bends_up = c2 > 0.0
    below = pick(bends_up, -2.0 * c3, root - c2)
    return _within(pick(bends_up, c2 + root, 2.0 * c1) / pick(below > 0.0, below, 1.0), 0.0, 1.0)


def _select(watched: list[Any], which: Any, k: int) -> Any:
    """Coefficient k of the function that is number `which`."""
    total = at(watched[0], k)
    total = 0.0 * which if total is None else total
    for j, function in enumerate(watched[1:], 1):
        one = at(function, k)
        total = pick(which > j - 0.5, 0.0 if one is None else one, total)
    return total


def _within(x: Any, low: Any, high: Any) -> Any:
    return minimum(maximum(x, low), high)
