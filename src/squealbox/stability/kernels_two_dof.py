"""Compiled answers for two degrees of freedom, from the characteristic polynomial a4 s^4 + a3 s^3 + a2 s^2 + a1 s + a0.

Growth rate and frequency: Ferrari's factorisation into two real quadratics, whose resolvent cubic is solved by Newton's
method from a bound that keeps it monotone, then refined by Bairstow's method on the polynomial itself. Stability: the
Routh-Hurwitz conditions. Sixteen systems are one packed number (see `compiled.packed`), and the last ones are filled up
with the last of all; matrices lie flat, four numbers each. Plain functions for `compiled`, which `spectra` has
translated.
"""

from typing import Any

import numpy as np

from squealbox.compiled import LANES, Lanes, columns, larger, root, select, signed, smaller, splat, store, word

TINY = 1e-300
MARGINAL = 1e-12  # growth below this share of the largest |lambda| is round-off, not growth


def entries(matrices: np.ndarray, start: int, number: int, spare: np.ndarray) -> Any:
    """The four entries of the matrices from `start` on; `spare` is room for four packed numbers."""
    if start + LANES <= number:
        return columns(matrices, start // LANES)
    for lane in range(LANES):
        place = 4 * min(start + lane, number - 1)
        for k in range(4):
            spare[4 * lane + k] = matrices[place + k]
    return columns(spare, 0)


def masses(m: np.ndarray, start: int, number: int, spare: np.ndarray) -> Any:
    """Their M; of one matrix that for all."""
    if len(m) == 4:
        return splat(m[0]), splat(m[1]), splat(m[2]), splat(m[3])
    return entries(m, start, number, spare)


def put(out: np.ndarray, start: int, number: int, value: Lanes, spare: np.ndarray) -> None:
    """Write a number of each of the systems from `start` on."""
    if start + LANES <= number:
        store(out, start // LANES, value)
    else:
        store(spare, 0, value)
        for lane in range(number - start):
            out[start + lane] = spare[lane]


def polynomial(m: tuple[Any, ...], c: tuple[Any, ...], k: tuple[Any, ...]) -> Any:
    """Coefficients a4 ... a0 of det(s^2 M + s C + K), each given by its four entries."""
    a4 = m[0] * m[3] - m[1] * m[2]
    a3 = m[0] * c[3] + c[0] * m[3] - m[1] * c[2] - c[1] * m[2]
    a2 = m[0] * k[3] + k[0] * m[3] - m[1] * k[2] - k[1] * m[2] + c[0] * c[3] - c[1] * c[2]
    a1 = c[0] * k[3] + k[0] * c[3] - c[1] * k[2] - k[1] * c[2]
    a0 = k[0] * k[3] - k[1] * k[2]
    return a4, a3, a2, a1, a0


def hurwitz_margin(a4: Lanes, a3: Lanes, a2: Lanes, a1: Lanes, a0: Lanes) -> Any:
    """Positive just where every root has a negative real part; NaN where a coefficient is."""
    sign = signed(splat(1.0), a4)
    a4, a3, a2, a1, a0 = abs(a4), a3 * sign, a2 * sign, a1 * sign, a0 * sign
    last = a1 * (a3 * a2 - a1 * a4) - a3 * a3 * a0
    return select(last == last, smaller(smaller(a3, a1), smaller(a0, last)), last)


def flags(m: np.ndarray, c: np.ndarray, k: np.ndarray, number: int, words: np.ndarray, spare: np.ndarray) -> None:
    """Bit i of word g tells whether all real parts of system 16 g + i are negative; of M one or as many."""
    for start in range(0, number, LANES):
        mass = masses(m, start, number, spare)
        damping, stiffness = entries(c, start, number, spare), entries(k, start, number, spare)
        a4, a3, a2, a1, a0 = polynomial(mass, damping, stiffness)
        words[start // LANES] = word(hurwitz_margin(a4, a3, a2, a1, a0) > splat(0.0))


def resolvent_root(p: Lanes, q: Lanes, r: Lanes) -> Any:
    """A root z >= 0 of z ((z + p)^2 - 4 r) = q^2, from s^4 + p s^2 + q s + r.

    To the right of the bound below, or left of it where the cubic is concave, Newton's iterates are monotone.
    """
    zero, tiny = splat(0.0), splat(TINY)
    square = q * q
    rise = root(larger(r, zero))
    edge = larger(2.0 * rise - p, zero)
    slope = select(edge > zero, 4.0 * edge * rise, p * p - 4.0 * r)
    curve = select(edge > zero, edge + 4.0 * rise, 2.0 * p)
    folded = (r < zero) & (p < zero)
    by_slope = square / larger(select(folded, tiny, slope), tiny)
    by_curve = abs(q) / root(larger(curve, tiny))
    z = edge + smaller(smaller(by_slope, by_curve), 1.0 + square)
    bend = -p * (2.0 / 3.0)
    left = folded & (bend * ((bend + p) * (bend + p) - 4.0 * r) > square)
    z = select(left, square / larger(p * p - 4.0 * r, tiny), z)
    for _ in range(9):
        w = z + p
        g = w * w - 4.0 * r
        z = z - (z * g - square) / larger(g + 2.0 * z * w, tiny)
    return larger(z, zero)


def rightmost_of_quadratic(p: Lanes, q: Lanes) -> Any:
    """Real and imaginary part of the root of s^2 + p s + q with the largest real part, and how many roots grow.

    A complex pair counts once.
    """
    zero, one = splat(0.0), splat(1.0)
    half = 0.5 * p
    d = half * half - q
    rise = root(abs(d))
    size = abs(half) + rise
    real = select(half > zero, -q / larger(size, splat(TINY)), size)
    real = select(d < zero, -half, real)
    both = (d >= zero) & (q > splat(MARGINAL * MARGINAL)) & (half < zero)
    growing = select(real <= splat(MARGINAL), zero, select(both, splat(2.0), one))
    return real, select(d < zero, rise, zero), growing


def factors(a4: Lanes, a3: Lanes, a2: Lanes, a1: Lanes, a0: Lanes) -> Any:
    """p1, q1, p2, q2 and a scale with quartic = a4 (s^2 + p1 s + q1)(s^2 + p2 s + q2) in s / scale."""
    zero, one, tiny = splat(0.0), splat(1.0), splat(TINY)
    inverse = one / a4
    a3, a2, a1, a0 = a3 * inverse, a2 * inverse, a1 * inverse, a0 * inverse
    scale = root(larger(a3 * a3, larger(abs(a2), root(abs(a0)))))
    t = one / larger(scale, tiny)
    a3, a2, a1, a0 = a3 * t, a2 * (t * t), a1 * (t * t) * t, a0 * (t * t) * (t * t)
    e = 0.25 * a3
    e2 = e * e
    p = a2 - 6.0 * e2
    q = a1 - 2.0 * e * a2 + 8.0 * e2 * e
    r = a0 - e * a1 + e2 * a2 - 3.0 * e2 * e2
    z = resolvent_root(p, q, r)
    total = p + z
    square = larger(total * total - 4.0 * r, zero)
    by_root = z > square  # take the well-conditioned one of s = sqrt(z), d = q/s and d = sqrt(square), s = q/d
    s, d = root(z), root(square)
    other = q / larger(select(by_root, s, d), tiny)
    s, d = select(by_root, s, other), select(by_root, other, d)
    p1, q1 = 2.0 * e + s, 0.5 * (total - d) + s * e + e2
    p2, q2 = 2.0 * e - s, 0.5 * (total + d) - s * e + e2
    for _ in range(3):
        r3, r2, r1, r0 = a3 - p1 - p2, a2 - q1 - q2 - p1 * p2, a1 - p1 * q2 - p2 * q1, a0 - q1 * q2
        dp, dq = p2 - p1, q2 - q1
        r2 = r2 - p1 * r3
        r1 = r1 - q1 * r3 - p1 * r2
        r0 = r0 - q1 * r2
        det = (dq - p1 * dp) * dq + q1 * dp * dp
        apart = abs(det) > splat(1e-200)
        over = select(apart, one / select(apart, det, one), zero)
        u, v = (r1 * dq - dp * r0) * over, ((dq - p1 * dp) * r0 + q1 * dp * r1) * over
        p1, q1, p2, q2 = p1 + u, q1 + v, p2 + r3 - u, q2 + r2 - dp * u - v
    return p1, q1, p2, q2, scale


def rightmost(a4: Lanes, a3: Lanes, a2: Lanes, a1: Lanes, a0: Lanes) -> Any:
    """Real and imaginary part of the root of the quartic with the largest real part, and how many grow."""
    p1, q1, p2, q2, scale = factors(a4, a3, a2, a1, a0)
    g1, w1, n1 = rightmost_of_quadratic(p1, q1)
    g2, w2, n2 = rightmost_of_quadratic(p2, q2)
    first = g1 >= g2
    return select(first, g1, g2) * scale, select(first, w1, w2) * scale, n1 + n2


def growth_and_frequency(
    m: np.ndarray, c: np.ndarray, k: np.ndarray, growth: np.ndarray, omega: np.ndarray,
    count: np.ndarray, spare: np.ndarray,
) -> None:  # fmt: skip
    """Largest real part, its |imaginary part| and the number of growing pairs of each system; of M one or as many."""
    number = len(growth)
    for start in range(0, number, LANES):
        mass = masses(m, start, number, spare)
        damping, stiffness = entries(c, start, number, spare), entries(k, start, number, spare)
        a4, a3, a2, a1, a0 = polynomial(mass, damping, stiffness)
        real, imaginary, growing = rightmost(a4, a3, a2, a1, a0)
        put(growth, start, number, real, spare)
        put(omega, start, number, imaginary, spare)
        put(count, start, number, growing, spare)


def between(a: tuple[Any, ...], b: tuple[Any, ...], share: Lanes) -> Any:
    """a + share (b - a) of four entries."""
    return (
        a[0] + share * (b[0] - a[0]), a[1] + share * (b[1] - a[1]), a[2] + share * (b[2] - a[2]),
        a[3] + share * (b[3] - a[3]),
    )  # fmt: skip


def growth_of_parts(
    m: np.ndarray, p: np.ndarray, c: np.ndarray, e: np.ndarray, k: np.ndarray, shares: tuple[float, float],
    growth: np.ndarray, spare: np.ndarray,
) -> None:  # fmt: skip
    """Largest real part of each system with K = E + x (K - E) and C = P + y (C - P), `shares` x and y."""
    x, y = shares
    number = len(growth)
    for start in range(0, number, LANES):
        mass = masses(m, start, number, spare)
        damping = between(entries(p, start, number, spare), entries(c, start, number, spare), splat(y))
        stiffness = between(entries(e, start, number, spare), entries(k, start, number, spare), splat(x))
        a4, a3, a2, a1, a0 = polynomial(mass, damping, stiffness)
        put(growth, start, number, rightmost(a4, a3, a2, a1, a0)[0], spare)


def roots_of(p: Lanes, q: Lanes, scale: Lanes, spare: np.ndarray, first: int) -> None:
    """Both roots of s^2 + p s + q times the scale, as four packed numbers of `spare` from `first` on."""
    zero, one = splat(0.0), splat(1.0)
    half = 0.5 * p
    d = half * half - q
    rise = root(abs(d)) * scale
    swings = d < zero
    far = select(half > zero, -half * scale - rise, rise - half * scale)
    lost = far == zero
    near = select(lost, zero, q * scale * scale / select(lost, one, far))
    store(spare, first, select(swings, -half * scale, far))
    store(spare, first + 1, select(swings, rise, zero))
    store(spare, first + 2, select(swings, -half * scale, near))
    store(spare, first + 3, select(swings, -rise, zero))


def spectrum(m: np.ndarray, c: np.ndarray, k: np.ndarray, values: np.ndarray, spare: np.ndarray) -> None:
    """All four eigenvalues of each system, values (count, 8) of real and imaginary parts; spare for eight packed."""
    number = values.shape[0]
    for start in range(0, number, LANES):
        mass = masses(m, start, number, spare)
        damping, stiffness = entries(c, start, number, spare), entries(k, start, number, spare)
        a4, a3, a2, a1, a0 = polynomial(mass, damping, stiffness)
        p1, q1, p2, q2, scale = factors(a4, a3, a2, a1, a0)
        roots_of(p1, q1, scale, spare, 0)
        roots_of(p2, q2, scale, spare, 4)
        for lane in range(min(LANES, number - start)):
            for part in range(8):
                values[start + lane, part] = spare[part * LANES + lane]
