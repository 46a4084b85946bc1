"""What the package imports is what it says it depends on."""

import ast
import sys
import tomllib

import pytest

from house.rooms import PACKAGE, PROJECT

# import name to the name it is installed by, where they differ
DISTRIBUTIONS = {"dask": "distributed", "skfem": "scikit-fem"}
PROJECT_TABLE = tomllib.loads((PROJECT / "pyproject.toml").read_text())["project"]
# Rooms, or single files, that may use an extra, and which one.
EXTRAS = {
    "signals": "recordings", "studies": "studies", "workbench": "workbench", "fe": "fe", "factorisation.py": "fe",
    "control": "control", "signals/quality.py": "sound",
}  # fmt: skip


def declared(requirements) -> set[str]:
    """The bare names of a list of requirements."""
    return {item.replace("[", ">").split(">")[0].strip() for item in requirements}


def third_party(text: str) -> set[str]:
    """Top-level packages the source imports, without the standard library and this package."""
    found = set()
    tree = ast.parse(text)
    for node in ast.walk(tree):
        if isinstance(node, ast.If) and ast.unparse(node.test) == "TYPE_CHECKING":
            node.body = [ast.Pass()]  # read by type checkers only
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name.split(".")[0] for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.level == 0 and node.module:
            found.add(node.module.split(".")[0])
    return {DISTRIBUTIONS.get(name, name) for name in found - set(sys.stdlib_module_names) - {"squealbox"}}


@pytest.mark.parametrize("path", sorted(PACKAGE.rglob("*.py")), ids=lambda path: str(path.relative_to(PACKAGE)))
def test_imports_are_declared(path):
    place = path.relative_to(PACKAGE)
    extra = PROJECT_TABLE["optional-dependencies"].get(EXTRAS.get(str(place), EXTRAS.get(place.parts[0], "")), [])
    assert third_party(path.read_text()) <= declared(PROJECT_TABLE["dependencies"]) | declared(extra)


def test_the_pages_are_built_with_what_their_cells_run():
    """`make docs` of a fresh clone installs the extra `docs` alone."""
    itself = PROJECT_TABLE["optional-dependencies"]["docs"][0]
    assert set(EXTRAS.values()) <= set(itself.removeprefix("squealbox[").removesuffix("]").split(","))


def test_an_undeclared_import_is_seen():
    assert third_party("import numpy\nimport os\ndef f():\n    from bokeh.io import show\n") == {"numpy", "bokeh"}
