"""Motion under loops that are sampled or late, piece by piece, each piece one exact run with all its events.

Sampled: the command of sample k is held and acts from k h + T on. Late: over a piece no longer than the shortest delay
the command is known from what was sensed before, and is given as a polynomial through its values at Chebyshev's points.
Pieces end a delay after each instant at which what was sensed has a kink: an event, a limit reached, the arrival of the
first value. A kink of the j-th derivative passes the brake and its loop as one of the next, until it is nothing.
Before the first sensed value has arrived the command is 0. It is cut at the limit, held, and then followed by the
actuator; actuators and what controllers remember are rows of first order, as those of continuous loops are.
"""

import time as clock
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from squealbox.cautions import aliased
from squealbox.loops import Driven, driven_brake, size_and_rate
from squealbox.parameters import ParameterError
from squealbox.schedules import Constant, Polynomial, Schedule
from squealbox.start import Start
from squealbox.system import System
from squealbox.transient import packing
from squealbox.transient.legs import SCHEMES, Leg, Progress, by_step, leg, told, ways_of
from squealbox.transient.limited import in_time
from squealbox.transient.methods import TAYLOR
from squealbox.transient.sensed import (
    ARC,
    MEANS,
    NEAR,
    NODES,
    SAME,
    WEIGHTS,
    Sensed,
    as_one,
    highest_kink,
    points_of,
)
from squealbox.transient.trajectory import Trajectory
from squealbox.transient.widened import start_of as widened_start

MOST_PIECES = 200_000
How = tuple[str, float, Any, tuple[float | None, Any]]  # scheme of contact, width of smoothing, method, tolerances


@dataclass(frozen=True, eq=False)
class Pieces:
    """The motion as one trajectory; `cuts` its instants between pieces, `marks` which are samples, arrivals or a number
    of delays, `rows` where, `commands` (k, a) from there on, `before` up to there, `work` (k,) [J] of actuators.
    """

    motion: Trajectory
    driven: Driven
    cuts: Any
    marks: Any
    rows: Any
    commands: Any
    before: Any
    work: Any


def start_of_driven(driven: Driven, start: Any, time: float = 0.0, modes_of: Any = None) -> tuple[Any, Any]:
    """q and q' of all rows, from any start of the brake or (q, q') of all rows; sliding is that with ideal loops."""
    system = driven.system
    if isinstance(start, str) and start == "sliding":
        system = system.replace(K=system.K - driven.columns.T @ driven.P)
    own = sum(not name.startswith("loop state") for name in system.names)
    begin = Start.of("simulate", start, system, time, modes_of=modes_of, rows=own)
    return widened_start(in_time(driven.system), begin, time)


def late_loops(system: System) -> Driven | None:
    """The brake with its sampled and late loops driven from outside; None where it has none."""
    return None if all(loop.linear for loop in system.loops) else driven_brake(system)


def motion_of(
    driven: Driven,
    start: tuple[Any, Any],
    begin: float,
    duration: float,
    times: np.ndarray | None,
    how: How,
    progress: Progress | None,
) -> Trajectory:
    """The motion in pieces, each a march of its own."""
    if how[0] in ("raw", "time-stepping"):
        expected = "exact or smoothed contact: loops that are sampled or late are run in pieces"
        raise ParameterError("simulate", "contact", how[0], expected)
    motion = in_pieces(driven, start, begin, duration, times, how, progress).motion
    return replace(motion, caution="; ".join([*filter(None, [motion.caution]), *aliased(driven.system, driven.loops)]))


def in_pieces(
    driven: Driven, start: tuple[Any, Any], begin: float, duration: float, times: np.ndarray | None, how: How,
    progress: Progress | None = None, weighed: bool = False,
) -> Pieces:  # fmt: skip
    """The motion over `duration` [s] from a start of all rows; the work of its actuators where that is `weighed`."""
    walk = _Walk(driven, start, begin, duration, how, weighed)
    legs = walk.whole(times, progress)
    system, last, cuts = walk.system, legs[-1], np.array(walk.cuts)
    end = last.last.copy()
    end[1 + 2 * system.size :] = np.sum([each.last[1 + 2 * system.size :] for each in legs], axis=0)
    joined = replace(
        last, last=end, rows=_joined(legs, system, times), events=np.concatenate([each.events for each in legs]),
        lowest=np.min([each.lowest for each in legs], axis=0), fastest=np.max([each.fastest for each in legs], axis=0),
        steps=(*map(sum, zip(*(each.steps for each in legs), strict=True)),),
        reversals=sum(each.reversals for each in legs),
        instead_of=next((each.instead_of for each in legs if each.instead_of), ""),
    )  # fmt: skip
    motion = told(system, walk.ways, start, begin, float(cuts[-1]) - begin, joined)
    motion = replace(motion, inputs={"system": driven.system}, settings={**motion.settings, "pieces": len(legs)})
    rows = np.searchsorted(motion.t, cuts * (1.0 - SAME)) if times is None else np.zeros(0, dtype=int)
    commands, before = np.array(walk.after), np.array(walk.before)
    return Pieces(motion, driven, cuts, np.array(walk.marks), rows, commands, before, np.cumsum(walk.work))


class _Walk:
    def __init__(self, driven: Driven, start: Any, begin: float, duration: float, how: How, weighed: bool) -> None:
        self.driven, self.system, self.weighed = driven, in_time(driven.system), weighed
        self.begin, self.end = begin, begin + duration
        self.q, self.qd = start
        count = len(driven.loops)
        self.steps = np.array([np.inf if x.sampling is None else 1.0 / float(x.sampling) for x in driven.loops])
        self.late = np.array([loop.late for loop in driven.loops])
        self.flowing = [a for a in range(count) if np.isinf(self.steps[a])]  # late but not sampled
        _, rate = size_and_rate(driven.system, ())
        self.arc = ARC / max(rate, 1e-300)
        self.shortest = min(self.late[self.flowing], default=np.inf)
        self.longest = self.shortest / np.ceil(self.shortest / self.arc) if self.flowing else np.inf
        if duration / min(self.longest, float(np.min(self.steps))) > MOST_PIECES:
            expected = f"at most {MOST_PIECES} samples, delays or half radians of the fastest mode under one"
            raise ParameterError("simulate", "duration", duration, expected)
        self.held = np.zeros(count)
        self.arrivals: list[tuple[float, int, float]] = []
        self.taken = np.zeros(count, dtype=int)
        limits = driven.limits[self.flowing]
        most = highest_kink(rate * self.longest) if self.flowing else 0
        self.sensed = Sensed(begin, self.late[self.flowing], limits, most)
        self.sensed.kink(begin, 0)
        self.cuts, self.marks, self.work = [begin], [True], [0.0]
        self.after: list[Any] = []
        self.before: list[Any] = []
        ways = ways_of(self.system, *how)
        whole = packing.pack(self.system, ways.method, SCHEMES[ways.contact], ways.width, False, start)
        atol = whole["atol"].reshape(2, -1)[:, : self.system.size].ravel()  # that of the motion, not of each piece
        self.ways = replace(ways, method=replace(ways.method, atol=atol))
        self.pushed: Any = None
        if self.ways.method.tableau == TAYLOR:
            from squealbox.transient.lanes.single import Pushed

            numbers, ways = count + (NODES + 2) * len(self.flowing), self.ways
            scheme = SCHEMES[ways.contact]
            self.pushed = Pushed(self._under, numbers, ways.method, duration, scheme, ways.width)

    def whole(self, times: np.ndarray | None, progress: Progress | None) -> list[Leg]:
        """Piece after piece to the end."""
        legs: list[Leg] = []
        now, began = self.begin, clock.monotonic()
        self.before.append(self._commanded(now, before=True))
        while now < self.end - SAME * (self.end - self.begin):
            if progress is not None:
                progress(now, self.end, clock.monotonic() - began)
            self._take(now)
            until, mark = self._next(now)
            self.after.append(self._commanded(now))
            legs.append(self._piece(now, until, times))
            if not legs[-1].outcome.ok:
                break
            now = until
            self.cuts.append(now)
            self.marks.append(mark)
            self.before.append(self._commanded(now, before=True))
            self.q, self.qd = _end_of(self.system, legs[-1])
        self.after.append(self.before[-1])
        return legs

    def _take(self, now: float) -> None:
        """Samples that are due, commands that arrive, and what is late."""
        order = self.sensed.acted(now) if self.flowing else None
        n, u = self.driven.b.shape[1], None
        for a in map(int, np.flatnonzero(np.isfinite(self.steps))):
            due = self.begin + self.taken[a] * self.steps[a]
            if due <= now + SAME * self.steps[a]:
                u = self.driven.commands(self.q[:n], self.qd[:n]) if u is None else u
                self.arrivals.append((due + self.late[a], a, float(u[a])))
                self.taken[a] += 1
        self.arrivals.sort(key=lambda each: each[0])
        while self.arrivals and self.arrivals[0][0] <= now + SAME * self.steps[self.arrivals[0][1]]:
            _, a, value = self.arrivals.pop(0)
            self.held[a], order = value, 0
        if order is not None and self.flowing:
            self.sensed.kink(now, order + 1)

    def _next(self, now: float) -> tuple[float, bool]:
        """Where the piece that begins now ends, and whether at a sample, an arrival, or a number of delays."""
        marks = [self.end, *(instant for instant, _, _ in self.arrivals[:1])]
        marks += [self.begin + k * h for k, h in zip(self.taken, self.steps, strict=True) if np.isfinite(h)]
        others = [instant for instant, _ in self.sensed.due]
        if self.flowing:
            marks.append(self._on_grid(now, self.shortest))
            others.append(self._on_grid(now, self.longest))
        apart = as_one(min(self.longest, self.end - self.begin), now)
        ends = [each for each in (*marks, *others) if each > now + apart]
        until = max(each for each in ends if each <= min(ends) + apart)
        return until, any(abs(each - until) <= apart for each in marks)

    def _on_grid(self, now: float, step: float) -> float:
        return self.begin + (np.floor((now - self.begin) / step + NEAR) + 1.0) * step

    def _commanded(self, now: float, before: bool = False) -> Any:
        """The commands that act from an instant on, or up to it, (a,)."""
        found = np.array(self.held)
        for i, a in enumerate(self.flowing):
            found[a] = self.sensed.commands(i, [now], before)[0]
        return found

    def _piece(self, now: float, until: float, times: np.ndarray | None) -> Leg:
        """March; where an event lies inside and what is sensed must be told, once more with points between events."""
        numbers = self._numbers(now, until)
        edges = self._edges(now, until, [])
        found = self._march(numbers, now, until, _instants(now, until, edges, times))
        apart = NEAR * (until - now)
        inside = sorted({t for t in found.events[:, 0].tolist() if now + apart < t < until - apart})
        if edges and inside and found.outcome.ok:
            edges = self._edges(now, until, inside)
            found = self._march(numbers, now, until, _instants(now, until, edges, times))
        if edges and found.outcome.ok:
            for instant in inside:
                self.sensed.kink(instant, 1)
            self._remember(found, edges)
            self.sensed.forget(until - float(np.max(self.late)))
        return found

    def _edges(self, now: float, until: float, inside: list[float]) -> list[float]:
        """Ends of the stretches in which what is sensed, or the work, is told; empty where neither is wanted."""
        if not (self.flowing or self.weighed):
            return []
        edges, apart = [now], NEAR * (until - now)
        for instant in (*inside, until):
            if instant > edges[-1] + apart:
                parts = int(np.ceil((instant - edges[-1]) / self.arc - NEAR))
                edges += np.linspace(edges[-1], instant, max(parts, 1) + 1)[1:].tolist()
        return edges

    def _numbers(self, now: float, until: float) -> Any:
        """What the load of a piece depends on: the commands that are held, and of each late one its polynomial."""
        numbers = np.zeros(len(self.held) + (NODES + 2) * len(self.flowing))
        numbers[: len(self.held)] = self.held
        for i in range(len(self.flowing)):
            at = len(self.held) + (NODES + 2) * i
            values = self.sensed.commands(i, points_of(now, until))
            numbers[at : at + 2] = 0.5 * (now + until), 2.0 / (until - now)
            numbers[at + 2 : at + 2 + NODES] = WEIGHTS @ values
        return numbers

    def _under(self, numbers: np.ndarray) -> System:
        """The brake in time under the load that belongs to such numbers."""
        system, columns, count = self.driven.system, self.driven.columns, len(self.held)
        load, held = system.load, numbers[:count] @ columns
        if not isinstance(load, Schedule) and not self.flowing:
            return in_time(system.replace(load=load + held))
        total = load if isinstance(load, Schedule) else Constant(1.0) * load
        total = total + Constant(1.0) * held
        for a, p in zip(self.flowing, numbers[count:].reshape(-1, NODES + 2), strict=True):
            total = total + Polynomial(p[2:], p[0], p[1]) * columns[a]
        return in_time(system.replace(load=total))

    def _march(self, numbers: np.ndarray, now: float, until: float, instants: np.ndarray | None) -> Leg:
        if self.pushed is not None:
            found = by_step(self.pushed.ready(numbers, self.q, self.qd, now, until, instants), until)
            if found.outcome != "step_underflow" or self.ways.named:
                return replace(found, rows=found.rows.copy())  # without the room around them
        return leg(self._under(numbers), self.ways, self.q, self.qd, now, until - now, instants)

    def _remember(self, found: Leg, edges: list[float]) -> None:
        """Keep what was sensed, and add up the work of the actuators."""
        driven, n = self.driven, self.driven.b.shape[1]
        t, q, qd = found.parts(self.system.size)
        done = 0.0
        for begin, end in pairwise(edges):
            points = points_of(begin, end)
            rows = np.searchsorted(t, points - NEAR * (end - begin))
            there, moving = q[rows, :n], qd[rows, :n]
            if self.flowing:
                self.sensed.add(begin, end, driven.wanted(there, moving)[:, self.flowing])
            if self.weighed:
                u = np.tile(self.held, (NODES, 1))
                for i, a in enumerate(self.flowing):
                    u[:, a] = self.sensed.commands(i, points)
                power = np.sum(driven.forces(there, u) * (moving @ driven.b.T), axis=-1)
                done += 0.5 * (end - begin) * float(MEANS @ power)
        self.work.append(done)


def _instants(now: float, until: float, edges: list[float], times: np.ndarray | None) -> Any:
    """Instants of one piece: those asked for, and the points of its stretches; None for every step."""
    if times is None and not edges:
        return None
    told_at = [points_of(begin, end) for begin, end in pairwise(edges)]
    instants = np.concatenate([[now], *told_at, [until]])
    if times is None:
        return instants
    first, last = np.searchsorted(times, [now, until], side="left")
    return np.union1d(instants, times[first:last])


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


def _joined(legs: list[Leg], system: System, times: np.ndarray | None) -> Any:
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
