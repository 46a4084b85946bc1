"""Static deflections K q = f where K may be singular: badly scaled, floating, or truly without an answer.

A matrix is judged after its rows and columns are brought to one size, so that K = diag(1, 1e16), which only has two
units, is regular. A free-free body leaves K singular by its rigid-body motions. Where no force drives such a motion and
no contact feels it, the deflection is known but for it, and the one of least length is taken.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.result import COMPLETED, Outcome

RIGID = 1e-14  # singular values below this share of the largest (rows and columns levelled) are rigid-body motions
FELT = 1e-9  # share of the forces, and of a contact's sensitivity, below which it is round-off that feels a motion


def solve(matrix: np.ndarray, right: np.ndarray) -> tuple[Any, Any]:
    """Solutions (..., n), zero where the matrix (..., n, n) is singular to working precision, and where it is."""
    limit = 1.0 / np.finfo(float).eps
    with np.errstate(all="ignore"):
        singular = np.asarray(~(_condition(matrix) < limit))
        if np.any(singular):
            again = ~(np.linalg.cond(levelled(matrix[singular])[0], 1) < limit)
            singular[singular] = again
    safe = np.where(singular[..., None, None], np.eye(matrix.shape[-1]), matrix)
    found = np.linalg.solve(safe, right[..., None])[..., 0]
    return np.where(singular[..., None], 0.0, found), singular


def levelled(matrices: np.ndarray) -> tuple[Any, Any, Any]:
    """Matrices (..., n, n) whose rows and columns have a largest entry of about 1, and the factors (..., n) for it.

    Source: Ruiz 2001, A scaling algorithm to equilibrate both rows and columns norms in matrices, RAL-TR-2001-034.
    """
    rows, columns = (np.ones(matrices.shape[:-1]) for _ in range(2))
    scaled = matrices
    for _ in range(6):  # each pass takes the square root of what is left
        high, wide = np.max(np.abs(scaled), axis=-1), np.max(np.abs(scaled), axis=-2)
        rows = rows / np.sqrt(np.where(high > 0.0, high, 1.0))
        columns = columns / np.sqrt(np.where(wide > 0.0, wide, 1.0))
        scaled = rows[..., :, None] * matrices * columns[..., None, :]
    return scaled, rows, columns


def modulo_rigid_motion(
    matrix: np.ndarray,
    right: np.ndarray,
    feelers: np.ndarray,
    forces: float | np.ndarray,
    found: ArrayLike,
    singular: ArrayLike,
) -> tuple[Any, Any, Any, Any]:
    """Deflections of least length where a matrix is singular only by motions nobody feels and no force drives.

    Parameters
    ----------
    matrix, right : (..., n, n) and (..., n)
    feelers : rows (..., contacts, n) that must not feel the motions
    forces : size of the forces [N], against which a push is judged
    found, singular : what `solve` gave

    Returns
    -------
    deflections; where there is still none; number of motions left free; where a force drives one, (...) each
    """
    batch = np.shape(singular)
    feelers = np.broadcast_to(feelers, (*batch, *np.shape(feelers)[-2:]))
    forces = np.broadcast_to(forces, batch)
    found, left = np.array(found), np.array(singular)
    floating, pushed = np.zeros(batch, dtype=int), np.zeros(batch, dtype=bool)
    for at in map(tuple, np.argwhere(singular)):
        if not np.all(np.isfinite(matrix[at])):
            continue
        scaled, rows, columns = levelled(matrix[at])
        u, sizes, v = np.linalg.svd(scaled)
        rank = int(np.sum(sizes > RIGID * len(sizes) * max(sizes[0], 1e-300)))
        push, motion = u[:, rank:] * rows[:, None], v[rank:].T * columns[:, None]
        size = np.max(np.abs(feelers[at]), initial=0.0) * np.max(np.abs(motion), axis=0, initial=0.0)
        if np.any(np.abs(feelers[at] @ motion) > FELT * size):
            continue  # the motion changes a normal force: which one holds is not known
        driven = np.abs(right[at] @ push) > FELT * (forces[at] + 1e-300) * np.max(np.abs(push), axis=0, initial=0.0)
        if np.any(driven):
            pushed[at] = True
            continue
        moved = columns * (v[:rank].T @ ((u[:, :rank].T @ (rows * right[at])) / sizes[:rank]))
        basis = np.linalg.qr(motion)[0]
        found[at], floating[at], left[at] = moved - basis @ (basis.T @ moved), basis.shape[1], False
    return found, left, floating, pushed


def ended(
    singular: np.ndarray,
    sliding: bool | np.bool_ | np.ndarray,
    converged: bool | np.bool_ | np.ndarray,
    speed: np.ndarray,
    pushed: bool | np.bool_ | np.ndarray = False,
) -> Outcome:
    """How the search for steady sliding ended, from truth values (...); with leading axes the worst entry is named."""
    if np.any(singular):
        message = "K_eff is singular: the friction-coupled stiffness has no unique static deflection"
        if np.any(pushed):
            message = "K_eff is singular: nothing holds a rigid-body motion that the forces drive, so it runs away"
        return Outcome("singular", message, entries=int(np.sum(singular)))
    if not np.all(sliding):
        contacts = sorted({int(i) for i in np.nonzero(speed == 0.0)[-1]})
        one = len(contacts) == 1
        said = f"contact{'' if one else 's'} {', '.join(str(i + 1) for i in contacts)} {'has' if one else 'have'} V = 0"
        message = f"{said}: it may stick, and any force up to its static limit balances"
        return Outcome("no_sliding", message, contacts=contacts, entries=int(np.sum(~sliding)))
    if not np.all(converged):
        return Outcome("no_convergence", "the set of open contacts did not settle", entries=int(np.sum(~converged)))
    return Outcome(COMPLETED)


def _condition(matrix: np.ndarray) -> Any:
    """Condition number by the inverse (1-norm); of 2 x 2 in closed form (Frobenius), many times faster on a map."""
    if matrix.shape[-1] != 2:
        return np.linalg.cond(matrix, 1)
    a = matrix / np.max(np.abs(matrix), axis=(-1, -2), keepdims=True)
    return np.sum(a**2, axis=(-1, -2)) / np.abs(a[..., 0, 0] * a[..., 1, 1] - a[..., 0, 1] * a[..., 1, 0])
