"""What of `bifurcation_diagram` and `basin` can be set, for the command line."""

from collections.abc import Mapping
from typing import ClassVar, Literal

from squealbox.parameters import DataSheet, parameter


class DiagramSettings(DataSheet):
    """How far each value of a bifurcation diagram is looked at."""

    told: ClassVar[Mapping[str, tuple[str, str]]] = {"sweeps": ("", "some of up, down and rest")}

    sweeps: tuple[Literal["up", "down", "rest"], ...] = ("up", "down", "rest")
    starts: int = parameter("-", 0, default=0, meaning="further starts at every value, drawn about steady sliding")
    returns: int = parameter("-", 1, default=40, meaning="about how many points of the section are kept of each motion")
    duration: float | None = parameter(
        "s", 0.0, low_open=True, default=None, optional=True,
        meaning="of the first stretch at each value; what has not settled runs on",
    )  # fmt: skip
    seed: int = parameter("-", 0, default=0, meaning="of the drawn starts")


class BasinSettings(DataSheet):
    """Which starts are looked at."""

    starts: int = parameter("-", 1, default=1000, meaning="number of starts")
    spread: float = parameter("-", 0.0, low_open=True, default=1.0, meaning="size of the box, in V/w and V")
    duration: float | None = parameter(
        "s", 0.0, low_open=True, default=None, optional=True,
        meaning="of the first stretch of each motion; what has not settled runs on",
    )  # fmt: skip
    seed: int = parameter("-", 0, default=1, meaning="of the starts")
