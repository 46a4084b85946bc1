"""A signal as something to listen to."""

import os
from fractions import Fraction
from pathlib import Path
from typing import Any

import numpy as np

from squealbox.signals.samples import SignalError, samples


def sound(
    signal: Any,
    path: str | os.PathLike[str],
    t: Any = None,
    *,
    sampling: int = 44100,
    level: float = 0.9,
    fade: float = 0.005,
    slower: float = 1.0,
    **cut: Any,
) -> Path:
    """Write a signal as a mono 16-bit WAV file and return its path.

    The pitch is true (`slower` = 2 plays at half speed, an octave down). The largest value is `level` of full scale, so
    nothing clips. `fade` [s] at each end keeps it from clicking. What lies above half of `sampling` [Hz] is filtered
    out.
    """
    from scipy.io import wavfile
    from scipy.signal import resample_poly

    data = samples(signal, t, **cut)
    if not (0.0 < level <= 1.0 and slower > 0.0 and fade >= 0.0):
        raise SignalError(f"level = {level}, slower = {slower}, fade = {fade}: expected (0, 1], > 0 and >= 0 s")
    ratio = Fraction(sampling * slower / data.rate).limit_denominator(10_000)
    wave = resample_poly(data.x - np.mean(data.x), ratio.numerator, ratio.denominator)
    ramp = np.minimum(np.arange(wave.size), np.arange(wave.size)[::-1]) / max(fade * sampling, 1.0)
    wave = wave * np.sin(0.5 * np.pi * np.minimum(ramp, 1.0)) ** 2
    loudest = float(np.max(np.abs(wave)))
    if loudest == 0.0:
        raise SignalError("the signal is constant: there is nothing to hear")
    whole = np.rint(wave * (level * np.iinfo(np.int16).max / loudest)).astype(np.int16)
    wavfile.write(path, sampling, whole)
    return Path(path)
