"""A grid that grows finer where an answer crosses a level, as the growth rate does at the boundary of stability."""

import itertools
from collections.abc import Iterable, Mapping
from typing import Any

import numpy as np

from squealbox.parameters import ParameterError
from squealbox.studies.analysis import StudyError
from squealbox.studies.block import Block
from squealbox.studies.space import POINT, Axis, Space, grid

FINEST = 16  # rounds: 65,536 cells for one of the grid
ROUND = "round"  # the coordinate that says in which round a point was added
Node = tuple[int, ...]


class Refined(Space):
    """A grid whose cells are halved, round by round, where `of` - `level` changes its sign or is known in part.

    Parameters
    ----------
    axes : dotted names to two or more numbers each, in rising order: the grid of the first round
    of : name of an answer with one number for each point, such as "largest_growth_rate"
    level : that is crossed
    rounds : of refinement; a cell next to the boundary ends 2^rounds times finer than the grid

    The points lie along one dimension, "point", those of the grid first; the coordinate "round" says when each was
    added. A boundary that enters and leaves a cell between its corners is not seen: the grid must be fine enough.
    Which points are added follows from the answers alone, so a stopped sweep goes on in the same way.

    >>> Refined({"friction.static": [0.2, 0.4, 0.6], "load": [1e3, 2e3]}, of="largest_growth_rate", rounds=4)
    6 points: friction.static and load (6)
    """

    def __init__(self, axes: Mapping[str, Any], of: str, level: float = 0.0, rounds: int = 4) -> None:
        self.base, self.of, self.level = grid(axes), str(of), float(level)
        if isinstance(rounds, bool) or int(rounds) != rounds or not 1 <= rounds <= FINEST:
            raise ParameterError("Refined", "rounds", rounds, f"a whole number in [1, {FINEST}]")
        self.rounds, self.given = int(rounds), dict(axes)
        self._values = [next(iter(axis.values.values())) for axis in self.base.axes]
        for name, values in zip(self.base.names, self._values, strict=True):
            if values.dtype.kind != "f" or len(values) < 2 or not np.all(np.diff(values) > 0.0):
                raise ParameterError("Refined", name, values, "two or more numbers in rising order")
        step = 2**self.rounds
        self._nodes: list[Node] = [tuple(step * i for i in place) for place in np.ndindex(*self.base.shape)]
        self._added = [0] * len(self._nodes)
        self._cells: list[Node] = [tuple(step * i for i in p) for p in np.ndindex(*(n - 1 for n in self.base.shape))]
        self._round = 0
        super().__init__(self._axis())

    def fresh(self) -> "Refined":
        """The same space before any refinement."""
        return Refined(self.given, self.of, self.level, self.rounds)

    def grow(self, blocks: Iterable[Block]) -> bool:
        """Add the points of the next round, chosen by the answers so far; False when there is none to add."""
        if self._round == self.rounds:
            return False
        side = dict(zip(self._nodes, self._sides(blocks), strict=True))
        size = 2 ** (self.rounds - self._round)
        crossed = [cell for cell in self._cells if len({side[node] for node in _corners(cell, size)}) > 1]
        half = size // 2
        self._cells = [child for cell in crossed for child in _corners(cell, half)]
        new = sorted({node for cell in self._cells for node in _corners(cell, half)} - side.keys())
        self._round += 1
        self._nodes += new
        self._added += [self._round] * len(new)
        self.axes = tuple(self._axis())
        return bool(new)

    def coordinates(self) -> dict[str, tuple[str, Any]]:
        return {**super().coordinates(), ROUND: (POINT, np.array(self._added))}

    def _axis(self) -> list[Axis]:
        places = np.array(self._nodes, dtype=float).reshape(len(self._nodes), -1) / 2**self.rounds
        columns = {
            name: np.interp(places[:, i], np.arange(len(values)), values)
            for i, (name, values) in enumerate(zip(self.base.names, self._values, strict=True))
        }
        return [Axis(POINT, columns)]

    def _sides(self, blocks: Iterable[Block]) -> Any:
        """On which side of the level each point lies: -1, 1, or 0 where nothing is known."""
        side = np.zeros(len(self._nodes), dtype=int)
        seen = False
        for block in blocks:
            if self.of in block.columns:
                seen = True
                values = np.asarray(block.columns[self.of].values)
                if values.ndim != 1 or values.dtype.kind not in "fiu":
                    raise StudyError(f"of = {self.of!r}: expected an answer with one number for each point")
                known = np.isfinite(values)
                found = np.where(known, np.where(values > self.level, 1, -1), 0)
                room = side[block.start : block.stop]  # blocks of later rounds are there when a sweep goes on
                room[:] = found[: len(room)]
        if not seen:
            raise StudyError(f"of = {self.of!r}: no point has an answer of that name")
        return side.tolist()


def _corners(cell: Node, size: int) -> list[Node]:
    """The corners of a cell; with half its size, the origins of the cells it is halved into."""
    steps = itertools.product((0, size), repeat=len(cell))
    return [tuple(a + b for a, b in zip(cell, step, strict=True)) for step in steps]
