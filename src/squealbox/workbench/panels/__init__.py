"""The panels of the workbench: one Python file each, and a script in ``static/panels/`` where one does more than show.

A panel's file has ``PANEL = Panel(...)``, what stands in it, and one function ``answer(design, options, work) ->
Answer``. It is imported when its panel is first asked.
"""

import importlib
from pathlib import Path

from squealbox.registers import assigned
from squealbox.workbench.panels import declared
from squealbox.workbench.panels.declared import Panel, Place
from squealbox.workbench.panels.panel import Answer, Elsewhere, Function, OptionError, Options, Stopped, Work

_FIRST = (  # in the order of the page; a panel in a further file of this folder stands behind them
    "moving", "mesh", "drawing", "verdict", "locus", "map", "friction", "motion", "energy", "sensitivity", "branch",
    "silence", "target", "listen", "compare", "recording", "calibrate", "report", "project", "tour",
)  # fmt: skip
_FOUND = assigned(Path(__file__).parent, "PANEL")
PANELS: dict[str, Panel] = {name: eval(_FOUND[name], vars(declared)) for name in dict.fromkeys((*_FIRST, *_FOUND))}


def function_of(name: str) -> Function:
    """The function that answers a panel."""
    module = importlib.import_module(f"squealbox.workbench.panels.{name}")
    function: Function = module.answer
    return function


__all__ = [
    "PANELS",
    "Answer",
    "Elsewhere",
    "OptionError",
    "Options",
    "Panel",
    "Place",
    "Stopped",
    "Work",
    "function_of",
]
