"""Loops with sampling, delay and limit in time: the motion `simulate` makes, with forces and work of the actuators.

Work is the integral of force times b.q'; the motion itself is that of `transient.pieces`.
"""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from squealbox.control.plant import with_loops
from squealbox.parameters import ParameterError
from squealbox.result import Array, Result, quantity
from squealbox.system import System, equilibrium
from squealbox.transient.pieces import Pieces, driven_brake, in_pieces, late_command, start_of

PARTS = 32  # of a piece, over which the work of an actuator with a lag is summed


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
    design_or_system : `Controlled(brake, loops)`, some loops of it sampled or late
    start : (q, qd); None is steady sliding without the loops' forces

    >>> from squealbox import PID, System
    >>> block = System([[1.0]], [[0.0]], [[1.0]], loops=(PID(on="q1", derivative=0.1, sampling=2.0),))
    >>> len(run_loops(block, 5.0, ([1.0], [0.0])).t)
    11
    """
    system = with_loops(design_or_system)
    if all(loop.linear for loop in system.loops):
        raise ParameterError(
            "run_loops", "loops", "continuous loops", "sampling or a delay: simulate() runs the others"
        )
    if not (np.isfinite(duration) and duration > 0.0):
        raise ParameterError("run_loops", "duration", duration, "a finite number in (0, inf)")
    driven = driven_brake(system)
    begins = start_of(driven, _resting(system.replace(loops=())) if start is None else start)
    found = in_pieces(driven, begins, 0.0, duration, None, ("exact", 1e-3, None, (rtol, None)), parts=PARTS)
    n, motion, u = system.size, found.motion, found.commands
    q = motion.q[found.rows]
    limits = np.array([np.inf if loop.limit is None else float(loop.limit) for loop in driven.loops])
    at_limit = np.diff(found.cuts) @ (np.abs(u[: len(found.cuts) - 1]) >= limits)
    left = np.abs(np.diff(motion.energy.residual[found.rows]))
    return LoopRun(
        t=found.cuts, q=q[:, :n], qd=motion.qd[found.rows][:, :n],
        force=driven.forces(q, u[: len(found.cuts)]), work=_work(found), residual=np.asarray(np.sum(left)),
        saturated=at_limit / max(float(np.ptp(found.cuts)), 1e-300), outcome=motion.outcome,
        inputs={"system": design_or_system}, settings={"duration": duration, "rtol": rtol},
    )  # fmt: skip


def _work(found: Pieces) -> Any:
    """What the actuators have put in at the ends of the pieces [J]."""
    motion, driven, rows = found.motion, found.driven, found.rows
    done = np.zeros(len(rows))
    for a, loop in enumerate(driven.loops):
        b, power = driven.b[a], motion.qd @ driven.b[a]
        if not np.any(driven.force[a]) and loop.sampling is not None:  # a force that is held
            moved = np.diff(motion.q[rows] @ b)
            done[1:] += np.cumsum(found.commands[: len(moved), a] * moved)
            continue
        forces = [motion.q @ driven.force[a]] * 2
        if not np.any(driven.force[a]):
            sensed = driven.commands(motion.q, motion.qd)[:, a]
            forces = [late_command(motion.t, motion.t, sensed, loop.late, 0.0, after) for after in (True, False)]
        after, before = (force * power for force in forces)
        whole = np.concatenate([[0.0], np.cumsum(0.5 * np.diff(motion.t) * (after[:-1] + before[1:]))])
        done += whole[rows]
    return done


def _resting(system: System) -> tuple[Any, Any]:
    steady = equilibrium(system)
    if not bool(steady.exists):
        raise ParameterError(
            "run_loops", "start", None, f"(q, qd): there is no steady sliding, {steady.outcome.message}"
        )
    return steady.q, np.zeros(system.size)
