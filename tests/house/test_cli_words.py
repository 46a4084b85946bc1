"""The words of a command line: their order, ranges below zero, what is missing, files with a byte order mark."""

from squealbox import DrumBrake, LinearSlope, mechanism, simulate
from squealbox.cautions import told_place


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
