"""`squealbox events`, `noise`, `damping`, `quality`, `calibrate`, `compare`: from a recording to a design file."""

import numpy as np
import pytest
import scipy.io.wavfile
from scipy.signal import lfilter

from squealbox import complex_modes, plots, squeal_events
from squealbox.files import read_design, read_file
from squealbox.signals import read_recording

BRAKE = """brake = "drum_brake"
friction = { law = "linear_slope", static = 0.36, slope = "-0.05 s/m" }
[recording]
file = "stop.csv"
unit = "Pa"
[calibrate.parameters]
k3 = ["150 kN/mm", "230 kN/mm"]
friction.static = [0.3, 0.42]
[[calibrate.measured]]
quantity = "growth_rate"
value = "536 1/s"
sd = "20 1/s"
[[calibrate.measured]]
quantity = "frequency"
value = "2078 Hz"
sd = "1 Hz"
mode = "unstable"
"""


@pytest.fixture
def stop(tmp_path):
    """A recording of one burst, the conditions of its stop, and a design file beside it."""
    t = np.arange(24000) / 24000.0
    x = np.exp(536.0 * np.minimum(t - 0.4, 0.0) - 200.0 * np.maximum(t - 0.7, 0.0)) * np.sin(2 * np.pi * 2078.0 * t)
    x = x + 1e-3 * np.random.default_rng(0).standard_normal(t.size)
    table = np.column_stack([t, x])
    np.savetxt(tmp_path / "stop.csv", table, delimiter=",", header="t [s],mic [Pa]", comments="", fmt="%.9g")
    braking = "\n".join(f"{0.1 * i},{10 - i},20" for i in range(11))
    (tmp_path / "stop.braking.csv").write_text(f"t,speed,pressure\n{braking}\n")
    (tmp_path / "brake.toml").write_text(BRAKE)
    return tmp_path


def test_events_and_noise(stop, said):
    code, out, err = said("events", str(stop / "stop.csv"), "--out", str(stop / "events.nc"))
    assert (code, err) == (0, "")
    assert "1 event in" in out
    assert "2078.0 Hz" in out
    assert (stop / "events.nc").exists()
    code, out, err = said("noise", str(stop))
    assert (code, err) == (0, "")
    assert "1 of 1 stops squeal" in out
    code, out, err = said("events", str(stop / "missing.wav"))
    assert (code, out) == (2, "")
    assert "cannot be read" in err


def test_calibrate_and_compare(stop, said):
    code, out, err = said("calibrate", str(stop / "brake.toml"), "--out", str(stop / "fitted.toml"))
    assert (code, err) == (0, "")
    assert "95 % interval" in out
    assert read_design(stop / "fitted.toml").k3 == pytest.approx(1.898e8, rel=2e-3)
    code, out, err = said("compare", str(stop / "brake.toml"))
    assert (code, err) == (0, "")
    assert "frequency" in out
    assert read_file(stop / "brake.toml").recording.unit == "Pa"


def test_compare_leaves_figures_and_both_spectrograms(stop, said):
    with (stop / "brake.toml").open("a") as file:
        file.write('\n[simulate]\nduration = "20 ms"\n')
    code, _, err = said("compare", str(stop / "brake.toml"), "--out", str(stop / "beside"))
    assert (code, err) == (0, "")
    names = {path.name for path in (stop / "beside").iterdir()}
    assert names == {f"{name}.{kind}" for name in ("modes", "motion") for kind in ("nc", "csv", "png", "svg")} | {
        "spectrograms.png", "spectrograms.svg"
    }  # fmt: skip
    found = read_file(stop / "brake.toml")
    sound = read_recording(stop / "stop.csv", unit="Pa")
    motion = found.simulate.run_closely(found.design.system())
    figure = plots.spectrograms_beside(motion, sound, squeal_events(sound))
    levels = [panel.collections[0] for panel in figure.axes[:2]]
    heights = [1e3 * levels[1].get_coordinates()[:, 0, 1], 1e3 * levels[0].get_coordinates()[:, 0, 1]]
    meshes = zip(heights, levels[::-1], strict=True)
    strongest = [float(height[np.argmax(np.max(mesh.get_array(), axis=1))]) for height, mesh in meshes]
    assert strongest[0] == pytest.approx(2078.0, abs=120.0)  # the recording's, to the resolution of pieces of 2.5 ms
    assert strongest[1] == pytest.approx(complex_modes(found.design).most_unstable.frequency, abs=250.0)


def test_compare_says_the_unit_of_the_level_and_takes_a_band(stop, said):
    """A recording without calibration has no dB(A), and squeal below the usual band can be asked for."""
    table = np.loadtxt(stop / "stop.csv", delimiter=",", skiprows=1)
    header = {"delimiter": ",", "header": "t [s],mic", "comments": "", "fmt": "%.9g"}
    np.savetxt(stop / "bare.csv", table, **header)
    (stop / "bare.toml").write_text(BRAKE.split("[recording]")[0])
    asked = "compare", str(stop / "bare.toml"), str(stop / "bare.csv"), "--unit", ""
    code, out, _ = said(*asked)
    assert code == 0
    assert "dB re full scale" in out
    assert "dB(A)" not in out
    code, _, err = said(*asked, "--band", "4kHz", "8kHz")
    assert (code, "no squeal between 4000 and 8000 Hz" in err) == (2, True)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"536 1/s"', '"536 kg"', "a mass"),
        ('sd = "1 Hz"', "sd = 0", "expected a finite number"),
        ('"growth_rate"', '"growth"', "unknown name 'growth'"),
        ('mode = "unstable"', 'mode = "loudest"', "place by frequency"),
        ("[0.3, 0.42]", "[0.42, 0.3]", "friction.static"),
        ('unit = "Pa"', "unit = 3", "a word in quotes"),
    ],
)
def test_what_is_wrong_in_the_sections_is_said(old, new, words, stop, said):
    (stop / "brake.toml").write_text(BRAKE.replace(old, new, 1))
    code, out, err = said("calibrate", str(stop / "brake.toml"))
    assert (code, out) == (2, "")
    assert words in err


def test_damping_and_quality(tmp_path, said):
    for pressure in (1.0, 2.0, 3.0):
        pole = np.exp((-80.0 + 20.0 * pressure + 2j * np.pi * 500.0) / 4000.0)
        push = np.random.default_rng(int(pressure)).standard_normal(12000)
        x = lfilter([0.0, pole.imag], [1.0, -2.0 * pole.real, abs(pole) ** 2], push)
        np.save(tmp_path / f"{pressure:.0f}.npy", x)
        rows = "\n".join(f"{time},{pressure}" for time in range(8))
        (tmp_path / f"{pressure:.0f}.braking.csv").write_text(f"t,pressure\n{rows}\n")
    files = [str(tmp_path / f"{i}.npy") for i in (1, 2, 3)]
    band = ("--rate", "4kHz", "--band", "300Hz", "700Hz")
    code, out, err = said("damping", *files, *band, "--against", "pressure")
    assert (code, err) == (0, "")
    assert "growth rate 0 at pressure = " in out
    code, out, err = said("damping", *files, *band, "--against", "speed")
    assert code == 2
    assert "the record has pressure" in err
    code, out, err = said("quality", files[0], "--rate", "4kHz", "--full-scale", "0.001")
    assert (code, err) == (0, "")
    assert "sone" in out


def test_low_squeal_has_the_hint_on_the_band_in_compare_as_in_events(said, tmp_path):
    """`events` named the band that holds a tone below it; `compare`, which has --band too, did not."""
    t = np.arange(48000) / 48000.0
    sound = 2e3 * np.sin(2.0 * np.pi * 1900.0 * t) + 30.0 * np.random.default_rng(1).standard_normal(t.size)
    scipy.io.wavfile.write(tmp_path / "low.wav", 48000, sound.astype(np.int16))
    (tmp_path / "drum.toml").write_text('brake = "drum_brake"\n')
    hint = "a tone stands below the band, at 1900 Hz: a band from 1000 Hz holds it"
    assert hint in said("events", tmp_path / "low.wav")[1]
    code, _, err = said("compare", tmp_path / "drum.toml", tmp_path / "low.wav")
    assert code == 2
    assert hint in err
    assert "no calibration" not in err
    assert said("compare", tmp_path / "drum.toml", tmp_path / "low.wav", "--band", "1kHz", "16kHz")[0] == 0
