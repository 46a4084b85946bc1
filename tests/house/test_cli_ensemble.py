"""`squealbox ensemble`: transients over two parameters from the command line."""

import csv
from dataclasses import replace

from squealbox import simulate_ensemble
from squealbox.cli import ensembles, main
from squealbox.result import Outcome


def test_ensemble_says_what_transients_end_in(capsys, tmp_path):
    path = tmp_path / "brake.toml"
    path.write_text('brake = "drum_brake"\n[friction]\nlaw = "linear_slope"\nstatic = 0.3\nslope = -0.05\n')
    plane = ("--x", "friction.static", "0.1", "0.45", "--y", "theta1", "30deg", "40deg", "--points", "3")
    code = main(["ensemble", str(path), *plane, "--duration", "20 ms", "--out", str(tmp_path / "out")])
    out, err = capsys.readouterr()
    assert (code, err) == (0, "")
    assert "9 transients of 0.02 s from rest: 9 completed" in out
    with open(tmp_path / "out" / "ensemble.csv", newline="") as file:
        table = list(csv.DictReader(file))
    assert len(table) == 9
    assert {row["ended"] for row in table} == {"completed"}
    quiet, loud = (float(row["amplitude [m]"]) for row in (table[0], table[-1]))
    assert loud > 10.0 * quiet  # stable sliding rings out, beyond the onset it squeals
    assert {path.name for path in (tmp_path / "out").iterdir()} == {
        "ensemble.nc", "ensemble.csv", "ensemble.png", "ensemble.svg"
    }  # fmt: skip


def test_ensemble_refuses_one_parameter_twice(capsys, tmp_path):
    path = tmp_path / "brake.toml"
    path.write_text('brake = "drum_brake"\n')
    twice = ("--x", "friction.static", "0", "1", "--y", "friction.static", "0", "1")
    code = main(["ensemble", str(path), *twice])
    out, err = capsys.readouterr()
    assert (code, out) == (2, "")
    assert "expected two different parameters" in err


def test_ctrl_c_leaves_the_figure_of_what_is_done(capsys, tmp_path, monkeypatch):
    def stopped(design, space, duration, **settings):
        many = simulate_ensemble(design, space, duration, **settings)
        many.ended[-1] = "not_run"
        return replace(many, outcome=Outcome("interrupted", "stopped by the user"))

    monkeypatch.setattr(ensembles, "simulate_ensemble", stopped)
    path = tmp_path / "brake.toml"
    path.write_text('brake = "drum_brake"\n')
    plane = ("--x", "friction.static", "0.1", "0.3", "--y", "load", "900", "1100", "--points", "2")
    code = main(["ensemble", str(path), *plane, "--duration", "2 ms", "--out", str(tmp_path / "out")])
    out, err = capsys.readouterr()
    assert (code, "interrupted" in err) == (130, True)
    assert "2 completed, 2 not_run" in out
    with open(tmp_path / "out" / "ensemble.csv", newline="") as file:
        assert [row["ended"] for row in csv.DictReader(file)] == ["completed"] * 2 + ["not_run"] * 2
