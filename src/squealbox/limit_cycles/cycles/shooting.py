"""Shooting: the start and the period for which the motion comes back, x(T; x0) = x0.

With k shots of length T/k from x_0 .. x_{k-1},

    r_i = x_{i+1} - flow(x_i, T/k) = 0    (x_k = x_0)
    phase: f(x_ref) . (x_0 - x_ref) = 0

are solved by Newton with the derivative of the flow, on the way from motions beside (`differences`). The multipliers
are the eigenvalues of the product of the shots' derivatives, exact with saltation matrices where the states are q and
q' (`variation`).
"""

from dataclasses import replace
from typing import Any

import numpy as np

from squealbox.arguments import public
from squealbox.cautions import out_of_range, turned
from squealbox.limit_cycles.cycles.cycle import Cycle, extremes
from squealbox.limit_cycles.cycles.field import Autonomous
from squealbox.limit_cycles.cycles.remembering import field_of
from squealbox.limit_cycles.cycles.rounds import rounds
from squealbox.limit_cycles.cycles.shots import Newton, monodromy, nodes_along
from squealbox.limit_cycles.cycles.starting import first_guess
from squealbox.limit_cycles.cycles.variation import Flight, fly
from squealbox.parameters import ParameterError, known_names
from squealbox.result import Outcome
from squealbox.start import StartLike
from squealbox.system import DesignOrSystem

CONTACTS = {"exact": "exact", "smooth": "arctan", "arctan": "arctan", "tanh": "tanh"}
NOWHERE = "no motion stays on an unstable cycle: another start or a longer `settle` may lead to what it settles to"
FINER = 0.1  # of the tolerance, where rows of a delay pass the corners of a command on
ROUNDED = 1e-5  # of a command, up to which a delay is told without a word
TURNS = (1, 2, 4)  # past a doubling, a run settles on the cycle that closes after two turns, past the next after four


@public()
def shooting(
    design_or_system: DesignOrSystem,
    start: StartLike = None,
    *,
    contact: str = "exact",
    width: float = 1e-3,
    shots: int = 1,
    settle: float | None = None,
    rtol: float = 1e-13,
    tolerance: float = 1e-10,
    most_steps: int = 30,
    samples: int = 2049,
) -> Cycle:
    """The limit cycle near `start`, by Newton on the exact motion and its exact derivative.

    Parameters
    ----------
    design_or_system : a design or a `System`, with constant loads and speeds
    start : None (the most unstable mode, and rest where that leads to an unstable cycle), or any start of `simulate`,
        from which a run of `settle` seconds leads to the cycle (past a period doubling to the stable one of two or four
        turns, where Newton's method finds it; else to the unstable one); (q, qd, period) or a `Cycle`, taken as they
        are (this is how an unstable cycle is found)
    contact, width : "exact", or "smooth" = "arctan", "tanh" with `width` [m/s]
    shots : 1 for single shooting, more where the cycle is strongly unstable
    settle : [s] of the run before; None takes 300 periods of the slowest mode
    rtol : relative tolerance of the integration [-]
    tolerance : largest scaled residual accepted as converged [-]
    samples : instants kept of one period, to which the events are added

    Returns
    -------
    Cycle, with outcome "completed", "no_convergence" (evidence: history, advice), "steady_sliding" or "no_cycle".

    Accuracy: period and state to about 100 rtol over the distance of the multipliers from 1; extremes of displacement
    add the order-4 error of `samples` points. Source: Nayfeh and Balachandran 1995, Applied Nonlinear Dynamics, Ch. 6.

    >>> from squealbox import Contact, Coulomb, System
    >>> belt = Contact(n=[0.0], d=[1.0], t=[1.0], N0=1.0, V=0.1, law=Coulomb(0.4, 0.25))
    >>> block = System([[1.0]], [[0.0]], [[1.0]], 0.0, (belt,))
    >>> round(float(shooting(block, ([0.0], [0.0])).period), 9)
    7.317597861
    """
    if contact not in CONTACTS:
        raise ParameterError("shooting", "contact", contact, known_names(str(contact), list(CONTACTS)))
    if int(shots) != shots or shots < 1:
        raise ParameterError("shooting", "shots", shots, "a whole number of at least 1")
    field = field_of(design_or_system, CONTACTS[contact], width)
    rtol = FINER * rtol if field.late else rtol
    settings = {"contact": contact, "width": width, "shots": shots, "rtol": rtol, "tolerance": tolerance}
    known = isinstance(start, Cycle) or (isinstance(start, (tuple, list)) and len(start) == 3)

    def reached(start: StartLike) -> Cycle:
        x, period, found = first_guess(field, start, settle)
        if not found.ok:
            return cycle_through(field, x, period, [], found, settings, samples)
        first: Any = None
        for turns in (1,) if known else TURNS:
            turned = turns * (period if first is None else float(first.period))
            newton, outcome = _solved(field, x, turned, int(shots), rtol, tolerance, most_steps)
            error = newton.history[-1] if newton.history else np.inf
            orbit = field, newton.nodes[0], newton.period, newton.flights
            cycle = cycle_through(*orbit, outcome, settings, samples, error)
            first = cycle if first is None else first
            if not cycle.outcome.ok or not _flips(cycle):
                break
        return cycle if cycle.stable else first

    cycle = reached(start)
    if known or cycle.stable or not cycle.outcome.ok:
        return cycle
    if start is None:
        other = reached("rest")
        if other.outcome.ok and other.stable:
            return other
    if cycle.stability == "neutral":
        return cycle
    return replace(cycle, caution="; ".join(filter(None, [cycle.caution, NOWHERE])))


def _solved(
    field: Autonomous, x: np.ndarray, period: float, shots: int, rtol: float, tolerance: float, most: int
) -> tuple[Newton, Outcome]:
    """Newton's method from x; where it converged on a cycle wound several times, again for one round of it."""
    for _ in range(2):
        newton = Newton(field, nodes_along(field, x, period, shots, rtol), period, rtol)
        outcome = newton.solve(tolerance, most)
        wound = rounds(field, newton.nodes[0], newton.period, newton.size, rtol, tolerance) if outcome.ok else 1
        if wound == 1:
            break
        x, period = newton.nodes[0], newton.period / wound
    return newton, outcome


def _flips(cycle: Cycle) -> bool:
    """Whether what leaves the cycle changes sides from turn to turn: a real multiplier below -1."""
    flipping = (np.abs(cycle.multipliers.imag) < 1e-9) & (cycle.multipliers.real < -1.0)
    return bool(np.any(flipping)) and not cycle.stable


def cycle_through(
    field: Autonomous, x: np.ndarray, period: float, flights: list[Flight], outcome: Outcome, settings: dict[str, Any],
    samples: int, error: float = np.nan,
) -> Cycle:  # fmt: skip
    """The cycle through x, sampled at equal instants and at its events; its multipliers are those of its flights."""
    rough = fly(field, x, period, settings["rtol"])
    instants = np.unique(np.r_[np.linspace(0.0, period, samples), rough.event_time])
    run = fly(field, x, period, settings["rtol"], np.minimum(instants, period))
    n = field.system.size
    q, qd = run.q[:, :n], run.qd[:, :n]
    low, high = extremes(run.t, q, qd)
    multipliers = field.multipliers(monodromy(flights) if flights else np.full((x.size, x.size), np.nan))
    return Cycle(
        inputs={"system": field.system}, settings=settings, outcome=outcome, period=np.asarray(period), t=run.t,
        q=q, qd=qd, memory=run.q[0, n:], sliding_velocity=run.sliding_velocity, mode=run.mode, multipliers=multipliers,
        lowest=low, highest=high, event_time=run.event_time, event_contact=run.event_contact,
        event_mode=run.event_mode, error=float(error),
        caution="; ".join([*filter(None, [_caution(flights), _late(field.delay_error(run))]),
                           *out_of_range(field.system, run.normal_force, run.sliding_velocity),
                           *turned(field.system, q)]),
    )  # fmt: skip


def _late(error: float) -> str:
    """What a reader must know of a delay that is written as rows."""
    told = f"what is under way in a delay is a polynomial, off by {error:.1e} of the command: corners of it are rounded"
    return told if error > ROUNDED else ""


def _caution(flights: list[Flight]) -> str:
    """What a reader must know of the multipliers."""
    if any(f.transversality < 1e-6 for f in flights):
        return "an event is nearly tangent (grazing): multipliers and stability are uncertain there"
    if any(f.together for f in flights):
        return "contacts change their modes together: the multipliers take the first for the cause of the others"
    if any(f.mismatch > 1e-8 for f in flights):
        return "the two integrations behind the multipliers differ by more than 1e-8"
    return ""
