"""How a limit cycle is looked for, for the command line."""

from squealbox.parameters import DataSheet, parameter


class CycleSettings(DataSheet):
    """What `shooting` begins with, and what is asked of the cycle besides."""

    period: float | None = parameter(
        "s", 0.0, low_open=True, default=None, optional=True,
        meaning="with --start, a state taken to be on the cycle already, which also finds unstable ones: 12ms",
    )  # fmt: skip
    settle: float | None = parameter(
        "s", 0.0, low_open=True, default=None, optional=True,
        meaning="length of the run to the cycle; left out, 300 periods of the slowest mode: 2s",
    )  # fmt: skip
    exponents: int = parameter(
        "-", 0, default=0,
        meaning="number of periods over which Lyapunov exponents are computed as well, such as 50; where no cycle is "
        "found, of the motion from rest after 300 periods of the slowest mode",
    )  # fmt: skip
