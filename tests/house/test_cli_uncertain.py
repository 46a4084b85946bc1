"""`squealbox scatter` and `squealbox optimise`: what they print, write and return."""

import csv

from house.rooms import PROJECT
from squealbox.files import read_file
from squealbox.result import Result
from squealbox.studies import squeal_probability

EXAMPLE = PROJECT / "examples" / "scatter.toml"


def rows(path):
    with open(path, newline="") as file:
        return list(csv.DictReader(file))


def test_scatter_answers_and_writes(said, tmp_path):
    code, out, err = said("scatter", EXAMPLE, "--samples", 512, "--out", tmp_path)
    assert (code, err) == (0, "")
    assert "P(squeal) = " in out
    assert "first order" in out
    found = read_file(EXAMPLE)
    section = found.scatter
    expected = squeal_probability(found.design, section.scatter, section.quantity, samples=512, seed=1)
    assert str(expected) in out
    assert Result.load(tmp_path / "probability.nc").summary() == str(expected)
    table = rows(tmp_path / "probability.csv")
    assert len(table) == 512
    assert "k1 [N/m]" in table[0]
    assert {row["parameter"] for row in rows(tmp_path / "sobol.csv")} == set(section.scatter.names)
    assert (tmp_path / "sobol.png").stat().st_size > 5000


def test_every_study_can_be_asked_for(said, tmp_path, monkeypatch):
    monkeypatch.setattr("squealbox.plots.save", lambda figure, path: [])
    file = tmp_path / "brake.toml"
    file.write_text(
        'brake = "damping_paradox"\n[scatter]\nquantity = "damping_ratio"\n[scatter.parameters]\n'
        'friction.static = { distribution = "uniform", low = 0.1, high = 0.31 }\n'
        'eta1 = { distribution = "lognormal", mean = 0.02, sd = 0.004 }\n'
    )
    names = ("probability", "sobol", "morris", "form", "subset", "surrogate", "bounds")
    code, out, _ = said("scatter", file, "--study", *names, "--samples", 64, "--seed", 3, "--out", tmp_path)
    assert code == 0, out
    assert all(f"\n{name}\n" in out for name in names)
    assert all((tmp_path / f"{name}{end}").exists() for name in names for end in (".nc", ".csv"))


def test_optimise_answers_and_writes_a_design_that_is_as_good_as_it_says(said, tmp_path):
    text = (
        EXAMPLE.read_text().replace("generations = 40", "generations = 3").replace("population = 40", "population = 8")
    )
    file = tmp_path / "brake.toml"
    file.write_text(text)
    code, out, err = said("optimise", file, "--out", tmp_path / "out")
    assert (code, err) == (0, "")
    assert "Pareto front" in out
    assert "binding: " in out
    found = Result.load(tmp_path / "out" / "optimum.nc")
    assert read_file(tmp_path / "out" / "optimum.toml").design == found.design
    assert len(rows(tmp_path / "out" / "optimum.csv")) == len(found.values)


def test_failures_have_their_exit_codes(said, tmp_path):
    file = tmp_path / "brake.toml"
    file.write_text('brake = "damping_paradox"\n')
    assert said("scatter", file)[0] == 2
    assert "no section [scatter]" in said("scatter", file)[2]
    assert "no section [optimise]" in said("optimise", file)[2]
    code, _, err = said("scatter", EXAMPLE, "--study", "sobel")
    assert (code, "probability, sobol" in err) == (2, True)
    code, _, err = said("scatter", EXAMPLE, "--samples", 3)
    assert (code, "--samples 3" in err) == (2, True)
    text = EXAMPLE.read_text().replace("range = [0, 1]\nstudy", "range = [0, 0.01]\nstudy")
    file.write_text(text)
    code, _, err = said("scatter", file, "--study", "sobol", "--samples", 64, "--out", tmp_path / "out")
    assert code == 1
    assert "unknown_values" in err
    assert (tmp_path / "out" / "sobol.nc").exists()
