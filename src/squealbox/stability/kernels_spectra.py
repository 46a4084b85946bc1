"""Compiled spectra of many small real matrices, sixteen at a time in packed registers.

The steps are LAPACK's geev: scale, balance, Householder reduction to Hessenberg form, Francis double-shift QR. Sixteen
matrices lie side by side as one matrix of packed numbers (see `packed`), entry (i, j) at i n + j. All take every step
together; what differs between them, the window that is still coupled and its shifts, is held in packed numbers too, and
a matrix outside its window, or finished, takes part with a reflection that does nothing.

Plain functions for `compiled`, which `spectra` has translated.
"""

import math
from typing import Any

import numpy as np

from squealbox.compiled import (
    LANES,
    Lanes,
    inverse_power,
    larger,
    load,
    power_near_root,
    root,
    select,
    signed,
    some,
    splat,
    store,
)
from squealbox.stability.kernels_qr import TINY, iterate


def scale(h: np.ndarray, n: int) -> Any:
    """Scale every matrix by a power of two to a largest entry in [1, 2); returns it, NaN for a matrix not finite."""
    total, largest_entry = splat(0.0), splat(0.0)
    for place in range(n * n):
        size = abs(load(h, place))
        largest_entry = larger(size, largest_entry)
        total = total + size
    usual = (total < splat(1e300)) & ((largest_entry > splat(TINY)) | (largest_entry == splat(0.0)))
    factor = select(usual, inverse_power(largest_entry), splat(0.0))
    for place in range(n * n):
        store(h, place, select(usual, load(h, place) * factor, splat(0.0)))
    return select(usual, factor, splat(math.nan))


def balance(h: np.ndarray, n: int) -> Any:
    """Scale rows and columns by powers of two until their norms agree; returns 1 where a row or column stands alone.

    LAPACK moves such rows out of the way first, and so gets their eigenvalues exactly. That is left to LAPACK.
    """
    zero, one = splat(0.0), splat(1.0)
    alone = zero
    for _ in range(20):
        done = True
        for i in range(n):
            column, line = zero, zero
            for j in range(n):
                if j != i:
                    column = column + abs(load(h, j * n + i))
                    line = line + abs(load(h, i * n + j))
            live = (column > zero) & (line > zero)
            alone = select(live, alone, one)
            column, line = select(live, column, one), select(live, line, one)
            up = power_near_root(line / column)
            down = inverse_power(up)
            better = live & (column * up + line * down < splat(0.95) * (column + line))
            if some(better):
                done = False
                up, down = select(better, up, one), select(better, down, one)
                for j in range(n):
                    store(h, i * n + j, load(h, i * n + j) * down)
                for j in range(n):
                    store(h, j * n + i, load(h, j * n + i) * up)
        if done:
            break
    return alone


def hessenberg(h: np.ndarray, n: int, v: np.ndarray) -> None:
    """Reduce to Hessenberg form by Householder reflections I - w v v'; v is room for one vector."""
    zero, one = splat(0.0), splat(1.0)
    for m in range(n - 2):
        corner = (m + 1) * n + m
        size = n - m - 1
        x, rest = load(h, corner), zero
        for i in range(1, size):
            y = load(h, corner + i * n)
            rest = rest + y * y
            store(v, i, y)
            store(h, corner + i * n, zero)
        length = signed(root(x * x + rest), x)
        live = rest > splat(TINY)
        store(v, 0, x + length)
        weight = select(live, one / select(live, length * (x + length), one), zero)
        store(h, corner, select(live, -length, x))
        for j in range(m + 1, n):
            _reflect(h, (m + 1) * n + j, n, v, weight, size)
        for i in range(n):
            _reflect(h, i * n + m + 1, 1, v, weight, size)


def _reflect(h: np.ndarray, start: int, stride: int, v: np.ndarray, weight: Lanes, size: int) -> None:
    """x -= w (v.x) v for the entries x of h at start, start + stride, ..."""
    product = splat(0.0)
    for i in range(size):
        product = product + load(v, i) * load(h, start + i * stride)
    product = product * weight
    for i in range(size):
        store(h, start + i * stride, load(h, start + i * stride) - product * load(v, i))


def read(h: np.ndarray, n: int, real: np.ndarray, imaginary: np.ndarray) -> None:
    """The eigenvalues of the blocks on the diagonal."""
    zero, one, half = splat(0.0), splat(1.0), splat(0.5)
    store(real, 0, load(h, 0))
    store(imaginary, 0, zero)
    for i in range(1, n):
        place = i * n + i
        x, y, below = load(h, place), load(h, place - n - 1), load(h, place - 1)
        pair = abs(below) > zero
        p = half * (y - x)
        w = below * load(h, place - n)
        discriminant = p * p + w
        z = root(abs(discriminant))
        oscillates = discriminant < zero
        away = p + signed(z, p)
        at_zero = away == zero
        second = x - select(at_zero, zero, w / select(at_zero, one, away))
        omega = select(oscillates, z, zero)
        store(real, i - 1, select(pair, select(oscillates, x + p, x + away), load(real, i - 1)))
        store(imaginary, i - 1, select(pair, omega, load(imaginary, i - 1)))
        store(real, i, select(pair, select(oscillates, x + p, second), x))
        store(imaginary, i, select(pair, -omega, zero))


def spectra(
    matrices: np.ndarray, values: np.ndarray, h: np.ndarray, v: np.ndarray, real: np.ndarray, imaginary: np.ndarray
) -> None:
    """Eigenvalues of matrices (count, n, n) into values (count, n, 2), real and imaginary; NaN where left to LAPACK.

    h is room for n n packed numbers, v, real and imaginary for n each. Left are matrices that are not finite, have a
    row or column with nothing beside its diagonal, or do not converge.
    """
    number, n = matrices.shape[0], matrices.shape[1]
    for start in range(0, number, LANES):
        count = min(LANES, number - start)
        for lane in range(LANES):
            one = start + min(lane, count - 1)
            for i in range(n):
                for j in range(n):
                    h[(i * n + j) * LANES + lane] = matrices[one, i, j]
        factor = scale(h, n)
        alone = balance(h, n)
        hessenberg(h, n, v)
        lost = iterate(h, n)
        read(h, n, real, imaginary)
        back = select(alone + lost > splat(0.5), splat(math.nan), splat(1.0) / factor)
        for i in range(n):
            store(real, i, load(real, i) * back)
            store(imaginary, i, load(imaginary, i) * back)
        for lane in range(count):
            for i in range(n):
                values[start + lane, i, 0] = real[i * LANES + lane]
                values[start + lane, i, 1] = imaginary[i * LANES + lane]
