"""Modes of systems with massless or rigid-body freedoms: what is infinite or zero is taken out before it is solved.

The pencil E x' = A x with x = (q, q') has a singular E where freedoms carry no mass; `massless` takes the infinite
eigenvalues out exactly. A rigid-body freedom makes A singular, mostly twice, for a displacement that stays and one
that runs on: a defective pair, which QR would spread to +-1e-8 of the largest eigenvalue, so that one half seemed to
grow. With N its null space and R what is orthogonal to it,

    [N R]' A [N R] = [[0, N' A R], [0, R' A R]],

so R' A R has the other eigenvalues; repeated until it is regular, each zero is exactly zero.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.stability.massless import reduced
from squealbox.stability.ordering import halves, spectrum_order

SLOW = 1e-6  # share of the largest |lambda| below which a mode counts as slow: a body that is only just held
LARGEST = 1e9  # entry of A, with time in units of the typical frequency, above which time is scaled anew
ZERO = 1e-12  # singular values below this share of 1 (all matrices are scaled to 1) count as zero


def special_modes(mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray) -> tuple[Any, Any, Any, Any] | None:
    """Eigenvalues (2n,), right and left modes (n, 2n) and condition numbers (2n,) of one system; NaN = at infinity.

    The first n hold Im >= 0, as in `ComplexModes`. None where every number is an eigenvalue.
    """
    size = len(mass)
    rate = _rate(mass, damping, stiffness)
    found = _states(mass, damping, stiffness, rate)
    if found is not None and (faster := _missed(found[-1])) > 1.0:
        rate *= faster
        found = _states(mass, damping, stiffness, rate)
    if found is None:
        return None
    level, (m, c, k), embedding, matrix = found
    empty = np.zeros(0, complex), np.zeros((0, 0))
    values, states = _eigen(matrix, _held(stiffness)) if len(matrix) else empty
    states = embedding @ states
    shapes = np.where(np.max(np.abs(states[:size]), axis=0, initial=0.0) > ZERO, states[:size], states[size:])
    lefts, condition = _lefts(m, c, k, values, shapes)
    columns = _places(values, size)
    out = np.full(2 * size, np.nan, dtype=complex)
    rights, duals = (np.full((size, 2 * size), np.nan, dtype=complex) for _ in range(2))
    conditions = np.full(2 * size, np.nan)
    out[columns] = values * rate
    rights[:, columns], duals[:, columns] = level[:, None] * shapes, level[:, None] * lefts
    conditions[columns] = condition
    return out, rights, duals, conditions


def vibrating(eigenvalues: np.ndarray, floating: ArrayLike) -> Any:
    """The largest growth rate (...) beside the zeros of rigid-body motion and what is at infinity; -inf without one."""
    rigid = (eigenvalues == 0.0) & (np.asarray(floating)[..., None] > 0)
    growth = np.real(eigenvalues)
    return np.max(np.where(rigid | np.isnan(growth), -np.inf, growth), axis=-1, initial=-np.inf)


def uncertain(eigenvalues: np.ndarray, condition: np.ndarray, scale: np.ndarray) -> Any:
    """Round-off of an eigenvalue over `scale`: of a slow pair beside fast ones it is its condition that counts."""
    slow = np.abs(eigenvalues) < SLOW * scale
    with np.errstate(invalid="ignore"):
        error = 16.0 * np.finfo(float).eps * condition
    return np.where(slow & np.isfinite(error), error, 0.0)


def _rate(mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray) -> float:
    """A typical angular frequency [rad/s]: a heavy free body must not set the rate of a light spring or damper."""
    rows = m, c, k = [np.max(np.abs(part), axis=1, initial=0.0) for part in (mass, damping, stiffness)]
    other = k if np.any(k > 0.0) else c
    both = (m > 0.0) & (other > 0.0)
    if np.any(both):
        ratio = np.exp(np.mean(np.log(other[both] / m[both])))
        rate = np.sqrt(ratio) if other is k else ratio
    else:
        m, c, k = (float(np.max(part, initial=0.0)) for part in rows)
        rate = np.sqrt(k / m) if m > 0.0 and k > 0.0 else k / c if c > 0.0 and k > 0.0 else c / m if m > 0.0 else 1.0
    return float(rate) if np.isfinite(rate) and rate > 0.0 else 1.0


def _states(
    mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray, rate: float
) -> tuple[Any, Any, Any, Any] | None:
    """Levels (n,), scaled M, C and K, what the states left stand for, and the matrix A of x' = A x in them.

    None where every number is an eigenvalue.
    """
    level = _levels(mass, damping, stiffness, rate)
    m, c, k = (level[:, None] * part * level for part in (rate**2 * mass, rate * damping, stiffness))
    zero, one = np.zeros(m.shape), np.eye(len(m))
    found = reduced(np.block([[one, zero], [zero, m]]), np.block([[zero, one], [-k, -c]]))
    if found is None:
        return None
    left, right, embedding = found
    return level, (m, c, k), embedding, np.linalg.solve(left, right)


def _missed(matrix: np.ndarray) -> float:
    """By how much time has to be scaled anew: a force through a row without mass is faster than any spring and mass.

    Ranks are decided by the largest entry: `ZERO` times it would count motions at the typical frequency as none.
    """
    if np.max(np.abs(matrix), initial=0.0) <= LARGEST:
        return 1.0
    return float(np.max(np.abs(np.linalg.eigvals(matrix)), initial=1.0))


def _levels(mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray, rate: float) -> Any:
    """Factors (n,) that bring each freedom to one unit."""
    size = np.maximum(np.max(np.abs(stiffness), axis=1), rate**2 * np.max(np.abs(mass), axis=1))
    size = np.maximum(size, rate * np.max(np.abs(damping), axis=1))
    return 1.0 / np.sqrt(np.where(size > 0.0, size, 1.0))


def _held(stiffness: np.ndarray) -> bool:
    """Whether springs hold every motion: then no eigenvalue is zero, however heavily something is damped."""
    rows = np.max(np.abs(stiffness), axis=1, keepdims=True, initial=0.0)
    if not np.all(rows > 0.0):
        return False
    return bool(np.linalg.svd(stiffness / rows, compute_uv=False)[-1] > ZERO)


def _eigen(matrix: np.ndarray, held: bool) -> tuple[Any, Any]:
    """Eigenvalues and vectors; zeros, which what is held has none of, exact, with a basis of their invariant space."""
    size = len(matrix)
    basis, zeros, rest = np.eye(size), 0, matrix
    while len(rest):
        _, sizes, v = np.linalg.svd(rest)
        regular = int(np.sum(sizes > ZERO * max(1.0, sizes[0])))
        if held or regular == len(rest):
            break
        turned = np.vstack([v[regular:], v[:regular]]).T
        basis[:, zeros:] = basis[:, zeros:] @ turned
        rest = v[:regular] @ rest @ v[:regular].T
        zeros += len(turned) - regular
    values, vectors = np.linalg.eig(rest) if len(rest) else (np.zeros(0), np.zeros((0, 0)))
    triangular = basis.T @ matrix @ basis
    states = np.zeros((size, size), dtype=complex)
    states[:, :zeros] = basis[:, :zeros]
    for i, value in enumerate(values):
        head = np.linalg.solve(
            value * np.eye(zeros) - np.triu(triangular[:zeros, :zeros], 1), triangular[:zeros, zeros:] @ vectors[:, i]
        )
        states[:, zeros + i] = basis[:, :zeros] @ head + basis[:, zeros:] @ vectors[:, i]
    return np.concatenate([np.zeros(zeros), values]).astype(complex), states


def _lefts(m: np.ndarray, c: np.ndarray, k: np.ndarray, values: np.ndarray, shapes: np.ndarray) -> tuple[Any, Any]:
    """Left modes with w^H (2 lambda M + C) u = 1 where that is not zero, and condition numbers."""
    lefts, condition = np.zeros(shapes.shape, dtype=complex), np.full(len(values), np.inf)
    zeros = 0
    for i, value in enumerate(values):
        vectors, _, _ = np.linalg.svd(value**2 * m + value * c + k)
        own = vectors[:, -1]
        if value == 0.0:  # several: the left null vectors in turn
            own = vectors[:, -1 - zeros % max(len(k) - np.linalg.matrix_rank(k, ZERO), 1)]
            zeros += 1
        slope = np.conj(own) @ (2.0 * value * m + c) @ shapes[:, i]
        length = np.linalg.norm(own) * np.linalg.norm(shapes[:, i])
        if abs(slope) > ZERO * length:
            weight = abs(value) ** 2 * np.linalg.norm(m) + abs(value) * np.linalg.norm(c) + np.linalg.norm(k)
            condition[i] = weight * length / (abs(slope) * max(abs(value), ZERO))
            own = own / np.conj(slope)
        lefts[:, i] = own
    return lefts, condition


def _places(values: np.ndarray, size: int) -> Any:
    """Where each eigenvalue goes: Im >= 0 ascending in the first half, the rest likewise in the second."""
    order = spectrum_order(values)
    side = np.where(values.imag == 0.0, halves(values[None])[0], values.imag < 0.0).astype(bool)
    places = np.zeros(len(values), dtype=int)
    for second in (False, True):
        own = [i for i in order if side[i] == second]
        places[own] = np.arange(len(own)) + size * second
    return places
