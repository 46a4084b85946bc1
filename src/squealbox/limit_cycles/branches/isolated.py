"""Cycles and branches that no Hopf point leads to, found from where long transients settle.

A large stick-slip cycle beside stable sliding is not born in a Hopf point, so continuation alone never meets it. Runs
from many states do: what each settles to is solved for by shooting, equal cycles are counted once, and each new one
starts a branch that is followed both ways. Runs find stable cycles only; unstable ones lie on the branches.
"""

from types import SimpleNamespace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import public
from squealbox.family import Bounds, DesignOrRecipe, Family, Varied
from squealbox.limit_cycles.branches.branch import Branch, branch
from squealbox.limit_cycles.branches.joined import joined
from squealbox.limit_cycles.cycles.cycle import Cycle
from squealbox.limit_cycles.cycles.field import Autonomous
from squealbox.limit_cycles.cycles.remembering import Remembering, field_of
from squealbox.limit_cycles.cycles.shooting import shooting
from squealbox.limit_cycles.cycles.starting import first_guess, steady_state
from squealbox.limit_cycles.cycles.variation import fly
from squealbox.parameters import ParameterError
from squealbox.system import DesignOrSystem

ALIKE = 1e-2  # of the size: extremes and period by which two settled motions are one cycle
SWINGS = (0.3, 6.0)  # largest speeds of the starts, in sliding speeds


@public()
def settled_cycles(
    design_or_system: DesignOrSystem, starts: ArrayLike = 16, *, settle: float | None = None, seed: int = 0
) -> tuple[Cycle, ...]:
    """The stable cycles that runs from many states settle to, each once, the largest first.

    Parameters
    ----------
    design_or_system : a design or a `System`, with constant loads and speeds
    starts : how many states are drawn, or the states (q, qd) themselves, shape (starts, 2 dof) [m, m/s]. Drawn states
        are sums of modes with random phases, with largest speeds from 0.3 to 6 sliding speeds, evenly in the logarithm
    settle : [s] of each run; None takes 300 periods of the slowest mode
    seed : of the draw

    Returns
    -------
    tuple of :class:`Cycle`, empty where every run settles on steady sliding or is not periodic.

    Accuracy: each cycle that of :func:`shooting`; how complete the list is depends on the starts. Source: this module.

    >>> from squealbox import DrumBrake, LinearSlope
    >>> drum = DrumBrake(friction=LinearSlope(0.3, -0.05), reading="consistent")  # sliding is stable below 0.3327
    >>> [cycle.stable for cycle in settled_cycles(drum, 8)]
    [True]
    """
    field = field_of(design_or_system)
    given = np.asarray(starts, dtype=float)
    states = drawn_states(field, int(given), seed) if given.ndim == 0 else given
    if states.ndim != 2 or states.shape[1] != 2 * field.system.size or not np.all(np.isfinite(states)):
        raise ParameterError(
            "settled_cycles", "starts", np.shape(starts), f"finite states, shape (k, {2 * field.system.size})"
        )
    found: list[Cycle] = []
    for state in states:
        cycle = _settled(field, state, settle, found)
        if cycle is not None:
            found.append(cycle)
    return tuple(sorted(found, key=lambda cycle: -float(np.max(cycle.amplitude))))


def drawn_states(field: Autonomous, count: int, seed: int = 0) -> Any:
    """`count` states about steady sliding (or about rest, where there is none), shape (count, 2 dof)."""
    if count < 1:
        raise ParameterError("settled_cycles", "starts", count, "at least 1")
    rng = np.random.default_rng(seed)
    steady = np.nan_to_num(steady_state(field))
    half = field.system.size
    rates, shapes = field.own_modes()
    vectors = np.vstack([shapes, shapes * 1j * rates])
    weights = rng.normal(size=(count, len(rates))) * np.exp(2j * np.pi * rng.random((count, len(rates))))
    states = np.real(weights @ vectors.T)
    speed = np.max(np.abs(states[:, half:]), axis=1, keepdims=True)
    sliding = float(np.max(np.abs(field.V), initial=0.0)) or 1.0
    low, high = np.log(SWINGS)
    wanted = sliding * np.exp(low + (high - low) * (np.arange(count)[:, None] + 0.5) / count)
    return steady + states * wanted / np.where(speed > 0.0, speed, 1.0)


def _settled(field: Autonomous, state: np.ndarray, settle: float | None, known: list[Cycle]) -> Cycle | None:
    """The cycle a run from `state` settles to, unless it is a known one or none."""
    half = field.system.size
    x, period, outcome = first_guess(field, (state[:half], state[half:]), settle)
    if not outcome.ok:
        return None
    run = fly(field, x, period, 1e-9, np.linspace(0.0, period, 257))
    if not run.outcome.ok or any(_alike(cycle, period, run.q.min(axis=0)[:half], run.q.max(axis=0)[:half])
                                 for cycle in known):  # fmt: skip
        return None
    known_start = (state[:half], state[half:]) if isinstance(field, Remembering) else (x[:half], x[half:], period)
    cycle = shooting(field.asked, known_start, settle=settle)
    if not cycle.stable or any(_alike(other, cycle.period, cycle.lowest, cycle.highest) for other in known):
        return None
    return cycle


def _alike(cycle: Cycle, period: float | np.ndarray, lowest: np.ndarray, highest: np.ndarray) -> bool:
    """True when a motion has the period of the cycle, or a multiple of it, and its extremes."""
    turns = max(1.0, np.round(float(period / cycle.period)))
    size = 2.0 * np.max(cycle.amplitude)
    apart = max(np.max(np.abs(cycle.lowest - lowest)), np.max(np.abs(cycle.highest - highest))) / size
    return bool(abs(float(period / cycle.period) / turns - 1.0) < ALIKE and apart < ALIKE)


@public()
def isolated_branches(
    design: DesignOrRecipe,
    parameter: Varied,
    bounds: Bounds | None = None,
    *,
    values: Any = 3,
    starts: int = 12,
    settle: float | None = None,
    known: tuple[Branch, ...] = (),
    seed: int = 0,
    **walk: Any,
) -> tuple[Branch, ...]:
    """Branches through the cycles that long runs settle to, each followed both ways by shooting.

    Parameters
    ----------
    design, parameter, bounds : as for :func:`branch`, in the parameter's own unit
    values : how many values of the parameter runs are made at, evenly inside the bounds, or the values themselves
    starts, settle, seed : as for :func:`settled_cycles`; settle in [s]
    known : branches whose cycles are not followed again
    walk : options of :func:`branch`, such as points and largest_step

    Accuracy: that of :func:`branch` by shooting; how complete the list is depends on values and starts. Source: this
    module.

    >>> from squealbox import DrumBrake, LinearSlope
    >>> drum = DrumBrake(friction=LinearSlope(0.3, -0.05), reading="consistent")
    >>> len(isolated_branches(drum, "friction.static", (0.1, 0.32), values=[0.3], starts=8, points=5))
    1
    """
    family, found = Family.within("isolated_branches", design, parameter, bounds), list(known)
    low, high = family.spans[0]
    at = low + (high - low) * (np.arange(values) + 0.5) / values if np.ndim(values) == 0 else np.asarray(values, float)
    for value in at:
        for cycle in settled_cycles(family.system(float(value)), starts, settle=settle, seed=seed):
            if any(passes(one, cycle, float(value)) for one in found):
                continue
            start = {"start": cycle, "value": float(value), "method": "shooting", **walk}
            ways = [branch(design, {family.name: (low, high)}, direction=way, **start) for way in (-1.0, 1.0)]
            one = joined(*ways)
            if not any(lies_on(one, other) for other in found):
                found.append(one)
    return tuple(found[len(known) :])


def lies_on(one: Branch, other: Branch) -> bool:
    """True when most points of a branch lie on another one: the same branch, met again."""
    on = 0
    for i in range(len(one.value)):
        at = SimpleNamespace(period=one.period[i], lowest=one.lowest[i], highest=one.highest[i],
                             amplitude=one.amplitude[i])  # fmt: skip
        on += passes(other, at, float(one.value[i]))
    return len(one.value) > 0 and on > 0.5 * len(one.value)


def passes(one: Branch, cycle: Any, value: float) -> bool:
    """True when a branch goes through a cycle at a value of the parameter."""
    p = one.value - value
    for i in np.flatnonzero(p[:-1] * p[1:] <= 0.0):
        share = -p[i] / (p[i + 1] - p[i]) if p[i + 1] != p[i] else 0.0
        ends = [(a[i], a[i + 1]) for a in (one.period, one.lowest, one.highest)]
        period, lowest, highest = ((1.0 - share) * a + share * b for a, b in ends)
        if _alike(cycle, period, lowest, highest):
            return True
    return False
