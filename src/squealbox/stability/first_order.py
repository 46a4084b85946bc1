"""Rows without mass as first-order states: a controller's memory, a viscoelastic part, a damper between springs.

With z the rows without mass and m the others,

    q_z' = -C_zz^-1 (K_z q + C_zm q_m'),      M_mm q_m'' = -K_m q - C_mm q_m' - C_mz q_z'

so there are fewer eigenvalues than 2n, and many systems are solved in one batched call. `deflation` solves those, one
by one, whose rows have no damper of their own.
"""

from typing import Any

import numpy as np


def first_order_rows(mass: np.ndarray) -> Any:
    """True for the degrees of freedom without mass in every entry, shape (n,)."""
    heavy = np.any(mass != 0.0, axis=-1)
    return ~np.any(heavy.reshape(-1, heavy.shape[-1]), axis=0)


def first_order_matrix(
    mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray, rows: np.ndarray
) -> tuple[Any, Any, Any]:
    """The state matrix over its time scale, that scale (...) [1/s], and where the rows have a damper of their own."""
    n = len(rows)
    z, m = np.flatnonzero(rows), np.flatnonzero(~rows)
    own = damping[..., z[:, None], z]
    regular = np.linalg.cond(own, 1) < 1.0 / np.finfo(float).eps
    if m.size:
        inertia = mass[..., m[:, None], m]
        heavy = np.linalg.cond(inertia, 1) < 1.0 / np.finfo(float).eps
        regular = regular & heavy
        inertia = np.where(heavy[..., None, None], inertia, np.eye(m.size))
    own = np.where(regular[..., None, None], own, np.eye(z.size))
    by_q, by_v = np.zeros(stiffness.shape), np.zeros(stiffness.shape)
    by_q[..., z, :] = -np.linalg.solve(own, stiffness[..., z, :])
    by_v[..., z[:, None], m] = -np.linalg.solve(own, damping[..., z[:, None], m])
    if m.size:
        back = damping[..., m[:, None], z]
        by_q[..., m, :] = -np.linalg.solve(inertia, stiffness[..., m, :] + back @ by_q[..., z, :])
        coupled = damping[..., m[:, None], m] + back @ by_v[..., z[:, None], m]
        by_v[..., m[:, None], m] = -np.linalg.solve(inertia, coupled)
    fast = np.max(np.abs(by_q[..., z, :]), axis=(-1, -2)) if z.size else 0.0
    slow = np.sqrt(np.max(np.abs(by_q[..., m, :]), axis=(-1, -2))) if m.size else 0.0
    rate = np.maximum(np.maximum(fast, slow), np.max(np.abs(by_v[..., m, :]), axis=(-1, -2)) if m.size else 0.0)
    rate = np.where(np.isfinite(rate) & (rate > 0.0), rate, 1.0)
    matrix, scale = np.zeros((*stiffness.shape[:-2], 2 * n, 2 * n)), rate[..., None, None]
    matrix[..., m, n + m] = 1.0
    matrix[..., z, :n], matrix[..., z, n:] = by_q[..., z, :] / scale, by_v[..., z, :]
    matrix[..., n + m, :n], matrix[..., n + m, n:] = by_q[..., m, :] / scale**2, by_v[..., m, :] / scale
    return matrix, rate, regular


def first_order_spectra(mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray) -> tuple[Any, Any]:
    """Eigenvalues (k, 2n) of k systems, NaN for those at infinity, and which of the systems are answered, (k,).

    Answered are those in which each row without mass has a damper of its own, and all share which rows these are.
    """
    rows = first_order_rows(mass)
    values = np.full((*mass.shape[:-2], 2 * len(rows)), np.nan, dtype=complex)
    if not np.any(rows):
        return values, np.zeros(mass.shape[:-2], dtype=bool)
    with np.errstate(all="ignore"):
        matrix, rate, regular = first_order_matrix(mass, damping, stiffness, rows)
    keep = np.concatenate([np.arange(len(rows)), len(rows) + np.flatnonzero(~rows)])
    matrix = matrix[..., keep[:, None], keep]
    regular = regular & np.all(np.isfinite(matrix), axis=(-1, -2))
    values[regular, : keep.size] = np.linalg.eigvals(matrix[regular]) * rate[regular][..., None]
    return values, regular
