"""The first page keeps its word: its example runs, its commands exist, its picture is there."""

import re
import runpy
import subprocess
import sys

from house.rooms import PROJECT

README = (PROJECT / "README.md").read_text()
MAKEFILE = (PROJECT / "Makefile").read_text()


def examples(text: str) -> list[str]:
    """The Python blocks of a Markdown page."""
    return re.findall(r"^```python\n(.*?)^```", text, flags=re.DOTALL | re.MULTILINE)


def test_the_example_runs_and_is_short(tmp_path):
    (example,) = examples(README)
    assert len([line for line in example.splitlines() if line.strip()]) <= 12
    done = subprocess.run([sys.executable, "-c", example], cwd=tmp_path, capture_output=True, text=True, timeout=200)
    assert done.returncode == 0, done.stderr


def test_the_commands_exist():
    commands = re.findall(r"(?:`|^)make (\w+)", README, flags=re.MULTILINE)
    assert {"demo", "test"} <= set(commands)
    for target in commands:
        assert re.search(rf"^{target}:", MAKEFILE, flags=re.MULTILINE), f"README names make {target}"


def test_links_and_pictures_exist():
    targets = re.findall(r"\]\(([^)#]+)", README)
    assert [target for target in targets if not (PROJECT / target).exists()] == []
    assert [target for target in targets if target.startswith("docs/images/")]


def test_the_numbers_of_the_paper_are_what_is_computed(tmp_path, capsys):
    """Recomputed as they stand; with one digit changed the program sees it."""
    paper, program = (PROJECT / "docs" / "paper" / name for name in ("paper.md", "recompute.py"))
    main = runpy.run_path(str(program))["main"]
    assert (main(), capsys.readouterr().out.count("NOT in the paper")) == (0, 0)
    (tmp_path / "paper.md").write_text(paper.read_text().replace("0.3327", "0.3328"))
    main.__globals__["PAPER"] = tmp_path / "paper.md"
    assert (main(), capsys.readouterr().out.count("NOT in the paper")) == (1, 1)


def test_the_brake_of_the_first_page_is_sound():
    """A newcomer's first answer is no caution that a shoe pulls; so is the file that `init` writes."""
    from squealbox import complex_modes
    from squealbox.files.beginnings import first_design

    (example,) = examples(README)
    line = next(line for line in example.splitlines() if line.startswith("brake = "))
    known: dict = {}
    exec("from squealbox import DrumBrake, LinearSlope\n" + line, known)
    for brake in (known["brake"], first_design("drum_brake")):
        modes = complex_modes(brake)
        assert not modes.stable
        assert "Caution" not in modes.summary()
