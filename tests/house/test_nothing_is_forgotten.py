"""A law, design, method, result, panel or command is one file, an example and a line in the pages (CONTRIBUTING.md).

Each function here returns what one of them still lacks, a sentence each; `test_adding.py` sees that they are found.
"""

import ast
import dataclasses
import importlib
import pkgutil

import pytest

import squealbox
from house.rooms import PROJECT
from law_examples import LAWS as EXAMPLES_OF_LAWS
from squealbox.cli import COMMANDS
from squealbox.designs import DESIGNS, Design
from squealbox.fit import FITTED
from squealbox.friction import LAW_NAMES
from squealbox.plots import plot
from squealbox.plots.brakes import draws
from squealbox.result import Result
from squealbox.transient.methods import TABLEAUX
from squealbox.workbench.panels import PANELS
from squealbox.workbench.state import CHOOSABLE

FOLDER = "CONTRIBUTING.md tells how"
NEITHER = {"table"}  # its points come from a measurement, not from another law or from a fit
UNFITTED = {"dahl"}  # slides as Coulomb's law does


def page(name: str) -> str:
    """The text of a page."""
    return (PROJECT / name).read_text(encoding="utf-8")


def laws() -> list[str]:
    """What friction laws lack."""
    lacks = []
    for name, law in LAW_NAMES.items():
        if law not in {type(each) for each in EXAMPLES_OF_LAWS}:
            lacks.append(f"the law {law.__name__} has no example in tests/law_examples.py")
        if name not in (*CHOOSABLE, *NEITHER):
            lacks.append(f"the law {law.__name__} cannot be chosen on the page: write its `like`")
        if name not in (*FITTED, *NEITHER, *UNFITTED):
            lacks.append(f"the law {law.__name__} cannot be fitted: write its `guess`")
    return lacks


def designs() -> list[str]:
    """What designs lack."""
    gallery = "".join(path.read_text(encoding="utf-8") for path in (PROJECT / "docs/gallery").glob("*.md"))
    cases = ast.parse(page("tests/agreements/test_cycles_of_every_design.py"))
    told = next(node.value for node in cases.body if isinstance(node, ast.Assign) and node.targets[0].id == "CASES")
    tried = {key.value for key in told.keys}
    lacks = []
    for name, kind in DESIGNS.items():
        if not kind.title or not kind.source:
            lacks.append(f"the design {kind.__name__} says no `title` or no `source`")
        if not draws(kind):
            lacks.append(f"the design {kind.__name__} is not drawn: write its `draw`")
        if kind.__name__ not in gallery:
            lacks.append(f"the design {kind.__name__} stands on no page of docs/gallery")
        if name not in tried:
            lacks.append(f"the design {kind.__name__} has no case in tests/agreements/test_cycles_of_every_design.py")
    return lacks


def methods() -> list[str]:
    """What methods lack."""
    text = page("docs/transients.md")
    lacks = [f'the method "{name}" has no line in docs/transients.md' for name in TABLEAUX if f'"{name}"' not in text]
    return lacks + [f"{make()} is called {name}" for name, make in TABLEAUX.items() if make().name != name]


def results() -> list[str]:
    """What results lack."""
    from result_examples import EXAMPLES

    for module in pkgutil.walk_packages(squealbox.__path__, "squealbox."):
        if module.name.split(".")[1] not in ("cli", "workbench", "report", "papers", "plots"):
            importlib.import_module(module.name)
    lacks = []
    for kind in [kind for kind in Result.kinds.values() if kind.__module__.startswith("squealbox.")]:
        if kind.__name__ not in EXAMPLES:
            lacks.append(f"the result {kind.__name__} has no example in tests/result_examples.py")
        if plot.dispatch(kind) is plot.dispatch(object):
            lacks.append(f"the result {kind.__name__} has no figure: register a function in src/squealbox/plots")
        if not kind.__dataclass_params__.frozen:
            lacks.append(f"the result {kind.__name__} is not frozen")
        for field in dataclasses.fields(kind):
            if "dims" in field.metadata and not field.metadata["meaning"]:
                lacks.append(f"the result {kind.__name__} does not say what its {field.name} is")
    return lacks


def panels() -> list[str]:
    """What panels lack."""
    text, script = page("docs/workbench.md").casefold(), page("src/squealbox/workbench/static/questions.js")
    lacks = []
    for name, panel in PANELS.items():
        module = importlib.import_module(f"squealbox.workbench.panels.{name}")
        if panel != module.PANEL:
            lacks.append(f"panels/{name}.py says another PANEL than its text does: use the words of declared.py alone")
        if not callable(getattr(module, "answer", None)):
            lacks.append(f"panels/{name}.py has no function `answer`")
        for question in panel.questions:
            if f'["{question}", ' not in script:
                lacks.append(f"panels/{name}.py answers {question!r}, which static/questions.js does not ask")
        if panel.questions and panel.title.partition(":")[0].casefold() not in text:
            lacks.append(f"the panel {panel.title!r} is not told of in docs/workbench.md")
    return lacks


def commands() -> list[str]:
    """What commands lack."""
    text, lacks = page("docs/cli.md"), []
    for name, command in COMMANDS.items():
        module = importlib.import_module(f"squealbox.cli.{command.module}")
        if not callable(getattr(module, command.function, None)):
            lacks.append(f"cli/{command.module}.py has no function `{command.function}`, which its ABOUT names")
        if f"| `squealbox {name}" not in text:
            lacks.append(f"the command {name} has no line in docs/cli.md")
    return lacks


NOUNS = {each.__name__: each for each in (laws, designs, methods, results, panels, commands)}


@pytest.mark.parametrize("noun", NOUNS)
def test_nothing_is_forgotten(noun):
    lacks = NOUNS[noun]()
    assert not lacks, f"{'; '.join(lacks)} ({FOLDER})"


def test_every_design_is_a_design():
    assert all(issubclass(kind, Design) for kind in DESIGNS.values())
