"""Loops with sampling, delay and limit in time: the motion `simulate` makes, with forces and work of the actuators.

Work is the integral of force times b.q'; the motion itself is that of `transient.pieces`.
"""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from squealbox.control.plants import with_loops
from squealbox.loops import Driven, driven_brake
from squealbox.parameters import ParameterError
from squealbox.result import Array, Outcome, Result, quantity
from squealbox.system import DesignOrSystem, System, equilibrium
from squealbox.transient import in_pieces, start_of_driven

LAST, MOSTLY = 0.25, 0.5  # share of a run, and share of that at a limit beyond which a loop is saturated


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


def run_loops(design_or_system: DesignOrSystem, duration: float, start: Any = None, *, rtol: float = 1e-10) -> LoopRun:
    """The motion over `duration` [s] of a brake whose loops are sampled, or late, or both; limits are kept.

    Parameters
    ----------
    design_or_system : `Controlled(brake, loops)`, some loops of it sampled or late
    start : (q, qd); None is steady sliding without the loops' forces
    rtol : [-] relative tolerance of the integration

    The outcome is that of the motion, or "saturated" where the force of a loop was at its limit for more than half of
    the last quarter. A late command is a polynomial between its kinks, as exact as the motion; see `transient.pieces`.

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
    begins = start_of_driven(driven, _resting(system.replace(loops=())) if start is None else start)
    found = in_pieces(driven, begins, 0.0, duration, None, ("exact", 1e-3, None, (rtol, None)), weighed=True)
    n, motion, kept = system.size, found.motion, found.marks
    rows, u = found.rows[kept], found.commands[: len(kept)]
    size = np.where([loop.sampling is None for loop in driven.loops], np.abs(found.before[1:]), np.inf)
    at_limit = np.minimum(np.abs(u[:-1]), size) >= driven.limits * (1.0 - 1e-9)
    lasting = np.diff(found.cuts)
    left = np.abs(np.diff(motion.energy.residual[found.rows]))
    return LoopRun(
        t=found.cuts[kept], q=motion.q[rows][:, :n], qd=motion.qd[rows][:, :n],
        force=driven.forces(motion.q[rows], u[kept]), work=found.work[kept], residual=np.asarray(np.sum(left)),
        saturated=lasting @ at_limit / max(float(np.sum(lasting)), 1e-300),
        outcome=_outcome(driven, motion.outcome, found.cuts, at_limit),
        inputs={"system": design_or_system}, settings={"duration": duration, "rtol": rtol},
    )  # fmt: skip


def _outcome(driven: Driven, outcome: Outcome, cuts: np.ndarray, at_limit: np.ndarray) -> Outcome:
    """That of the motion; "saturated" where it completed with a force that is at its limit most of its last part."""
    last = np.clip(cuts[1:] - np.maximum(cuts[:-1], cuts[-1] - LAST * (cuts[-1] - cuts[0])), 0.0, None)
    shares = last @ at_limit / max(float(np.sum(last)), 1e-300)
    if not outcome.ok or not np.any(shares > MOSTLY):
        return outcome
    a = int(np.argmax(shares))
    loop, share = driven.loops[a], float(shares[a])
    message = (
        f"the force of the loop on {loop.on} was at its limit of {float(driven.limits[a]):g} N for "
        f"{100.0 * share:.3g} % of the last quarter: what is commanded no longer acts"
    )
    return Outcome("saturated", message, loop=a, share=share)


def _resting(system: System) -> tuple[Any, Any]:
    steady = equilibrium(system)
    if not bool(steady.exists):
        raise ParameterError(
            "run_loops", "start", None, f"(q, qd): there is no steady sliding, {steady.outcome.message}"
        )
    return steady.q, np.zeros(system.size)
