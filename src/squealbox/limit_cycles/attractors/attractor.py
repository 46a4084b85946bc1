"""Telling attractors apart: motions that ended alike are one attractor, which shooting then confirms and refines.

The signature of a motion that repeats itself is (ln A, A_i/A, c_i/A) with A_i half the range of each degree of freedom,
A the largest of them and c_i its middle beside steady sliding; of one that does not, only those of 20 % nearness count.
Motions are of one attractor when a chain of neighbours within `SAME_SIGNATURE` joins them (single linkage).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from squealbox.limit_cycles.attractors.settling import FAILED, MOVING, REPEATS, RESTS, Known, Settled
from squealbox.limit_cycles.cycles.cycle import Cycle
from squealbox.limit_cycles.cycles.shooting import shooting
from squealbox.system import System
from squealbox.words import sizes_told

SLIDING, REST, CYCLE, VIBRATION, IRREGULAR = "steady sliding", "rest elsewhere", "cycle", "vibration", "irregular"
UNSTABLE = "unstable cycle"
SAME_SIGNATURE, SAME_IRREGULAR = 0.01, 0.2
SAME_CYCLE = 1e-6  # in period and extremes: cycles found twice
MOST_SEARCHES = 12  # without damping every start is a motion of its own: the groups with most members are searched
NOT_SETTLED, NO_END = -1, -2


@dataclass(frozen=True, eq=False)
class Attractor:
    """What motions settle to.

    kind : "steady sliding", "rest elsewhere", "cycle" (confirmed by shooting), "vibration" (repeats itself; not
        confirmed, or not of the dozen with most starts that are searched for), "unstable cycle" (a motion that lingers
        beside one) or "irregular" (does not repeat itself: quasi-periodic, chaotic or very slow)
    low, high : extremes of each degree of freedom [m], of the motion that came closest to it
    maxima : its last eight maxima [m], shape (n, 8), newest first
    frequency : of the maxima [Hz]
    start : (q, qd) on it
    cycle : the refined cycle, or the failed search for one; None where none was asked for
    """

    kind: str
    low: Any
    high: Any
    maxima: Any
    frequency: float
    start: tuple[Any, Any]
    cycle: Cycle | None = None

    @property
    def amplitude(self) -> Any:
        """Half range of each degree of freedom [m]."""
        return 0.5 * (self.high - self.low)

    def summary(self, system: System | None = None) -> str:
        """One line: kind, amplitude, frequency; with the `system` freedoms have names, and those that turn radians."""
        if self.kind in (SLIDING, REST):
            return self.kind
        count = len(self.low)
        names, units = ([""] * count, ["m"] * count) if system is None else (system.names, system.units)
        sizes = sizes_told(names, self.amplitude, units, 4)
        if self.kind in (CYCLE, UNSTABLE) and self.cycle is not None:
            return f"{self.cycle.stability} cycle, amplitude {sizes}, {self.cycle.frequency:.6g} Hz"
        return f"{self.kind}, amplitude {sizes}, maxima at {self.frequency:.5g} Hz"


def attractors(
    system: System, ends: Settled, refine: bool, known: Sequence[Attractor] = ()
) -> tuple[list[Attractor], Any]:
    """The attractors of one system, steady sliding first, then by size; and the index of each motion's own.

    The index is `NOT_SETTLED` or `NO_END` for motions without one. What is known need not be confirmed again.
    """
    label = np.full(len(ends.kind), NOT_SETTLED)
    label[ends.kind == FAILED] = NO_END
    groups: list[tuple[Attractor, Any]] = []
    centre, half = 0.5 * (ends.low + ends.high), 0.5 * np.ptp(np.stack([ends.low, ends.high]), axis=0)
    beside = centre - ends.scales.rest
    size = (ends.scales.speed / ends.scales.slowest)[:, None]
    near = np.all(np.abs(beside) <= half + 1e-3 * size, axis=-1)
    resting = ends.kind == RESTS
    groups += _grouped(ends, np.flatnonzero(resting & near), np.zeros((len(label), 1)), 1.0, SLIDING)
    groups += _grouped(ends, np.flatnonzero(resting & ~near), beside / size, SAME_SIGNATURE, REST)
    with np.errstate(divide="ignore", invalid="ignore"):
        largest = np.max(half, axis=-1)[:, None]
        signature = np.concatenate([np.log(largest), half / largest, beside / largest], axis=-1)
    groups += _confirmed(system, _grouped(ends, np.flatnonzero(ends.kind == REPEATS), signature, SAME_SIGNATURE,
                                          VIBRATION), refine, known)  # fmt: skip
    groups += _grouped(ends, np.flatnonzero(ends.kind == MOVING), signature, SAME_IRREGULAR, IRREGULAR)
    for i, (_, members) in enumerate(groups):
        label[members] = i
    return [attractor for attractor, _ in groups], label


def linked(points: np.ndarray, reach: float) -> Any:
    """Group number of each point (k, m): chains of neighbours whose coordinates differ by at most `reach`."""
    from scipy.sparse import coo_array
    from scipy.sparse.csgraph import connected_components
    from scipy.spatial import KDTree

    cells, of = np.unique(np.round(4.0 * points / reach), axis=0, return_inverse=True)
    pairs = KDTree(cells).query_pairs(4.0, p=np.inf, output_type="ndarray")
    graph = coo_array((np.ones(len(pairs)), (pairs[:, 0], pairs[:, 1])), shape=(len(cells), len(cells)))
    return connected_components(graph, directed=False)[1][of.ravel()]


def _grouped(
    ends: Settled, which: np.ndarray, signature: np.ndarray, reach: float, kind: str
) -> list[tuple[Attractor, Any]]:
    """Attractors and their members, the largest motion last."""
    if which.size == 0:
        return []
    number = linked(signature[which], reach)
    found = []
    for group in range(int(np.max(number)) + 1):
        members = which[number == group]
        best = members[np.argmax(np.where(ends.arrived, -1.0, ends.time)[members])]  # that had most time to settle
        found.append((_attractor(ends, int(best), kind), members))
    return sorted(found, key=lambda pair: float(np.max(pair[0].amplitude)))


def _attractor(ends: Settled, i: int, kind: str) -> Attractor:
    tone = ends.frequency[i][np.argmax(ends.high[i] - ends.low[i])]
    return Attractor(kind, ends.low[i], ends.high[i], ends.maxima[i], float(tone), (ends.q[i], ends.qd[i]))


def _confirmed(
    system: System, groups: list[tuple[Attractor, Any]], refine: bool, known: Sequence[Attractor]
) -> list[tuple[Attractor, Any]]:
    """Each as a cycle where shooting from its end finds one of its size; groups of the same cycle as one."""
    if not refine:
        return groups
    found: list[tuple[Attractor, Any]] = []
    searched = sorted(range(len(groups)), key=lambda i: -len(groups[i][1]))[:MOST_SEARCHES]
    for i, (attractor, members) in enumerate(groups):
        if i not in searched:
            found.append((attractor, members))
            continue
        cycle = next((one.cycle for one in known if one.cycle and _alike(one.cycle, attractor, SAME_SIGNATURE)), None)
        cycle = cycle or shooting(system, attractor.start, settle=0.0)
        if not (cycle.outcome.ok and _alike(cycle, attractor, SAME_SIGNATURE)):
            found.append((_with(attractor, VIBRATION, cycle), members))
            continue
        twin = next((i for i, (other, _) in enumerate(found)
                     if other.kind in (CYCLE, UNSTABLE) and _alike(cycle, other, SAME_CYCLE)), None)  # fmt: skip
        if twin is None:
            found.append((_with(attractor, UNSTABLE if cycle.stability == "unstable" else CYCLE, cycle), members))
        else:
            found[twin] = (found[twin][0], np.concatenate([found[twin][1], members]))
    return found


def stable_cycles(found: Sequence[Attractor]) -> list[Known]:
    """Those of the attractors that motions may arrive at."""
    cycles = [each.cycle for each in found if each.kind == CYCLE and each.cycle is not None]
    return [Known(c.lowest, c.highest, float(c.period), float(np.abs(c.multipliers[1]))) for c in cycles]


def _with(attractor: Attractor, kind: str, cycle: Cycle) -> Attractor:
    """The attractor with what shooting found: its extremes and start where that is a cycle."""
    if kind not in (CYCLE, UNSTABLE):
        return replace(attractor, cycle=cycle)
    return replace(attractor, kind=kind, low=cycle.lowest, high=cycle.highest, start=cycle.start, cycle=cycle)


def _alike(cycle: Cycle, attractor: Attractor, reach: float) -> bool:
    size = float(np.max(attractor.amplitude))
    off = np.abs(np.concatenate([cycle.lowest - attractor.low, cycle.highest - attractor.high]))
    return bool(np.max(off) <= reach * size)
