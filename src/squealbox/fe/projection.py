"""Modes of a large brake on a small basis, each with an estimate of its error; the basis grows until that is small.

On V the problem is V'Q(lambda)V x = 0, small and dense. With right and left shapes u = V x, w = V y the residuals
r = Q u and s = Q^H w say what the basis misses, and to second order the true eigenvalue is lambda + delta,

    delta = s^H K0^-1 r / (w^H Q'(lambda) u)

because K0^-1 is nearly Q^-1 on the directions outside the basis. K0^-1 r and K0^-1 s are also the directions to add.
"""

from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from squealbox.factorisation import Factor
from squealbox.fe.basis import enriched_basis
from squealbox.fe.growing_basis import GrowingBasis, times
from squealbox.fe.pencil import Pencil, vibrating
from squealbox.fe.real_modes import RealModes, real_modes

HEADROOM = 0.7  # modes above this share of the highest real mode of a basis are not shown: there it invents
FEWEST = 12  # real modes that a basis holds at least
ROUNDS = 6  # of growing a basis
LEFT_OUT = 0.3  # of the tolerance: what a round of growing may leave out


@dataclass(frozen=True)
class Projected:
    """Modes on a basis: eigenvalues (k,) with Im > 0, x and y (m, k), error (k,): the complex estimate delta.

    condition (k,) is the condition number of each eigenvalue on the basis; every holds all eigenvalues of the small
    problem, also those outside the band. right and left (n, k) are the shapes on all freedoms, where asked for.
    """

    eigenvalues: Any
    x: Any
    y: Any
    error: Any
    condition: Any
    every: Any
    right: Any = None
    left: Any = None


class Residuals(NamedTuple):
    """What a basis misses of modes (n, k): r = Q u, s = Q^H w, and K0^-1 r."""

    right: Any
    left: Any
    moved: Any


def basis_for(pencil: Pencil, band: tuple[float, float]) -> tuple[RealModes, Any]:
    """Real modes up to the band's end / 0.7, and the basis enriched by friction and damping."""
    top = band[1] / HEADROOM
    modes = real_modes(pencil.elastic, pencil.M, top)
    while modes.count < min(FEWEST, pencil.size // 2):
        top *= 1.5
        modes = real_modes(pencil.elastic, pencil.M, top)
    return modes, enriched_basis(pencil, modes)


def modes_on(onto: GrowingBasis, i: int, base: Factor, band: tuple[float, float]) -> tuple[Projected, Residuals]:
    """The modes of the i-th pencil in the band (f1, f2) [Hz], with their estimates: one solve for each."""
    small = onto.small(i)
    values, x, y, condition = small.eigen()
    low, high = (2.0 * np.pi * f for f in band)
    inside = np.flatnonzero((values.imag >= low) & (values.imag <= high) & vibrating(values))
    inside = inside[np.argsort(values[inside].imag, kind="stable")]
    chosen, x, y = values[inside], x[:, inside], y[:, inside]
    y = y / np.conj(np.sum(np.conj(y) * (2.0 * chosen * (small.M @ x) + small.C @ x), axis=0))
    missed, missed_left = onto.residual(i, chosen, x), onto.left_residual(i, chosen, y)
    moved = base.solve_many(missed)
    error = np.sum(np.conj(missed_left) * moved, axis=0)
    return Projected(chosen, x, y, error, condition[inside], values), Residuals(missed, missed_left, moved)


def with_shapes(onto: GrowingBasis, found: Projected) -> Projected:
    """The same modes with right and left shapes on all freedoms; the right ones of length 1."""
    right = times(onto.blocks, found.x)
    length = np.linalg.norm(right, axis=0)
    left = times(onto.blocks, found.y * length)
    return replace(found, x=found.x / length, y=found.y * length, right=right / length, left=left)


def residual_vectors(base: Factor, missed: Residuals, marked: Any) -> tuple[Any, Any]:
    """Real and imaginary parts of du = K0^-1 r and dw = K0^-1 s of the marked modes, (n, 4k), and of r and s likewise.

    The estimate is <dw, du> in the energy of K0. Each pair is scaled so that both have the same energy, |dw| |du|: what
    a direction holds of them is then what leaving it out may cost, in 1/s.
    """
    right, left, moved = missed.right[:, marked], missed.left[:, marked], missed.moved[:, marked]
    moved_left = base.solve_many(left)
    energies = [np.sum(np.conj(m) * r, axis=0).real for m, r in ((moved, right), (moved_left, left))]
    balance = np.sqrt(np.sqrt(np.maximum(energies[1], 1e-300) / np.maximum(energies[0], 1e-300)))
    pairs = ((moved * balance, moved_left / balance), (right * balance, left / balance))
    return tuple(np.concatenate([a.real, a.imag, b.real, b.imag], axis=1) for a, b in pairs)  # type: ignore[return-value]


def main_directions(moved: Any, missed: Any, allowed: float) -> Any:
    """The directions of scaled residual vectors that together hold all but `allowed` [1/s] of their energies.

    Residuals are at right angles to the basis, so K0^-1 of them is so in the energy of K0: what they hold is new to it.
    """
    energy = moved.T @ missed
    values, turns = np.linalg.eigh(0.5 * (energy + energy.T))
    values = np.maximum(values, 0.0)
    keep = np.cumsum(values) > allowed
    return moved @ (turns[:, keep] / np.sqrt(values[keep]))


def refined(
    onto: GrowingBasis, base: Factor, band: tuple[float, float], tolerance: float, rounds: int = ROUNDS
) -> list[Projected]:
    """The modes in the band of every pencil; the basis grows until every estimate is below `tolerance` [1/s].

    The first pencil and the last, about which and between which the others lie, come after these: what serves them
    mostly serves those too. A pencil whose estimates are small is not looked at again, because the basis only grows.
    """
    every: list[Any] = [None] * len(onto.pencils)
    outer = [*range(1, len(onto.pencils) - 1)]
    for group in (outer, [i for i in range(len(onto.pencils)) if i not in outer]):
        open_ = group
        for left in reversed(range(rounds + 1)):
            parts, marked, again = [], 0, []
            for i in open_:
                every[i], missed = modes_on(onto, i, base, band)
                marks = np.abs(every[i].error) > tolerance
                if np.any(marks) and left:
                    parts.append(residual_vectors(base, missed, marks))
                    marked += int(np.sum(marks))
                    again.append(i)
                del missed
            if not parts:
                break
            moved, missing = (np.concatenate(part, axis=1) for part in zip(*parts, strict=True))
            del parts
            # what is left out is spread over the marked modes
            onto.add(main_directions(moved, missing, LEFT_OUT * tolerance * np.sqrt(marked)))
            open_ = again
    return every
