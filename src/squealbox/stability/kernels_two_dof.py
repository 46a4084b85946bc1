"""Compiled answers for two degrees of freedom, from the characteristic polynomial a4 s^4 + a3 s^3 + a2 s^2 + a1 s + a0.

Growth rate and frequency: Ferrari's factorisation into two real quadratics, whose resolvent cubic is solved by Newton's
method from a bound that keeps it monotone, then refined by Bairstow's method on the polynomial itself. Stability: the
Routh-Hurwitz conditions, in blocks of a fixed length so that the loop runs on packed registers. Importing this module
loads numba; only `spectra` does, when a batch is large enough.
"""

import math
from typing import Any

import numpy as np
from numba import njit

FAST = {"contract", "nsz", "arcp", "reassoc", "afn"}  # not nnan or ninf: they would remove the tests for lost points
BLOCK = 64
TINY = 1e-300
MARGINAL = 1e-12  # growth below this share of the largest |lambda| is round-off, not growth


@njit(forceinline=True, error_model="numpy", fastmath=FAST)
def polynomial(m: Any, c: Any, k: Any, j: int, i: int) -> Any:
    """Coefficients a4 ... a0 of det(s^2 M + s C + K); the matrices lie flat, M's at j and the others' at i."""
    a4 = m[j] * m[j + 3] - m[j + 1] * m[j + 2]
    a3 = m[j] * c[i + 3] + c[i] * m[j + 3] - m[j + 1] * c[i + 2] - c[i + 1] * m[j + 2]
    a2 = m[j] * k[i + 3] + k[i] * m[j + 3] - m[j + 1] * k[i + 2] - k[i + 1] * m[j + 2]
    a2 += c[i] * c[i + 3] - c[i + 1] * c[i + 2]
    a1 = c[i] * k[i + 3] + k[i] * c[i + 3] - c[i + 1] * k[i + 2] - k[i + 1] * c[i + 2]
    a0 = k[i] * k[i + 3] - k[i + 1] * k[i + 2]
    return a4, a3, a2, a1, a0


@njit(forceinline=True, error_model="numpy", fastmath=FAST)
def hurwitz_margin(a4: float, a3: float, a2: float, a1: float, a0: float) -> float:
    """Positive just where every root has a negative real part."""
    inverse = 1.0 / a4
    a3, a2, a1, a0 = a3 * inverse, a2 * inverse, a1 * inverse, a0 * inverse
    return min(min(a3, a1), min(a0, a1 * (a3 * a2 - a1) - a3 * a3 * a0))


@njit(cache=True, error_model="numpy", fastmath=FAST)
def flags_shared_mass(m: Any, c: Any, k: Any, out: Any) -> None:
    """out[i] = 1 where all real parts are negative, else 0; one M for all."""
    margin = np.empty(BLOCK)
    mass = (m[0], m[1], m[2], m[3])
    full = len(out) // BLOCK
    for block in range(full):
        start = block * BLOCK
        for b in range(BLOCK):
            i = 4 * (start + b)
            a4, a3, a2, a1, a0 = polynomial(mass, c, k, 0, i)
            margin[b] = hurwitz_margin(a4, a3, a2, a1, a0)
        for b in range(BLOCK):
            out[start + b] = margin[b] > 0.0
    for i in range(full * BLOCK, len(out)):
        a4, a3, a2, a1, a0 = polynomial(mass, c, k, 0, 4 * i)
        out[i] = hurwitz_margin(a4, a3, a2, a1, a0) > 0.0


@njit(cache=True, error_model="numpy", fastmath=FAST)
def flags_own_mass(m: Any, c: Any, k: Any, out: Any) -> None:
    """out[i] = 1 where all real parts are negative, else 0; an M for each."""
    margin = np.empty(BLOCK)
    full = len(out) // BLOCK
    for block in range(full):
        start = block * BLOCK
        for b in range(BLOCK):
            i = 4 * (start + b)
            a4, a3, a2, a1, a0 = polynomial(m, c, k, i, i)
            margin[b] = hurwitz_margin(a4, a3, a2, a1, a0)
        for b in range(BLOCK):
            out[start + b] = margin[b] > 0.0
    for i in range(full * BLOCK, len(out)):
        a4, a3, a2, a1, a0 = polynomial(m, c, k, 4 * i, 4 * i)
        out[i] = hurwitz_margin(a4, a3, a2, a1, a0) > 0.0


@njit(forceinline=True, error_model="numpy", fastmath=FAST)
def resolvent_root(p: float, q: float, r: float) -> float:
    """A root z >= 0 of z ((z + p)^2 - 4 r) = q^2, from s^4 + p s^2 + q s + r.

    To the right of the bound below, or left of it where the cubic is concave, Newton's iterates are monotone.
    """
    square = q * q
    root = math.sqrt(max(r, 0.0))
    edge = max(0.0, 2.0 * root - p)
    slope = 4.0 * edge * root if edge > 0.0 else p * p - 4.0 * r
    curve = edge + 4.0 * root if edge > 0.0 else 2.0 * p
    folded = (r < 0.0) & (p < 0.0)
    by_slope = square / max(TINY if folded else slope, TINY)
    by_curve = abs(q) / math.sqrt(max(curve, TINY))
    z = edge + min(min(by_slope, by_curve), 1.0 + square)
    bend = -p * (2.0 / 3.0)
    left = folded & (bend * ((bend + p) * (bend + p) - 4.0 * r) > square)
    z = square / max(p * p - 4.0 * r, TINY) if left else z
    for _ in range(9):
        w = z + p
        g = w * w - 4.0 * r
        z -= (z * g - square) / max(g + 2.0 * z * w, TINY)
    return max(z, 0.0)


@njit(forceinline=True, error_model="numpy", fastmath=FAST)
def rightmost_of_quadratic(p: float, q: float) -> Any:
    """Real and imaginary part of the root of s^2 + p s + q with the largest real part, and how many roots grow.

    A complex pair counts once.
    """
    half = 0.5 * p
    d = half * half - q
    root = math.sqrt(abs(d))
    size = abs(half) + root
    real = -q / max(size, TINY) if half > 0.0 else size
    real = -half if d < 0.0 else real
    both = (d >= 0.0) & (q > MARGINAL * MARGINAL) & (half < 0.0)
    growing = 0.0 if real <= MARGINAL else (2.0 if both else 1.0)
    return real, (root if d < 0.0 else 0.0), growing


@njit(forceinline=True, error_model="numpy", fastmath=FAST)
def factors(a4: float, a3: float, a2: float, a1: float, a0: float) -> Any:
    """p1, q1, p2, q2 and a scale with quartic = a4 (s^2 + p1 s + q1)(s^2 + p2 s + q2) in s / scale."""
    inverse = 1.0 / a4
    a3, a2, a1, a0 = a3 * inverse, a2 * inverse, a1 * inverse, a0 * inverse
    scale = math.sqrt(max(a3 * a3, max(abs(a2), math.sqrt(abs(a0)))))
    t = 1.0 / max(scale, TINY)
    a3, a2, a1, a0 = a3 * t, a2 * (t * t), a1 * (t * t) * t, a0 * (t * t) * (t * t)
    e = 0.25 * a3
    e2 = e * e
    p = a2 - 6.0 * e2
    q = a1 - 2.0 * e * a2 + 8.0 * e2 * e
    r = a0 - e * a1 + e2 * a2 - 3.0 * e2 * e2
    z = resolvent_root(p, q, r)
    total = p + z
    square = max(total * total - 4.0 * r, 0.0)
    by_root = z > square  # take the well-conditioned one of s = sqrt(z), d = q/s and d = sqrt(square), s = q/d
    s, d = math.sqrt(z), math.sqrt(square)
    other = q / max(s if by_root else d, TINY)
    s, d = (s if by_root else other), (other if by_root else d)
    p1, q1 = 2.0 * e + s, 0.5 * (total - d) + s * e + e2
    p2, q2 = 2.0 * e - s, 0.5 * (total + d) - s * e + e2
    for _ in range(3):
        r3, r2, r1, r0 = a3 - p1 - p2, a2 - q1 - q2 - p1 * p2, a1 - p1 * q2 - p2 * q1, a0 - q1 * q2
        dp, dq = p2 - p1, q2 - q1
        r2 -= p1 * r3
        r1 -= q1 * r3 + p1 * r2
        r0 -= q1 * r2
        det = (dq - p1 * dp) * dq + q1 * dp * dp
        over = 1.0 / det if abs(det) > 1e-200 else 0.0
        u, v = (r1 * dq - dp * r0) * over, ((dq - p1 * dp) * r0 + q1 * dp * r1) * over
        p1, q1, p2, q2 = p1 + u, q1 + v, p2 + r3 - u, q2 + r2 - dp * u - v
    return p1, q1, p2, q2, scale


@njit(forceinline=True, error_model="numpy", fastmath=FAST)
def rightmost(a4: float, a3: float, a2: float, a1: float, a0: float) -> Any:
    """Real and imaginary part of the root of the quartic with the largest real part, and how many grow."""
    p1, q1, p2, q2, scale = factors(a4, a3, a2, a1, a0)
    g1, w1, n1 = rightmost_of_quadratic(p1, q1)
    g2, w2, n2 = rightmost_of_quadratic(p2, q2)
    first = g1 >= g2
    return (g1 if first else g2) * scale, (w1 if first else w2) * scale, n1 + n2


@njit(forceinline=True, error_model="numpy", fastmath=FAST)
def solve_block(a: Any, out: Any) -> None:
    """The quartics of a block, a (5, BLOCK), into out (3, BLOCK): a loop of fixed length over contiguous rows."""
    for b in range(BLOCK):
        out[0, b], out[1, b], out[2, b] = rightmost(a[0, b], a[1, b], a[2, b], a[3, b], a[4, b])


@njit(cache=True, error_model="numpy", fastmath=FAST)
def growth_and_frequency(m: Any, c: Any, k: Any, stride: int, growth: Any, omega: Any, count: Any) -> None:
    """Largest real part, its |imaginary part| and the number of growing pairs of each system.

    `stride` is 0 when M is shared, else 4. The last block is filled up with its last system.
    """
    a = np.empty((5, BLOCK))
    out = np.empty((3, BLOCK))
    number = len(growth)
    for start in range(0, number, BLOCK):
        for b in range(BLOCK):
            i = min(start + b, number - 1)
            a[0, b], a[1, b], a[2, b], a[3, b], a[4, b] = polynomial(m, c, k, stride * i, 4 * i)
        solve_block(a, out)
        for b in range(min(BLOCK, number - start)):
            growth[start + b] = out[0, b]
            omega[start + b] = out[1, b]
            count[start + b] = out[2, b]


@njit(forceinline=True, error_model="numpy", fastmath=FAST)
def polynomial_of_part(m: Any, p: Any, c: Any, e: Any, k: Any, j: int, i: int, x: float, y: float) -> Any:
    """`polynomial` with K = E + x (K - E) and C = P + y (C - P)."""
    mass = (m[j], m[j + 1], m[j + 2], m[j + 3])
    damping = (
        p[i] + y * (c[i] - p[i]),
        p[i + 1] + y * (c[i + 1] - p[i + 1]),
        p[i + 2] + y * (c[i + 2] - p[i + 2]),
        p[i + 3] + y * (c[i + 3] - p[i + 3]),
    )
    stiffness = (
        e[i] + x * (k[i] - e[i]),
        e[i + 1] + x * (k[i + 1] - e[i + 1]),
        e[i + 2] + x * (k[i + 2] - e[i + 2]),
        e[i + 3] + x * (k[i + 3] - e[i + 3]),
    )
    return polynomial(mass, damping, stiffness, 0, 0)


@njit(cache=True, error_model="numpy", fastmath=FAST)
def growth_of_parts(m: Any, p: Any, c: Any, e: Any, k: Any, stride: int, x: float, y: float, growth: Any) -> None:
    """Largest real part of each system with K = E + x (K - E) and C = P + y (C - P)."""
    a = np.empty((5, BLOCK))
    out = np.empty((3, BLOCK))
    number = len(growth)
    for start in range(0, number, BLOCK):
        for b in range(BLOCK):
            i = min(start + b, number - 1)
            a[0, b], a[1, b], a[2, b], a[3, b], a[4, b] = polynomial_of_part(m, p, c, e, k, stride * i, 4 * i, x, y)
        solve_block(a, out)
        for b in range(min(BLOCK, number - start)):
            growth[start + b] = out[0, b]


@njit(cache=True, error_model="numpy", fastmath=FAST)
def spectrum(m: Any, c: Any, k: Any, stride: int, values: Any) -> None:
    """All four eigenvalues of each system, values (count, 4): two roots of each quadratic factor."""
    a = np.empty((5, BLOCK))
    out = np.empty((5, BLOCK))
    number = len(values)
    for start in range(0, number, BLOCK):
        for b in range(BLOCK):
            i = min(start + b, number - 1)
            a[0, b], a[1, b], a[2, b], a[3, b], a[4, b] = polynomial(m, c, k, stride * i, 4 * i)
        for b in range(BLOCK):
            out[0, b], out[1, b], out[2, b], out[3, b], out[4, b] = factors(a[0, b], a[1, b], a[2, b], a[3, b], a[4, b])
        for b in range(min(BLOCK, number - start)):
            for pair in range(2):
                half, q, scale = 0.5 * out[2 * pair, b], out[2 * pair + 1, b], out[4, b]
                d = half * half - q
                root = math.sqrt(abs(d)) * scale
                place = start + b
                if d < 0.0:
                    values[place, 2 * pair] = complex(-half * scale, root)
                    values[place, 2 * pair + 1] = complex(-half * scale, -root)
                else:
                    far = -half * scale - root if half > 0.0 else -half * scale + root
                    near = q * scale * scale / far if far != 0.0 else far
                    values[place, 2 * pair] = complex(far, 0.0)
                    values[place, 2 * pair + 1] = complex(near, 0.0)
