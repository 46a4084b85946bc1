"""Spectra of many systems whose bodies move together freely: the common motion is projected out, all in one call.

Where K R = C R = 0 and R' K = R' C = 0 with M symmetric, the motion splits exactly into the common one, R' M q, whose
eigenvalues are zero, and the rest q = Z y with R' M Z = 0:

    y'' + Z' M^-1 C Z y' + Z' M^-1 K Z y = 0,   Z' Z = 1.

`deflation` solves those, one by one, that do not split so.
"""

from typing import Any

import numpy as np

FELT = 1e-13  # share of the largest entry below which a motion is not felt


def free_body_spectra(
    mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray, floating: np.ndarray
) -> tuple[Any, Any]:
    """Eigenvalues (k, 2n) of k systems in no order, and which of the systems are answered, (k,).

    Answered are those in which the common motions of the first system, `floating[0]` of them, are all there are.
    """
    size, count = mass.shape[-1], int(floating[0])
    values = np.zeros((len(mass), 2 * size), dtype=complex)
    both = np.vstack([stiffness[0], stiffness[0].T]) / _largest(stiffness[0])
    motion: Any = np.linalg.svd(both)[2][size - count :].T
    unfelt = np.asarray(floating == count)
    for part in (stiffness, damping):
        small = FELT * size * _largest(part)
        unfelt = unfelt & np.all(np.abs(part @ motion) <= small, axis=(-1, -2))
        unfelt = unfelt & np.all(np.abs(motion.T @ part) <= small, axis=(-1, -2))
    unfelt &= np.all(np.abs(mass - np.swapaxes(mass, -1, -2)) <= FELT * _largest(mass), axis=(-1, -2))
    unfelt &= np.linalg.cond(mass, 1) < 1.0 / np.finfo(float).eps
    if count == size or not np.any(unfelt):
        return values, unfelt
    mass, damping, stiffness = (part[unfelt] for part in (mass, damping, stiffness))
    rest = np.swapaxes(np.linalg.svd(np.swapaxes(mass @ motion, -1, -2))[2][..., count:, :], -1, -2)
    left = np.swapaxes(rest, -1, -2)
    by_q, by_v = (left @ np.linalg.solve(mass, part @ rest) for part in (stiffness, damping))
    rate = np.maximum(np.sqrt(_largest(by_q)), _largest(by_v))
    rate = np.where(np.isfinite(rate) & (rate > 0.0), rate, 1.0)
    matrix = np.zeros((len(by_q), 2 * (size - count), 2 * (size - count)))
    matrix[:, : size - count, size - count :] = np.eye(size - count)
    matrix[:, size - count :, : size - count] = -by_q / rate**2
    matrix[:, size - count :, size - count :] = -by_v / rate
    values[unfelt, 2 * count :] = np.linalg.eigvals(matrix) * rate[:, 0]
    return values, unfelt


def _largest(matrix: np.ndarray) -> Any:
    """The largest entry, with axes to divide by; 1 where there is none."""
    size = np.max(np.abs(matrix), axis=(-1, -2), keepdims=True)
    return np.where(size > 0.0, size, 1.0)
