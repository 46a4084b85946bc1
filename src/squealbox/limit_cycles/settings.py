"""What of `bifurcation_diagram`, `basin`, `shooting` and `isolated_branches` can be set, for the command line."""

from typing import Literal

from squealbox.parameters import DataSheet, above_zero, choice, free, parameter


class DiagramSettings(DataSheet):
    """How far each value of a bifurcation diagram is looked at."""

    sweeps: tuple[Literal["up", "down", "rest"], ...] = free(
        default=("up", "down", "rest"), meaning="some of up, down and rest"
    )
    starts: int = parameter("-", 0, default=0, meaning="further starts at every value, drawn about steady sliding")
    returns: int = parameter("-", 1, default=40, meaning="about how many points of the section are kept of each motion")
    duration: float | None = above_zero(
        "s", default=None, meaning="of the first stretch at each value; what has not settled runs on"
    )
    seed: int = parameter("-", 0, default=0, meaning="of the drawn starts")


class BasinSettings(DataSheet):
    """Which starts are looked at."""

    starts: int = parameter("-", 1, default=1000, meaning="number of starts")
    spread: float = parameter("-", 0.0, low_open=True, default=1.0, meaning="size of the box, in V/w and V")
    seed: int = parameter("-", 0, default=1, meaning="of the starts")


class CycleSettings(DataSheet):
    """What a cycle is looked for from, and what is asked of it besides."""

    period: float | None = above_zero(
        "s",
        default=None,
        meaning="with --start, a state taken to be on the cycle already; finds unstable ones, too: 12ms",
    )
    settle: float | None = above_zero(
        "s", default=None, meaning="length of the run to the cycle; left out, 300 periods of the slowest mode"
    )
    exponents: int = parameter(
        "-", 0, default=0,
        meaning="periods over which Lyapunov exponents are computed as well, such as 50; where no cycle is found, of "
        "the motion from rest after 300 periods of the slowest mode",
    )  # fmt: skip


class BranchSettings(DataSheet):
    """Where branches begin: at the onset, and in what runs settle to."""

    start: str = choice(
        "all", "hopf", "runs", default="all",
        meaning="where branches begin: at the Hopf point of steady sliding, in what long runs settle to, or both",
    )  # fmt: skip
    runs: int = parameter("-", 1, default=12, meaning="number of runs from different states at each value")
    at: int = parameter("-", 1, default=3, meaning="number of values, evenly inside the range, at which runs are made")
    estimates: bool = free(default=True, meaning="quick estimates drawn beside the branches")
