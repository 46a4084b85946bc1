"""Recordings read right or refused in a sentence, and the squeal events in stops whose truth is known."""

import numpy as np
import pytest
from scipy.signal import lfilter

from squealbox.signals import (
    SignalError,
    a_weighting,
    growth_rate,
    noise_matrix,
    read_recording,
    rendered,
    squeal_events,
)
from squealbox.signals.recordings import Recording

RATE = 48000.0
LENGTH = 2048  # samples of a frame at 48 kHz
HANN = np.sin(np.pi * np.arange(LENGTH) / LENGTH) ** 2
HOP = 512 / RATE


def tone(t, frequency, amplitude, begin, end, growth=2000.0, decay=2000.0):
    envelope = np.exp(growth * np.minimum(t - begin, 0.0) - decay * np.maximum(t - end, 0.0))
    return amplitude * envelope * np.sin(2.0 * np.pi * frequency * t)


def in_the_bin(decibel, sigma):
    """Amplitude of a tone `decibel` above white noise of deviation `sigma` in its line of the transform."""
    return np.sqrt(2.0 * 2.0 * sigma**2 * np.sum(HANN**2) / np.sum(HANN) ** 2 * 10.0 ** (decibel / 10.0))


# --- reading ------------------------------------------------------------------------------------------------------


def test_every_kind_of_file_holds_the_same_samples(tmp_path):
    soundfile, pyuff = pytest.importorskip("soundfile"), pytest.importorskip("pyuff")
    t = np.arange(4800) / RATE
    x = (
        np.round(np.column_stack([0.5 * np.sin(2 * np.pi * 3000.0 * t), 0.1 * np.cos(2 * np.pi * 500.0 * t)]) * 2**20)
        / 2**20
    )
    soundfile.write(tmp_path / "a.wav", x, int(RATE), subtype="PCM_24")
    soundfile.write(tmp_path / "a.flac", x, int(RATE), subtype="PCM_24")
    np.save(tmp_path / "a.npy", x)
    np.savetxt(tmp_path / "a.csv", np.column_stack([t, x]), delimiter=",", header="t [s],mic [Pa],acc [g]", comments="")
    file = pyuff.UFF(str(tmp_path / "a.uff"))
    for i in range(2):
        file.write_sets(pyuff.prepare_58(
            binary=0, func_type=1, rsp_node=1, rsp_dir=1, ref_dir=1, ref_node=1, data=x[:, i], x=t, id1=f"c{i}",
            rsp_ent_name="b", ref_ent_name="b", abscissa_spacing=1, abscissa_spec_data_type=17,
            ordinate_spec_data_type=12, orddenom_spec_data_type=13,
        ), mode="add")  # fmt: skip
    for name in ("a.wav", "a.flac", "a.npy", "a.csv", "a.uff"):
        found = read_recording(tmp_path / name, rate=RATE if name == "a.npy" else None)
        assert found.rate == pytest.approx(RATE, rel=1e-9), name
        # 24 bits round to 6e-8 of full scale; UFF keeps 13 digits.
        assert np.allclose(found.samples, x, atol=2e-7, rtol=0.0), name
    named = read_recording(tmp_path / "a.csv")
    assert (named.names, named.units) == (("mic", "acc"), ("Pa", "g"))
    assert named.calibrated("mic")
    assert not named.calibrated("acc")
    loud = read_recording(tmp_path / "a.wav", unit="Pa", full_scale=[20.0, 10.0])
    assert np.allclose(loud.samples, x * [20.0, 10.0], atol=4e-6)
    assert not loud.notes
    assert "no calibration" in read_recording(tmp_path / "a.wav").notes[0]


def test_what_is_wrong_with_a_recording_is_said_in_a_sentence(tmp_path):
    soundfile = pytest.importorskip("soundfile")
    t = np.arange(4800) / RATE
    wave = np.sin(2 * np.pi * 3000.0 * t)
    soundfile.write(tmp_path / "clipped.wav", np.clip(3.0 * wave, -1.0, 1.0), int(RATE))
    assert any("clipped" in note for note in read_recording(tmp_path / "clipped.wav").notes)
    soundfile.write(tmp_path / "eight.wav", wave, int(RATE), subtype="PCM_U8")
    assert any("8 bits" in note for note in read_recording(tmp_path / "eight.wav").notes)
    cases = {
        "nan.csv": (
            "t,x\n" + "\n".join(f"{i},{'nan' if i == 9 else i}" for i in range(20)),
            "sample 9 of channel 1 is nan",
        ),
        "uneven.csv": ("t,x\n" + "\n".join(f"{i * i},{i}" for i in range(20)), "not equally spaced"),
        "words.csv": ("t,x\n1,2\n2,two\n", "'two' is not a number"),
        "rateless.csv": ("\n".join("1,2" for _ in range(20)), "has no column of times"),
        "empty.wav": ("", "not a sound file"),
        "text.wav": ("hello", "not a sound file"),
        "text.uff": ("hello", "UFF file|holds no time response"),
        "text.npy": ("hello", "has no sampling rate"),
    }
    for name, (text, words) in cases.items():
        (tmp_path / name).write_text(text)
        with pytest.raises(SignalError, match=words):
            read_recording(tmp_path / name)
    with pytest.raises(SignalError, match="cannot be read"):
        read_recording(tmp_path / "missing.wav")


@pytest.mark.parametrize(
    ("rate", "digits"), [(44100.0, "%.6f"), (44100.0, "%.8g"), (8000.0, "%.5f"), (51200.0, "%.9e")]
)
def test_times_are_judged_by_the_digits_they_are_written_with(rate, digits, tmp_path):
    t = 0.25 + np.arange(60000) / rate
    kept = np.arange(t.size) != 31000  # the twin: one sample is lost
    for name, chosen in (("whole.csv", t), ("lost.csv", t[kept])):
        np.savetxt(tmp_path / name, np.column_stack([chosen, np.sin(chosen)]), fmt=digits, delimiter=",",
                   header="t [s],x", comments="")  # fmt: skip
    assert read_recording(tmp_path / "whole.csv").rate == pytest.approx(rate, rel=1e-6)
    with pytest.raises(SignalError, match=r"not equally spaced.* but after \d\.\d+ s comes"):
        read_recording(tmp_path / "lost.csv")
    (tmp_path / "coarse.csv").write_text("t,x\n" + "\n".join(f"{each:.4f},1" for each in t[:2000]))
    with pytest.raises(SignalError, match="the times are written to 0.0001 s"):
        read_recording(tmp_path / "coarse.csv")


@pytest.mark.parametrize("ending", [".wav", ".flac", ".csv", ".npy", ".uff"])
def test_damaged_files_get_a_sentence(ending, tmp_path):
    soundfile = pytest.importorskip("soundfile")
    rng = np.random.default_rng(5)
    x = rng.standard_normal(600)
    whole = tmp_path / f"whole{ending}"
    if ending in (".wav", ".flac"):
        soundfile.write(whole, 0.1 * x, 8000)
    elif ending == ".npy":
        np.save(whole, x)
    else:
        whole.write_text("    -1\n    58\nrun\n" + "\n".join(f"{i / 8000},{v}" for i, v in enumerate(x)))
    good = whole.read_bytes()
    for trial in range(40):
        bad = bytearray(good)
        if trial % 3 == 0:
            bad = bad[: rng.integers(0, len(bad))]
        else:
            for place in rng.integers(0, min(len(bad), 200 if trial % 2 else len(bad)), size=8):
                bad[place] = rng.integers(256)
        path = tmp_path / f"{trial}{ending}"
        path.write_bytes(bytes(bad))
        said = ""
        try:
            assert read_recording(path, rate=8000.0).samples.size <= 512 * len(good)
        except SignalError as error:
            said = str(error)
        assert "\n" not in said


# --- events -------------------------------------------------------------------------------------------------------


def test_events_of_a_stop_with_a_known_truth():
    t = np.arange(int(6 * RATE)) / RATE
    truth = [(2500.0, 0.5, 1.0, 2.0), (4000.0, 0.3, 3.0, 3.9), (4100.0, 0.3, 3.2, 3.7), (8000.4, 0.2, 4.5, 5.0)]
    x = sum(tone(t, *each) for each in truth) + 0.01 * np.random.default_rng(0).standard_normal(t.size)
    found = squeal_events(x, RATE)
    assert found.count == 4
    for i, (frequency, amplitude, begin, end) in enumerate(truth):
        assert found.frequency[i] == pytest.approx(frequency, abs=0.5)
        assert abs(found.onset[i] - begin) <= 2 * HOP
        assert abs(found.end[i] - end) <= 2 * HOP
        level = 20.0 * np.log10(amplitude / np.sqrt(2.0) / 20e-6 * float(a_weighting(frequency)))
        assert found.level[i] == pytest.approx(level, abs=0.05)
    assert found.occurrence == pytest.approx((1.0 + 0.9 + 0.5) / 6.0, abs=0.01)
    assert squeal_events(x, RATE, least_level=84.0).count == 1  # the twins: a threshold, and a band
    assert squeal_events(x, RATE, band=(5000.0, 16000.0)).count == 1
    assert squeal_events(0.0 * x + 1e-9, RATE).outcome == "no_event"


@pytest.mark.parametrize("harmonic", [2, 3])
def test_a_harmonic_of_a_louder_tone_below_the_band_is_told_as_one(harmonic):
    t = np.arange(int(2 * RATE)) / RATE
    hiss = 0.001 * np.random.default_rng(0).standard_normal(t.size)
    over = tone(t, harmonic * 1450.0, 0.15, 0.5, 1.5) + hiss
    (note,) = squeal_events(over + tone(t, 1450.0, 0.5, 0.5, 1.5), RATE).settings["notes"]
    assert f"at 1450 Hz, of which the event at {harmonic * 1450} Hz is harmonic {harmonic}" in note
    assert not squeal_events(over, RATE).settings[
        "notes"
    ]  # the twins: no such tone, a quieter one, a band that holds it
    assert not squeal_events(over + tone(t, 1450.0, 0.02, 0.5, 1.5), RATE).settings["notes"]
    assert not squeal_events(over + tone(t, 1450.0, 0.5, 0.5, 1.5), RATE, band=(1000.0, 16e3)).settings["notes"]
    (alone,) = squeal_events(hiss + tone(t, 1450.0, 0.5, 0.5, 1.5), RATE).settings["notes"]
    assert alone == "a tone stands below the band, at 1450 Hz: a band from 1000 Hz holds it"


def test_growth_and_decay_of_an_event_are_those_put_in():
    t = np.arange(int(1.5 * RATE)) / RATE
    held = 0
    for seed in range(8):
        x = tone(t, 3000.0, 0.5, 0.6, 1.0, growth=300.0, decay=150.0)
        found = squeal_events(x + 2e-3 * np.random.default_rng(seed).standard_normal(t.size), RATE)
        assert found.growth_rate[0] == pytest.approx(300.0, rel=0.03)
        assert found.decay_rate[0] == pytest.approx(-150.0, rel=0.03)
        held += abs(found.growth_rate[0] - 300.0) <= found.growth_error[0]
        held += abs(found.decay_rate[0] + 150.0) <= found.decay_error[0]
    assert held >= 12


@pytest.mark.parametrize(("decibel", "least"), [(15.0, 12), (13.0, 11)])
def test_quiet_events_are_found(decibel, least):
    t = np.arange(int(1.5 * RATE)) / RATE
    amplitude, found = in_the_bin(decibel, 0.1), 0
    for seed in range(12):
        rng = np.random.default_rng(seed)
        frequency, begin = rng.uniform(2200.0, 15000.0), rng.uniform(0.2, 0.6)
        x = 0.1 * rng.standard_normal(t.size) + amplitude * np.sin(2 * np.pi * frequency * t) * (
            (t > begin) & (t < begin + 0.7)
        )
        events = squeal_events(x, RATE, least_level=None)
        near = np.abs(events.frequency - frequency) < 30.0
        found += bool(np.any(near))
        if decibel >= 15.0:
            assert abs(events.onset[near][0] - begin) <= 2 * HOP + 1e-9
        assert events.count == np.count_nonzero(near)
    assert found >= least


def test_noise_is_no_squeal():
    for seed in range(3):
        x = np.random.default_rng(seed).standard_normal(int(20 * RATE))
        assert squeal_events(x, RATE, least_level=None).count == 0


@pytest.mark.parametrize(
    "loudness",
    [lambda t: 1.0 - 0.98 * t / 6.0, lambda t: np.exp(-t), lambda t: 1.0 + 20.0 * (t % 1.0 < 0.02),
     lambda t: 1.0 + 3.0 * (t % 2.0 < 0.2), lambda t: 1.0 + 0.9 * np.sin(2 * np.pi * 5.0 * t)],
    ids=["falls", "dies away", "knocks", "bursts", "beats"],
)  # fmt: skip
def test_noise_whose_loudness_changes_is_no_squeal(loudness):
    """A brake's noise falls with its speed; the tone in it is still found."""
    t = np.arange(int(6 * RATE)) / RATE
    noise = loudness(t) * lfilter([1.0], [1.0, -0.7], np.random.default_rng(1).standard_normal(t.size))
    assert squeal_events(noise, RATE, least_level=None).count == 0
    found = squeal_events(noise + tone(t, 4321.0, 1.0, 2.5, 4.0), RATE, least_level=None)
    assert found.frequency == pytest.approx([4321.0], abs=1.0)


def test_a_faint_tone_beside_a_loud_one_keeps_its_own_frequency():
    t = np.arange(int(1.5 * RATE)) / RATE
    on = (t > 0.4) & (t < 1.1)
    for seed in range(6):
        rng = np.random.default_rng(seed)
        f, share = rng.uniform(2100.0, 14000.0), rng.uniform(0.1, 0.2)
        x = on * (np.sin(2 * np.pi * f * t) + share * np.sin(2 * np.pi * (f + 100.0) * t + rng.uniform(0.0, 6.0)))
        found = squeal_events(x + 0.01 * rng.standard_normal(t.size), RATE, least_level=None)
        assert np.sort(found.frequency) == pytest.approx([f, f + 100.0], abs=0.5)
    far = tone(t, 2500.0, 1.0, 0.4, 1.1) + tone(t, 9000.0, 0.01, 0.5, 1.0)  # 40 dB apart
    found = squeal_events(far + 1e-4 * np.random.default_rng(0).standard_normal(t.size), RATE, least_level=None)
    assert np.sort(found.frequency) == pytest.approx([2500.0, 9000.0], abs=0.5)


def test_a_squeal_from_the_first_sample_to_the_last():
    t = np.arange(int(1.0 * RATE)) / RATE
    found = squeal_events(
        np.sin(2 * np.pi * 3000.0 * t) + 1e-3 * np.random.default_rng(0).standard_normal(t.size), RATE
    )
    assert (found.onset[0], found.end[0], found.occurrence) == (0.0, 1.0, 1.0)


def test_conditions_of_a_stop_are_means_over_its_own_time():
    speed = ([-1.0, 0.0, 0.5, 2.0], [20.0, 10.0, 5.0, 5.0])  # from 10 to 5 in half a second, then steady to its end
    sound = Recording(
        np.zeros(int(RATE)) + 1e-3, RATE, ("acc",), ("g",), {"speed": speed, "late": ([3.0, 4.0], [1.0, 1.0])}
    )
    found = squeal_events(sound)
    assert found.settings["stop"]["speed"] == pytest.approx(0.5 * 7.5 + 0.5 * 5.0)
    assert np.isnan(found.settings["stop"]["late"])
    assert found.settings["unit"] == "dB re 1 g"


def test_a_noise_matrix_is_what_a_hand_counts():
    t = np.arange(int(0.6 * RATE)) / RATE
    stops, hand = [], np.zeros((2, 2, 2))
    for i in range(24):
        speed, pressure, loud = 1.0 + i % 2, 10.0 + 10.0 * (i // 2 % 2), i % 3 == 0
        x = tone(t, 3100.0, 0.5 if loud else 0.0, 0.2, 0.4) + 1e-3 * np.random.default_rng(i).standard_normal(t.size)
        braking = {"speed": ([0.0, 0.6], [speed, speed]), "pressure": ([0.0, 0.6], [pressure, pressure])}
        stops.append(squeal_events(Recording(x, RATE, ("mic",), ("Pa",), braking)))
        hand[i % 2, i // 2 % 2] += [1, loud]
    found = noise_matrix(stops, x_edges=[0.5, 1.5, 2.5], y_edges=[5.0, 15.0, 25.0])
    assert np.array_equal(found.stops, hand[..., 0])
    assert np.array_equal(found.noisy, hand[..., 1])
    assert (found.total, found.total_noisy) == (24, 8)
    assert np.sum(found.histogram) == 8
    assert found.histogram[6] == 8  # 3000 to 3500 Hz
    with pytest.raises(SignalError, match="increasing"):
        noise_matrix(stops, x_edges=[1.0, 0.0])


def test_a_rendered_motion_is_heard_as_it_was():
    class Motion:
        t = np.arange(int(1.0 * 96000)) / 96000.0
        qd = tone(t, 2034.6, 0.05, 0.3, 0.8, growth=500.0, decay=400.0)[:, None]
        q = np.cumsum(qd, axis=0) / 96000.0

    sound = rendered(Motion(), noise=1e-4)
    found = squeal_events(sound)
    assert found.frequency[0] == pytest.approx(2034.6, abs=0.1)
    assert abs(found.growth_rate[0] - 500.0) <= max(2.0 * found.growth_error[0] / 1.96, 5.0)
    inside = (sound.t > 0.4) & (sound.t < 0.7)
    rms = np.sqrt(np.mean(sound.channel()[inside] ** 2))
    assert found.level[0] == pytest.approx(20.0 * np.log10(rms / 20e-6 * float(a_weighting(2034.6))), abs=0.1)
    assert growth_rate(sound.channel(), rate=sound.rate, begin=0.4, end=0.7).rate == pytest.approx(0.0, abs=0.1)
