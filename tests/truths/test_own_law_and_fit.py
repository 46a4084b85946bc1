"""A law of plain functions and the fit of laws to points; each with a wrong twin that must fail."""

import numpy as np
import pytest

from squealbox import MassOnBelt, Stribeck, complex_modes, fit_friction, own_law, read_design
from squealbox.cli import main
from squealbox.files import DesignFileError
from squealbox.files.own_law import allow
from squealbox.parameters import ParameterError, from_plain, to_plain
from squealbox.plots import friction_fit

TEXT = "import numpy as np\n\ndef mu(v, p):\n    return p[2] + (p[1] - p[2]) * np.exp(-v / p[3])\n"
SLOPE = "\ndef slope(v, p):\n    return -(p[1] - p[2]) / p[3] * np.exp(-v / p[3])\n"
NUMBERS, SPEEDS = (0.5, 0.3, 0.2), np.linspace(0.0, 2.0, 41)


def mu(v, p):
    return 0.4 / (1.0 + 2.0 * v)


@pytest.mark.parametrize("text", [TEXT, TEXT + SLOPE])
def test_own_law_equals_the_law_it_writes_out(text):
    law, known = own_law(text, numbers=NUMBERS), Stribeck(*NUMBERS)
    assert np.max(np.abs(law.mu(-SPEEDS) - known.mu(SPEEDS))) < 1e-15
    # central difference with h = 1e-5 v: h^2 mu'''/6 is below 1e-8 here; at v = 0 it is one-sided, h mu''/2 = 1e-8
    assert np.max(np.abs(law.slope_at(SPEEDS) - known.slope_at(SPEEDS))) < 1e-7
    assert law.static_limit == pytest.approx(0.5)
    ours, theirs = (complex_modes(MassOnBelt(friction=each)).eigenvalues for each in (law, known))
    assert np.max(np.abs(ours - theirs)) < 1e-7
    assert np.max(np.abs(own_law(text, numbers=(0.5, 0.3, 0.25)).mu(SPEEDS) - known.mu(SPEEDS))) > 1e-2


def test_own_law_from_a_function():
    assert float(own_law(mu).mu(0.5)) == pytest.approx(0.2)


@pytest.mark.parametrize(
    "text",
    [
        "def mu(v): return 0.3",
        "def slope(v, p): return 0.0",
        "import os\ndef mu(v, p): return 0.3",
        "print('hello')\ndef mu(v, p): return 0.3",
        "def mu(v, p) return 0.3",
        "def mu(v, p): return -0.3",
        "def mu(v, p): return nonsense",
    ],
)
def test_what_is_no_law_is_refused(text):
    with pytest.raises(ParameterError, match="OwnLaw"):
        own_law(text)


def test_code_that_came_as_data_does_not_run():
    source = "def mu(v, p):\n    return 0.31 + 0.0 * v\n"
    law = from_plain({"kind": "files.own_law.OwnLaw", "source": source, "static": 0.31, "numbers": []})
    with pytest.raises(ParameterError, match="allow"):
        law.mu(0.1)
    assert float(allow(law).mu(0.1)) == 0.31
    assert from_plain(to_plain(law)) == law


def write(folder, text=TEXT):
    (folder / "law.py").write_text(text)
    path = folder / "brake.toml"
    path.write_text('brake = "mass_on_belt"\nfriction = { law = "own", file = "law.py", numbers = [0.5, 0.3, 0.2] }\n')
    return path


def test_a_file_runs_code_only_when_allowed(tmp_path, capsys):
    path = write(tmp_path, TEXT + "\n")
    with pytest.raises(DesignFileError, match="only with --allow-code") as caught:
        read_design(path)
    assert len(caught.value.problems) == 1
    assert read_design(path, allow_code=True).friction == own_law(TEXT + "\n", numbers=NUMBERS)
    assert main(["modes", str(path)]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert main(["modes", str(path), "--allow-code"]) == 0


@pytest.mark.parametrize("name", ["../law.py", "/etc/passwd.py", "none.py", "law.txt"])
def test_a_law_stands_beside_its_file(name, tmp_path):
    path = write(tmp_path)
    path.write_text(path.read_text().replace("law.py", name))
    with pytest.raises(DesignFileError) as caught:
        read_design(path, allow_code=True)
    assert len(caught.value.problems) == 1


def test_fit_finds_the_law_that_made_the_points():
    noise = 0.002 * np.random.default_rng(3).standard_normal(60)
    v = np.linspace(0.02, 1.5, 60)
    fit = fit_friction(v, Stribeck(*NUMBERS).mu(v) + noise)
    assert fit.names[fit.best] == "stribeck"
    for found, error, true in zip(fit.coefficients[fit.best], fit.errors[fit.best], NUMBERS, strict=True):
        assert abs(found - true) < 4.0 * error  # four standard errors
    inside = (fit.low[fit.best] <= fit.law.mu(fit.curve_speeds)) & (fit.law.mu(fit.curve_speeds) <= fit.high[fit.best])
    assert np.all(inside)
    assert friction_fit(fit).axes


def test_band_covers_as_often_as_it_says():
    # a straight line, where linear propagation is exact: 95 % at one speed, 200 draws, 3 binomial deviations = 4.6 %
    random, v, hits = np.random.default_rng(7), np.linspace(0.0, 1.0, 12), 0
    for _ in range(200):
        fit = fit_friction(v, 0.4 - 0.1 * v + 0.01 * random.standard_normal(12), "linear_slope")
        hits += fit.low[0, 100] <= 0.35 <= fit.high[0, 100]
    assert abs(hits / 200 - 0.95) < 0.047


@pytest.mark.parametrize(
    ("speeds", "values"),
    [([1, 2, 3], [1, 2, 3]), (range(6), [0.3] * 5), ([1.0] * 6, [0.3] * 6), (range(6), [np.nan] * 6)],
)
def test_fit_refuses_what_is_no_measurement(speeds, values):
    with pytest.raises(ParameterError, match="fit_friction"):
        fit_friction(list(speeds), values)


@pytest.mark.parametrize("text", ["", "v,mu\n", "0.1,0.3\n0.2\n", "0.1 kg,0.3\n", "0.1,0.3\n0.2,x\n"])
def test_points_that_are_none_are_one_sentence(text, tmp_path, capsys):
    (tmp_path / "mu.csv").write_text(text)
    assert main(["fit", str(tmp_path / "mu.csv")]) == 2
    assert capsys.readouterr().err.count("\n") == 1
    assert sorted(path.name for path in tmp_path.iterdir()) == ["mu.csv"]


def test_fit_on_the_command_line(tmp_path, capsys):
    v = np.linspace(0.05, 1.0, 15)
    lines = [f"{a} m/s,{b}" for a, b in zip(v, 0.45 - 0.05 * v + 0.001 * np.sin(40 * v), strict=True)]
    (tmp_path / "mu.csv").write_text("speed,mu\n" + "\n".join(lines))
    assert (
        main(["fit", str(tmp_path / "mu.csv"), "--law", "linear_slope", "--law", "coulomb", "--out", str(tmp_path)])
        == 0
    )
    assert 'law = "linear_slope"' in capsys.readouterr().out
    assert (tmp_path / "fit.png").exists()
