"""The examples as programs run, and their notebooks are the same cells."""

import os
import runpy
import subprocess
import sys

import pytest

from house.rooms import PROJECT

FOLDER = PROJECT / "examples" / "python"
MADE = runpy.run_path(str(FOLDER / "notebooks.py"))


@pytest.mark.parametrize("name", MADE["EXAMPLES"])
def test_a_notebook_has_the_cells_of_its_program(name):
    source = (FOLDER / f"{name}.py").read_text()
    assert (FOLDER / f"{name}.ipynb").read_text() == MADE["notebook"](source)
    assert MADE["notebook"](source.replace("print(", "print( ")) != MADE["notebook"](source)


@pytest.mark.parametrize("name", MADE["EXAMPLES"])
def test_a_program_runs(name, tmp_path):
    command = [sys.executable, "-W", "error", str(FOLDER / f"{name}.py")]
    environment = {**os.environ, "MPLBACKEND": "Agg"}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, timeout=600)
    assert done.returncode == 0, done.stderr
    assert done.stdout.strip()
