from .ambient import DampingOnset, OperationalModes, damping_onset, operational_modes
from .events import SquealEvents, squeal_events
from .growth import GrowthRate, dominant_frequency, growth_rate, highest_line, slope, with_error
from .noise import NoiseMatrix, noise_matrix
from .quality import SoundQuality, sound_quality
from .radiation import SoundLevel, a_weighting, piston_efficiency, sound_level
from .recordings import Recording, read_recording
from .rendering import rendered
from .sampling import LEAST, Samples, SignalError, carries, column, equal_steps, samples, too_few, values
from .settings import EventSettings, RecordingSettings
from .spectra import Peaks, Spectrogram, Spectrum, peaks, spectrogram, spectrum
from .wav import audible, sixteen_bits, sound

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

# What neighbours may use too; no names of the reference (docs/house.md, Faces).
from .events import BAND as BAND
from .events import BELOW as BELOW
from .growth import LEVEL as LEVEL
from .radiation import AREA as AREA
from .radiation import AUDIBLE as AUDIBLE
from .recordings import universal_sets as universal_sets
from .sampling import MotionLike as MotionLike
from .sampling import Signal as Signal
from .wav import SAMPLING as SAMPLING
