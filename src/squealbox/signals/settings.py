"""How recordings are read and what counts as squeal in them, for files, the command line and pages."""

import os
from collections.abc import Mapping
from typing import Any

from squealbox.parameters import DataSheet, Vector, above_zero, free, parameter
from squealbox.signals.events import LEAST_LEVEL
from squealbox.signals.recordings import Recording, read_recording


class RecordingSettings(DataSheet):
    """How a recording is read."""

    unit: str = free(default="", meaning="unit of the channels: Pa for sound pressure")
    full_scale: float | None = above_zero(
        "", default=None, meaning="what full scale (of sound files) or one unit is worth: 20 for 20 Pa"
    )
    rate: float | None = above_zero("Hz", default=None, meaning="sampling rate of files that do not tell it")
    channel: str = free(default="0", meaning="number from 0 on, or name")

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

    band: Vector = above_zero("Hz", default=None, ends=True, meaning="lowest and highest frequency, 2kHz 16kHz")
    least_level: float = parameter(
        "-", default=LEAST_LEVEL,
        meaning="peak level an event must reach in dB(A); asked of calibrated recordings only",
    )  # fmt: skip
