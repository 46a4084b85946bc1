"""The words of a command line: their order, ranges below zero, what is missing, files with a byte order mark."""

import numpy as np

from squealbox import DrumBrake, LinearSlope, System, critical_value, mechanism, simulate, stability_boundary
from squealbox.cautions import told_place
from squealbox.files import read_design
from squealbox.limit_cycles.attractors.attractor import Attractor
from squealbox.plots import card
from squealbox.result import Result


def test_changes_may_stand_before_the_file_and_ranges_may_be_negative(said, brake):
    _, after, _ = said("modes", brake, "--set", "load=2 kN", "theta1=20 deg")
    code, before, _ = said("modes", "--set", "load=2 kN", "theta1=20 deg", brake)
    assert (code, before) == (0, after)
    code, out, _ = said("onset", brake, "--parameter", "theta2", "--range", "-20deg", "20deg")
    assert code == 0
    assert "theta2" in out


def test_what_is_missing_is_called_as_the_usage_line_calls_it(said):
    code, _, err = said("modes")
    assert code == 2
    assert "FILE is missing: squealbox modes FILE" in err


def test_a_byte_order_mark_is_no_part_of_the_text(said, brake):
    brake.write_bytes(b"\xef\xbb\xbf" + brake.read_bytes())
    assert said("modes", brake)[0] == 0


def test_init_takes_the_name_of_a_file_too(said, tmp_path):
    """`init pad.toml` made a folder of that name."""
    code, out, _ = said("init", tmp_path / "new" / "pad.toml")
    assert code == 0
    assert (tmp_path / "new" / "pad.toml").is_file()
    assert f"squealbox modes {tmp_path / 'new' / 'pad.toml'}" in out
    assert said("init", tmp_path / "new" / "pad.toml")[0] == 2  # the twin: nothing is overwritten


def test_numbers_are_told_in_the_words_of_the_reader():
    """One word for one share; no name in a sentence that is none of the reader's; a caution has its unit."""
    brake = DrumBrake(friction=LinearSlope(0.45, -0.05))
    why = mechanism(brake)
    shares = f"flutter {100.0 * why.flutter_share:.0f} %, negative slope {100.0 * why.negative_slope_share:.0f} %"
    assert str(why) == f"{why.name} ({shares})"
    assert told_place("theta1", 0.5, "rad") == "theta1 = 0.5 rad (28.65 deg),"
    assert told_place("mu", 0.25, "") == "mu = 0.25,"
    frame = simulate(brake, 1e-3).to_dataframe()
    assert frame.attrs["units"]["q[x]"] == "m"
    assert set(frame.attrs["units"]) == set(frame.columns)


def test_a_command_says_of_a_result_what_it_says_of_itself(said, brake, tmp_path):
    """Angles in degrees, in Python, on a card and on the command line; the command had other words and other units."""
    plane = ["--vary", "friction.static=0:1", "theta1=20deg:80deg", "--points", "7"]
    _, out, _ = said("map", brake, *plane, "--out", tmp_path / "map")
    grid = Result.load(tmp_path / "map" / "map.nc")
    edge = stability_boundary(read_design(brake), {"friction.static": (0.0, 1.0), "theta1": np.deg2rad([20.0, 80.0])})
    assert grid.summary() in out
    assert edge.summary() in out
    assert "theta1 = 80 deg" in grid.summary()
    assert grid.summary().splitlines()[0] in card(grid)
    _, out, _ = said("onset", brake, "--vary", "theta1=10deg:90deg")
    onset = critical_value(read_design(brake), "theta1", np.deg2rad([10.0, 90.0]))
    assert onset.told(7) in out
    assert " deg: squeal begins" in str(onset)
    assert "rad" not in str(onset)


def test_amplitudes_are_told_by_name_in_a_unit_that_suits():
    """A rotation was told in metres."""
    moves = Attractor("vibration", np.array([-2e-6, -1e-3]), np.array([2e-6, 1e-3]), np.zeros((2, 8)), 100.0, ((), ()))
    system = System(np.eye(2), np.eye(2), np.eye(2), names=("x", "y"), angles=("y",))
    assert moves.summary(system) == "vibration, amplitude x 2 µm, y 1 mrad, maxima at 100 Hz"
    assert moves.summary() == "vibration, amplitude 2 µm, 1 mm, maxima at 100 Hz"
