"""How a motion is followed: what of `simulate` can be set, for files, the command line and pages; and for how long."""

from collections.abc import Mapping
from typing import Any, ClassVar

import numpy as np

from squealbox.parameters import DataSheet, ParameterError, Vector, above_zero, choice, parameter
from squealbox.start import Start, in_words
from squealbox.system import System, as_system
from squealbox.transient.legs import SCHEMES
from squealbox.transient.methods import TABLEAUX, TAYLOR
from squealbox.transient.simulating import TIME_STEPPING, simulate
from squealbox.transient.trajectory import Trajectory

PERIODS = 200.0  # of the worst mode, followed where nobody says how long
SAMPLES = 12  # kept in a period of the quickest mode, at least, of a run that is judged
LARGE = 5_000  # coordinates times contacts from which no motion is followed unasked
MOST_NUMBERS = 40_000_000  # kept of one run: displacements and velocities together


class MotionSettings(DataSheet):
    """[simulate]: a transient."""

    formerly: ClassVar[Mapping[str, str]] = {"begin": "start_time", "points": "times"}

    duration: float | None = above_zero(
        "s", default=None, meaning="how long the motion is followed; left out, 200 periods of the worst mode"
    )
    start: str = choice(
        "rest", "sliding", "mode", default="rest",
        meaning="where it starts: at zero, in steady sliding, or beside it in a mode; mode 2 says in which",
    )  # fmt: skip
    mode: int | None = parameter("-", 1, default=None, optional=True, meaning="left out, the mode that grows fastest")
    amplitude: float | None = above_zero(
        "m", default=None, meaning="of the mode; left out, the sliding speed of a contact swings by a hundredth"
    )
    q: Vector = parameter("m", default=None, optional=True, meaning="displacement added at the start; left out, none")
    qd: Vector = parameter("m/s", default=None, optional=True, meaning="velocity at the start; left out, zero")
    method: str = choice(
        "usual", TAYLOR, *TABLEAUX, default="usual",
        meaning="usual: the Taylor series where the equation has one, else dormand-prince-8; or a method by name",
    )  # fmt: skip
    rtol: float | None = parameter("-", 1e-14, 0.1, default=None, optional=True, meaning="left out, the method's own")
    contact: str = choice(
        *SCHEMES, TIME_STEPPING, default="exact",
        meaning="events (exact), plain sgn (raw), a smoothed sgn, or fixed steps, which know sliding in a plane",
    )  # fmt: skip
    width: float = parameter("m/s", 0.0, low_open=True, default=1e-3, meaning="speed over which sgn is smoothed")
    start_time: float = parameter("s", default=0.0, meaning="instant at which the schedules begin")
    times: int = parameter("-", 2, 1_000_000, default=5001, meaning="number of instants kept")

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.amplitude is not None and self.start != "mode":
            expected = 'a start in a mode beside it, such as "mode 1"'
            raise ParameterError(type(self).__name__, "amplitude", self.amplitude, expected)

    @staticmethod
    def spelled(given: Mapping[str, Any]) -> dict[str, Any]:
        """``"mode 2"`` and ``{ mode = 2, amplitude = "1 um" }`` as start, mode and amplitude; the rest as given."""
        start = given.get("start")
        asked = start if isinstance(start, Mapping) else in_words(start)
        more = {} if asked is None else {name: value for name, value in asked.items() if value is not None}
        return {**given, **({} if asked is None else {"start": "mode"}), **more}

    def start_of(self, design_or_system: Any) -> tuple[Any, Any]:
        """Displacement (n,) [m] and velocity (n,) [m/s] at the start: what `start` names, and what q and qd add to it.

        Raises `InvalidSystem` where steady sliding is asked for and does not exist.
        """
        number = None if self.mode is None else int(self.mode)
        start = {"mode": number, "amplitude": self.amplitude} if self.start == "mode" else self.start
        system = as_system(design_or_system)
        begin = Start.of("simulate", start, system, self.start_time, modes_of=design_or_system)
        return tuple(x if more is None else x + more for x, more in ((begin.q, self.q), (begin.qd, self.qd)))

    def lasting(self, design: Any) -> "MotionSettings":
        """The same with a duration: its own, or the usual one of the brake."""
        return self.replace({"duration": self.duration or usual_duration(design, self.start_time)})

    def run(self, system: System, times: Any = None) -> Trajectory:
        """The motion at `times`, a number of equal steps or the instants [s], shape (k,); left out, at its own."""
        return simulate(
            system, self.duration or usual_duration(system, self.start_time), start=self.start_of(system),
            times=int(self.times) if times is None else times, method=None if self.method == "usual" else self.method,
            contact=self.contact, rtol=self.rtol, width=self.width, start_time=self.start_time,
        )  # fmt: skip

    def run_closely(self, system: System) -> Trajectory:
        """The motion at so many instants that amplitude, frequency and level can be read from them.

        The instants somebody keeps are his, those of a verdict follow from the brake: `SAMPLES` in a period of the
        quickest mode. Where so many do not fit in memory, the last stretch that fits is kept.
        """
        settings, quickest = self.lasting(system), _quickest(system)
        assert settings.duration is not None
        needed = int(np.ceil(SAMPLES * quickest * settings.duration)) + 1 if np.isfinite(quickest) else 0
        most = max(MOST_NUMBERS // (2 * system.size), 1000)
        if needed <= int(settings.times):
            return settings.run(system)
        if needed <= most:
            return settings.run(system, needed)
        end = settings.start_time + settings.duration
        return settings.run(system, np.linspace(end - (most - 1) / (SAMPLES * quickest), end, most))


def usual_duration(design: Any, time: float = 0.0, periods: float = PERIODS) -> float:
    """So many periods [s] of the worst mode about steady sliding, or of the quickest without friction; else 1 s.

    `time` [s]: instant at which schedules are taken; `periods` [-]: how many.
    """
    from squealbox.stability import complex_modes

    modes = complex_modes(design, time)
    worst = float(modes.most_unstable.frequency) if bool(modes.exists) else 0.0
    hertz = worst if worst > 0.0 else _quickest(as_system(design))
    return periods / hertz if hertz > 0.0 else 1.0


def _quickest(system: System) -> float:
    """The highest frequency [Hz] among the modes of the brake without friction; NaN when there is none."""
    from squealbox.stability import finite_spectrum

    found = np.asarray(finite_spectrum(System(system.M, system.C, system.K)).eigenvalues)
    return float(np.max(np.abs(found.imag))) / (2.0 * np.pi) if found.size else np.nan
