"""What of `best_absorber` and of a look at dither can be set, for the command line."""

from collections.abc import Mapping
from typing import ClassVar

from squealbox.countermeasures.best import AIMS
from squealbox.countermeasures.dither import Dithered
from squealbox.parameters import DataSheet, choice, parameter


class AbsorberSettings(DataSheet):
    """What a tuned mass is tuned for."""

    told: ClassVar[Mapping[str, tuple[str, str]]] = {"parameter": ("", "whose critical value is the margin")}

    aim: str = choice(
        *AIMS, default="decay",
        meaning="fastest decay, highest critical value of a parameter, or least probability of squeal",
    )  # fmt: skip
    samples: int = parameter("-", 1, default=256, meaning="brakes in the lot, the same for every tuning")
    seed: int = parameter("-", 0, default=0, meaning="of the lot")
    parameter: str = "friction.static"


class DitherSettings(DataSheet):
    """Which dither is looked at."""

    told: ClassVar[Mapping[str, tuple[str, str]]] = {
        "along": ("", "name of the contact that is shaken; all when left out")
    }

    frequency: float = parameter(
        "Hz", 0.0, low_open=True, default=Dithered.frequency,
        meaning="of the dither; said to be near a mode where it is",
    )  # fmt: skip
    along: str = Dithered.along
    points: int = parameter("-", 2, default=25, meaning="amplitudes looked at")
