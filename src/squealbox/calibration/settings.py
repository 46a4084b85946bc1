"""What of `calibrate` can be set, for files and the command line."""

from squealbox.calibration.calibrating import LOSSES
from squealbox.parameters import DataSheet, choice, parameter


class CalibrateSettings(DataSheet):
    """[calibrate]: how parameters are fitted to measured numbers."""

    loss: str = choice(
        *LOSSES, default="squares",
        meaning="of the residuals; under robust one bad number does not pull the rest",
    )  # fmt: skip
    level: float = parameter("-", 0.0, 1.0, low_open=True, high_open=True, default=0.95, meaning="of the intervals")
    seed: int = parameter("-", 0, default=0, meaning="of the first points")
