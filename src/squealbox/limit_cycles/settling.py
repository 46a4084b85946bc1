"""What many motions settle to: an ensemble run on until each of them rests, repeats itself, or has had its time.

A motion is looked at through two windows of equal length w, one after the other, at the end of a stretch of time. With
A the half range of a degree of freedom in a window and V the fastest belt, its level is max A w1 / V, w1 the slowest
frequency of the system [rad/s]. A motion

    rests    when its level is below 0.05 and falls at no less than a quarter of the rate -s of the linear theory,
             A2/A1 <= 1 - min(1, -s w)/4, or is below 1e-9 of V
    repeats  when its extremes in both windows agree to a tolerance times their range

and what does neither is run on, for stretches of twice the length.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from squealbox.limit_cycles.field import check_autonomous
from squealbox.parameters import ParameterError
from squealbox.schedules import value_at
from squealbox.stability import complex_modes
from squealbox.system import System, as_system, equilibrium
from squealbox.transient import Method, Observer, simulate_ensemble
from squealbox.transient.lanes.batch import first_of, stacked
from squealbox.transient.observers import amplitude_update, frequency, poincare

STRETCH = 60.0  # periods of the slowest mode, of the first stretch
WINDOW = 0.2  # of a stretch
STRETCHES = 6  # at most: 63 times the first
RAN, STILL = 0.05, 1e-9
LOOSE, TIGHT = 1e-3, 3e-5  # of the range: two windows that may be alike, and that are
METHOD = Method("dormand-prince-8", rtol=1e-7, most_steps=1_000_000)

FAILED, MOVING, RESTS, REPEATS = range(-1, 3)
KINDS = {FAILED: "failed", MOVING: "not settled", RESTS: "rests", REPEATS: "repeats"}


def _both(memory: Any) -> Any:
    return memory[..., ::-1]


def extent(last: float) -> Observer:
    """Least and largest displacement over the last part [m]; the kernel is that of `amplitude`."""
    return Observer("extent", amplitude_update, (-np.inf, np.inf), "dof", _both, last, unit="m")


@dataclass(frozen=True, eq=False)
class Batch:
    """One brake at one or many values of its parameters (k,), or a sequence of systems of the same structure."""

    design: Any
    parameters: Mapping[str, Any]

    @classmethod
    def over(cls, design: Any, parameters: Mapping[str, Any] | None = None) -> "Batch":
        """A design with arrays for its dotted names, a function of one value with {name: values}, or a system."""
        given = {name: np.asarray(value, dtype=float) for name, value in (parameters or {}).items()}
        if callable(design) and not hasattr(design, "replace"):
            if len(given) != 1:
                raise ParameterError("limit_cycles", "parameters", list(given), "one, for a function of one value")
            return cls([as_system(design(float(value))) for value in next(iter(given.values()))], {})
        batch = cls(design if given else as_system(design), given)
        check_autonomous(first_of(batch.system))
        return batch

    @property
    def system(self) -> System:
        """All of it as one system, with a leading axis where there are several."""
        if isinstance(self.design, list):
            return stacked(self.design)
        return as_system(self.design.replace(dict(self.parameters)) if self.parameters else self.design)

    def take(self, which: Any) -> "Batch":
        """Some of it."""
        if isinstance(self.design, list):
            return Batch([self.design[i] for i in which], {})
        return Batch(self.design, {name: value[which] for name, value in self.parameters.items()})

    @property
    def one(self) -> System:
        """Its first system, without leading axes."""
        return first_of(self.system)

    def sampled(self, q: Any, qd: Any, times: Any, threads: int | None = None) -> tuple[Any, Any, Any]:
        """(t, q, qd) of the motions from (q, qd), each (k, n), at the given instants, (k, instants, n)."""
        run = simulate_ensemble(self.design, self.parameters or None, float(times[-1]), METHOD, (), start=(q, qd),
                                times=times, threads=threads)  # fmt: skip
        return run.sample_time, run.sample_q, run.sample_qd

    def run(self, q: Any, qd: Any, duration: float, observe: Sequence[Observer], threads: int | None = None) -> Any:
        """The ensemble from (q, qd), each (k, n)."""
        return simulate_ensemble(self.design, self.parameters or None, duration, METHOD, observe, start=(q, qd),
                                 threads=threads)  # fmt: skip


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
        growth = np.max(modes.eigenvalues.real, axis=-1)
        frequency = np.where(modes.angular_frequency > 0.0, modes.angular_frequency, np.inf)
        slowest = np.min(frequency, axis=-1)
        own = np.sqrt(np.abs(np.max(np.abs(np.linalg.eigvals(np.linalg.solve(system.M, system.K))), axis=-1)))
        slowest = np.where(np.isfinite(slowest), slowest, np.where(own > 0.0, own, 1.0))
        speeds = [np.abs(np.asarray(value_at(c.V, 0.0), dtype=float)) for c in system.contacts]
        speed = np.max(np.stack(np.broadcast_arrays(*speeds)), axis=0) if speeds else np.zeros(())
        rest = np.where(np.asarray(state.exists)[..., None], state.q, np.nan)
        return cls(np.broadcast_to(rest, (count, n)), *(np.broadcast_to(x, (count,)) for x in (growth, speed, slowest)))

    def take(self, which: Any) -> "Scales":
        """Those of some systems."""
        return Scales(*(getattr(self, each.name)[which] for each in fields(self)))


@dataclass(frozen=True, eq=False)
class Settled:
    """How each of k motions ended: kind (k,), extremes (k, n), last maxima (k, n, 8), frequency, end state, time."""

    kind: Any
    low: Any
    high: Any
    maxima: Any
    frequency: Any
    q: Any
    qd: Any
    time: Any
    scales: Scales

    def take(self, which: Any) -> "Settled":
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
    batch: Batch, q: Any, qd: Any, *, duration: float | None = None, stretches: int = STRETCHES,
    same: float = TIGHT, threads: int | None = None,
) -> Settled:  # fmt: skip
    """Run all from (q, qd), each (k, n), until they rest or repeat to `same`, for at most 2^stretches - 1 durations."""
    q, qd = (np.array(x, dtype=float) for x in (q, qd))
    count, n = q.shape
    scales = Scales.of(batch, count)
    length = STRETCH * 2.0 * np.pi / float(np.min(scales.slowest)) if duration is None else float(duration)
    if not (np.isfinite(length) and length > 0.0):
        raise ParameterError("limit_cycles", "duration", duration, "a time above 0 s")
    kind, time = np.full(count, MOVING), np.zeros(count)
    low, high, tone = (np.full((count, n), np.nan) for _ in range(3))
    tops = np.full((count, n, 8), np.nan)
    todo = np.flatnonzero(np.all(np.isfinite(q) & np.isfinite(qd), axis=-1))
    kind[np.setdiff1d(np.arange(count), todo)] = FAILED
    for _ in range(stretches):
        if todo.size == 0:
            break
        part, early = batch.take(todo), (1.0 - WINDOW) * length
        first = part.run(q[todo], qd[todo], early, _observers(WINDOW * length / early), threads)
        second = part.run(_finite(first.q), _finite(first.qd), WINDOW * length, _observers(1.0), threads)
        windows = [np.moveaxis(run["extent"], -1, 0) for run in (first, second)]
        kind[todo] = _judge(windows, WINDOW * length, scales.take(todo), same)
        kind[todo[(first.ended != "completed") | (second.ended != "completed")]] = FAILED
        low[todo], high[todo] = windows[1]
        tone[todo], tops[todo] = second["frequency"], second["poincare"]
        q[todo], qd[todo] = second.q, second.qd
        time[todo] += length
        todo, length = todo[kind[todo] == MOVING], 2.0 * length
    return Settled(kind, low, high, tops, tone, q, qd, time, scales)


def settle_on(ends: Settled, batch: Batch, which: Any, threads: int | None = None) -> Settled:
    """The same with some of the motions run on, from where they ended, until they are surely settled."""
    longer = settle(batch.take(which), ends.q[which], ends.qd[which], duration=float(np.max(ends.time[which])),
                    stretches=STRETCHES - 1, threads=threads)  # fmt: skip
    merged = {each.name: np.array(getattr(ends, each.name)) for each in fields(ends) if each.name != "scales"}
    for name, values in merged.items():
        values[which] = getattr(longer, name) + (values[which] if name == "time" else 0)
    return Settled(**merged, scales=ends.scales)


def _observers(last: float) -> tuple[Observer, ...]:
    return extent(last), frequency(last), poincare(last)


def _finite(x: Any) -> Any:
    """What failed goes on from zero; it is marked as failed afterwards."""
    return np.nan_to_num(x, nan=0.0, posinf=0.0, neginf=0.0)


def _level(low: Any, high: Any, scales: Scales) -> Any:
    half = 0.5 * np.max(high - low, axis=-1) * scales.slowest
    return np.where(scales.speed > 0.0, half / np.where(scales.speed > 0.0, scales.speed, 1.0), half)


def _judge(windows: Sequence[Any], apart: float, scales: Scales, same: float) -> Any:
    """MOVING, RESTS or REPEATS of each, from (low, high) in two windows whose middles lie `apart` [s]."""
    (low1, high1), (low2, high2) = windows
    before, now = (_level(low, high, scales) for low, high in windows)
    least = 1.0 - 0.25 * np.clip(-scales.growth * apart, 0.0, 1.0)
    with np.errstate(invalid="ignore"):
        decays = (now < RAN) & (now <= least * before) & (scales.growth < 0.0)
        rests = decays | (now < STILL)
        reach = np.max(high2 - low2, axis=-1)
        off = np.max(np.maximum(np.abs(low2 - low1), np.abs(high2 - high1)), axis=-1)
        repeats = off <= same * reach
    return np.where(rests, RESTS, np.where(repeats, REPEATS, MOVING))
