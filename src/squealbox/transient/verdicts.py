"""What became of a motion: it decays, grows, settles on a cycle, or the record does not decide.

The verdict rests on the course of the amplitude, half peak to peak in successive windows of two periods: a static
deflection does not count, nor does a mean that drifts. Lines fitted to its logarithm give growth rates with errors.
"""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from squealbox import words
from squealbox.arguments import public
from squealbox.matrices import liveliest
from squealbox.result import Array, Outcome, Result, quantity
from squealbox.signals import LEAST, with_error
from squealbox.transient.course import Course, course_of, held_since, nothing, sticking
from squealbox.transient.envelope import RETURNS, smooth_curve
from squealbox.transient.resolution import resolved
from squealbox.transient.trajectory import Trajectory

DECAYS, GROWS, SETTLES_ON_CYCLE, NOT_DECIDED = "decays", "grows", "settles_on_cycle", "not_decided"
FLAT = 0.1  # of the amplitude: what changes by less in the last part settles
ONE_RATE = 0.8  # a decay at one rate keeps it from one part to the next; an approach to a cycle slows down


@dataclass(frozen=True, kw_only=True, eq=False)
class Verdict(Result):
    """What became of a motion, in one word and one sentence, with the numbers it rests on.

    `fate`, also called `kind`, is "decays", "grows", "settles_on_cycle" or "not_decided". `outcome` is the run's own: a
    run that failed is not decided, and the numbers tell what was reached. A number that does not apply is NaN.
    """

    amplitude: Any = quantity("", "m", "half peak to peak over the last part, which holds two periods")
    frequency: Any = quantity("", "Hz", "dominant frequency in the last part")
    growth_rate: Any = quantity(
        "", "1/s", "growth rate of the amplitude in the last half; of a beat, up to or from its top"
    )
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
    part : share of the stretch called its last part [-]. A quarter leaves three to see where the motion came from
    steady : relative change of the amplitude over the last part that still counts as constant [-]. 2 % is as good as
        the two digits a paper prints
    band : settled is an amplitude that stays within this share of its last value (of its largest, for a motion that
        decays) [-]. 5 % is the usual settling band
    gone : share of the largest amplitude below which nothing is left [-]. An integrator at its usual tolerance of 1e-3
        leaves that much
    least_periods : fewer periods [-] than this in the last part decide nothing; amplitude and frequency are then those
        of the last two periods, or without a frequency where the record holds none

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
        course = nothing(motion)
    else:
        curve = smooth_curve(motion, t, dof=dof, begin=begin, end=end)
        late = curve.end - part * (curve.end - curve.begin)
        course = course_of(curve, part, gone, held_since(motion), sticking(motion, dof, late))
    if outcome.ok:
        kind, why, course = _judged(course, steady, gone, least_periods)
    else:
        kind, why = NOT_DECIDED, f"the run ended early, {outcome.told}"
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


def _judged(course: Course, steady: float, gone: float, least_periods: float) -> tuple[str, str, Course]:
    """The fate, why, and the course with the rate that it rests on."""
    top = float(np.max(course.envelope))
    last = course.envelope[course.time > course.end - course.last]
    if top == 0.0:
        return DECAYS, "it stays at rest", course
    if np.isfinite(course.rest):
        why = f"it comes to rest at {words.quantity(course.rest, 's', 3)}" if course.rest > 0.0 else "it stays at rest"
        return DECAYS, why, course
    if np.max(last) <= gone * top:
        return DECAYS, "nothing is left of it", course
    if np.isnan(course.frequency):
        return _one_way(course)
    periods = course.frequency * course.last
    if periods < least_periods:
        told = f"{periods:.2g}"
        return (
            NOT_DECIDED,
            f"the last {words.quantity(course.last, 's', 3)} hold only {told} period{'s' * (told != '1')}",
            course,
        )
    now = course.stretch(1.0 - course.part, 1.0)
    change = now[0] * course.last
    if abs(change) <= steady and np.ptp(last) <= 2.0 * steady * np.mean(last):
        before = course.stretch(1.0 - 2.0 * course.part, 1.0 - course.part)
        one_rate = _clear(*now) and _clear(*before) and ONE_RATE < before[0] / now[0] < 1.0 / ONE_RATE
        if one_rate and abs(change) > gone:
            return (DECAYS if now[0] < 0.0 else GROWS), "slowly, at one rate", course.at_rate(*now)
        if course.misfit > RETURNS:
            return NOT_DECIDED, "its amplitude is steady, but the motion does not repeat", course
        return SETTLES_ON_CYCLE, "", course
    settling = f"its amplitude is still settling, by {100.0 * change:+.2g} % over the last part"
    if _slows(course, course.part, ONE_RATE) and _slows(course, 0.5 * course.part, np.sqrt(ONE_RATE)):
        return NOT_DECIDED, settling, course
    kind, rate = _trend(course, steady)
    if kind == NOT_DECIDED:
        flat = np.ptp(last) <= FLAT * np.mean(last)
        why = settling if flat else "its amplitude rises and falls, and no trend stands out"
        return kind, why, course
    return (kind, "", course) if rate is None else (kind, "while beating", course.at_rate(*rate))


def _clear(rate: float, error: float) -> bool:
    """True of a rate whose interval, as it is printed, does not hold zero."""
    if not abs(rate) > error:
        return False
    told, about = with_error(abs(rate), error).split(" +- ")
    return float(told) > float(about)


def _slows(course: Course, part: float, share: float) -> bool:
    """True when the rate in the last part is surely less than `share` of the rate in the part before, same sign."""
    now, now_error = course.stretch(1.0 - part, 1.0)
    before, before_error = course.stretch(1.0 - 2.0 * part, 1.0 - part)
    return now * before > 0.0 and abs(now) + now_error < share * (abs(before) - before_error)


def _trend(course: Course, steady: float) -> tuple[str, tuple[float, float] | None]:
    """Growth or decay over the last half; where it beats, from the largest amplitude on, or up to it, with its rate."""
    if _clear(course.rate, course.rate_error):
        return (DECAYS if course.rate < 0.0 else GROWS), None
    peak = int(np.argmax(course.envelope))
    share = (course.time[peak] - course.begin) / (course.end - course.begin)
    after = course.stretch(share, 1.0)
    if share < 0.5 and after[0] < 0.0 and _clear(*after):
        return DECAYS, after
    until, three_quarters = course.stretch(0.0, share), course.end - 0.25 * (course.end - course.begin)
    rises = course.envelope[peak] > (1.0 + steady) * np.max(course.envelope[course.time < three_quarters])
    if rises and until[0] > 0.0 and _clear(*until):
        return GROWS, until
    return NOT_DECIDED, None


def _one_way(course: Course) -> tuple[str, str, Course]:
    if course.turns:
        return NOT_DECIDED, "it does not run one way, and the record is too short to tell a period", course
    if course.sticks:
        return NOT_DECIDED, f"{course.sticks} sticks through the last part", course
    before, now = (course.stretch(1.0 - k * course.part, 1.0 - (k - 1) * course.part)[0] for k in (2, 1))
    if 0.0 < now < ONE_RATE * before:
        return NOT_DECIDED, "it runs one way, but not at one rate", course.at_rate(np.nan, np.nan)
    if _clear(course.rate, course.rate_error):
        return (GROWS if course.rate > 0.0 else DECAYS), "without oscillation", course
    return NOT_DECIDED, "it neither oscillates nor clearly runs away or towards rest", course


def _settled_at(course: Course, kind: str, band: float) -> float:
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


def _sentence(kind: str, why: str, course: Course, settled: float, name: str, unit: str) -> str:
    called = {DECAYS: "Decays", GROWS: "Grows", SETTLES_ON_CYCLE: "Settles on a cycle", NOT_DECIDED: "Not decided"}
    text = called[kind] + (f" ({why})" if why else "")
    told = _clear(course.rate, course.rate_error) if kind == NOT_DECIDED else kind != SETTLES_ON_CYCLE
    if np.isfinite(course.rate) and told:
        text += f", growth rate {with_error(course.rate, course.rate_error)} 1/s"
    if np.isnan(course.amplitude) or np.isfinite(course.rest):
        return text + "."
    size, last = words.quantity(course.amplitude, unit, 3), words.quantity(course.end - course.late, "s", 3)
    text += f"; half peak to peak{f' of {name}' if name else ''} {size} over the last {last}"
    if np.isfinite(course.frequency):
        text += f" at {course.frequency:.5g} Hz"
    if np.isfinite(settled):
        text += (
            f"; settled at {words.quantity(settled, 's', 3)}" if settled > course.begin else "; settled from the start"
        )
    return text + "."
