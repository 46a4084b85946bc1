"""What is measured of a motion before it is judged: its envelope, and what that says of its last part and half."""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from squealbox.signals import column, highest_line, slope
from squealbox.transient.envelope import Curve, envelope, last_period, repetition
from squealbox.transient.trajectory import Trajectory

FEW = 6.0  # periods in a stretch from which a transform tells a frequency
STILL = 1e-9  # of the whole swing: what moves less in the last part is at rest


@dataclass(frozen=True)
class Course:
    """What was measured of a motion. Without oscillation the envelope is that of the speed."""

    begin: float
    end: float
    part: float
    late: float
    time: Any
    envelope: Any
    centre: Any
    amplitude: float
    offset: float
    turns: int
    frequency: float = float("nan")
    rate: float = float("nan")
    rate_error: float = float("nan")
    misfit: float = float("nan")
    rest: float = float("nan")
    sticks: str = ""

    def at_rate(self, rate: float, error: float) -> "Course":
        """The same course, its rate another stretch's."""
        return replace(self, rate=rate, rate_error=error)

    @property
    def last(self) -> float:
        """Length [s] of the last part."""
        return self.part * (self.end - self.begin)

    def stretch(self, left: float, right: float) -> tuple[float, float]:
        """Rate and error of the logarithm of the envelope between shares `left` and `right` of the run."""
        share = (self.time - self.begin) / (self.end - self.begin)
        inside = (share >= left) & (share <= right) & (self.envelope > 0.0)
        return slope(self.time[inside], np.log(self.envelope[inside]))


def held_since(motion: Any) -> float:
    """The instant [s] of the last event of a motion that ends with a contact that sticks; NaN of any other."""
    sticks = isinstance(motion, Trajectory) and motion.mode.size and np.any(motion.mode[-1] == 0)
    return (float(motion.event_time[-1]) if len(motion.event_time) else float(motion.t[0])) if sticks else float("nan")


def sticking(motion: Any, dof: int | str, late: float) -> str:
    """The contacts that stick all through the last part and hold the degree of freedom, in words."""
    if not isinstance(motion, Trajectory) or not motion.mode.size:
        return ""
    system, column_ = motion.system, column(motion, dof)
    stuck = np.all(motion.mode[motion.t > late] == 0, axis=0)
    held = [name for name, contact, one in zip(system.contact_names, system.contacts, stuck, strict=True)
            if one and np.asarray(contact.t)[column_] != 0.0]  # fmt: skip
    return " and ".join(held)


def course_of(curve: Curve, part: float, gone: float, held: float, sticks: str) -> Course:
    """The course of a curve: `held` is the instant of its last event, `sticks` what holds it to the end."""
    length = curve.end - curve.begin
    late = curve.end - part * length
    half = 0.5 * (curve.begin + curve.end)
    turns = int(np.count_nonzero(curve.turns > late))
    still = float(np.ptp(curve.x)) <= 1e-12 * float(np.max(np.abs(curve.x), initial=0.0))  # rounding of a constant
    if still or np.count_nonzero(curve.turns > half) < 2:
        return _without_oscillation(curve, part, half, turns, sticks)
    overall = _frequency(curve, curve.begin, curve.end)
    time, heights, centre = envelope(curve, overall)
    frequency, repeat, misfit = overall, 1, 1.0
    if overall * length < FEW or np.max(heights[time > late]) > gone * np.max(heights):
        frequency, late, misfit = _pitch(curve, late, overall)
        lowest = min(frequency, overall)
        if np.isnan(misfit):
            repeat, misfit = repetition(curve, late, curve.end, frequency)
        elif np.isfinite(frequency):
            lowest = frequency
        time, heights, centre = envelope(curve, lowest if np.isfinite(lowest) else 1.0 / length, repeat)
    if np.isfinite(held) and float(np.ptp(curve.spline(np.linspace(late, curve.end, 257)))) <= STILL * float(
        np.ptp(curve.heights)
    ):
        return _stopped(curve, part, turns, held, time, heights, centre)
    strong = (time > half) & (heights > gone * np.max(heights))
    rate, error = slope(time[strong], np.log(heights[strong])) if np.count_nonzero(strong) > 2 else (np.nan, np.nan)
    swing = curve.swing(late, curve.end, 1.0 / frequency if np.isfinite(frequency) else length)[0]
    return _measured(curve, part, late, turns, time=time, envelope=heights, centre=centre, amplitude=float(swing),
                     frequency=frequency, rate=rate, rate_error=error, misfit=misfit)  # fmt: skip


def _measured(curve: Curve, part: float, late: float, turns: int, **seen: Any) -> Course:
    """The course of a curve with what was seen of it."""
    offset = float(curve.mean(late, curve.end))
    return Course(begin=curve.begin, end=curve.end, part=part, late=late, offset=offset, turns=turns, **seen)


def _stopped(curve: Curve, part: float, turns: int, rest: float, time: Any, heights: Any, centre: Any) -> Course:
    """A motion that friction has stopped: it has no frequency any more, and its envelope ends where it came to rest."""
    late = curve.end - part * (curve.end - curve.begin)
    return _measured(curve, part, late, turns, time=time, envelope=heights, centre=centre, amplitude=0.0, rest=rest)


def nothing(motion: Any) -> Course:
    """A run that failed before there was anything to measure."""
    begin, end = (float(motion.t[i]) for i in (0, -1)) if np.size(motion.t) else (np.nan, np.nan)
    none, unknown = np.empty(0), float("nan")
    return Course(begin, end, unknown, unknown, none, none, none, amplitude=unknown, offset=unknown, turns=0)


def _frequency(curve: Curve, left: float, right: float) -> float:
    times, x = curve.even(left, right)
    return highest_line(x, times)


def _pitch(curve: Curve, late: float, overall: float) -> tuple[float, float, float]:
    """Frequency [Hz] in the last part, where that begins [s], and by how much the motion misses itself after a period.

    A last part of few periods is read by the motion's returns, and begins early enough for two of them. The frequency
    is NaN where the record holds no two, the misfit NaN where it is still to be read.
    """
    found = _frequency(curve, late, curve.end)
    if found * (curve.end - late) >= FEW:
        return found, late, np.nan
    period, misfit = last_period(curve)
    if np.isfinite(period):
        return 1.0 / period, min(late, curve.end - 2.0 * period), misfit
    if overall * (curve.end - curve.begin) >= FEW:
        early = min(late, curve.end - 3.0 / overall)
        found = _frequency(curve, early, curve.end)
        if found * (curve.end - early) >= 2.0:
            return found, early, np.nan
    return np.nan, late, 1.0


def _without_oscillation(curve: Curve, part: float, half: float, turns: int, sticks: str) -> Course:
    """A motion that runs one way: its rate is that of its velocity, which knows no offset. What is carried has none."""
    times, x = curve.even(curve.begin, curve.end)
    late = curve.end - part * (curve.end - curve.begin)
    speed = np.abs(curve.spline.derivative()(times))
    moving = (times > half) & (speed > 0.0)
    runs = np.ptp(x) > 0.0 and not sticks and turns == 0
    rate, error = slope(times[moving], np.log(speed[moving])) if runs else (np.nan, np.nan)
    swing = float(curve.swing(late, curve.end, curve.end - curve.begin)[0])
    return _measured(curve, part, late, turns, time=times, envelope=speed, centre=x, amplitude=swing,
                     rate=rate, rate_error=error, sticks=sticks)  # fmt: skip
