"""Over which stretches of a parameter a branch is stable, and where a stable cycle exists beside stable sliding.

A stretch ends where stability changes (the fold, the onset), not at the last cycle followed beside it, and what is not
one stretch is told as several.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from squealbox.limit_cycles.branches.branch import Branch
from squealbox.matrices import runs_of_true
from squealbox.stability import complex_modes, critical_values
from squealbox.system import DesignOrSystem

NEUTRAL = 1e-6  # of a multiplier from the unit circle within which a cycle neither attracts nor repels
GRID = 201  # values at which steady sliding is looked at, between its onsets
UPRIGHT = 1e-6  # share of the range: what is narrower is a branch that goes straight up
CHANGES = ("fold", "period_doubling", "neimark_sacker")
BESIDE = 0.5  # share of the way to an onset by which amplitude squared, gone on as a line, may miss it

Stretch = tuple[float, float]


def onsets(design: DesignOrSystem, parameter: str, bounds: Stretch) -> list[float]:
    """Values at which steady sliding changes its stability, in rising order."""
    return [float(one.value) for one in critical_values(design, parameter, bounds).changes]


def stretches(one: Branch, births: Sequence[float] = (), margin: float = 0.0) -> list[tuple[float, float, bool]]:
    """(lowest, highest value, stable) of each stretch of a branch, in the order walked.

    Each reaches the special point that divides it from the next; the first and the last reach the onset among `births`,
    in the parameter's own unit, at which their cycles are born. Stable are multipliers within the unit circle by more
    than `margin` [-].
    """
    attracts = np.all(np.abs(one.multipliers[:, 1:]) < 1.0 - margin, axis=1)
    found = []
    for first, last in runs_of_true(attracts) + runs_of_true(~attracts):
        ends = _birth(one, births, 0, 1) if first == 0 else _divide(one, first - 1)
        ends = ends + (_birth(one, births, -1, -2) if last == len(attracts) - 1 else _divide(one, last))
        values = [*one.value[first : last + 1], *ends]
        found.append((first, (float(min(values)), float(max(values)), bool(attracts[first]))))
    return [each for _, each in sorted(found)]


def stable_sliding(design: Any, parameter: str, bounds: Stretch) -> list[Stretch]:
    """Stretches of a parameter, within `bounds` in its own unit, on which steady sliding exists and is stable."""
    edges = np.unique([*np.linspace(*bounds, GRID), *onsets(design, parameter, bounds)])
    stable = np.asarray(complex_modes(design.replace({parameter: 0.5 * (edges[1:] + edges[:-1])})).stable)
    return [(float(edges[i]), float(edges[j + 1])) for i, j in runs_of_true(stable)]


def beside_sliding(branches: Sequence[Branch], quiet: Sequence[Stretch]) -> list[Stretch]:
    """Stretches on which a stable cycle exists beside stable sliding (`quiet`), as no eigenvalue shows."""
    births = [end for stretch in quiet for end in stretch]
    cycles = [(a, b) for one in branches for a, b, stable in stretches(one, births, NEUTRAL) if stable]
    edges = np.unique([*np.ravel(quiet), *np.ravel(cycles)])
    middles = 0.5 * (edges[1:] + edges[:-1])
    both = np.ones(middles.size, dtype=bool)
    for several in (cycles, quiet):
        both &= [any(a < middle < b for a, b in several) for middle in middles]
    found = [(float(edges[i]), float(edges[j + 1])) for i, j in runs_of_true(both)]
    return [(a, b) for a, b in found if b - a > UPRIGHT * float(np.ptp(edges))]


def _divide(one: Branch, i: int) -> list[float]:
    """Where stability changes between the points i and i + 1: at a bifurcation, else at a corner between them."""
    there = [(str(one.special_kind[k]), float(one.special_value[k])) for k in np.flatnonzero(one.special_point == i)]
    return ([value for kind, value in there if kind in CHANGES] or [value for _, value in there])[:1]


def _birth(one: Branch, births: Sequence[float], end: int, inner: int) -> list[float]:
    """The onset at which the cycles of an end are born: amplitude squared goes to zero there, about as a line."""
    if not births or len(one.value) < 2:
        return []
    (p, p_in), (size, size_in) = one.value[[end, inner]], np.max(one.amplitude[[end, inner]], axis=1) ** 2
    onset = min(births, key=lambda value: abs(value - p))
    if size >= size_in or np.any((one.value - onset) * (one.value - p) < 0.0):
        return []
    zero = p - size * (p_in - p) / (size_in - size)
    return [onset] if abs(zero - onset) <= BESIDE * abs(p - onset) else []
