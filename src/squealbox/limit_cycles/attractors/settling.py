"""What many motions settle to: an ensemble run on until each of them rests, repeats itself, or has had its time.

A motion is looked at through windows of equal length w, one after the other, five to a stretch of time. With
A the half range of a degree of freedom in a window and V the fastest belt, its level is max A w1 / V, w1 the slowest
frequency of the system [rad/s]. A motion

    rests    when its level is below 0.05 and falls at no less than a quarter of the rate -s of the linear theory,
             A2/A1 <= 1 - min(1, -s w)/4, or is below 1e-9 of V
    repeats  when its extremes in two windows, one after the other, agree to a tolerance times their range
    arrives  at a stable cycle that is known when they lie within 5 % of the cycle's and come nearer, twice in a row, by
             at least half of what its slowest multiplier m and its period T foretell, d2/d1 <= (1 + m^(w/T))/2

and what does none of these is run on, for stretches of twice the length with windows of twice the length.
"""

import itertools
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from typing import Any

import numpy as np

from squealbox.family import is_recipe
from squealbox.limit_cycles.cycles.field import check_autonomous, remembers_nothing
from squealbox.parameters import ParameterError
from squealbox.schedules import value_at
from squealbox.stability import complex_modes
from squealbox.system import System, as_system, equilibrium
from squealbox.transient import (
    Method,
    Observer,
    amplitude_update,
    fastest_rate,
    first_of,
    frequency,
    poincare,
    rows_of,
    simulate_ensemble,
    stacked,
)

STRETCH = 60.0  # periods of the slowest mode, of the first stretch
WINDOWS = 5  # in a stretch
UNSEEN = 2  # windows of the first stretch that belong to the transient
STRETCHES = 6  # at most: 63 times the first
ARRIVED, TWICE = 0.05, 2  # of the range of a known cycle, and how often in a row
RAN, STILL = 0.05, 1e-9
LOOSE, TIGHT = 1e-3, 3e-5  # of the range: two windows that may be alike, and that are
METHOD = Method("dormand-prince-8", rtol=1e-7, most_steps=1_000_000)

FAILED, MOVING, RESTS, REPEATS = range(-1, 3)
KINDS = {FAILED: "failed", MOVING: "not settled", RESTS: "rests", REPEATS: "repeats"}


def _both(memory: np.ndarray) -> Any:
    return memory[..., ::-1]


def extent(last: float) -> Observer:
    """Least and largest displacement over the last part [m]; the kernel is that of `amplitude`."""
    return Observer("extent", amplitude_update, (-np.inf, np.inf), "dof", _both, last, unit="m")


@dataclass(frozen=True, eq=False)
class Batch:
    """One brake at one or many values of its parameters (k,), or a list of systems of the same structure; threads."""

    design: Any
    parameters: Mapping[str, Any]
    threads: int | None = None

    @classmethod
    def over(cls, design: Any, parameters: Mapping[str, Any] | None = None, threads: int | None = None) -> "Batch":
        """A design with arrays for its dotted names, a function of one value with {name: values}, or a system."""
        given = {name: np.asarray(value, dtype=float) for name, value in (parameters or {}).items()}
        if is_recipe(design):
            if len(given) != 1:
                raise ParameterError("limit_cycles", "parameters", list(given), "one, for a function of one value")
            batch = cls([as_system(design(float(value))) for value in next(iter(given.values()))], {}, threads)
        else:
            batch = cls(design if given else as_system(design), given, threads)
        one = batch.design[0] if isinstance(batch.design, list) else first_of(batch.system)
        remembers_nothing(one)
        check_autonomous(one)
        return batch

    @property
    def system(self) -> System:
        """All of it as one system, with a leading axis where there are several."""
        if isinstance(self.design, list):
            return stacked(self.design)
        return as_system(self.design.replace(dict(self.parameters)) if self.parameters else self.design)

    def take(self, which: Sequence[int] | np.ndarray) -> "Batch":
        """Some of it."""
        if isinstance(self.design, list):
            return replace(self, design=[self.design[i] for i in which])
        return replace(self, parameters={name: value[which] for name, value in self.parameters.items()})

    @property
    def held(self) -> "Batch":
        """The same with its systems made, for many runs of them."""
        return replace(self, design=self.system, parameters={})

    @property
    def one(self) -> System:
        """Its first system, without leading axes."""
        return first_of(self.system)

    def sampled(self, q: np.ndarray, qd: np.ndarray, times: np.ndarray) -> tuple[Any, Any, Any]:
        """(t, q, qd) of the motions from (q, qd), each (k, n), at the given instants, (k, instants, n)."""
        run = simulate_ensemble(self.design, self.parameters or None, float(times[-1]), METHOD, (), start=(q, qd),
                                times=times, threads=self.threads)  # fmt: skip
        return run.sample_time, run.sample_q, run.sample_qd

    def run(self, q: np.ndarray, qd: np.ndarray, duration: float, observe: Sequence[Observer]) -> Any:
        """The ensemble from (q, qd), each (k, n)."""
        return simulate_ensemble(self.design, self.parameters or None, duration, METHOD, observe, start=(q, qd),
                                 threads=self.threads)  # fmt: skip


@dataclass(frozen=True, eq=False)
class Scales:
    """Of each system: steady sliding q (k, n), growth rate [1/s], V [m/s], slowest frequency [rad/s], each (k,)."""

    rest: Any
    growth: Any
    speed: Any
    slowest: Any

    @classmethod
    def of(cls, batch: Batch, count: int) -> "Scales":
        """Where sliding is steady, how it grows, and what motions are measured by."""
        system = batch.system
        n = system.size
        modes, state = complex_modes(system), equilibrium(system)
        growth = modes.largest_growth_rate
        frequency = np.where(modes.angular_frequency > 0.0, modes.angular_frequency, np.inf)
        slowest = np.min(frequency, axis=-1)
        own = fastest_rate(system, rows_of(system))
        slowest = np.where(np.isfinite(slowest), slowest, np.where(own > 0.0, own, 1.0))
        speeds = [np.abs(np.asarray(value_at(c.V, 0.0), dtype=float)) for c in system.contacts]
        speed = np.max(np.stack(np.broadcast_arrays(*speeds)), axis=0) if speeds else np.zeros(())
        rest = np.where(np.asarray(state.exists)[..., None], state.q, np.nan)
        return cls(np.broadcast_to(rest, (count, n)), *(np.broadcast_to(x, (count,)) for x in (growth, speed, slowest)))

    def take(self, which: Sequence[int] | np.ndarray) -> "Scales":
        """Those of some systems."""
        return Scales(*(getattr(self, each.name)[which] for each in fields(self)))


@dataclass(frozen=True, eq=False)
class Known:
    """A stable cycle: its extremes (n,), period [s] and the size of its slowest multiplier."""

    low: Any
    high: Any
    period: float
    slowest: float

    def reached(self, earlier: Any, later: Any, apart: float) -> Any:
        """True (k,) for motions that arrive, from (low, high) in two windows whose middles lie `apart` [s]."""
        size = float(np.max(self.high - self.low))
        before, now = (
            np.max(np.maximum(np.abs(low - self.low), np.abs(high - self.high)), axis=-1) / size
            for low, high in (earlier, later)
        )
        falls = 0.5 * (1.0 + self.slowest ** (apart / self.period))
        return (now < ARRIVED) & (now <= falls * before)


@dataclass(frozen=True, eq=False)
class Settled:
    """How each of k motions ended: kind (k,), extremes (k, n), last maxima (k, n, 8), frequency, end state, time.

    arrived (k,) marks those that count as on a known cycle, whose extremes they are given.
    """

    kind: Any
    low: Any
    high: Any
    maxima: Any
    frequency: Any
    q: Any
    qd: Any
    time: Any
    arrived: Any
    scales: Scales

    def take(self, which: Sequence[int] | np.ndarray) -> "Settled":
        """Some of the motions."""
        return Settled(**{each.name: getattr(self, each.name)[which] for each in fields(self) if each.name != "scales"},
                       scales=self.scales.take(which))  # fmt: skip

    @property
    def level(self) -> Any:
        """Half range over V/w1, largest degree of freedom."""
        return _level(self.low, self.high, self.scales)

    @property
    def vibrates(self) -> Any:
        """True where a motion ended in a vibration, or had not come to rest when its time was over."""
        return self.kind != RESTS


def settle(
    batch: Batch, q: np.ndarray, qd: np.ndarray, *, duration: float | None = None, stretches: int = STRETCHES,
    same: float = TIGHT, often: bool = False, known: Sequence[Known] = (),
) -> Settled:  # fmt: skip
    """Run all from (q, qd), each (k, n), until they rest or repeat to `same`, for at most 2^stretches - 1 durations.

    often : judge at every window, not only at the end of each stretch: quicker, but a motion that lingers beside an
        unstable cycle passes more easily for one that repeats itself
    known : stable cycles of the one system that a motion may arrive at
    """
    q, qd = (np.array(x, dtype=float) for x in (q, qd))
    count, n = q.shape
    scales = Scales.of(batch, count)
    length = (
        STRETCH * 2.0 * np.pi / float(np.min(scales.slowest, initial=np.inf)) if duration is None else float(duration)
    )
    if not (np.isfinite(length) and length > 0.0) and not (count == 0 and duration is None):
        raise ParameterError("limit_cycles", "duration", duration, "a time above 0 s")
    kind, time, width = np.full(count, MOVING), np.zeros(count), length / WINDOWS
    seen = np.full((2, 2, count, n), np.nan)  # (low, high) of the last window and the one before
    tone, tops, arrived = np.full((count, n), np.nan), np.full((count, n, 8), np.nan), np.zeros(count, dtype=bool)
    nearer = np.zeros((len(known), count), dtype=int)
    todo, taken, part = np.flatnonzero(np.all(np.isfinite(q) & np.isfinite(qd), axis=-1)), -1, batch
    kind[np.setdiff1d(np.arange(count), todo)] = FAILED
    for stretch, window in itertools.product(range(stretches), range(WINDOWS)):
        if todo.size == 0:
            break
        if stretch and not window:  # the last two windows are one of the new width
            width, pair = 2.0 * width, seen[:, :, todo]
            seen[0, 0, todo], seen[0, 1, todo] = np.min(pair[:, 0], axis=0), np.max(pair[:, 1], axis=0)
        if todo.size != taken:
            taken, part = todo.size, batch.take(todo).held
        run = part.run(q[todo], qd[todo], width, OBSERVERS)
        seen[1, :, todo] = seen[0, :, todo]
        seen[0, :, todo] = np.moveaxis(run["extent"], -1, 1)
        if window == WINDOWS - 1 or (often and (stretch or window >= UNSEEN)):
            kind[todo] = _judge(seen[1][:, todo], seen[0][:, todo], width, scales.take(todo), same)
        for i, cycle in enumerate(known):
            nearer[i, todo] = np.where(cycle.reached(seen[1][:, todo], seen[0][:, todo], width), nearer[i, todo] + 1, 0)
            here = todo[(nearer[i, todo] == TWICE) & (kind[todo] == MOVING)]
            kind[here], arrived[here] = REPEATS, True
            seen[0][0, here], seen[0][1, here] = cycle.low, cycle.high
        kind[todo[run.ended != "completed"]] = FAILED
        tone[todo], tops[todo] = run["frequency"], run["poincare"]
        q[todo], qd[todo] = run.q, run.qd
        time[todo] += width
        todo = todo[kind[todo] == MOVING]
    low, high = seen[0]
    return Settled(kind, low, high, tops, tone, q, qd, time, arrived, scales)


def together(ends: Sequence[Settled]) -> Settled:
    """Motions of one system as one."""
    names = [each.name for each in fields(Settled) if each.name != "scales"]
    scales = [np.concatenate([getattr(one.scales, each.name) for one in ends]) for each in fields(Scales)]
    return Settled(**{name: np.concatenate([getattr(one, name) for one in ends]) for name in names},
                   scales=Scales(*scales))  # fmt: skip


def settle_on(ends: Settled, batch: Batch, which: np.ndarray) -> Settled:
    """The same with some of the motions run on, from where they ended, until they are surely settled."""
    longer = settle(batch.take(which), ends.q[which], ends.qd[which], duration=float(np.max(ends.time[which])),
                    stretches=STRETCHES - 1)  # fmt: skip
    merged = {each.name: np.array(getattr(ends, each.name)) for each in fields(ends) if each.name != "scales"}
    for name, values in merged.items():
        values[which] = getattr(longer, name) + (values[which] if name == "time" else 0)
    return Settled(**merged, scales=ends.scales)


OBSERVERS = (extent(1.0), frequency(1.0), poincare(1.0))


def _level(low: np.ndarray, high: np.ndarray, scales: Scales) -> Any:
    half = 0.5 * np.max(high - low, axis=-1) * scales.slowest
    return np.where(scales.speed > 0.0, half / np.where(scales.speed > 0.0, scales.speed, 1.0), half)


def _judge(earlier: np.ndarray, later: np.ndarray, apart: float, scales: Scales, same: float) -> Any:
    """MOVING, RESTS or REPEATS of each, from (low, high) in two windows whose middles lie `apart` [s]."""
    (low1, high1), (low2, high2) = earlier, later
    before, now = _level(low1, high1, scales), _level(low2, high2, scales)
    least = 1.0 - 0.25 * np.clip(-scales.growth * apart, 0.0, 1.0)
    with np.errstate(invalid="ignore"):
        decays = (now < RAN) & (now <= least * before) & (scales.growth < 0.0)
        rests = decays | (now < STILL)
        reach = np.max(high2 - low2, axis=-1)
        off = np.max(np.maximum(np.abs(low2 - low1), np.abs(high2 - high1)), axis=-1)
        repeats = off <= same * reach
    return np.where(rests, RESTS, np.where(repeats, REPEATS, MOVING))
