"""What happens in time: one transient of one system."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import public
from squealbox.parameters import ParameterError, known_names
from squealbox.start import Start
from squealbox.system import System, as_system, no_rigid_contact
from squealbox.transient import moreau, pieces
from squealbox.transient._motion import EXACT
from squealbox.transient.choosing import chosen_method, usual_method
from squealbox.transient.instants import instants_of
from squealbox.transient.latest import Latest
from squealbox.transient.legs import SCHEMES, Progress, Scalar, leg, told, ways_of
from squealbox.transient.limited import in_time
from squealbox.transient.methods import TAYLOR, Method
from squealbox.transient.trajectory import Trajectory
from squealbox.transient.widened import base_of, start_of

TIME_STEPPING = "time-stepping"


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
    atol: ArrayLike | None = None,
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
    start : "rest" (the default: q = qd = 0, loads applied suddenly), "sliding" (steady sliding without vibration),
        "mode" or "mode 2" (with a small vibration in the mode that grows fastest, or in the second), or
        {"mode": 2, "amplitude": 1e-6} [m]; a `Mode`; (q, qd), shapes (n,) and (n,) [m], [m/s]; a `Trajectory`, from its
        end; a `Cycle`. Laws with memory begin with their bristles straight, or bent as in steady sliding; (q, qd, z)
        gives their deflections [m], one for each such contact
    times : instants of output [s] within the run, shape (k,), increasing; a whole number k for k equidistant instants;
        None for every step taken, a long one in parts of at most a sixth of the shortest period. They do not influence
        the steps.
    method : "taylor" (the motion's own series, for all but plain sgn), the name of a tableau, or a `Method` with
        tolerances; None takes "taylor" wherever the equation has a series, else "dormand-prince-8", also where the
        series ends at an instant: `caution` and `settings` then say so
    contact : "exact" (stick, slip and lift-off by events), "raw" (plain sgn), "smooth" = "arctan"
        ((2/pi) arctan(v/width)), "tanh" (tanh(v/width)) or "time-stepping" (Moreau: many contacts, sliding in a plane)
    rtol, atol : override those of `method`, [-] and [m/s]
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
        asked = instants_of("simulate", times, start_time, duration)
        how = contact, width, method, (rtol, atol)
        start = pieces.start_of_driven(late, start, start_time, design_or_system)
        return pieces.motion_of(late, start, start_time, duration, asked, how, progress)
    system = system_of(design_or_system, plane=plane)
    ways = ways_of(system, contact, width, method, (rtol, atol))
    requested = instants_of("simulate", times, start_time, duration)
    if contact != "exact":
        no_rigid_contact(system, f"contact={contact!r}")
    begin = Start.of("simulate", start, base_of(system), start_time, modes_of=design_or_system)
    _check_gaps(base_of(system), begin.q)
    q, qd = start_of(system, begin, start_time)
    if plane:
        return moreau.time_stepping(system, duration, q, qd, start_time, requested, step)
    found = leg(system, ways, q, qd, start_time, duration, requested, progress)
    return told(system, ways, (q, qd), start_time, duration, found)


SYSTEMS, LATE = Latest(16), Latest(16)


def system_of(design_or_system: Any, *, plane: bool = False) -> System:
    """The system in time of a design; one that slides in a `plane` where the motion knows it."""
    found: System = SYSTEMS.of(design_or_system, plane, lambda: in_time(as_system(design_or_system, plane=plane)))
    return found


def exact_call(system: System) -> tuple[Any, tuple[Any, ...]]:
    """The compiled march of an exact run of the usual method with given instants, and what it is called with."""
    name, rest = usual_method(system, "exact"), np.zeros(system.size)
    method = chosen_method(name, None, None)
    if name == TAYLOR:
        from squealbox.transient.lanes.single import Single

        return Single(system, method, rest, rest, 0.0, 1.0, np.array([0.0, 1.0])).call()
    return Scalar(system, method, EXACT, 1e-3, rest, rest, 0.0, np.array([0.0, 1.0])).call(1.0, 1.0)


def _check_gaps(system: System, q: np.ndarray) -> None:
    """A start inside a rigid contact is no start."""
    for i, contact in enumerate(system.contacts):
        if contact.rigid:
            size = abs(contact.gap) + float(np.sum(np.abs(contact.normal * q)))
            gap = contact.gap - float(contact.normal @ q)
            if gap < -1e-12 * size:
                expected = f"a gap >= 0 at rigid contact {i + 1}, not {gap:.3g} m"
                raise ParameterError("simulate", "start", q.tolist(), expected)
