"""The first page keeps its word: its example runs, its commands exist, its picture is there."""

import re
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
