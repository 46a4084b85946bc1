"""Squeal events in a recording: when, at what frequency, how loud, how quickly they grew and died away.

Each frame of a short-time transform is compared, line by line, with the noise in that line. Under noise alone the power
of a line is distributed as exp(-x/mean), so a threshold of -ln p times the mean is passed with the probability p. Peaks
above it that follow each other for `FRAMES` frames are an event; several may sound at once. Rates of growth and decay
are of the samples themselves (`growth_rate`), because a frame is longer than many a burst.

Band and threshold follow SAE J2521 as its public summary states them: a peak of 70 dB(A) or more between 2 and 16 kHz
(from 1.25 kHz on for full corners).
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import public
from squealbox.result import Array, Outcome, Result, quantity
from squealbox.signals.event_ends import edges, rate_at, steady_frequency
from squealbox.signals.radiation import HEARING, a_weighting
from squealbox.signals.recordings import Recording, as_recording
from squealbox.signals.sampling import SignalError
from squealbox.signals.tracks import Frames, Track, lines_of, seen, stands_out, tracks

BAND = (2000.0, 16000.0)  # [Hz]
LEAST_LEVEL = 70.0  # dB(A)
FRAME = 0.043  # s
CHANCE = 1e-3  # that noise passes the threshold in a line of a frame
SURE = 1e-5  # and the threshold of the mean over the frames of an event
BENEATH = 0.5  # of the lower end of the band: as far down a louder tone is looked for
BELOW = "stands below the band"
HARMONIC = 0.01  # by which an event may miss a multiple of it
STEADY = 0.02  # lines an event may wander and still have one frequency
MOST_TOLD = 10.0  # events a second whose samples are looked at, so that no recording takes for ever


@dataclass(frozen=True, kw_only=True, eq=False)
class SquealEvents(Result):
    """Squeal events, in the order of their onsets; rates are NaN where the record cannot tell them.

    Levels are dB(A) re 20 uPa of a sound pressure, unweighted dB re full scale or re 1 of its unit of another channel;
    `settings["unit"]` says which. The outcome is "completed" or "no_event".
    """

    onset: Array = quantity("event", "s", "when it begins")
    end: Array = quantity("event", "s", "when it ends")
    frequency: Array = quantity("event", "Hz", "mean frequency, weighed by power")
    frequency_error: Array = quantity("event", "Hz", "95 % error of the frequency where it is steady, else its spread")
    level: Array = quantity("event", "dB", "level over the event")
    peak_level: Array = quantity("event", "dB", "level of its loudest frame")
    growth_rate: Array = quantity("event", "1/s", "growth at its onset")
    growth_error: Array = quantity("event", "1/s", "95 % error")
    onset_frequency: Array = quantity(
        "event", "Hz", "frequency while it grows: that of small motion, where friction is one"
    )
    onset_frequency_error: Array = quantity("event", "Hz", "95 % error")
    decay_rate: Array = quantity("event", "1/s", "rate at its end, below 0 for a decay")
    decay_error: Array = quantity("event", "1/s", "95 % error")
    track_time: Array = quantity("event frame", "s", "middles of its frames; NaN behind the last")
    track_frequency: Array = quantity("event frame", "Hz", "frequency in each frame")
    track_level: Array = quantity("event frame", "dB", "level in each frame")
    braking: Array = quantity("event braking", "", "quantities of the braking at the onset")

    headings: ClassVar = {"track_time": "", "track_frequency": "", "track_level": ""}
    duration: float = 0.0

    @property
    def count(self) -> int:
        """Number of events."""
        return int(np.size(self.onset))

    @property
    def occurrence(self) -> float:
        """Share of the recording during which something squealed."""
        edges = sorted(zip(np.atleast_1d(self.onset), np.atleast_1d(self.end), strict=True))
        covered, reached = 0.0, -np.inf
        for begin, end in edges:
            covered += max(0.0, end - max(begin, reached))
            reached = max(reached, end)
        return covered / self.duration if self.duration > 0.0 else 0.0

    def summary(self) -> str:
        """A table, one line for each event."""
        unit = self.settings["unit"]
        lines = [
            f"{'onset':>9}  {'end':>9}  {'frequency':>12}  {'level':>8}  {'peak':>8}  growth, decay [1/s]   ({unit})"
        ]
        for i in range(self.count):
            rates = ", ".join(
                "-" if not np.isfinite(rate) else f"{rate:.3g} +- {error:.1g}"
                for rate, error in (
                    (self.growth_rate[i], self.growth_error[i]),
                    (self.decay_rate[i], self.decay_error[i]),
                )
            )
            lines.append(
                f"{self.onset[i]:7.3f} s  {self.end[i]:7.3f} s  {self.frequency[i]:9.1f} Hz  {self.level[i]:8.1f}  "
                f"{self.peak_level[i]:8.1f}  {rates}"
            )
        counted = "1 event" if self.count == 1 else f"{self.count} events"
        head = f"{counted} in {self.duration:.3g} s, {100.0 * self.occurrence:.1f} % of the time"
        notes = [f"note: {note}" for note in self.settings.get("notes", ())]
        return "\n".join(
            [
                head if self.count else self.outcome.told,
                *lines[: self.count + 1 if self.count else 0],
                *notes,
            ]
        )


@public()
def squeal_events(
    recording: Recording | ArrayLike,
    rate: float | None = None,
    *,
    channel: int | str = 0,
    band: tuple[float, float] = BAND,
    least_level: float | None = LEAST_LEVEL,
    frame: float = FRAME,
    chance: float = CHANCE,
) -> SquealEvents:
    """The squeal events of a recording.

    Parameters
    ----------
    recording : a `Recording`, or samples (k,) with `rate` [Hz], taken to be Pa
    channel : index or name
    band : lowest and highest frequency [Hz]
    least_level : peak level an event must reach [dB(A)]; not asked of a recording without calibration, nor for None
    frame : length of a frame [s]; the next begins a quarter later
    chance : [-] probability that noise passes the threshold in one line of one frame; `FRAMES` of them on end make an
        event

    Accuracy: tones of 15 dB above the noise in their line are found, to two hops of their onset; tones 100 Hz apart are
    told apart. Raises `SignalError` for a band outside what the sampling rate can carry, or too few frames.

    >>> t = np.arange(48000) / 48000.0
    >>> tone = np.where((t > 0.3) & (t < 0.7), np.sin(2 * np.pi * 3000.0 * t), 0.0)
    >>> found = squeal_events(tone + 1e-3 * np.random.default_rng(0).standard_normal(t.size), 48000.0)
    >>> found.count, round(float(found.frequency[0]))
    (1, 3000)
    """
    sound = as_recording(recording, rate, "Pa")
    x, rate = sound.channel(channel), sound.rate
    low, high = (float(each) for each in band)
    if not 0.0 < low < high or low >= 0.5 * rate:
        raise SignalError(f"band = {band} Hz at {rate:g} Hz: expected 0 < low < high and low below {0.5 * rate:g} Hz")
    length = 1 << max(round(np.log2(frame * rate)), 5)
    hop = length // 4
    if x.size < length + 3 * hop:
        raise SignalError(f"{x.size} samples at {rate:g} Hz: expected {length + 3 * hop} or more for four frames")
    calibrated = sound.calibrated(channel)
    high = min(high, 0.49 * rate)
    frames = Frames(x, rate, length, (low, high))
    weigh = a_weighting if calibrated else np.ones_like
    reference = HEARING if calibrated else 1.0
    events = []
    for track in tracks(frames, chance):
        if stands_out(track, frames, SURE * chance / CHANCE):
            event = _event(track, frames, weigh, reference)
            loud = least_level is None or not calibrated or event["peak_level"] >= least_level
            if loud and low <= event["frequency"] <= high:
                events.append(event)
    events.sort(key=lambda event: -event["level"])
    most = max(MOST_TOLD * sound.duration, MOST_TOLD)
    told = events[: int(most)]
    for event in told:
        _of_samples(event, x, rate, length)
    untold = f"only of the {len(told)} loudest of {len(events)} events are frequency and rates read from the samples"
    notes = [*sound.notes, *([untold] if len(told) < len(events) else [])]
    beneath = Frames(x, rate, length, (BENEATH * low, low))
    notes += _beneath(beneath, low, chance, events, weigh, reference, least_level if calibrated else None)
    events.sort(key=lambda event: event["onset"])
    names = list(sound.braking)
    settings = {"band": [low, high], "least_level": least_level, "frame": length / rate, "chance": chance}
    settings |= {"unit": _level_unit(sound.units[sound.index(channel)]), "notes": notes}
    settings |= {"braking": names, "source": sound.source, "channel": sound.names[sound.index(channel)]}
    settings["stop"] = {name: sound.mean_of(name) for name in names}
    level = f" of {least_level:g} dB(A) or more" if calibrated and least_level is not None else ""
    outcome = Outcome() if events else Outcome("no_event", f"no squeal{level} between {low:g} and {high:g} Hz")
    longest = max((len(event["track_time"]) for event in events), default=1)
    arrays: dict[str, Any] = {
        name: np.array([_padded(event[name], longest) for event in events]).reshape(
            (len(events), longest) if name.startswith("track") else (len(events),)
        )
        for name in _NAMES
    }
    return SquealEvents(
        **arrays,
        braking=np.array([[sound.at(name, event["onset"]) for name in names] for event in events]).reshape(
            len(events), len(names)
        ),
        duration=sound.duration,
        settings=settings,
        outcome=outcome,
    )


_NAMES = (
    "onset", "end", "frequency", "frequency_error", "level", "peak_level", "growth_rate", "growth_error",
    "onset_frequency", "onset_frequency_error", "decay_rate", "decay_error",
    "track_time", "track_frequency", "track_level",
)  # fmt: skip


_OF_SAMPLES = _NAMES[6:12]


def _beneath(
    frames: Frames, low: float, chance: float, events: Sequence[dict[str, Any]], weigh: Callable[[Any], Any],
    reference: float, least: float | None,
) -> list[str]:  # fmt: skip
    """A tone below the band that is louder than all in it: what is told may be no more than its harmonic."""
    found = [_event(each, frames, weigh, reference) for each in tracks(frames, chance)
             if stands_out(each, frames, SURE * chance / CHANCE)]  # fmt: skip
    loudest = max((event["level"] for event in events), default=-np.inf)
    found = [each for each in found if BENEATH * low <= each["frequency"] < low and each["level"] > loudest]
    found = [each for each in found if least is None or each["peak_level"] >= least]
    if not found:
        return []
    tone = max(found, key=lambda each: each["level"])
    times = [event["frequency"] / tone["frequency"] for event in events]
    whole = sorted({round(each) for each in times if abs(each - round(each)) < HARMONIC * each})
    of = f", of which the event at {whole[0] * tone['frequency']:.0f} Hz is harmonic {whole[0]}" if whole else ""
    louder = "a louder tone" if events else "a tone"
    return [f"{louder} {BELOW}, at {tone['frequency']:.0f} Hz{of}: a band from {BENEATH * low:g} Hz holds it"]


def _level_unit(unit: str) -> str:
    return "dB(A)" if unit == "Pa" else "dB re full scale" if unit == "FS" else f"dB re 1 {unit}"


def _padded(value: Any, longest: int) -> Any:
    return value if np.ndim(value) == 0 else np.append(value, np.full(longest - len(value), np.nan))


def _event(track: Track, frames: Frames, weigh: Callable[[Any], Any], reference: float) -> dict[str, Any]:
    """What the frames tell of an event; see `_of_samples`."""
    numbers, places = np.array(track.frames), lines_of(track)
    step = frames.frequency[1] - frames.frequency[0]
    frequency = frames.frequency[0] + step * np.array(track.lines)
    total = np.array(track.powers) / seen(track.offsets)
    noise = frames.usual_noise(numbers, places)
    square = np.maximum(total - 2.0 * noise, 1e-3 * total) * frames.scale
    middles = frames.middle[numbers]
    weighted = square * weigh(frequency) ** 2
    level = 10.0 * np.log10(weighted / reference**2)
    mean = float(np.average(frequency, weights=square))
    onset, end = edges(*_with_ends(track, frames), frames.hop / frames.rate)
    near = 0.25 * frames.hop / frames.rate  # of an end of the recording: it may have begun before
    onset, end = (onset if onset > near else 0.0), (end if end < frames.duration - near else frames.duration)
    spread = float(np.sqrt(np.average((frequency - mean) ** 2, weights=square)))
    inside = (middles >= onset) & (middles <= end)
    loud = weighted[inside] if np.any(inside) else weighted
    return {
        **dict.fromkeys(_OF_SAMPLES, np.nan),
        "onset": onset, "end": end, "frequency": mean, "frequency_error": 1.96 * spread,
        "level": float(10.0 * np.log10(np.mean(_full(loud)) / reference**2)), "peak_level": float(np.max(level)),
        "track_time": middles, "track_frequency": frequency, "track_level": level,
        "steady": _is_steady(frequency, step),
    }  # fmt: skip


def _is_steady(frequency: np.ndarray, step: float) -> bool:
    """Whether the means of an event's four quarters differ by no more than its frames do among each other."""
    whole = _full(frequency)
    if len(whole) < 8:
        return True
    apart = float(np.std(whole[3:] - whole[:-3])) / np.sqrt(2.0)  # frames that share little
    quarters = [float(np.mean(part)) for part in np.array_split(whole, 4)]
    return float(np.ptp(quarters)) <= STEADY * step + 4.0 * apart / np.sqrt(len(whole) / 9.0)


def _with_ends(track: Track, frames: Frames) -> tuple[Any, Any, Any]:
    """Middles, amplitudes and noise of the frames of a track, and of four before and after it that hide in noise."""
    first, last = max(track.frames[0] - 4, 0), min(track.frames[-1] + 5, len(frames.middle))
    numbers = np.arange(first, last)
    places = np.round(np.interp(numbers, track.frames, lines_of(track))).astype(int)
    around = np.clip(places[:, None] + np.array([-1, 0, 1]), 0, frames.power.shape[1] - 1)
    noise = frames.usual_noise(numbers, places)
    square = np.sum(frames.power[numbers[:, None], around], axis=1) / 1.5 - 2.0 * noise
    return frames.middle[numbers], np.sqrt(np.maximum(square, 0.0)), np.sqrt(noise)


def _of_samples(event: dict[str, Any], x: np.ndarray, rate: float, length: int) -> None:
    """Frequency and rates of an event from the samples themselves, which tell them better than frames."""
    near, onset, end = event["frequency"], event["onset"], event["end"]
    exact = steady_frequency(x, rate, near, onset, end, length) if event["steady"] else None
    if exact is not None:
        event["frequency"], event["frequency_error"] = exact
    grown = rate_at(x, rate, near, onset, end, length, backwards=False)
    event.update(zip(_OF_SAMPLES, (*grown, *rate_at(x, rate, near, onset, end, length, backwards=True)), strict=False))


def _full(weighted: np.ndarray) -> Any:
    """Frames that the event fills: its ends are left out where it is long enough."""
    return weighted[2:-2] if len(weighted) > 8 else weighted
