"""Importing the package, and asking it the first question, loads only what is needed for it."""

import json
import subprocess
import sys
from types import ModuleType

import pytest

from squealbox import DrumBrake

HEAVY = {
    "numba", "llvmlite", "matplotlib", "xarray", "pandas", "h5py", "pydantic", "pint", "rich", "cyclopts", "dask",
    "distributed", "jinja2",
}  # fmt: skip
BRAKE = "import squealbox as sb; brake = sb.DrumBrake(friction=sb.LinearSlope(0.45, -0.05))\n"
FIRST_QUESTIONS = BRAKE + "sb.complex_modes(brake); sb.critical_value(brake, 'friction.static', (0.0, 0.6))"


def loaded_by(code: str) -> set[str]:
    """The heavy packages a fresh interpreter has loaded after running `code`."""
    script = f"{code}\nimport json, sys; print(json.dumps(sorted(sys.modules)))"
    done = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True, timeout=60)
    return HEAVY & set(json.loads(done.stdout.splitlines()[-1]))


@pytest.mark.parametrize("code", ["import squealbox", "from squealbox import *", FIRST_QUESTIONS])
def test_nothing_heavy_is_loaded(code):
    assert loaded_by(code) == set()


def test_a_heavy_import_is_seen():
    assert loaded_by("import jinja2") == {"jinja2"}


def test_a_system_is_made_while_another_thread_loads_sparse_matrices(monkeypatch):
    """A module in the making is in sys.modules already, without what it will have."""
    monkeypatch.setitem(sys.modules, "scipy.sparse", ModuleType("scipy.sparse"))
    assert not DrumBrake().system().is_sparse
