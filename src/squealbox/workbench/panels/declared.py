"""What stands in a panel: its title, the choices in its head, the places of its figures.

Each panel's file says it in ``PANEL = Panel(...)`` with the words of this module alone: the page knows it before the
file, which may load half the house, is first needed. An option that an analysis has is declared on the analysis' sheet,
``of="remedies.SilenceSettings"``: what is said here is what the page calls it and has otherwise.
"""

from dataclasses import dataclass
from math import inf
from pathlib import Path
from typing import Any

from squealbox.parameters import field_type, load_kind

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
        choices = [told(each) for each in self.choices if each.get("text", name)]
        return {**vars(self), "name": name, "choices": choices, "figures": [vars(each) for each in self.figures],
                "script": (SCRIPTS / f"{name}.js").is_file()}  # fmt: skip


Choice = dict[str, Any]


def over(text: str, name: str, *usual: str, span: str = "span") -> Choice:
    """A choice among the parameters that can be varied: the option `name`; the ends of its axis `span`, "" for none."""
    return {"kind": "over", **locals()}


def words(text: str, name: str, *options: tuple[str, str], usual: str | None = None, of: str = "") -> Choice:
    """A choice among words (value, as it is read); the first is usual. Values that are numbers are sent as numbers.

    Without a text it is no choice in the head, but an option of the question all the same; so is a number.
    """
    numbers = all(value.replace(".", "").isdigit() for value, _ in options)
    usual = usual or (None if of else options[0][0])
    return {"kind": "words", **locals()}


def number(
    text: str, name: str, usual: float | None = None, low: float | None = None, high: float | None = None,
    step: float | str = "any", of: str = "",
) -> Choice:  # fmt: skip
    """A number to be typed, the option `name`."""
    return {"kind": "number", **locals()}


def shared(panel: str, name: str) -> Choice:
    """The option `name` as it was chosen in another panel."""
    return {"kind": "shared", **locals()}


def told(choice: Choice) -> Choice:
    """A choice with what it leaves to the sheet it is of."""
    if not choice.get("of"):
        return choice
    sheet, name = load_kind(choice["of"]), choice["name"]
    both = (vars(sheet.parameters().get(name) or sheet.choices()[name]), choice)
    about = {key: value for part in both for key, value in part.items() if value not in (None, inf, -inf)}
    return {"usual": getattr(sheet, name), "whole": field_type(sheet, name) is int, **about}


FREEDOM = {"kind": "freedom", "text": "of"}  # a choice among the degrees of freedom that the answer names
START = (  # of a motion, and the push as a share of the static deflection
    words("start", "start", ("push", "steady sliding, pushed"), ("rest", "loads applied at rest"),
          ("sliding", "steady sliding")),
    words("push", "push", ("0.001", "0.1 %"), ("0.05", "5 %"), ("0.5", "50 %"), ("2", "200 %"), usual="0.05"),
)  # fmt: skip
FRICTION = "friction.static"
OVER = over("over", "parameter", FRICTION)
LOADS = ("load", "load1", "sliding_speed", "theta1")
