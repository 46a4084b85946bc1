"""Signals with closed-form answers: each estimator against the number put in, and a twin that must fail."""

from fractions import Fraction

import numpy as np
import pytest
from scipy.io import wavfile
from scipy.signal import butter, find_peaks, get_window, lfilter, resample_poly

from squealbox import DrumBrake, LinearSlope, simulate
from squealbox.signals import (
    SignalError,
    dominant_frequency,
    growth_rate,
    peaks,
    rendered,
    samples,
    slope,
    sound,
    sound_level,
    spectrogram,
    spectrum,
)
from squealbox.signals.spectra import tops
from squealbox.signals.wav import resampled

RATE = 100e3
T = np.arange(4000) / RATE
BIN = RATE / T.size


def sine(frequency, amplitude=1.0, phase=0.3, growth=0.0, t=T):
    return amplitude * np.exp(growth * t) * np.sin(2.0 * np.pi * frequency * t + phase)


class Motion:
    def __init__(self, t, q, names=("x", "y")):
        self.t, self.q, self.system = t, q, type("System", (), {"names": names})


def test_a_line_has_the_height_of_its_sinusoid_and_the_mean_is_apart():
    found = spectrum(3.0 + sine(80 * BIN, 2.0), T)
    # On a frequency of the grid Hann's transform has no leakage: rounding only.
    assert np.max(found.amplitude) == pytest.approx(2.0, rel=1e-12)
    assert found.mean == pytest.approx(3.0, rel=1e-12)
    assert found.amplitude[0] == pytest.approx(0.0, abs=1e-12)
    # The top of a flat-top window ripples by 0.01 dB, or 0.1 %.
    assert np.max(spectrum(sine(80 * BIN, 2.0), T, window="flattop").amplitude) == pytest.approx(2.0, rel=1e-3)


def test_what_a_window_resolves_is_stated():
    hann, boxcar = spectrum(sine(2000.0), T), spectrum(sine(2000.0), T, window="boxcar", pad=1)
    assert (hann.window, boxcar.window) == ("hann", "boxcar")
    assert hann.resolution == boxcar.resolution == pytest.approx(25.0)
    assert hann.angular_resolution == pytest.approx(50.0 * np.pi)
    # Equivalent noise bandwidths of textbooks (Harris 1978): 1.5 bins and 1 bin; exact for periodic windows.
    assert hann.noise_bandwidth == pytest.approx(1.5 * BIN, rel=1e-12)
    assert boxcar.noise_bandwidth == pytest.approx(BIN, rel=1e-12)
    # The paper's 0.05 s resolve 126 rad/s.
    assert spectrum(np.ones(5000) + sine(2e3, t=np.arange(5000) / RATE), rate=RATE).angular_resolution == pytest.approx(
        2.0 * np.pi / 0.05
    )


@pytest.mark.parametrize("shift", np.linspace(0.0, 1.0, 11))
def test_peak_between_the_grid_is_found_and_the_grid_alone_is_not_enough(shift):
    frequency = (80 + shift) * BIN
    found = spectrum(sine(frequency), T)
    line = peaks(found)
    # The parabola through a Hann line padded four times misses by less than 2e-4 of a resolution (measured).
    assert line.frequency.size == 1
    assert line.frequency[0] == pytest.approx(frequency, abs=4e-4 * BIN)
    assert line.amplitude[0] == pytest.approx(1.0, rel=2e-4)
    if shift == 0.5:
        coarse = spectrum(sine(frequency), T, pad=1)
        assert abs(coarse.frequency[np.argmax(coarse.amplitude)] - frequency) > 0.4 * BIN


def test_side_lobes_are_no_lines_and_two_lines_are_two():
    one = spectrum(sine(2013.0), T)
    assert peaks(one, least=1e-4).frequency.size == 1
    assert len(find_peaks(one.amplitude, height=1e-4 * one.amplitude.max())[0]) > 10  # the twin: lobes are there
    two = peaks(spectrum(sine(2013.0) + sine(2613.0, 0.1), T))
    assert two.frequency == pytest.approx([2013.0, 2613.0], abs=0.01 * BIN)
    assert two.amplitude == pytest.approx([1.0, 0.1], rel=1e-2)
    assert peaks(spectrum(sine(2013.0) + sine(2023.0), T)).frequency.size == 1  # closer than the resolution


@pytest.mark.parametrize("growth", [-300.0, 0.0, 80.0, 700.0])
def test_frequency_and_growth_rate_of_one_exponential(growth):
    x = 1e-4 + sine(2067.7, 1e-5, growth=growth)
    # What is left is the mirror line at -f: worst at 700 1/s, where only the last 3 periods count. A bin is 1.2 %.
    assert dominant_frequency(x, T) == pytest.approx(2067.7, rel=3e-6)
    found = growth_rate(x, T)
    assert found.rate == pytest.approx(growth, rel=1e-4, abs=1e-3)
    assert found.frequency == pytest.approx(2067.7, rel=1e-6)
    assert found.rate_error < 0.05


def test_two_tones_that_beat_do_not_disturb_each_other():
    t = np.arange(5000) / RATE
    beating = sine(2000.0, t=t, growth=-40.0) + sine(2089.0, 0.8, t=t, growth=-40.0)
    for frequency in (2000.0, 2089.0):  # 4.5 resolutions apart; fitted together, what is left is rounding
        found = growth_rate(beating, t, frequency=frequency)
        assert found.rate == pytest.approx(-40.0, abs=1e-6)
        assert found.frequency == pytest.approx(frequency, abs=1e-6)


@pytest.mark.parametrize(("true", "noise"), [(-20.0, 1e-4), (-50.0, 1e-3), (-100.0, 1e-2)])
def test_a_ring_down_with_noise(true, noise):
    t = np.arange(44100) / 44100.0
    x = np.exp(true * t) * np.sin(2 * np.pi * 1723.4567 * t) + noise * np.random.default_rng(0).standard_normal(t.size)
    found = growth_rate(x, t)
    # Cramer and Rao for a decay that ends in the record: sd = 4 |g|^1.5 (s/A)/sqrt(fs).
    bound = 4.0 * abs(true) ** 1.5 * noise / np.sqrt(44100.0)
    assert found.rate_error == pytest.approx(1.96 * bound, rel=0.05)
    assert abs(found.rate - true) < 3.0 * bound
    assert abs(found.frequency - 1723.4567) < 3.0 * bound / (2.0 * np.pi)


def test_an_envelope_that_is_no_exponential_has_no_growth_rate_and_says_so():
    t = np.arange(9600) / 48000.0
    burst = np.sin(2 * np.pi * 2000.0 * t) / (1.0 + np.exp(-100.0 * (t - 0.1)))  # grows, then stays
    found = growth_rate(burst + 1e-3 * np.random.default_rng(2).standard_normal(t.size), t)
    assert not found.steady
    assert found.rate_error > 5.0
    assert "not one rate" in str(found)
    assert growth_rate(sine(2000.0, growth=-40.0, t=t), t).steady  # the twin


@pytest.mark.parametrize("cycles", [0.5, 1.0, 1.5])
def test_less_than_two_cycles_are_no_frequency(cycles):
    t = np.linspace(0.0, 10.0, 10001)
    with pytest.raises(SignalError, match="cycles of its motion: it cannot tell"):
        dominant_frequency(np.sin(2 * np.pi * cycles / 10.0 * t + 0.4), t)
    assert dominant_frequency(np.sin(2 * np.pi * 0.25 * t + 0.4), t) == pytest.approx(0.25, rel=1e-9)


@pytest.mark.parametrize("seed", range(12))
def test_noise_alone_has_no_frequency(seed):
    with pytest.raises(SignalError, match="nothing stands above the noise"):  # once in 10^4 records it may
        dominant_frequency(np.random.default_rng(seed).standard_normal(4800), rate=48000.0)


@pytest.mark.parametrize("colour", [0.0, 0.9])
def test_errors_are_those_of_cramer_and_rao(colour):
    count, rate, noise, trials = 1200, 48000.0, 0.2, 120
    t = np.arange(count) / rate
    gain = np.abs(1.0 - colour * np.exp(-2j * np.pi * 2000.0 / rate))  # the noise at 2 kHz is `noise` as if white
    bound = np.sqrt(24.0 / count) * noise / t[-1]
    misses, covered = [], 0
    for seed in range(trials):
        rng = np.random.default_rng(seed)
        hiss = gain * noise * lfilter([1.0], [1.0, -colour], rng.standard_normal(count + 200))[200:]
        found = growth_rate(np.cos(2 * np.pi * 2000.0 * t + rng.uniform(0.0, 6.28)) + hiss, t)
        misses.append(found.rate)
        covered += abs(found.rate) <= found.rate_error
    # 120 draws tell a root mean square to 6.5 %, a share of 95 % to 2 %: three of them each.
    assert np.sqrt(np.mean(np.square(misses))) < 1.2 * bound
    assert covered / trials >= 0.89


def test_slope_of_a_line_is_exact_and_of_two_points_is_unsure():
    t = np.linspace(0.0, 1.0, 20)
    assert slope(t, 2.0 - 3.0 * t)[0] == pytest.approx(-3.0, rel=1e-12)
    assert slope(t[:2], t[:2])[1] == np.inf


def test_spectrogram_follows_a_sweep():
    t = np.arange(20000) / RATE
    grid = spectrogram(np.sin(2.0 * np.pi * (1000.0 * t + 0.5 * 5000.0 * t**2)), t, segment=0.02)
    ridge = grid.frequency[np.argmax(grid.amplitude, axis=0)]
    # A quarter of the resolution is the step of the frequency grid.
    assert np.max(np.abs(ridge - (1000.0 + 5000.0 * grid.time))) <= 0.26 * grid.resolution
    steady = spectrogram(sine(2000.0, 0.7), T, segment=0.01)
    assert np.max(steady.amplitude, axis=0) == pytest.approx(0.7, rel=1e-9)


def test_sound_has_true_pitch_and_does_not_clip(tmp_path):
    t = np.arange(100_000) / RATE
    path = sound(1e-4 + sine(2067.7, 1e-4, t=t, growth=-1.0) + sine(30e3, 1e-4, t=t), tmp_path / "a.wav", t)
    sampling, wave = wavfile.read(path)
    assert (sampling, wave.dtype, wave.ndim) == (44100, np.int16, 1)
    assert np.max(np.abs(wave.astype(int))) == round(0.9 * 32767)
    assert wave[0] == wave[-1] == 0
    heard = spectrum(wave.astype(float), rate=sampling)
    assert peaks(heard, 1).frequency[0] == pytest.approx(2067.7, rel=1e-6)
    # 30 kHz cannot be written at 44.1 kHz: left in, it would be heard at 14.1 kHz.
    alias = np.abs(heard.frequency - (44100 - 30e3)) < 100.0
    assert np.max(heard.amplitude[alias]) < 1e-2 * np.max(heard.amplitude)
    _, low = wavfile.read(sound(sine(2000.0, t=t), tmp_path / "b.wav", t, slower=2.0))
    assert low.size == pytest.approx(2 * 44100, abs=2)
    assert dominant_frequency(low.astype(float), rate=44100.0) == pytest.approx(1000.0, rel=1e-6)


def test_two_sounds_of_one_loudest_value_keep_their_ratio(tmp_path):
    loud, quiet = sine(2000.0, 3e-6), sine(2000.0, 1e-6)
    waves = [wavfile.read(sound(x, tmp_path / f"{i}.wav", T, loudest=3e-6))[1] for i, x in enumerate((loud, quiet))]
    peaks_ = [float(np.max(np.abs(wave.astype(float)))) for wave in waves]
    assert peaks_[1] / peaks_[0] == pytest.approx(1.0 / 3.0, abs=1e-4)  # a sample is a whole number of 32767
    assert peaks_[0] == pytest.approx(0.9 * 32767, rel=5e-3)  # the filter overshoots at the ends
    with pytest.raises(SignalError, match="loudest"):
        sound(loud, tmp_path / "clips.wav", T, loudest=2e-6)


def test_a_sound_fades_in_and_out(tmp_path):
    _, wave = wavfile.read(sound(sine(2000.0), tmp_path / "faded.wav", T, fade=0.01))
    _, hard = wavfile.read(sound(sine(2000.0), tmp_path / "hard.wav", T, fade=0.0))
    first = slice(0, 44)  # the first millisecond: the fade of 10 ms is at sin^2(9 deg) = 2.4 % there
    assert np.max(np.abs(wave[first].astype(int))) < 0.03 * 32767 < np.max(np.abs(hard[first].astype(int)))
    assert np.array_equal(np.abs(wave[-44:].astype(int)) < 0.03 * 32767, np.ones(44, dtype=bool))


def test_a_trajectory_is_taken_by_index_and_by_name():
    motion = Motion(T, np.column_stack([sine(2000.0), sine(3000.0)]))
    assert peaks(spectrum(motion, dof="y"), 1).frequency[0] == pytest.approx(3000.0, abs=0.01)
    assert peaks(spectrum(motion, dof=0, begin=0.01, end=0.03), 1).frequency[0] == pytest.approx(2000.0, abs=0.1)
    assert samples(motion, begin=0.01, end=0.03).t[[0, -1]] == pytest.approx([0.01, 0.03])


@pytest.mark.parametrize(
    ("signal", "keywords", "words"),
    [
        (sine(2000.0), {"t": T**1.1}, "not equally spaced: steps from .* expected equal steps, such as simulate"),
        (sine(2000.0), {}, "t is missing and rate = None"),
        (sine(2000.0), {"rate": -1.0}, "rate = -1.0: expected"),
        (np.r_[sine(2000.0)[:-1], np.nan], {"t": T}, "sample 3999 is not finite"),
        (sine(2000.0), {"t": T[:-1]}, "one value for each time"),
        (sine(2000.0), {"t": T[::-1]}, "do not increase"),
        (sine(2000.0), {"t": T, "begin": 0.04}, "has 0 samples from 0.04 s: expected 8 or more"),
        (Motion(T, np.zeros((T.size, 2))), {"dof": 2}, "dof = 2: expected an index from 0 to 1"),
        (Motion(T, np.zeros((T.size, 2))), {"dof": "z"}, "dof = 'z': expected one of x, y"),
    ],
)
def test_bad_signals_are_refused_in_one_sentence(signal, keywords, words):
    with pytest.raises(SignalError, match=words):
        spectrum(signal, **keywords)


def test_nothing_is_made_of_nothing(tmp_path):
    still = np.full(T.size, 2.0)
    with pytest.raises(SignalError, match="it has no frequency"):
        dominant_frequency(still, T)
    with pytest.raises(SignalError, match="nothing to hear"):
        sound(still, tmp_path / "still.wav", T)
    with pytest.raises(SignalError, match="holds 1 cycles of its motion"):
        growth_rate(sine(25.0), T)
    assert growth_rate(sine(100.0, growth=3.0), T).rate == pytest.approx(3.0, abs=1e-6)  # four cycles are enough
    with pytest.raises(SignalError, match=r"expected 8e-05 s to 0\.04 s"):
        spectrogram(sine(2000.0), T, segment=1.0)
    with pytest.raises(SignalError, match="level = 2"):
        sound(sine(2000.0), tmp_path / "loud.wav", T, level=2.0)


@pytest.mark.parametrize("count", [1, 2, 7, 512])
def test_the_usual_window_is_that_of_scipy(count):
    from squealbox.signals.spectra import window_weights

    assert window_weights("hann", count) == pytest.approx(get_window("hann", count), abs=1e-15)
    assert window_weights("flattop", count).tolist() == get_window("flattop", count).tolist()


def test_results_are_saved_and_read_back(tmp_path):
    for result in (spectrum(sine(2000.0), T), spectrogram(sine(2000.0), T), growth_rate(sine(2000.0), T)):
        back = type(result).load(result.save(tmp_path / f"{type(result).__name__}.nc"))
        assert back.amplitude.tolist() == result.amplitude.tolist() if hasattr(result, "amplitude") else back.rate
        assert back.settings == result.settings


@pytest.mark.parametrize(
    ("ahead", "back"),
    [butter(2, 2000.0, fs=48e3), butter(4, 8000.0, fs=48e3), butter(2, 5000.0, "high", fs=48e3),
     ([1.0], [1.0, -1.8 * np.cos(0.8), 0.81])],
    ids=["low pass", "steep low pass", "high pass", "resonance"],
)  # fmt: skip
def test_errors_in_noise_of_any_colour_are_those_of_its_density_at_the_tone(ahead, back):
    """sd(g) = sqrt(24/n) s/(A T) with the density of the noise at the tone; a hill of the noise is no component."""
    rate, count, tone = 48e3, 4800, 3111.7
    t, turn = np.arange(count) / rate, np.exp(-2j * np.pi * tone / rate)
    gain = abs(np.polyval(ahead[::-1], turn) / np.polyval(back[::-1], turn))
    sd = np.sqrt(24.0 / count) * 0.1 / (count / rate)
    away = []
    for seed in range(10):
        noise = lfilter(ahead, back, np.random.default_rng(seed).standard_normal(count + 2000))[2000:]
        x = np.cos(2 * np.pi * tone * t + seed) + 0.1 / gain * noise
        found = growth_rate(x, rate=rate)
        assert found.steady
        assert found.rate_error == pytest.approx(1.96 * sd, rel=0.25)  # 100 lines tell a density to 10 %
        away.append(found.rate / sd)
    assert np.sqrt(np.mean(np.square(away))) < 1.7  # of ten, 2e-4


@pytest.mark.parametrize("apart", [1, 4, 20])
@pytest.mark.parametrize("steps", [1e-9, 0.1], ids=["no plateaus", "plateaus"])
@pytest.mark.parametrize("count", [3, 50, 2000])
def test_maxima_are_those_of_scipy(count, steps, apart):
    noise = np.random.default_rng(count).normal(size=count + 6)
    x = np.round(np.convolve(noise, np.ones(7), "valid") / steps) * steps
    for least in (-2.0, 0.0, 2.0):
        expected, _ = find_peaks(x, height=least, distance=apart, prominence=0.7)
        if steps < 0.1 or apart == 1:  # of neighbours of one height either may go
            np.testing.assert_array_equal(tops(x, least, apart, 0.7), expected)
        assert tops(x, least, apart, 0.7).size == pytest.approx(expected.size, abs=0.1 * expected.size)


@pytest.mark.parametrize("ratio", [Fraction(1), Fraction(3, 2), Fraction(2, 3), Fraction(147, 160), Fraction(10, 77)])
def test_another_rate_is_that_of_scipy(ratio):
    x = np.random.default_rng(0).normal(size=1003)
    expected = resample_poly(x, ratio.numerator, ratio.denominator)
    np.testing.assert_allclose(resampled(x, ratio), expected, atol=1e-13)  # rounding of 20 terms each


def test_what_can_carry_no_caution_refuses_instants_too_few_for_the_motion():
    """A squeal of 2.03 kHz kept 580 times a second has no frequency, no growth, no level and no sound."""
    brake = DrumBrake(friction=LinearSlope(0.45, -0.05))
    few, enough = (simulate(brake, 0.05, times=count) for count in (30, 3001))
    for answer in (growth_rate, dominant_frequency, sound_level, rendered):
        with pytest.raises(SignalError, match="580 a second, are too few"):
            answer(few)
        answer(enough)
