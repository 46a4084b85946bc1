"""One march between two instants, by the generated step or by the scalar one, and how its rows become a result."""

import time as clock
from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import Any, NamedTuple

import numpy as np

from squealbox.cautions import of_a_run, of_the_clock
from squealbox.result import COMPLETED, Outcome
from squealbox.system import System
from squealbox.transient import _march, _motion, packing
from squealbox.transient._motion import ARCTAN, EXACT, OPEN, RAW, TANH
from squealbox.transient.choosing import check_scheme, check_series, chosen_method, has_step, usual_method
from squealbox.transient.methods import TAYLOR, Method
from squealbox.transient.one_motion import undetermined
from squealbox.transient.own_laws import own_texts
from squealbox.transient.rows import rows_of
from squealbox.transient.self_check import checked
from squealbox.transient.smooth_laws import smooth_kinds
from squealbox.transient.trajectory import Trajectory
from squealbox.transient.widened import base_of

SCHEMES = {"exact": EXACT, "raw": RAW, "tanh": TANH, "smooth": ARCTAN, "arctan": ARCTAN}
ROWS = 32_768  # room for steps at first; memory is touched only as rows are written
OTHER = "dormand-prince-8"  # where the usual method cannot go on
BUDGET = (5_000, 50_000)  # least and most steps between two looks at the keyboard
LOOK = 0.02  # s that should pass between them
Progress = Callable[[float, float, float], None]

MESSAGES = {
    _march.UNDERFLOW: ("step_underflow", "no step was small enough for the tolerance"),
    _march.NOT_FINITE: ("not_finite", "the motion left the range of finite numbers"),
    _march.CHATTERING: (
        "chattering",
        "sgn(v) switches at almost every step: the contact sticks, which this scheme cannot hold, or the width of a "
        "smoothed sgn is below what the steps resolve",
    ),
    _march.ZENO: ("zeno", "events accumulate at one instant"),
    _march.INCONSISTENT: ("inconsistent_contact", "no set of stick and slip modes satisfies the contacts together"),
    _march.TENSION: (
        "contact_in_tension",
        "events accumulate while a contact that cannot open is pulled (N < 0): its friction then drives its sliding "
        "instead of opposing it, so beside a sticking contact no mode lasts; a unilateral contact would lift off",
    ),
    _march.PAINLEVE: (
        "painleve",
        "friction presses a sliding rigid contact together harder than its normal force holds it apart, "
        "w . M^-1 (w - sense mu d) <= 0: no force, or more than one, satisfies the contact laws",
    ),
    _march.MISSED: (
        "missed_event",
        "a look at half the search interval, on a sample of steps, found a contact against its mode: events were "
        "passed over, and the motion is not the system's; limit the steps, Method(..., largest_step=...)",
    ),
    _march.STEP_LIMIT: ("step_limit", "the largest number of steps was reached"),
}


class MarchOrders(NamedTuple):
    """What the scalar march is told: instants, where rows and events go, the end, the largest and the least step,
    how many may be tried in all, and how many until the next look at the keyboard.
    """

    times: Any
    rows: Any
    events: Any
    end: float
    largest: float
    least: float
    most: int
    budget: int


@dataclass(frozen=True, eq=False)
class Ways:
    """How a march goes: its method, whether somebody named that, the scheme of its contacts, the width of smoothing,
    and the tolerances that were given.
    """

    method: Method
    named: bool = False
    contact: str = "exact"
    width: float = 1e-3
    given: tuple[float | None, Any] = (None, None)


@dataclass(frozen=True, eq=False)
class Leg:
    """What a march wrote: rows of output and of events, how it ended, the least normal force and the largest sliding
    speed of each contact, steps taken, rejected and evaluated; by which method, and why by another than the usual one;
    `last` begins as a row does: instant, state and works where it ended, whatever rows were asked for.
    """

    rows: Any
    events: Any
    outcome: Outcome
    lowest: Any
    fastest: Any
    steps: tuple[int, ...]
    method: Method
    atol: Any
    last: Any
    reversals: int = 0
    instead_of: str = ""

    def parts(self, n: int) -> tuple[Any, Any, Any]:
        """t, q and q' of all n rows."""
        return self.rows[:, 0], self.rows[:, 1 : 1 + n], self.rows[:, 1 + n : 1 + 2 * n]

    def of_contacts(self, m: int) -> tuple[Any, Any, Any, Any]:
        """N, v, force and mode of the m contacts, each (k, m): the last columns."""
        first = self.rows.shape[1] - 4 * m
        normal, speed, force, mode = (self.rows[:, first + k * m : first + (k + 1) * m] for k in range(4))
        return normal, speed, force, mode


def ways_of(system: System, contact: str, width: float, method: Any, given: tuple[float | None, Any]) -> Ways:
    """The ways of a march: its usual method, or that which was named and can serve, with the tolerances given."""
    chosen = chosen_method(method or usual_method(system, contact), *given)
    check_scheme("simulate", chosen, contact)
    if chosen.tableau == TAYLOR and method is not None:
        check_series(system)
    return Ways(chosen, method is not None, contact, width, given)


def leg(
    system: System, ways: Ways, q: np.ndarray, qd: np.ndarray, begin: float, duration: float, times: np.ndarray | None,
    progress: Progress | None = None,
) -> Leg:  # fmt: skip
    """March from a start of all rows; a usual series that ends at an instant gives way to another method."""
    from squealbox.transient.lanes.single import Single

    scheme, end = SCHEMES[ways.contact], begin + duration

    def marched(method: Method) -> Leg:
        if method.tableau == TAYLOR or has_step(system, ways.contact):
            return by_step(Single(system, method, q, qd, begin, duration, times, scheme, ways.width), end, progress)
        march = Scalar(system, method, scheme, ways.width, q, qd, begin, times)
        return march.leg(march.to(end, duration, progress))

    found = marched(ways.method)
    if found.outcome != "step_underflow" or ways.named or ways.method.tableau != TAYLOR:
        return found  # else a law without a series at zero speed, such as one with sqrt(v)
    instead = f"taylor, which ended as step_underflow at {found.outcome.evidence['time']:.6g} s"
    return replace(marched(chosen_method(OTHER, *ways.given)), instead_of=instead)


def by_step(run: Any, end: float, progress: Progress | None = None) -> Leg:
    """The march of a generated step that is ready to go."""
    n, m = run.system.size, len(run.system.contacts)
    code, why = run.to(end, progress)
    reached = run.out[0, 1:5] if code is not None else [run.at("t"), run.at("taken"), run.at("tries"), 0.0]
    if code is None:
        outcome = Outcome("interrupted", why, time=float(reached[0]))
    elif code == _march.COMPLETED:
        outcome = Outcome(COMPLETED)
    else:
        state = run.out[0, 5 : 5 + n], run.out[0, 5 + n : 5 + 2 * n]
        speed = run.speeds(float(reached[0]), state[1])
        outcome = failed(code, end, float(reached[0]), run.at("h"), (*state, speed), int(reached[1]))
    lowest, fastest = run.several("lowest", m), run.several("fastest", m)
    taken, tried = int(reached[1]), int(reached[2])
    rows, events = run.columns()
    steps = taken, tried - taken, tried * run.evaluations
    last = np.concatenate([[run.at("t")], run.several("q", n), run.several("v", n), run.several("done", m + 4), [0.0]])
    return Leg(rows, events, outcome, lowest, fastest, steps, run.method, run.atol, last, int(run.at("reversals")))


class Scalar:
    """One march with its records and output, resumed until it ends."""

    def __init__(
        self,
        system: System,
        method: Method,
        scheme: int,
        width: float,
        q: np.ndarray,
        qd: np.ndarray,
        time: float,
        times: np.ndarray | None,
    ) -> None:
        self.system, self.method = system, method
        self.problem = packing.pack(system, method, scheme, width, times is None, (q, qd))
        self.rule = packing.rule(method.tableau)
        self.scratch = packing.scratch(self.problem, q, qd, time, method.first_step or 0.0)
        self.times = np.full(1, np.inf) if times is None else times
        self.rows = np.empty((ROWS if times is None else len(times), packing.row_width(self.problem)))
        self.events = np.zeros((256, 3))
        self.period = 1e3 * float(self.problem["window"])  # the shortest; inf where nothing swings
        room = len(self.problem["mk"])
        self.atol = self.problem["atol"].reshape(2, room)[:, : system.size].ravel()

    def to(self, end: float, span: float, progress: Progress | None = None) -> Outcome:
        """March from the start to `end`, `span` seconds later."""
        march, (p, r, s, orders) = self.call(end, span)
        code, budget, began = _march.RUNNING, BUDGET[0], clock.monotonic()
        try:
            while code == _march.RUNNING:
                self._make_room()
                before = clock.monotonic()
                code = march(p, r, s, orders._replace(rows=self.rows, events=self.events, budget=budget))
                now = clock.monotonic()
                wanted = int(budget * LOOK / max(now - before, 1e-4))
                budget = min(max(wanted, BUDGET[0]), BUDGET[1])
                if progress is not None:
                    progress(float(self.scratch["clock"][_motion.TIME]), end, now - began)
        except KeyboardInterrupt:
            reached = float(self.scratch["clock"][_motion.TIME])
            return Outcome("interrupted", f"stopped by the user at t = {reached:g} s", time=reached)
        return self._outcome(code, end)

    def call(self, end: float, span: float) -> tuple[Any, tuple[Any, ...]]:
        """The compiled march of this run, and what it is called with."""
        from squealbox.transient._engine import kernel

        if not np.isfinite(self.period):
            self.period = 6.0 * span
            self.problem["window"] = 1e-3 * self.period
        events = bool(self.problem["scheme"] == EXACT and self.problem["contacts"] > 0)
        march = kernel(events, own=own_texts(self.system.contacts))
        swing = float(packing.schedule_frequency(self.system))
        seen = self.period / 6.0 if events else np.pi / (3.0 * swing) if swing > 0.0 else np.inf
        largest = min(self.method.largest_step or np.inf, span, seen)
        limits = end, largest, 1e-14 * self.period, self.method.most_steps, BUDGET[0]
        return march, (self.problem, self.rule, self.scratch, MarchOrders(self.times, self.rows, self.events, *limits))

    def _make_room(self) -> None:
        count = self.scratch["count"]
        if self.problem["every_step"] and count[_motion.ROWS] >= len(self.rows):
            self.rows = packing.longer(self.rows)
        if count[_motion.EVENTS] + self.problem["contacts"] > len(self.events):
            more = np.zeros((len(self.events) + int(self.problem["contacts"]), 3))
            self.events = np.concatenate([self.events, more])

    def _outcome(self, code: int, end: float) -> Outcome:
        if code == _march.COMPLETED:
            return Outcome(COMPLETED)
        s, n, room = self.scratch, self.system.size, len(self.problem["mk"])
        reached, step = float(s["clock"][_motion.TIME]), float(s["clock"][_motion.STEP])
        speed = s["speed"][: len(self.system.contacts)]
        state = s["state"][:n], s["state"][room : room + n], speed
        return failed(code, end, reached, step, state, int(s["count"][_motion.ACCEPTED]))

    def leg(self, outcome: Outcome) -> Leg:
        """What was written so far."""
        m, s, n, room = len(self.system.contacts), self.scratch, self.system.size, len(self.problem["mk"])
        y = s["state"]
        last = np.r_[s["clock"][_motion.TIME], y[:n], y[room : room + n], y[2 * room : 2 * room + m + 5]]
        count = [int(x) for x in s["count"]]
        steps = count[_motion.ACCEPTED], count[_motion.REJECTED], count[_motion.EVALUATIONS]
        return Leg(
            self.rows[: count[_motion.ROWS]], self.events[: count[_motion.EVENTS]], outcome,
            s["lowest"][:m], s["fastest"][:m], steps, self.method, self.atol, last, count[_motion.REVERSALS],
        )  # fmt: skip


def failed(code: int, end: float, reached: float, step: float, state: tuple[Any, Any, Any], accepted: int) -> Outcome:
    """The outcome of a run that could not go on, with what it had reached: q, q' and sliding velocities."""
    name, why = MESSAGES[code]
    q, qd, speed = (np.asarray(each).tolist() for each in state)
    message = f"{why}; reached t = {reached:.9g} s of {end:g} s with a step of {step:.3g} s"
    return Outcome(name, message, time=reached, step=step, q=q, qd=qd, sliding_velocity=speed, accepted=accepted)


def told(system: System, ways: Ways, start: tuple[Any, Any], begin: float, duration: float, of: Leg) -> Trajectory:
    """A march as a result. Its rows are t, q, q', the works, then N, v, force and mode of each contact: of the works
    first those of friction, then of load, circulation, damping, opening and impacts.
    """
    settings: dict[str, Any] = {
        "duration": duration, "start": [x.tolist() for x in start], "start_time": begin, "contact": ways.contact,
        "width": ways.width, "tableau": of.method.tableau, "rtol": of.method.rtol, "atol": of.atol.tolist(),
    }  # fmt: skip
    said = [_caution(ways, of.reversals), *of_a_run(system, of.lowest, of.fastest), *of_the_clock(begin, duration)]
    said += undetermined(system, of.rows, of.events)
    if of.instead_of:
        settings["instead_of"] = of.instead_of
        said.insert(0, f"run by {of.method.tableau} from the start, instead of {of.instead_of}")
    n, m, base, rows, events = system.size, len(system.contacts), base_of(system), of.rows, of.events
    (t, q, qd), (normal, speed, force, mode) = of.parts(n), of.of_contacts(m)
    works = rows[:, 1 + 2 * n : 6 + 2 * n + m]
    friction, (load, circulation, dissipated, opening, impact) = works[:, :m], works[:, m:].T
    if any(smooth := smooth_kinds(system.contacts)):  # no events tell their sense
        mode = np.where((np.array(smooth) > 0) & (mode != OPEN), np.sign(speed), mode)
    motion = Trajectory(
        inputs={"system": base},
        settings=settings,
        outcome=of.outcome,
        t=t,
        q=q[:, : base.size],
        qd=qd[:, : base.size],
        normal_force=np.where(mode == OPEN, 0.0, normal),
        sliding_velocity=speed,
        friction_force=force,
        mode=mode.astype(np.int8),
        end_q=of.last[1 : 1 + base.size],
        end_qd=of.last[1 + n : 1 + n + base.size],
        work_friction=friction,
        work_load=load,
        work_circulation=circulation,
        work_dissipated=dissipated,
        work_opening=opening,
        work_impact=impact,
        event_time=events[:, 0],
        event_contact=events[:, 1].astype(np.int64),
        event_mode=events[:, 2].astype(np.int8),
        caution="; ".join(filter(None, said)),
        steps=of.steps[0],
        rejected=of.steps[1],
        evaluations=of.steps[2],
    )
    if ways.contact == "raw":
        return motion
    first = np.zeros(len(of.last))
    first[0], first[1 : 1 + n], first[1 + n : 1 + 2 * n] = begin, *start
    if rows_of(system).all_have_mass:
        return checked(motion, first, of.last, n)
    return checked(motion, rows[0], rows[-1], n) if len(rows) > 1 else motion  # a start is changed to what rows allow


def _caution(ways: Ways, reversals: int) -> str:
    """What a reader must know of a run that did not locate the reversals of its contacts."""
    if reversals == 0 or ways.contact == "exact":
        return ""
    advice = 'compare with contact="exact"'
    if ways.contact == "raw":
        return f"plain sgn was stepped over {reversals} times: no tolerance bounds the error there; {advice}"
    return (
        f"sliding reversed {reversals} times inside a smoothing of {ways.width:g} m/s: sticking became creep; {advice}"
    )
