"""`squealbox branch`: the branches of a range in words, figure and tables, by options and by the file."""

import csv

import numpy as np
import pytest

from squealbox import DrumBrake, LinearSlope
from squealbox.cli import BAD_INPUT, DONE, FAILED, main
from squealbox.files import write_design
from squealbox.limit_cycles import Branch

WALK = ["--points", "40", "--at", "1", "--runs", "3"]


@pytest.fixture
def brake(tmp_path):
    return write_design(DrumBrake(friction=LinearSlope(0.3, -0.05), reading="consistent"), tmp_path / "brake.toml")


def test_words_figure_and_tables(brake, tmp_path, capsys):
    """The cycle at 0.3 coexists with stable sliding; eigenvalues put the onset at 0.3327."""
    out = tmp_path / "out"
    words = ["--parameter", "friction.static", "--range", "0.29", "0.31", *WALK, "--out", str(out)]
    assert main(["branch", str(brake), *words]) == DONE
    said = capsys.readouterr().out
    assert "stable from 0.29 to 0.31" in said
    assert "Stable sliding and a stable cycle coexist: friction.static from 0.29 to 0.31" in said
    assert {path.name for path in out.iterdir()} == {
        "branch.png", "branch.svg", "branch.csv", "special.csv", "branch_1.nc"
    }  # fmt: skip
    kept = Branch.load(out / "branch_1.nc")
    rows = list(csv.DictReader((out / "branch.csv").read_text().splitlines()))
    assert len(rows) == len(kept.value)
    np.testing.assert_allclose([float(row["amplitude y [m]"]) for row in rows], kept.amplitude[:, 1], rtol=1e-8)
    assert all(row["stable"] == "True" for row in rows)


def test_the_section_of_the_file_and_the_hopf_point(brake, capsys):
    brake.write_text(f'{brake.read_text()}\n[branch]\nparameter = "friction.static"\nrange = [0.3, 0.36]\npoints = 6\n')
    assert main(["branch", str(brake), "--start", "hopf"]) == DONE
    said = capsys.readouterr().out
    assert "supercritical Hopf point at friction.static = 0.3326885" in said
    assert "Branch 1: 6 cycles" in said
    assert "Branch 2" not in said


def test_what_fails_and_what_is_refused(brake, capsys):
    where = ["--parameter", "friction.static", "--range"]
    assert main(["branch", str(brake), *where, "0.01", "0.05", *WALK]) == FAILED
    assert "no_cycle: no cycle was found" in capsys.readouterr().err
    assert main(["branch", str(brake), *where, "0.3", "0.2"]) == BAD_INPUT
    assert main(["branch", str(brake), *where, "0.2", "0.3", "--start", "anywhere"]) == BAD_INPUT
