"""How recordings are read and what counts as squeal in them, for files, the command line and pages."""

import os
from collections.abc import Mapping
from typing import Any, ClassVar

from squealbox.arguments import band
from squealbox.parameters import DataSheet, ParameterError, Vector, parameter
from squealbox.signals.events import LEAST_LEVEL
from squealbox.signals.recordings import Recording, read_recording


class RecordingSettings(DataSheet):
    """How a recording is read."""

    told: ClassVar[Mapping[str, tuple[str, str]]] = {
        "unit": ("", "unit of the channels: Pa for sound pressure"),
        "channel": ("", "number from 0 on, or name"),
    }

    unit: str = ""
    full_scale: float | None = parameter(
        "", 0.0, low_open=True, default=None, optional=True,
        meaning="what full scale (of sound files) or one unit is worth: 20 for 20 Pa",
    )  # fmt: skip
    rate: float | None = parameter(
        "Hz", 0.0, low_open=True, default=None, optional=True, meaning="sampling rate of files that do not tell it"
    )
    channel: str = "0"

    @staticmethod
    def unit_for(given: Mapping[str, Any]) -> str:
        """The unit of `full_scale` in a file."""
        return "Pa" if given.get("unit") == "Pa" else "-"

    @staticmethod
    def spelled(given: Mapping[str, Any]) -> Mapping[str, Any]:
        """The channel as a number, too."""
        return {**given, "channel": f"{given['channel']}"} if type(given.get("channel")) is int else given

    @property
    def place(self) -> int | str:
        """The channel as a number or a name."""
        return int(self.channel) if self.channel.isdigit() else self.channel

    def read(self, path: str | os.PathLike[str], braking: Mapping[str, tuple[Any, Any]] | None = None) -> Recording:
        """The recording in a file, with `braking` as `read_recording` takes it."""
        how = {name: getattr(self, name) for name in ("unit", "full_scale", "rate")}
        return read_recording(path, **how, braking=braking)


class EventSettings(RecordingSettings):
    """How a recording is read, and what counts as squeal in it."""

    band: Vector = parameter("Hz", 0.0, default=None, optional=True, meaning="lowest and highest frequency of squeal")
    least_level: float = parameter(
        "-", default=LEAST_LEVEL,
        meaning="peak level an event must reach in dB(A); asked of calibrated recordings only",
    )  # fmt: skip

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.band is not None and (expected := band(self.band)):
            raise ParameterError(type(self).__name__, "band", self.band, expected)
