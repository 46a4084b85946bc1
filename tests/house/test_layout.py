"""The walls: no drawers for odds and ends, short files, the pages every visitor looks for."""

import ast

import pytest

from house.rooms import PACKAGE, PROJECT, module_names

BANNED = {"utils", "util", "core", "common", "helpers", "helper", "misc", "tools"}
LINES = 400
UNFINISHED = ("TO" + "DO", "FIX" + "ME", "XX" + "X")

SOURCES = sorted(PACKAGE.rglob("*.py"))
TESTS = sorted((PROJECT / "tests").rglob("*.py"))


def drawers(names) -> list[str]:
    """The dotted names with a banned part."""
    return [name for name in names if BANNED & {part.strip("_") for part in name.split(".")}]


def test_no_module_is_a_drawer():
    assert drawers(module_names()) == []


def test_a_drawer_is_found():
    assert drawers(["squealbox.system", "squealbox.stability._utils"]) == ["squealbox.stability._utils"]


@pytest.mark.parametrize("path", [*SOURCES, *TESTS], ids=lambda path: str(path.relative_to(PROJECT)))
def test_file_is_short_and_finished(path):
    text = path.read_text()
    assert text.count("\n") <= LINES, f"{path.name} has more than {LINES} lines: split it by what its parts answer"
    assert not [word for word in UNFINISHED if word in text]


@pytest.mark.parametrize("path", SOURCES, ids=lambda path: str(path.relative_to(PROJECT)))
def test_no_star_import_and_no_silent_except(path):
    for node in ast.walk(ast.parse(path.read_text())):
        assert not (isinstance(node, ast.ImportFrom) and any(alias.name == "*" for alias in node.names)), node.lineno
        if isinstance(node, ast.ExceptHandler):
            assert node.type is not None, f"line {node.lineno}: a bare except hides what went wrong"
            assert not isinstance(node.body[0], ast.Pass), f"line {node.lineno}: an error is swallowed"


@pytest.mark.parametrize("name", ["README.md", "CONVENTIONS.md", "CHANGELOG.md", "LICENSE", "docs/house.md"])
def test_page_is_there(name):
    assert (PROJECT / name).read_text().strip()


def test_types_are_shipped():
    assert (PACKAGE / "py.typed").exists()
