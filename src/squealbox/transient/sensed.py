"""What late loops have sensed, as polynomials between its kinks, and when those act.

A kink of the j-th derivative of a command acts a delay later, and comes back through the brake in the derivative after
that. It is followed until (highest frequency x length of a piece)^j / j! is nothing.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from math import factorial
from typing import Any

import numpy as np

NODES = 8  # Chebyshev's points in which a command is told
ARC = 0.5  # radians of the brake's motion that they carry: 2 (ARC/4)^8/8! is 3e-12
FAINT = 1e-11  # share of a kink that is nothing
NEAR = 1e-9  # share of a stretch below which two instants in it are one
SAME = 1e-12  # share of a delay or a piece below which two instants are one
POINTS = np.cos(np.pi * (np.arange(NODES) + 0.5) / NODES)[::-1]
WEIGHTS = np.linalg.inv(np.vander(POINTS, increasing=True))  # of the powers of x, from values at the points
MEANS = np.array([2.0 / (k + 1) if k % 2 == 0 else 0.0 for k in range(NODES)]) @ WEIGHTS  # Fejer's rule on (-1, 1)


def points_of(begin: float, end: float) -> Any:
    """Chebyshev's points between two instants, (NODES,)."""
    return 0.5 * (begin + end) + 0.5 * (end - begin) * POINTS


def as_one(length: float, now: float) -> float:
    """The time [s] within which instants about `now` are one, where pieces are as long as `length` [s]."""
    return SAME * length + 16.0 * float(np.spacing(abs(now)))


def highest_kink(angle: float) -> int:
    """The first derivative whose kink is nothing over so many radians."""
    return next(j for j in range(1, 40) if angle**j / factorial(j) < FAINT)


@dataclass(eq=False)
class Sensed:
    """Commands (a,) as they were sensed since `begin`, each acting a time `late` (a,) [s] after; cut at limits (a,)."""

    begin: float
    late: Any
    limits: Any
    most: int
    edges: list[float] = field(default_factory=list)
    ends: list[float] = field(default_factory=list)
    weights: list[Any] = field(default_factory=list)  # (NODES, a) of the powers of x in each stretch
    due: list[tuple[float, int]] = field(default_factory=list)  # instants at which kinks act, and of which derivative

    def add(self, begin: float, end: float, values: np.ndarray) -> None:
        """A stretch of time with the uncut commands (NODES, a) at its points."""
        self.edges.append(begin)
        self.ends.append(end)
        self.weights.append(WEIGHTS @ values)
        for a in map(int, np.flatnonzero(np.isfinite(self.limits))):
            w = self.weights[-1][:, a]
            course = [w @ (-1.0) ** np.arange(NODES), *values[:, a], np.sum(w)]
            for limit in (-self.limits[a], self.limits[a]):
                beyond = np.array(course) > limit
                if np.any(beyond) and not np.all(beyond):
                    for instant in self._reached(begin, end, a, limit):
                        self.kink(instant, 1, a)

    def _reached(self, begin: float, end: float, a: int, limit: float) -> Any:
        """Instants at which a command reaches its limit in the last stretch."""
        weights = self.weights[-1][:, a].copy()
        weights[0] -= limit
        roots = np.roots(weights[::-1])
        real = roots.real[(np.abs(roots.imag) < NEAR) & (np.abs(roots.real) <= 1.0)]
        return 0.5 * (begin + end) + 0.5 * (end - begin) * np.sort(real)

    def kink(self, instant: float, order: int, only: int | None = None) -> None:
        """A kink in what is sensed acts a delay later, of one loop or of all."""
        if order >= self.most:
            return
        for a, late in enumerate(self.late):
            if only in (None, a):
                at = instant + late
                apart = self._apart(at)
                same = [k for k, (other, _) in enumerate(self.due) if abs(other - at) <= apart]
                order = min([order, *(self.due[k][1] for k in same)])
                self.due = [each for k, each in enumerate(self.due) if k not in same]
                self.due.append((at, order))

    def acted(self, now: float) -> int | None:
        """The least derivative of the forces that has a kink now; None without any."""
        apart = self._apart(now)
        orders = [order for at, order in self.due if at <= now + apart]
        self.due = [each for each in self.due if each[0] > now + apart]
        return min(orders, default=None)

    def _apart(self, now: float) -> float:
        return as_one(float(np.min(self.late)), now)

    def forget(self, before: float) -> None:
        """What acts no more."""
        while len(self.ends) > 1 and self.ends[0] < before:
            for kept in (self.edges, self.ends, self.weights):
                kept.pop(0)

    def commands(self, a: int, instants: Sequence[float] | np.ndarray, before: bool = False) -> Any:
        """The cut command of loop a that acts at instants (k,); 0 until it has arrived, at that instant `before` it."""
        sensed = np.asarray(instants, dtype=float) - self.late[a]
        apart = self._apart(float(instants[0]))
        if not self.edges:
            return np.zeros(len(sensed))
        places = np.clip(np.searchsorted(self.edges, sensed, side="left" if before else "right") - 1, 0, None)
        edges, ends = np.array(self.edges)[places], np.array(self.ends)[places]
        x = (2.0 * sensed - edges - ends) / (ends - edges)
        weights = np.array([self.weights[i][:, a] for i in places])
        u = np.zeros(len(x))
        for k in range(NODES - 1, -1, -1):
            u = u * x + weights[:, k]
        there = sensed > self.begin + apart if before else sensed >= self.begin - apart
        return np.where(there, np.clip(u, -self.limits[a], self.limits[a]), 0.0)
