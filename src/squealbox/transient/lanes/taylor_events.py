"""Where a Taylor step must end: the first root of any event function inside it, found on the series in all lanes.

The step is looked at in PARTS equal parts. In each a function is the cubic of its values and slopes at both ends; it
has no root there while the cubic's Bernstein coefficients exceed what the cubic may err by. In the first part in which
this fails, the function whose cubic is first at zero, with a change of sign, has one root, which Newton's rule finds on
the series itself; the others must surely be free of roots up to there, by the coefficients of their cubics cut off
there. Where either fails, the step ends before that part, and the next one looks closer.
"""

from dataclasses import dataclass
from typing import Any, NamedTuple

from squealbox.compiled import Lanes, Truth, if_any, maximum, minimum, sqrt
from squealbox.compiled import where as pick
from squealbox.transient.lanes.series import Series, at, constant, value, value_and_slope, where
from squealbox.transient.lanes.shape import PARTS

NEAR_ZERO = 1e-9  # share of its size at which a function starts at zero: its contact has just begun to slip
TINY = 1e-6  # angle of the highest frequency over a step in which nothing turns: the signs at the ends tell
BEYOND = 1e-9  # by this angle a step goes beyond a kink of a law, so that the next one begins on its far side


@dataclass
class Watched:
    """A function in a part of the step: the Bernstein coefficients of its cubic, what that may err by, and what is said
    of its roots.
    """

    number: Any
    cubic: tuple[Any, ...]
    room: Any
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
    if not any(isinstance(each, Series) for each in (*functions, *kinks)):  # a constant has no root
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


def _parts(watched: list[Any], events: int, part: Lanes, moving: Truth, tiny: Truth, order: int) -> list[list[Watched]]:
    """For each part of the step, each function; a kink that is never left, as of what rests, is none."""
    out: list[list[Watched]] = [[] for _ in range(PARTS)]
    for number, function in enumerate(watched):
        if not isinstance(function, Series):
            continue  # a constant, which has no root
        zero = 0.0 * part
        f0, g0, bend = (constant(at(function, k), zero) for k in range(3))
        slack = NEAR_ZERO * (abs(g0) + abs(bend))
        for i in range(1, PARTS + 1):
            f1, g1 = value_and_slope(function, part * float(i), order)
            each = _surely(float(number), f0, g0 * part, f1, g1 * part, part, tiny, slack if i == 1 else None)
            if number >= events:
                each.doubtful = each.doubtful & (abs(f0) + abs(g0) + abs(f1) + abs(g1) > 0.0)
            each.doubtful = each.doubtful & moving
            out[i - 1].append(each)
            f0, g0 = f1, g1
    return out


def _ended(
    watched: list[Any], events: int, parts: list[list[Watched]], part: Lanes, tiny: Truth, clear: Found, order: int
) -> tuple[Lanes, ...]:
    """Where the step ends in the lanes in doubt."""
    low, doubt, functions = _first(parts, part)
    first, share = _earliest(functions, part)
    root, sharp = _root(watched, first, share, low, part, order)
    share = (root - low) / pick(part > 0.0, part, 1.0)
    for each in functions:
        sharp = sharp & (~each.doubtful | (abs(first.number - each.number) < 0.5) | _clear_before(each, share))
    lone = doubt & first.crosses & (sharp | tiny)
    kink = lone & (first.number > events - 0.5)
    end = pick(doubt, pick(lone, root, low), clear.end)
    end = pick(kink, root + BEYOND, end)
    closer = pick(low > 0.0, part, 0.25 * part)
    return Found(end, 1.0 * (lone & ~kink), first.number, 1.0 * ~doubt, pick(doubt & ~lone, closer, clear.next_limit))


def _chosen(truth: Truth, yes: Watched, no: Watched) -> Watched:
    """One of two in each lane."""
    return Watched(
        pick(truth, yes.number, no.number),
        (*(pick(truth, a, b) for a, b in zip(yes.cubic, no.cubic, strict=True)),),
        pick(truth, yes.room, no.room),
        *(
            (truth & a) | (~truth & b)
            for a, b in ((yes.doubtful, no.doubtful), (yes.crosses, no.crosses), (yes.leaves, no.leaves))
        ),
    )


def _first(parts: list[list[Watched]], part: Lanes) -> tuple[Lanes, Truth, list[Watched]]:
    """(where the first part that is in doubt begins, whether any is, all functions there)."""
    low, doubt, there = 0.0 * part, part != part, parts[-1]
    for i, row in reversed(list(enumerate(parts))):
        here = row[0].doubtful
        for each in row[1:]:
            here = here | each.doubtful
        low, doubt = pick(here, float(i) * part, low), doubt | here
        there = row if i == PARTS - 1 else [_chosen(here, a, b) for a, b in zip(row, there, strict=True)]
    return low, doubt, there


def _earliest(functions: list[Watched], part: Lanes) -> tuple[Watched, Lanes]:
    """The doubtful function whose cubic is first at zero, and the share of the part at which it is."""
    first, least = functions[0], 2.0 + 0.0 * part
    for each in functions:
        share = pick(each.doubtful, _share(each), 2.0)
        first, least = _chosen(share < least, each, first), minimum(share, least)
    return first, least


def _share(of: Watched) -> Any:
    """The share of its part at which the cubic of a function that crosses is zero."""
    f0, left, right, f1 = of.cubic
    c1, c2, c3 = 3.0 * (left - f0), 3.0 * (f0 - 2.0 * left + right), f1 - 3.0 * right + 3.0 * left - f0
    fall = f0 - f1
    share = pick(of.leaves, _second_root(c1, c2, c3), f0 / pick(fall > 0.0, fall, 1.0))
    for _ in range(2):
        slope = c1 + share * (2.0 * c2 + share * 3.0 * c3)
        f = f0 + share * (c1 + share * (c2 + share * c3))
        share = _within(share - f / pick(slope < 0.0, slope, -1e300), 0.0, 1.0)
    return share


def _clear_before(of: Watched, share: Lanes) -> Truth:
    """Whether the function surely has no root up to a share of the part, by the coefficients of that piece of it."""
    f0, left, right, f1 = of.cubic
    a, b, c = f0 + share * (left - f0), left + share * (right - left), right + share * (f1 - right)
    d, e = a + share * (b - a), b + share * (c - b)
    there = d + share * (e - d)
    return (minimum(minimum(f0, a), minimum(d, there)) > of.room) | (of.leaves & (d > 0.0) & (there > 0.0))


def _surely(number: float, f0: Any, g0: Any, f1: Any, g1: Any, part: Any, tiny: Any, slack: Any) -> Watched:
    """Whether the function has no root in the part; just one; and starts as a root itself. Slopes are per part.

    The cubic errs by h^4 f x^2 (1 - x)^2 / 24, and f is at most the square of the highest frequency times f'':
    so `part`, an angle of that frequency, tells by how much. Four times that is taken.
    """
    left, right = f0 + g0 * (1.0 / 3.0), f1 - g1 * (1.0 / 3.0)
    bend = maximum(abs(f0 - 2.0 * left + right), abs(left - 2.0 * right + f1))
    bend = maximum(bend, (0.5 / 3.0) * part * maximum(abs(g0), abs(g1)))
    room = 0.0625 * part * part * bend
    least = minimum(minimum(left, right), f1)
    sure = (least > room) | (tiny & (f1 > 0.0))
    crosses, leaves = (f1 <= 0.0) & ~((left <= 0.0) & (right > 0.0)), f1 > f1
    if slack is not None:
        leaves = _leaves(f0, left, right, f1, slack)
        sure, crosses = sure | (leaves & (right > 0.0) & (f1 > 0.0)), crosses | (leaves & (f1 <= 0.0))
    return Watched(number, (f0, left, right, f1), room, ~sure, crosses, leaves)


def _leaves(f0: Any, left: Any, right: Any, f1: Any, slack: Any) -> Truth:
    """Whether a function that is zero at the start, but for round-off, rises from there: with a slope or a bend."""
    small = NEAR_ZERO * maximum(maximum(abs(left), abs(right)), abs(f1))
    return (abs(f0) <= slack) & ((left > small) | ((left > -small) & (right > small)))


def _root(watched: list[Any], first: Watched, share: Lanes, low: Lanes, part: Lanes, order: int) -> tuple[Any, Truth]:
    """The root of the first function, from where its cubic is zero, and whether Newton's rule has settled on it."""
    chosen = Series(lambda k: _select(watched, first.number, k))
    high = low + part
    t = low + _within(share, 0.0, 1.0) * part
    for _ in range(2):
        f, slope = value_and_slope(chosen, t, order)
        falls = slope < 0.0
        inverse = 1.0 / pick(falls, slope, -1e300)
        t = _within(t - f * inverse, low, high)
    step = value(chosen, t, order) * inverse
    settled = (falls & (abs(step) <= 1e-7 * part)) | ((first.cubic[0] <= 0.0) & ~first.leaves)
    return _within(t - step, low, high), settled


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
