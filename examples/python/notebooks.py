"""Write the examples beside this file as notebooks: `python examples/python/notebooks.py`. A test sees them agree."""

import json
import re
from pathlib import Path

FOLDER = Path(__file__).parent
EXAMPLES = ("first_steps", "own_matrices", "study")


def notebook(source: str) -> str:
    """The notebook of a program whose cells begin with `# %% title`."""
    head, *cells = re.split(r"^# %% ", source, flags=re.MULTILINE)
    found = [{"cell_type": "markdown", "id": "0", "metadata": {}, "source": head.strip().strip('"').partition(". ")[0]}]
    for i, cell in enumerate(cells):
        title, _, code = cell.partition("\n")
        found.append({"cell_type": "markdown", "id": f"{i + 1}a", "metadata": {}, "source": f"## {title}"})
        found.append({"cell_type": "code", "id": f"{i + 1}b", "metadata": {}, "execution_count": None, "outputs": [],
                      "source": code.strip()})  # fmt: skip
    kernel = {"kernelspec": {"name": "python3", "display_name": "Python 3", "language": "python"}}
    return json.dumps({"cells": found, "metadata": kernel, "nbformat": 4, "nbformat_minor": 5}, indent=1) + "\n"


def main() -> None:
    """Write each notebook beside its program."""
    for name in EXAMPLES:
        text = (FOLDER / f"{name}.py").read_text(encoding="utf-8")
        (FOLDER / f"{name}.ipynb").write_text(notebook(text), encoding="utf-8")


if __name__ == "__main__":
    main()
