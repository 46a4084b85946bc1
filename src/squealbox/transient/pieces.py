"""Motion under loops that are sampled or late, piece by piece, each piece one exact run with all its events.

Sampled: the command of sample k is held and acts from k h + T on. Late: over the shortest delay the command is known
from what was sensed before, and is given at instants `record` apart, joined by lines: an error of order record^2.
Before the first sensed value has arrived the command is 0. It is cut at the limit, held, and then followed by the
actuator; actuators and what controllers remember are rows of first order, as those of continuous loops are.
"""

import time as clock
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from squealbox.loops.driven import Driven, driven_brake
from squealbox.loops.held import aliased
from squealbox.loops.rows import size_and_rate
from squealbox.parameters import ParameterError
from squealbox.schedules import Constant, Schedule, Table
from squealbox.system import InvalidSystem, System, equilibrium
from squealbox.transient.legs import Leg, Progress, by_series, leg, told, ways_of
from squealbox.transient.limited import in_time
from squealbox.transient.methods import TAYLOR
from squealbox.transient.trajectory import Trajectory
from squealbox.transient.widened import parted
from squealbox.transient.widened import start_of as widened_start

PER_RADIAN = 256  # instants of record in each radian of the brake's motion
LEAST, MOST = 16, 4096  # of them in a delay
MOST_PIECES = 200_000
WORK = 32  # parts of a piece over which the work of an actuator with a lag is summed
SAME = 1e-12  # share of a piece below which two instants are one
How = tuple[str, float, Any, tuple[float | None, Any]]  # scheme of contact, width of smoothing, method, tolerances


@dataclass(frozen=True, eq=False)
class Pieces:
    """The motion as one trajectory; `cuts` its instants between pieces, `rows` where, `commands` (k, a) held there."""

    motion: Trajectory
    driven: Driven
    cuts: Any
    rows: Any
    commands: Any


def start_of(driven: Driven, start: Any, time: float = 0.0) -> tuple[Any, Any]:
    """q and q' of all rows: "rest", "sliding" with ideal loops, or (q, q') or (q, q', z) of the brake or all rows."""
    system = in_time(driven.system)
    start, z = parted("simulate", start, system)
    steady = isinstance(start, str) and start == "sliding"
    return widened_start(system, *_start_of(driven, start, time), z, steady, time)


def _start_of(driven: Driven, start: Any, time: float) -> tuple[Any, Any]:
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
    driven: Driven, start: Any, begin: float, duration: float, times: Any, how: How, progress: Progress | None
) -> Trajectory:
    """The motion in pieces, each a march of its own."""
    if how[0] in ("raw", "time-stepping"):
        expected = "exact or smoothed contact: loops that are sampled or late are run in pieces"
        raise ParameterError("simulate", "contact", how[0], expected)
    motion = in_pieces(driven, start_of(driven, start, begin), begin, duration, times, how, progress).motion
    return replace(motion, caution="; ".join([*filter(None, [motion.caution]), *aliased(driven.system, driven.loops)]))


def in_pieces(
    driven: Driven, start: tuple[Any, Any], begin: float, duration: float, times: Any, how: How,
    progress: Progress | None = None, parts: int = 1,
) -> Pieces:  # fmt: skip
    """The motion over `duration` [s] from a start of all rows, with output in so many parts of each piece at least."""
    walk = _Walk(driven, start, begin, duration, how, parts)
    legs, cuts, commands = walk.whole(times, progress)
    system, asked = walk.system, parts > 1 or times is None
    rows = _joined(legs, system, None if asked else times)
    last = legs[-1]
    joined = replace(
        last, rows=rows, events=np.concatenate([each.events for each in legs]),
        lowest=np.min([each.lowest for each in legs], axis=0), fastest=np.max([each.fastest for each in legs], axis=0),
        steps=(*map(sum, zip(*(each.steps for each in legs), strict=True)),),
        reversals=sum(each.reversals for each in legs),
        instead_of=next((each.instead_of for each in legs if each.instead_of), ""),
    )  # fmt: skip
    motion = told(system, walk.ways, start, begin, cuts[-1] - begin, joined)
    motion = replace(motion, inputs={"system": driven.system}, settings={**motion.settings, "pieces": len(legs)})
    places = np.searchsorted(motion.t, np.array(cuts) * (1.0 - SAME)) if asked else np.zeros(0, dtype=int)
    return Pieces(motion, driven, np.array(cuts), places, np.array(commands))


class _Walk:
    def __init__(self, driven: Driven, start: Any, begin: float, duration: float, how: How, parts: int) -> None:
        self.driven, self.system, self.parts = driven, in_time(driven.system), parts
        self.begin, self.end = begin, begin + duration
        self.q, self.qd = start
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
        self.how, self.ways = how, ways_of(self.system, *how)
        self.pushed: Any = None
        if self.ways.method.tableau == TAYLOR and not np.any(self.flowing):
            from squealbox.transient.lanes.single import Pushed

            self.pushed = Pushed(self._under, driven.columns, self.ways.method, duration)

    def whole(self, times: Any, progress: Progress | None) -> tuple[list[Leg], list[float], list[Any]]:
        """Piece after piece to the end: what each wrote, the instants between them and the commands after those."""
        legs: list[Leg] = []
        commands, cuts, now, began = [], [self.begin], self.begin, clock.monotonic()
        while now < self.end - SAME * (self.end - self.begin):
            if progress is not None:
                progress(now, self.end, clock.monotonic() - began)
            self._take(now)
            until = self._next(now)
            legs.append(self._piece(now, until, times))
            commands.append(self._commanded(now, after=True))
            if not legs[-1].outcome.ok:
                break
            cuts.append(until)
            self.q, self.qd = _end_of(self.system, legs[-1])
            now = until
        commands.append(self._commanded(now, after=False))
        return legs, cuts, commands

    def _take(self, now: float) -> None:
        """Samples that are due, and commands that arrive."""
        for a in map(int, np.flatnonzero(~self.flowing)):
            due = self.begin + self.taken[a] * self.steps[a]
            if due <= now + SAME * self.steps[a]:
                self.arrivals.append((due + self.late[a], a, float(self._sensed(self.q, self.qd)[a])))
                self.taken[a] += 1
        self.arrivals.sort(key=lambda each: each[0])
        while self.arrivals and self.arrivals[0][0] <= now + SAME * self.steps[self.arrivals[0][1]]:
            _, a, value = self.arrivals.pop(0)
            self.held[a] = value

    def _sensed(self, q: Any, qd: Any) -> Any:
        """The commands (..., a) at states of all rows (..., n)."""
        n = self.driven.b.shape[1]
        return self.driven.commands(q[..., :n], qd[..., :n])

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
        known, values = self.past
        return late_command(instants, known, values[:, a], self.late[a], self.begin, after)

    def _piece(self, now: float, until: float, times: Any) -> Leg:
        instants = self._instants(now, until, times)
        if self.pushed is not None:
            found = by_series(self.pushed.ready(self.held, self.q, self.qd, now, until, instants), until)
            if found.outcome != "step_underflow" or self.ways.named:
                return found
        driven, moving = self.driven, []
        for a in map(int, np.flatnonzero(self.flowing)):
            if until <= self.begin + self.late[a] * (1.0 + SAME):
                continue
            knots = self.past[0] + self.late[a]
            apart = 1e-9 * self.record
            inner = knots[(knots > now + apart) & (knots < until - apart) & (np.diff(knots, prepend=-np.inf) > apart)]
            at = np.concatenate([[now], inner, [until]])
            moving.append(Table(at, self._earlier(a, at, after=True)) * driven.columns[a])
        system = self._under(np.where(self.flowing, 0.0, self.held) @ driven.columns, moving)
        found = leg(system, ways_of(system, *self.how), self.q, self.qd, now, until - now, instants)
        if np.isfinite(self.record):
            self._remember(now, found)
        return found

    def _under(self, constant: Any, moving: Any = ()) -> System:
        """The brake in time under a further load."""
        system = self.driven.system
        return in_time(system.replace(load=_sum(system.load, constant, moving)))

    def _remember(self, now: float, found: Leg) -> None:
        """Keep what was sensed, for as long as it is under way."""
        keep = self.past[0] >= now - float(np.max(self.late)) - self.record
        known = [part[keep] for part in self.past]
        t, q, qd = found.parts(self.system.size)
        new = slice(1 if len(known[0]) else 0, None)
        self.past = np.concatenate([known[0], t[new]]), np.concatenate([known[1], self._sensed(q, qd)[new]])

    def _instants(self, now: float, until: float, times: Any) -> Any:
        """Instants of one piece: those asked for, those of the record, and its parts."""
        count = self.parts
        if np.isfinite(self.record):
            count = max(int(np.ceil((until - now) / self.record - 1e-9)), 1)
        elif times is None and count == 1:
            return None
        instants = np.append(now + (until - now) * np.arange(count) / count, until)
        if times is None:
            return instants
        apart = 1e-9 * (until - now) / count
        first, last = np.searchsorted(times, [now + apart, until - apart], side="right")
        asked = times[first:last]
        if not len(asked):
            return instants
        near = np.array([np.any(np.abs(asked - instant) <= apart) for instant in instants])
        return np.union1d(instants[~near], asked)


def late_command(instants: Any, known: Any, values: Any, late: float, begin: float, after: bool) -> Any:
    """A command at instants, sensed a time `late` before; 0 until it arrives, at that instant as before or after it."""
    if not len(known):
        return np.zeros(len(instants))
    sensed, margin = instants - late, SAME * late
    return np.where(sensed >= (begin - margin if after else begin + margin), np.interp(sensed, known, values), 0.0)


def _sum(load: Any, constant: Any, moving: list[Any]) -> Any:
    """A load with a constant part and schedules added."""
    if not isinstance(load, Schedule) and not moving:
        return load + constant
    total = load if isinstance(load, Schedule) else Constant(1.0) * load
    for part in (Constant(1.0) * constant, *moving):
        total = total + part
    return total


def _end_of(system: System, of: Leg) -> tuple[Any, Any]:
    """q and q' of all rows at the end of a march; contacts that stick there move exactly with what they stick to."""
    m = len(system.contacts)
    _, q, qd = of.parts(system.size)
    width = of.rows.shape[1]
    stuck = np.flatnonzero(of.rows[-1, width - m :] == 0)
    if not stuck.size:
        return q[-1], qd[-1]
    rows = np.array([system.contacts[c].t for c in stuck])
    return q[-1], qd[-1] + np.linalg.lstsq(rows, of.rows[-1, width - 3 * m + stuck], rcond=1e-12)[0]


def _joined(legs: list[Leg], system: System, times: Any) -> Any:
    """The rows of all legs as those of one, with works that go on, at `times` or all."""
    first, last = 1 + 2 * system.size, 6 + 2 * system.size + len(system.contacts)
    parts, carried = [], np.zeros(last - first)
    for i, each in enumerate(legs):
        rows = each.rows[1:] if i else each.rows
        rows[:, first:last] += carried
        parts.append(rows)
        carried = rows[-1, first:last] if len(rows) else carried
    rows = np.concatenate(parts)
    if times is None:
        return rows
    t = rows[:, 0]
    wanted = times[times <= t[-1] * (1.0 + SAME)]
    places = np.clip(np.searchsorted(t, wanted), 1, max(len(t) - 1, 1))
    places -= np.abs(t[places - 1] - wanted) < np.abs(t[places] - wanted)
    rows = rows[places]
    rows[:, 0] = wanted
    return rows
