"""Where in a rectangle may the stability boundary run? Cells subdivided until nothing can hide in them.

Growth rates are flat away from a narrow band of flutter, so a grid of them misses it. The product of all sums of two
eigenvalues is not flat: it is a polynomial in the entries of M, C and K that vanishes wherever a pair is on the
imaginary axis, and between any two modes it feels how far they are from merging (Orlando's formula: it is the last
Hurwitz determinant up to its sign). With the product of the eigenvalues, for divergence, it decides which cells to look
into.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

LEVELS_DEEP = 7  # halvings of a start cell where something may hide
LEVELS_SURE = 1  # halvings of every cell that the boundary crosses


@dataclass(frozen=True)
class LevelsAtPoints:
    """At each point: `level`, positive where a mode grows (NaN if unknown), and smooth detectors (k, points)."""

    level: Any
    detectors: Any


Sampler = Callable[[Any, Any], LevelsAtPoints]


@dataclass(frozen=True)
class Crossing:
    """An edge between two lattice points, in [0, 1]^2, with the boundary between them; `stable` is the stable end."""

    stable: tuple[float, float]
    unstable: tuple[float, float]
    size: float


def crossings(sample: Sampler, cells: int) -> list[Crossing]:
    """Edges that the boundary crosses, at least one for each of its branches in each small cell, coarse cells first."""
    lattice = _Lattice(sample, cells * 2 ** (LEVELS_DEEP + 1))
    step = 2 ** (LEVELS_DEEP + 1)
    corners = np.arange(cells) * step
    x, y = (a.ravel() for a in np.meshgrid(corners, corners, indexing="ij"))
    found: list[Crossing] = []
    for level in range(LEVELS_DEEP + 1):
        hidden, crossed, simple = _examine(lattice, x, y, step)
        done = crossed & simple & (level >= LEVELS_SURE) | (crossed & (level == LEVELS_DEEP))
        found += _edges(lattice, x[done], y[done], step)
        deeper = (crossed | hidden) & ~done
        x, y = x[deeper], y[deeper]
        if level == LEVELS_DEEP or x.size == 0:
            break
        step //= 2
        x, y = np.concatenate([x, x + step, x, x + step]), np.concatenate([y, y, y + step, y + step])
    return found


class _Lattice:
    """Samples at the points of a fine lattice, each computed once."""

    def __init__(self, sample: Sampler, size: int) -> None:
        self.sample, self.size = sample, size
        self.keys = np.array([], dtype=np.int64)
        self.level = np.array([])
        self.detectors: Any = None

    def at(self, x: np.ndarray, y: np.ndarray) -> LevelsAtPoints:
        wanted = x * (self.size + 1) + y
        new = np.setdiff1d(wanted, self.keys)
        if new.size:
            samples = self.sample((new // (self.size + 1)) / self.size, (new % (self.size + 1)) / self.size)
            keys = np.concatenate([self.keys, new])
            order = np.argsort(keys)
            self.keys = keys[order]
            self.level = np.concatenate([self.level, samples.level])[order]
            old = samples.detectors[:, :0] if self.detectors is None else self.detectors
            self.detectors = np.concatenate([old, samples.detectors], axis=1)[:, order]
        place = np.searchsorted(self.keys, wanted)
        return LevelsAtPoints(self.level[place], self.detectors[:, place])


def _examine(lattice: _Lattice, x: np.ndarray, y: np.ndarray, step: int) -> tuple[Any, Any, Any]:
    """For each cell: may the boundary hide in it, do its corners differ, and is it crossed once and plainly?"""
    half = step // 2
    offsets = [(i * half, j * half) for i in range(3) for j in range(3)]
    nodes = [lattice.at(x + i, y + j) for i, j in offsets]
    values = np.stack([node.detectors for node in nodes]).reshape(3, 3, -1, x.size)
    growing = np.stack([node.level > 0.0 for node in nodes]).reshape(3, 3, x.size)
    known = np.all(np.isfinite(np.stack([node.level for node in nodes])), axis=0)
    bend = np.maximum(np.abs(np.diff(values, 2, axis=0)).max((0, 1)), np.abs(np.diff(values, 2, axis=1)).max((0, 1)))
    twist = np.abs(np.diff(np.diff(values, axis=0), axis=1)).max((0, 1))
    curved = 2.0 * np.maximum(bend, twist)
    least = np.abs(values).min((0, 1))
    flips = (values.min((0, 1)) < 0.0) & (values.max((0, 1)) > 0.0)
    hidden = known & np.any(flips | (least <= curved), axis=0)
    slope = np.maximum(np.abs(np.diff(values, axis=0)).min((0, 1)), np.abs(np.diff(values, axis=1)).min((0, 1)))
    corners = growing[::2, ::2].reshape(4, -1)
    crossed = known & np.any(corners != corners[0], axis=0)
    crossed |= known & np.any(growing != growing[0, 0], axis=(0, 1)) & (half > 0)
    plain = np.where(flips | (least <= curved), slope > 0.25 * curved, True)
    return hidden & ~crossed, crossed, np.all(plain, axis=0)


def _edges(lattice: _Lattice, x: np.ndarray, y: np.ndarray, step: int) -> list[Crossing]:
    """The crossed edges of the 3 x 3 nodes of each cell."""
    half = step // 2
    found = []
    for along, across in ((half, 0), (0, half)):
        for i in range(0, step + 1, half):
            for j in range(0, step, half):
                ax, ay = (x + j, y + i) if along else (x + i, y + j)
                bx, by = ax + along, ay + across
                a, b = lattice.at(ax, ay).level, lattice.at(bx, by).level
                for k in np.nonzero((a > 0.0) != (b > 0.0))[0]:
                    ends = ((ax[k], ay[k]), (bx[k], by[k]))
                    first, second = ((u / lattice.size, v / lattice.size) for u, v in ends)
                    stable, unstable = (second, first) if a[k] > 0.0 else (first, second)
                    found.append(Crossing(stable, unstable, step / lattice.size))
    return found
