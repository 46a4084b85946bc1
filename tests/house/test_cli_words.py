"""The words of a command line: their order, ranges below zero, what is missing, files with a byte order mark."""


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
