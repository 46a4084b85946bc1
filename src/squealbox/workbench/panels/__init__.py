"""The panels of the workbench: one Python file here, one ES module of the same name in ``static/panels/``.

A panel's file has one function ``answer(design, options, work) -> Answer``. `PANELS` names the panels in the order of
the page; a file is imported when its panel is first asked.
"""

import importlib
from dataclasses import dataclass

from squealbox.workbench.panels.panel import Answer, Elsewhere, Function, OptionError, Options, Stopped, Work


@dataclass(frozen=True)
class Panel:
    """A panel: its title, how wide it is in columns of the page, and whether its answer may take seconds.

    `apart`: it is computed in a process of its own, which takes a second to start and can be ended at any instant.
    `single`: it takes one spectrum, which brakes of 160 degrees of freedom have at once.
    """

    title: str
    columns: int = 1
    slow: bool = False
    apart: bool = False
    single: bool = False
    light: bool = False  # no more work for a large brake than for a small one
    shown: bool = True  # False: it answers the page itself, not a place on it


PANELS: dict[str, Panel] = {
    "moving": Panel("The brake, slowed down", single=True),
    "mesh": Panel("Its surface", light=True, shown=False),
    "drawing": Panel("The brake", light=True, shown=False),
    "verdict": Panel("Verdict", shown=False),
    "locus": Panel("Modes over a parameter", columns=2),
    "map": Panel("Stability map", slow=True),
    "friction": Panel("Friction curve"),
    "motion": Panel("Motion", columns=2, slow=True),
    "energy": Panel("Energy by contact"),
    "sensitivity": Panel("Which parameter to change", slow=True),
    "branch": Panel("Limit cycles over a parameter", slow=True, apart=True),
    "silence": Panel("Cures", columns=2, slow=True, apart=True),
    "target": Panel("A target", slow=True),
    "listen": Panel("Listen", slow=True),
    "compare": Panel("Compare two designs", columns=2),
    "recording": Panel("Recording", columns=2, slow=True),
    "calibrate": Panel("Calibrate", columns=2, slow=True, apart=True),
    "report": Panel("Report", slow=True, apart=True),
    "tour": Panel("Tour: the drum-brake paper of 2011", slow=True, apart=True),
}


def function_of(name: str) -> Function:
    """The function that answers a panel."""
    module = importlib.import_module(f"squealbox.workbench.panels.{name}")
    function: Function = module.answer
    return function


__all__ = ["PANELS", "Answer", "Elsewhere", "OptionError", "Options", "Panel", "Stopped", "Work", "function_of"]
