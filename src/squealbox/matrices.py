"""The arrays of a system: what is wrong with one, steady sliding, and sums over contacts as products of matrices."""

import sys
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.result import Outcome

FEW = 8  # contacts up to which sums are taken one by one, the same for one system as for a map of them
SYMMETRIC = 1e-8  # of the largest entry: differences beyond it are no round-off of a written file


class InvalidSystem(ValueError):
    """Matrices, vectors or contacts do not make a system; the message names array, shape and what was expected."""


def is_sparse(value: object) -> bool:
    """Whether it is a sparse array of SciPy: nothing is while those are not loaded, which takes a quarter second."""
    asked = getattr(sys.modules.get("scipy.sparse"), "issparse", None)  # None also while another thread loads them
    return asked is not None and bool(asked(value))


def runs_of_true(inside: ArrayLike) -> list[tuple[int, int]]:
    """Indices of the first and the last of each run of True in a row (k,)."""
    edges = np.diff(np.r_[False, np.asarray(inside, dtype=bool), False].astype(int))
    return list(zip(np.flatnonzero(edges == 1).tolist(), (np.flatnonzero(edges == -1) - 1).tolist(), strict=True))


def coupled(left: np.ndarray, factor: np.ndarray, right: np.ndarray) -> Any:
    """sum_c left_c factor_c right_c' of rows (..., contacts, n), shape (..., n, n); factor is (..., contacts)."""
    if len(np.shape(factor)) == 1 and len(factor) > FEW and np.ndim(left) == 2 and np.ndim(right) == 2:
        return (left * factor[:, None]).T @ right
    total: Any = 0.0
    for i in range(np.shape(factor)[-1]):  # on a map, sums of outer products are quicker than tiny products
        total = total + factor[..., i, None, None] * outer(left[..., i, :], right[..., i, :])
    return total


def felt(rows: np.ndarray, q: np.ndarray) -> Any:
    """rows . q, (..., contacts)."""
    many = np.ndim(q) == 1 and np.ndim(rows) == 2 and len(rows) > FEW
    return rows @ q if many else np.sum(rows * q[..., None, :], axis=-1)


def check_mass(mass: np.ndarray) -> None:
    """Symmetric to its own size, and no motion of negative kinetic energy."""
    largest = np.max(np.abs(mass), axis=(-1, -2), keepdims=True, initial=0.0)
    if np.any(np.abs(mass - np.swapaxes(mass, -1, -2)) > SYMMETRIC * largest):
        raise InvalidSystem("M is not symmetric: expected a symmetric mass matrix")
    diagonal = np.diagonal(mass, axis1=-2, axis2=-1)
    if np.any(diagonal < 0.0):
        *_, i = (int(k[0]) for k in np.nonzero(diagonal < 0.0))
        raise InvalidSystem(f"M[{i}, {i}] = {float(np.min(diagonal[..., i])):g} is negative: expected masses >= 0")
    if np.all(mass == diagonal[..., None] * np.eye(mass.shape[-1])):
        return
    root = np.sqrt(np.where(diagonal > 0.0, diagonal, 1.0))  # one unit for all freedoms: kg and kg m2 side by side
    least = np.linalg.eigvalsh(mass / (root[..., :, None] * root[..., None, :]))[..., 0]
    if np.any(least < -SYMMETRIC * mass.shape[-1]):
        raise InvalidSystem(
            "M is indefinite: some motion has negative kinetic energy; expected a positive (semi)definite mass matrix"
        )


def checked_names(names: Sequence[str], size: int) -> tuple[str, ...]:
    """Names of the degrees of freedom, by default q1, q2, ...; `InvalidSystem` for a wrong number or one twice."""
    if isinstance(names, str):
        raise InvalidSystem(f"names = {names!r}: expected a name for each degree of freedom, such as ('x', 'y')")
    names = tuple(names) or tuple(f"q{i + 1}" for i in range(size))
    if len(names) != size:
        raise InvalidSystem(f"names = {names}: {len(names)} names, expected {size}, one for each degree of freedom")
    if len(set(names)) < len(names):
        twice = [name for name, times in Counter(names).items() if times > 1]
        raise InvalidSystem(f"names = {names}: {min(twice)!r} stands more than once, expected names of their own")
    return names


def liveliest(sizes: ArrayLike, units: Sequence[str]) -> int:
    """The degree of freedom that moves most; a rotation only where nothing else moves: rad are no metres."""
    sizes = np.nan_to_num(np.asarray(sizes, dtype=float))
    moves = np.where(np.array([unit == "rad" for unit in units], dtype=bool), 0.0, sizes)
    return int(np.argmax(moves if np.any(moves > 0.0) else sizes))


def array(name: str, value: Any, ndim: int) -> np.ndarray:
    """A read-only array of finite real numbers with at least `ndim` axes; `InvalidSystem` with its name else."""
    try:
        array = np.array(value)
        array = array.astype(float, casting="same_kind", copy=False)  # refuses complex numbers and texts
    except (TypeError, ValueError) as error:
        given = f" = {value!r}" if isinstance(value, str) or value is None else ""
        else_ = "; what varies in time is a schedule, such as Sinusoid or schedules.Table" if callable(value) else ""
        raise InvalidSystem(f"{name}{given}: expected an array of real numbers{else_}") from error
    if array.ndim < ndim:
        raise InvalidSystem(f"{name} has shape {array.shape}: expected at least {ndim} axes")
    if not np.isfinite(array).all():
        raise InvalidSystem(f"{name} holds a value that is not finite")
    array.flags.writeable = False
    return array


def check_width(name: str, array: np.ndarray, size: int) -> None:
    """Raise `InvalidSystem` unless the last axis has the size."""
    if array.shape[-1:] != (size,):
        raise InvalidSystem(f"{name} has shape {array.shape}: expected (..., {size})")


def outer(a: ArrayLike, b: ArrayLike) -> Any:
    """a b' over leading axes."""
    return np.asarray(a)[..., :, None] * np.asarray(b)[..., None, :]


def form(a: ArrayLike, matrix: np.ndarray, b: ArrayLike) -> Any:
    """a . matrix b over leading axes; one matrix for all rows goes through one matrix product."""
    product = np.asarray(b) @ matrix.T if np.ndim(matrix) == 2 else np.einsum("...ij,...j->...i", matrix, np.asarray(b))
    return np.sum(np.asarray(a) * product, axis=-1)


@dataclass(frozen=True)
class Equilibrium:
    """Steady sliding: displacements and contact states, or why there is none.

    q (..., n) [m]; normal_force, sliding_speed and friction (..., contacts) in N, m/s and -; exists (...) bool;
    outcome "completed", "singular" (K_eff cannot be solved), "no_sliding" (a contact has V = 0, so any force up to the
    static limit balances) or "no_convergence"; with leading axes the outcome names the worst entry.
    floating (...) counts rigid-body freedoms: motions that no spring and no contact feels and no force drives. Steady
    sliding is known but for them, and q is the one of least length.
    """

    q: Any
    normal_force: Any
    sliding_speed: Any
    friction: Any
    exists: Any
    outcome: Outcome
    floating: Any = 0


@dataclass(frozen=True)
class Linearised:
    """M, C_eff, K_eff, each (..., n, n), about an equilibrium; NaN where there is none."""

    M: Any
    C: Any
    K: Any
    equilibrium: Equilibrium
