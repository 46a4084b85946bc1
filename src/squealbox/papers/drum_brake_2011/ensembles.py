"""Tens of thousands of transients of one reading: maps of what squeals, and the maxima over the friction coefficient.

A trajectory starts from rest, the load applied at once, as in the paper, and lasts 0.05 s. Its level is the largest
over x and y of 2 pi f A / V_B, with A the amplitude and f the frequency over the last fifth of the run: the speed of
the vibration as a share of the belt's. Friction reverses once that is about 1, so a cycle has a level near 1 or above,
and what dies out has one that falls without limit. It squeals when its level is above 0.1.

Where that differs from what the eigenvalues of steady sliding say, the same trajectory goes on to 0.10 s. When it still
squeals, at 0.84 of its level or more, it is on a cycle that exists beside stable sliding; when not, it was still
ringing, and the run too short. The weakest decay this tells from a cycle is 3.5 1/s.

A map begins with every fourth value of both axes. Each square whose corners are of different kinds, or in which the
eigenvalues change sign, is halved down to the map's own grid; the rest takes the kind of its corners.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.papers.drum_brake_2011.cases import (
    ALL_READINGS,
    DEFAULT_READING,
    DURATION,
    INFERRED,
    MAP_ANGLES,
    PRINTED,
    Case,
)
from squealbox.stability import stability_map
from squealbox.system import as_system, equilibrium
from squealbox.transient import Ensemble, Method, simulate_ensemble

LEVEL = 0.1  # of V_B: a tenth of what a cycle limited by friction has
LONGER = 0.10  # s: twice the paper's run
HOLDS = 0.84  # of its level is what a cycle keeps from 0.05 s to then
SETTLED = 0.5  # s: twenty times the slowest decay away from an onset
OBSERVED = ("amplitude", "frequency", "poincare")  # the same everywhere, so that all maps share a kernel
# A run of 0.05 s takes about 400 steps and 9,000 at most, the longest of all 28,000. One that needs more hangs.
METHOD = Method("taylor", rtol=1e-7, most_steps=50_000)
COARSE = 4  # values of the map from one to the next with which it begins
NUDGE = 1e-3  # of the equilibrium, how far from it the motions begin that show whether sliding is stable

QUIET, SQUEAL, BESIDE, RINGING, HELD, UNKNOWN = range(6)
MEANS = (
    "stable in both",
    "squeals in both",
    "squeals beside stable sliding",
    "stable, still ringing at 0.05 s",
    "unstable, yet quiet",
    "not decided",
)


@dataclass(frozen=True)
class Sizes:
    """How many values each axis has: of the centres of pressure, of friction with load or speed, of friction alone.

    `planes` are the readings whose friction is varied together with load and speed, `mapped` those whose centres of
    pressure are mapped by transients, `vector` says whether figures are written as SVG as well as PNG.
    """

    pressure: int = 141
    plane: int = 101
    friction: int = 201
    planes: tuple[str, ...] = (DEFAULT_READING,)
    mapped: tuple[str, ...] = (DEFAULT_READING, "eq1_printed")
    vector: bool = False


PRINTED_READINGS = tuple(name for name in ALL_READINGS if name not in (*INFERRED, PRINTED))
USUAL, FINE = Sizes(), Sizes(561, planes=(DEFAULT_READING, "eq3"), mapped=PRINTED_READINGS, vector=True)


@dataclass(frozen=True)
class SquealMap:
    """A plane of two parameters by both roads, arrays (x, y): `growth` [1/s], `level` [-], `kind`, one of `MEANS`.

    `x` and `y` are in SI units. `run` is True where a trajectory was run; elsewhere `kind` is that of the corners of
    the square around, and `level` is NaN, as it is where a trajectory did not reach its end.
    """

    x: Any
    y: Any
    growth: Any
    level: Any
    kind: Any
    run: Any

    @property
    def shares(self) -> list[float]:
        """The share of the plane of each kind, in the order of `MEANS`."""
        return [float(np.mean(self.kind == kind)) for kind in range(len(MEANS))]


@dataclass(frozen=True)
class Maxima:
    """The last eight maxima of x [m] over mu, shape (mu, 8), from rest and from beside steady sliding at `sliding`."""

    mu: Any
    from_rest: Any
    from_sliding: Any
    sliding: Any


def pressure(case: Case, size: int = USUAL.pressure) -> SquealMap:
    """Both centres of pressure, from 20 to 160 deg."""
    angles = np.deg2rad(np.linspace(*MAP_ANGLES, size))
    return _map(case, {"theta1": angles, "theta2": angles})


def friction_and_load(case: Case, size: int = USUAL.plane) -> SquealMap:
    """The friction coefficient from 0.05 to 0.6 and the load on both shoes from 0.25 to 25 kN."""
    return _map(case, {"friction.static": np.linspace(0.05, 0.6, size), "load": np.linspace(250.0, 25e3, size)})


def friction_and_speed(case: Case, size: int = USUAL.plane) -> SquealMap:
    """The friction coefficient from 0.05 to 0.6 and the sliding speed from 0.02 to 1 m/s."""
    speed = np.linspace(0.02, 1.0, size)
    return _map(case, {"friction.static": np.linspace(0.05, 0.6, size), "sliding_speed": speed})


def maxima(case: Case, size: int = USUAL.friction) -> Maxima:
    """The motion after 0.5 s over the friction coefficient, from two starts."""
    over = {"friction.static": np.linspace(0.05, 0.6, size)}
    sliding = equilibrium(as_system(case.design().replace(over))).q
    beside = ((1.0 + NUDGE) * sliding, np.zeros_like(sliding))
    runs = [_run(case, over, SETTLED, start=start) for start in ("rest", beside)]
    rest, near = (np.where(np.isfinite(level(case, run))[:, None], run["poincare"][:, 0], np.nan) for run in runs)
    return Maxima(over["friction.static"], rest, near, sliding[:, 0])


def level(case: Case, run: Ensemble, speed: np.ndarray | None = None) -> Any:
    """Speed of the vibration over that of the belt at the end of each trajectory; NaN where it did not get there."""
    ended = run.ended == "completed"
    frequency, amplitude = (np.where(ended[..., None], run[name], 0.0) for name in ("frequency", "amplitude"))
    vibration = np.max(2.0 * np.pi * np.nan_to_num(frequency) * amplitude, axis=-1)  # no maxima: no vibration
    return np.where(ended, vibration / (case.speed if speed is None else speed), np.nan)


def _map(case: Case, over: dict[str, Any], coarse: int = COARSE) -> SquealMap:
    x, y = over.values()
    growth = stability_map(case.design(), over, mechanism=False).growth_rate
    plane = dict(zip(over, np.meshgrid(x, y, indexing="ij"), strict=True))
    levels, kind = np.full(growth.shape, np.nan), np.full(growth.shape, UNKNOWN)

    def run(there: np.ndarray) -> None:
        chosen = {name: values[there] for name, values in plane.items()}
        levels[there], kind[there] = _kinds(case, chosen, growth[there])

    made = refined(growth > 0.0, kind, run, coarse)
    return SquealMap(x, y, growth, levels, kind, made)


def refined(unstable: np.ndarray, kind: np.ndarray, run: Callable[[Any], None], coarse: int) -> Any:
    """Let `run` fill `kind` where it differs from its neighbours, and fill the rest; True where it was run.

    Begins with every `coarse`-th value of both axes, a power of two; a square is halved whose corners differ in kind or
    that holds stable and `unstable` points.
    """
    while coarse > 1 and any((size - 1) % coarse for size in kind.shape):
        coarse //= 2
    made = np.zeros(kind.shape, dtype=bool)
    wanted = np.zeros(kind.shape, dtype=bool)
    wanted[::coarse, ::coarse] = True
    step = coarse
    while True:
        new = wanted & ~made
        if np.any(new):
            run(new)
        made |= new
        if step == 1:
            break
        split = _differ(kind, step, step) | _differ(unstable, step, 1)
        split &= ~_differ(~made, step, step) & made[:-1:step, :-1:step]
        half = step // 2
        for i, j in np.ndindex(3, 3):
            wanted[i * half :: step, j * half :: step][: split.shape[0], : split.shape[1]] |= split
        step = half
    filled = made.copy()
    while step < coarse:  # from the finest squares up, so that each takes the kind of its own corner
        step *= 2
        for i, j in np.ndindex(step, step):
            here = kind[i::step, j::step]
            corner = kind[::step, ::step][: here.shape[0], : here.shape[1]]
            known = filled[i::step, j::step]
            from_corner = made[::step, ::step][: here.shape[0], : here.shape[1]]
            here[~known & from_corner] = corner[~known & from_corner]
            known |= from_corner
    return made


def _differ(values: np.ndarray, size: int, step: int) -> Any:
    """Whether the values in each square of this size differ; corners alone with `step` = `size`, else every point."""
    rows, columns = ((n - 1) // size for n in values.shape)
    first = values[: rows * size : size, : columns * size : size]
    found = np.zeros(first.shape, dtype=bool)
    for i in range(0, size + 1, step):
        for j in range(0, size + 1, step):
            found |= values[i::size, j::size][:rows, :columns] != first
    return found


def _kinds(case: Case, there: dict[str, Any], growth: np.ndarray) -> tuple[Any, Any]:
    """The level after 0.05 s at these points, and their kinds."""
    first = _run(case, there, DURATION)
    short = level(case, first, there.get("sliding_speed"))
    unstable = growth > 0.0
    kind = np.where(unstable, SQUEAL, QUIET)
    disputed = (short > LEVEL) != unstable
    if np.any(disputed):
        again = {name: values[disputed] for name, values in there.items()}
        on = _run(case, again, LONGER - DURATION, start=(first.q[disputed], first.qd[disputed]))
        longer = level(case, on, again.get("sliding_speed"))
        kind[disputed] = _why(unstable[disputed], short[disputed], longer)
    kind[~np.isfinite(short) | ~np.isfinite(growth)] = UNKNOWN
    return short, kind


def _why(unstable: np.ndarray, short: np.ndarray, longer: np.ndarray) -> Any:
    """What a trajectory is that differs from the eigenvalues, by its levels after both runs."""
    squeals = longer > LEVEL
    holds = squeals & (longer > HOLDS * short)
    kind = np.where(unstable, np.where(squeals, SQUEAL, HELD), np.where(holds, BESIDE, RINGING))
    return np.where(np.isfinite(longer), kind, UNKNOWN)


def _run(case: Case, over: dict[str, Any], duration: float, start: Any = "rest") -> Ensemble:
    return simulate_ensemble(case.design(), over, duration, METHOD, OBSERVED, start=start)
