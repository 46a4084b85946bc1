"""A start for `squealbox cycle`, a box of starts for `squealbox basin`, and files that forgot their contacts."""

import pytest

from squealbox.cli import BAD_INPUT, DONE, FAILED, main
from squealbox.files import DesignFileError, read_file, read_text
from squealbox.report import report

BLOCK = """
brake = "mass_on_belt"
m = 1
c = 0.02
k = 1
load = 1
sliding_speed = 0.2
friction = { law = "coulomb", static = 0.4, kinetic = 0.25 }
"""


@pytest.fixture
def block(tmp_path):
    file = tmp_path / "block.toml"
    file.write_text(BLOCK)
    return str(file)


def test_the_start_decides_what_a_cycle_is_found_from(block, capsys):
    """Steady sliding is stable beside stick-slip: which of the two a run settles on is a matter of its start."""
    assert main(["cycle", block, "--start", "sliding"]) == FAILED
    assert "steady_sliding" in capsys.readouterr().err
    assert main(["cycle", block, "--start", "x=1", "x'=0.1 m/s"]) == DONE
    assert "period 6.454383" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (["--start", "y=1"], "--start y=1: unknown state, one of x, x'"),
        (["--start", "x=1kg"], "expected m (a length)"),
        (["--start", "x"], "expected rest, sliding, mode 2, or NAME=VALUE"),
        (["--start", "x=1", "x=2"], "x is given twice"),
        (["--period", "1s"], "expected --start with the state that is on the cycle"),
        (["--settle", "0s"], "--settle 0s: expected a finite number in (0, inf) s"),
    ],
)
def test_what_is_no_start_gets_a_sentence(block, words, said, capsys):
    assert main(["cycle", block, *words]) == BAD_INPUT
    assert said in capsys.readouterr().err


def test_a_box_of_starts(block, capsys):
    assert main(["basin", block, "--starts", "20", "--box", "x=0.24:0.26", "x'=0"]) == DONE
    assert capsys.readouterr().out.splitlines()[1].startswith("0.0 % of 20 starts vibrate")
    assert main(["basin", block, "--starts", "20", "--box", "x=1:2", "x'=0"]) == DONE
    assert capsys.readouterr().out.splitlines()[1].startswith("100.0 % of 20 starts vibrate")
    assert main(["basin", block, "--box", "x=1:0"]) == BAD_INPUT
    assert "expected the lower end first" in capsys.readouterr().err


def test_a_file_that_forgot_its_contacts_is_cautioned_about(tmp_path, capsys):
    """On every command and in the report; contacts = [] says that nothing shall rub."""
    for more, said in (("", True), ("contacts = []\n", False)):
        file = tmp_path / "brake.toml"
        file.write_text(f'brake = "own"\nM = [[1.0]]\nK = [[4.0]]\n{more}')
        assert ("nothing in it rubs" in read_file(file).caution) is said
        assert main(["modes", str(file)]) == DONE
        assert ("Caution: brake = 'own' has no contacts" in capsys.readouterr().err) is said
        page = report(file, tmp_path / "page.html").read_text()
        assert ("has no contacts, so nothing in it rubs" in page) is said


def test_an_angle_that_is_no_freedom_is_refused():
    text = 'brake = "own"\nM = [[1.0]]\nK = [[4.0]]\ncontacts = []\nangles = ["a"]\n'
    with pytest.raises(DesignFileError, match="angles"):
        read_text(text)
