"""Francis double-shift QR on sixteen real Hessenberg matrices at once, each on a window of its own.

Row and column indices that differ between the matrices are packed numbers; a choice by mask takes the place of a
branch. Blocks that have split off are left alone, since only eigenvalues are wanted; the entries between them mean
nothing.
"""

from typing import Any

import numpy as np

from squealbox.compiled import Lanes, inverse_power, larger, largest, load, root, select, signed, some, splat, store

EPS = 2.220446049250313e-16
TINY = 1e-290  # of a matrix whose largest entry is about 1: nothing
SWEEPS = 60  # QR sweeps on one window before the matrix is given up


def windows(h: np.ndarray, n: int, top: int) -> Any:
    """Set negligible subdiagonals to zero; last and first row of each matrix's lowest window of three rows or more.

    -1 and 0 where there is none. Negligible is what LAPACK's lahqr calls so: |h(i, i-1)| below round-off of its two
    neighbours on the diagonal, and so small beside h(i-1, i) that graded matrices keep their small eigenvalues.
    """
    zero, one, eps = splat(0.0), splat(1.0), splat(EPS)
    size, last, low = zero, splat(-1.0), zero
    row = splat(float(top))
    diagonal = load(h, top * n + top)
    for i in range(top, 0, -1):
        before = load(h, (i - 1) * n + i - 1)
        place = i * n + i - 1
        below = abs(load(h, place))
        small = below <= eps * (abs(before) + abs(diagonal))
        if some(small):
            beside = abs(load(h, place - n + 1))
            coupling = below * beside <= eps * abs(diagonal) * abs(before - diagonal)
            small = small & (coupling | (below * larger(below, beside) <= splat(TINY)))
            store(h, place, select(small, zero, load(h, place)))
        size = size + one
        found = small & (size > splat(2.5)) & (last < zero)
        low, last = select(found, row, low), select(found, row + size - one, last)
        size = select(small, zero, size)
        row, diagonal = row - one, before
    found = (size > splat(1.5)) & (last < zero)
    return select(found, size, last), low


def shifts(h: np.ndarray, n: int, top: int, bottom: int, last: Lanes, low: Lanes, sweeps: Lanes) -> Any:
    """First column (p, q, r) of (H - s1)(H - s2), both shifts the eigenvalues of the window's last 2 x 2 block.

    After each ten sweeps on one window LAPACK's exceptional shift is taken instead.
    """
    zero = splat(0.0)
    a, b, c, d, e = zero, zero, zero, zero, zero  # the window's first entries (0,0), (0,1), (1,0), (1,1), (2,1)
    x, y, w, size = zero, zero, zero, zero  # its last diagonal entries, the product beside them, the size below
    row = splat(float(bottom))
    for i in range(bottom, top + 1):
        place = i * n + i
        if i <= top - 2:
            here = low == row
            a, b = select(here, load(h, place), a), select(here, load(h, place + 1), b)
            c, d = select(here, load(h, place + n), c), select(here, load(h, place + n + 1), d)
            e = select(here, load(h, place + 2 * n + 1), e)
        if i >= bottom + 2:
            here = last == row
            below = load(h, place - 1)
            x, y = select(here, load(h, place), x), select(here, load(h, place - n - 1), y)
            w = select(here, below * load(h, place - n), w)
            size = select(here, abs(below) + abs(load(h, place - n - 2)), size)
        row = row + splat(1.0)
    tens = (sweeps == splat(10.0)) | (sweeps == splat(20.0)) | (sweeps == splat(30.0)) | (sweeps == splat(40.0))
    x = select(tens, x + splat(0.75) * size, x)
    y = select(tens, x, y)
    w = select(tens, splat(-0.4375) * size * size, w)
    return (a - x) * (a - y) - w + b * c, c * (a + d - x - y), c * e


def sweep(
    h: np.ndarray, n: int, top: int, bottom: int, last: Lanes, low: Lanes, column: tuple[Lanes, Lanes, Lanes]
) -> None:
    """One implicit double-shift QR sweep of every matrix over its own window, inside rows bottom to top.

    column : the first one of both shifts, as `shifts` gives it
    """
    p, q, r = column
    zero, one = splat(0.0), splat(1.0)
    row = splat(float(bottom))
    for k in range(bottom, top):
        corner = k * n + max(k - 1, 0)
        third = min(k + 2, n - 1) * n + max(k - 1, 0)
        old, old_below, old_third = load(h, corner), load(h, corner + n), load(h, third)
        first = low == row
        inside = (row >= low) & (row < last)
        inner = inside & (row > low)
        three = row + one < last
        p, q = select(first, p, old), select(first, q, old_below)
        r = select(three, select(first, r, old_third), zero)
        size = abs(p) + abs(q) + abs(r)
        live = inside & (size > splat(TINY))
        power = inverse_power(size)
        p, q, r = p * power, q * power, r * power
        length = signed(root(p * p + q * q + r * r), p)
        u = p + length
        weight = select(live, one / select(live, length * u, one), zero)
        store(h, third, select(inner & three, zero, old_third))
        store(h, corner + n, select(inner, zero, old_below))
        store(h, corner, select(inner & live, -length * inverse_power(power), old))
        f, g, s = weight * u, weight * q, weight * r
        last_row = min(top, k + 3)
        if k < top - 1:
            for j in range(k, top + 1):
                _turn_three(h, k * n + j, n, (f, g, s), (u, q, r))
            for i in range(last_row, bottom - 1, -1):  # what the next reflection waits for comes first
                _turn_three(h, i * n + k, 1, (f, g, s), (u, q, r))
        else:
            for j in range(k, top + 1):
                _turn_two(h, k * n + j, n, f, g, u, q)
            for i in range(last_row, bottom - 1, -1):
                _turn_two(h, i * n + k, 1, f, g, u, q)
        row = row + one


def _turn_three(
    h: np.ndarray, place: int, apart: int, weighted: tuple[Lanes, Lanes, Lanes], normal: tuple[Lanes, Lanes, Lanes]
) -> None:
    x, y, z = load(h, place), load(h, place + apart), load(h, place + 2 * apart)
    f, g, s = weighted
    u, q, r = normal
    t = f * x + g * y + s * z
    store(h, place, x - t * u)
    store(h, place + apart, y - t * q)
    store(h, place + 2 * apart, z - t * r)


def _turn_two(h: np.ndarray, place: int, apart: int, f: Lanes, g: Lanes, u: Lanes, q: Lanes) -> None:
    x, y = load(h, place), load(h, place + apart)
    t = f * x + g * y
    store(h, place, x - t * u)
    store(h, place + apart, y - t * q)


def iterate(h: np.ndarray, n: int) -> Any:
    """QR sweeps until every matrix has blocks of one and two rows only; returns 1 where that did not come about."""
    zero, one, none = splat(0.0), splat(1.0), splat(-1.0)
    lost, sweeps, last = zero, zero, splat(float(n))
    top = n - 1
    while True:
        before = last
        last, low = windows(h, n, top)
        last = select(lost > zero, none, last)
        sweeps = select(last < before, zero, sweeps + one)
        late = (sweeps > splat(float(SWEEPS))) & (last >= zero)
        lost, last = select(late, one, lost), select(late, none, last)
        top = int(largest(last))
        if top < 0:
            return lost
        bottom = -int(largest(select(last < zero, splat(-float(n)), -low)))
        sweep(h, n, top, bottom, last, low, shifts(h, n, top, bottom, last, low, sweeps))
