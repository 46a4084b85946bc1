"""A run that names no method is the same run from Python, from a file and from the command line."""

import pytest

from squealbox import DrumBrake, Result, simulate
from squealbox.cli import main
from squealbox.files import read_file


@pytest.mark.parametrize("contact", ["exact", "smooth"])
def test_a_file_takes_the_usual_method_of_python(tmp_path, contact):
    path = tmp_path / "drum.toml"
    path.write_text(f'brake = "drum_brake"\n[simulate]\nduration = "2 ms"\ntimes = 11\ncontact = "{contact}"\n')
    found = read_file(path)
    filed, plain = found.simulate.run(found.design.system()), simulate(DrumBrake(), 0.002, times=11, contact=contact)
    assert filed.settings == plain.settings
    assert (filed.q == plain.q).all()
    assert (filed.qd == plain.qd).all()


def test_the_command_line_too(tmp_path, monkeypatch):
    monkeypatch.setattr("squealbox.plots.save", lambda figure, path: [])
    path, out = tmp_path / "drum.toml", tmp_path / "out"
    path.write_text('brake = "drum_brake"\n')
    for words, expected in (
        ([], "taylor"),
        (["--method", "usual"], "taylor"),
        (["--method", "tsitouras"], "tsitouras"),
    ):
        assert main(["simulate", str(path), "--duration", "2 ms", "--out", str(out), *words, "--force"]) == 0
        assert Result.load(out / "motion.nc").settings["tableau"] == expected
