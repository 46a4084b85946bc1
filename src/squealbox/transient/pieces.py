"""Motion under loops that are sampled or late, piece by piece, each piece one exact run with all its events.

Sampled: the command of sample k is held and acts from k h + T on. Late: over the shortest delay the command is known
from what was sensed before, and is given at instants `record` apart, joined by lines: an error of order record^2.
Before the first sensed value has arrived the command is 0. It is cut at the limit, held, and then followed by the
actuator; actuators and what controllers remember are rows of first order, as those of continuous loops are.
"""

import time as clock
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from squealbox.cautions import of_a_run
from squealbox.loops.driven import Driven, driven_brake
from squealbox.loops.held import aliased
from squealbox.loops.rows import size_and_rate
from squealbox.parameters import ParameterError
from squealbox.schedules import Constant, Schedule, Table
from squealbox.system import InvalidSystem, System, equilibrium
from squealbox.transient.trajectory import Trajectory

PER_RADIAN = 256  # instants of record in each radian of the brake's motion
LEAST, MOST = 16, 4096  # of them in a delay
MOST_PIECES = 200_000
WORKS = ("work_friction", "work_load", "work_circulation", "work_dissipated", "work_opening", "work_impact")
WORK = 32  # parts of a piece over which the work of an actuator with a lag is summed
SAME = 1e-12  # share of a piece below which two instants are one

Run = Callable[[System, Any, Any, float, float], Trajectory]  # of a system, (q, qd), times, begin and end


@dataclass(frozen=True, eq=False)
class Pieces:
    """The motion as one trajectory; `cuts` its instants between pieces, `rows` where, `commands` (k, a) held there."""

    motion: Trajectory
    driven: Driven
    cuts: Any
    rows: Any
    commands: Any
    work: Any
    residual: float


def start_of(driven: Driven, start: Any, time: float = 0.0) -> tuple[Any, Any]:
    """q and q' with the rows of the loops: "rest", "sliding" with ideal loops, or (q, q') of the brake or all rows."""
    system, n = driven.system, driven.b.shape[1]
    if isinstance(start, str) and start == "sliding":
        held = system.replace(K=system.K - driven.columns.T @ driven.P)
        state = equilibrium(held, time)
        if not state.exists:
            raise InvalidSystem(f"there is no steady sliding to start from: {state.outcome.message}")
        return state.q, np.zeros(n)
    if start is None or (isinstance(start, str) and start == "rest"):
        return np.zeros(n), np.zeros(n)
    own = sum(not name.startswith("loop state") for name in system.names)
    try:
        q, qd = (np.asarray(part, dtype=float).ravel() for part in start)
        parts = [np.concatenate([part, np.zeros(n - own)]) if part.size == own else part.reshape(n) for part in (q, qd)]
    except (TypeError, ValueError) as error:
        expected = f'(q, qd) with {own} values each, "rest" or "sliding"'
        raise ParameterError("simulate", "start", start, expected) from error
    if not np.all(np.isfinite(parts)):
        raise ParameterError("simulate", "start", start, "finite displacements and velocities")
    return parts[0], parts[1]


def late_loops(system: System) -> Driven | None:
    """The brake with its sampled and late loops driven from outside; None where it has none."""
    return None if all(loop.linear for loop in system.loops) else driven_brake(system)


def motion_of(
    driven: Driven, start: Any, begin: float, duration: float, times: Any, one: Any, contact: str, progress: Any
) -> Trajectory:
    """The motion in pieces, each by `one`: `simulate` with its method."""
    if contact in ("raw", "time-stepping"):
        expected = "exact or smoothed contact: loops that are sampled or late are run in pieces"
        raise ParameterError("simulate", "contact", contact, expected)
    began = clock.monotonic()

    def run(system: System, state: Any, instants: Any, now: float, until: float) -> Trajectory:
        if progress is not None:
            progress(now, begin + duration, clock.monotonic() - began)
        motion: Trajectory = one(system, until - now, state, instants, start_time=now)
        return motion

    motion = in_pieces(driven, start_of(driven, start, begin), begin, duration, times, run).motion
    return replace(motion, caution="; ".join([*filter(None, [motion.caution]), *aliased(driven.system, driven.loops)]))


def in_pieces(driven: Driven, start: tuple[Any, Any], begin: float, duration: float, times: Any, run: Run) -> Pieces:
    """The motion over `duration` [s] from `begin`; `run` is one exact run between two instants."""
    return _Walk(driven, start, begin, duration, times, run).whole()


class _Walk:
    def __init__(self, driven: Driven, start: Any, begin: float, duration: float, times: Any, run: Run) -> None:
        self.driven, self.run, self.times = driven, run, times
        self.begin, self.end = begin, begin + duration
        self.q, self.qd = (np.asarray(part, dtype=float) for part in start)
        self.steps = np.array([np.inf if x.sampling is None else 1.0 / float(x.sampling) for x in driven.loops])
        self.late = np.array([loop.late for loop in driven.loops])
        self.flowing = np.isinf(self.steps)  # loops that are late but not sampled
        _, rate = size_and_rate(driven.system, ())
        shortest = float(np.min(self.late[self.flowing], initial=np.inf))
        self.record = shortest / float(np.clip(np.ceil(PER_RADIAN * rate * shortest), LEAST, MOST)) if (
            np.isfinite(shortest)) else np.inf  # fmt: skip
        self.longest = shortest
        count = duration / min(shortest, float(np.min(self.steps)))
        if count > MOST_PIECES:
            raise ParameterError("simulate", "duration", duration, f"at most {MOST_PIECES} samples or delays")
        self.held = np.zeros(len(driven.loops))
        self.arrivals: list[tuple[float, int, float]] = []
        self.taken = np.zeros(len(driven.loops), dtype=int)
        self.past: tuple[Any, Any] = (np.zeros(0), np.zeros((0, len(driven.loops))))

    def whole(self) -> Pieces:
        """Piece after piece to the end."""
        motions, commands, cuts, work, residual = [], [], [self.begin], [0.0], 0.0
        now = self.begin
        while now < self.end - SAME * (self.end - self.begin):
            self._take(now)
            until = self._next(now)
            motion = self._piece(now, until)
            motions.append(motion)
            commands.append(self._commanded(now, after=True))
            if not motion.outcome.ok:
                break
            cuts.append(until)
            work.append(work[-1] + self._work(motion))
            residual += float(abs(motion.energy.residual[-1]))
            self.q, self.qd, now = motion.q[-1], _stuck(self.driven.system, motion), until
        commands.append(self._commanded(now, after=False))
        motion, rows = _joined(motions, self.times, cuts, self.driven.system)
        return Pieces(motion, self.driven, np.array(cuts), rows, np.array(commands), np.array(work), residual)

    def _take(self, now: float) -> None:
        """Samples that are due, and commands that arrive."""
        for a in map(int, np.flatnonzero(~self.flowing)):
            due = self.begin + self.taken[a] * self.steps[a]
            if due <= now + SAME * self.steps[a]:
                self.arrivals.append((due + self.late[a], a, float(self.driven.commands(self.q, self.qd)[a])))
                self.taken[a] += 1
        self.arrivals.sort(key=lambda each: each[0])
        while self.arrivals and self.arrivals[0][0] <= now + SAME * self.steps[self.arrivals[0][1]]:
            _, a, value = self.arrivals.pop(0)
            self.held[a] = value

    def _next(self, now: float) -> float:
        """Where the piece that begins now ends."""
        ends = [self.end, now + self.longest]
        ends += [self.begin + k * h for k, h in zip(self.taken, self.steps, strict=True) if np.isfinite(h)]
        ends += [instant for instant, _, _ in self.arrivals[:1]]
        ends += [self.begin + late for late in self.late[self.flowing] if self.begin + late > now * (1.0 + SAME)]
        return float(min(each for each in ends if each > now))

    def _commanded(self, now: float, after: bool) -> Any:
        """The commands that act at an instant, (a,)."""
        found = np.array(self.held)
        for a in map(int, np.flatnonzero(self.flowing)):
            found[a] = self._earlier(a, np.array([now]), after)[0]
        return found

    def _earlier(self, a: int, instants: Any, after: bool) -> Any:
        """The command of a late loop at instants, from what was sensed; 0 before anything had arrived."""
        sensed, margin = instants - self.late[a], SAME * self.late[a]
        known, values = self.past
        if not len(known):
            return np.zeros(len(instants))
        first = self.begin - margin if after else self.begin + margin
        return np.where(sensed >= first, np.interp(sensed, known, values[:, a]), 0.0)

    def _piece(self, now: float, until: float) -> Trajectory:
        system, driven = self.driven.system, self.driven
        constant = np.where(self.flowing, 0.0, self.held) @ driven.columns
        moving = []
        for a in map(int, np.flatnonzero(self.flowing)):
            if until <= self.begin + self.late[a] * (1.0 + SAME):
                continue
            knots = self.past[0] + self.late[a]
            apart = 1e-9 * self.record
            inner = knots[(knots > now + apart) & (knots < until - apart) & (np.diff(knots, prepend=-np.inf) > apart)]
            instants = np.concatenate([[now], inner, [until]])
            moving.append(Table(instants, self._earlier(a, instants, after=True)) * driven.columns[a])
        if np.any(constant) or moving:
            system = system.replace(load=_sum(system.load, constant, moving))
        motion = self.run(system, (self.q, self.qd), self._instants(now, until), now, until)
        if np.isfinite(self.record):
            keep = self.past[0] >= now - float(np.max(self.late)) - self.record
            known = [part[keep] for part in self.past]
            more = motion.t[1:] if len(known[0]) else motion.t
            value = driven.commands(motion.q, motion.qd)[-len(more) :]
            self.past = np.concatenate([known[0], more]), np.concatenate([known[1], value])
        return motion

    def _instants(self, now: float, until: float) -> Any:
        """Instants of one piece: those asked for, those of the record, those the work of an actuator is summed over."""
        count = 1
        if np.isfinite(self.record):
            count = max(int(np.ceil((until - now) / self.record - 1e-9)), 1)
        elif any(loop.rate is not None for loop in self.driven.loops):
            count = WORK
        elif self.times is None:
            return None
        instants = np.append(now + (until - now) * np.arange(count) / count, until)
        if self.times is None:
            return instants
        apart = 1e-9 * (until - now) / count
        asked = self.times[(self.times > now + apart) & (self.times < until - apart)]
        near = np.array([np.any(np.abs(asked - instant) <= apart) for instant in instants])
        return np.union1d(instants[~near], asked)

    def _work(self, motion: Trajectory) -> float:
        """What the actuators put in over one piece [J]."""
        total = 0.0
        for a in range(len(self.driven.loops)):
            b, power = self.driven.b[a], motion.qd @ self.driven.b[a]
            if np.any(self.driven.force[a]):
                total += float(np.trapezoid((motion.q @ self.driven.force[a]) * power, motion.t))
            elif self.flowing[a]:
                total += float(np.trapezoid(self._earlier(a, motion.t, after=True) * power, motion.t))
            else:
                total += float(self.held[a] * (b @ (motion.q[-1] - motion.q[0])))
        return total


def _sum(load: Any, constant: Any, moving: list[Any]) -> Any:
    """A load with a constant part and schedules added."""
    if not isinstance(load, Schedule) and not moving:
        return load + constant
    total = load if isinstance(load, Schedule) else Constant(1.0) * load
    for part in (Constant(1.0) * constant, *moving):
        total = total + part
    return total


def _stuck(system: System, motion: Trajectory) -> Any:
    """The velocity at the end of a piece; contacts that stick there move exactly with what they stick to."""
    stuck = np.flatnonzero(motion.mode[-1][: len(system.contacts)] == 0)
    if not stuck.size:
        return motion.qd[-1]
    rows = np.array([system.contacts[c].t for c in stuck])
    return motion.qd[-1] + np.linalg.lstsq(rows, motion.sliding_velocity[-1][stuck], rcond=1e-12)[0]


def _joined(motions: list[Trajectory], times: Any, cuts: list[float], base: System) -> tuple[Trajectory, Any]:
    """The pieces as one trajectory with rows at `times`, or all, and the rows of the cuts in it (all) or -1."""
    first, last = motions[0], motions[-1]
    fields: dict[str, Any] = {}
    by_time = ["t", "q", "qd", "normal_force", "sliding_velocity", "friction_force", "mode", *WORKS]
    carried = {name: np.zeros_like(getattr(first, name)[0]) for name in WORKS}
    parts: dict[str, list[Any]] = {name: [] for name in by_time}
    for i, motion in enumerate(motions):
        for name in by_time:
            rows = getattr(motion, name) + carried.get(name, 0)
            parts[name].append(rows[1:] if i else rows)
        carried = {name: carried[name] + getattr(motion, name)[-1] for name in WORKS}
    for name in by_time:
        fields[name] = np.concatenate(parts[name])
    if times is not None:
        wanted = times[times <= fields["t"][-1] * (1.0 + SAME)]
        places = np.clip(np.searchsorted(fields["t"], wanted), 1, len(fields["t"]) - 1)
        places -= np.abs(fields["t"][places - 1] - wanted) < np.abs(fields["t"][places] - wanted)
        fields = {name: rows[places] for name, rows in fields.items()} | {"t": wanted}
    rows = np.searchsorted(fields["t"], np.array(cuts) * (1.0 - SAME)) if times is None else np.zeros(0, dtype=int)
    for name in ("event_time", "event_contact", "event_mode"):
        fields[name] = np.concatenate([getattr(motion, name) for motion in motions])
    m = len(base.contacts)
    forces, speeds = (np.concatenate([getattr(x, name)[:, :m] for x in motions]) for name in (
        "normal_force", "sliding_velocity"))  # fmt: skip
    said = [*of_a_run(base, np.min(forces, axis=0), np.max(np.abs(speeds), axis=0))]
    texts = (text for motion in motions for text in motion.caution.split("; ") if text)
    said += dict.fromkeys(text for text in texts if not text.startswith(base.contact_names))
    fields |= {name: sum(getattr(motion, name) for motion in motions) for name in ("steps", "rejected", "evaluations")}
    settings = {**first.settings, "duration": cuts[-1] - cuts[0], "pieces": len(motions)}
    inputs = {"system": base}
    return replace(
        first, **fields, caution="; ".join(said), settings=settings, outcome=last.outcome, inputs=inputs
    ), rows
