"""A signal as something to listen to."""

import os
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import public
from squealbox.signals.sampling import Signal, SignalError, unfolded

SAMPLING = 44100  # [Hz]


@public()
def sound(
    signal: Signal,
    path: str | os.PathLike[str],
    t: ArrayLike | None = None,
    *,
    sampling: int = SAMPLING,
    level: float = 0.9,
    fade: float = 0.005,
    slower: float = 1.0,
    loudest: float | None = None,
    **cut: Any,
) -> Path:
    """Write a signal as a mono 16-bit WAV file and return its path.

    The pitch is true (`slower` [-] = 2 plays at half speed, an octave down). The largest value is `level` [-] of full
    scale, so nothing clips; with `loudest` [SI], a value of that size is, so that two sounds written with the same
    `loudest` can be compared by ear. `fade` [s] at each end keeps it from clicking. What lies above half of `sampling`
    [Hz] is filtered out. Raises `SignalError` for a constant signal, and when a `loudest` is so small that it would
    clip.
    """
    from scipy.io import wavfile

    wave = audible(signal, t, sampling=sampling, fade=fade, slower=slower, **cut)
    wavfile.write(path, sampling, sixteen_bits(wave, level=level, loudest=loudest))
    return Path(path)


def audible(
    signal: Signal,
    t: ArrayLike | None = None,
    *,
    sampling: int = SAMPLING,
    fade: float = 0.005,
    slower: float = 1.0,
    **cut: Any,
) -> Any:
    """The signal about its mean, shape (k,), sampled at `sampling` [Hz] and faded in and out over `fade` [s], in its
    own unit.

    The true frequencies are kept; `slower` [-] stretches time. What cannot be written at that rate is filtered out.
    """
    data = unfolded(signal, t, **cut)
    if not (slower > 0.0 and fade >= 0.0):
        raise SignalError(f"slower = {slower}, fade = {fade}: expected > 0 and >= 0 s")
    ratio = Fraction(sampling * slower / data.rate).limit_denominator(10_000)
    wave = resampled(data.x - np.mean(data.x), ratio)
    ramp = np.minimum(np.arange(wave.size), np.arange(wave.size)[::-1]) / max(fade * sampling, 1.0)
    return wave * np.sin(0.5 * np.pi * np.minimum(ramp, 1.0)) ** 2


def resampled(x: np.ndarray, ratio: Fraction) -> Any:
    """The samples x (k,) at `ratio` times their rate: a sum over a sinc under Kaiser's window of ten zeros either way.

    What `scipy.signal.resample_poly` gives, whose package takes longer to load than the sum does.
    """
    up, down = ratio.numerator, ratio.denominator
    coarse = max(up, down)
    reach = 10 * coarse
    at = np.arange(-reach, reach + 1)
    taps = np.sinc(at / coarse) * np.i0(5.0 * np.sqrt(1.0 - (at / reach) ** 2))
    taps *= up / np.sum(taps)
    wide = reach // up + 1  # samples either way that one of the result is made of
    taps = np.pad(taps, (up, 2 * up))
    around = np.lib.stride_tricks.sliding_window_view(np.pad(x, wide), 2 * wide + 1)
    wave = np.zeros(-(-x.size * up // down))
    for first in range(min(up, wave.size)):
        sample, phase = divmod(first * down, up)
        weights = taps[up + phase + reach + wide * up :: -up][: 2 * wide + 1]
        wave[first::up] = around[sample::down] @ weights
    return wave


def sixteen_bits(wave: np.ndarray, *, level: float = 0.9, loudest: float | None = None) -> Any:
    """A wave (k,) as 16-bit samples; its largest value, or one of size `loudest` [SI], becomes `level` [-] of full
    scale.
    """
    if not 0.0 < level <= 1.0:
        raise SignalError(f"level = {level}: expected a share of full scale in (0, 1]")
    own = float(np.max(np.abs(wave)))
    if own == 0.0 and loudest is None:
        raise SignalError("the signal is constant: there is nothing to hear")
    if loudest is not None and not (loudest > 0.0 and level * own <= loudest):
        raise SignalError(f"loudest = {loudest:g}: expected about the largest value or more, {own:g} would clip")
    return np.rint(wave * (level * np.iinfo(np.int16).max / (loudest or own))).astype(np.int16)
