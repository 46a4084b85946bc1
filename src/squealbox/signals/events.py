"""Squeal events in a recording: when, at what frequency, how loud, how quickly they grew and died away.

Each frame of a short-time transform is compared, line by line, with the noise in that line. Under noise alone the power
of a line is distributed as exp(-x/mean), so a threshold of -ln p times the mean is passed with the probability p. Peaks
above it that follow each other for `FRAMES` frames are an event; several may sound at once. Rates of growth and decay
are of the samples themselves (`growth_rate`), because a frame is longer than many a burst.

Band and threshold follow SAE J2521 as its public summary states them: a peak of 70 dB(A) or more between 2 and 16 kHz
(from 1.25 kHz on for full corners).
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.arguments import public
from squealbox.result import Array, Outcome, Result, quantity
from squealbox.signals.event_ends import edges, rate_at, steady_frequency
from squealbox.signals.radiation import HEARING, a_weighting
from squealbox.signals.recordings import as_recording
from squealbox.signals.samples import SignalError

BAND = (2000.0, 16000.0)  # [Hz]
LEAST_LEVEL = 70.0  # dB(A)
FRAME = 0.043  # s
CHANCE = 1e-3  # that noise passes the threshold in a line of a frame
SURE = 1e-5  # and the threshold of the mean over the frames of an event
FRAMES = 6  # on end, at least, three quarters of each over the next
WANDER = 1.6  # lines a track may move from frame to frame
GAP = 6  # frames a track may be lost for
LEAK = 1e-3  # of the power of a line that may be seen beside it


@dataclass(frozen=True, kw_only=True, eq=False)
class SquealEvents(Result):
    """Squeal events, in the order of their onsets; rates are NaN where the record cannot tell them.

    Levels are dB(A) re 20 uPa of a calibrated recording, dB re full scale (unweighted) of another; `settings["unit"]`
    says which. The outcome is "completed" or "no_event".
    """

    onset: Array = quantity("event", "s", "when it begins")
    end: Array = quantity("event", "s", "when it ends")
    frequency: Array = quantity("event", "Hz", "mean frequency, weighed by power")
    frequency_error: Array = quantity("event", "Hz", "95 % error of the frequency where it is steady, else its spread")
    level: Array = quantity("event", "dB", "level over the event")
    peak_level: Array = quantity("event", "dB", "level of its loudest frame")
    growth_rate: Array = quantity("event", "1/s", "growth at its onset")
    growth_error: Array = quantity("event", "1/s", "95 % error")
    decay_rate: Array = quantity("event", "1/s", "rate at its end, below 0 for a decay")
    decay_error: Array = quantity("event", "1/s", "95 % error")
    track_time: Array = quantity("event frame", "s", "middles of its frames; NaN behind the last")
    track_frequency: Array = quantity("event frame", "Hz", "frequency in each frame")
    track_level: Array = quantity("event frame", "dB", "level in each frame")
    braking: Array = quantity("event braking", "", "quantities of the braking at the onset")
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
                head if self.count else f"{self.outcome}: {self.outcome.message}",
                *lines[: self.count + 1 if self.count else 0],
                *notes,
            ]
        )

    def __repr__(self) -> str:
        return self.summary()


@dataclass
class _Track:
    """Peaks that follow each other: frames, lines (fractional), sums over three lines, heights, distances."""

    frames: list[int]
    lines: list[float]
    powers: list[float]
    heights: list[float]
    offsets: list[float]


@public()
def squeal_events(
    recording: Any,
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
    chance : probability that noise passes the threshold in one line of one frame; `FRAMES` of them on end make an event

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
    power, lines, floor, starts = _frames(x, rate, length, hop, (low, min(high, 0.49 * rate)))
    weigh = a_weighting if calibrated else np.ones_like
    reference = HEARING if calibrated else 1.0
    tracks = [track for track in _tracks(power, floor, chance) if _stands_out(track, floor, SURE * chance / CHANCE)]
    events = []
    for track in tracks:
        event = _event(x, rate, track, lines, floor, starts, length, hop, weigh, reference)
        if least_level is None or not calibrated or event["peak_level"] >= least_level:
            events.append(event)
    events.sort(key=lambda event: event["onset"])
    names = list(sound.braking)
    settings = {"band": [low, high], "least_level": least_level, "frame": length / rate, "chance": chance}
    settings |= {"unit": "dB(A)" if calibrated else "dB re full scale", "notes": list(sound.notes)}
    settings |= {"braking": names, "source": sound.source, "channel": sound.names[sound.index(channel)]}
    settings["stop"] = {name: float(np.mean(values)) for name, (_, values) in sound.braking.items()}
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
    "onset", "end", "frequency", "frequency_error", "level", "peak_level", "growth_rate", "growth_error", "decay_rate",
    "decay_error", "track_time", "track_frequency", "track_level",
)  # fmt: skip


def _padded(value: Any, longest: int) -> Any:
    return value if np.ndim(value) == 0 else np.append(value, np.full(longest - len(value), np.nan))


def _frames(x: Any, rate: float, length: int, hop: int, band: tuple[float, float]) -> tuple[Any, Any, Any, Any]:
    """Mean squares (frames, lines) of a line under Hann's window, its frequencies, the noise, the frames' starts."""
    from scipy.fft import rfft

    weights = np.sin(np.pi * np.arange(length) / length) ** 2
    starts = np.arange(0, x.size - length + 1, hop)
    first, last = int(band[0] * length / rate), int(np.ceil(band[1] * length / rate))
    first, last = max(first - 4, 1), min(last + 5, length // 2)
    pieces = np.lib.stride_tricks.sliding_window_view(x, length)[::hop]
    power = np.empty((len(starts), last - first))
    for begin in range(0, len(starts), 256):
        part = rfft(pieces[begin : begin + 256] * weights, axis=1)[:, first:last]
        power[begin : begin + 256] = 2.0 * (part.real**2 + part.imag**2) / np.sum(weights) ** 2
    return power, np.arange(first, last) * (rate / length), _noise(power), starts


def _noise(power: Any) -> Any:
    """The mean of the noise in each line: its median over time, or over the lines beside it where a tone stays."""
    from scipy.ndimage import median_filter

    level = np.median(power[:: max(len(power) // 2000, 1)], axis=0) / np.log(2.0)
    beside = median_filter(level, size=13, mode="nearest")  # a tone takes four lines
    return np.maximum(np.minimum(level, 1.1 * beside), 1e-300)


def _tracks(power: Any, floor: Any, chance: float) -> Iterator[_Track]:
    """Peaks joined from frame to frame."""
    limit = -np.log(chance) * floor
    inner = power[:, 1:-1]
    peak = (inner >= power[:, :-2]) & (inner > power[:, 2:]) & (inner > limit[1:-1])
    frames, places = np.nonzero(peak)
    open_tracks: list[_Track] = []
    for k in np.unique(frames):
        found = places[frames == k] + 1
        heights = power[k, found]
        reach = np.max(heights) * LEAK
        still = []
        for track in open_tracks:
            if k - track.frames[-1] <= GAP:
                still.append(track)
            else:
                yield track
        open_tracks = still
        free = dict.fromkeys(range(len(open_tracks)))
        for i in np.argsort(-heights):
            if heights[i] < reach:
                continue
            line = _between(power[k], int(found[i]))
            near = [(abs(open_tracks[j].lines[-1] - line), j) for j in free]
            away, j = min(near, default=(np.inf, -1))
            mean_square = float(np.sum(power[k, found[i] - 1 : found[i] + 2]))
            if away <= WANDER:
                del free[j]
                track = open_tracks[j]
            else:
                if heights[i] < 4.0 * reach and len(found) > 1 and _is_skirt(found, heights, i):
                    continue
                track = _Track([], [], [], [], [])
                open_tracks.append(track)
            track.frames.append(int(k))
            track.lines.append(line)
            track.offsets.append(line - float(found[i]))
            track.powers.append(mean_square)
            track.heights.append(float(heights[i]))
    yield from open_tracks


def _stands_out(track: _Track, floor: Any, chance: float) -> bool:
    """Whether a track is long and, on the mean of its frames, high enough to be no noise."""
    places = np.clip(np.round(track.lines).astype(int), 0, len(floor) - 1)
    return len(track.frames) >= FRAMES and bool(np.mean(track.heights / floor[places]) >= -np.log(chance))


def _is_skirt(found: Any, heights: Any, i: int) -> bool:
    """Whether a peak stands within what Hann's window shows beside a much higher one."""
    higher = heights > 100.0 * heights[i]
    return bool(np.any(higher & (np.abs(found - found[i]) < 24)))


def _between(row: Any, k: int) -> float:
    """The place of a peak between lines: a parabola through the logarithms."""
    left, middle, right = np.log(np.maximum(row[k - 1 : k + 2], 1e-300))
    bend = left - 2.0 * middle + right
    return k + (0.5 * (left - right) / bend if bend < 0.0 else 0.0)


def _seen(offsets: Any) -> Any:
    """What Hann's window shows of a tone in the three lines about it, `offsets` lines off the middle one; 1.5 at 0."""
    x = np.asarray(offsets)[:, None] - np.array([-1.0, 0.0, 1.0])
    x = np.where(np.abs(np.abs(x) - 1.0) < 1e-6, x + 2e-6, x)
    return np.sum((np.sinc(x) / (1.0 - x**2)) ** 2, axis=1)


def _event(
    x: Any,
    rate: float,
    track: _Track,
    lines: Any,
    floor: Any,
    starts: Any,
    length: int,
    hop: int,
    weigh: Any,
    reference: float,
) -> dict[str, Any]:
    step = lines[1] - lines[0]
    frames = np.array(track.frames)
    frequency = lines[0] + step * np.array(track.lines)
    places = np.clip(np.round(track.lines).astype(int), 0, len(floor) - 1)
    total = np.array(track.powers) / _seen(track.offsets)
    square = np.maximum(total - 2.0 * floor[places], 1e-3 * total)
    middles = (starts[frames] + 0.5 * length) / rate
    weighted = square * weigh(frequency) ** 2
    level = 10.0 * np.log10(weighted / reference**2)
    mean = float(np.average(frequency, weights=square))
    onset, end = edges(middles, np.sqrt(square), hop / rate)
    spread = float(np.sqrt(np.average((frequency - mean) ** 2, weights=square)))
    inside = (middles >= onset) & (middles <= end)
    loud = weighted[inside] if np.any(inside) else weighted
    event: dict[str, Any] = {
        "onset": onset, "end": end, "frequency": mean, "frequency_error": 1.96 * spread,
        "level": float(10.0 * np.log10(np.mean(_full(loud)) / reference**2)), "peak_level": float(np.max(level)),
        "track_time": middles, "track_frequency": frequency, "track_level": level,
    }  # fmt: skip
    exact = steady_frequency(x, rate, mean, onset, end, length)
    if exact is not None and exact[1] < event["frequency_error"]:
        event["frequency"], event["frequency_error"] = exact
    event["growth_rate"], event["growth_error"] = rate_at(x, rate, mean, onset, end, length, backwards=False)
    event["decay_rate"], event["decay_error"] = rate_at(x, rate, mean, onset, end, length, backwards=True)
    return event


def _full(weighted: Any) -> Any:
    """Frames that the event fills: its ends are left out where it is long enough."""
    return weighted[2:-2] if len(weighted) > 8 else weighted
