"""What is left to do of a sweep: pieces of points, sized by measuring, and how fast it goes."""

import time
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple, Protocol

import numpy as np

from squealbox.result import COMPLETED
from squealbox.studies.analysis import Task
from squealbox.studies.block import Block
from squealbox.studies.layout import Summary, open_ranges

BLOCK_SECONDS = 1.0  # what a killed run may lose, and long against the 10 ms it takes to make a block safe
LARGEST_BLOCK = 64 << 20  # bytes of one block
FIRST, FIRST_BATCH = 1, 256  # points of the first block, from which the size of the next is estimated
GROWTH = 8  # a block is at most this many times as large as the one before


class Pace(NamedTuple):
    """How far a sweep is: points done, in all and failed; seconds and points done since it was started or resumed."""

    done: int
    total: int
    failed: int
    seconds: float
    fresh: int

    @property
    def share(self) -> float:
        """Share of the points that are done."""
        return self.done / max(self.total, 1)

    @property
    def rate(self) -> float:
        """Points per second."""
        return self.fresh / self.seconds if self.seconds > 0.0 else 0.0

    @property
    def left(self) -> float:
        """Seconds left at this rate; infinite before the first block."""
        return (self.total - self.done) / self.rate if self.rate > 0.0 else np.inf

    def __str__(self) -> str:
        failed = f", {self.failed} failed" if self.failed else ""
        left = f", {_spoken(self.left)} left" if np.isfinite(self.left) and self.done < self.total else ""
        return f"{self.done} of {self.total} points{failed}, {self.rate:.4g}/s{left}"


Progress = Callable[[Pace], None]


class Target(Protocol):
    """Where finished blocks go: a `Store`, or a `Memory`."""

    done: dict[tuple[int, int], Summary]

    def add(self, block: Block) -> None:
        """Keep a block."""

    def log(self, text: str) -> None:
        """Say what happened."""


class Counted(Protocol):
    """Points that can be counted: a `Space`, or one that grows."""

    def __len__(self) -> int: ...

    def points(self, start: int, stop: int) -> Mapping[str, Any]:
        """Values of each parameter at these points."""


@dataclass(frozen=True)
class Piece:
    """Points that are asked for together; alone and tries tell a point to blame from one that was unlucky."""

    start: int
    stop: int
    tries: int = 0

    def __len__(self) -> int:
        return self.stop - self.start


class WorkInPieces:
    """Pieces to be taken by an executor, and blocks it brings back.

    slots : how many pieces are computed at the same time
    seconds : how long a piece should take; an executor raises it when handing out a piece costs much
    """

    def __init__(
        self, task: Task, points: Counted, target: Target, *, chunk: int | None = None, progress: Progress | None = None
    ) -> None:
        self.task, self.points, self.target = task, points, target
        self.slots, self.seconds = 1, BLOCK_SECONDS
        self.computed = 0.0  # seconds of analysis in all blocks
        self.blocks = 0
        self._open = open_ranges(target.done, len(points))
        self._returned: list[Piece] = []
        self._chunk, self._progress = chunk, progress
        self._size = chunk or (FIRST_BATCH if task.batched else FIRST)
        self._left = sum(stop - start for start, stop in self._open)
        self._before = len(points) - self._left
        self._failed = sum(summary.failed for summary in target.done.values())
        self._began = time.monotonic()

    @property
    def pace(self) -> Pace:
        """How far the sweep is."""
        total = len(self.points)
        done = total - self._left
        return Pace(done, total, self._failed, time.monotonic() - self._began, done - self._before)

    @property
    def left(self) -> int:
        """Points that are not finished."""
        return self._left

    def take(self) -> Piece | None:
        """The next piece to compute; None when all are taken."""
        if self._returned:
            return self._returned.pop(0)
        if not self._open:
            return None
        start, stop = self._open[0]
        size = self._chunk or self._sized()
        end = min(stop, (start // size + 1) * size if self._chunk else start + size)
        if end == stop:
            self._open.pop(0)
        else:
            self._open[0] = (end, stop)
        return Piece(start, end)

    def values(self, piece: Piece) -> Mapping[str, Any]:
        """The values of the parameters at the points of a piece."""
        return self.points.points(piece.start, piece.stop)

    def put_back(self, *pieces: Piece) -> None:
        """Pieces that are to be computed after all, before any other."""
        self._returned[:0] = [piece for piece in pieces if len(piece) > 0]

    def finish(self, block: Block, seconds: float) -> None:
        """Keep a block that took `seconds` to compute."""
        self.target.add(block)
        self.blocks += 1
        self.computed += seconds
        self._left -= len(block)
        self._failed += block.failed
        if block.failed:
            names, counts = np.unique(block.outcome[block.outcome != COMPLETED], return_counts=True)
            said = ", ".join(f"{count} {name}" for name, count in zip(names, counts, strict=True))
            first = next(iter(block.messages.values()), "")
            self.target.log(f"points {block.start} to {block.stop - 1}: {said} {first}".rstrip())
        self._learn(len(block), seconds, block.nbytes)
        self.report()

    def report(self) -> None:
        """Tell how far it is."""
        if self._progress is not None:
            self._progress(self.pace)

    def _sized(self) -> int:
        """Points of the next piece; near the end smaller, so that all slots have work to the last."""
        if self.slots == 1:
            return self._size
        return max(1, min(self._size, -(-self._left // (3 * self.slots))))

    def _learn(self, count: int, seconds: float, nbytes: int) -> None:
        wanted = int(count * self.seconds / max(seconds, 1e-6))
        fits = int(LARGEST_BLOCK * count / max(nbytes, 1))
        self._size = max(1, min(wanted, fits, GROWTH * max(self._size, count)))


def _spoken(seconds: float) -> str:
    minutes, seconds = divmod(round(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours} h {minutes} min" if hours else f"{minutes} min {seconds} s" if minutes else f"{seconds} s"
