"""Where a squeal event begins and ends, its frequency, and how quickly it grew and died away, from the samples."""

from typing import Any

import numpy as np

from squealbox.signals.growth import growth_rate
from squealbox.signals.samples import SignalError
from squealbox.signals.tones import tones

QUIET = 0.05  # share of the plateau from which growth is read, if the noise is below
LOUD = 0.45  # share of the plateau up to which growth is read


def edges(middles: Any, amplitude: Any, hop: float) -> tuple[float, float]:
    """Onset and end: where half of what follows within a frame is reached; of slow growth, where it is seen."""

    def first(times: Any, heights: Any) -> float:
        later = heights[min(4, len(heights) - 1)]
        above = np.nonzero(heights >= 0.5 * later)[0]
        k = int(above[0]) if above.size else 0
        if k == 0:
            return float(times[0])
        share = (0.5 * later - heights[k - 1]) / max(heights[k] - heights[k - 1], 1e-300)
        return float(times[k - 1] + share * (times[k] - times[k - 1]))

    begin, end = first(middles, amplitude), -first(-middles[::-1], amplitude[::-1])
    return begin, max(end, begin + hop)


def steady_frequency(
    x: Any, rate: float, near: float, onset: float, end: float, length: int
) -> tuple[float, float] | None:
    """The frequency over the middle of an event by maximum likelihood, with its error."""
    a, b = int((onset + 0.1 * (end - onset)) * rate), int((end - 0.1 * (end - onset)) * rate)
    middle = (a + b) // 2
    part = x[max(a, middle - 2 * length) : min(b, middle + 2 * length)]
    if part.size < length // 2:
        return None
    try:
        found = tones(part, rate, near=near, most=1, colour=False)
    except SignalError:
        return None
    if not found.exponents.size or abs(found.exponents[0].real) * part.size / rate > 1.0:
        return None
    return float(found.exponents[0].imag / (2.0 * np.pi)), float(1.96 * found.error(0)[1] / (2.0 * np.pi))


def rate_at(
    x: Any, rate: float, near: float, onset: float, end: float, length: int, *, backwards: bool
) -> tuple[float, float]:
    """Growth at the onset or, `backwards`, the rate at the end, with its error; NaN when the record cannot tell."""
    if backwards:
        other = rate_at(x[::-1], rate, near, x.size / rate - end, x.size / rate - onset, length, backwards=False)
        return -other[0], other[1]
    a = max(int(onset * rate) - 2 * length, 0)
    b = min(int(min(onset * rate + 2 * length, 0.5 * (onset + end) * rate + length)), x.size)
    width = max(int(8.0 * rate / near), 8)
    carrier = np.exp(-2j * np.pi * near / rate * np.arange(b - a))
    window = np.sin(np.pi * (np.arange(width) + 0.5) / width) ** 2
    envelope = np.abs(np.convolve(x[a:b] * carrier, window / np.sum(window), mode="valid"))
    if envelope.size < 4:
        return np.nan, np.nan
    plateau = float(np.max(envelope))
    noise = float(np.median(envelope[: max(length // 4, 4)])) if a > 0 or onset * rate > length else 0.0
    top = int(np.argmax(envelope >= LOUD * plateau))
    below = np.nonzero(envelope[:top] < max(QUIET * plateau, 3.0 * noise))[0]
    first = int(below[-1]) + 1 if below.size else 0
    begin, stop = a + first + width // 2, a + top + width // 2  # samples of which the envelope is the middle
    if stop - begin < max(3.0 * rate / near, 24.0):
        return np.nan, np.nan
    try:
        found = growth_rate(x[begin:stop], rate=rate, frequency=near)
    except SignalError:
        return np.nan, np.nan
    return found.rate, found.rate_error
