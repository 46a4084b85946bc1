"""`squealbox listen`: a file one can hear, at the frequency of the motion."""

import pytest
from scipy.io import wavfile

from squealbox import DrumBrake, LinearSlope, simulate
from squealbox.cli import BAD_INPUT, DONE, main
from squealbox.files import write_design
from squealbox.signals import dominant_frequency

SQUEALING = DrumBrake(friction=LinearSlope(0.45, -0.05))


@pytest.fixture
def brake(tmp_path):
    return str(write_design(SQUEALING, tmp_path / "brake.toml"))


def test_the_file_has_the_frequency_of_the_motion(brake, tmp_path, capsys):
    assert main(["listen", brake, "--out", str(tmp_path / "a.wav"), "--duration", "0.5s"]) == DONE
    rate, wave = wavfile.read(tmp_path / "a.wav")
    true = dominant_frequency(simulate(SQUEALING, 0.1, times=10_001), dof="y", begin=0.05)
    heard = dominant_frequency(wave[rate // 10 :].astype(float), rate=float(rate))
    assert heard == pytest.approx(true, rel=1e-5)  # 0.4 s resolve 2.5 Hz; the peak is found much finer
    said = capsys.readouterr().out
    assert "y at 2034." in said
    assert "100 cm²" in said


def test_slower_is_an_octave_lower_and_another_value_sounds_otherwise(brake, tmp_path):
    words = ["--duration", "0.2s", "--dof", "x"]
    assert main(["listen", brake, "--out", str(tmp_path / "b.wav"), "--slower", "2", *words]) == DONE
    assert main(["listen", brake, "--out", str(tmp_path / "c.wav"), "--set", "friction.static=0.3", *words]) == DONE
    low, other = (wavfile.read(tmp_path / f"{name}.wav")[1].astype(float) for name in "bc")
    true = dominant_frequency(simulate(SQUEALING, 0.1, times=10_001), dof="x", begin=0.05)
    assert dominant_frequency(low[8820:], rate=44100.0) == pytest.approx(0.5 * true, rel=1e-4)
    assert dominant_frequency(other, rate=44100.0) != pytest.approx(true, rel=1e-2)


@pytest.mark.parametrize(
    ("words", "sentence"),
    [
        (["--duration", "0s"], "--duration 0s: expected more than 0 and at most 60 s"),
        (["--duration", "5min"], "expected more than 0 and at most 60 s"),
        (["--dof", "z"], "expected one of x, y"),
        (["--slower", "0"], "slower = 0.0"),
    ],
)
def test_bad_input_is_one_sentence_and_writes_nothing(brake, tmp_path, capsys, words, sentence):
    out = tmp_path / "d.wav"
    usual = [] if "--duration" in words else ["--duration", "0.01s"]
    assert main(["listen", brake, "--out", str(out), *usual, *words]) == BAD_INPUT
    said = capsys.readouterr().err
    assert sentence in said
    assert len(said.splitlines()) == 1
    assert not out.exists()
