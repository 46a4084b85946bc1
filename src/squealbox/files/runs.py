"""The transient that a section [simulate] describes."""

from typing import Any

import numpy as np

from squealbox.files.analyses import Simulate
from squealbox.start import Start
from squealbox.system import System, as_system
from squealbox.transient import Trajectory, simulate


def start_of(design_or_system: Any, settings: Simulate) -> tuple[Any, Any]:
    """Displacement and velocity at the start: what the section names, and what it adds to that.

    Raises `InvalidSystem` where steady sliding is asked for and does not exist.
    """
    system = as_system(design_or_system)
    begin = Start.of("simulate", settings.begins, system, settings.begin, modes_of=design_or_system)
    return tuple(x if more is None else x + more for x, more in ((begin.q, settings.q), (begin.qd, settings.qd)))


PERIODS = 200.0  # of the worst mode, followed where nobody says how long
SAMPLES = 12  # kept in a period of the quickest mode, at least, of a run that is judged
LARGE = 5_000  # coordinates times contacts from which no motion is followed unasked
MOST_NUMBERS = 40_000_000  # kept of one run: displacements and velocities together


def usual_duration(design: Any, time: float = 0.0, periods: float = PERIODS) -> float:
    """So many periods [s] of the worst mode about steady sliding, or of the quickest without friction; else 1 s."""
    from squealbox.stability import complex_modes

    modes = complex_modes(design, time)
    worst = float(modes.most_unstable.frequency) if bool(modes.exists) else 0.0
    hertz = worst if worst > 0.0 else _quickest(as_system(design))
    return periods / hertz if hertz > 0.0 else 1.0


def lasting(design: Any, settings: Simulate) -> Simulate:
    """The section with a duration: its own, or the usual one of the brake."""
    return settings.replace({"duration": settings.duration or usual_duration(design, settings.begin)})


def run_closely(system: System, settings: Simulate) -> Trajectory:
    """The motion at so many instants that amplitude, frequency and level can be read from them.

    The instants somebody keeps are his, those of a verdict follow from the brake: `SAMPLES` in a period of the quickest
    mode. Where so many do not fit in memory, the last stretch that fits is kept.
    """
    settings, quickest = lasting(system, settings), _quickest(system)
    assert settings.duration is not None
    needed = int(np.ceil(SAMPLES * quickest * settings.duration)) + 1 if np.isfinite(quickest) else 0
    most = max(MOST_NUMBERS // (2 * system.size), 1000)
    if needed <= int(settings.points):
        return run(system, settings)
    if needed <= most:
        return run(system, settings, points=needed)
    end = settings.begin + settings.duration
    return run(system, settings, points=np.linspace(end - (most - 1) / (SAMPLES * quickest), end, most))


def _quickest(system: System) -> float:
    """The highest frequency [Hz] among the modes of the brake without friction; NaN when there is none."""
    from squealbox.stability import finite_spectrum

    found = np.asarray(finite_spectrum(System(system.M, system.C, system.K)).eigenvalues)
    return float(np.max(np.abs(found.imag))) / (2.0 * np.pi) if found.size else np.nan


def run(system: System, settings: Simulate, *, points: Any = None) -> Trajectory:
    """The motion at `points`, a number of equal steps or the instants; by default as many as the section says."""
    return simulate(
        system,
        settings.duration or usual_duration(system, settings.begin),
        start=start_of(system, settings),
        times=int(settings.points) if points is None else points,
        method=None if settings.method == "usual" else settings.method,
        contact=settings.contact,
        rtol=settings.rtol,
        width=settings.width,
        start_time=settings.begin,
    )
