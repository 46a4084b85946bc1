"""Modes of a large brake on a small basis, each with an estimate of its error; the basis grows until that is small.

On V the problem is V'Q(lambda)V x = 0, small and dense. With right and left shapes u = V x, w = V y the residuals
r = Q u and s = Q^H w say what the basis misses, and to second order the true eigenvalue is lambda + delta,

    delta = (s^H K0^-1 r - w^H r) / (w^H Q'(lambda) u)

because K0^-1 is nearly Q^-1 on the directions outside the basis. K0^-1 r and K0^-1 s are also the directions to add.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.factorisation import Factor
from squealbox.fe.basis import enriched_basis
from squealbox.fe.growing_basis import GrowingBasis, times
from squealbox.fe.pencil import Pencil, vibrating
from squealbox.fe.real_modes import RealModes, real_modes

HEADROOM = 0.7  # modes above this share of the highest real mode of a basis are not shown: there it invents
FEWEST = 12  # real modes that a basis holds at least
ROUNDS = 4  # of growing a basis
LEFT_OUT = 0.3  # of the tolerance: what a round of growing may leave out


@dataclass(frozen=True)
class Projected:
    """Modes on a basis: eigenvalues (k,) with Im > 0, right and left (n, k), error (k,): the complex estimate delta.

    condition (k,) is the condition number of each eigenvalue on the basis; every holds all eigenvalues of the small
    problem, also those outside the band. missed and missed_left (n, k) are the residuals r and s, moved is K0^-1 r.
    """

    eigenvalues: Any
    right: Any
    left: Any
    error: Any
    condition: Any
    every: Any
    missed: Any = None
    missed_left: Any = None
    moved: Any = None


def basis_for(pencil: Pencil, band: tuple[float, float]) -> tuple[RealModes, Any]:
    """Real modes up to the band's end / 0.7, and the basis enriched by friction and damping."""
    top = band[1] / HEADROOM
    modes = real_modes(pencil.elastic, pencil.M, top)
    while modes.count < min(FEWEST, pencil.size // 2):
        top *= 1.5
        modes = real_modes(pencil.elastic, pencil.M, top)
    return modes, enriched_basis(pencil, modes)


def modes_on(onto: GrowingBasis, i: int, base: Factor, band: tuple[float, float]) -> Projected:
    """The modes of the i-th pencil in the band (f1, f2) [Hz], with their estimates: one solve for each."""
    values, x, y, condition = onto.small(i).eigen()
    low, high = (2.0 * np.pi * f for f in band)
    inside = np.flatnonzero((values.imag >= low) & (values.imag <= high) & vibrating(values))
    inside = inside[np.argsort(values[inside].imag, kind="stable")]
    chosen, x, y = values[inside], x[:, inside], y[:, inside]
    small = onto.small(i)
    y = y / np.conj(np.sum(np.conj(y) * (2.0 * chosen * (small.M @ x) + small.C @ x), axis=0))
    right = times(onto.basis, x)
    length = np.linalg.norm(right, axis=0)
    x, y, right = x / length, y * length, right / length
    left = times(onto.basis, y)
    missed, missed_left = onto.residual(i, chosen, x), onto.left_residual(i, chosen, y)
    moved = base.solve_many(missed)
    error = np.sum(np.conj(missed_left) * moved, axis=0) - np.sum(np.conj(left) * missed, axis=0)
    return Projected(chosen, right, left, error, condition[inside], values, missed, missed_left, moved)


def residual_vectors(base: Factor, found: Projected, worst: Any) -> Any:
    """Real and imaginary parts of du = K0^-1 r and dw = K0^-1 s of the modes marked in `worst`, (n, 4k).

    The estimate is <dw, du> in the energy of K0. Each pair is scaled so that both have the same energy, |dw| |du|: what
    a direction holds of them is then what leaving it out may cost, in 1/s.
    """
    right, left, moved = found.missed[:, worst], found.missed_left[:, worst], found.moved[:, worst]
    moved_left = base.solve_many(left)
    sizes = [
        np.sqrt(np.maximum(np.sum(np.conj(m) * r, axis=0).real, 1e-300))
        for m, r in ((moved, right), (moved_left, left))
    ]
    balance = np.sqrt(sizes[1] / sizes[0])
    moved, moved_left = moved * balance, moved_left / balance
    return np.concatenate([moved.real, moved.imag, moved_left.real, moved_left.imag], axis=1)


def main_directions(onto: GrowingBasis, vectors: Any, allowed: float) -> Any:
    """The directions of scaled residual vectors that together hold all but `allowed` [1/s] of their energies."""
    vectors = onto.without(vectors)
    energy = vectors.T @ (onto.pencils[0].elastic @ vectors)
    values, turns = np.linalg.eigh(0.5 * (energy + energy.T))
    values = np.maximum(values, 0.0)
    keep = np.cumsum(values) > allowed
    return vectors @ (turns[:, keep] / np.sqrt(values[keep]))


def refined(
    onto: GrowingBasis, base: Factor, band: tuple[float, float], tolerance: float, rounds: int = ROUNDS
) -> list[Projected]:
    """The modes in the band of every pencil; the basis grows until every estimate is below `tolerance` [1/s]."""
    for left in reversed(range(rounds + 1)):
        found = [modes_on(onto, i, base, band) for i in range(len(onto.pencils))]
        worst = [np.abs(one.error) > tolerance for one in found]
        if left == 0 or not any(np.any(marks) for marks in worst):
            break
        pairs = zip(found, worst, strict=True)
        vectors = [residual_vectors(base, one, marks) for one, marks in pairs if np.any(marks)]
        marked = sum(int(np.sum(marks)) for marks in worst)  # what is left out is spread over that many modes
        together = np.concatenate(vectors, axis=1)
        onto.add(main_directions(onto, together, LEFT_OUT * tolerance * np.sqrt(marked)))
    return found
