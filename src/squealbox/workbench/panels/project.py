"""The designs of the project side by side: state, worst mode, critical friction with its margin, and notes."""

import functools
from typing import Any

import numpy as np

from squealbox.design import Design
from squealbox.files import DesignFileError, read_text
from squealbox.stability import mechanism
from squealbox.words import number, quantity
from squealbox.workbench.folder import LARGEST_TEXT, Project, ProjectError, standing
from squealbox.workbench.panels.declared import Panel
from squealbox.workbench.panels.modes import crossings_of, modes_of
from squealbox.workbench.panels.panel import NONE, Answer, Elsewhere, Options, Work
from squealbox.workbench.session import LARGE, PER_CUBE

PANEL = Panel("Project", questions=("project",), columns=2, slow=True, light=True)

NO_DESIGN = "No design yet: name the one on the page and save it, or begin with a preset."
FRICTION = "friction.static"  # whose critical value is tabled


def answer(design: Design, options: Options, work: Work) -> Answer:
    """A row for each design of the project; what cannot be read or computed says so in its row."""
    project = Project(standing())
    names = [name.removesuffix(".toml") for name in project.names("designs", ".toml")]
    rows = []
    for i, name in enumerate(names):
        work.progress(i / len(names), name)
        rows.append({**project.about("designs", f"{name}.toml"), "name": name, **_row(project, name, work)})
    return Answer({"rows": rows, "marks": {"designs": len(rows)}, "words": "" if rows else NO_DESIGN})


def _row(project: Project, name: str, work: Work) -> dict[str, Any]:
    row: dict[str, Any] = {"wrong": "", "note": "", "state": "", "numbers": [NONE] * 4}
    try:
        row["note"] = str(project.data("designs", f"{name}.json").get("note") or "")
    except ProjectError as error:
        row["wrong"] = str(error)
    try:
        text = project.text("designs", f"{name}.toml")
        if len(text) > LARGEST_TEXT:
            raise ProjectError(f"{name}.toml is too long")
        return row | _numbers(text, work.apart)
    except ProjectError as error:
        return {**row, "wrong": str(error)}
    except DesignFileError as error:
        first = error.problems[0]
        place = f"line {first.line}: " * bool(first.line) + f"{first.key}: " * bool(first.key)
        return {**row, "wrong": f"{place}{first.message}"}
    except Elsewhere:
        raise
    except Exception as error:  # one design that cannot be computed does not take the table from the others
        return {**row, "wrong": f"{type(error).__name__}: {error}"[:300]}


@functools.lru_cache(maxsize=2000)
def _numbers(text: str, apart: bool) -> dict[str, Any]:
    """What compares a design; a large one is computed in a process of its own."""
    design = read_text(text, "the file", beside=False).design
    size = design.system().size
    if size > LARGE and not apart:
        raise Elsewhere(f"computing, one design has {size} degrees of freedom", PER_CUBE * size**3)
    with np.errstate(all="ignore"):
        modes = modes_of(design)
        if not bool(modes.exists):
            return {"state": "no steady sliding"}
        stable, worst = bool(modes.stable), modes.most_unstable
        state = "stable" if stable else f"unstable, {mechanism(design).name.replace('_', ' ')}"
        numbers = [quantity(worst.frequency, "Hz"), number(worst.growth_rate, 3), *_critical(design)]
    return {"state": state, "numbers": numbers}


def _critical(design: Design) -> list[str]:
    """The critical friction nearest to that of the design, and the margin to it in per cent."""
    options = Options({})
    if options.parameter("parameter", design, FRICTION) != FRICTION:
        return [NONE, NONE]
    span, value = options.span("span", design, FRICTION), float(design.value_of(FRICTION))
    near = crossings_of(design, FRICTION, span).nearest(value)
    if near is None:
        return [NONE, NONE]
    nearest = float(near.value)
    return [number(nearest, 4), f"{number(100.0 * (nearest - value) / value, 3)} %" if value else NONE]
