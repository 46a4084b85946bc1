"""Which starts lead to which attractor: basins, their shares with confidence intervals, and pictures of a plane.

Starts fill a box of the state space, or a grid in one of its planes. An ensemble runs them until each rests or repeats
itself (`settling`), motions that ended alike are one attractor, and shooting confirms it (`attractors`). Of n starts of
which k lead to an attractor its share is k/n, with the Wilson score interval of 95 % (SciPy's `binomtest`).
Basin stability: Menck, Heitzig, Marwan and Kurths 2013, Nature Physics 9, 89-92.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import public
from squealbox.limit_cycles.attractors.attractor import (
    IRREGULAR,
    NO_END,
    UNSTABLE,
    VIBRATION,
    Attractor,
    attractors,
    stable_cycles,
)
from squealbox.limit_cycles.attractors.sections import state_names
from squealbox.limit_cycles.attractors.settling import (
    LOOSE,
    RESTS,
    TIGHT,
    Batch,
    Scales,
    Settled,
    settle,
    settle_on,
    together,
)
from squealbox.limit_cycles.cycles.pinned import at_rest_together
from squealbox.parameters import ParameterError, known_names
from squealbox.result import COMPLETED, Array, Outcome, Result, quantity
from squealbox.start import Start
from squealbox.system import DesignOrSystem, System, as_system

MOST_LINES = 12  # of a summary, the largest shares
CONFIDENCE = 0.95
PILOT = 512  # starts that run until they have settled; those after them until they arrive at what these found


@dataclass(frozen=True, kw_only=True, eq=False)
class Basin(Result):
    """Starts and what became of them, as :func:`basin` returns it.

    `attractors` are :class:`Attractor` objects, with the refined cycles; a saved file keeps the arrays only. `plane`
    names the two states of a picture; `through` is the state its plane goes through.
    """

    start: Array = quantity("start state", "m", "starts (q, q'), displacements in m and velocities in m/s")
    attractor: Array = quantity("start", "1", "index of the attractor; -1 not settled, -2 the run failed")
    level: Array = quantity("start", "1", "half range at the end over V/w1, w1 the slowest frequency")
    time: Array = quantity("start", "s", "time it ran")
    vibrates: Array = quantity("start", "1", "True where the run does not come to rest")
    kind: Array = quantity(
        "attractor", "", "steady sliding, rest elsewhere, cycle, unstable cycle, vibration or irregular"
    )
    count: Array = quantity("attractor", "1", "number of starts that lead there")
    shares: Array = quantity("attractor", "1", "share of the starts that lead there")
    intervals: Array = quantity("attractor end", "1", "its confidence interval, 95 %")
    lowest: Array = quantity("attractor dof", "m", "least displacement")
    highest: Array = quantity("attractor dof", "m", "largest displacement")
    share: Any = quantity("", "1", "share of the starts that vibrate")
    interval: Array = quantity("end", "1", "its confidence interval, 95 %")
    rest: Array = quantity("state", "m", "steady sliding")
    through: Array = quantity("state", "m", "state in the middle of the box, or that the plane goes through")
    plane: tuple[str, ...] = ()
    attractors: tuple[Attractor, ...] = field(default=(), metadata={"transient": True})

    table_over: ClassVar = ("start",)
    headings: ClassVar = {"start": "{}"}

    def table(self) -> dict[str, Any]:
        kinds = np.array([*self.kind, "failed", "not settled"], dtype=str)
        return {**super().table(), "kind": kinds[self.attractor]}

    @property
    def system(self) -> System:
        """The system that moves."""
        system: System = self.inputs["system"]
        return system

    def summary(self) -> str:
        """The share that vibrates, and a line for each attractor."""
        if self.outcome == "no_sliding":
            return self.outcome.told
        if len(self.attractor) and np.all(self.attractor == len(self.kind)):
            return f"every one of {len(self.attractor)} runs failed: {self.outcome.message or self.outcome}"
        low, high = self.interval
        lines = [f"{100 * float(self.share):.1f} % of {len(self.attractor)} starts vibrate "
                 f"({100 * low:.1f} to {100 * high:.1f} %)"]  # fmt: skip
        shown = np.sort(np.argsort(-np.asarray(self.shares), kind="stable")[:MOST_LINES])
        for i in shown:
            kind = self.kind[i]
            about = self.attractors[i].summary(self.system) if self.attractors else str(kind)
            low, high = self.intervals[i]
            lines.append(f"  {100 * self.shares[i]:5.1f} % ({100 * low:.1f} to {100 * high:.1f} %) {about}")
        if len(self.kind) > MOST_LINES:
            lines.append(f"  and {len(self.kind) - MOST_LINES} smaller ones, in `attractors`: a continuum of motions?")
        if not self.outcome.ok:
            lines.append(f"  {self.outcome.told}")
        return "\n".join(lines)


@public()
def basin(
    design_or_system: DesignOrSystem,
    spread: ArrayLike | None = 1.0,
    starts: int = 1000,
    *,
    plane: Sequence[Any] | None = None,
    through: Any = None,
    duration: float | None = None,
    seed: int = 1,
    refine: bool = True,
    threads: int | None = None,
) -> Basin:
    """What becomes of many starts in a box about steady sliding, or on a grid in a plane of the state space.

    Parameters
    ----------
    design_or_system : a design or a `System` with constant loads and speeds
    spread : half widths, shape (2n,): displacements [m] and velocities [m/s]; a number is that many times V/w1 and V,
        with V the fastest sliding speed and w1 the slowest frequency [rad/s]; None as 1
    starts : number of starts, a Sobol sequence with `seed`; with `plane`, about that many on a square grid
    plane : two states, by place in (q, q') or by name, as in ("x", "x'"); the others stay at `through`
    through : the middle of the box or plane, as the start of `simulate`, such as a cycle; None takes steady sliding
    duration : [s] of the first stretch; None takes 60 periods of the slowest mode. What has not settled, or lingers
        where shooting finds no stable cycle, runs on for some 63 times that and more
    refine : confirm each attractor by shooting
    threads : how many; None takes one for each core

    Outcome "completed", "not_settled" (some runs neither rest nor repeat, or linger beside an unstable cycle: they
    count as vibrating, and their attractor is of the kind "irregular" or "unstable cycle"), "failed_runs" or
    "no_sliding". Accuracy: shares as their intervals, for starts uniform in the box (a Sobol sequence does better). A
    cycle below 5 % of V that attracts slowly may pass for rest. Rigid contacts raise `InvalidSystem`. Source: as this
    module.

    >>> from squealbox import DrumBrake, LinearSlope
    >>> basin(DrumBrake(friction=LinearSlope(0.3, -0.05)), [1e-6, 1e-6, 0.0, 0.0], 4).share
    array(0.)
    """
    system = at_rest_together(as_system(design_or_system))
    batch = Batch.over(system, threads=threads)
    scales = Scales.of(batch, 1)
    n = system.size
    names = state_names(system)
    half = _spread(spread, scales, n)
    rest = np.concatenate([scales.rest[0], np.zeros(n)])
    centre = rest if through is None else Start.of("basin", through, system, name="through").state
    points = np.zeros((0, 2 * n))
    places = None if plane is None else [place(names, each) for each in plane]
    if places is not None and (len(places) != 2 or places[0] == places[1]):
        raise ParameterError("basin", "plane", plane, "two different states")
    if np.all(np.isfinite(rest)):
        points = centre + half * unit_starts(2 * n, starts, seed, places)
    ends, found, label = _ended(system, batch, points, duration, refine)
    counts = np.array([int(np.sum(label == i)) for i in range(len(found))], dtype=np.int64)
    total = len(label)
    spans = [interval(int(k), total) for k in counts]
    vibrates = ends.kind != RESTS
    share, span = interval(int(np.sum(vibrates)), total)
    return Basin(
        inputs={"system": system}, settings={"spread": half.tolist(), "seed": seed, "starts": starts},
        outcome=_outcome(label, found), start=points, attractor=label, level=ends.level, time=ends.time,
        vibrates=vibrates, kind=np.array([each.kind for each in found], dtype=str), count=counts,
        shares=np.array([s for s, _ in spans]), intervals=np.array([i for _, i in spans]).reshape(-1, 2),
        lowest=np.array([each.low for each in found]).reshape(-1, n),
        highest=np.array([each.high for each in found]).reshape(-1, n), share=np.asarray(share), interval=span,
        rest=rest, through=centre, plane=tuple(names[i] for i in places or ()), attractors=tuple(found),
    )  # fmt: skip


def _ended(
    system: System, batch: Batch, points: np.ndarray, duration: float | None, refine: bool
) -> tuple[Settled, list[Attractor], Any]:
    """How all ended, the attractors and the index of each motion's own. The first starts find what the others reach."""

    def run(part: np.ndarray, known: list[Attractor]) -> Settled:
        q, qd = np.split(part, 2, axis=1)
        return settle(batch, q, qd, duration=duration, same=LOOSE if refine else TIGHT, often=refine,
                      known=stable_cycles(known))  # fmt: skip

    pilot = PILOT if refine and len(points) > 2 * PILOT else len(points)
    first = np.arange(len(points)) * pilot // max(len(points), 1)
    first = np.flatnonzero(np.diff(first, prepend=-1))  # evenly among them
    ends = run(points[first], [])
    found, label = attractors(system, ends, refine)
    if pilot < len(points):
        others = np.setdiff1d(np.arange(len(points)), first)
        ends = together([ends, run(points[others], found)]).take(np.argsort(np.r_[first, others]))
        found, label = attractors(system, ends, refine, found)
    doubtful = np.flatnonzero(np.isin(label, [i for i, each in enumerate(found) if each.kind in (VIBRATION, UNSTABLE)]))
    if refine and doubtful.size:
        ends = settle_on(ends, batch, doubtful)
        found, label = attractors(system, ends, refine, found)
    return ends, found, label


def interval(count: int, total: int) -> tuple[float, Any]:
    """Share and its Wilson score interval of 95 %, shape (2,); NaN without any."""
    if total == 0:
        return float("nan"), np.full(2, np.nan)
    from scipy.stats import binomtest

    span = binomtest(count, total).proportion_ci(CONFIDENCE, method="wilson")
    return count / total, np.array([span.low, span.high])


def place(names: Sequence[str], given: int | str) -> int:
    """The place of a state in (q, q') from its place or name."""
    if isinstance(given, str) and given in names:
        return list(names).index(given)
    if isinstance(given, (int, np.integer)) and 0 <= given < len(names):
        return int(given)
    expected = known_names(str(given), list(names))
    raise ParameterError("basin", "plane", given, f"{expected}; or a place from 0 to {len(names) - 1}")


def unit_starts(size: int, starts: int, seed: int, places: Sequence[int] | None) -> Any:
    """Points of the cube [-1, 1]^size: a Sobol sequence, or a square grid in two of its directions."""
    if places is not None:
        side = np.linspace(-1.0, 1.0, max(2, round(np.sqrt(starts))))
        out = np.zeros((side.size**2, size))
        out[:, places[0]], out[:, places[1]] = (x.ravel() for x in np.meshgrid(side, side))
        return out
    from scipy.stats import qmc

    power = int(np.ceil(np.log2(max(starts, 2))))
    return 2.0 * qmc.Sobol(size, rng=seed).random_base2(power)[:starts] - 1.0


def half_widths(system: System, spread: float = 1.0) -> Any:
    """The usual half widths (2n,) of the box of starts, V/w1 [m] and V [m/s], times `spread`."""
    return _spread(spread, Scales.of(Batch.over(system), 1), system.size)


def _spread(spread: ArrayLike | None, scales: Scales, n: int) -> Any:
    speed = float(scales.speed[0]) or 1.0
    usual = np.repeat([speed / float(scales.slowest[0]), speed], n)
    given = np.asarray(1.0 if spread is None else spread, dtype=float)
    half = given * usual if given.ndim == 0 else given
    if half.shape != (2 * n,) or not np.all(np.isfinite(half)) or np.any(half < 0.0):
        raise ParameterError("basin", "spread", spread, f"{2 * n} half widths of at least 0, or one number")
    return half


def _outcome(label: np.ndarray, found: Sequence[Attractor]) -> Outcome:
    if len(label) == 0:
        return Outcome("no_sliding", "there is no steady sliding to start about")
    failed = int(np.sum(label == NO_END))
    if failed:
        return Outcome("failed_runs", f"{failed} of {len(label)} runs did not reach their end", failed=failed)
    wild = [i for i, each in enumerate(found) if each.kind in (IRREGULAR, UNSTABLE)]
    moving = int(np.sum(np.isin(label, wild)))
    if moving:
        message = f"{moving} of {len(label)} runs neither came to rest nor repeated themselves in their time"
        return Outcome("not_settled", message, moving=moving)
    return Outcome(COMPLETED)
