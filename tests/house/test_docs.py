"""The pages keep their word: every cell runs, and every room has its place in the house and in the reference."""

import re
import runpy
import shutil
import subprocess
import sys

import matplotlib as mpl
import pytest

from house.rooms import PACKAGE, PROJECT

DOCS = PROJECT / "docs"
PAGES = sorted(path for path in DOCS.rglob("*.md") if not {"_build", "paper"} & set(path.parts))
REFERENCE = "\n".join(path.read_text() for path in sorted((DOCS / "api").glob("*.md")))
HOUSE = (DOCS / "house.md").read_text()
ROOMS = sorted({path.stem for path in PACKAGE.iterdir() if path.suffix == ".py" or (path / "__init__.py").exists()})


def cells(text: str) -> str:
    """The code cells of a page, one after the other, without the notebook's own commands."""
    found = re.findall(r"^```\{code-cell\}[^\n]*\n(.*?)^```", text, flags=re.DOTALL | re.MULTILINE)
    lines = "\n".join(found).splitlines()
    return "\n".join(line for line in lines if not line.startswith((":tags:", "%")))


@pytest.mark.parametrize("path", [p for p in PAGES if "{code-cell}" in p.read_text()], ids=lambda path: path.stem)
def test_cells_run(path, tmp_path, monkeypatch):
    """With warnings as errors, in this process: `make docs` gives each page one of its own, which takes longer."""
    page = tmp_path / "page.py"  # a file, so that the source of its functions can be read
    page.write_text(cells(path.read_text()))
    monkeypatch.chdir(tmp_path)
    with mpl.rc_context():
        runpy.run_path(str(page), run_name="__main__")


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.stem)
def test_links_lead_somewhere(path):
    targets = re.findall(r"\]\(([^)#:]+)(?:#[^)]*)?\)", path.read_text())
    assert [target for target in targets if not (path.parent / target).exists()] == []


def built(source, folder) -> subprocess.CompletedProcess[str]:
    """The pages without their cells, which `test_cells_run` runs, and without names in the list of contents; a cell
    that is not run has no language.
    """
    settings = ["nb_execution_mode=off", "suppress_warnings=ref.python,myst-nb.lexer", "toc_object_entries=0"]
    command = [sys.executable, "-m", "sphinx", "-q", "--fail-on-warning", "-b", "html"]
    command += [word for setting in settings for word in ("-D", setting)]
    return subprocess.run([*command, str(source), str(folder)], capture_output=True, text=True, timeout=600)


def test_the_documentation_is_built_without_a_warning(tmp_path):
    done = built(DOCS, tmp_path)
    assert done.returncode == 0, done.stderr


def test_a_formula_beyond_the_converter_stops_the_build(tmp_path):
    source = tmp_path / "docs"
    source.mkdir()
    shutil.copytree(DOCS / "_ext", source / "_ext")
    shutil.copytree(DOCS / "_static", source / "_static")
    shutil.copy(DOCS / "conf.py", source)
    (source / "index.md").write_text("# One\n\n$0\\dots n$\n")
    done = built(source, tmp_path / "html")
    assert done.returncode != 0
    assert "dots" in done.stderr


@pytest.mark.parametrize("path", PAGES, ids=lambda path: path.stem)
def test_a_page_is_in_the_contents(path):
    name = str(path.relative_to(DOCS).with_suffix(""))
    contents = [line for page in ("index.md", "api.md") for line in (DOCS / page).read_text().splitlines()]
    assert name == "index" or name in contents


@pytest.mark.parametrize("room", [room for room in ROOMS if not room.startswith("_")])
def test_a_room_is_described(room):
    assert re.search(rf"^`{room}(\.py|/)`$", HOUSE, flags=re.MULTILINE), f"docs/house.md does not describe {room}"


# The command line and the papers are used by their commands, not from Python.
@pytest.mark.parametrize("room", [room for room in ROOMS if not room.startswith("_") and room not in ("cli", "papers")])
def test_a_room_is_in_the_reference(room):
    assert f".. automodule:: squealbox.{room}\n" in REFERENCE, f"docs/api/ does not list {room}"


def test_the_floors_of_the_page_are_those_of_the_contract():
    contract = (PROJECT / ".importlinter").read_text().partition("layers =")[2].partition("exhaustive")[0]
    kept = [line.strip().replace("(", "").replace(")", "") for line in contract.splitlines() if line.strip()]
    assert "\n".join(f"    {line}" for line in kept) in HOUSE


def stated(room: str) -> set[str] | None:
    """The rooms the page says this one depends on; None where it says so in words."""
    text = re.search(rf"^`{room}(?:\.py|/)`\n: (.*?)(?=\n\n)", HOUSE, flags=re.DOTALL | re.MULTILINE)[1]
    names = set(re.split(r",\s+", " ".join(text.rpartition("*Depends on:*")[2].split()).rstrip(".")))
    return names if names <= {*ROOMS, "nothing"} else None


def imported(room: str) -> set[str]:
    """The other rooms this one imports, anywhere in its files."""
    path = PACKAGE / room
    files = sorted(path.rglob("*.py")) if path.is_dir() else [path.with_suffix(".py")]
    found = re.findall(r"^\s*(?:from|import) squealbox\.(\w+)", "\n".join(f.read_text() for f in files), re.MULTILINE)
    return set(found) - {room}


@pytest.mark.parametrize("room", [room for room in ROOMS if not room.startswith("_")])
def test_a_room_depends_on_what_the_page_says(room):
    said = stated(room)
    if said is not None:
        assert imported(room) <= said


def test_formulas_have_no_dots_above_that_some_browsers_lose():
    """A derivative is a prime: without a mathematical font a dot above q lies on the q."""
    dotted = [path.name for path in PAGES if re.search(r"\\d?dot\b", path.read_text())]
    assert dotted == []
