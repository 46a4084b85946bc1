"""The order of a spectrum: conjugates apart, real eigenvalues in halves."""

from typing import Any

import numpy as np


def spectrum_order(eigenvalues: np.ndarray) -> Any:
    """Indices that put Im >= 0 first, ascending in |Im|, and then the conjugates; shape (..., 2n).

    |Im| that agree to 1e-10 of the largest |lambda| count as equal and are ordered by falling growth rate, so that
    coalesced modes come out in the same order whatever the round-off.
    """
    shape, count = eigenvalues.shape, eigenvalues.shape[-1]
    if eigenvalues.size == 0:
        return np.zeros(shape, dtype=int)
    flat = eigenvalues.reshape(-1, count)
    scale = np.max(np.abs(flat), axis=-1, keepdims=True)
    by_size = np.argsort(np.abs(flat.imag), axis=-1, kind="stable")
    sizes = np.take_along_axis(np.abs(flat.imag), by_size, axis=-1)
    steps = np.diff(sizes, axis=-1, prepend=sizes[:, :1]) > 1e-10 * scale
    group = np.empty_like(by_size)
    np.put_along_axis(group, by_size, np.cumsum(steps, axis=-1), axis=-1)
    side = np.where(flat.imag == 0.0, halves(flat), flat.imag < 0.0)
    return np.lexsort((-flat.real, group, side), axis=-1).reshape(shape)


def halves(flat: np.ndarray) -> Any:
    """For real eigenvalues: 0 for the larger half of them (one more of an odd number), 1 for the smaller half."""
    real = flat.imag == 0.0
    rank = np.argsort(np.argsort(np.where(real, -flat.real, np.inf), axis=-1, kind="stable"), axis=-1, kind="stable")
    return rank >= (np.sum(real, axis=-1, keepdims=True) + 1) // 2
