"""Where stable sliding and a vibration coexist: the part of a plane of two parameters no eigenvalue sees.

In the first parameter the region ends above where steady sliding loses its stability, and below where the last
vibration ends. Both edges are found on two roads:

    ensembles   many starts far from sliding at each point of a grid; then the vibrations found just below the onset
                are followed down, in steps that are halved where one dies (all rows side by side)
    curves      `hopf_curve` for the upper edge; branches of exact cycles by shooting, walked down to their ends, for
                the lower one (`cycle_ends`)
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any, ClassVar

import numpy as np

from squealbox.arguments import public
from squealbox.family import Bounds, DesignOrRecipe, Family
from squealbox.limit_cycles.attractors.attractor import linked
from squealbox.limit_cycles.attractors.basins import unit_starts
from squealbox.limit_cycles.attractors.settling import (
    FAILED,
    LOOSE,
    REPEATS,
    RESTS,
    TIGHT,
    Batch,
    Scales,
    Settled,
    settle,
)
from squealbox.limit_cycles.branches.branch import branch
from squealbox.limit_cycles.branches.curves import PointCurve, hopf_curve
from squealbox.parameters import ParameterError
from squealbox.result import COMPLETED, Array, Outcome, Result, quantity
from squealbox.stability import critical_value

STRETCHES = 5
FOLLOWED = 6  # vibrations of different size followed down in each row
STEPS = 40  # of the range in the first parameter, before they are halved
HALVINGS = 8
ABOVE = 0.01  # of the range: how far above the edge a branch of exact cycles begins
TURNS = ("fold", "neimark_sacker", "period_doubling")


@dataclass(frozen=True, kw_only=True, eq=False)
class Coexistence(Result):
    """Region over two parameters, as :func:`coexistence` returns it."""

    x: Array = quantity("column", "", "first parameter of the grid, in its own unit")
    y: Array = quantity("row", "", "second parameter of the grid and of the edges, in its own unit")
    vibrates: Array = quantity("column row", "1", "share of the far starts that end in a vibration; NaN = all failed")
    stable: Array = quantity("column row", "1", "True where steady sliding is stable")
    onset: Array = quantity("row", "", "upper edge: sliding loses its stability; inf = beyond the range, NaN = below")
    end: Array = quantity(
        "row", "", "lower edge: the vibration followed down has ended; -inf = below the range, NaN = none"
    )
    resolution: Array = quantity("row", "", "of the lower edge: it lies at most this much below")
    amplitude: Array = quantity("row dof", "m", "amplitude of the last vibration, just above the lower edge")
    state: Array = quantity("row state", "m", "a state (q, q') on it")
    parameters: tuple[str, ...] = ()
    starts: int = 0
    hopf: PointCurve | None = None

    coordinates: ClassVar = {"column": "x", "row": "y"}
    table_over: ClassVar = ("column", "row")

    @property
    def share(self) -> float:
        """Share of the grid's points at which sliding is stable and a vibration was found as well."""
        return float(np.mean(self.stable & (self.vibrates > 0.0)))

    def summary(self) -> str:
        """The share of the plane, and the edges of each row."""
        if not self.outcome.ok:
            return self.outcome.told
        x, y = self.parameters
        lines = [f"stable sliding and vibration coexist at {100 * self.share:.1f} % of {self.stable.size} points"]
        rows = zip(self.y, self.end, self.onset, strict=True)
        lines += [f"  {y} {b:.5g}: {_edges(x, float(low), float(high))}" for b, low, high in rows]
        return "\n".join(lines)


def _edges(name: str, low: float, high: float) -> str:
    """The lower and the upper edge of a row in words."""
    if np.isnan(high):
        return "sliding is unstable from the lower end of the range"
    above = (
        f"sliding is stable up to {name} {high:.5g}" if np.isfinite(high) else "sliding is stable in the whole range"
    )
    if np.isnan(low):
        return f"{above}, and no lower edge of the vibration was found"
    return f"{above}, the vibration is there from {f'{name} {low:.5g}' if np.isfinite(low) else 'below the range'} on"


@public()
def coexistence(
    design: DesignOrRecipe,
    bounds: Mapping[str, Bounds],
    *,
    columns: int = 24,
    rows: int = 12,
    starts: int = 16,
    spread: float = 3.0,
    seed: int = 1,
    threads: int | None = None,
) -> Coexistence:
    """The region where stable sliding and a vibration coexist, over two parameters, by ensembles, and its Hopf curve.

    Parameters
    ----------
    design : a design
    bounds : dotted name to (low, high) for two parameters; the region is looked for along the first, in which more is
        less stable
    columns, rows : of the grid
    starts : far from sliding at each point, a Sobol sequence with `seed` in a box of `spread` [-] times V/w1 and V
    threads : as in :func:`basin`

    Outcome "completed". What is guaranteed: at each point that counts a vibration was run, and each lower edge is the
    end of one that was followed. That there is none beyond is not: a vibration no start has reached is not seen.
    Accuracy of the lower edge: `resolution`, the range over 40 x 256, at a fold; a cycle that loses its stability
    otherwise is left later, by up to some 1e-3 of the range, since what grows slowly is seen late. Source: as this
    module.

    >>> from squealbox import DrumBrake, LinearSlope
    >>> drum = DrumBrake(friction=LinearSlope(0.3, -0.05))
    >>> area = {"friction.static": (0.3, 0.5), "load": (900.0, 1100.0)}
    >>> coexistence(drum, area, columns=4, rows=2, starts=2).outcome.ok
    True
    """
    family = Family.within("coexistence", design, bounds, count=2)
    if family.recipe is not None:
        raise ParameterError("coexistence", "design", design, "a design, whose parameters have names")
    names, ends, far = family.parameters, family.spans[0], _Far(starts, spread, seed)
    x, y = (np.linspace(low, high, k) for (low, high), k in zip(family.spans, (columns, rows), strict=True))
    grid = _grid(design, names, x, y, far, threads)
    onset = np.array([_onset(design, names, ends, value) for value in y])
    onset = np.where(np.all(grid["stable"], axis=0), np.inf, onset)
    top = np.minimum(np.where(np.isfinite(onset) | grid["stable"][0], onset, x[0]), x[-1])
    followed = _followed(design, names, ends, top, y, replace(far, starts=4 * starts), threads)
    return Coexistence(
        inputs={"system": design}, settings={"spread": spread, "seed": seed}, outcome=Outcome(COMPLETED), x=x, y=y,
        onset=onset, parameters=names, starts=starts, hopf=hopf_curve(design, bounds), **grid, **followed,
    )  # fmt: skip


def cycle_ends(design: Any, region: Coexistence, rows: Sequence[int] | None = None) -> tuple[Any, Any]:
    """The lower edge on the other road: where the exact cycle of each row loses its stability, and how.

    From the last vibration followed, somewhat above the edge, a branch of exact cycles is walked down by shooting. The
    edge is the first fold, Neimark-Sacker or period doubling point on it, which is solved for.

    Returns
    -------
    value (rows,), in the unit of the first parameter, NaN where there is no vibration or the branch ends before such a
    point (at a corner); kind (rows,), the name of the point or how the branch ended
    """
    x, y = region.parameters
    reach = float(region.x[-1] - region.x[0])
    value, kind = np.full(len(region.y), np.nan), np.full(len(region.y), "", dtype=object)
    for i in range(len(region.y)) if rows is None else rows:
        if not np.isfinite(region.end[i]):
            continue
        own = design.replace({y: float(region.y[i])})
        edge, half = float(region.end[i] + region.resolution[i]), len(region.state[i]) // 2
        above = edge + ABOVE * reach
        ends = settle(Batch.over(own, {x: np.array([above])}), region.state[i][None, :half],
                      region.state[i][None, half:])  # fmt: skip
        walk = branch(own, {x: (edge - 0.5 * ABOVE * reach, 1.01 * above)}, (ends.q[0], ends.qd[0]), value=above,
                      method="shooting", direction=-1.0, points=80)  # fmt: skip
        turns = [j for j, name in enumerate(walk.special_kind) if name in TURNS]
        kind[i] = str(walk.special_kind[turns[0]]) if turns else str(walk.outcome)
        value[i] = walk.special_value[turns[0]] if turns else np.nan
    return value, kind.astype(str)


@dataclass(frozen=True)
class _Far:
    """Starts far from sliding, as many about each system, a Sobol sequence in a box of `spread` times V/w1 and V."""

    starts: int
    spread: float
    seed: int

    def settled(self, batch: Batch, count: int, rows: np.ndarray) -> Any:
        """How they end about the steady sliding of some of the `count` systems, one system after the other."""
        scales = Scales.of(batch, count).take(rows)
        n = scales.rest.shape[-1]
        cube = self.spread * unit_starts(2 * n, self.starts, self.seed, None)
        speed = scales.speed[:, None, None]
        q = scales.rest[:, None] + cube[None, :, :n] * speed / scales.slowest[:, None, None]
        start = q.reshape(-1, n), (cube[None, :, n:] * speed).reshape(-1, n)
        return settle(batch.take(np.repeat(rows, self.starts)), *start, stretches=STRETCHES, same=LOOSE)


def _grid(
    design: DesignOrRecipe, names: Sequence[str], x: np.ndarray, y: np.ndarray, far: _Far, threads: int | None
) -> Any:
    """Share of far starts that vibrate, and whether sliding is stable, over the grid."""
    plane = dict(zip(names, (v.ravel() for v in np.meshgrid(x, y, indexing="ij")), strict=True))
    count, shape = len(x) * len(y), (len(x), len(y), far.starts)
    ends = far.settled(Batch.over(design, plane, threads), count, np.arange(count))
    kind = ends.kind.reshape(shape)
    ran = np.sum(kind != FAILED, axis=-1)
    share = np.sum((kind != FAILED) & (kind != RESTS), axis=-1) / np.where(ran > 0, ran, np.nan)
    growth = ends.scales.growth.reshape(shape)[..., 0]
    return {"vibrates": share, "stable": growth < 0.0}


def _onset(design: Any, names: Sequence[str], ends: tuple[float, float], value: float) -> float:
    found = critical_value(design.replace({names[1]: float(value)}), {names[0]: ends})
    return float(found.value) if found.outcome.ok else float("nan")


def _followed(
    design: DesignOrRecipe,
    names: Sequence[str],
    ends: Bounds,
    top: np.ndarray,
    y: np.ndarray,
    far: _Far,
    threads: int | None,
) -> Any:
    """Vibrations of each row just below its onset, followed down in the first parameter until they end."""
    low, high = ends
    step = (high - low) / STEPS
    rows = np.flatnonzero(top > low + step)  # elsewhere sliding is not stable
    begin = np.maximum(top - 0.5 * step, low)
    found = far.settled(Batch.over(design, {names[0]: begin, names[1]: y}, threads), len(y), rows)
    row, n = np.repeat(rows, far.starts), found.q.shape[-1]
    chosen = _different(found, row, len(y))
    at, row = begin[row[chosen]], row[chosen]
    state, amplitude = np.hstack([found.q[chosen], found.qd[chosen]]), 0.5 * (found.high - found.low)[chosen]
    size = np.full(len(chosen), step)
    while chosen.size and np.any(live := (size > step / 2.0**HALVINGS * 1.5) & (at > low)):
        which = np.flatnonzero(live)
        trial = np.maximum(at[which] - size[which], low)
        part = Batch.over(design, {names[0]: trial, names[1]: y[row[which]]}, threads)
        now = settle(part, state[which, :n], state[which, n:], stretches=STRETCHES, same=TIGHT)
        lives = now.kind == REPEATS
        kept, lost = which[lives], which[~lives]
        at[kept], state[kept] = trial[lives], np.hstack([now.q, now.qd])[lives]
        amplitude[kept] = 0.5 * (now.high - now.low)[lives]
        size[lost] *= 0.5
    return _lowest(len(y), n, low, row, at, size, state, amplitude)


def _different(found: Settled, row: np.ndarray, rows: int) -> Any:
    """Up to `FOLLOWED` vibrations of different size in each row."""
    chosen: list[int] = []
    for i in range(rows):
        here = np.flatnonzero((row == i) & (found.kind == REPEATS))
        if here.size == 0:
            continue
        size = np.log(0.5 * np.max(found.high[here] - found.low[here], axis=-1))[:, None]
        group = linked(size, 0.02)
        first = [here[np.flatnonzero(group == g)[0]] for g in range(int(np.max(group)) + 1)]
        first.sort(key=lambda j: -float(np.max(found.high[j] - found.low[j])))
        chosen += [int(j) for j in first[:FOLLOWED]]
    return np.array(chosen, dtype=int)


def _lowest(
    rows: int,
    n: int,
    low: float,
    row: np.ndarray,
    at: np.ndarray,
    size: np.ndarray,
    state: np.ndarray,
    amplitude: np.ndarray,
) -> Any:
    """Of each row the vibration that reached lowest."""
    end, resolution = np.full(rows, np.nan), np.full(rows, np.nan)
    last, large = np.full((rows, 2 * n), np.nan), np.full((rows, n), np.nan)
    for i in range(rows):
        here = np.flatnonzero(row == i)
        if here.size:
            j = here[np.argmin(at[here])]
            end[i] = at[j] - size[j] if at[j] > low else -np.inf
            resolution[i], last[i], large[i] = size[j], state[j], amplitude[j]
    return {"end": end, "resolution": resolution, "state": last, "amplitude": large}
