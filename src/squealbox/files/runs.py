"""The transient that a section [simulate] describes."""

from typing import Any

import numpy as np

from squealbox.files.analyses import Simulate
from squealbox.system import InvalidSystem, System, equilibrium
from squealbox.transient import Trajectory, simulate


def start_of(system: System, settings: Simulate) -> tuple[Any, Any]:
    """Displacement and velocity at the start: rest or steady sliding, and what the section adds to it.

    Raises `InvalidSystem` where steady sliding is asked for and does not exist.
    """
    q = qd = np.zeros(system.size)
    if settings.start == "sliding":
        state = equilibrium(system, settings.begin)
        if not state.exists:
            raise InvalidSystem(f"there is no steady sliding to start from: {state.outcome.message}")
        q = state.q
    return q + (0.0 if settings.q is None else settings.q), qd + (0.0 if settings.qd is None else settings.qd)


def run(system: System, settings: Simulate, *, points: int | None = None) -> Trajectory:
    """The motion, at `points` equal steps in time, by default as many as the section says."""
    return simulate(
        system,
        settings.duration,
        start=start_of(system, settings),
        times=int(settings.points if points is None else points),
        method=settings.method,
        contact=settings.contact,
        rtol=settings.rtol,
        width=settings.width,
        start_time=settings.begin,
    )
