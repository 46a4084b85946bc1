"""Where a squeal event begins and ends, its frequency, and how quickly it grew and died away, from the samples."""

from typing import Any

import numpy as np

from squealbox.signals.growth import growth_rate
from squealbox.signals.sampling import SignalError
from squealbox.signals.tones import tones

QUIET = 0.05  # share of the plateau from which growth is read, if the noise is below
LOUD = 0.45  # share of the plateau up to which growth is read


def edges(middles: np.ndarray, amplitude: np.ndarray, noise: np.ndarray, hop: float) -> tuple[float, float]:
    """Onset and end: where half of what follows within a frame is reached, for three frames on end above the noise.

    A tone that sets in at once shows the share of the window that holds it; the best such instant is taken.
    """

    def first(times: np.ndarray, heights: np.ndarray, quiet: np.ndarray) -> float:
        after = np.append(heights, np.full(4, np.nan))[3:]
        half = 0.5 * np.nanmedian(np.lib.stride_tricks.sliding_window_view(after, 5), axis=1)
        lasts = np.min(np.lib.stride_tricks.sliding_window_view(heights, 3), axis=1)[: len(half)]
        stays = np.nonzero((lasts >= half) & (half >= 1.5 * quiet[: len(half)]))[0]
        k = int(stays[0]) if stays.size else 0
        near = slice(max(k - 4, 0), k + 6)
        tried = times[k] + hop * np.arange(-3.0, 2.0, 0.05)
        misfit = np.minimum(heights[near] / (2.0 * half[k]), 1.2) - _rise((times[near] - tried[:, None]) / (4.0 * hop))
        return float(tried[np.argmin(np.sum(misfit**2, axis=1))])

    begin, end = first(middles, amplitude, noise), -first(-middles[::-1], amplitude[::-1], noise[::-1])
    return begin, max(end, begin + hop)


def _rise(after: np.ndarray) -> Any:
    """Amplitude that Hann's window shows of a tone which sets in `after` of its length before the window's middle.

    The middle of what its line holds, 1 - F, and of what all lines hold, sqrt(1 - G); the lines beside it are counted.
    """
    s = 2.0 * np.pi * np.clip(0.5 - after, 0.0, 1.0)
    line = 1.0 - (s - np.sin(s)) / (2.0 * np.pi)
    every = 1.0 - (s - (8.0 * np.sin(s) - np.sin(2.0 * s)) / 6.0) / (2.0 * np.pi)
    return 0.5 * (line + np.sqrt(np.clip(every, 0.0, 1.0)))


def steady_frequency(
    x: np.ndarray, rate: float, near: float, onset: float, end: float, length: int
) -> tuple[float, float] | None:
    """The frequency over the middle of an event by maximum likelihood, with its error."""
    a, b = int((onset + 0.1 * (end - onset)) * rate), int((end - 0.1 * (end - onset)) * rate)
    middle = (a + b) // 2
    part = x[max(a, middle - 2 * length) : min(b, middle + 2 * length)]
    if part.size < length // 2:
        return None
    try:
        for most in (1, 4):  # a louder tone beside it is fitted with it
            found = tones(part, rate, near=near, most=most, colour=False)
            away = np.abs(found.exponents.imag / (2.0 * np.pi) - near)
            if away.size and np.min(away) <= 0.5 * rate / length:
                break
        else:
            return None
    except SignalError:
        return None
    i = int(np.argmin(away))
    if abs(found.exponents[i].real) * part.size / rate > 1.0:
        return None
    return float(found.exponents[i].imag / (2.0 * np.pi)), float(1.96 * found.error(i)[1] / (2.0 * np.pi))


def rate_at(
    x: np.ndarray, rate: float, near: float, onset: float, end: float, length: int, *, backwards: bool
) -> tuple[float, float, float, float]:
    """Growth at the onset or, `backwards`, the rate at the end, and the frequency there, each followed by its error.

    All are NaN when the record cannot tell them.
    """
    if backwards:
        other = rate_at(x[::-1], rate, near, x.size / rate - end, x.size / rate - onset, length, backwards=False)
        return (-other[0], *other[1:])
    nothing = (np.nan,) * 4
    a = max(int(onset * rate) - 2 * length, 0)
    b = min(int(min(onset * rate + 2 * length, 0.5 * (onset + end) * rate + length)), x.size)
    width = max(int(8.0 * rate / near), 8)
    carrier = np.exp(-2j * np.pi * near / rate * np.arange(b - a))
    window = np.sin(np.pi * (np.arange(width) + 0.5) / width) ** 2
    envelope = np.abs(np.convolve(x[a:b] * carrier, window / np.sum(window), mode="valid"))
    if envelope.size < 4:
        return nothing
    plateau = float(np.max(envelope))
    noise = float(np.median(envelope[: max(length // 4, 4)])) if a > 0 or onset * rate > length else 0.0
    top = int(np.argmax(envelope >= LOUD * plateau))
    below = np.nonzero(envelope[:top] < max(QUIET * plateau, 3.0 * noise))[0]
    first = int(below[-1]) + 1 if below.size else 0
    begin, stop = a + first + width // 2, a + top + width // 2  # samples of which the envelope is the middle
    if stop - begin < max(3.0 * rate / near, 24.0):
        return nothing
    try:
        found = growth_rate(x[begin:stop], rate=rate, frequency=near)
    except SignalError:
        return nothing
    return found.rate, found.rate_error, found.frequency, found.frequency_error
