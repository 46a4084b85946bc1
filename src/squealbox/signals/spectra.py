"""Amplitude spectrum, its peaks, and the spectrogram."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import public
from squealbox.result import Array, Result, quantity
from squealbox.signals.sampling import Signal, SignalError, given, samples

LOBE_STEPS = 16


@dataclass(frozen=True, kw_only=True, eq=False)
class Spectrum(Result):
    """One-sided amplitude spectrum: a sinusoid of amplitude a shows a line of height a."""

    frequency: Array = quantity("frequency", "Hz", "frequency")
    amplitude: Array = quantity("frequency", "unit of the signal", "amplitude of the sinusoid at each frequency")
    mean: float
    window: str
    resolution: float
    noise_bandwidth: float
    caution: str = ""

    @property
    def angular_frequency(self) -> Any:
        """Angular frequency [rad/s]."""
        return 2.0 * np.pi * self.frequency

    @property
    def angular_resolution(self) -> float:
        """Resolution in rad/s: 2 pi over the length of the record."""
        return 2.0 * np.pi * self.resolution


@dataclass(frozen=True, kw_only=True, eq=False)
class Spectrogram(Result):
    """Amplitude spectra of successive pieces of a signal; `time` is the middle of each piece."""

    time: Array = quantity("time", "s", "middle of each piece")
    frequency: Array = quantity("frequency", "Hz", "frequency")
    amplitude: Array = quantity("frequency time", "unit of the signal", "amplitude of the sinusoid at each frequency")
    window: str
    segment: float
    resolution: float
    caution: str = ""

    table_over: ClassVar = ("time", "frequency")

    @property
    def strongest(self) -> float:
        """Frequency [Hz] of the largest amplitude above 0 Hz, at any time."""
        return float(self.frequency[np.argmax(np.max(self.amplitude[1:], axis=1)) + 1])


@public()
def spectrum(signal: Signal, t: ArrayLike | None = None, *, window: str = "hann", pad: int = 4, **cut: Any) -> Spectrum:
    """One-sided amplitude spectrum of a signal about its mean under the window.

    Parameters
    ----------
    signal, t : see the head of this module
    window : any name `scipy.signal.get_window` knows
    pad : the record is lengthened `pad` times with zeros, which draws the lines smoothly and resolves nothing more
    cut : `rate` [Hz], `dof`, `begin` [s], `end` [s] as in :func:`samples`

    Returns
    -------
    Spectrum
        `frequency` [Hz], `amplitude` in the signal's unit, `mean`, `window`, `resolution` [Hz], one over the length of
        the record (two closer lines are not told apart), `noise_bandwidth` [Hz], the window's equivalent noise
        bandwidth. `caution` says where the instants of a trajectory are too few for its motion.

    Limits
    ------
    A line between two frequencies of the grid is low by at most 1 % (hann, pad = 4); `peaks` mends it.

    >>> t = np.arange(1000) / 1000.0
    >>> round(float(spectrum(2.0 * np.sin(2 * np.pi * 50.0 * t), t).amplitude.max()), 6)
    2.0
    """
    from scipy.fft import next_fast_len, rfft, rfftfreq

    data = samples(signal, t, **cut)
    count = data.x.size
    weights = window_weights(window, count)
    length = next_fast_len(max(int(pad), 1) * count, real=True) if pad > 1 else count
    mean = float(np.average(data.x, weights=weights))
    amplitude = 2.0 * np.abs(rfft(weights * (data.x - mean), length)) / np.sum(weights)
    amplitude[0] /= 2.0
    if length % 2 == 0:
        amplitude[-1] /= 2.0
    return Spectrum(
        frequency=rfftfreq(length, 1.0 / data.rate),
        amplitude=amplitude,
        mean=mean,
        window=window,
        resolution=data.rate / count,
        noise_bandwidth=float(data.rate * np.sum(weights**2) / np.sum(weights) ** 2),
        caution=data.caution,
        settings={"pad": pad, "window": window, **given(cut)},
    )


def window_weights(window: str, count: int) -> Any:
    """The periodic window of a name `scipy.signal.get_window` knows; the usual one without loading that package."""
    if window == "hann" and count > 1:
        return 0.5 - 0.5 * np.cos(2.0 * np.pi * np.arange(count) / count)
    from scipy.signal import get_window

    return get_window(window, count)


@dataclass(frozen=True)
class Peaks:
    """Lines of a spectrum, highest first: `frequency` (m,) [Hz] and `amplitude` (m,); iterates over the pairs."""

    frequency: Any
    amplitude: Any

    def __iter__(self) -> Iterator[tuple[float, float]]:
        return iter(zip(self.frequency.tolist(), self.amplitude.tolist(), strict=True))


def peaks(spectrum: Spectrum, count: int | None = None, *, least: float = 0.03) -> Peaks:
    """The lines of a spectrum, highest first, at most `count`, each at least `least` [-] of the highest.

    Frequency and amplitude come from the parabola through the logarithms of the three points at the top. A line counts
    when it is a resolution away from the next, the dip before a higher one falls to half of it, and it is twice what
    the side lobes of higher lines can make there.
    """
    if not isinstance(spectrum, Spectrum):
        raise SignalError(f"a {type(spectrum).__name__} is no spectrum: expected spectrum(signal)")
    amplitude, frequency = spectrum.amplitude, spectrum.frequency
    step = frequency[1] - frequency[0]
    apart = max(1, round(spectrum.resolution / step))
    floor = np.finfo(float).tiny
    level = np.log(np.maximum(amplitude, floor))
    top = float(np.max(amplitude, initial=floor))
    found = tops(level, np.log(max(least * top, floor)), apart, np.log(2.0))
    middle = level[found]
    left, right = (np.maximum(level[found + side], middle - 2.0) for side in (-1, 1))  # a null of a side lobe misleads
    shift = 0.5 * (left - right) / (left - 2.0 * middle + right)
    height = np.exp(middle - 0.25 * (left - right) * shift)
    place = frequency[found] + shift * step
    kept: list[int] = []
    hull = _side_lobes(spectrum.window)
    for i in np.argsort(-height):
        away = np.abs(place[kept] - place[i]) / spectrum.resolution * LOBE_STEPS
        lobes = hull[np.minimum(away.astype(int), hull.size - 1)]
        if height[i] > 2.0 * np.sum(height[kept] * lobes):
            kept.append(int(i))
    return Peaks(place[kept[:count]], height[kept[:count]])


def tops(x: np.ndarray, least: float, apart: int, dip: float) -> Any:
    """Places of the maxima of x: `least` high, the highest within `apart` points, `dip` above the way to a higher one.

    Those of `scipy.signal.find_peaks(x, height=least, distance=apart, prominence=dip)`, whose package takes longer to
    load than all of a run's drawing.
    """
    begins = np.flatnonzero(np.diff(x, prepend=np.nan))  # of stretches of one height, of which the middle counts
    heights, ends = x[begins], np.append(begins[1:], x.size) - 1
    inner = np.flatnonzero((heights[1:-1] > heights[:-2]) & (heights[1:-1] > heights[2:])) + 1
    found = (begins[inner] + ends[inner])[heights[inner] >= least] // 2
    if not found.size:
        return found
    high = x[found]
    saddles = np.minimum.reduceat(x, np.append(0, found))
    below = np.maximum(_lowest_before(high, saddles), _lowest_before(high[::-1], saddles[::-1])[::-1])
    first, last = np.searchsorted(found, found - apart + 1), np.searchsorted(found, found + apart)
    alone, order = np.ones(found.size, dtype=bool), np.argsort(high)[::-1]
    for i in order[(last - first)[order] > 1]:
        if alone[i]:
            alone[first[i] : last[i]] = False
            alone[i] = True
    return found[alone & (high - below >= dip)]


def _lowest_before(high: np.ndarray, saddles: np.ndarray) -> Any:
    """The lowest of what lies between each top and the next higher one before it, or the beginning."""
    lowest, higher = np.empty(high.size), list[tuple[float, float]]()
    for i, (height, low) in enumerate(zip(high.tolist(), saddles.tolist(), strict=False)):
        while higher and higher[-1][0] <= height:
            low = min(low, higher.pop()[1])
        higher.append((height, low))
        lowest[i] = low
    return lowest


def _side_lobes(window: str) -> Any:
    """Highest share of a line that a window shows at each 1/LOBE_STEPS resolution from it, or farther."""
    bins = 512  # the response depends on the window's length only through 1/bins^2
    response = np.abs(np.fft.rfft(window_weights(window, bins), bins * LOBE_STEPS))
    return np.maximum.accumulate(response[::-1])[::-1] / response[0]


@public()
def spectrogram(
    signal: Signal,
    t: ArrayLike | None = None,
    *,
    segment: float | None = None,
    window: str = "hann",
    overlap: float = 0.9,
    **cut: Any,
) -> Spectrogram:
    """Amplitude spectra of successive pieces of a signal, which overlap by the share `overlap` [-].

    A piece is `segment` [s] long, by default an eighth of the record; the resolution is 1/segment [Hz]. Only pieces
    that lie whole inside the record are kept, so `time` starts and ends half a piece inside it. Each piece is taken
    about its own mean under the window. `caution` says where the instants of a trajectory are too few for its motion.
    """
    from scipy.signal import ShortTimeFFT

    data = samples(signal, t, **cut)
    length = round((data.duration / 8.0 if segment is None else segment) * data.rate)
    if not 8 <= length <= data.x.size or not 0.0 <= overlap < 1.0:
        raise SignalError(
            f"segment = {length / data.rate:g} s with overlap = {overlap:g}: expected {8 / data.rate:g} s to "
            f"{data.duration:g} s and an overlap in [0, 1)"
        )
    hop = max(1, round(length * (1.0 - overlap)))
    scale = {"scale_to": "magnitude", "fft_mode": "onesided2X"}
    weights = window_weights(window, length)
    transform = ShortTimeFFT(weights, hop, data.rate, mfft=4 * length, **scale)
    first, last = transform.lower_border_end[1], transform.upper_border_begin(data.x.size)[1]

    def about_mean(piece: np.ndarray) -> Any:
        return piece - np.average(piece, weights=weights, axis=-1)

    pieces = transform.stft_detrend(data.x, about_mean, first, last)
    return Spectrogram(
        time=data.t[0] + transform.t(data.x.size, first, last),
        frequency=transform.f,
        amplitude=np.abs(pieces),
        window=window,
        segment=length / data.rate,
        resolution=data.rate / length,
        caution=data.caution,
        settings={"overlap": overlap, **given(cut)},
    )
