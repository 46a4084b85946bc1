"""A command line for scripts: one JSON object, silence, an exit code that says "unstable", completion of words."""

import json
import shutil
import subprocess

import pytest

from squealbox import complex_modes, equilibrium, read_design, simulate
from squealbox.cli import COMMANDS
from squealbox.cli.answers import UNSTABLE


def test_json_holds_what_python_finds(said, brake):
    code, out, _ = said("modes", brake, "--json")
    told = json.loads(out)
    assert (code, told["exit_code"], told["error"]) == (0, 0, None)
    (modes,) = told["results"]
    assert modes["kind"] == "ComplexModes"
    growth = modes["values"]["largest_growth_rate"]
    assert growth["unit"] == "1/s"
    assert growth["value"] == float(complex_modes(read_design(brake)).largest_growth_rate)
    assert any("UNSTABLE" in line for line in told["text"])


def test_json_of_a_motion_has_no_long_arrays_and_its_files_are_written(said, brake, tmp_path):
    _, out, _ = said("simulate", brake, "--duration", "5ms", "--json", "--out", tmp_path / "run")
    motion, *verdicts = json.loads(out)["results"]
    assert motion["values"]["q"]["value"] == {"shape": [5001, 2]}
    assert {each["kind"] for each in verdicts} == {"Verdict"}
    assert (tmp_path / "run" / "motion.nc").is_file()


def test_an_error_is_in_the_object_too(said, tmp_path):
    code, out, err = said("modes", tmp_path / "none.toml", "--json")
    told = json.loads(out)
    assert code == told["exit_code"] == 2
    assert told["error"] in err
    assert told["results"] == []


def test_quiet_says_nothing_and_the_code_says_unstable(said, brake):
    assert said("modes", brake, "--quiet") == (0, "", "")
    assert said("modes", brake, "--quiet", "--exit-code") == (UNSTABLE, "", "")
    assert said("modes", brake, "--exit-code", "--set", "friction.static=0.2")[0] == 0
    assert said("modes", brake)[0] == 0


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_a_shell_completes_every_command(said, shell):
    code, script, _ = said("completion", shell)
    assert code == 0
    assert all(name in script for name in COMMANDS)
    if shutil.which(shell):
        subprocess.run([shell, "-n"], input=script, text=True, check=True)


def test_the_first_brake_is_sound(brake):
    """No shoe would have to pull, in steady sliding or while it squeals."""
    design = read_design(brake)
    assert min(equilibrium(design).normal_force) > 0.0
    motion = simulate(design, 0.02)
    assert motion.caution == ""
    assert motion.normal_force.min() > 0.0
