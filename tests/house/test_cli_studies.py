"""`squealbox run`, `status`, `show` and `export`, and what is said of a study file that is wrong."""

import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest
import xarray
from scipy.io import loadmat

from house.rooms import PROJECT
from squealbox import complex_modes, critical_value, read_design
from squealbox.cli import main
from squealbox.files import DesignFileError
from squealbox.files.study import read_study
from squealbox.plots import sweep_overview
from squealbox.studies import open_sweep

BRAKE = 'brake = "drum_brake"\nfriction = { law = "linear_slope", static = 0.45, slope = "-0.05 s/m" }\n'
NORMAL = '{ parameter = "m", distribution = "normal", mean = "1 N", sd = -1 }'
ONSET = '[onset]\nparameter = "load"\nrange = [1, 2e4]\n'
AXIS = '[[study.axis]]\nparameter = "friction.static"\nrange = [0.2, 0.5]\npoints = 4\n'


def written(folder, text):
    path = folder / "study.toml"
    path.write_text(text)
    return path


def test_a_whole_session(tmp_path, capsys, monkeypatch):
    monkeypatch.chdir(tmp_path)
    example = PROJECT / "examples" / "study.toml"
    assert main(["run", str(example), "--out", "study", "--set", "friction.slope=-0.01"]) == 0
    out = capsys.readouterr().out
    assert "9882 points, friction.static (81) x load (61) x reading (2): 9882 completed" in out
    assert main(["status", "study"]) == 0
    assert "study: finished" in capsys.readouterr().out
    assert main(["show", "study", "--of", "largest_growth_rate", "--out", "figures"]) == 0
    assert "and 9862 more" in capsys.readouterr().out
    names = ["sweep.csv", "sweep.nc", "sweep.png", "sweep.svg"]
    assert sorted(path.name for path in (tmp_path / "figures").iterdir()) == names
    for kind in ("csv", "nc", "mat"):
        assert main(["export", "study", "--format", kind]) == 0
    table = open_sweep("study")
    growth = table["largest_growth_rate"].values
    brake = read_design(example).replace({"friction.slope": -0.01, "friction.static": 0.6, "load": 1e4})
    assert growth[-1, -1, -1] == complex_modes(brake.replace(reading="consistent")).largest_growth_rate
    rows = (tmp_path / "sweep.csv").read_text().splitlines()
    assert rows[0].startswith("friction.static,load [N],reading,outcome,largest_growth_rate [1/s]")
    assert float(rows[-1].split(",")[4]) == pytest.approx(growth[-1, -1, -1], rel=1e-9)  # ten digits are written
    for_matlab = loadmat("sweep.mat", squeeze_me=True)
    np.testing.assert_array_equal(for_matlab["largest_growth_rate"], growth)
    assert for_matlab["units"]["load"].item() == "N"
    with xarray.open_dataset("sweep.nc", engine="h5netcdf") as raw:
        np.testing.assert_array_equal(raw["largest_growth_rate"].values, growth)
    capsys.readouterr()
    assert main(["export", "study", "--format", "csv"]) == 2
    assert "--force overwrites" in capsys.readouterr().err
    assert main(["run", str(example), "--out", "study"]) == 2
    assert "design.friction.slope was -0.01 and is -0.05" in capsys.readouterr().err
    assert main(["show", "study", "--of", "nonsense", "--out", "figures"]) == 2


@pytest.mark.parametrize(
    ("sections", "answer"),
    [
        ('[onset]\nparameter = "load"\nrange = ["100 N", "20 kN"]\n[study]\nanalysis = "onset"\n', "value"),
        ('[study]\nanalysis = "ensemble"\nduration = "2 ms"\nobserve = ["amplitude"]\n', "amplitude"),
        ('[simulate]\nduration = "2 ms"\ntimes = 501\n[study]\nanalysis = "simulate"\nworkers = 2\n', "amplitude"),
        ('[study]\nanalysis = "cycle"\n', "period"),
        ('[study]\nkeep = ["stable"]\n', "stable"),
    ],
)
def test_every_analysis_runs_from_a_file(tmp_path, sections, answer, capsys):
    path = written(tmp_path, BRAKE + sections + AXIS)
    assert main(["run", str(path), "--out", str(tmp_path / "study")]) == 0, capsys.readouterr().err
    found = open_sweep(tmp_path / "study")
    assert found["outcome"].shape == (4,)
    assert found[answer].shape[0] == 4
    assert sweep_overview(found, answer=answer).axes
    if answer == "value":
        brake = read_design(path).replace({"friction.static": 0.2})
        assert found["value"].values[0] == critical_value(brake, "load", (100.0, 2e4), points=201).value


def test_a_design_of_its_own_file_and_every_kind_of_axis(tmp_path):
    (tmp_path / "brake.toml").write_text(BRAKE)
    text = """
        design = "brake.toml"
        [study]
        seed = 3
        [[study.axis]]
        together = [
            { parameter = "k1", values = ["19 kN/mm", "20 kN/mm"] },
            { parameter = "k2", values = [1.8e7, 1.9e7] },
        ]
        [[study.axis]]
        parameter = "reading"
        values = ["eq3", "consistent"]
        [[study.axis]]
        sample = "latin_hypercube"
        points = 8
        of = [{ parameter = "load", range = ["100 N", "10 kN"], spacing = "log" }]
        [[study.axis]]
        sample = "random"
        points = 3
        of = [
            { parameter = "m", distribution = "normal", mean = "1000 g", sd = "10 g" },
            { parameter = "theta1", range = ["30 deg", "40 deg"] },
        ]
        correlation = [["m", "theta1", 0.9]]
    """
    found = read_study(written(tmp_path, text))
    assert found.space.shape == (2, 2, 8, 3)
    points = found.space.points(0, len(found.space))
    assert set(points["k1"]) == {1.9e7, 2.0e7}
    assert np.all((points["load"] > 100.0) & (points["load"] < 1e4))
    assert np.all((points["theta1"] > np.deg2rad(30.0)) & (points["theta1"] < np.deg2rad(40.0)))
    assert 0.9 < np.mean(points["m"]) < 1.1
    assert found.space.dims == ("point_1", "reading", "point_2", "point_3")


@pytest.mark.parametrize(
    ("text", "problems"),
    [
        (BRAKE, [(0, "the section [study] is missing")]),
        (BRAKE + '[study]\nanalysis = "mode"\n', [(4, "did you mean 'modes'"), (3, "[[study.axis]] are missing")]),
        (
            BRAKE + '[study]\nsed = 1\n[[study.axis]]\nparameter = "lod"\nvalues = [1]\n[[study.axis]]\nvalues = [1]\n',
            [(4, "did you mean 'seed'"), (6, "did you mean 'load'"), (8, "the key 'parameter' is missing")],
        ),
        (BRAKE + AXIS.replace("points = 4", "points = 0"), [(6, "points = 0: expected a whole number")]),
        (BRAKE + AXIS.replace("[0.2, 0.5]", '["0.2 N", 0.5]'), [(5, "has the unit N (a force)")]),
        (BRAKE + AXIS.replace("[0.2, 0.5]", "[0.5, 0.2]"), [(5, "the lower value first")]),
        (BRAKE + AXIS + 'spacing = "cubic"\n', [(7, "unknown name 'cubic'")]),
        (BRAKE + AXIS.replace("0.2", "0.0") + 'spacing = "log"\n', [(5, "above 0")]),
        (BRAKE + AXIS + AXIS, [(3, "each parameter once")]),
        (BRAKE + AXIS.replace("range", "rnge"), [(5, "unknown key"), (3, "'range' or 'values' is missing")]),
        (BRAKE + '[study]\nanalysis = "onset"\n' + AXIS, [(4, "needs a section [onset]")]),
        ('design = "none.toml"\n[study]\n' + AXIS, [(1, "there is no such file")]),
        ('design = "../none.toml"\n[study]\n' + AXIS, [(1, "outside the folder")]),
        (
            BRAKE + '[[study.axis]]\nsample = "sobol"\npoints = 8\nof = [ ' + NORMAL + " ]\n",
            [(6, "has the unit N"), (6, "expected a finite number")],
        ),
    ],
)
def test_every_problem_of_a_study_file_is_said_with_its_line(tmp_path, text, problems, capsys):
    path = written(tmp_path, text)
    with pytest.raises(DesignFileError) as caught:
        read_study(path)
    said = [(problem.line, problem.message) for problem in caught.value.problems]
    for line, words in problems:
        assert any(words in message and (at == line or line == 0) for at, message in said), (line, words, said)
    assert main(["run", str(path), "--out", str(tmp_path / "out")]) == 2
    assert "Traceback" not in capsys.readouterr().err
    assert not (tmp_path / "out").exists()


def test_ctrl_c_and_on_again(tmp_path):
    study = '[study]\nanalysis = "onset"\nchunk = 2\n'
    path = written(tmp_path, BRAKE + ONSET + study + AXIS.replace("points = 4", "points = 400"))
    words = [sys.executable, "-c", "import sys; from squealbox.cli import main; sys.exit(main())", "run", str(path)]
    words += ["--out", str(tmp_path / "study")]
    with subprocess.Popen(words, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True) as process:
        for _ in range(600):
            time.sleep(0.05)
            if len(list((tmp_path / "study").glob("blocks/*.npz"))) >= 3:
                break
        process.send_signal(signal.SIGINT)
        _, err = process.communicate(timeout=60)
    assert process.returncode == 130, err
    assert "stopped before the end" in err
    assert "Traceback" not in err
    status = subprocess.run([*words[:3], "status", str(tmp_path / "study")], capture_output=True, text=True, timeout=60)
    assert "the same run command goes on from here" in status.stdout
    assert "of 400 points" in status.stdout
    shown = subprocess.run([*words[:3], "show", str(tmp_path / "study")], capture_output=True, text=True, timeout=60)
    assert "not_run" in shown.stdout
    assert os.path.exists(tmp_path / "study" / "run.log")
