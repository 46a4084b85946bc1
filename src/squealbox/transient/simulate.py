"""What happens in time: one transient of one system."""

import time as clock
from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from squealbox.arguments import public
from squealbox.cautions import of_a_run
from squealbox.parameters import ParameterError, known_names
from squealbox.result import COMPLETED, Outcome
from squealbox.system import InvalidSystem, System, as_system, equilibrium, no_rigid_contact
from squealbox.transient import _march, _motion, moreau, packing, pieces
from squealbox.transient._motion import ARCTAN, EXACT, OPEN, RAW, TANH
from squealbox.transient.choosing import check_series, chosen_method, usual_method
from squealbox.transient.instants import instants_of
from squealbox.transient.latest import Latest
from squealbox.transient.limited import in_time
from squealbox.transient.methods import TAYLOR, Method
from squealbox.transient.one_motion import undetermined
from squealbox.transient.own_laws import own_texts
from squealbox.transient.self_check import checked
from squealbox.transient.smooth_laws import smooth_kinds
from squealbox.transient.trajectory import Trajectory
from squealbox.transient.widened import base_of, parted, start_of

SCHEMES = {"exact": EXACT, "raw": RAW, "tanh": TANH, "smooth": ARCTAN, "arctan": ARCTAN}
TIME_STEPPING = "time-stepping"
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
        "sgn(v) switches at almost every step: the contact sticks, which this scheme cannot hold",
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


@public()
def simulate(
    design_or_system: Any,
    duration: float,
    start: Any = None,
    times: Any = None,
    method: str | Method | None = None,
    contact: str = "exact",
    *,
    rtol: float | None = None,
    atol: Any = None,
    width: float = 1e-3,
    step: float | None = None,
    start_time: float = 0.0,
    progress: Progress | None = None,
) -> Trajectory:
    """Integrate the equation of motion over `duration` seconds.

    Parameters
    ----------
    design_or_system : a design, or a `System` without leading axes
    duration : [s], > 0
    start : (q, qd), shapes (n,) and (n,) [m], [m/s]; "rest" (the default: q = qd = 0, loads applied suddenly) or
        "sliding" (steady sliding without vibration). Laws with memory begin with their bristles straight, or bent as in
        steady sliding; (q, qd, z) gives their deflections [m], one for each such contact
    times : instants of output [s] within the run, shape (k,), increasing; a whole number k for k equidistant instants;
        None for every step taken, a long one in parts of at most a sixth of the shortest period. They do not influence
        the steps.
    method : "taylor" (the motion's own series, for exact contact), the name of a tableau, or a `Method` with
        tolerances; None takes "taylor" wherever the equation has a series, else "dormand-prince-8", also where the
        series ends at an instant: `caution` and `settings` then say so
    contact : "exact" (stick, slip and lift-off by events), "raw" (plain sgn), "smooth" = "arctan"
        ((2/pi) arctan(v/width)), "tanh" (tanh(v/width)) or "time-stepping" (Moreau: many contacts, sliding in a plane)
    rtol, atol : override those of `method`
    width : [m/s] of the smoothed sgn
    step : [s] of time stepping; None takes 1/400 of the shortest period. The other schemes choose their steps.
    start_time : [s], where the schedules begin
    progress : called with (time reached, end, seconds since the start of the run) some fifty times a second; what it
        raises ends the run and reaches the caller. Time stepping, which is one call, does not call it.

    Returns
    -------
    Trajectory, whose outcome is "completed" or names why the run could not go on ("step_underflow", "not_finite",
    "chattering", "zeno", "contact_in_tension", "painleve", "inconsistent_contact", "step_limit", "interrupted", or
    by its self-check "missed_event", "energy_unbalanced"); it then holds what was reached.

    Raises `ParameterError` or `InvalidSystem` for input that does not make sense.

    >>> from squealbox import DrumBrake
    >>> simulate(DrumBrake(), duration=1e-3).outcome
    'completed'
    """
    if contact not in (*SCHEMES, TIME_STEPPING):
        raise ParameterError("simulate", "contact", contact, known_names(str(contact), [*SCHEMES, TIME_STEPPING]))
    plane = contact == TIME_STEPPING
    late = LATE.of(design_or_system, plane, lambda: pieces.late_loops(as_system(design_or_system, plane=plane)))
    if late is not None:
        one = partial(simulate, method=method, contact=contact, rtol=rtol, atol=atol, width=width)
        asked = instants_of("simulate", times, start_time, duration)
        return pieces.motion_of(late, start, start_time, duration, asked, one, contact, progress)
    system = system_of(design_or_system, plane=plane)
    chosen = chosen_method(method or usual_method(system, contact), rtol, atol)
    requested = instants_of("simulate", times, start_time, duration)
    if contact != "exact":
        no_rigid_contact(system, f"contact={contact!r}")
    start, z = parted("simulate", start, system)
    q, qd = _start(base_of(system), start, start_time)
    _check_gaps(base_of(system), q)
    q, qd = start_of(system, q, qd, z, isinstance(start, str) and start == "sliding", start_time)
    if plane:
        return moreau.time_stepping(system, duration, q, qd, start_time, requested, step)
    instead: dict[str, str] = {}
    if chosen.tableau == TAYLOR:
        if method is not None:
            check_series(system, contact)
        motion = _by_series(system, chosen, contact, width, q, qd, start_time, duration, requested, progress)
        if motion.outcome != "step_underflow" or method is not None:
            return motion
        chosen = chosen_method(OTHER, rtol, atol)  # a law without a series at zero speed, such as one with sqrt(v)
        reached = f"{motion.outcome.evidence['time']:.6g} s"
        instead = {"instead_of": f"taylor, which ended as step_underflow at {reached}"}
    run = _Run(system, chosen, SCHEMES[contact], width, q, qd, start_time, requested)
    outcome = run.to(start_time + duration, duration, progress)
    settings = {
        "duration": duration, "start": [q.tolist(), qd.tolist()], "start_time": start_time, "contact": contact,
        "width": width, "tableau": chosen.tableau, "rtol": chosen.rtol, "atol": run.atol.tolist(), **instead,
    }  # fmt: skip
    return run.trajectory(settings, outcome)


SYSTEMS, LATE = Latest(16), Latest(16)


def system_of(design_or_system: Any, *, plane: bool = False) -> System:
    """The system in time of a design; one that slides in a `plane` where the motion knows it."""
    found: System = SYSTEMS.of(design_or_system, plane, lambda: in_time(as_system(design_or_system, plane=plane)))
    return found


class _Run:
    """One march with its records and output, resumed until it ends."""

    def __init__(
        self, system: System, method: Method, scheme: int, width: float, q: Any, qd: Any, time: float, times: Any
    ) -> None:
        self.system, self.method = system, method
        self.problem = packing.pack(system, method, scheme, width, times is None)
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
        march, arguments = self.call(end, span)
        code, budget, began = _march.RUNNING, BUDGET[0], clock.monotonic()
        try:
            while code == _march.RUNNING:
                self._make_room()
                before = clock.monotonic()
                code = march(*arguments[:4], self.rows, self.events, *arguments[6:10], budget)
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
        march = kernel(events, counts=() if events else self._counts(), own=own_texts(self.system.contacts))
        swing = float(packing.schedule_frequency(self.system))
        seen = self.period / 6.0 if events else np.pi / (3.0 * swing) if swing > 0.0 else np.inf
        largest = min(self.method.largest_step or np.inf, span, seen)
        records = (self.problem, self.rule, self.scratch, self.times, self.rows, self.events)
        return march, (*records, end, largest, 1e-14 * self.period, self.method.most_steps, BUDGET[0])

    def _counts(self) -> tuple[tuple[str, int], ...]:
        """What the kernel without events is compiled for; the one with events compiles longer and stays general."""
        problem = [(f"p.{name}", int(self.problem[name])) for name in ("size", "contacts")]
        return (*problem, *((f"r.{name}", int(self.rule[name])) for name in ("stages", "blended")))

    def _make_room(self) -> None:
        count = self.scratch["count"]
        if self.problem["every_step"] and count[_motion.ROWS] >= len(self.rows):
            self.rows = np.concatenate([self.rows, np.empty_like(self.rows)])
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

    def trajectory(self, settings: dict[str, Any], outcome: Outcome) -> Trajectory:
        """The output so far as a result."""
        m, s = len(self.system.contacts), self.scratch
        count = [int(x) for x in s["count"]]
        rows, events = self.rows[: count[_motion.ROWS]], self.events[: count[_motion.EVENTS]]
        said = [_instead(settings), _caution(settings, count[_motion.REVERSALS])]
        said += (*of_a_run(self.system, s["lowest"][:m], s["fastest"][:m]), *undetermined(self.system, rows, events))
        caution = "; ".join(each for each in said if each)
        steps = count[_motion.ACCEPTED], count[_motion.REJECTED], count[_motion.EVALUATIONS]
        return told(self.system, rows, events, settings, outcome, caution, steps)


def failed(code: int, end: float, reached: float, step: float, state: tuple[Any, Any, Any], accepted: int) -> Outcome:
    """The outcome of a run that could not go on, with what it had reached: q, q' and sliding velocities."""
    name, why = MESSAGES[code]
    q, qd, speed = (np.asarray(each).tolist() for each in state)
    message = f"{why}; reached t = {reached:.9g} s of {end:g} s with a step of {step:.3g} s"
    return Outcome(name, message, time=reached, step=step, q=q, qd=qd, sliding_velocity=speed, accepted=accepted)


def told(
    system: System, rows: Any, events: Any, settings: dict[str, Any], outcome: Outcome, caution: str,
    steps: tuple[int, int, int],
) -> Trajectory:  # fmt: skip
    """Rows of output as a result: t, q, q', the works, then N, v, force and mode of each contact."""
    n, m, base = system.size, len(system.contacts), base_of(system)
    widths = [1, n, n, m, 1, 1, 1, 1, 1, m, m, m, m]
    columns = np.split(rows, np.cumsum(widths)[:-1], axis=1)
    t, q, qd, friction, load, circulation, dissipated, opening, impact, normal, speed, force, mode = columns
    smooth = np.array(smooth_kinds(system.contacts)) > 0  # no events tell their sense
    mode = np.where(smooth & (mode != OPEN), np.sign(speed), mode)
    motion = Trajectory(
        inputs={"system": base},
        settings=settings,
        outcome=outcome,
        t=t[:, 0],
        q=q[:, : base.size],
        qd=qd[:, : base.size],
        normal_force=np.where(mode == OPEN, 0.0, normal),
        sliding_velocity=speed,
        friction_force=force,
        mode=mode.astype(np.int8),
        work_friction=friction,
        work_load=load[:, 0],
        work_circulation=circulation[:, 0],
        work_dissipated=dissipated[:, 0],
        work_opening=opening[:, 0],
        work_impact=impact[:, 0],
        event_time=events[:, 0],
        event_contact=events[:, 1].astype(np.int64),
        event_mode=events[:, 2].astype(np.int8),
        caution=caution,
        steps=steps[0],
        rejected=steps[1],
        evaluations=steps[2],
    )
    return checked(motion, rows, n) if settings["contact"] == "exact" else motion


def _by_series(
    system: System, method: Method, contact: str, width: float, q: Any, qd: Any, begin: float, duration: float,
    times: Any, progress: Progress | None,
) -> Trajectory:  # fmt: skip
    """The run by the generated step of a Taylor series."""
    from squealbox.transient.lanes.single import Single

    run, end = Single(system, method, q, qd, begin, duration, times), begin + duration
    n, m = system.size, len(system.contacts)
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
    settings = {
        "duration": duration, "start": [q.tolist(), qd.tolist()], "start_time": begin, "contact": contact,
        "width": width, "tableau": method.tableau, "rtol": method.rtol, "atol": run.atol.tolist(),
    }  # fmt: skip
    lowest, fastest = ([run.at(f"{name}{c}") for c in range(m)] for name in ("lowest", "fastest"))
    said = "; ".join(of_a_run(system, lowest, fastest))
    taken, tried = int(reached[1]), int(reached[2])
    return told(system, *run.columns(), settings, outcome, said, (taken, tried - taken, tried))


def exact_call(system: System) -> tuple[Any, tuple[Any, ...]]:
    """The compiled march of an exact run of the usual method with given instants, and what it is called with."""
    name, rest = usual_method(system, "exact"), np.zeros(system.size)
    method = chosen_method(name, None, None)
    if name == TAYLOR:
        from squealbox.transient.lanes.single import Single

        return Single(system, method, rest, rest, 0.0, 1.0, np.array([0.0, 1.0])).call()
    return _Run(system, method, EXACT, 1e-3, rest, rest, 0.0, np.array([0.0, 1.0])).call(1.0, 1.0)


def _instead(settings: dict[str, Any]) -> str:
    """That a run was made by another method than the usual one, and why."""
    other = settings.get("instead_of")
    return f"run by {settings['tableau']} from the start, instead of {other}" if other else ""


def _caution(settings: dict[str, Any], reversals: int) -> str:
    """What a reader must know of a run that did not locate the reversals of its contacts."""
    if reversals == 0 or settings["contact"] == "exact":
        return ""
    advice = 'compare with contact="exact"'
    if settings["contact"] == "raw":
        return f"plain sgn was stepped over {reversals} times: no tolerance bounds the error there; {advice}"
    width = settings["width"]
    return f"sliding reversed {reversals} times inside a smoothing of {width:g} m/s: sticking became creep; {advice}"


def _start(system: System, start: Any, time: float) -> tuple[Any, Any]:
    n = system.size
    if start is None or (isinstance(start, str) and start == "rest"):
        return np.zeros(n), np.zeros(n)
    if isinstance(start, str) and start == "sliding":
        state = equilibrium(system, time)
        if not state.exists:
            raise InvalidSystem(f"there is no steady sliding to start from: {state.outcome.message}")
        return state.q, np.zeros(n)
    try:
        q, qd = (np.array(x, dtype=float).reshape(n) for x in start)
    except (TypeError, ValueError) as error:
        raise ParameterError(
            "simulate", "start", start, f'(q, qd) with {n} values each, "rest" or "sliding"'
        ) from error
    if not (np.all(np.isfinite(q)) and np.all(np.isfinite(qd))):
        raise ParameterError("simulate", "start", start, "finite displacements and velocities")
    return q, qd


def _check_gaps(system: System, q: Any) -> None:
    """A start inside a rigid contact is no start."""
    for i, contact in enumerate(system.contacts):
        if contact.rigid:
            size = abs(contact.gap) + float(np.sum(np.abs(contact.normal * q)))
            gap = contact.gap - float(contact.normal @ q)
            if gap < -1e-12 * size:
                expected = f"a gap >= 0 at rigid contact {i + 1}, not {gap:.3g} m"
                raise ParameterError("simulate", "start", q.tolist(), expected)
