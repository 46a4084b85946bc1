"""Undamped modes of K0 u = w^2 M u below a frequency, none missed: Sturm's count says beforehand how many there are."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import eigh
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigsh

from squealbox.factorisation import Factor, SingularMatrix, factor

DENSE = 400  # rows up to which LAPACK finds all modes at once
MOST = 3000  # modes that are looked for at once


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
    """All undamped modes below `top` [Hz], by shift-invert Lanczos about 0.

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
        back = LinearOperator((size, size), matvec=base.solve, dtype=float)
        start = np.random.default_rng(7).standard_normal(size)
        try:
            values, shapes = eigsh(stiffness, k=count, M=mass, sigma=-shift, OPinv=back, v0=start, tol=1e-13)
        except ArpackNoConvergence as error:
            values, shapes = error.eigenvalues, error.eigenvectors
    order = np.argsort(values)
    values, shapes = values[order], shapes[:, order]
    inside = values < (2.0 * np.pi * top) ** 2
    values, shapes = values[inside], shapes[:, inside]
    shapes = shapes / np.sqrt(np.einsum("ij,ij->j", shapes, mass @ shapes))
    return RealModes(np.sqrt(np.maximum(values, 0.0)) / (2.0 * np.pi), shapes, top, count, base, shift)


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
