"""What stands in a panel: its title, the choices in its head, the places of its figures.

Each panel's file says it in ``PANEL = Panel(...)`` with the words of this module alone: the page knows it before the
file, which may load half the house, is first needed.
"""

from dataclasses import dataclass
from pathlib import Path
from typing import Any

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
    questions: tuple[str, ...] = ()  # of the page's bar (static/questions.js); none: it answers the page itself
    columns: int = 1
    slow: bool = False
    apart: bool = False
    single: bool = False
    light: bool = False  # no more work for a large brake than for a small one
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
