"""Ways a user takes on the command line: brakes within countermeasures, negative quantities, missing extras."""

import importlib
import inspect
import json
import subprocess
import sys
import typing

import numpy as np
import pytest
import scipy.io.wavfile

from house.rooms import PROJECT
from squealbox import AddedDamping, complex_modes, critical_value, read_design
from squealbox.cli import COMMANDS
from squealbox.parameters import ParameterError
from squealbox.studies.quantity import declared

CURE = '\n[[countermeasures]]\nkind = "added_damping"\non = "x"\ndamping = 3827\n'


def options_of(name, annotation):
    """The options of a command whose annotation has that text in it."""
    command = COMMANDS[name]
    function = getattr(importlib.import_module(f"squealbox.cli.{command.module}"), command.function)
    several = [about for about in inspect.signature(function).parameters.values() if about.kind is about.KEYWORD_ONLY]
    told = {each.name: str(each.annotation) for each in several}
    for each in several:  # what several commands take is a class of options
        shared = next(iter(typing.get_args(each.annotation)), None)
        told |= {one.name: str(one.type) for one in getattr(shared, "__dataclass_fields__", {}).values()}
    yield from ((option, text.count("str")) for option, text in told.items() if annotation in text)


@pytest.fixture
def cured(brake):
    """The file that `init` writes, with a cure at its end."""
    brake.write_text(brake.read_text() + CURE)
    return brake


def test_a_cure_in_a_file_leaves_the_names_of_the_brake(said, cured):
    """Sections, --set, --parameter and axes name a parameter as they did before the cure was put into the file."""
    design = read_design(cured)
    assert isinstance(design, AddedDamping)
    code, out, err = said("onset", cured, "--parameter", "friction.static", "--range", "0", "1")
    onset = float(critical_value(design, "friction.static", (0.0, 1.0)).value)
    assert (code, err) == (0, "")
    assert f"friction.static = {onset:.7g}" in out
    code, out, _ = said("modes", cured, "--set", "friction.static=0.2", "load=2 kN", "reading=eq3")
    changed = design.replace({"friction.static": 0.2, "load": 2000.0, "brake.reading": "eq3"})
    assert code == 0
    assert f"{float(complex_modes(changed).largest_growth_rate):.6g} 1/s" in out
    for words in (["map", "--points", "3"], ["onset"], ["modes", "--set", "brake.friction.static=0.2", "damping=1"]):
        assert said(words[0], cured, *words[1:])[0] == 0
    code, _, err = said("onset", cured, "--parameter", "frictoin.static", "--range", "0", "1")
    assert code == 2
    assert "--parameter frictoin.static: unknown parameter, did you mean 'friction.static'?" in err


def test_what_is_declared_is_found_within_countermeasures(cured):
    design = AddedDamping(read_design(cured), "y", 1.0)
    assert [about.unit for about in declared(design, "load")] == ["N", "N"]
    assert [about.unit for about in declared(design, "friction.slope")] == ["s/m"]
    assert [name for name, _, _ in design.leaves() if name.endswith("damping")] == ["brake.damping", "damping"]
    with pytest.raises(ParameterError, match="did you mean"):
        declared(design, "lod")


TWO = [(name, *found) for name in COMMANDS for found in options_of(name, "tuple[str, str")]


@pytest.mark.parametrize(("name", "option", "count"), TWO, ids=[f"{name} --{option}" for name, option, _ in TWO])
def test_an_option_of_several_values_takes_negative_quantities(said, tmp_path, name, option, count):
    words = ["-1mm", "-2.5 kHz", "-.5deg"][:count]
    place = [] if name == "noise" else ["--out", tmp_path / "out"]
    code, _, err = said(name, tmp_path / "nowhere.toml", f"--{option}", *words, *place)
    assert code == 2
    assert not any(wrong in err for wrong in ("requires", f"--{option} is missing", "nknown option", "unexpected"))


def test_there_are_options_of_several_values():
    assert {("map", "x"), ("map", "y"), ("ensemble", "x"), ("onset", "range"), ("basin", "plane")} <= {
        each[:2] for each in TWO
    }


def test_a_negative_quantity_is_the_value_of_its_option(said, brake):
    """--x theta1 -180deg 180deg was refused, --range -90deg 90deg taken."""
    told = [said("map", brake, "--points", "5", *words, "--y", "friction.static", "0", "0.2") for words in (
        ["--x", "theta1", "-3.1 rad", "-10deg"], ["--x", "theta1", "-3.1", f"-{10 * 3.141592653589793 / 180}"],
    )]  # fmt: skip
    assert told[0] == told[1]
    assert told[0][0] == 0
    code, _, err = said("simulate", brake, "--duration", "-5 ms")
    assert code == 2
    assert "--duration -5 ms: expected a finite number in (0, inf) s" in err
    code, _, err = said("modes", brake, "--set", "theta1=-999deg")
    assert "--set theta1=-999deg" in err
    assert said("modes", "-5deg")[2].count("-5deg") == 1


EXAMPLES = PROJECT / "examples"
DISC = 'brake = "disc_brake"\n'
WITHOUT = {  # words of a command, what is not installed, and the extra that brings it
    "optimise": (["optimise", EXAMPLES / "scatter.toml"], "pymoo", "studies"),
    "morris": (["scatter", EXAMPLES / "scatter.toml", "--study", "morris", "--samples", "16"], "SALib", "studies"),
    "form": (["scatter", EXAMPLES / "scatter.toml", "--study", "form"], "openturns", "studies"),
    "subset": (["scatter", EXAMPLES / "scatter.toml", "--study", "subset", "--samples", "64"], "openturns", "studies"),
    "surrogate": (["scatter", EXAMPLES / "scatter.toml", "--study", "surrogate"], "openturns", "studies"),
    "disc brake": (["modes", "disc.toml"], "skfem", "fe"),
    "lab": (["lab", "--no-browser"], "uvicorn", "workbench"),
    "recording": (["events", "stop.wav"], "soundfile", "recordings"),
    "quality": (["quality", "stop.wav", "--full-scale", "20"], "mosqito", "sound"),
}


ASK = """
import contextlib, io, json, sys
from squealbox.cli import main

told = {}
for case, (words, library, _) in json.loads(sys.argv[1]).items():
    sys.modules[library] = None
    with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()) as err:
        told[case] = main(words), out, err
    del sys.modules[library]
print(json.dumps({case: (code, out.getvalue(), err.getvalue()) for case, (code, out, err) in told.items()}))
"""


@pytest.fixture(scope="module")
def without(tmp_path_factory):
    """Exit code, output and errors of each case, of a process in which no other test has imported what is missing."""
    folder = tmp_path_factory.mktemp("without")
    (folder / "disc.toml").write_text(DISC)
    scipy.io.wavfile.write(folder / "stop.wav", 8000, (1e4 * np.sin(np.arange(4000.0))).astype(np.int16))
    words = [sys.executable, "-c", ASK, json.dumps(WITHOUT, default=str)]
    return json.loads(subprocess.run(words, capture_output=True, text=True, cwd=folder, timeout=900, check=True).stdout)


@pytest.mark.parametrize("case", WITHOUT)
def test_a_missing_extra_is_one_sentence_with_its_command(without, case):
    """It was told as a mistake inside the program, and the workbench printed its address before it failed."""
    _, library, extra = WITHOUT[case]
    code, out, err = without[case]
    assert code == 2
    assert err.count("\n") == 1
    assert "an error inside" not in err
    assert library in err
    assert f"pip install 'squealbox[{extra}]'" in err
    assert "http" not in out


def test_what_an_extra_brings_is_named_where_it_is_missing():
    from squealbox.extras import MissingExtra, extra, need

    asked = pytest.raises(MissingExtra, match="^pymoo is missing: it comes with the extra studies, pip install ")
    with asked, extra("studies"):
        raise ModuleNotFoundError("No module named 'pymoo.core'", name="pymoo.core")
    with pytest.raises(ModuleNotFoundError, match="^No module named 'squealbox.gone'$"), extra("studies"):
        raise ModuleNotFoundError("No module named 'squealbox.gone'", name="squealbox.gone")  # our own mistake
    with pytest.raises(MissingExtra, match="^nothing_here is missing"):
        need("fe", "numpy", "nothing_here")
