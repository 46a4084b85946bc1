"""Compiled spectra of many small real matrices: balance, Hessenberg form by elimination, shifted QR.

The algorithms are EISPACK's balanc, elmhes and hqr (Wilkinson and Reinsch 1971, Handbook for Automatic Computation,
II/11, II/13 and II/14); one matrix at a time in a scratch array, so nothing is allocated between them. Importing this
module loads numba; only `spectra` does, when a batch is large enough.
"""

import math
from typing import Any

from numba import njit

RADIX2 = 4.0
EPS = 2.220446049250313e-16
SWEEPS = 60  # iterations on one eigenvalue before the matrix is given up


@njit(cache=True, error_model="numpy")
def balance(a: Any, n: int) -> None:
    """Scale rows and columns by powers of two until their norms agree."""
    done = False
    while not done:
        done = True
        for i in range(n):
            c = 0.0
            r = 0.0
            for j in range(n):
                if j != i:
                    c += abs(a[j, i])
                    r += abs(a[i, j])
            if c != 0.0 and r != 0.0:
                g = r / 2.0
                f = 1.0
                s = c + r
                while c < g:
                    f *= 2.0
                    c *= RADIX2
                g = r * 2.0
                while c > g:
                    f /= 2.0
                    c /= RADIX2
                if (c + r) / f < 0.95 * s:
                    done = False
                    g = 1.0 / f
                    for j in range(n):
                        a[i, j] *= g
                    for j in range(n):
                        a[j, i] *= f


@njit(cache=True, error_model="numpy")
def hessenberg(a: Any, n: int) -> None:
    """Reduce to upper Hessenberg form by elimination with pivoting; entries below the subdiagonal are set to 0."""
    for m in range(1, n - 1):
        x = 0.0
        pivot = m
        for j in range(m, n):
            if abs(a[j, m - 1]) > abs(x):
                x = a[j, m - 1]
                pivot = j
        if pivot != m:
            for j in range(m - 1, n):
                swap = a[pivot, j]
                a[pivot, j] = a[m, j]
                a[m, j] = swap
            for j in range(n):
                swap = a[j, pivot]
                a[j, pivot] = a[j, m]
                a[j, m] = swap
        if x != 0.0:
            inverse = 1.0 / x
            for i in range(m + 1, n):
                y = a[i, m - 1]
                if y != 0.0:
                    y *= inverse
                    a[i, m - 1] = 0.0
                    for j in range(m, n):
                        a[i, j] -= y * a[m, j]
                    for j in range(n):
                        a[j, m] += y * a[j, i]


@njit(cache=True, error_model="numpy")
def francis(a: Any, n: int, wr: Any, wi: Any) -> bool:
    """Eigenvalues of an upper Hessenberg matrix by double-shift QR; False when one does not converge."""
    norm = 0.0
    for i in range(n):
        for j in range(max(i - 1, 0), n):
            norm += abs(a[i, j])
    if not math.isfinite(norm):
        return False
    nn = n - 1
    t = 0.0
    while nn >= 0:
        its = 0
        while True:
            low = nn
            while low >= 1:
                s = abs(a[low - 1, low - 1]) + abs(a[low, low])
                if s == 0.0:
                    s = norm
                if abs(a[low, low - 1]) <= EPS * s:
                    a[low, low - 1] = 0.0
                    break
                low -= 1
            x = a[nn, nn]
            if low == nn:
                wr[nn] = x + t
                wi[nn] = 0.0
                nn -= 1
                break
            y = a[nn - 1, nn - 1]
            w = a[nn, nn - 1] * a[nn - 1, nn]
            if low == nn - 1:
                p = 0.5 * (y - x)
                q = p * p + w
                z = math.sqrt(abs(q))
                x += t
                if q >= 0.0:
                    z = p + (z if p >= 0.0 else -z)
                    wr[nn - 1] = x + z
                    wr[nn] = x - w / z if z != 0.0 else x + z
                    wi[nn - 1] = 0.0
                    wi[nn] = 0.0
                else:
                    wr[nn - 1] = x + p
                    wr[nn] = x + p
                    wi[nn - 1] = z
                    wi[nn] = -z
                nn -= 2
                break
            if its == SWEEPS:
                return False
            if its == 10 or its == 20:
                t += x
                for i in range(nn + 1):
                    a[i, i] -= x
                s = abs(a[nn, nn - 1]) + abs(a[nn - 1, nn - 2])
                x = 0.75 * s
                y = x
                w = -0.4375 * s * s
            its += 1
            m = nn - 2
            p = 0.0
            q = 0.0
            r = 0.0
            while m >= low:
                z = a[m, m]
                r = x - z
                s = y - z
                p = (r * s - w) / a[m + 1, m] + a[m, m + 1]
                q = a[m + 1, m + 1] - z - r - s
                r = a[m + 2, m + 1]
                scale = 1.0 / (abs(p) + abs(q) + abs(r))
                p *= scale
                q *= scale
                r *= scale
                if m == low:
                    break
                u = abs(a[m, m - 1]) * (abs(q) + abs(r))
                v = abs(p) * (abs(a[m - 1, m - 1]) + abs(z) + abs(a[m + 1, m + 1]))
                if u <= EPS * v:
                    break
                m -= 1
            for i in range(m + 2, nn + 1):
                a[i, i - 2] = 0.0
                if i != m + 2:
                    a[i, i - 3] = 0.0
            for k in range(m, nn):
                x = 1.0
                if k != m:
                    p = a[k, k - 1]
                    q = a[k + 1, k - 1]
                    r = a[k + 2, k - 1] if k != nn - 1 else 0.0
                    x = abs(p) + abs(q) + abs(r)
                    if x != 0.0:
                        scale = 1.0 / x
                        p *= scale
                        q *= scale
                        r *= scale
                s = math.sqrt(p * p + q * q + r * r)
                if p < 0.0:
                    s = -s
                if s == 0.0:
                    continue
                if k == m:
                    if low != m:
                        a[k, k - 1] = -a[k, k - 1]
                else:
                    a[k, k - 1] = -s * x
                p += s
                x = p / s
                y = q / s
                z = r / s
                scale = 1.0 / p
                q *= scale
                r *= scale
                last = min(nn, k + 3)
                if k != nn - 1:
                    for j in range(k, nn + 1):
                        p = a[k, j] + q * a[k + 1, j] + r * a[k + 2, j]
                        a[k, j] -= p * x
                        a[k + 1, j] -= p * y
                        a[k + 2, j] -= p * z
                    for i in range(low, last + 1):
                        p = x * a[i, k] + y * a[i, k + 1] + z * a[i, k + 2]
                        a[i, k] -= p
                        a[i, k + 1] -= p * q
                        a[i, k + 2] -= p * r
                else:
                    for j in range(k, nn + 1):
                        p = a[k, j] + q * a[k + 1, j]
                        a[k, j] -= p * x
                        a[k + 1, j] -= p * y
                    for i in range(low, last + 1):
                        p = x * a[i, k] + y * a[i, k + 1]
                        a[i, k] -= p
                        a[i, k + 1] -= p * q
    return True


@njit(cache=True, error_model="numpy")
def spectra(matrices: Any, scratch: Any, wr: Any, wi: Any, values: Any) -> int:
    """Eigenvalues of matrices (count, n, n) into values (count, n), NaN where QR does not converge; how many."""
    count, n = matrices.shape[0], matrices.shape[1]
    lost = 0
    for c in range(count):
        for i in range(n):
            for j in range(n):
                scratch[i, j] = matrices[c, i, j]
        balance(scratch, n)
        hessenberg(scratch, n)
        if francis(scratch, n, wr, wi):
            for i in range(n):
                values[c, i] = complex(wr[i], wi[i])
        else:
            lost += 1
            for i in range(n):
                values[c, i] = complex(math.nan, math.nan)
    return lost
