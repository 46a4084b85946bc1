"""CONTRIBUTING.md is right: the files it shows, put into a copy of the package, are a law, a design, a method, a result
with its figure, a panel and a command, known everywhere at once; and what it says to do then is asked for."""

import json
import os
import re
import shutil
import subprocess
import sys

import pytest

from house.rooms import PACKAGE, PROJECT

FILES = re.findall(
    r"^`src/(squealbox/\S+\.py)`:\n\n```python\n(.*?)^```", (PROJECT / "CONTRIBUTING.md").read_text(), re.M | re.S
)
FIRST = ["Coulomb", "LinearSlope", "Stribeck", "Hyperbolic", "Cubic", "Table", "LuGre", "Dahl", "ElastoPlastic"]
USED = """
import json, sys
import numpy as np
from house import test_nothing_is_forgotten as house

import squealbox
from squealbox import DrumBrake, complex_modes, fit_friction, plot, read_design, simulate, write_design
from squealbox.cli import main
from squealbox.designs import TiltedBlock, drawing_of
from squealbox.friction import Gaussian, LAWS, Coulomb
from squealbox.plots import brake_drawing
from squealbox.result import Result
from squealbox.stability import friction_course
from squealbox.workbench.panels import PANELS, Options, Work, function_of
from squealbox.workbench.sheet import sheet
from squealbox.workbench.state import design_of

out = {"package": squealbox.__file__, "laws": [law.__name__ for law in LAWS]}
law = Gaussian(0.4, 0.25, 0.7)
brake = TiltedBlock(friction=law)

# from Python, and through a file
out["equal"] = read_design(write_design(brake, "brake.toml")) == brake
modes = complex_modes(brake)
out["stiffness"] = float(np.abs(modes.eigenvalues[0]) ** 2 * brake.m)
for method in ("usual", "heun-euler"):
    motion = simulate(brake, 0.02, method=None if method == "usual" else method)
    out[method] = [str(motion.outcome), float(motion.q[-1, 0])]
speeds = np.linspace(0.05, 2.0, 20)
out["fitted"] = fit_friction(speeds, law.mu(speeds), ["coulomb", "gaussian"]).law.speed

# the result, its file and its figure
course = friction_course(brake, [0.1, 0.2, 0.3])
course.save("course.nc")
out["growth"] = [course.growth.tolist(), Result.load("course.nc").growth.tolist()]
plot(course).savefig("course.png")
brake_drawing(brake).savefig("brake.png")
drawn = drawing_of(brake)
out["drawn"] = [drawn.places(), np.abs(drawn.moved(1)).max(), drawn.contacts_moved(1).tolist()]

# the page
chosen = design_of({"brake": "tilted_block", "laws": {"friction": "gaussian"}}, {})
out["chosen"] = [type(chosen).__name__, repr(chosen.friction)]
out["offered"] = next(each["options"] for each in sheet(brake)["fields"] if each["path"] == "friction")
out["panel"] = [PANELS["damping"].title, function_of("damping")(brake, Options({}), Work()).data["words"]]

# the command line
with open("brake.toml", "a") as file:
    file.write('\\n[simulate]\\nduration = "20 ms"\\nmethod = "heun-euler"\\n')
out["codes"] = [main(words.split()) for words in (
    "modes brake.toml", "slope brake.toml", "list gaussian", "list tilted_block", "list", "schema", "--help",
    "slope --help", "init made --brake tilted_block", "simulate brake.toml",
)]
out["lacks"] = {noun: lacks() for noun, lacks in house.NOUNS.items()}
print("\\n" + json.dumps(out))
"""


@pytest.fixture(scope="module")
def used(tmp_path_factory):
    """What a user gets of a copy with the files of the page, in one process."""
    folder = tmp_path_factory.mktemp("copy")
    shutil.copytree(PACKAGE, folder / "squealbox", ignore=shutil.ignore_patterns("__pycache__"))
    for place, text in FILES:
        assert not (folder / place).exists()
        (folder / place).write_text(text)
    face = folder / "squealbox/stability/__init__.pyi"
    names = "FrictionCourse", "friction_course"
    line = f"from .friction_course import {', '.join(names)}\n"
    face.write_text(line + face.read_text().replace("__all__ = [", f'__all__ = ["{names[0]}", "{names[1]}",'))
    paths = os.pathsep.join([str(folder), str(PROJECT / "tests")])
    done = subprocess.run([sys.executable, "-c", USED], capture_output=True, text=True, cwd=folder, timeout=300,
                          env={**os.environ, "PYTHONPATH": paths, "SQUEALBOX_TRACEBACK": "1"})  # fmt: skip
    assert done.returncode == 0, done.stderr[-3000:]
    said, _, last = done.stdout.rstrip().rpartition("\n")
    return {**json.loads(last), "folder": folder, "said": said}


def test_the_page_shows_one_file_of_each():
    rooms = [place.split("/")[1] for place, _ in FILES]
    assert rooms == ["friction", "designs", "transient", "stability", "plots", "workbench", "cli"]


def test_a_law_design_and_method_are_used(used):
    assert used["package"].startswith(str(used["folder"]))
    assert used["laws"][:9] == [
        "Coulomb",
        "LinearSlope",
        "Stribeck",
        "Hyperbolic",
        "Cubic",
        "Table",
        "LuGre",
        "Dahl",
        "ElastoPlastic",
    ]
    assert used["laws"][9:] == ["Gaussian"]
    assert used["equal"]
    # K_eff = k cos^2 + mu k sin cos with mu of the sliding speed, and m = 1 kg: |lambda|^2 = K_eff/m
    mu = 0.25 + 0.15 * 2.718281828459045 ** (-((0.5 / 0.7) ** 2))
    assert used["stiffness"] == pytest.approx(1e4 * (0.7701511529340699 + mu * 0.42073549240394825), rel=1e-9)
    assert used["usual"][0] == used["heun-euler"][0] == "completed"
    assert used["heun-euler"][1] == pytest.approx(used["usual"][1], rel=1e-3)  # a hundred times its tolerance
    assert used["fitted"] == pytest.approx(0.7, rel=1e-6)


def test_a_result_and_its_figure_are_used(used):
    computed, kept = used["growth"]
    assert computed == kept
    assert len(computed) == 3
    assert (used["folder"] / "course.png").stat().st_size > 1000
    places, most, touching = used["drawn"]
    assert set(places) == {"m", "k", "load", "sliding_speed"}
    assert places["m"] == [0.5, 0.3]  # the middle of the block
    assert (most, touching) == (1.0, [[[1.0, 0.0]]])  # the block and its contact go along x, nothing goes farther


def test_the_page_and_the_command_line_know_them(used):
    kind, law = used["chosen"]
    assert kind == "TiltedBlock"
    assert law.startswith("Gaussian(static=0.4, kinetic=0.4, speed=0.5")  # continues Coulomb(0.4)
    assert used["offered"][-1] == "gaussian"
    title, words = used["panel"]
    assert title == "Damping of the modes"
    assert words == "The least damping ratio is -0.0759."  # (c + N mu')/(2 sqrt(K m)), N = load/(1 + mu tan(tilt))
    assert used["codes"] == [0] * len(used["codes"])
    for word in ("pad: -0.1838 s/m", "heun-euler", "slope       how friction varies", '"gaussian"', '"tilted_block"'):
        assert word in used["said"], word


def test_what_is_forgotten_is_said(used):
    assert used["lacks"] == {
        "laws": ["the law Gaussian has no example in tests/law_examples.py"],
        "designs": [
            "the design TiltedBlock stands on no page of docs/gallery",
            "the design TiltedBlock has no case in tests/agreements/test_cycles_of_every_design.py",
        ],
        "methods": ['the method "heun-euler" has no line in docs/transients.md'],
        "results": ["the result FrictionCourse has no example in tests/result_examples.py"],
        "panels": ["the panel 'Damping of the modes' is not told of in docs/workbench.md"],
        "commands": ["the command slope has no line in docs/cli.md"],
    }
