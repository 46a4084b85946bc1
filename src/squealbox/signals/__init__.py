"""What a signal holds: spectrum, peaks, growth rate, sound and how loud; recordings, the squeal events in them, and
the damping before it squeals.

Depends on: parameters, result.

Every function takes an array with its times ``t`` [s] or its sampling rate [Hz], or anything with ``.t`` and ``.q``,
such as a trajectory, of which ``dof`` names one column. Fourier methods need equal time steps and refuse others.
"""

from squealbox.signals.ambient import DampingOnset, OperationalModes, damping_onset, operational_modes
from squealbox.signals.events import SquealEvents, squeal_events
from squealbox.signals.growth import GrowthRate, dominant_frequency, growth_rate, highest_line, slope, with_error
from squealbox.signals.noise import NoiseMatrix, noise_matrix
from squealbox.signals.quality import SoundQuality, sound_quality
from squealbox.signals.radiation import SoundLevel, a_weighting, piston_efficiency, sound_level
from squealbox.signals.recordings import Recording, read_recording
from squealbox.signals.rendering import rendered
from squealbox.signals.samples import (
    LEAST,
    Samples,
    SignalError,
    carries,
    column,
    equal_steps,
    samples,
    too_few,
    values,
)
from squealbox.signals.settings import EventSettings, RecordingSettings
from squealbox.signals.spectra import Peaks, Spectrogram, Spectrum, peaks, spectrogram, spectrum
from squealbox.signals.wav import audible, sixteen_bits, sound

__all__ = [
    "LEAST",
    "DampingOnset",
    "EventSettings",
    "GrowthRate",
    "NoiseMatrix",
    "OperationalModes",
    "Peaks",
    "Recording",
    "RecordingSettings",
    "Samples",
    "SignalError",
    "SoundLevel",
    "SoundQuality",
    "Spectrogram",
    "Spectrum",
    "SquealEvents",
    "a_weighting",
    "audible",
    "carries",
    "column",
    "damping_onset",
    "dominant_frequency",
    "equal_steps",
    "growth_rate",
    "highest_line",
    "noise_matrix",
    "operational_modes",
    "peaks",
    "piston_efficiency",
    "read_recording",
    "rendered",
    "samples",
    "sixteen_bits",
    "slope",
    "sound",
    "sound_level",
    "sound_quality",
    "spectrogram",
    "spectrum",
    "squeal_events",
    "too_few",
    "values",
    "with_error",
]
