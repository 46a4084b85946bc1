"""Lines of a short-time transform that stand above the noise, followed from frame to frame.

Under noise alone the power of a line is distributed as exp(-x/mean), so a threshold of -ln p times the mean is passed
with the probability p. Peaks above it that follow each other are a track.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import pairwise
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

WANDER = 1.6  # lines a track may move from frame to frame
GAP = 6  # frames a track may be lost for
FRAMES = 6  # on end, at least, three quarters of each over the next
LEAK = 1e-3  # of the power of a line that may be seen beside it
SKIRT = 24  # lines beside it, and less with the square of the distance beyond
FAINTEST = 1e-100  # a largest value from which there is something to hear
LINES = 64  # from which the noise of a frame is told


@dataclass
class Track:
    """Peaks that follow each other: frames, lines (fractional), sums over three lines, heights, distances."""

    frames: list[int]
    lines: list[float]
    powers: list[float]
    heights: list[float]
    offsets: list[float]


class Frames:
    """Mean squares `power` (frames, lines) of lines under Hann's window, their frequencies, and the noise in them.

    The noise is the median of a line over time, or over the lines beside it where a tone stays, times how much louder
    than then the lines about it are in a frame: the noise of a brake falls with its speed, and a knock is in all lines.
    It is no less than what those lines have in that frame.
    """

    def __init__(self, x: np.ndarray, rate: float, length: int, band: tuple[float, float]) -> None:
        from scipy.fft import rfft
        from scipy.ndimage import median_filter

        self.hop, self.rate, self.duration = length // 4, rate, x.size / rate
        weights = np.sin(np.pi * np.arange(length) / length) ** 2
        first, last = int(band[0] * length / rate), int(np.ceil(band[1] * length / rate))
        wide = max(LINES - (last - first), 9) // 2 + 1  # enough lines to tell the noise
        first, last = max(first - wide, 1), min(last + wide, length // 2)
        self.frequency = np.arange(first, last) * (rate / length)
        starts = np.arange(0, x.size - length + 1, self.hop)
        self.middle = (starts + 0.5 * length) / rate
        top = float(np.max(np.abs(x)))
        top = top if top > FAINTEST else 1.0
        window = (weights * (np.sqrt(2.0) / np.sum(weights))).astype(np.float32)
        pieces = np.lib.stride_tricks.sliding_window_view((x / top).astype(np.float32), length)[:: self.hop]
        self.power = np.empty((len(starts), last - first), dtype=np.float32)
        for begin in range(0, len(starts), 256):
            part = rfft(pieces[begin : begin + 256] * window, axis=1)[:, first:last]
            self.power[begin : begin + 256] = part.real**2 + part.imag**2
        self.scale = top**2
        level = np.median(self.power[:: max(len(starts) // 2000, 1)], axis=0) / np.log(2.0)
        beside = median_filter(level, size=13, mode="nearest")  # a tone takes four lines
        self.floor = np.maximum(np.minimum(level, 1.1 * beside), np.float32(1e-30))
        count = max((last - first) // LINES, 1)
        edges = np.linspace(0, last - first, count + 1).astype(int)
        self.louder, self.least = np.empty((2, len(starts), count), dtype=np.float32)
        for j, (a, b) in enumerate(pairwise(edges)):
            part = self.power[:, a:b]
            self.louder[:, j] = np.median(part / self.floor[a:b], axis=1) / np.log(2.0)
            self.least[:, j] = np.median(part, axis=1) / np.log(2.0)
        places, middles = np.arange(last - first), 0.5 * (edges[:-1] + edges[1:])
        self.between = np.stack([np.interp(places, middles, row) for row in np.eye(count)]).astype(np.float32)

    def noise(self, frames: slice) -> Any:
        """Mean square of the noise in every line of some frames, shape (frames, lines)."""
        louder, least = (np.einsum("ij,jk->ik", each[frames], self.between) for each in (self.louder, self.least))
        return np.maximum(louder * self.floor, least)

    def noise_at(self, frames: Sequence[int] | np.ndarray, places: np.ndarray) -> Any:
        """Mean square of the noise in one line of each frame."""
        shares = self.between[:, places].T
        louder, least = (np.sum(each[frames] * shares, axis=1) for each in (self.louder, self.least))
        return np.maximum(louder * self.floor[places], least)

    def usual_noise(self, frames: np.ndarray, places: np.ndarray) -> Any:
        """The same as it is over most of the frames: a tone that begins or ends is in all lines, as a knock is."""
        noise = self.noise_at(frames, places)
        return self.floor[places] * np.median(noise / self.floor[places])


def tracks(frames: Frames, chance: float) -> Iterator[Track]:
    """Peaks joined from frame to frame."""
    power = frames.power
    limit = -np.log(chance)
    open_tracks: list[Track] = []
    for begin in range(0, len(power), 256):
        inner = power[begin : begin + 256, 1:-1]
        peak = (inner >= power[begin : begin + 256, :-2]) & (inner > power[begin : begin + 256, 2:])
        peak &= inner > limit * frames.noise(slice(begin, begin + 256))[:, 1:-1]
        numbers, places = np.nonzero(peak)
        for k in np.unique(numbers):
            found = places[numbers == k] + 1
            yield from (track for track in open_tracks if begin + k - track.frames[-1] > GAP)
            open_tracks = [track for track in open_tracks if begin + k - track.frames[-1] <= GAP]
            _join(open_tracks, begin + int(k), power[begin + k].astype(float), found)
    yield from open_tracks


def _join(open_tracks: list[Track], frame: int, row: np.ndarray, found: np.ndarray) -> None:
    """The peaks `found` of a frame as the next points of the tracks, or as the first of new ones."""
    heights = row[found]
    free = dict.fromkeys(range(len(open_tracks)))
    for i in np.argsort(-heights):
        line = _between(row, int(found[i]))
        near = [(abs(open_tracks[j].lines[-1] - line), j) for j in free]
        away, j = min(near, default=(np.inf, -1))
        if away <= WANDER:
            if _is_skirt(found, heights, i, 1.0 / LEAK):
                continue
            del free[j]
            track = open_tracks[j]
        elif _is_skirt(found, heights, i, 0.1 / LEAK):
            continue
        else:
            track = Track([], [], [], [], [])
            open_tracks.append(track)
        track.frames.append(frame)
        track.lines.append(line)
        track.offsets.append(line - float(found[i]))
        track.powers.append(float(np.sum(row[found[i] - 1 : found[i] + 2])))
        track.heights.append(float(heights[i]))


def stands_out(track: Track, frames: Frames, chance: float) -> bool:
    """Whether a track is long and, on the mean of its frames, high enough to be no noise."""
    if len(track.frames) < FRAMES:
        return False
    noise = frames.noise_at(track.frames, lines_of(track))
    return bool(np.mean(track.heights / noise) >= -np.log(chance))


def lines_of(track: Track) -> Any:
    """The line in which each peak of a track is highest."""
    return np.round(np.subtract(track.lines, track.offsets)).astype(int)


def _is_skirt(found: np.ndarray, heights: np.ndarray, i: int, times: float) -> bool:
    """Whether a peak is what the window, or the onset of a tone within a frame, shows beside one `times` higher."""
    if heights.max() <= times * heights[i]:
        return False
    away = np.abs(found - found[i])
    return bool(np.any(heights > times * heights[i] * np.maximum(1.0, (away / SKIRT) ** 2)))


def _between(row: np.ndarray, k: int) -> float:
    """The place of a peak between lines: of a tone under Hann's window exactly, from its line and the higher beside."""
    left, middle, right = row[k - 1 : k + 2].tolist()
    share = math.sqrt(max(left, right) / middle)
    return k + math.copysign(min(max((2.0 * share - 1.0) / (share + 1.0), 0.0), 0.5), right - left)


def seen(offsets: ArrayLike) -> Any:
    """What Hann's window shows of a tone in the three lines about it, `offsets` lines off the middle one; 1.5 at 0."""
    x = np.asarray(offsets)[:, None] - np.array([-1.0, 0.0, 1.0])
    x = np.where(np.abs(np.abs(x) - 1.0) < 1e-6, x + 2e-6, x)
    return np.sum((np.sinc(x) / (1.0 - x**2)) ** 2, axis=1)
