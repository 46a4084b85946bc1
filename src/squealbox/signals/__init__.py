"""What a signal holds: spectrum, peaks, spectrogram, frequency, growth rate, sound. Depends on: result.

Every function takes an array with its times ``t`` [s] or its sampling rate [Hz], or anything with ``.t`` and ``.q``,
such as a trajectory, of which ``dof`` names one column. Fourier methods need equal time steps and refuse others.
"""

from squealbox.signals.growth import GrowthRate, dominant_frequency, growth_rate, slope, with_error
from squealbox.signals.samples import LEAST, Samples, SignalError, column, equal_steps, samples, values
from squealbox.signals.spectra import Peaks, Spectrogram, Spectrum, peaks, spectrogram, spectrum
from squealbox.signals.wav import sound

__all__ = [
    "LEAST",
    "GrowthRate",
    "Peaks",
    "Samples",
    "SignalError",
    "Spectrogram",
    "Spectrum",
    "column",
    "dominant_frequency",
    "equal_steps",
    "growth_rate",
    "peaks",
    "samples",
    "slope",
    "sound",
    "spectrogram",
    "spectrum",
    "values",
    "with_error",
]
