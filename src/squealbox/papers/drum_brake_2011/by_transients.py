"""What the time series say to each claim of the paper, by the verdict on x and by the lines of its spectrum."""

from collections.abc import Callable, Iterable
from typing import Any

import numpy as np

from squealbox.papers.drum_brake_2011.cases import RESOLUTION
from squealbox.papers.drum_brake_2011.claims import Finding
from squealbox.papers.drum_brake_2011.motions import BRAKE, NO_SLOPE, Motion, Run, Studies, doubt
from squealbox.signals import peaks, spectrum

STRETCH = (0.02, 0.037)  # s, where the paper sees the amplitude constant
CONSTANT = 0.10  # an amplitude that stays within this share of its middle value is constant
SHORTEST = 0.005  # s, ten periods: a shorter stretch is no stretch
SLOWEST = 3.0 * RESOLUTION  # rad/s: what is slower is the mean settling, not a vibration
GONE = 1e-3  # of the largest amplitude: below it the motion is gone
LINEAR = Finding(None, "the printed matrices are linear: what sgn() limits needs contacts")

Findings = dict[str, Finding]
Rule = Callable[..., Finding]


def findings(studies: Studies, exact: Studies | None = None, only: Iterable[str] | None = None) -> Findings:
    """What these runs say, by ``claim.part``; given the exact runs too, doubtful raw ones are named."""
    return {key: _judged(*RULES[key], studies, exact) for key in (RULES if only is None else only)}


def without_contacts() -> Findings:
    """The findings where there are no contacts to integrate."""
    return dict.fromkeys(RULES, LINEAR)


def constant_stretch(time: np.ndarray, envelope: np.ndarray) -> tuple[float, float]:
    """Begin and end [s] of the longest stretch in which an amplitude is constant within 10 % and not gone."""
    alive = envelope > GONE * np.max(envelope, initial=0.0)
    best = (0.0, 0.0)
    for first in range(len(time)):
        low = high = envelope[first]
        last = first
        while last < len(time) and alive[last]:
            low, high = min(low, envelope[last]), max(high, envelope[last])
            if high - low > CONSTANT * (high + low):
                break
            last += 1
        if last > first and time[last - 1] - time[first] > best[1] - best[0]:
            best = (float(time[first]), float(time[last - 1]))
    return best


def lines(motion: Motion) -> Any:
    """The two strongest lines of x that are no harmonics of each other [rad/s], the lower first."""
    found = 2.0 * np.pi * peaks(spectrum(motion.trajectory, dof="x", end=motion.end), 6).frequency
    found = found[found > SLOWEST]
    if not found.size:
        return found
    order = np.round(found / found[0])
    harmonic = (order > 1) & (np.abs(found - order * found[0]) < RESOLUTION)
    return np.sort(found[~harmonic][:2])


def _judged(rule: Rule, runs: tuple[Run, ...], studies: Studies, exact: Studies | None) -> Finding:
    motions = {str(run): studies[run] for run in runs}
    doubts = {} if exact is None else {str(run): doubt(studies[run], exact[run]) for run in runs}
    notes = [f"{name}: {why}" for name, why in doubts.items() if why]
    unjudged = [f"{name}: {motion.ended}" for name, motion in motions.items() if motion.verdict is None]
    cut_short = [f"{name}: {motion.ended}" for name, motion in motions.items() if not motion.completed]
    finding = Finding(None) if unjudged else rule(motions)
    if cut_short and finding.value is not False:
        finding = Finding(None, "; ".join(cut_short))
    note = "; ".join(text for text in (finding.note, *notes) if text)
    return Finding(finding.value, note, trusted=not notes)


def _all_decay(motions: dict[str, Motion]) -> Finding:
    return _all(False, motions, "persists")


def _all_persist(motions: dict[str, Motion]) -> Finding:
    return _all(True, motions, "decays")


def _all(wanted: bool, motions: dict[str, Motion], otherwise: str) -> Finding:
    against = [name for name, motion in motions.items() if motion.persists is (not wanted)]
    if against:
        return Finding(False, f"{otherwise} at {', '.join(against)}")
    undecided = [name for name, motion in motions.items() if motion.persists is None]
    return Finding(None, f"no verdict at {', '.join(undecided)}") if undecided else Finding(True)


def _of_one(rule: Callable[[Motion], Finding]) -> Rule:
    """A rule about one run."""

    def of_one(motions: dict[str, Motion]) -> Finding:
        (motion,) = motions.values()
        return rule(motion)

    return of_one


def _strongest_line(motion: Motion) -> Finding:
    strongest = peaks(spectrum(motion.trajectory, dof="x", end=motion.end), 1).frequency
    return Finding(float(2.0 * np.pi * strongest[0])) if strongest.size else Finding(None, "no line stands out")


def _lower_line(motion: Motion) -> Finding:
    return _of_two(lines(motion), lambda pair: pair[0])


def _upper_line(motion: Motion) -> Finding:
    return _of_two(lines(motion), lambda pair: pair[1])


def _separation(motion: Motion) -> Finding:
    return _of_two(lines(motion), lambda pair: pair[1] - pair[0])


def _of_two(found: Any, value: Callable[[Any], float]) -> Finding:
    if found.size == 2:
        return Finding(float(value(found)))
    return Finding(None, f"only one line stands out, at {found[0]:.0f} rad/s" if found.size else "no line stands out")


def _amplitude(motion: Motion) -> Finding:
    return Finding(1e3 * motion.amplitude, motion.words)


def _settled(motion: Motion) -> Finding:
    if motion.verdict and motion.verdict.kind == "settles_on_cycle":
        return Finding(1e3 * float(motion.verdict.settled_at))
    return Finding(np.inf if motion.persists is False else None, f"{motion.words}: there is no cycle to settle on")


def _stretch_begin(motion: Motion) -> Finding:
    return _stretch(motion, 0)


def _stretch_end(motion: Motion) -> Finding:
    return _stretch(motion, 1)


def _stretch(motion: Motion, which: int) -> Finding:
    assert motion.verdict is not None
    ends = constant_stretch(motion.verdict.envelope_time, motion.verdict.envelope)
    if ends[1] - ends[0] < SHORTEST:
        return Finding(np.inf, f"no stretch of {1e3 * SHORTEST:g} ms has a constant amplitude")
    return Finding(ends[which])


def _amplitude_in_stretch(motion: Motion) -> Finding:
    assert motion.verdict is not None
    time, envelope = motion.verdict.envelope_time, motion.verdict.envelope
    inside = envelope[(time >= STRETCH[0]) & (time <= STRETCH[1])]
    if not inside.size:
        return Finding(None, "the run has no amplitude from 0.02 to 0.037 s")
    least, greatest = 1e3 * np.min(inside), 1e3 * np.max(inside)
    return Finding(1e3 * float(np.median(inside)), f"median; from {least:.3g} to {greatest:.3g} mm")


def _change(motions: dict[str, Motion]) -> Finding:
    with_slope, without = motions.values()
    if not (with_slope.persists and without.persists):
        return Finding(None, "with or without the slope nothing persists at mu = 0.50")
    return Finding(1e3 * (with_slope.amplitude - without.amplitude))


def _mu(*values: float) -> tuple[Run, ...]:
    return tuple(Run("friction", value) for value in values)


def _kn(*values: float) -> tuple[Run, ...]:
    return tuple(Run("load", 1e3 * value) for value in values)


RULES: dict[str, tuple[Rule, tuple[Run, ...]]] = {
    "mu-1.decays": (_all_decay, _mu(0.10, 0.20, 0.30, 0.39)),
    "mu-2.persists": (_all_persist, _mu(0.40, 0.50)),
    "mu-3.lower": (_of_one(_lower_line), _mu(0.10)),
    "mu-3.upper": (_of_one(_upper_line), _mu(0.10)),
    "mu-4.separation": (_of_one(_separation), _mu(0.39)),
    "mu-5.frequency": (_of_one(_strongest_line), _mu(0.40)),
    "mu-6.frequency": (_of_one(_strongest_line), _mu(0.50)),
    "mu-7.at_0.40": (_of_one(_amplitude), _mu(0.40)),
    "mu-7.at_0.50": (_of_one(_amplitude), _mu(0.50)),
    "N-1.stable_below": (_all_decay, _kn(5, 10)),
    "N-1.persists": (_all_persist, _kn(15, 20, 25)),
    "N-2.lower": (_of_one(_lower_line), _kn(15)),
    "N-2.upper": (_of_one(_upper_line), _kn(15)),
    "N-3.at_15_kN": (_of_one(_amplitude), _kn(15)),
    "N-3.at_25_kN": (_of_one(_amplitude), _kn(25)),
    "N-3.settled": (_of_one(_settled), _kn(15)),
    "V-1.begin": (_of_one(_stretch_begin), (BRAKE,)),
    "V-1.end": (_of_one(_stretch_end), (BRAKE,)),
    "V-2.amplitude": (_of_one(_amplitude_in_stretch), (BRAKE,)),
    "V-2.frequency": (_of_one(_strongest_line), (BRAKE,)),
    "q-1.amplitude": (_change, (*_mu(0.50), NO_SLOPE)),
}
