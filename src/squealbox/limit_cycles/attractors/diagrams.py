"""Bifurcation diagrams by brute force: what ensembles settle to over a parameter, swept up, swept down and from rest.

In a sweep each value begins with the state in which the one before it ended, with a small nudge, so that a sweep
follows an attractor until it ends and leaves steady sliding where that is unstable. Up and down are run side by side.
"From rest" starts every value anew from q = q' = 0, the load applied at once, and drawn starts from states about steady
sliding; all of it is one ensemble. Where up and down differ, attractors coexist. What a Poincare section reads of each
motion comes from a run of its own, after the motion has settled.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from squealbox.arguments import public
from squealbox.cautions import along, told_place
from squealbox.family import DesignOrRecipe, Family, Varied, unit_of
from squealbox.limit_cycles.attractors.sections import Section, passages
from squealbox.limit_cycles.attractors.settling import (
    FAILED,
    KINDS,
    LOOSE,
    MOVING,
    RESTS,
    Batch,
    Scales,
    Settled,
    settle,
)
from squealbox.limit_cycles.branches.isolated import drawn_states
from squealbox.limit_cycles.cycles.remembering import field_of
from squealbox.matrices import runs_of_true
from squealbox.parameters import ParameterError, known_names
from squealbox.result import COMPLETED, Array, Outcome, Result, quantity
from squealbox.stability import complex_modes
from squealbox.start import Start, StartLike
from squealbox.system import System
from squealbox.words import sizes_told, unit_at

SWEEPS = ("up", "down", "rest")
NUDGE = 1e-3  # of V, on every velocity
STRETCHES = 4
FINE = 128  # samples of the fastest period, of the run behind a section
SEEN = 3  # returns of the largest motion that are looked at for cautions
LONGEST = 20.0  # slowest periods: of one return at most, by which that run is measured
AT_ONCE = 2_000_000  # samples


@dataclass(frozen=True, kw_only=True, eq=False)
class BifurcationDiagram(Result):
    """What the motion settles to over a parameter, as :func:`bifurcation_diagram` returns it."""

    value: Array = quantity("point", "", "value of the parameter, in its own unit")
    maxima: Array = quantity(
        "sweep point dof sample", "m", "last eight maxima, newest first; where it rests, its place"
    )
    lowest: Array = quantity("sweep point dof", "m", "least displacement in the end")
    highest: Array = quantity("sweep point dof", "m", "largest displacement in the end")
    frequency: Array = quantity("sweep point dof", "Hz", "frequency of the maxima")
    kind: Array = quantity("sweep point", "1", "-1 failed, 0 not settled, 1 rests, 2 repeats itself")
    state: Array = quantity("sweep point state", "m", "state (q, q') in which each ended")
    sliding: Array = quantity("point dof", "m", "steady sliding")
    crossings: Array = quantity(
        "sweep point crossing", "", "what the section reads, m or m/s, oldest first, NaN behind"
    )
    parameter: str = ""
    sweeps: tuple[str, ...] = ()
    dofs: tuple[str, ...] = ()
    read: str = ""
    section: str = ""
    caution: str = ""

    coordinates: ClassVar = {"point": "value"}
    derived: ClassVar = {"amplitude": ("sweep point dof", "m", "half peak to peak; 0 where it rests")}
    table_over: ClassVar = ("sweep", "point")
    headings: ClassVar = {
        "maxima": "", "state": "", "crossings": "", "lowest": "least {}", "highest": "largest {}",
        "frequency": "frequency of {}",
    }  # fmt: skip

    def table(self) -> dict[str, Any]:
        return {**super().table(), "kind": np.array([KINDS[int(code)] for code in self.kind.ravel()])}

    @property
    def amplitude(self) -> Any:
        """Half peak to peak [m], shape (sweep, point, dof); 0 where it rests."""
        return np.where(self.kind[..., None] == RESTS, 0.0, 0.5 * (self.highest - self.lowest))

    @property
    def coexist(self) -> Any:
        """True where one sweep rests and another does not, shape (point,)."""
        rests = self.kind == RESTS
        return np.any(rests, axis=0) & np.any(~rests & (self.kind != FAILED), axis=0)

    def stretches(self, inside: np.ndarray, shown: Callable[[float], str]) -> str:
        """The values of `inside` (point,) in words, a stretch of neighbours at a time."""
        ends = [(shown(float(self.value[i])), shown(float(self.value[j]))) for i, j in runs_of_true(inside)]
        return " and ".join(f"at {low}" if low == high else f"from {low} to {high}" for low, high in ends)

    def summary(self) -> str:
        """A line for each sweep, and where sliding and vibration coexist."""

        def shown(value: float) -> str:
            return self.read_value(self.parameter, value)

        system, span = self.kept_system(), f"{shown(self.value[0])} to {shown(self.value[-1])}"
        units = [unit_at(system, dof) for dof in self.dofs]
        lines = [f"{self.parameter} from {span}, {len(self.value)} values{f'; {self.section}' if self.section else ''}"]
        for sweep, kind, size in zip(self.sweeps, self.kind, self.amplitude, strict=True):
            counts = [f"{n} {KINDS[code]}" for code in (1, 2, 0, -1) if (n := int(np.sum(kind == code)))]
            moves = self.stretches((kind == 2) | (kind == 0), shown)
            where = f"; vibrates {moves}" if moves else ""
            largest = sizes_told(self.dofs, np.nanmax(size, axis=0), units, 3)
            lines.append(f"{sweep}: {', '.join(counts)}{where}; largest amplitude {largest}")
        if np.any(self.coexist):
            over = self.stretches(self.coexist, shown)
            lines.append(f"Rest and vibration coexist at {int(np.sum(self.coexist))} values, {over}.")
        lines += [f"Note: {self.outcome.message}"] * (not self.outcome.ok)
        return self.warned(lines)


@public()
def bifurcation_diagram(
    design: DesignOrRecipe,
    parameter: Varied,
    values: Any = None,
    *,
    sweeps: Sequence[str] = SWEEPS,
    starts: int = 0,
    section: Section | None = None,
    returns: int = 40,
    start: StartLike = None,
    duration: float | None = None,
    seed: int = 0,
    threads: int | None = None,
) -> BifurcationDiagram:
    """What the motion settles to over a parameter, by transients alone: extremes, and what a Poincare section reads.

    Parameters
    ----------
    design : a design, or a function of one value that returns a design or system
    parameter, values : {name: values (k,)} in rising order, such as {"friction.static": np.linspace(0.1, 0.5, 41)}; or
        the name and the values one after the other
    sweeps : some of "up", "down" (the state goes on from value to value) and "rest" (each from q = q' = 0)
    starts : number of states drawn about steady sliding, with `seed`, from which every value starts as well
    section : a :class:`Section`; None keeps the last eight maxima of each degree of freedom only
    returns : about how many passages of the section are kept, in the time of as many returns
    start : in which the sweeps up and down begin, as for `simulate`, counted at the first value
    duration : [s] of the first stretch at each value; None takes 60 periods of the slowest mode. What has not settled
        runs on, up to 15 times that
    threads : as in :func:`basin`

    Outcome "completed", "not_settled" or "failed_runs" (`kind` tells which). Accuracy: extremes to 1e-6 of their range
    where a motion repeats itself, what a section reads to 1e-4 of it; a
    sweep leaves an attractor up to one value late, and later where it loses stability so slowly that the nudge, 0.1 %
    of V, does not grow in the time given. The plot draws it over branches.

    >>> from squealbox import DrumBrake, LinearSlope
    >>> drum = DrumBrake(friction=LinearSlope(0.3, -0.05))
    >>> bifurcation_diagram(drum, "friction.static", [0.1, 0.15], sweeps=("rest",)).kind
    array([[1, 1]])
    """
    family = Family.along("bifurcation_diagram", design, parameter, values, count=1)
    parameter, values = family.name, family.spans[0]
    if not np.all(np.diff(values) > 0.0):
        raise ParameterError("bifurcation_diagram", "values", values, "a list of rising values")
    for name in sweeps:
        if name not in SWEEPS:
            raise ParameterError("bifurcation_diagram", "sweeps", name, known_names(str(name), list(SWEEPS)))
    if int(starts) != starts or starts < 0 or not (sweeps or starts):
        raise ParameterError("bifurcation_diagram", "starts", starts, "a whole number, at least 1 without sweeps")
    if int(returns) != returns or returns < 1:
        raise ParameterError("bifurcation_diagram", "returns", returns, "a whole number of at least 1")
    batch = Batch.over(design, {parameter: values}, threads)
    scales = Scales.of(batch, len(values))
    if section is not None:
        section.column(batch.system), section.plane(batch.system, scales.rest)
    n = scales.rest.shape[-1]
    begin = Start.of("bifurcation_diagram", start, batch.one).state
    ways = [name for name in sweeps if name != "rest"]
    found = dict(zip(ways, _swept(batch, ways, begin, scales, duration), strict=True))
    names = [*sweeps, *(f"start {i + 1}" for i in range(starts))]
    anew = {"rest": np.zeros((len(values), 2 * n))} if "rest" in sweeps else {}
    anew |= dict(zip(names[len(sweeps) :], _drawn(batch, scales, int(starts), seed), strict=True))
    found |= _anew(batch, anew, duration)
    ends = [found[name] for name in names]
    kind = np.array([each.kind for each in ends])
    rests = kind[..., None, None] == RESTS
    read = [np.zeros((len(values), 0)) if section is None else _read(batch, each, section, int(returns))
            for each in ends]  # fmt: skip
    return BifurcationDiagram(
        inputs={} if family.recipe else {"system": design},
        settings={"sweeps": list(sweeps), "starts": int(starts), "seed": seed, "returns": int(returns)},
        outcome=_outcome(kind), value=values, kind=kind, sliding=scales.rest, parameter=parameter,
        maxima=np.where(rests, scales.rest[None, :, :, None], np.array([each.maxima for each in ends])),
        lowest=np.array([each.low for each in ends]), highest=np.array([each.high for each in ends]),
        frequency=np.array([each.frequency for each in ends]), sweeps=tuple(names),
        state=np.array([np.concatenate([each.q, each.qd], axis=-1) for each in ends]),
        crossings=np.array(read),
        dofs=tuple(batch.system.names), read="" if section is None else section.read,
        section="" if section is None else str(section),
        caution=_caution(batch, ends, parameter, values, unit_of(design, parameter)),
    )  # fmt: skip


def _caution(batch: Batch, ends: list[Settled], parameter: str, values: np.ndarray, unit: str) -> str:
    """Where the motions leave the range of their model: the largest of each sweep, over some of its periods."""
    largest: dict[int, Settled] = {}
    for each in ends:
        size = np.max(each.high - each.low, axis=-1)
        size = np.where((each.kind == FAILED) | ~np.isfinite(size), -1.0, size)
        if np.max(size) >= 0.0:
            largest.setdefault(int(np.argmax(size)), each)
    said: dict[str, None] = {}
    for i, each in largest.items():
        part, at = batch.take([i]), np.array([i])
        times = _instants(each.take(at), part.system, SEEN)
        _, q, qd = part.sampled(each.q[at], each.qd[at], times)
        for one in along(part.one, q[0], qd[0]):
            said[f"at {told_place(parameter, values[i], unit)} {one}"] = None
    return "; ".join(said)


def _drawn(batch: Batch, scales: Scales, starts: int, seed: int) -> list[Any]:
    """States (k, 2n) of each drawn start: the same beside steady sliding at every value."""
    if starts == 0:
        return []
    first = field_of(batch.take([0]).one)
    own = np.r_[np.nan_to_num(scales.rest[0]), np.zeros(first.size)]
    beside = drawn_states(first, starts, seed) - own
    sliding = np.concatenate([np.nan_to_num(scales.rest), np.zeros_like(scales.rest)], axis=1)
    return [sliding + each for each in beside]


def _anew(batch: Batch, anew: dict[str, Any], duration: float | None) -> dict[str, Settled]:
    """What each value settles to from the states (k, 2n) of each name: one ensemble."""
    if not anew:
        return {}
    states = np.array(list(anew.values()))
    count, size = states.shape[1:]
    all_ = batch.take(np.tile(np.arange(count), len(anew)))
    flat = states.reshape(-1, size)
    ends = settle(all_, flat[:, : size // 2], flat[:, size // 2 :], duration=duration, stretches=STRETCHES, same=LOOSE)
    return {name: ends.take(np.arange(i * count, (i + 1) * count)) for i, name in enumerate(anew)}


def _read(batch: Batch, ends: Settled, section: Section, returns: int) -> Any:
    """What the section reads of each motion, run on from its end, (k, returns), oldest first; at rest, its place."""
    system, scales, n = batch.system, ends.scales, ends.q.shape[1]
    normal, offset = section.plane(system, np.nan_to_num(scales.rest))
    column = section.column(system)
    found = np.full((len(ends.kind), returns), np.nan)
    rests = np.flatnonzero(ends.kind == RESTS)
    found[rests, 0] = scales.rest[rests, column] if column < n else 0.0
    moving = np.flatnonzero((ends.kind != RESTS) & (ends.kind != FAILED))
    if moving.size == 0:
        return found
    times = _instants(ends.take(moving), batch.take(moving).system, returns)
    for part in np.array_split(moving, max(1, len(moving) * len(times) // AT_ONCE)):
        t, q, qd = batch.take(part).sampled(ends.q[part], ends.qd[part], times)
        which, _, states = passages(t, q, qd, normal[part], offset[part], section.direction)
        for k, i in enumerate(part):
            values = states[which == k, column][-returns:]
            found[i, : len(values)] = values
    return found


def _instants(ends: Settled, system: System, returns: int) -> Any:
    """Samples over the time of so many returns, fine enough for the fastest mode."""
    slow = 2.0 * np.pi / float(np.min(ends.scales.slowest))
    tones = ends.frequency[np.isfinite(ends.frequency) & (ends.frequency > 0.0)]
    period = float(np.clip(1.0 / np.min(tones), slow, LONGEST * slow)) if tones.size else slow
    fast = 2.0 * np.pi / float(np.max(complex_modes(system).angular_frequency))
    span = (returns + 1) * period
    return np.linspace(0.0, span, 1 + int(np.ceil(FINE * span / min(fast, slow))))


def _swept(batch: Batch, ways: list[str], begin: np.ndarray, scales: Scales, duration: float | None) -> Any:
    """The sweeps in the given ways, side by side, each as what it settles to at every value in rising order."""
    count, n = scales.rest.shape
    state = np.tile(begin, (len(ways), 1))
    orders = np.array([np.arange(count) if way == "up" else np.arange(count)[::-1] for way in ways], dtype=int)
    steps: list[Settled] = []
    for at in orders.T:
        nudge = NUDGE * scales.speed[at][:, None]
        ends = settle(batch.take(at), state[:, :n], state[:, n:] + nudge, duration=duration, stretches=STRETCHES,
                      same=LOOSE)  # fmt: skip
        steps.append(ends)
        state = np.concatenate([ends.q, ends.qd], axis=-1)
        lost = ~np.all(np.isfinite(state), axis=-1)
        state[lost] = begin
    for k, order in enumerate(orders):
        rank = np.argsort(order)
        names = ("kind", "low", "high", "maxima", "frequency", "q", "qd", "time", "arrived")
        ended = {name: np.array([getattr(steps[i], name)[k] for i in rank]) for name in names}
        yield Settled(**ended, scales=scales)


def _outcome(kind: np.ndarray) -> Outcome:
    failed, moving = int(np.sum(kind == FAILED)), int(np.sum(kind == MOVING))
    if failed:
        return Outcome("failed_runs", f"{failed} of {kind.size} motions did not reach their end", failed=failed)
    if moving:
        message = f"{moving} of {kind.size} motions neither came to rest nor repeated themselves in their time"
        return Outcome("not_settled", message, moving=moving)
    return Outcome(COMPLETED)
