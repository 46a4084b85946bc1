"""Loops with sampling, delay and limit in time, with exact contact: piece by piece, each piece one exact run.

Sampled: u is constant between samples, so each piece is a run under a constant load b u, with all its events; the force
changes T_a after the sample. Delayed: over one delay the force is known from what was sensed a delay ago, and is a load
given at `POINTS` instants, joined by lines: an error of order (T/POINTS)^2. Before the first sensed value has arrived
the force is 0. Work of the actuators is the integral of u b.q'.
"""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from squealbox.control.plant import with_loops
from squealbox.parameters import ParameterError
from squealbox.result import Array, Outcome, Result, quantity
from squealbox.schedules import Schedule, Table
from squealbox.system import System, equilibrium
from squealbox.transient.simulate import simulate

POINTS = 256  # instants of a delay at which what was sensed is kept
MOST_PIECES = 200_000


@dataclass(frozen=True, kw_only=True, eq=False)
class LoopRun(Result):
    """A motion under late or sampled loops, as :func:`run_loops` returns it, at the ends of its pieces."""

    t: Array = quantity("time", "s", "instants")
    q: Array = quantity("time dof", "m", "displacement")
    qd: Array = quantity("time dof", "m/s", "velocity")
    force: Array = quantity("time loop", "N", "force of each loop from that instant on")
    work: Array = quantity("time", "J", "work the actuators have put in")
    residual: Any = quantity("", "J", "what the energy audits of the pieces leave, added up")
    saturated: Array = quantity("loop", "1", "share of the time each force was at its limit")

    coordinates: ClassVar = {"time": "t"}

    def summary(self) -> str:
        """How it ended, its amplitude, the actuators' work."""
        return (
            f"{self.outcome}: {len(self.t) - 1} pieces to t = {self.t[-1]:.6g} s, "
            f"actuators put in {self.work[-1]:.6g} J, "
            f"at the limit {100.0 * float(np.max(self.saturated, initial=0.0)):.3g} % of the time"
        )

    def __repr__(self) -> str:
        return self.summary()


def run_loops(design_or_system: Any, duration: float, start: Any = None, *, rtol: float = 1e-10) -> LoopRun:
    """The motion over `duration` [s] of a brake whose loops are sampled, or late, or both; limits are kept.

    Parameters
    ----------
    design_or_system : `Controlled(brake, loops)`; loops without memory, sampled at one rate or all delayed alike
    start : (q, qd); None is steady sliding without the loops' forces

    >>> from squealbox import PID, System
    >>> block = System([[1.0]], [[0.0]], [[1.0]], loops=(PID(on="q1", derivative=0.1, sampling=2.0),))
    >>> len(run_loops(block, 5.0, ([1.0], [0.0])).t)
    11
    """
    system = with_loops(design_or_system)
    loops = system.loops
    rows = [loop.rows(system.names) for loop in loops]
    rates = {loop.sampling for loop in loops}
    if not loops or any(row.memory for row in rows):
        raise ParameterError("run_loops", "loops", len(loops), "loops without memory: no integral, bandwidth or filter")
    if len(rates) > 1 or len({loop.late for loop in loops}) > 1:
        raise ParameterError("run_loops", "loops", sorted(map(str, rates)), "one rate and one delay for all loops")
    if not (np.isfinite(duration) and duration > 0.0):
        raise ParameterError("run_loops", "duration", duration, "a finite number in (0, inf)")
    bare = system.replace(loops=())
    if isinstance(bare.load, Schedule):
        raise ParameterError("run_loops", "system", "a load that moves", "a constant load")
    late, rate = loops[0].late, rates.pop()
    if rate is None and late == 0.0:
        raise ParameterError(
            "run_loops", "loops", "continuous loops", "sampling or a delay: simulate() runs the others"
        )
    q, qd = (np.asarray(part, dtype=float) for part in start) if start is not None else _resting(bare)
    limits = np.array([np.inf if loop.limit is None else float(loop.limit) for loop in loops])
    P, R, B = (np.array([getattr(row, name) for row in rows]) for name in ("P", "R", "b"))

    def commanded(displacement: Any, velocity: Any) -> Any:
        return np.clip(displacement @ P.T + velocity @ R.T, -limits, limits)

    walk = _Walk(bare, B, q, qd, rtol)
    if rate is not None:
        _sampled(walk, commanded, duration, 1.0 / float(rate), late)
    else:
        _delayed(walk, commanded, duration, late)
    force = np.array([*walk.forces, walk.forces[-1]])
    length = np.diff(walk.t)
    at_limit = np.array([np.sum(length * (np.abs(force[:-1, a]) >= limits[a])) for a in range(len(loops))])
    return LoopRun(
        t=np.array(walk.t), q=np.array(walk.q), qd=np.array(walk.qd), force=force, work=np.cumsum([0.0, *walk.work]),
        residual=np.asarray(walk.residual), saturated=at_limit / max(float(np.sum(length)), 1e-300),
        outcome=walk.outcome,
        inputs={"system": design_or_system}, settings={"duration": duration, "rtol": rtol},
    )  # fmt: skip


class _Walk:
    """The motion so far, and how it goes on under a force."""

    def __init__(self, system: System, B: Any, q: Any, qd: Any, rtol: float) -> None:
        self.system, self.B, self.rtol = system, B, rtol
        self.t, self.q, self.qd = [0.0], [q], [qd]
        self.forces: list[Any] = []
        self.work: list[float] = []
        self.residual, self.outcome = 0.0, Outcome()

    def on(self, force: Any, until: float) -> bool:
        """Run to `until` under constant forces; False when the run could not go on."""
        begin = self.t[-1]
        held = self.system.replace(load=self.system.load + force @ self.B)
        motion = simulate(
            held, until - begin, (self.q[-1], self.qd[-1]), [begin, until], rtol=self.rtol, start_time=begin
        )
        if motion.outcome.ok:
            self.work.append(float((force @ self.B) @ (motion.q[-1] - self.q[-1])))
        return self._kept(motion, force, until)

    def along(self, instants: Any, forces: Any, until: float) -> Any:
        """Run to `until` under forces (k, loops) at instants (k,); what is moving at those instants of this piece."""
        begin = self.t[-1]
        load: Any = Table([begin, begin + 1.0], [1.0, 1.0]) * self.system.load
        for a in range(len(self.B)):
            load = load + Table(instants, forces[:, a]) * self.B[a]
        inside = np.append(instants[instants < until - 1e-12 * (until - begin)], until)
        inside[0] = begin
        motion = simulate(
            self.system.replace(load=load),
            until - begin,
            (self.q[-1], self.qd[-1]),
            inside,
            rtol=self.rtol,
            start_time=begin,
        )
        if motion.outcome.ok:
            put_in = np.sum((forces[: len(inside)] @ self.B) * motion.qd, axis=1)
            self.work.append(float(np.trapezoid(put_in, inside)))
        self._kept(motion, forces[0], until)
        return motion

    def _kept(self, motion: Any, force: Any, until: float) -> bool:
        if not motion.outcome.ok:
            self.outcome = motion.outcome
            if not self.forces:
                self.forces.append(force)
            return False
        self.t.append(until)
        self.q.append(motion.q[-1])
        self.qd.append(motion.qd[-1])
        self.forces.append(force)
        self.residual += float(abs(motion.energy.residual[-1]))
        return True


def _sampled(walk: _Walk, commanded: Any, duration: float, step: float, late: float) -> None:
    """Samples at k h; the force of sample k acts from k h + late on."""
    count = int(np.ceil(duration / step - 1e-12))
    if count > MOST_PIECES:
        raise ParameterError("run_loops", "duration", duration, f"at most {MOST_PIECES} samples")
    arrivals: list[tuple[float, Any]] = []
    force = np.zeros(len(walk.B))
    for k in range(count):
        begin, end = k * step, min((k + 1) * step, duration)
        arrivals.append((begin + late, commanded(walk.q[-1], walk.qd[-1])))
        while arrivals and arrivals[0][0] < end - 1e-12 * step:
            at, new = arrivals.pop(0)
            if at > walk.t[-1] + 1e-12 * step and not walk.on(force, at):
                return
            force = new
        if end > walk.t[-1] + 1e-12 * step and not walk.on(force, end):
            return


def _delayed(walk: _Walk, commanded: Any, duration: float, late: float) -> None:
    """The method of steps: what is sensed over one delay is the force over the next."""
    count = int(np.ceil(duration / late - 1e-12))
    if count > MOST_PIECES:
        raise ParameterError("run_loops", "duration", duration, f"at most {MOST_PIECES} delays")
    forces = np.zeros((POINTS + 1, len(walk.B)))
    for k in range(count):
        instants = k * late + np.linspace(0.0, late, POINTS + 1)
        motion = walk.along(instants, forces, min((k + 1) * late, duration))
        if not motion.outcome.ok:
            return
        forces = commanded(motion.q, motion.qd)
        forces = np.vstack([forces, np.repeat(forces[-1:], POINTS + 1 - len(forces), axis=0)])


def _resting(system: System) -> tuple[Any, Any]:
    steady = equilibrium(system)
    if not bool(steady.exists):
        raise ParameterError(
            "run_loops", "start", None, f"(q, qd): there is no steady sliding, {steady.outcome.message}"
        )
    return steady.q, np.zeros(system.size)
