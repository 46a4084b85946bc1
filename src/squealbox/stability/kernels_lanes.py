"""Compiled spectra of many small real matrices, sixteen at a time on packed registers.

The steps are LAPACK's: balance, Householder reduction to Hessenberg form, Francis double-shift QR. Sixteen matrices lie
side by side, entry (i, j) of all of them at (i n + j) 16, and a reflection is applied to all at once. What differs
between them, the window that is still coupled and its shifts, is settled by a scalar pass between two sweeps; a matrix
outside its window, or finished, takes part with a reflection that does nothing.

The innermost operations are those of `lanes`. Importing this module loads numba; only `spectra` does.
"""

import math
from typing import Any

import numpy as np
from numba import njit

from squealbox.stability.lanes import EPS, LANES, add_product, reflect, reflectors, subtract_scaled, window_starts

SWEEPS = 60  # QR sweeps on one eigenvalue before the matrix is given up
FAST = {"contract", "nsz", "arcp", "reassoc", "afn"}  # not nnan or ninf: they would remove the tests for lost lanes


@njit(error_model="numpy", fastmath=FAST)
def hessenberg(h: Any, n: int, v: Any, s: Any) -> None:
    """Householder reduction of all lanes; v holds the vector, s sums and scales."""
    row, entry = n * LANES, LANES
    for m in range(n - 2):
        size = n - m - 1
        corner = (m + 1) * row + m * entry
        add_product(s, 0, h, corner + row, h, corner + row, row, row, size - 1)
        for lane in range(LANES):
            x, rest = h[corner + lane], s[lane]
            length = math.sqrt(x * x + rest)
            alpha = -length if x > 0.0 else length
            live = rest > 0.0
            u = x - alpha
            v[lane] = u
            s[LANES + lane] = 2.0 / (u * u + rest) if live else 0.0
            s[2 * LANES + lane] = alpha if live else x
        for i in range(1, size):
            for lane in range(LANES):
                v[i * LANES + lane] = h[corner + i * row + lane]
        for lane in range(LANES):
            h[corner + lane] = s[2 * LANES + lane]
        for i in range(1, size):
            for lane in range(LANES):
                h[corner + i * row + lane] = 0.0
        for j in range(m + 1, n):
            start = (m + 1) * row + j * entry
            add_product(s, 0, v, 0, h, start, entry, row, size)
            for lane in range(LANES):
                s[lane] *= s[LANES + lane]
            subtract_scaled(h, start, row, v, 0, s, 0, size)
        for i in range(n):
            start = i * row + (m + 1) * entry
            add_product(s, 0, v, 0, h, start, entry, entry, size)
            for lane in range(LANES):
                s[lane] *= s[LANES + lane]
            subtract_scaled(h, start, entry, v, 0, s, 0, size)


@njit(error_model="numpy", fastmath=FAST)
def settle(h: Any, n: int, lane: int, state: Any, start: int, shifts: Any, values: Any, row_of: int) -> bool:
    """Write the eigenvalues of one lane that have split off, and prepare its next window; True while it has one.

    state (3, lanes): last row of the window, first row, sweeps; `start` is the first row found for that last row;
    values[row_of] takes the eigenvalues.
    """
    row = n * LANES
    last = state[0, lane]
    low = start
    while last >= 0:
        if low < 0:
            low = last
            while low >= 1:
                size = abs(h[(low - 1) * row + (low - 1) * LANES + lane]) + abs(h[low * row + low * LANES + lane])
                if abs(h[low * row + (low - 1) * LANES + lane]) <= EPS * size:
                    break
                low -= 1
        x = h[last * row + last * LANES + lane]
        if low == last:
            values[row_of, last] = complex(x, 0.0)
            last -= 1
            low = -1
            state[2, lane] = 0
            continue
        y = h[(last - 1) * row + (last - 1) * LANES + lane]
        w = h[last * row + (last - 1) * LANES + lane] * h[(last - 1) * row + last * LANES + lane]
        if low == last - 1:
            p = 0.5 * (y - x)
            q = p * p + w
            z = math.sqrt(abs(q))
            if q >= 0.0:
                z = p + (z if p >= 0.0 else -z)
                values[row_of, last - 1] = complex(x + z, 0.0)
                values[row_of, last] = complex(x - w / z if z != 0.0 else x + z, 0.0)
            else:
                values[row_of, last - 1] = complex(x + p, z)
                values[row_of, last] = complex(x + p, -z)
            last -= 2
            low = -1
            state[2, lane] = 0
            continue
        state[2, lane] += 1
        if state[2, lane] > SWEEPS or not abs(x) < 1e300:
            for i in range(last + 1):
                values[row_of, i] = complex(math.nan, math.nan)
            last = -1
            break
        if state[2, lane] % 10 == 0:
            size = abs(h[last * row + (last - 1) * LANES + lane]) + abs(h[(last - 1) * row + (last - 2) * LANES + lane])
            x += 0.75 * size
            y = x
            w = -0.4375 * size * size
        corner = low * row + low * LANES + lane
        z = h[corner]
        r, s = x - z, y - z
        shifts[lane] = (r * s - w) / h[corner + row] + h[corner + LANES]
        shifts[LANES + lane] = h[corner + row + LANES] - z - r - s
        shifts[2 * LANES + lane] = h[corner + 2 * row + LANES]
        state[0, lane], state[1, lane] = last, low
        return True
    state[0, lane], state[1, lane] = -1, n
    return False


@njit(error_model="numpy", fastmath=FAST)
def mirror(f: Any) -> None:
    """Exchange the two triples of f: the columns take the transposed reflection."""
    for i in range(3 * LANES):
        swap = f[i]
        f[i] = f[3 * LANES + i]
        f[3 * LANES + i] = swap


@njit(error_model="numpy", fastmath=FAST)
def francis(h: Any, n: int, count: int, state: Any, ends: Any, shifts: Any, f: Any, values: Any, start: int) -> None:
    """QR sweeps until every lane has all its eigenvalues."""
    row = n * LANES
    for lane in range(LANES):
        state[0, lane] = n - 1 if lane < count else -1
        state[1, lane] = n
        state[2, lane] = 0
    while True:
        for lane in range(LANES):
            ends[lane] = float(state[0, lane])
        window_starts(h, LANES, row, n, ends)
        top, bottom = -1, n
        for lane in range(count):
            if state[0, lane] >= 0 and settle(h, n, lane, state, int(ends[LANES + lane]), shifts, values, start + lane):
                top, bottom = max(top, state[0, lane]), min(bottom, state[1, lane])
        if top < 0:
            return
        for lane in range(LANES):
            ends[lane], ends[LANES + lane] = float(state[0, lane]), float(state[1, lane])
        for k in range(bottom, top):
            column = k * row + max(k - 1, 0) * LANES
            third = min(k + 2, n - 1) * row + max(k - 1, 0) * LANES
            reflectors(h, column, row, third, float(k), ends, shifts, f)
            width = 3 if k < top - 1 else 2
            reflect(h, k * row + k * LANES, row, LANES, top + 1 - k, width, f)
            mirror(f)
            reflect(h, bottom * row + k * LANES, LANES, row, min(top, k + 3) + 1 - bottom, width, f)


@njit(error_model="numpy")
def balance(a: Any, n: int) -> None:
    """Scale rows and columns by powers of two until their norms agree."""
    done = False
    while not done:
        done = True
        for i in range(n):
            c = 0.0
            r = 0.0
            for j in range(n):
                c += abs(a[j, i])
                r += abs(a[i, j])
            c -= abs(a[i, i])
            r -= abs(a[i, i])
            if not (c > 0.0 and r > 0.0 and c < 1e300 and r < 1e300):
                continue
            f = 1.0
            s = c + r
            while c < r / 2.0:
                f *= 2.0
                c *= 4.0
            while c > r * 2.0:
                f /= 2.0
                c /= 4.0
            if (c + r) / f < 0.95 * s:
                done = False
                for j in range(n):
                    a[i, j] /= f
                for j in range(n):
                    a[j, i] *= f


@njit(cache=True, error_model="numpy")
def spectra(matrices: Any, values: Any) -> None:
    """Eigenvalues of matrices (count, n, n) into values (count, n); NaN where QR does not converge."""
    number, n = matrices.shape[0], matrices.shape[1]
    a = np.empty((n, n))
    h = np.zeros(n * n * LANES)
    v = np.zeros(max(n, 8) * LANES)
    s = np.zeros(3 * LANES)
    shifts = np.zeros(3 * LANES)
    ends = np.zeros(2 * LANES)
    f = np.zeros(6 * LANES)
    state = np.zeros((3, LANES), dtype=np.int64)
    for start in range(0, number, LANES):
        count = min(LANES, number - start)
        for lane in range(count):
            a[:, :] = matrices[start + lane]
            balance(a, n)
            for i in range(n):
                for j in range(n):
                    h[(i * n + j) * LANES + lane] = a[i, j]
        hessenberg(h, n, v, s)
        francis(h, n, count, state, ends, shifts, f, values, start)
