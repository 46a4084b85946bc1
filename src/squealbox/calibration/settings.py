"""What of `calibrate` and of the recording it is fitted to can be set, for files and the command line."""

from dataclasses import field

from squealbox.calibration.calibrating import LOSSES
from squealbox.parameters import DataSheet, choice, parameter
from squealbox.signals import EventSettings


class CalibrateSettings(DataSheet):
    """[calibrate]: how parameters are fitted to measured numbers."""

    loss: str = choice(
        *LOSSES, default="squares",
        meaning="of the residuals; under robust one bad number does not pull the rest",
    )  # fmt: skip
    level: float = parameter("-", 0.0, 1.0, low_open=True, high_open=True, default=0.95, meaning="of the intervals")
    seed: int = parameter("-", 0, default=0, meaning="of the first points")


class Recorded(EventSettings):
    """[recording]: a recording beside the design file, what its numbers are worth, and what counts as squeal.

    Without a band squeal is looked for where it is usual, and as far down as half the frequency that is expected.
    """

    file: str = field(kw_only=True)
