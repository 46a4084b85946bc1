"""Damping before squeal: at the bound of the noise, with honest errors, and the onset; how loud a sound is."""

import numpy as np
import pytest
from scipy.signal import lfilter

from squealbox.signals import SignalError, damping_onset, operational_modes, sound_quality

RATE = 8000.0


def answered(modes, duration, seed, *, noise=0.05, together=False):
    """Displacement of modes (frequency, damping ratio) under white forcing, each its own or one for all, with noise."""
    rng = np.random.default_rng(seed)
    count, total = int(duration * RATE), 0.0
    one = rng.standard_normal(count)
    for f, zeta in modes:
        w = 2.0 * np.pi * f
        pole = np.exp((-zeta * w + 1j * w * np.sqrt(1.0 - zeta**2)) / RATE)
        push = one if together else rng.standard_normal(count)
        total = total + lfilter([0.0, pole.imag], [1.0, -2.0 * pole.real, abs(pole) ** 2], push)
    return total + noise * np.std(total) * rng.standard_normal(count)


@pytest.mark.parametrize("together", [False, True])
def test_damping_at_the_bound_of_the_noise(together):
    """White forcing leaves zeta / sqrt(2 pi zeta f T) of error at least."""
    f, zeta, duration = 1300.0, 0.01, 3.0
    found = [operational_modes(answered([(f, zeta), (1700.0, 0.02)], duration, seed, together=together), RATE,
                               band=(1000.0, 2100.0), modes=2) for seed in range(25)]  # fmt: skip
    values, errors = (
        np.array([getattr(each, name)[0] for each in found]) for name in ("damping_ratio", "damping_error")
    )
    bound = zeta * (2.0 * np.pi * zeta * f * duration) ** -0.5
    assert np.sqrt(np.mean((values - zeta) ** 2)) < 1.4 * bound
    assert abs(np.mean(values) - zeta) < 0.5 * bound
    assert np.count_nonzero(np.abs(values - zeta) < errors) >= 21  # of 24 expected; fewer once in 30 tries
    assert np.mean(errors) < 1.96 * 1.4 * bound  # the twin: not by errors that are too wide


def test_as_many_modes_as_there_are():
    counts = [operational_modes(answered(modes, 3.0, 1), RATE, band=(1000.0, 2100.0)).frequency.size
              for modes in ([(1300.0, 0.01)], [(1300.0, 0.01), (1400.0, 0.02)])]  # fmt: skip
    assert counts == [1, 2]
    flat = [operational_modes(np.random.default_rng(seed).standard_normal(16000), RATE, band=(1000.0, 2100.0))
            for seed in range(5)]  # fmt: skip
    assert {str(each.outcome) for each in flat} == {"no_mode"}


def test_a_record_too_short_says_so():
    found = operational_modes(answered([(1300.0, 0.002)], 0.3, 0), RATE, band=(1000.0, 1600.0), modes=1)
    assert "time constants of the mode at 13" in found.summary()
    with pytest.raises(SignalError, match="holds 16 lines"):
        operational_modes(answered([(1300.0, 0.002)], 0.3, 0), RATE, band=(1290.0, 1340.0))
    with pytest.raises(SignalError, match="expected 0 < low < high < 4000 Hz"):
        operational_modes(np.ones(100), RATE, band=(1000.0, 5000.0))


def test_the_onset_the_damping_points_to():
    """Growth rate -90 + 20 x: zero at 4.5."""
    places = np.array([1.0, 1.5, 2.0, 2.5, 3.0])
    found = [
        operational_modes(
            answered([(1300.0, (90.0 - 20.0 * x) / (2.0 * np.pi * 1300.0)), (1700.0, 0.03)], 5.0, i), RATE,
            band=(1000.0, 2100.0), modes=2,
        ) for i, x in enumerate(places)
    ]  # fmt: skip
    onset = damping_onset(found[::-1], places[::-1], near=1310.0, name="pressure")
    assert onset.outcome.ok
    assert onset.low < 4.5 < onset.high
    assert onset.high - onset.low < 2.0
    assert np.all(np.abs(onset.frequency - 1300.0) < 5.0)
    assert "lies 0.7" in onset.caution or "times the measured range" in onset.caution
    steady = damping_onset([found[0]] * 3, [1.0, 2.0, 3.0])  # the twin: the same damping thrice
    assert steady.outcome == "no_onset"
    with pytest.raises(SignalError, match="three or more"):
        damping_onset(found[:2], [1.0, 2.0])


def test_a_sone_is_a_tone_of_40_decibels():
    """ISO 532-1: a tone of 1 kHz at 40 dB is 1 sone, and each 10 dB double it; a full swing at 70 Hz is 1 asper."""
    t = np.arange(24000) / 48000.0

    def tone(level, swing=0.0):
        return 20e-6 * 10.0 ** (level / 20.0) * np.sqrt(2.0) * np.sin(2e3 * np.pi * t) * (1.0 + swing)

    quiet, loud = (sound_quality(tone(level), 48000.0) for level in (40.0, 60.0))
    assert float(quiet.loudness) == pytest.approx(1.0, rel=0.05)
    assert float(loud.loudness) == pytest.approx(4.0, rel=0.05)
    assert float(loud.sharpness) == pytest.approx(1.0, rel=0.05)
    assert float(loud.roughness) < 0.01
    assert float(sound_quality(tone(60.0, np.sin(140.0 * np.pi * t)), 48000.0).roughness) == pytest.approx(1.0, rel=0.1)
    with pytest.raises(SignalError, match=r"expected 0.2 s or more"):
        sound_quality(tone(60.0)[:2000], 48000.0)
