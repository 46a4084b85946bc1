"""Where branches of cycles are looked for, for the command line."""

from collections.abc import Mapping
from typing import ClassVar

from squealbox.parameters import DataSheet, choice, parameter


class BranchSettings(DataSheet):
    """Where branches begin: at the onset, and in what runs settle to, as `isolated_branches` has it."""

    told: ClassVar[Mapping[str, tuple[str, str]]] = {
        "estimates": (
            "", "quick estimates beside the branches: describing function, and averaging for a block on a belt"
        )
    }  # fmt: skip

    start: str = choice(
        "all", "hopf", "runs", default="all",
        meaning="where branches begin: at the Hopf point of steady sliding, in what long runs settle to, or both",
    )  # fmt: skip
    runs: int = parameter("-", 1, default=12, meaning="number of runs from different states at each value")
    at: int = parameter("-", 1, default=3, meaning="number of values, evenly inside the range, at which runs are made")
    estimates: bool = True
