"""Where in a rejected trial the first event lies, and how long the next trial must be; compiled by `kernel`.

A slip speed or a normal force is the cubic of its values and slopes at both ends of the trial, the margin of a sticking
contact a straight line. What the interpolation proposes is tried as a step of the method itself and then refined, so an
event inherits the method's order.
"""

# ruff: noqa: F821  (the places of the rows, FUNCTIONS and CONTACTS are generated)
# mypy: disable-error-code="name-defined,no-untyped-def"

import numpy as np

CLOSE = 1e-11  # share of the step to which an event is located


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

    The function is the cubic of its values and slopes; a margin of sticking is a straight line.
    """
    f0 = A[b + (ROW_PHI + j) * WIDTH + lane]
    f1 = A[b + (ROW_END + j) * WIDTH + lane]
    fresh = j < CONTACTS and A[b + (ROW_FRESH + j) * WIDTH + lane] > 0.0
    if not smooth(A, b, lane, j):
        if not f0 > 0.0:
            return (0.0 if f1 <= 0.0 else 2.0), False
        if f1 <= 0.0:
            return f0 / (f0 - f1), False
        return 2.0, A[b + (ROW_INNER + j) * WIDTH + lane] <= 0.0
    b1 = f0 + h * A[b + (ROW_RATE + j) * WIDTH + lane] / 3.0
    b2 = f1 - h * A[b + (ROW_RATE_END + j) * WIDTH + lane] / 3.0
    size = max(abs(b1), abs(b2), abs(f1))
    if fresh and not b1 > -1e-9 * size:
        return 0.0, False
    if not fresh and not f0 > 0.0:
        return 0.0, False
    before = 0.0
    for k in range(1, 17):
        x = k / 16.0
        if not cubic(f0, b1, b2, f1, x) > 0.0:
            return cubic_root(f0, b1, b2, f1, before, x), False
        before = x
    return 2.0, False


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
    A[b + ROW_TOLERANCE * WIDTH + lane] = CLOSE * slope
    A[b + ROW_LOW * WIDTH + lane] = 0.0
    A[b + ROW_LOW_PHI * WIDTH + lane] = f0
    A[b + ROW_HIGH * WIDTH + lane] = h
    A[b + ROW_HIGH_PHI * WIDTH + lane] = min(f1, 0.0)
    A[b + ROW_TURNS * WIDTH + lane] = 0.0
    A[b + ROW_H * WIDTH + lane] = theta * h


def refine(A, b, lane, j, h):
    """A better length of the trial that aims at an event: Newton where the slope is known, else regula falsi."""
    f = A[b + (ROW_END + j) * WIDTH + lane]
    if f > 0.0:
        A[b + ROW_LOW * WIDTH + lane] = h
        A[b + ROW_LOW_PHI * WIDTH + lane] = f
        A[b + ROW_HIGH_PHI * WIDTH + lane] *= 0.5
    else:
        A[b + ROW_HIGH * WIDTH + lane] = h
        A[b + ROW_HIGH_PHI * WIDTH + lane] = f
        A[b + ROW_LOW_PHI * WIDTH + lane] *= 0.5
    low = A[b + ROW_LOW * WIDTH + lane]
    high = A[b + ROW_HIGH * WIDTH + lane]
    f_low = A[b + ROW_LOW_PHI * WIDTH + lane]
    f_high = A[b + ROW_HIGH_PHI * WIDTH + lane]
    x = 0.5 * (low + high)
    slope = A[b + (ROW_RATE_END + j) * WIDTH + lane]
    if smooth(A, b, lane, j) and slope < 0.0:
        newton = h - f / slope
        if low < newton < high:
            x = newton
    elif f_high < 0.0:
        x = (low * f_high - high * f_low) / (f_high - f_low)
    A[b + ROW_TURNS * WIDTH + lane] += 1.0
    if A[b + ROW_TURNS * WIDTH + lane] > 60.0 or not abs(x - h) > 4e-16 * (A[b + ROW_T * WIDTH + lane] + h):
        A[b + ROW_TOLERANCE * WIDTH + lane] = np.inf
        x = h
    A[b + ROW_H * WIDTH + lane] = x
