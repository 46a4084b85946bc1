"""Modes of a large brake on a small basis, each with an estimate of its error; the basis grows until that is small.

On V the problem is V'Q(lambda)V x = 0, small and dense. With right and left shapes u = V x, w = V y the residuals
r = Q u and s = Q^H w say what the basis misses, and to second order the true eigenvalue is lambda + delta,

    delta = s^H K0^-1 r / (w^H Q'(lambda) u)

because K0^-1 is nearly Q^-1 on the directions outside the basis. K0^-1 r and K0^-1 s are also the directions to add.
"""

from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np

from squealbox.factorisation import Factor, Order
from squealbox.fe.band_spectrum import Pairs, band_pairs
from squealbox.fe.basis import enriched_basis
from squealbox.fe.growing_basis import GrowingBasis, parts, times
from squealbox.fe.pencil import Pencil, vibrating
from squealbox.fe.small import Small
from squealbox.fe.undamped_modes import RealModes, real_modes

HEADROOM = 0.7  # modes above this share of the highest real mode of a basis are not shown: there it invents
REACH = 1.1  # times the end of the band up to which real modes are enriched
FEWEST = 12  # real modes that a basis holds at least
ROUNDS = 6  # of growing a basis
LEFT_OUT = 0.3  # of the tolerance: what a round of growing may leave out


@dataclass(frozen=True)
class Projected:
    """Modes on a basis: eigenvalues (k,) with Im > 0, x and y (m, k), error (k,): the complex estimate delta.

    condition (k,) is the condition number of each eigenvalue on the basis; small is the problem on it. right and left
    (n, k) are the shapes on all freedoms, where asked for.
    """

    eigenvalues: Any
    x: Any
    y: Any
    error: Any
    condition: Any
    small: Small
    right: Any = None
    left: Any = None

    @cached_property
    def every(self) -> Any:
        """All eigenvalues of the small problem, also those outside the band."""
        return self.small.eigenvalues()


class Residuals(NamedTuple):
    """What a basis misses of the modes `asked` (k,): r = Q u, s = Q^H w, and K0^-1 r, all (n, 2k).

    Real parts come first, then imaginary ones.
    """

    asked: Any
    right: Any
    left: Any
    moved: Any


def basis_for(pencil: Pencil, band: tuple[float, float], order: Order | None = None) -> tuple[RealModes, Any]:
    """Real modes up to the band's end / 0.7, and the basis enriched by friction and damping."""
    top = band[1] / HEADROOM
    modes = real_modes(pencil.elastic, pencil.M, top, order)
    while modes.count < min(FEWEST, pencil.size // 2):
        top *= 1.5
        modes = real_modes(pencil.elastic, pencil.M, top, modes.base.order)
    modes = replace(modes, base=modes.base.in_single())  # from here on it gives directions and estimates
    return modes, enriched_basis(pencil, modes, REACH * band[1])


def modes_on(
    onto: GrowingBasis,
    i: int,
    base: Factor,
    band: tuple[float, float],
    before: Projected | None = None,
    tolerance: float = 0.0,
) -> tuple[Projected, Residuals]:
    """The modes of the i-th pencil in the band (f1, f2) [Hz], with their estimates: one solve for each.

    Where they are known `before`, on part of this basis, those with an estimate within `tolerance` [1/s] are not solved
    for again: what is left of it is what the eigenvalue has not moved of it.
    """
    small = onto.small(i)
    pairs = _pairs(small, onto.undamped, band)
    error = np.full(len(pairs.values), np.inf, dtype=complex)
    if before is not None and len(before.eigenvalues):
        exact = before.eigenvalues + before.error
        same = np.argmin(np.abs(exact - pairs.values[:, None]), axis=1)
        error = np.where(np.abs(before.error[same]) <= tolerance, exact[same] - pairs.values, np.inf)
    asked = np.flatnonzero(~(np.abs(error) <= tolerance))
    values, x, y = pairs.values[asked], pairs.right[:, asked], pairs.left[:, asked]
    missed, missed_left = onto.residual(i, values, x), onto.left_residual(i, values, y)
    moved = base.solve_many(missed)
    error[asked] = _paired(missed_left, moved)
    found = Projected(pairs.values, pairs.right, pairs.left, error, pairs.condition, small)
    return found, Residuals(asked, missed, missed_left, moved)


def _pairs(small: Small, turns: np.ndarray, band: tuple[float, float]) -> Pairs:
    """The modes in the band by condensation in undamped modes; where they do not settle, of the whole spectrum."""
    turned = Small(*(turns.T @ (matrix @ turns) for matrix in (small.M, small.C, small.K)))
    pairs = band_pairs(turned, band)
    if pairs is not None:
        return pairs._replace(right=turns @ pairs.right, left=turns @ pairs.left)
    values, x, y, condition = small.eigen()
    low, high = (2.0 * np.pi * f for f in band)
    inside = np.flatnonzero((values.imag >= low) & (values.imag <= high) & vibrating(values))
    inside = inside[np.argsort(values[inside].imag, kind="stable")]
    chosen, x, y = values[inside], x[:, inside], y[:, inside]
    y = y / np.conj(np.sum(np.conj(y) * (2.0 * chosen * (small.M @ x) + small.C @ x), axis=0))
    return Pairs(chosen, x, y, condition[inside])


def with_shapes(onto: GrowingBasis, found: Projected) -> Projected:
    """The same modes with right and left shapes on all freedoms; the right ones of length 1."""
    right = _complex(times(onto.blocks, parts(found.x)))
    length = np.linalg.norm(right, axis=0)
    left = _complex(times(onto.blocks, parts(found.y * length)))
    return replace(found, x=found.x / length, y=found.y * length, right=right / length, left=left)


def residual_vectors(base: Factor, missed: Residuals, marked: np.ndarray) -> tuple[Any, Any]:
    """Real and imaginary parts of du = K0^-1 r and dw = K0^-1 s of the marked modes, (n, 4k), and of r and s likewise.

    The estimate is <dw, du> in the energy of K0. Each pair is scaled so that both have the same energy, |dw| |du|: what
    a direction holds of them is then what leaving it out may cost, in 1/s.
    """
    both = np.tile(marked, 2)
    right, left, moved = missed.right[:, both], missed.left[:, both], missed.moved[:, both]
    moved_left = base.solve_many(left)
    energies = [_paired(m, r).real for m, r in ((moved, right), (moved_left, left))]
    balance = np.tile(np.sqrt(np.sqrt(np.maximum(energies[1], 1e-300) / np.maximum(energies[0], 1e-300))), 2)
    for columns in (moved, right):
        columns *= balance
    for columns in (moved_left, left):
        columns /= balance
    return np.concatenate([moved, moved_left], axis=1), np.concatenate([right, left], axis=1)


def _complex(columns: np.ndarray) -> Any:
    """Complex columns (n, k) from their parts (n, 2k)."""
    count = columns.shape[1] // 2
    return columns[:, :count] + 1j * columns[:, count:]


def _paired(left: np.ndarray, right: np.ndarray) -> Any:
    """a_k^H b_k (k,) of complex columns given by their parts (n, 2k)."""
    count = left.shape[1] // 2
    real, swapped = (np.einsum("ij,ij->j", left, columns) for columns in (right, np.roll(right, count, axis=1)))
    return real[:count] + real[count:] + 1j * (swapped[:count] - swapped[count:])


def main_directions(moved: np.ndarray, missed: np.ndarray, allowed: float) -> Any:
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
    mostly serves those too. A mode whose estimate is small is not looked at again, because the basis only grows.
    """
    every: list[Any] = [None] * len(onto.pencils)
    outer = [*range(1, len(onto.pencils) - 1)]
    for group in (outer, [i for i in range(len(onto.pencils)) if i not in outer]):
        open_ = group
        for left in reversed(range(rounds + 1)):
            parts, marked, again = [], 0, []
            for i in open_:
                every[i], missed = modes_on(onto, i, base, band, every[i], tolerance)
                marks = np.abs(every[i].error[missed.asked]) > tolerance
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
