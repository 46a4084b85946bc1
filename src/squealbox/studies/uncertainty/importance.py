"""Importance sampling from a mixture that has been to look: about the design point, about squealing points, and widely.

A sample about one design point misses squeal elsewhere and says nothing of it: its own spread looks small. So a first
sample is drawn half about the design point and half widely, N(0, s^2); the squealing points it finds, weighed, become
centres of the second, from which alone P follows:

    P = mean of phi(z)/h(z) over squealing z,    h = a mixture of normal densities

A share of h stays wide, so no squealing point can have an unbounded weight (a defensive mixture).
Source: T. Hesterberg 1995, Technometrics 37, 185-194; O. Cappe et al. 2004, J. Comput. Graph. Statist. 13, 907-929.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.studies.uncertainty.limit_state import LimitState

CENTRES = 40
WIDE = 0.2  # share of the second sample that stays wide
STARTS = 5  # searches for a nearer design point
APART = 0.9  # cosine between the directions of two of them, at most


@dataclass(frozen=True)
class Mixture:
    """Normal densities about `centres` (m, d) with standard deviations `widths` (m,) and shares `weights` (m,)."""

    centres: Any
    widths: Any
    weights: Any

    def draw(self, count: int, rng: np.random.Generator) -> Any:
        """Points, shape (count, d), each part with its exact share."""
        ends = np.concatenate([[0.0], np.cumsum(self.weights)])
        parts = np.searchsorted(ends, (np.arange(count) + rng.uniform()) / count, side="right") - 1
        parts = np.minimum(parts, len(self.weights) - 1)
        noise = rng.standard_normal((count, self.centres.shape[1]))
        return self.centres[parts] + self.widths[parts, None] * noise

    def likelihood(self, points: np.ndarray) -> Any:
        """phi(z)/h(z), shape (n,)."""
        from scipy.special import logsumexp

        away = np.sum((points[:, None, :] - self.centres) ** 2, axis=2) / self.widths**2
        size = points.shape[1]
        log_h = logsumexp(-0.5 * away - size * np.log(self.widths), b=self.weights, axis=1)
        return np.exp(-0.5 * np.sum(points**2, axis=1) - log_h)


@dataclass(frozen=True)
class WideSample:
    """Squealing points (m, d) of the first sample with their weights, and how wide it was."""

    points: Any
    weights: Any
    width: float

    def starts(self, known: np.ndarray | None) -> Iterator[Any]:
        """Squealing points nearest to 0 in directions that differ from each other and from `known`."""
        taken = [] if known is None else [known / max(float(np.linalg.norm(known)), 1e-300)]
        length = np.linalg.norm(self.points, axis=1)
        count = 0
        for i in np.argsort(length, kind="stable"):
            direction = self.points[i] / max(length[i], 1e-300)
            if count < STARTS and all(float(direction @ other) < APART for other in taken):
                taken.append(direction)
                count += 1
                yield self.points[i]

    def probability(self, state: LimitState, z: np.ndarray, count: int, seed: int) -> tuple[float, float]:
        """P and its coefficient of variation from a second sample."""
        rng = np.random.default_rng([seed, 2])
        size = len(z)
        centres = [z[None, :]]
        if len(self.points):
            ends = np.cumsum(self.weights) / np.sum(self.weights)
            places = np.searchsorted(ends, (np.arange(CENTRES) + rng.uniform()) / CENTRES)
            centres.append(self.points[np.minimum(places, len(ends) - 1)])
        near = np.concatenate(centres)
        shares = np.full(len(near), (1.0 - WIDE) / len(near))
        mixture = Mixture(
            np.concatenate([near, np.zeros((1, size))]),
            np.append(np.ones(len(near)), self.width),
            np.append(shares, WIDE),
        )
        points = mixture.draw(count, rng)
        hits = np.where(state(points) < 0.0, mixture.likelihood(points), 0.0)
        mean, error = float(np.mean(hits)), float(np.std(hits, ddof=1) / np.sqrt(count))
        return mean, error / mean if mean > 0.0 else np.nan


def wide_sample(state: LimitState, z: np.ndarray | None, count: int, seed: int) -> WideSample:
    """The first sample: half about the design point `z` (None when there is none yet), half as wide as it is far."""
    rng = np.random.default_rng([seed, 1])
    size = state.dimension
    far = 4.0 if z is None else float(np.linalg.norm(z))
    width = max(1.5, (far + 1.0) / np.sqrt(size))
    centres = np.zeros((1, size)) if z is None else np.stack([np.zeros(size), z])
    widths = np.array([width, 1.0])[: len(centres)]
    mixture = Mixture(centres, widths, np.full(len(centres), 1.0 / len(centres)))
    points = mixture.draw(max(count, 2), rng)
    squeals = state(points) < 0.0
    return WideSample(points[squeals], mixture.likelihood(points)[squeals], width)
