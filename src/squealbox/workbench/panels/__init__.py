"""The panels of the workbench: one Python file each, and a script in ``static/panels/`` where one does more than show.

A panel's file has one function ``answer(design, options, work) -> Answer``. `PANELS` names the panels in the order of
the page, with what stands in them; a file is imported when its panel is first asked.
"""

import importlib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from squealbox.workbench.panels.panel import Answer, Elsewhere, Function, OptionError, Options, Stopped, Work

SCRIPTS = Path(__file__).parents[1] / "static" / "panels"


@dataclass(frozen=True)
class Place:
    """The place of a figure: its name, its title, its height [px] where the page does not decide, and its sketch."""

    name: str
    title: str = ""
    height: int = 230
    like: str = "wave"  # "bent", "events"
    awaited: str = "being computed"
    bars: bool = False


@dataclass(frozen=True)
class Panel:
    """A panel: its title, how wide it is in columns of the page, and whether its answer may take seconds.

    `choices` stand in its head and become options of the question, `figures` are drawn as its answer describes them.
    `along`: the answer is the same for all values of the parameters along its axes. `apart`: it is computed in a
    process of its own, which takes a second to start and can be ended at any instant.
    `single`: it takes one spectrum, which brakes of 160 degrees of freedom have at once.
    """

    title: str
    columns: int = 1
    slow: bool = False
    apart: bool = False
    single: bool = False
    light: bool = False  # no more work for a large brake than for a small one
    shown: bool = True  # False: it answers the page itself, not a place on it
    along: bool = False
    choices: tuple[dict[str, Any], ...] = ()
    figures: tuple[Place, ...] = ()
    layout: str = ""  # "two", "three": figures beside each other
    table: str = ""  # the name of its table, where it has one

    def data(self, name: str) -> dict[str, Any]:
        """For the page."""
        return {**vars(self), "name": name, "figures": [vars(each) for each in self.figures],
                "script": (SCRIPTS / f"{name}.js").is_file()}  # fmt: skip


def over(text: str, name: str, *usual: str, span: str = "span") -> dict[str, Any]:
    """A choice among the parameters that can be varied: the option `name`; the ends of its axis `span`, "" for none."""
    return {"kind": "over", "text": text, "name": name, "usual": usual, "span": span}


def words(text: str, name: str, *options: tuple[str, str], usual: str = "") -> dict[str, Any]:
    """A choice among words (value, as it is read); the first is usual. Values that are numbers are sent as numbers."""
    numbers = all(value.replace(".", "").isdigit() for value, _ in options)
    return {"kind": "words", "text": text, "name": name, "options": options, "usual": usual or options[0][0],
            "numbers": numbers}  # fmt: skip


def number(text: str, name: str, usual: float, low: float, high: float, step: float) -> dict[str, Any]:
    """A number to be typed, the option `name`."""
    return {"kind": "number", "text": text, "name": name, "usual": usual, "low": low, "high": high, "step": step}


def shared(panel: str, name: str) -> dict[str, Any]:
    """The option `name` as it was chosen in another panel."""
    return {"kind": "shared", "name": name, "panel": panel}


FREEDOM = {"kind": "freedom", "text": "of"}  # a choice among the degrees of freedom that the answer names
FRICTION = "friction.static"
LOADS = ("load", "load1", "sliding_speed", "theta1")
STARTS = (("push", "steady sliding, pushed"), ("rest", "loads applied at rest"), ("sliding", "steady sliding"))
STEPS = (("percent", "+1 %"), ("tolerance", "one tolerance"))
SLOWED = (("1", "true"), ("8", "slowed 8 times"), ("32", "slowed 32 times"))
STOPS = (("0", "as it slides"), *((f"{s:g}", f"braking to rest in {s:g} s") for s in (0.5, 1, 2, 4)))
SHOWN = (("growth", "growth rate"), ("frequency", "frequency"), ("mechanism", "mechanism"))
PUSHES = (("0.001", "0.1 %"), ("0.05", "5 %"), ("0.5", "50 %"), ("2", "200 %"))

PANELS: dict[str, Panel] = {
    "moving": Panel("The brake, slowed down", single=True),
    "mesh": Panel("Its surface", light=True, shown=False),
    "drawing": Panel("The brake", light=True, shown=False),
    "verdict": Panel("Verdict", shown=False),
    "locus": Panel(
        "Modes over a parameter", columns=2, choices=(over("over", "parameter", FRICTION),), layout="three",
        figures=(Place("frequency", "Frequency", 216), Place("growth", "Growth rate (above zero: squeal)", 216),
                 Place("plane", "Eigenvalue plane", 216)),
    ),
    "map": Panel(
        "Stability map", slow=True, along=True, figures=(Place("map", "", 300),),
        choices=(over("x", "x", FRICTION, span="xspan"), over("y", "y", *LOADS, span="yspan"),
                 words("show", "show", *SHOWN)),
    ),
    "friction": Panel("Friction curve", figures=(Place("friction", "", 300),), table="Contacts in steady sliding"),
    "motion": Panel(
        "Motion", columns=2, slow=True, layout="two",
        choices=(words("start", "start", *STARTS), words("push", "push", *PUSHES, usual="0.05"), FREEDOM),
        figures=(Place("time", "Displacement", 190), Place("spectrum", "Spectrum of the second half", 190),
                 Place("phase", "Phase plane of the second half"), Place("spectrogram", "Spectrogram")),
    ),
    "energy": Panel("Energy by contact", figures=(Place("energy", bars=True),), choices=(shared("moving", "mode"),)),
    "sensitivity": Panel(
        "Which parameter to change", slow=True, choices=(words("for", "step", *STEPS),),
        figures=(Place("sensitivity", bars=True),), layout="beside",
    ),
    "branch": Panel(
        "Limit cycles over a parameter", slow=True, apart=True, along=True,
        choices=(over("over", "parameter", FRICTION), FREEDOM),
        figures=(Place("branch", "", 270, "bent", "amplitude of the cycles: press Follow"),),
    ),
    "silence": Panel("Cures", columns=2, slow=True, apart=True),
    "target": Panel(
        "A target", slow=True, figures=(Place("lot", "", 150),),
        choices=(number("friction", "friction", 0.45, 0.01, 5.0, 0.01), number("for %", "share", 95.0, 1.0, 99.9, 0.1)),
    ),
    "listen": Panel(
        "Listen", slow=True, choices=(FREEDOM, words("heard", "slow", *SLOWED), words("while", "braking", *STOPS)),
        figures=(Place("sound", "", 170, awaited="the sound: press Play"),),
    ),
    "compare": Panel(
        "Compare two designs", columns=2, choices=(over("over", "parameter", FRICTION),), layout="two",
        figures=(Place("frequency", "Frequencies", 200), Place("growth", "Growth rate", 200)),
        table="The two designs in numbers",
    ),
    "recording": Panel(
        "Recording", columns=2, slow=True, layout="two", table="Squeal events",
        figures=(Place("recording", "Spectrogram with the events", 230, "events",
                       "drop a recording here: WAV, FLAC, CSV, UFF"),),
    ),
    "calibrate": Panel(
        "Calibrate", columns=2, slow=True, apart=True, table="Fitted values",
        choices=(over("fit", "p0", FRICTION, span=""), over("and", "p1", "k3", "k2", "k", "k11", span=""),
                 words("within", "share", ("0.1", "10 %"), ("0.3", "30 %"), ("0.6", "60 %"), usual="0.3")),
    ),
    "report": Panel("Report", slow=True, apart=True),
    "project": Panel("Project", columns=2, slow=True, light=True),
    "tour": Panel("Tour: the drum-brake paper of 2011", slow=True, apart=True),
}  # fmt: skip


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
