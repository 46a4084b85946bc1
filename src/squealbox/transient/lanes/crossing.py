"""Where in a rejected trial the first event lies, and how long the next trial must be; compiled by `kernel`.

A slip speed or a normal force is the cubic of its values and slopes at both ends of the trial, the margin of a sticking
contact a straight line. What the interpolation proposes is tried as a step of the method itself and then refined, so an
event inherits the method's order.
"""

# ruff: noqa: F821  (the places of the rows, FUNCTIONS and CONTACTS are generated)
# mypy: disable-error-code="name-defined,no-untyped-def"

import numpy as np

CLOSEST, WIDEST = 1e-11, 1e-10  # shares of the step to which an event is located, for the finest and coarsest rtol


def locate(A, b, lane):
    """Choose the length of the next trial so that it ends on the first event of the one just rejected.

    Returns the function whose mode does not hold even at the start, which is an event at once; otherwise -1.
    """
    h = A[b + ROW_H * WIDTH + lane]
    target = int(A[b + ROW_TARGET * WIDTH + lane])
    if target < 0:
        A[b + ROW_RESUME * WIDTH + lane] = h
    best = 2.0
    which = -1
    suspicious = False
    for j in range(FUNCTIONS):
        if j == target:
            continue
        theta, unsure = first_crossing(A, b, lane, j, h)
        suspicious = suspicious or unsure
        if theta < best:
            best = theta
            which = j
    if best <= 0.0:
        return which
    if which >= 0:
        aim(A, b, lane, which, best, h)
    elif target >= 0 and A[b + (ROW_END + target) * WIDTH + lane] != 0.0 and not close(A, b, lane, target):
        refine(A, b, lane, target, h)
    elif suspicious and h > 1e-3 * A[b + ROW_RESUME * WIDTH + lane]:
        A[b + ROW_H * WIDTH + lane] = 0.5 * h
        A[b + ROW_TARGET * WIDTH + lane] = -1.0
    else:
        A[b + ROW_TRUST * WIDTH + lane] = 1.0
    return -1


def close(A, b, lane, j):
    """Whether the trial ended on its event."""
    return abs(A[b + (ROW_END + j) * WIDTH + lane]) <= A[b + ROW_TOLERANCE * WIDTH + lane]


def smooth(A, b, lane, j):
    """Whether function j has slopes; the margin of a sticking contact has none at hand."""
    if j >= CONTACTS:
        return True
    return A[b + (ROW_SLIPS + j) * WIDTH + lane] != 0.0 or A[b + (ROW_OPENED + j) * WIDTH + lane] != 0.0


def first_crossing(A, b, lane, j, h):
    """(share of the step at which function j first turns negative, or 2; whether a shorter step must tell).

    The function is the cubic of its values and slopes; a margin of sticking is a parabola through its value in a stage.
    A shorter step must tell where the cubic has a minimum nearer to zero than it may err: so a short reversal is found.
    """
    f0 = A[b + (ROW_PHI + j) * WIDTH + lane]
    f1 = A[b + (ROW_END + j) * WIDTH + lane]
    fresh = j < CONTACTS and A[b + (ROW_FRESH + j) * WIDTH + lane] > 0.0
    if not smooth(A, b, lane, j):
        if not f0 > 0.0:
            return (0.0 if f1 <= 0.0 else 2.0), False
        if f1 <= 0.0:
            middle = A[b + (ROW_MIDDLE + j) * WIDTH + lane]
            return inverse_parabola(0.0, f0, 1.0, f1, MIDDLE, middle), False
        return 2.0, A[b + (ROW_INNER + j) * WIDTH + lane] <= 0.0
    b1 = f0 + h * A[b + (ROW_RATE + j) * WIDTH + lane] / 3.0
    b2 = f1 - h * A[b + (ROW_RATE_END + j) * WIDTH + lane] / 3.0
    size = max(abs(b1), abs(b2), abs(f1))
    if fresh and not b1 > -1e-9 * size:
        return 0.0, False
    if not fresh and not f0 > 0.0:
        return 0.0, False
    dip = lowest(b1 - f0, b2 - b1, f1 - b2, 0.0625 if fresh else 0.0)
    least = cubic(f0, b1, b2, f1, dip)
    doubt = doubt_of(A, b, lane, f0, b1, b2, f1, h) * (dip * (1.0 - dip)) ** 2
    before = 0.0
    for k in range(1, 17):
        x = k / 16.0
        if x > dip and abs(least) <= doubt:
            return 2.0, True
        if x > dip > before and least < 0.0:
            return cubic_root(f0, b1, b2, f1, before, dip), False
        if not cubic(f0, b1, b2, f1, x) > 0.0:
            return cubic_root(f0, b1, b2, f1, before, x), False
        before = x
    return 2.0, False


def lowest(d0, d1, d2, first):
    """Where the cubic with these differences of its Bernstein coefficients is least; 1 if not inside, behind `first`.

    A contact that has just been released leaves with v' = 0, so round-off makes a minimum at its very start.
    """
    bend = d1 - d0
    square = bend * bend - d0 * (d0 - 2.0 * d1 + d2)
    if not square >= 0.0:
        return 1.0
    x = -d0 / (bend + np.sqrt(square))
    return x if first < x < 1.0 else 1.0


def doubt_of(A, b, lane, b0, b1, b2, b3, h):
    """By how much the function may differ from its cubic at x: this number times (x (1 - x))^2.

    The cubic errs by h^4 f'''' x^2 (1 - x)^2 / 24. With f'''' = w^2 f'', w the highest frequency, it is (w h)^2 D / 4,
    where f'' = 6 D / h^2 is the larger one of both ends, or w times the larger slope should they be at a point of
    inflection. Four times that is taken. Steps below 1e-3 / w are not in doubt.
    """
    angle = 2e-3 * np.pi * h / A[b + ROW_WINDOW * WIDTH + lane]
    if angle < 1e-3:
        return 0.0
    bend = max(abs(b0 - 2.0 * b1 + b2), abs(b1 - 2.0 * b2 + b3))
    return angle * angle * max(bend, 0.5 * angle * max(abs(b1 - b0), abs(b3 - b2)))


def cubic(b0, b1, b2, b3, x):
    """The cubic of four Bernstein coefficients."""
    y = 1.0 - x
    return y * y * (y * b0 + 3.0 * x * b1) + x * x * (3.0 * y * b2 + x * b3)


def cubic_root(b0, b1, b2, b3, low, high):
    """Where it turns negative between low and high, by the Illinois rule."""
    f_low = cubic(b0, b1, b2, b3, low)
    f_high = cubic(b0, b1, b2, b3, high)
    if not f_low > 0.0:  # a contact that has just begun to slip starts from zero
        low += 1e-3 * (high - low)
        f_low = cubic(b0, b1, b2, b3, low)
        if not f_low > 0.0:
            return low
    for _ in range(12):
        x = (low * f_high - high * f_low) / (f_high - f_low)
        f = cubic(b0, b1, b2, b3, x)
        if f > 0.0:
            low = x
            f_low = f
            f_high *= 0.5
        else:
            high = x
            f_high = f
            f_low *= 0.5
        if high - low < 1e-7 or f == 0.0:
            break
    return x


def aim(A, b, lane, j, theta, h):
    """The next trial is theta of the last one, towards an event of function j."""
    f0 = A[b + (ROW_PHI + j) * WIDTH + lane]
    f1 = A[b + (ROW_END + j) * WIDTH + lane]
    b1 = f0 + h * A[b + (ROW_RATE + j) * WIDTH + lane] / 3.0
    b2 = f1 - h * A[b + (ROW_RATE_END + j) * WIDTH + lane] / 3.0
    y = 1.0 - theta
    slope = abs(f1 - f0)
    if smooth(A, b, lane, j):
        slope = 3.0 * abs(y * y * (b1 - f0) + 2.0 * y * theta * (b2 - b1) + theta * theta * (f1 - b2))
    A[b + ROW_TARGET * WIDTH + lane] = j
    A[b + ROW_TOLERANCE * WIDTH + lane] = slope * min(max(1e-4 * A[b + ROW_RTOL * WIDTH + lane], CLOSEST), WIDEST)
    A[b + ROW_LOW * WIDTH + lane] = 0.0
    A[b + ROW_LOW_PHI * WIDTH + lane] = f0
    A[b + ROW_HIGH * WIDTH + lane] = h
    A[b + ROW_HIGH_PHI * WIDTH + lane] = f1
    A[b + ROW_HIGH_RATE * WIDTH + lane] = A[b + (ROW_RATE_END + j) * WIDTH + lane]
    A[b + ROW_TURNS * WIDTH + lane] = 0.0
    A[b + ROW_H * WIDTH + lane] = theta * h


def refine(A, b, lane, j, h):
    """A better length of the trial that aims at an event, inside a bracket that shrinks.

    Where slopes are known, the root of the quintic of values and slopes at three instants, then Newton. Otherwise the
    inverse parabola through the bracket and the end it lost last; when that is slow, the middle every third time.
    """
    f = A[b + (ROW_END + j) * WIDTH + lane]
    points = (
        A[b + (ROW_PHI + j) * WIDTH + lane],
        A[b + (ROW_RATE + j) * WIDTH + lane],
        A[b + ROW_HIGH * WIDTH + lane],
        A[b + ROW_HIGH_PHI * WIDTH + lane],
        A[b + ROW_HIGH_RATE * WIDTH + lane],
    )
    side = ROW_LOW if f > 0.0 else ROW_HIGH
    third = A[b + side * WIDTH + lane]
    f_third = A[b + (side + 1) * WIDTH + lane]
    A[b + side * WIDTH + lane] = h
    A[b + (side + 1) * WIDTH + lane] = f
    low = A[b + ROW_LOW * WIDTH + lane]
    high = A[b + ROW_HIGH * WIDTH + lane]
    turns = A[b + ROW_TURNS * WIDTH + lane] + 1.0
    A[b + ROW_TURNS * WIDTH + lane] = turns
    x = 0.5 * (low + high)
    slope = A[b + (ROW_RATE_END + j) * WIDTH + lane]
    if smooth(A, b, lane, j) and slope < 0.0:
        step = h - f / slope
        if turns < 2.0:
            step = quintic_root(points, h, f, slope, step)
        if low < step < high:
            x = step
    elif turns < 10.0 or int(turns) % 3 != 0:
        x = inverse_parabola(
            low, A[b + ROW_LOW_PHI * WIDTH + lane], high, A[b + ROW_HIGH_PHI * WIDTH + lane], third, f_third
        )
    if turns > 60.0 or not abs(x - h) > 4e-16 * (A[b + ROW_T * WIDTH + lane] + h):
        A[b + ROW_TOLERANCE * WIDTH + lane] = np.inf
        x = h
    A[b + ROW_H * WIDTH + lane] = x


def inverse_parabola(low, f_low, high, f_high, third, f_third):
    """Where the parabola x(f) through three points has f = 0; the chord's root if that lies outside the bracket."""
    x = 0.5 * (low + high)
    if not f_low > f_high:
        return x
    chord = (low * f_high - high * f_low) / (f_high - f_low)
    if low < chord < high:
        x = chord
    if f_third != f_low and f_third != f_high:
        bend = ((third - low) / (f_third - f_low) - (high - low) / (f_high - f_low)) / (f_third - f_high)
        curved = chord + bend * f_low * f_high
        if low < curved < high:
            x = curved
    return x


def quintic_root(points, h, f, slope, guess):
    """Root near h of the quintic with given values and slopes at 0, at h and at an end: Newton's form over h, h, 0, 0.

    `points` holds (f, slope) at 0, then the end and its (f, slope).
    """
    f0, rate0, end, f1, rate1 = points
    back = (f - f0) / h
    on = (f1 - f0) / end
    bend = (back - rate0) / h
    twist = (on - rate0) / end
    two = (slope - back) / h
    three = (two - bend) / h
    across = (twist - bend) / (end - h)
    four = (across - three) / (end - h)
    five = ((((rate1 - on) / end - twist) / end - across) / (end - h) - four) / (end - h)
    x = guess
    for _ in range(3):
        d = x - h
        outer = four + (x - end) * five
        third = three + x * outer
        second = two + x * third
        rate = slope + d * (2.0 * second + d * (third + x * (outer + x * five)))
        if not rate < 0.0:
            return guess
        x -= (f + d * (slope + d * second)) / rate
    return x
