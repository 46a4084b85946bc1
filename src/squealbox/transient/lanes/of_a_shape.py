"""Names in the passes over one lane that their writer, `kernel`, fills in: what a shape has, and its features."""

from typing import Any

from squealbox.compiled import FLOAT, WHOLE, OfAnotherText

DOFS = CONTACTS = FUNCTIONS = 0  # degrees of freedom, contacts, event functions
GIVEN = ALL_ROWS = 0  # rows that come with a job, and in all
BREAKS = MEMORY = 0  # kinks of schedules, numbers of the observers
TRIES = SIMPLE = False  # events are located by rejected trials; the usual one is decided on the rows alone
SERIES = STAGED = STEPPED = False  # a Taylor step; a recorded one by stages; samples by steps of the method
RECORDED = SAMPLES = False  # rows of output are kept, or states at given instants
WIDTH = SHARES = 1  # lanes of a group; parts of a step that are rows of output
TERMS, UNIT_OF_WINDOW = 1, 1.0  # coefficients of a series, and the unit of its time in windows
PROBES, PROBE_0, PROBE_1, PROBE_2 = 0, 0.0, 0.0, 0.0  # stages at which margins are looked at, and where these are
step, evaluate, add_works = (OfAnotherText(name, WHOLE) for name in ("step", "evaluate", "add_works"))
gather, set_observers = OfAnotherText("gather", None), OfAnotherText("set_observers", None)
push, stop = OfAnotherText("push", None), OfAnotherText("stop", None)
contact_normal, contact_speed, contact_static, slip_rate, rate_scale, speed_scale = (
    OfAnotherText(name, FLOAT)
    for name in ("contact_normal", "contact_speed", "contact_static", "slip_rate", "rate_scale", "speed_scale")
)


class Lane:
    """One lane of a group: its rows by name, `lane.t`, and those that follow by number, `lane.q[i]`.

    `Lane(A, b, k)` is lane k of the group that begins at place b of the array A. Compiled code hands these three over,
    and a row is a place in the array: see `_engine` and the names in `kernel.PLACES`.
    """

    def __init__(self, A: Any, b: Any, k: Any) -> None:
        raise TypeError("a lane of compiled code alone")

    def __getattr__(self, name: str) -> Any:
        raise TypeError("a lane of compiled code alone")
