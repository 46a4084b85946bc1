"""Undamped modes of K0 u = w^2 M u below a frequency, none missed: Sturm's count says beforehand how many there are."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import eigh

from squealbox.factorisation import Factor, SingularMatrix, factor

DENSE = 400  # rows up to which LAPACK finds all modes at once
MOST = 3000  # modes that are looked for at once
BLOCK = 16  # right sides solved together
CLOSE = 1e-10  # relative residual at which a pair is found
MOST_VECTORS = 10  # Krylov vectors for each mode, at most


@dataclass(frozen=True)
class RealModes:
    """Modes below `top` [Hz]: frequency (k,) [Hz], shapes (n, k) with u' M u = 1, and the factor of K0 + shift M.

    count is the number of modes below `top` by Sturm, so `complete` says that none is missing.
    """

    frequency: Any
    shapes: Any
    top: float
    count: int
    base: Factor
    shift: float

    @property
    def complete(self) -> bool:
        """True where as many modes were found as there are."""
        return self.count == len(self.frequency)


def count_below(stiffness: Any, mass: Any, frequency: float) -> int:
    """Number of undamped modes below `frequency` [Hz]: negative eigenvalues of K - w^2 M (K, M symmetric, M >= 0)."""
    return factor(stiffness - (2.0 * np.pi * frequency) ** 2 * mass, symmetric=True).inertia[1]


def real_modes(stiffness: Any, mass: Any, top: float) -> RealModes:
    """All undamped modes below `top` [Hz], by Lanczos in blocks, shifted to 0 and inverted.

    A body that is free to move makes K0 singular; it is then shifted by a small share of (2 pi top)^2 M.

    Raises `ValueError` when more than 3000 modes lie below `top`.
    """
    count = count_below(stiffness, mass, top)
    base, shift = _base(stiffness, mass, top)
    size = mass.shape[0]
    if count > MOST:
        raise ValueError(f"{count} real modes below {top:g} Hz: expected at most {MOST}; choose a lower band")
    if size <= DENSE or count > size - 2:
        values, shapes = _dense(stiffness, mass, count)
    elif count == 0:
        values, shapes = np.zeros(0), np.zeros((size, 0))
    else:
        values, shapes = block_lanczos(base, mass, count)
        values = values - shift
    order = np.argsort(values)
    values, shapes = values[order], shapes[:, order]
    inside = values < (2.0 * np.pi * top) ** 2
    values, shapes = values[inside], shapes[:, inside]
    shapes = shapes / np.sqrt(np.einsum("ij,ij->j", shapes, mass @ shapes))
    return RealModes(np.sqrt(np.maximum(values, 0.0)) / (2.0 * np.pi), shapes, top, count, base, shift)


def block_lanczos(base: Factor, mass: Any, count: int) -> tuple[Any, Any]:
    """The `count` lowest eigenvalues of A u = s M u, A in `base`, and shapes (n, count) with u' M u = 1.

    Krylov vectors of A^-1 M come in blocks, because a factor serves many right sides several times quicker than one,
    and are kept orthogonal in M. A pair counts as found when its residual is below 1e-10 of its eigenvalue 1/s; the
    eigenvalue is then good to the square of that. A singular M is allowed: every vector is in the range of A^-1 M.
    """
    size = mass.shape[0]
    width = min(BLOCK, max(count, 4))
    fresh = base.solve(mass @ np.random.default_rng(7).standard_normal((size, width)))
    basis, weighted, operator = np.zeros((size, 0)), np.zeros((size, 0)), np.zeros((0, 0))
    while True:
        fresh = _orthogonal(fresh, basis, weighted, mass)
        new = mass @ fresh
        next_ = base.solve(new)
        above, corner = weighted.T @ next_, new.T @ next_
        operator = np.block([[operator, above], [above.T, 0.5 * (corner + corner.T)]])
        basis, weighted = np.concatenate([basis, fresh], axis=1), np.concatenate([weighted, new], axis=1)
        rest = next_ - basis @ (weighted.T @ next_)
        if basis.shape[1] >= count:
            values, turns = np.linalg.eigh(operator)
            best = np.argsort(-values)[:count]
            gram = rest.T @ (mass @ rest)
            tails = turns[-fresh.shape[1] :, best]
            missed = np.sqrt(np.maximum(np.einsum("ij,ik,kj->j", tails, gram, tails), 0.0))
            if np.all(missed <= CLOSE * values[best]) or basis.shape[1] + width > min(size, MOST_VECTORS * count + 400):
                return 1.0 / values[best], basis @ turns[:, best]
        fresh = rest


def _orthogonal(vectors: Any, basis: Any, weighted: Any, mass: Any) -> Any:
    """`vectors` made orthonormal in M, to each other and to the basis; what is not new is left out."""
    for _ in range(2):
        vectors = vectors - basis @ (weighted.T @ vectors)
        gram = vectors.T @ (mass @ vectors)
        values, turns = np.linalg.eigh(0.5 * (gram + gram.T))
        keep = values > 1e-24 * values[-1]
        vectors = vectors @ (turns[:, keep] / np.sqrt(values[keep]))
    return vectors


def _base(stiffness: Any, mass: Any, top: float) -> tuple[Factor, float]:
    try:
        return factor(stiffness, symmetric=True), 0.0
    except SingularMatrix:
        shift = 1e-4 * (2.0 * np.pi * top) ** 2
        return factor(stiffness + shift * mass, symmetric=True), shift


def _dense(stiffness: Any, mass: Any, count: int) -> tuple[Any, Any]:
    """By LAPACK with the roles of K and M exchanged where M is singular."""
    dense, weight = stiffness.toarray(), mass.toarray()
    if np.all(np.linalg.eigvalsh(weight) > 1e-14 * np.max(weight)):
        values, shapes = eigh(dense, weight)
    else:
        inverse, shapes = eigh(weight, dense)
        order = np.argsort(-inverse)
        keep = inverse[order] > 1e-12 * np.max(inverse)
        values, shapes = 1.0 / inverse[order][keep], shapes[:, order][:, keep]
    return values[:count], shapes[:, :count]
