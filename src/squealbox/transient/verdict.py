"""What became of a motion: it decays, grows, settles on a cycle, or the record does not decide.

The verdict rests on the course of the amplitude, half peak to peak in successive windows of two periods: a static
deflection does not count, nor does a mean that drifts. Lines fitted to its logarithm give growth rates with errors.
"""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from squealbox.arguments import public
from squealbox.matrices import liveliest
from squealbox.result import Array, Outcome, Result, quantity
from squealbox.signals import LEAST, highest_line, slope, with_error
from squealbox.transient.envelope import Curve, envelope, repetition, smooth_curve
from squealbox.transient.resolution import resolved
from squealbox.transient.trajectory import Trajectory

DECAYS, GROWS, SETTLES_ON_CYCLE, NOT_DECIDED = "decays", "grows", "settles_on_cycle", "not_decided"
MISFIT = 0.1  # a motion that misses itself by more after its period is no cycle; 2 % of change adds 0.02
STILL = 1e-9  # of the whole swing: what moves less in the last part is at rest
ONE_RATE = 0.8  # a decay at one rate keeps it from one part to the next; an approach to a cycle slows down


@dataclass(frozen=True, kw_only=True, eq=False)
class Verdict(Result):
    """What became of a motion, in one word and one sentence, with the numbers it rests on.

    `fate`, also called `kind`, is "decays", "grows", "settles_on_cycle" or "not_decided". `outcome` is the run's own: a
    run that failed is not decided, and the numbers tell what was reached. A number that does not apply is NaN.
    """

    amplitude: Any = quantity("", "m", "half peak to peak over the last part")
    frequency: Any = quantity("", "Hz", "dominant frequency in the last part")
    growth_rate: Any = quantity("", "1/s", "growth rate of the amplitude in the last half")
    growth_rate_error: Any = quantity("", "1/s", "95 % half-width of the growth rate")
    settled_at: Any = quantity("", "s", "when the amplitude came to stay near its last value, or near zero")
    offset: Any = quantity("", "m", "mean over the last part")
    envelope_time: Array = quantity("window", "s", "middle of each window")
    envelope: Array = quantity("window", "m", "half peak to peak in each window")
    envelope_centre: Array = quantity("window", "m", "mid-height in each window")
    fate: str
    text: str

    coordinates: ClassVar = {"window": "envelope_time"}

    @property
    def kind(self) -> str:
        """The one word: `fate`."""
        return self.fate

    def __str__(self) -> str:
        return self.text


@public(band=None)
def verdict(
    motion: Any,
    t: Any = None,
    *,
    dof: int | str | None = None,
    begin: float | None = None,
    end: float | None = None,
    part: float = 0.25,
    steady: float = 0.02,
    band: float = 0.05,
    gone: float = 1e-3,
    least_periods: float = 6.0,
) -> Verdict:
    """What became of one degree of freedom of a motion.

    Parameters
    ----------
    motion, t : a trajectory, or an array (k,) with its times [s]; steps need not be equal
    dof : index or name of the degree of freedom; None takes the one that moves most, and the sentence names it
    begin, end : the stretch that is judged [s]
    part : share of the stretch called its last part. A quarter leaves three to see where the motion came from
    steady : relative change of the amplitude over the last part that still counts as constant. 2 % is as good as the
        two digits a paper prints
    band : settled is an amplitude that stays within this share of its last value (of its largest, for a motion that
        decays). 5 % is the usual settling band
    gone : share of the largest amplitude below which nothing is left. An integrator at its usual tolerance of 1e-3
        leaves that much
    least_periods : fewer periods than this in the last part decide nothing

    Returns
    -------
    Verdict

    Limits
    ------
    A motion that kept its amplitude during the last part is called a cycle. A decay or growth slower than `steady` over
    that part is told from one only where it also ran at the same rate in the part before. Two frequencies that beat
    without losing strength are not decided.

    >>> t = np.linspace(0.0, 0.05, 5001)
    >>> verdict(np.exp(-100.0 * t) * np.sin(2 * np.pi * 2000.0 * t), t).kind
    'decays'
    """
    outcome = getattr(motion, "outcome", None) or Outcome()
    if isinstance(motion, Trajectory):
        closer = resolved(motion)
        if end is None or np.count_nonzero(closer.t <= end) >= LEAST:  # else only the last part was run again
            motion = closer
    dof, name, unit = _judged_dof(motion, dof)
    if not outcome.ok and np.size(motion.t) < LEAST:
        course = _nothing(motion)
    else:
        course = _course(smooth_curve(motion, t, dof=dof, begin=begin, end=end), part, gone, held=_held(motion))
    if outcome.ok:
        kind, why = _judged(course, part, steady, gone, least_periods)
    else:
        kind, why = NOT_DECIDED, f"the run ended early, {outcome}: {outcome.message}"
    settled = _settled_at(course, kind, band)
    return Verdict(
        amplitude=course.amplitude,
        frequency=course.frequency,
        growth_rate=course.rate,
        growth_rate_error=course.rate_error,
        settled_at=settled,
        offset=course.offset,
        envelope_time=course.time,
        envelope=course.envelope,
        envelope_centre=course.centre,
        fate=kind,
        text=_sentence(kind, why, course, settled, name, unit),
        outcome=outcome,
        settings={"dof": dof, "part": part, "steady": steady, "band": band, "gone": gone, "periods": least_periods},
    )


def _judged_dof(motion: Any, dof: int | str | None) -> tuple[int | str, str, str]:
    """The degree of freedom that is judged, its name where the motion has names, and its unit."""
    names = motion.system.names if isinstance(motion, Trajectory) else ()
    if dof is None:
        late = motion.q[len(motion.q) // 2 :] if isinstance(motion, Trajectory) else np.zeros((0, 1))
        dof = liveliest(np.ptp(late, axis=0), motion.system.units) if len(late) else 0
    known = isinstance(dof, (int, np.integer)) and -len(names) <= dof < len(names)
    name = dof if isinstance(dof, str) else names[dof] if known else ""
    return dof, name, motion.system.units[names.index(name)] if name in names else "m"


@dataclass(frozen=True)
class _Course:
    """What was measured: the envelope and what it says of the last part and the last half."""

    begin: float
    end: float
    late: float
    time: Any
    envelope: Any
    centre: Any
    amplitude: float
    frequency: float
    rate: float
    rate_error: float
    offset: float
    turns: int
    misfit: float
    rest: float = float("nan")

    def stretch(self, left: float, right: float) -> tuple[float, float]:
        """Rate and error of the logarithm of the envelope between shares `left` and `right` of the run."""
        share = (self.time - self.begin) / (self.end - self.begin)
        inside = (share >= left) & (share <= right) & (self.envelope > 0.0)
        return slope(self.time[inside], np.log(self.envelope[inside]))


def _held(motion: Any) -> float:
    """The instant [s] of the last event of a motion that ends with a contact that sticks; NaN of any other."""
    sticks = isinstance(motion, Trajectory) and motion.mode.size and np.any(motion.mode[-1] == 0)
    return (float(motion.event_time[-1]) if len(motion.event_time) else float(motion.t[0])) if sticks else float("nan")


def _course(curve: Curve, part: float, gone: float, *, held: float) -> _Course:
    late = curve.end - part * (curve.end - curve.begin)
    half = 0.5 * (curve.begin + curve.end)
    turns = int(np.count_nonzero(curve.turns > late))
    still = float(np.ptp(curve.x)) <= 1e-12 * float(np.max(np.abs(curve.x), initial=0.0))  # rounding of a constant
    if still or np.count_nonzero(curve.turns > half) < 2:
        return _without_oscillation(curve, late, half, turns)
    overall = _frequency(curve, curve.begin, curve.end)
    time, heights, centre = envelope(curve, overall)
    frequency, repeat, misfit = overall, 1, 1.0
    if np.max(heights[time > late]) > gone * np.max(heights):
        frequency = _frequency(curve, late, curve.end)
        repeat, misfit = repetition(curve, late, curve.end, frequency)
        time, heights, centre = envelope(curve, min(frequency, overall), repeat)
    if np.isfinite(held) and float(np.ptp(curve.spline(np.linspace(late, curve.end, 257)))) <= STILL * float(
        np.ptp(curve.heights)
    ):
        return _stopped(curve, late, turns, held, time, heights, centre)
    strong = (time > half) & (heights > gone * np.max(heights))
    rate, error = slope(time[strong], np.log(heights[strong])) if np.count_nonzero(strong) > 2 else (np.nan, np.nan)
    return _Course(
        begin=curve.begin,
        end=curve.end,
        late=late,
        time=time,
        envelope=heights,
        centre=centre,
        amplitude=float(curve.swing(late, curve.end, 1.0 / frequency)[0]),
        frequency=frequency,
        rate=rate,
        rate_error=error,
        offset=float(curve.mean(late, curve.end)),
        turns=turns,
        misfit=misfit,
    )


def _stopped(curve: Curve, late: float, turns: int, rest: float, time: Any, heights: Any, centre: Any) -> _Course:
    """A motion that friction has stopped: it has no frequency any more, and its envelope ends where it came to rest."""
    none = float("nan")
    return _Course(curve.begin, curve.end, late, time, heights, centre, 0.0, none, none, none,
                   float(curve.mean(late, curve.end)), turns, none, rest)  # fmt: skip


def _nothing(motion: Any) -> _Course:
    """A run that failed before there was anything to measure."""
    begin, end = (float(motion.t[i]) for i in (0, -1)) if np.size(motion.t) else (np.nan, np.nan)
    none = np.empty(0)
    return _Course(begin, end, np.nan, none, none, none, np.nan, np.nan, np.nan, np.nan, np.nan, 0, np.nan)


def _frequency(curve: Curve, left: float, right: float) -> float:
    times, x = curve.even(left, right)
    return highest_line(x, times)


def _without_oscillation(curve: Curve, late: float, half: float, turns: int) -> _Course:
    """A motion that runs one way: its rate is that of its velocity, which knows no offset."""
    times, x = curve.even(curve.begin, curve.end)
    speed = np.abs(curve.spline.derivative()(times))
    moving = (times > half) & (speed > 0.0)
    rate, error = slope(times[moving], np.log(speed[moving])) if np.ptp(x) > 0.0 else (np.nan, np.nan)
    return _Course(
        begin=curve.begin,
        end=curve.end,
        late=late,
        time=times,
        envelope=speed,
        centre=x,
        amplitude=0.5 * float(np.ptp(x[times > late])),
        frequency=np.nan,
        rate=rate,
        rate_error=error,
        offset=float(curve.mean(late, curve.end)),
        turns=turns,
        misfit=np.nan,
    )


def _judged(course: _Course, part: float, steady: float, gone: float, least_periods: float) -> tuple[str, str]:
    top = float(np.max(course.envelope))
    last = course.envelope[course.time > course.late]
    if top == 0.0:
        return DECAYS, "it stays at rest"
    if np.isfinite(course.rest):
        return DECAYS, f"it comes to rest at {_read(course.rest, 's')}" if course.rest > 0.0 else "it stays at rest"
    if np.max(last) <= gone * top:
        return DECAYS, "nothing is left of it"
    if np.isnan(course.frequency):
        return _one_way(course)
    periods = course.frequency * (course.end - course.late)
    if periods < least_periods:
        return NOT_DECIDED, f"the last part holds only {periods:.2g} periods"
    now, error = course.stretch(1.0 - part, 1.0)
    change = now * (course.end - course.late)
    if abs(change) <= steady and np.ptp(last) <= 2.0 * steady * np.mean(last):
        before, before_error = course.stretch(1.0 - 2.0 * part, 1.0 - part)
        one_rate = abs(now) > error and abs(before) > before_error and ONE_RATE < before / now < 1.0 / ONE_RATE
        if one_rate and abs(change) > gone:
            return (DECAYS if now < 0.0 else GROWS), "slowly, at one rate"
        if course.misfit > MISFIT:
            return NOT_DECIDED, "its amplitude is steady, but the motion does not repeat"
        return SETTLES_ON_CYCLE, ""
    if _slows(course, part, ONE_RATE) and _slows(course, 0.5 * part, np.sqrt(ONE_RATE)):
        return NOT_DECIDED, f"its amplitude is still settling, by {100.0 * change:+.2g} % over the last part"
    return _trend(course)


def _slows(course: _Course, part: float, share: float) -> bool:
    """True when the rate in the last part is surely less than `share` of the rate in the part before, same sign."""
    now, now_error = course.stretch(1.0 - part, 1.0)
    before, before_error = course.stretch(1.0 - 2.0 * part, 1.0 - part)
    return now * before > 0.0 and abs(now) + now_error < share * (abs(before) - before_error)


def _trend(course: _Course) -> tuple[str, str]:
    """Growth or decay over the last half; where it beats, from the largest amplitude on, or up to it."""
    rate, error = course.stretch(0.5, 1.0)
    if rate + error < 0.0:
        return DECAYS, ""
    if rate - error > 0.0:
        return GROWS, ""
    peak = int(np.argmax(course.envelope))
    share = (course.time[peak] - course.begin) / (course.end - course.begin)
    after, after_error = course.stretch(share, 1.0)
    if share < 0.5 and after + after_error < 0.0:
        return DECAYS, "while beating"
    until, until_error = course.stretch(0.0, share)
    if share > 0.5 and until - until_error > 0.0:
        return GROWS, "while beating"
    return NOT_DECIDED, "its amplitude rises and falls, and no trend stands out"


def _one_way(course: _Course) -> tuple[str, str]:
    if course.turns == 0 and course.rate - course.rate_error > 0.0:
        return GROWS, "without oscillation"
    if course.turns == 0 and course.rate + course.rate_error < 0.0:
        return DECAYS, "without oscillation"
    return NOT_DECIDED, "it neither oscillates nor runs one way"


def _settled_at(course: _Course, kind: str, band: float) -> float:
    if np.isfinite(course.rest):
        return course.rest
    if kind == SETTLES_ON_CYCLE:
        outside = np.abs(course.envelope - course.amplitude) > band * course.amplitude
    elif kind == DECAYS:
        outside = course.envelope > band * np.max(course.envelope)
    else:
        return np.nan
    if not np.any(outside):
        return course.begin
    after = int(np.nonzero(outside)[0][-1]) + 1
    return float(course.time[after]) if after < course.time.size else np.nan


def _sentence(kind: str, why: str, course: _Course, settled: float, name: str, unit: str) -> str:
    words = {DECAYS: "Decays", GROWS: "Grows", SETTLES_ON_CYCLE: "Settles on a cycle", NOT_DECIDED: "Not decided"}
    text = words[kind] + (f" ({why})" if why else "")
    if np.isfinite(course.rate) and kind != SETTLES_ON_CYCLE:
        text += f", growth rate {with_error(course.rate, course.rate_error)} 1/s"
    if np.isnan(course.amplitude) or np.isfinite(course.rest):
        return text + "."
    last = _read(course.end - course.late, "s")
    text += f"; half peak to peak{f' of {name}' if name else ''} {_read(course.amplitude, unit)} over the last {last}"
    if np.isfinite(course.frequency):
        text += f" at {course.frequency:.5g} Hz"
    if np.isfinite(settled):
        text += f"; settled at {_read(settled, 's')}" if settled > course.begin else "; settled from the start"
    return text + "."


def _read(value: float, unit: str) -> str:
    """A value with the prefix that leaves one to three digits before the point."""
    for factor, prefix in ((1.0, ""), (1e-3, "m"), (1e-6, "u")):
        if abs(value) >= 0.9995 * factor:
            return f"{value / factor:.3g} {prefix}{unit}"
    return f"{value / 1e-9:.3g} n{unit}"
