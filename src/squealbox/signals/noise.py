"""How often does it squeal? Statistics over many stops: occurrence against speed and pressure; frequencies."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from squealbox.result import Array, Outcome, Result, quantity
from squealbox.signals.events import SquealEvents
from squealbox.signals.sampling import SignalError

CELLS = 5
FREQUENCY_WIDTH = 500.0  # Hz of a bin of the histogram


@dataclass(frozen=True, kw_only=True, eq=False)
class NoiseMatrix(Result):
    """Stops and noisy stops in cells of two braking quantities, as :func:`noise_matrix` returns them."""

    x_edges: Array = quantity("x_edge", "", "edges of the first quantity")
    y_edges: Array = quantity("y_edge", "", "edges of the second quantity")
    stops: Array = quantity("x y", "1", "stops in each cell")
    noisy: Array = quantity("x y", "1", "of them, those with an event")
    loudest: Array = quantity("x y", "dB", "highest peak level in each cell; NaN without an event")
    frequency_edges: Array = quantity("frequency_edge", "Hz", "edges of the histogram")
    histogram: Array = quantity("frequency", "1", "events in each bin of frequency")
    total: int = 0
    total_noisy: int = 0
    unplaced: int = 0

    table_over: ClassVar = ("x", "y")

    @property
    def share(self) -> Any:
        """Noisy stops over stops in each cell; NaN where nobody braked."""
        return np.where(self.stops > 0, self.noisy / np.maximum(self.stops, 1), np.nan)

    def summary(self) -> str:
        """Occurrence in all and per cell, and the frequencies."""
        if not self.outcome.ok:
            return self.outcome.told
        x, y = self.settings["x"], self.settings["y"]
        percent = 100.0 * self.total_noisy / self.total
        lines = [
            f"{self.total_noisy} of {self.total} stops squeal ({percent:.1f} %), {int(np.sum(self.histogram))} events"
        ]
        if self.unplaced < self.total:
            lines.append(f"noisy / stops; rows: {x}, columns: {y}")
            lines.append(
                " " * 20
                + "".join(f"{a:>9.4g}-{b:<9.4g}" for a, b in zip(self.y_edges[:-1], self.y_edges[1:], strict=True))
            )
            for i, (a, b) in enumerate(zip(self.x_edges[:-1], self.x_edges[1:], strict=True)):
                cells = "".join(
                    f"{f'{n:.0f} / {s:.0f}':^19}" for n, s in zip(self.noisy[i], self.stops[i], strict=True)
                )
                lines.append(f"{a:>9.4g}-{b:<9.4g} {cells}")
        if self.unplaced:
            lines.append(f"{self.unplaced} stops have no {x} or {y} and are in no cell")
        for i in np.nonzero(self.histogram)[0].tolist():
            lines.append(
                f"{self.frequency_edges[i]:7.0f} to {self.frequency_edges[i + 1]:5.0f} Hz: {self.histogram[i]:.0f}"
            )
        return "\n".join(lines)


def noise_matrix(
    stops: Sequence[SquealEvents],
    *,
    x: str = "speed",
    y: str = "pressure",
    x_edges: ArrayLike | None = None,
    y_edges: ArrayLike | None = None,
) -> NoiseMatrix:
    """The noise matrix of a campaign: in which conditions how many stops squeal.

    Parameters
    ----------
    stops : the events of each stop, those without an event too; a stop stands at the means of its braking quantities
    x, y : names of two of them
    x_edges, y_edges : edges of the cells, increasing; left out, five equal ones over what occurred. The last edge
        belongs to its cell

    Raises `SignalError` for no stops or edges that do not increase.
    """
    found = list(stops)
    if not found or not all(isinstance(each, SquealEvents) for each in found):
        raise SignalError("no stops: expected a list of SquealEvents, one for each stop")
    places = np.array(
        [[each.settings.get("stop", {}).get(name, np.nan) for name in (x, y)] for each in found], dtype=float
    )
    noisy = np.array([each.count > 0 for each in found])
    edges = [_edges(name, given, places[:, i]) for i, (name, given) in enumerate(((x, x_edges), (y, y_edges)))]
    inside = [np.searchsorted(each, places[:, i], side="right") - 1 for i, each in enumerate(edges)]
    for i, each in enumerate(edges):
        inside[i] = np.where(places[:, i] == each[-1], len(each) - 2, inside[i])
    shape = tuple(len(each) - 1 for each in edges)
    placed = np.all(
        [(k >= 0) & (k < n) & np.isfinite(p) for k, n, p in zip(inside, shape, places.T, strict=True)], axis=0
    )
    counts, loud, loudest = np.zeros(shape), np.zeros(shape), np.full(shape, np.nan)
    for i in np.nonzero(placed)[0].tolist():
        cell = (inside[0][i], inside[1][i])
        counts[cell] += 1
        loud[cell] += noisy[i]
        if noisy[i]:
            loudest[cell] = np.fmax(loudest[cell], float(np.max(found[i].peak_level)))
    frequencies = np.concatenate([np.atleast_1d(each.frequency) for each in found])
    top = max(float(np.max(frequencies, initial=0.0)), FREQUENCY_WIDTH)
    bins = np.arange(0.0, top + 2.0 * FREQUENCY_WIDTH, FREQUENCY_WIDTH)
    return NoiseMatrix(
        x_edges=edges[0], y_edges=edges[1], stops=counts, noisy=loud, loudest=loudest, frequency_edges=bins,
        histogram=np.histogram(frequencies, bins)[0].astype(float), total=len(found), total_noisy=int(np.sum(noisy)),
        unplaced=int(np.count_nonzero(~placed)), settings={"x": x, "y": y}, outcome=Outcome(),
    )  # fmt: skip


def _edges(name: str, given: ArrayLike | None, values: np.ndarray) -> Any:
    if given is not None:
        edges: Any = np.asarray(given, dtype=float)
        if edges.ndim != 1 or edges.size < 2 or not np.all(np.isfinite(edges)) or np.any(np.diff(edges) <= 0.0):
            raise SignalError(f"edges of {name}: expected two or more increasing numbers")
        return edges
    known = values[np.isfinite(values)]
    low, high = (float(np.min(known)), float(np.max(known))) if known.size else (0.0, 1.0)
    return np.linspace(low, high, CELLS + 1) if high > low else low + max(abs(low), 1.0) * np.array([-0.5, 0.5])
