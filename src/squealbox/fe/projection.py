"""Modes of a large brake on a small basis, each with an estimate of its error; the basis grows until that is small.

On V the problem is V'Q(lambda)V x = 0, small and dense. With right and left shapes u = V x, w = V y the residuals
r = Q u and s = Q^H w say what the basis misses, and to second order the true eigenvalue is lambda + delta,

    delta = (s^H K0^-1 r - w^H r) / (w^H Q'(lambda) u)

because K0^-1 is nearly Q^-1 on the directions outside the basis. K0^-1 r and K0^-1 s are also the directions to add.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import eig

from squealbox.factorisation import Factor
from squealbox.fe.basis import enriched_basis, joined
from squealbox.fe.pencil import Pencil, vibrating
from squealbox.fe.real_modes import RealModes, real_modes

HEADROOM = 0.7  # modes above this share of the highest real mode of a basis are not shown: there it invents
FEWEST = 12  # real modes that a basis holds at least
ROUNDS = 4  # of growing a basis
LEFT_OUT = 0.3  # of the tolerance: what a round of growing may leave out


@dataclass(frozen=True)
class Projected:
    """Modes on a basis: eigenvalues (k,) with Im > 0, right and left (n, k), error (k,): the complex estimate delta.

    condition (k,) is the condition number of each eigenvalue on the basis;
    every holds all eigenvalues of the small problem, also those outside the band.
    """

    eigenvalues: Any
    right: Any
    left: Any
    error: Any
    condition: Any
    every: Any


@dataclass(frozen=True)
class Small:
    """The projected matrices V'MV, V'CV, V'KV, each (m, m)."""

    M: Any
    C: Any
    K: Any

    def eigenvalues(self) -> Any:
        """Eigenvalues (2m,) alone."""
        state, rate, _ = self._state()
        return np.linalg.eigvals(state).astype(complex) * rate

    def eigen(self) -> tuple[Any, Any, Any, Any]:
        """Eigenvalues (2m,), right x and left y (m, 2m) of the quadratic problem, and the condition numbers (2m,)."""
        size = len(self.M)
        state, rate, inverse = self._state()
        values, left, right = eig(state, left=True, right=True)
        with np.errstate(divide="ignore"):
            condition = 1.0 / np.abs(np.sum(left.conj() * right, axis=0))
        return values * rate, right[:size], inverse.T @ left[size:], condition

    def _state(self) -> tuple[Any, float, Any]:
        size = len(self.M)
        inverse = np.linalg.inv(self.M)
        stiffness, damping = inverse @ self.K, inverse @ self.C
        rate = float(np.sqrt(np.max(np.abs(stiffness)))) or 1.0
        return (
            np.block([[np.zeros((size, size)), np.eye(size)], [-stiffness / rate**2, -damping / rate]]),
            rate,
            inverse,
        )


def projected(pencil: Pencil, basis: Any) -> Small:
    """The matrices on a basis V (n, m)."""
    return Small(*(basis.T @ (matrix @ basis) for matrix in (pencil.M, pencil.C, pencil.K)))


def basis_for(pencil: Pencil, band: tuple[float, float]) -> tuple[RealModes, Any]:
    """Real modes up to the band's end / 0.7, and the basis enriched by friction and damping."""
    top = band[1] / HEADROOM
    modes = real_modes(pencil.elastic, pencil.M, top)
    while modes.count < min(FEWEST, pencil.size // 2):
        top *= 1.5
        modes = real_modes(pencil.elastic, pencil.M, top)
    return modes, enriched_basis(pencil, modes)


def modes_on(pencil: Pencil, base: Factor, basis: Any, band: tuple[float, float]) -> Projected:
    """The modes in the band (f1, f2) [Hz] on a basis, with their estimates."""
    values, x, y, condition = projected(pencil, basis).eigen()
    low, high = (2.0 * np.pi * f for f in band)
    inside = np.flatnonzero((values.imag >= low) & (values.imag <= high) & vibrating(values))
    inside = inside[np.argsort(values[inside].imag, kind="stable")]
    right, left = basis @ x[:, inside], basis @ y[:, inside]
    chosen = values[inside]
    right = right / np.linalg.norm(right, axis=0)
    slope = 2.0 * chosen * (pencil.M @ right) + pencil.C @ right
    left = left / np.conj(np.sum(np.conj(left) * slope, axis=0))
    error = estimates(pencil, base, chosen, right, left)
    return Projected(chosen, right, left, error, condition[inside], values)


def estimates(pencil: Pencil, base: Factor, values: Any, right: Any, left: Any) -> Any:
    """delta (k,) [1/s] for shapes with w^H Q'(lambda) u = 1."""
    missed, missed_left = pencil.residual(values, right), pencil.left_residual(values, left)
    moved = base.solve_many(missed)
    return np.sum(np.conj(missed_left) * moved, axis=0) - np.sum(np.conj(left) * missed, axis=0)


def residual_vectors(pencil: Pencil, base: Factor, found: Projected, worst: Any) -> Any:
    """Real and imaginary parts of du = K0^-1 r and dw = K0^-1 s of the modes marked in `worst`, (n, 4k).

    The estimate is <dw, du> in the energy of K0. Each pair is scaled so that both have the same energy, |dw| |du|: what
    a direction holds of them is then what leaving it out may cost, in 1/s.
    """
    values = found.eigenvalues[worst]
    right = pencil.residual(values, found.right[:, worst])
    left = pencil.left_residual(values, found.left[:, worst])
    moved, moved_left = base.solve_many(right), base.solve_many(left)
    sizes = [
        np.sqrt(np.maximum(np.sum(np.conj(m) * r, axis=0).real, 1e-300))
        for m, r in ((moved, right), (moved_left, left))
    ]
    balance = np.sqrt(sizes[1] / sizes[0])
    moved, moved_left = moved * balance, moved_left / balance
    return np.concatenate([moved.real, moved.imag, moved_left.real, moved_left.imag], axis=1)


def main_directions(pencil: Pencil, basis: Any, vectors: Any, allowed: float) -> Any:
    """The directions of scaled residual vectors that together hold all but `allowed` [1/s] of their energies."""
    for _ in range(2):
        vectors = vectors - basis @ (basis.T @ (pencil.M @ vectors))
    energy = vectors.T @ (pencil.elastic @ vectors)
    values, turns = np.linalg.eigh(0.5 * (energy + energy.T))
    values = np.maximum(values, 0.0)
    keep = np.cumsum(values) > allowed
    return vectors @ (turns[:, keep] / np.sqrt(values[keep]))


def refined_modes(
    pencil: Pencil, modes: RealModes, basis: Any, band: tuple[float, float], tolerance: float
) -> tuple[Projected, Any]:
    """The modes in the band and the basis, grown by residual vectors until every estimate is below `tolerance`."""
    found = modes_on(pencil, modes.base, basis, band)
    for _ in range(ROUNDS):
        worst = np.abs(found.error) > tolerance
        if not np.any(worst):
            break
        vectors = residual_vectors(pencil, modes.base, found, worst)
        basis = joined(pencil, basis, main_directions(pencil, basis, vectors, LEFT_OUT * tolerance))
        found = modes_on(pencil, modes.base, basis, band)
    return found, basis
