"""Undamped modes of K0 u = w^2 M u below a frequency, none missed: Sturm's count says beforehand how many there are."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy.linalg import eigh

from squealbox.factorisation import Factor, Order, SingularMatrix, factor

if TYPE_CHECKING:
    from scipy.sparse import sparray

DENSE = 400  # rows up to which LAPACK finds all modes at once
MOST = 3000  # modes that are looked for at once
BLOCK = 8  # columns that are solved for together, at a fraction of the price of one by one
RIGID = 1e-8  # (w / w_top)^2 of a motion that is rigid but for round-off
CLOSE = 1e-9  # residual of a shape; its frequency is good to the square of that
DEPENDENT = (
    1e-20  # share of its square length that is left of a column without the others, below which it is no new one
)


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


def count_below(stiffness: "sparray", mass: "sparray", frequency: float, order: Order | None = None) -> int:
    """Number of undamped modes below `frequency` [Hz]: negative eigenvalues of K - w^2 M (K, M symmetric, M >= 0).

    `order` is that of a factor of K, where there is one.
    """
    return factor(stiffness - (2.0 * np.pi * frequency) ** 2 * mass, symmetric=True, order=order).inertia[1]


def real_modes(stiffness: "sparray", mass: "sparray", top: float, order: Order | None = None) -> RealModes:
    """All undamped modes below `top` [Hz], by shift-invert Lanczos about 0 with blocks of columns.

    A body that is free to move makes K0 singular; it is then shifted by a small share of (2 pi top)^2 M. `order`
    is that of the factor of a similar matrix, where there is one.

    Raises `ValueError` when more than 3000 modes lie below `top`.
    """
    base, shift = _base(stiffness, mass, top, order)
    count = count_below(stiffness, mass, top, base.order)
    size = mass.shape[0]
    if count > MOST:
        raise ValueError(f"{count} real modes below {top:g} Hz: expected at most {MOST}; choose a lower band")
    if size <= DENSE or count > size - 2:
        values, shapes = _dense(stiffness, mass, count)
    elif count == 0:
        values, shapes = np.zeros(0), np.zeros((size, 0))
    else:
        inverse, shapes = _slowest(base, mass, count)
        values = 1.0 / inverse - shift
    rising = np.argsort(values)
    values, shapes = values[rising], shapes[:, rising]
    inside = values < (2.0 * np.pi * top) ** 2
    values, shapes = values[inside], shapes[:, inside]
    shapes = shapes / np.sqrt(np.einsum("ij,ij->j", shapes, mass @ shapes))
    return RealModes(np.sqrt(np.maximum(values, 0.0)) / (2.0 * np.pi), shapes, top, count, base, shift)


def _base(stiffness: "sparray", mass: "sparray", top: float, order: Order | None) -> tuple[Factor, float]:
    """The factor of K0, or of K0 + shift M where K0 is singular or so nearly that its rigid motions drown all else."""
    rate = (2.0 * np.pi * top) ** 2
    try:
        base = factor(stiffness, symmetric=True, order=order)
    except SingularMatrix:
        base = None
    if base is not None:
        slow = base.solve(mass @ np.random.default_rng(5).standard_normal(mass.shape[0]))
        slower = base.solve(mass @ slow)
        if slower @ (mass @ slower) * RIGID**2 < rate**-2 * (slow @ (mass @ slow)):
            return base, 0.0
    return factor(stiffness + 1e-4 * rate * mass, symmetric=True, order=order), 1e-4 * rate


def _slowest(base: Factor, mass: "sparray", count: int) -> tuple[Any, Any]:
    """The `count` largest eigenvalues of A^-1 M and their shapes, A that of the factor: block Lanczos, lengths by M."""
    size = mass.shape[0]
    start = np.random.default_rng(7).standard_normal((size, BLOCK))
    fresh = base.solve_many(mass @ start)
    columns: list[Any] = []
    weighted: list[Any] = []
    small = np.zeros((0, 0))
    values, turns = np.zeros(0), np.zeros((0, 0))
    for _ in range(4 + 8 * count // BLOCK):
        coupling = np.zeros((len(small), fresh.shape[1]))
        for _ in range(2):  # once more for what the first pass lost to round-off
            for i, (old, heavy) in enumerate(zip(columns, weighted, strict=True)):
                part = heavy.T @ fresh
                fresh = fresh - old @ part
                coupling[_place(columns, i)] += part
        fresh, heavy, length = _orthonormal(fresh, mass)
        if len(small):  # `fresh` was A^-1 M of the last block: its parts are the next column of the projection
            last = _place(columns, len(columns) - 1)
            small[:, last] = coupling
            small[last, :] = coupling.T
            values, turns = np.linalg.eigh(small)
            order = np.argsort(-np.abs(values))[:count]  # K0 may have negative ones, which Sturm counts too
            off = np.linalg.norm(length @ turns[last][:, order], axis=0)
            if len(order) == count and np.all(off <= CLOSE * np.abs(values[order])):
                break
        if fresh.shape[1] == 0:
            break
        columns.append(fresh)
        weighted.append(heavy)
        small = np.pad(small, (0, fresh.shape[1]))
        fresh = base.solve_many(heavy)
    order = np.argsort(-np.abs(values))[:count]
    shapes = sum(old @ turns[_place(columns, i)][:, order] for i, old in enumerate(columns))
    return values[order], shapes


def _place(columns: list[Any], i: int) -> slice:
    """Where the i-th block stands among all columns."""
    before = sum(block.shape[1] for block in columns[:i])
    return slice(before, before + columns[i].shape[1])


def _orthonormal(vectors: np.ndarray, mass: "sparray") -> tuple[Any, Any, Any]:
    """Columns W with W' M W = I, M W, and L with W L = `vectors`; columns that depend on others are left out."""
    whole: Any = None
    for _ in range(2):
        heavy = mass @ vectors
        values, turns = np.linalg.eigh(vectors.T @ heavy)
        keep = values > DEPENDENT * max(values[-1], 1e-300)
        scale = np.sqrt(values[keep])
        length = scale[:, None] * turns[:, keep].T
        vectors, heavy = vectors @ (turns[:, keep] / scale), heavy @ (turns[:, keep] / scale)
        whole = length if whole is None else length @ whole
    return vectors, heavy, whole


def _dense(stiffness: "sparray", mass: "sparray", count: int) -> tuple[Any, Any]:
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
