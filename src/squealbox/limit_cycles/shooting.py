"""Shooting: the start and the period for which the motion comes back, x(T; x0) = x0.

With k shots of length T/k from x_0 .. x_{k-1},

    r_i = x_{i+1} - flow(x_i, T/k) = 0    (x_k = x_0)
    phase: f(x_ref) . (x_0 - x_ref) = 0

are solved by Newton with the exact derivative of the flow, saltation matrices included (`variation`). The multipliers
are the eigenvalues of the product of the shots' derivatives.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.limit_cycles.cycle import Cycle, extremes, ordered
from squealbox.limit_cycles.field import Field
from squealbox.limit_cycles.starting import first_guess
from squealbox.limit_cycles.variation import Flight, flight, fly, quick_flight
from squealbox.parameters import ParameterError, known_names
from squealbox.result import COMPLETED, Outcome
from squealbox.system import as_system

CONTACTS = {"exact": "exact", "smooth": "arctan", "arctan": "arctan", "tanh": "tanh"}
TURNS = (1, 2, 4)  # past a doubling, a run settles on the cycle that closes after two turns, past the next after four
COARSE = 1e-5  # residual above which a derivative to 1e-8 is as good as the exact one
ADVICE = "give a start nearer to the cycle, a longer `settle`, or more `shots`"


def shooting(
    design_or_system: Any,
    start: Any = None,
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
    start : None (the most unstable mode, else rest), a `Mode`, (q, qd) or a `Trajectory`, from which a run of `settle`
        seconds leads to the cycle (past a period doubling to the stable one of two or four turns, where Newton's
        method finds it; else to the unstable one); (q, qd, period) or a `Cycle`, taken as they are (this is how an
        unstable cycle is found)
    contact, width : "exact", or "smooth" = "arctan", "tanh" with `width` [m/s]
    shots : 1 for single shooting, more where the cycle is strongly unstable
    settle : [s] of the run before; None takes 300 periods of the slowest mode
    rtol : of the integration
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
    field = Field(as_system(design_or_system), CONTACTS[contact], width)
    x, period, found = first_guess(field, start, settle)
    settings = {"contact": contact, "width": width, "shots": shots, "rtol": rtol, "tolerance": tolerance}
    if not found.ok:
        return cycle_through(field, x, period, np.full((x.size, x.size), np.nan), found, settings, samples, np.nan)
    known = isinstance(start, Cycle) or (isinstance(start, (tuple, list)) and len(start) == 3)
    first: Any = None
    for turns in (1,) if known else TURNS:
        turned = turns * (period if first is None else float(first.period))
        newton = Newton(field, _nodes(field, x, turned, int(shots), rtol), turned, rtol)
        outcome = newton.solve(tolerance, most_steps)
        error = newton.history[-1] if newton.history else np.inf
        cycle = cycle_through(
            field, newton.nodes[0], newton.period, newton.monodromy, outcome, settings, samples, error, newton.flights
        )
        first = cycle if first is None else first
        if not cycle.outcome.ok or not _flips(cycle):
            break
    return cycle if cycle.stable else first


def _flips(cycle: Cycle) -> bool:
    """Whether what leaves the cycle changes sides from turn to turn: a real multiplier below -1."""
    flipping = (np.abs(cycle.multipliers.imag) < 1e-9) & (cycle.multipliers.real < -1.0)
    return bool(np.any(flipping)) and not cycle.stable


@dataclass(frozen=True, eq=False)
class _Shots:
    """Residual, its norm [-], and the flights behind it."""

    residual: Any
    norm: float
    flights: list[Flight]


class Newton:
    """Newton's method on the shots, in states scaled to velocities; keeps the history of the scaled residual."""

    def __init__(self, field: Field, nodes: Any, period: float, rtol: float) -> None:
        self.field, self.nodes, self.period, self.rtol = field, nodes, period, rtol
        self.reference = nodes[0].copy()
        self.coarse = field.contact == "exact"  # the derivative to 1e-8, far from the cycle
        self.history: list[float] = []
        self.flights: list[Flight] = []
        self.monodromy = np.full((nodes.shape[1],) * 2, np.nan)

    def solve(self, tolerance: float, most: int) -> Outcome:
        """Iterate until the residual is below `tolerance` and no longer falls."""
        now = self._shoot(self.nodes, self.period)
        if not now.flights[-1].outcome.ok:
            return Outcome("no_convergence", f"a shot ended early: {now.flights[-1].outcome.message}", advice=ADVICE)
        heading = now.flights[0]
        normal = self._phase(heading)
        for _ in range(most):
            self.history.append(now.norm)
            if self.coarse and now.norm < COARSE:
                self.coarse, now = False, self._shoot(self.nodes, self.period)
            step = self._step(now, normal)
            following = self._damped(now, step, most_halvings=0 if now.norm < tolerance else 6)
            if following is None and not self.coarse:
                break
            if following is None:
                self.coarse, now = False, self._shoot(self.nodes, self.period)
            else:
                now, self.nodes, self.period = following
        if self.coarse:
            self.coarse, now = False, self._shoot(self.nodes, self.period)
        self.flights = now.flights
        self.monodromy = _product([f.phi for f in now.flights])
        if now.norm > tolerance or not np.isfinite(now.norm):
            message = f"Newton's method stopped at a scaled residual of {now.norm:.3g}: {ADVICE}"
            return Outcome("no_convergence", message, history=self.history, advice=ADVICE)
        return self._degenerate(now) or Outcome(COMPLETED, "", history=self.history)

    def _shoot(self, nodes: Any, period: float) -> _Shots:
        flights = []
        for node in nodes:
            fly_to = quick_flight if self.coarse else flight
            flights.append(fly_to(self.field, node, period / len(nodes), self.rtol))
            if not flights[-1].outcome.ok:
                return _Shots(None, np.inf, flights)
        ends = np.array([f.x for f in flights])
        residual = np.roll(nodes, -1, axis=0) - ends
        scale = self.field.scale
        states = np.vstack([np.hstack([f.motion.q, f.motion.qd]) for f in flights])
        size = float(np.max(np.ptp(states, axis=0) * scale)) or 1.0
        return _Shots(residual, float(np.max(np.abs(residual * scale))) / size, flights)

    def _phase(self, flight_: Flight) -> Any:
        mode = flight_.motion.mode[0]
        normal = self.field.rate(self.reference, mode) * self.field.scale
        return normal / np.linalg.norm(normal)

    def _step(self, now: _Shots, normal: Any) -> Any:
        """Newton step (k 2n + 1,), in scaled states and the share of the period."""
        k, size = self.nodes.shape
        scale = self.field.scale
        matrix = np.zeros((k * size + 1, k * size + 1))
        for i, f in enumerate(now.flights):
            rows = slice(i * size, (i + 1) * size)
            after = (i + 1) % k
            matrix[rows, after * size : (after + 1) * size] += np.eye(size)
            matrix[rows, rows] -= f.phi * (scale[:, None] / scale)
            matrix[rows, -1] = -f.rate * scale * self.period / k
        matrix[-1, :size] = normal
        right = np.append((now.residual * scale).ravel(), normal @ ((self.nodes[0] - self.reference) * scale))
        weight = np.max(np.abs(matrix[:, -1])) or 1.0
        matrix[:, -1] /= weight
        step = np.linalg.lstsq(matrix, -right, rcond=1e-14)[0]
        step[-1] /= weight
        return step

    def _damped(self, now: _Shots, step: Any, most_halvings: int) -> tuple[_Shots, Any, float] | None:
        """The first of the step, its half, its quarter ... that lowers the residual; None when none does."""
        share = min(1.0, 0.3 / max(abs(step[-1]), 1e-300))
        for _ in range(most_halvings + 1):
            nodes = self.nodes + share * step[:-1].reshape(self.nodes.shape) / self.field.scale
            period = self.period * (1.0 + share * step[-1])
            trial = self._shoot(nodes, period)
            if trial.norm < now.norm:
                return trial, nodes, period
            share *= 0.5
        return None

    def _degenerate(self, now: _Shots) -> Outcome | None:
        speed = max(float(np.ptp(f.motion.qd, axis=0).max()) for f in now.flights)
        reference = float(np.max(np.abs(self.field.V), initial=0.0)) or 1.0
        if speed > 1e-9 * reference:
            return None
        return Outcome("steady_sliding", "the shots met on steady sliding, not on a cycle", history=self.history)


def _product(matrices: Any) -> Any:
    total = matrices[0]
    for matrix in matrices[1:]:
        total = matrix @ total
    return total


def _nodes(field: Field, x: Any, period: float, shots: int, rtol: float) -> Any:
    """Starts of the shots, along the motion from x."""
    if shots == 1:
        return x[None].copy()
    run = fly(field, x, period, rtol, np.linspace(0.0, period, shots + 1))
    return np.hstack([run.q, run.qd])[:shots]


def cycle_through(
    field: Field, x: Any, period: float, monodromy: Any, outcome: Outcome, settings: dict[str, Any], samples: int,
    error: float, flights: list[Flight] | None = None,
) -> Cycle:  # fmt: skip
    """The cycle through x, sampled at equal instants and at its events."""
    rough = fly(field, x, period, settings["rtol"])
    instants = np.unique(np.r_[np.linspace(0.0, period, samples), rough.event_time])
    run = fly(field, x, period, settings["rtol"], np.minimum(instants, period))
    low, high = extremes(run.t, run.q, run.qd)
    multipliers = ordered(np.linalg.eigvals(monodromy)) if np.all(np.isfinite(monodromy)) else np.full(x.size, np.nan)
    return Cycle(
        inputs={"system": field.system}, settings=settings, outcome=outcome, period=np.asarray(period), t=run.t,
        q=run.q, qd=run.qd, sliding_velocity=run.sliding_velocity, mode=run.mode, multipliers=multipliers,
        lowest=low, highest=high, event_time=run.event_time, event_contact=run.event_contact,
        event_mode=run.event_mode, error=float(error), caution=_caution(flights or []),
    )  # fmt: skip


def _caution(flights: list[Flight]) -> str:
    """What a reader must know of the multipliers."""
    if any(f.transversality < 1e-6 for f in flights):
        return "an event is nearly tangent (grazing): multipliers and stability are uncertain there"
    if any(f.together for f in flights):
        return "contacts change their modes together: the multipliers take the first for the cause of the others"
    if any(f.mismatch > 1e-8 for f in flights):
        return "the two integrations behind the multipliers differ by more than 1e-8"
    return ""
