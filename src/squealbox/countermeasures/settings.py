"""What of `best_absorber` and of a look at dither can be set, for the command line."""

from squealbox.countermeasures.best import AIMS
from squealbox.countermeasures.dither import Dithered
from squealbox.parameters import DataSheet, choice, free, parameter


class AbsorberSettings(DataSheet):
    """What a tuned mass is tuned for."""

    aim: str = choice(
        *AIMS, default="decay",
        meaning="fastest decay, highest critical value of a parameter, or least probability of squeal",
    )  # fmt: skip
    samples: int = parameter("-", 1, default=256, meaning="brakes in the lot, the same for every tuning")
    seed: int = parameter("-", 0, default=0, meaning="of the lot")
    parameter: str = free(default="friction.static", meaning="whose critical value is the margin")


class DitherSettings(DataSheet):
    """Which dither is looked at."""

    frequency: float = parameter(
        "Hz", 0.0, low_open=True, default=Dithered.frequency,
        meaning="of the dither; said to be near a mode where it is",
    )  # fmt: skip
    along: str = free(default=Dithered.along, meaning="name of the contact that is shaken; all when left out")
    points: int = parameter("-", 2, default=25, meaning="amplitudes looked at")
