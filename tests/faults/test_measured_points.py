"""Friction measured in other units, backwards or at one lonely speed: read right, refused, or unsure."""

import numpy as np
import pytest

from squealbox.files import DesignFileError, read_design
from squealbox.files.measured import read_points
from squealbox.files.writing import design_text
from squealbox.fit import fit_friction
from squealbox.parameters import ParameterError


@pytest.mark.parametrize(
    ("header", "factor"),
    [
        ("speed,mu", 1.0),
        ("speed [mm/s],mu", 1e-3),
        ("v (km/h),mu [-]", 1.0 / 3.6),
        ("speed in mm/s,friction", 1e-3),
        ("v / mm/s,mu", 1e-3),
        ("speed_mm/s,mu", 1e-3),
        ("sliding speed [m s^-1],mu", 1.0),
    ],
)
def test_the_unit_of_a_header_counts(header, factor, tmp_path):
    (tmp_path / "p.csv").write_text(f"{header}\n100,0.4\n200,0.3\n")
    speeds, values = read_points(tmp_path / "p.csv")
    assert speeds == pytest.approx([100.0 * factor, 200.0 * factor], rel=1e-12)
    assert values == pytest.approx([0.4, 0.3])


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("speed [rpm],mu\n1,0.4\n", "an angular frequency"),
        ("speed [mm],mu\n1,0.4\n", "a length"),
        ("speed [furlongs],mu [N]\n1,0.4\n", "header"),
        ("speed,mu [N]\n1,0.4\n", "a force"),
        ("speed,mu\n-1,0.4\n", "expected 0 m/s or more"),
    ],
)
def test_what_is_no_speed_or_no_coefficient_is_refused(text, words, tmp_path):
    (tmp_path / "p.csv").write_text(text)
    with pytest.raises(DesignFileError, match=words):
        read_points(tmp_path / "p.csv")


@pytest.mark.parametrize(
    "text",
    [
        "Dynamometer test 5\n\nspeed [km/h],mu\n3.6,0.4\n7.2,0.3\n",
        "Run 3;;\nt [s];mu [-];v [m/s]\n0;0,4;1\n1;0,3;2\n",
        "mu,v\n0.4,1\n0.3,2\n",
        "# pad A\ntemperature,friction coefficient [%],sliding speed\n20,40,1\n25,30,2\n",
    ],
)
def test_titles_are_passed_over_and_of_more_columns_the_names_choose(text, tmp_path):
    (tmp_path / "p.csv").write_text(text)
    speeds, values = read_points(tmp_path / "p.csv")
    assert speeds == pytest.approx([1.0, 2.0], rel=1e-12)
    assert values == pytest.approx([0.4, 0.3], rel=1e-12)


@pytest.mark.parametrize("text", ["1,0.4,20\n", "time,v,speed,mu\n0,1,1,0.4\n", "a,b,c\n1,0.4,20\n", "v,mu\n1,0.4,3\n"])
def test_columns_that_nothing_tells_apart_are_refused(text, tmp_path):
    (tmp_path / "p.csv").write_text(text)
    with pytest.raises(DesignFileError, match="cells: expected two"):
        read_points(tmp_path / "p.csv")


def test_negative_speeds_are_refused_in_python_too():
    with pytest.raises(ParameterError, match=r"speeds\[2\].*0 m/s or more"):
        fit_friction([0.1, 0.2, -0.3, 0.4, 0.5], [0.3] * 5)


def test_one_point_that_carries_a_coefficient_is_not_trusted_alone():
    speeds = np.r_[0.02, np.linspace(1.0, 3.0, 12)]  # the static limit and the speed hang on the first point
    held = 0
    for seed in range(20):
        noise = 0.01 * np.random.default_rng(seed).standard_normal(13)
        found = fit_friction(speeds, 0.3 + 0.15 * np.exp(-speeds / 0.2) + noise, "stribeck")
        held += abs(found.coefficients[0, 0] - 0.45) <= 2.23 * found.errors[0, 0]  # Student's t of 10
    assert held >= 17
    plenty = np.linspace(0.02, 3.0, 200)
    sure = fit_friction(plenty, 0.3 + 0.15 * np.exp(-plenty / 0.2), "stribeck")
    assert np.all(sure.errors[0] < 1e-6)


OWN = """brake = "own"
M = [[1, 0], [0, 2]]
K = [[100, 0], [0, 80]]
load = LOAD
[[contacts]]
n = [0, 0]
d = [1, 0]
normal_force = { ramp = { start = "10 N", slope = "-1 N/s", stop = "5 N" } }
sliding_speed = { sinusoid = { mean = 1, amplitude = 0.5, frequency = 3 } }
"""


def test_loads_that_vary_in_time_in_a_file(tmp_path):
    file = tmp_path / "own.toml"
    file.write_text(
        OWN.replace("LOAD", '[2, { sinusoid = { mean = "1 N", amplitude = "0.5 N", frequency = "3 Hz" } }]')
    )
    brake = read_design(file)
    assert brake.system().load.value(0.05) == pytest.approx([2.0, 1.0 + 0.5 * np.sin(2 * np.pi * 3.0 * 0.05)])
    again = tmp_path / "again.toml"
    again.write_text(design_text(brake))
    assert read_design(again) == brake
    file.write_text(OWN.replace("LOAD", "{ ramp = { start = 0, slope = 10 } }"))
    with pytest.raises(DesignFileError, match="2 forces, one for each degree of freedom"):
        read_design(file)
    ramp = 'load = { ramp = { start = "0 N", slope = "10 N/s", stop = "1 kN" } }'
    one = f'brake = "own"\ncontacts = []\nM = [[1]]\nK = [[4]]\n{ramp}\n'
    file.write_text(one)
    assert read_design(file).system().load.value(2.0) == pytest.approx([20.0])
