"""Roots of polynomials through what is known of an event function; compiled by `kernel`."""

# mypy: disable-error-code="no-untyped-def"

import numpy as np


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


def quartic_root(x, f):
    """Where the quartic through five points, its last value negative, first turns negative: Newton from the chord."""
    k = 1
    while k < 4 and f[k] > 0.0:
        k += 1
    low, high = x[k - 1], x[k]
    d01, d12, d23, d34 = f[1] - f[0], f[2] - f[1], f[3] - f[2], f[4] - f[3]
    d01, d12, d23, d34 = d01 / (x[1] - x[0]), d12 / (x[2] - x[1]), d23 / (x[3] - x[2]), d34 / (x[4] - x[3])
    e0, e1, e2 = (d12 - d01) / (x[2] - x[0]), (d23 - d12) / (x[3] - x[1]), (d34 - d23) / (x[4] - x[2])
    g0, g1 = (e1 - e0) / (x[3] - x[0]), (e2 - e1) / (x[4] - x[1])
    top = (g1 - g0) / (x[4] - x[0])
    guess = low + (high - low) * f[k - 1] / (f[k - 1] - f[k])
    at = guess
    for _ in range(4):
        a, b, c, d = at - x[0], at - x[1], at - x[2], at - x[3]
        three = g0 + d * top
        two = e0 + c * three
        one = d01 + b * two
        rate = one + a * (two + b * (three + c * top))
        if not rate < 0.0:
            return guess
        at -= (f[0] + a * one) / rate
    return at if low < at < high else guess
