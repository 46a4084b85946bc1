"""Where in a rejected trial the first event lies, and how long the next trial must be; compiled by `kernel`.

A slip speed or a normal force is the cubic of its values and slopes at both ends of a trial, or the quintic with those
of a stage; the margin of a sticking contact is the polynomial of values in stages. What the interpolation proposes is
tried as a step of the method itself and then refined, so an event inherits the method's order. A trial that ends beside
its event is moved onto it by Taylor's series: `event_text` tells how far that may be.
"""

# mypy: disable-error-code="no-untyped-def"

import numpy as np

from squealbox.transient.lanes.of_a_shape import CONTACTS, FUNCTIONS, PROBE_0, PROBE_1, PROBE_2, PROBES
from squealbox.transient.lanes.roots import (
    cubic,
    cubic_root,
    inverse_parabola,
    lowest,
    quartic_root,
    quintic_root,
)

CLOSEST, WIDEST = 1e-11, 1e-10  # shares of the step to which an event is located, for the finest and coarsest rtol


def locate(lane):
    """Choose the length of the next trial so that it ends on the first event of the one just rejected.

    Returns the function whose mode does not hold even at the start, which is an event at once; otherwise -1.
    """
    h = lane.h
    target = int(lane.target)
    if target < 0:
        lane.resume = h
    best = 2.0
    which = -1
    suspicious = False
    for j in range(FUNCTIONS):
        if j == target:
            continue
        theta, unsure = first_crossing(lane, j, h)
        suspicious = suspicious or unsure
        if theta < best:
            best = theta
            which = j
    if best <= 0.0:
        return which
    if which >= 0:
        aim(lane, which, best, h)
    elif target >= 0 and lane.close == 0.0:
        refine(lane, target, h)
    elif suspicious and h > 1e-3 * lane.resume:
        lane.h = 0.5 * h
        lane.target = -1.0
    else:
        lane.trust = 1.0
    return -1


def smooth(lane, j):
    """Whether function j has slopes; the margin of a sticking contact has none at hand."""
    if j >= CONTACTS:
        return True
    return lane.slips[j] != 0.0 or lane.opened[j] != 0.0


def first_crossing(lane, j, h):
    """(share of the step at which function j first turns negative, or 2; whether a shorter step must tell).

    The function is the cubic of its values and slopes; a margin of sticking is the polynomial of its values in stages.
    A shorter step must tell where the cubic has a minimum nearer to zero than it may err: so a short reversal is found.
    """
    f0 = lane.phi[j]
    f1 = lane.end[j]
    noise = lane.fresh[j] if j < CONTACTS else 0.0
    fresh = noise > 0.0
    if not smooth(lane, j):
        if not f0 > 0.0:
            return (0.0 if f1 <= 0.0 else 2.0), False
        if f1 <= 0.0:
            return margin_root(lane, j, f0, f1), False
        return 2.0, lane.inner[j] <= 0.0
    b1 = f0 + h * lane.rate[j] / 3.0
    b2 = f1 - h * lane.rate_end[j] / 3.0
    if fresh and not 3.0 * b1 > -h * noise:
        return 0.0, False
    if not fresh and not f0 > 0.0:
        return 0.0, False
    doubt = doubt_of(lane, f0, b1, b2, f1, h)
    if min(f0 + 3.0 * b1, 3.0 * b2 + f1, f1) > 0.0 and b1 + b2 > doubt / 3.0:
        return 2.0, False
    dip = lowest(b1 - f0, b2 - b1, f1 - b2, 0.0625 if fresh else 0.0)
    least = cubic(f0, b1, b2, f1, dip)
    if dip < 1.0:
        if abs(least) <= doubt * (dip * (1.0 - dip)) ** 2:
            return 2.0, True
        if least < 0.0:
            return cubic_root(f0, b1, b2, f1, 0.0, dip), False
    if f1 > 0.0:
        return 2.0, False
    return cubic_root(f0, b1, b2, f1, dip if dip < 1.0 else 0.0, 1.0), False


def margin_root(lane, j, f0, f1):
    """Where the margin of a sticking contact turns negative, as a share of the step, by its values in stages."""
    y1 = lane.probe[j]
    if PROBES == 1:
        return inverse_parabola(0.0, f0, 1.0, f1, PROBE_0, y1)
    y2 = lane.probe[CONTACTS + j]
    y3 = lane.probe[2 * CONTACTS + j]
    return quartic_root((0.0, PROBE_0, PROBE_1, PROBE_2, 1.0), (f0, y1, y2, y3, f1))


def doubt_of(lane, b0, b1, b2, b3, h):
    """By how much the function may differ from its cubic at x: this number times (x (1 - x))^2.

    The cubic errs by h^4 f'''' x^2 (1 - x)^2 / 24. With f'''' = w^2 f'', w the highest frequency, it is (w h)^2 D / 4,
    where f'' = 6 D / h^2 is the larger one of both ends, or w times the larger slope should they be at a point of
    inflection. Four times that is taken. Steps below 1e-3 / w are not in doubt.
    """
    angle = lane.highest * h
    if angle < 1e-3:
        return 0.0
    bend = max(abs(b0 - 2.0 * b1 + b2), abs(b1 - 2.0 * b2 + b3))
    return angle * angle * max(bend, 0.5 * angle * max(abs(b1 - b0), abs(b3 - b2)))


def aim(lane, j, theta, h):
    """The next trial is theta of the last one, towards an event of function j."""
    f0 = lane.phi[j]
    f1 = lane.end[j]
    b1 = f0 + h * lane.rate[j] / 3.0
    b2 = f1 - h * lane.rate_end[j] / 3.0
    y = 1.0 - theta
    slope = abs(f1 - f0)
    if smooth(lane, j):
        slope = 3.0 * abs(y * y * (b1 - f0) + 2.0 * y * theta * (b2 - b1) + theta * theta * (f1 - b2))
    lane.target = j
    lane.tolerance = slope * min(max(1e-4 * lane.rtol, CLOSEST), WIDEST)
    lane.low = 0.0
    lane.low_phi = f0
    lane.high = h
    lane.high_phi = f1
    lane.high_rate = lane.rate_end[j]
    lane.turns = 0.0
    x = theta * h
    if PROBES > 1 and j < CONTACTS and smooth(lane, j):
        ends = (f0, lane.rate[j], h, f1, lane.rate_end[j])
        early = lane.early[j]
        better = quintic_root(ends, PROBE_0 * h, early, lane.early_rate[j], x)
        if 0.0 < better < h:
            x = better
    lane.h = x


def refine(lane, j, h):
    """A better length of the trial that aims at an event, inside a bracket that shrinks.

    Where slopes are known, the root of the quintic of values and slopes at three instants, then Newton. Otherwise the
    inverse parabola through the bracket and the end it lost last; when that is slow, the middle every third time.
    """
    f = lane.end[j]
    points = (
        lane.phi[j],
        lane.rate[j],
        lane.high,
        lane.high_phi,
        lane.high_rate,
    )
    side = 0 if f > 0.0 else 2  # low and low_phi, or high and high_phi behind them
    third = lane.low[side]
    f_third = lane.low[side + 1]
    lane.low[side] = h
    lane.low[side + 1] = f
    low = lane.low
    high = lane.high
    turns = lane.turns + 1.0
    lane.turns = turns
    x = 0.5 * (low + high)
    slope = lane.pace / h
    known = smooth(lane, j)
    step = h - f / slope if slope < 0.0 else low
    if known and slope < 0.0 and turns < 2.0:
        step = quintic_root(points, h, f, slope, step)
    if low < step < high and (known or (PROBES > 1 and turns < 4.0)):
        x = step
    elif not known and (turns < 10.0 or int(turns) % 3 != 0):
        x = inverse_parabola(low, lane.low_phi, high, lane.high_phi, third, f_third)
    if turns > 60.0 or not abs(x - h) > 4e-16 * (lane.t + h):
        lane.tolerance = np.inf
        x = h
    lane.h = x
