"""`squealbox events`, `noise`, `damping` and `quality`: what recordings hold, one or a whole campaign."""

from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Annotated

import cyclopts
import numpy as np

from squealbox.cli.answers import show
from squealbox.cli.inputs import number
from squealbox.cli.running import UsageError
from squealbox.signals import (
    Recording,
    SignalError,
    SquealEvents,
    damping_onset,
    noise_matrix,
    operational_modes,
    read_recording,
    sound_quality,
    squeal_events,
)
from squealbox.signals.events import BAND, LEAST_LEVEL
from squealbox.waiting import Progress

ABOUT = {
    "events": "squeal events in recordings: when, which frequency, how loud, how quick",
    "noise": "a folder of stops: how often it squeals, at which speed and pressure",
    "damping": "damping of the modes before squeal, and the onset it points to",
    "quality": "loudness, sharpness and roughness of recordings",
}

SOUNDS = (".wav", ".flac", ".csv", ".uff", ".unv")
Band = Annotated[tuple[str, str] | None, cyclopts.Parameter(negative="")]


@dataclass(frozen=True)
class HowRead:
    """How a recording is read, options of every command that takes one.

    Parameters
    ----------
    unit
        unit of the channels: Pa for sound pressure
    full_scale
        what full scale (of sound files) or one unit is worth: 20 for 20 Pa
    rate
        sampling rate of files that do not tell it: 48kHz
    channel
        number from 0 on, or name
    """

    unit: str = ""
    full_scale: float | None = None
    rate: str | None = None
    channel: str = "0"

    def read(self, path: Path) -> Recording:
        """A recording with the braking quantities of the table beside it."""
        braking = {}
        beside = path.with_suffix(".braking.csv")
        if beside.is_file():
            table = read_recording(beside)
            braking = {name: (table.t, table.samples[:, i]) for i, name in enumerate(table.names)}
        own = None if self.rate is None else number(self.rate, "Hz", f"--rate {self.rate[:40]}")
        return read_recording(path, unit=self.unit, full_scale=self.full_scale, rate=own, braking=braking)

    @property
    def place(self) -> int | str:
        """The channel as a number or a name."""
        return int(self.channel) if self.channel.isdigit() else self.channel


How = Annotated[HowRead, cyclopts.Parameter(name="*")]
AS_TOLD = HowRead()


def events(
    recordings: tuple[Path, ...],
    /,
    *,
    how: How = AS_TOLD,
    band: Band = None,
    least_level: float = LEAST_LEVEL,
    out: Path | None = None,
) -> None:
    """Find squeal events: onset, end, frequency, level, growth and decay.

    Parameters
    ----------
    recordings
        .wav, .flac, .csv, .npy, .uff files
    band
        lowest and highest frequency: --band 2kHz 16kHz
    least_level
        peak level an event must reach in dB(A); asked of calibrated recordings only
    out
        file for the events as a dataset (.nc), of one recording
    """
    if not recordings:
        raise UsageError("expected one recording or more")
    if out is not None and len(recordings) > 1:
        raise UsageError("--out: expected one recording")
    for path in recordings:
        found = _found(path, how, band, least_level)
        show(f"{path}", found)
        if out is not None:
            print(f"written: {found.save(out)}")


def noise(
    folder: Path,
    *,
    x: str = "speed",
    y: str = "pressure",
    how: How = AS_TOLD,
    band: Band = None,
    least_level: float = LEAST_LEVEL,
) -> None:
    """How often it squeals over a folder of stops: occurrence, the noise matrix, frequencies.

    Beside stop.wav a table stop.braking.csv (t [s], speed, pressure, ...) gives the conditions of the stop.

    Parameters
    ----------
    folder
        folder of recordings, one stop each
    x
        braking quantity of the rows
    y
        braking quantity of the columns
    band
        lowest and highest frequency: --band 2kHz 16kHz
    least_level
        peak level an event must reach in dB(A)
    """
    if not folder.is_dir():
        raise UsageError(f"{folder}: expected a folder of recordings")
    paths = sorted(p for p in folder.iterdir() if p.suffix.lower() in SOUNDS and not p.name.endswith(".braking.csv"))
    if not paths:
        raise UsageError(f"{folder}: holds no recordings ({', '.join(SOUNDS)})")
    stops, refused = [], []
    for path in paths:
        try:
            stops.append(_found(path, how, band, least_level))
        except UsageError as error:
            refused.append(str(error))
    for text in refused:
        print(f"left out: {text}")
    if not stops:
        raise UsageError(f"{folder}: none of {len(paths)} recordings can be read")
    show("", noise_matrix(stops, x=x, y=y))


def damping(
    recordings: tuple[Path, ...],
    /,
    *,
    band: Annotated[tuple[str, str], cyclopts.Parameter(negative="")],
    against: str = "",
    near: str | None = None,
    how: How = AS_TOLD,
    out: Path | None = None,
) -> None:
    """Damping of the modes in recordings without squeal, and where it ends: the onset of squeal, continued.

    Beside stop.wav a table stop.braking.csv (t [s], speed, pressure, ...) gives the conditions of the record.

    Parameters
    ----------
    recordings
        .wav, .flac, .csv, .npy, .uff files of what a brake answers to the noise that shakes it
    band
        lowest and highest frequency of the modes: --band 1.5kHz 3kHz
    against
        braking quantity along which the growth rate is continued to zero: pressure, speed
    near
        frequency of the mode that is followed; left out, the least damped of the first record
    out
        file for the onset as a dataset (.nc)
    """
    if not recordings:
        raise UsageError("expected one recording or more")
    if out is not None and not against:
        raise UsageError("--out: keeps the onset, which --against asks for")
    found, at = [], []
    for path in recordings:
        with _named(path):
            sound = how.read(path)
            found.append(operational_modes(sound, channel=how.place, band=ends_of(band)))
            show(f"{path}", found[-1])
            if against and against not in sound.braking:
                known = ", ".join(sound.braking) or f"nothing: {path.with_suffix('.braking.csv').name} is missing"
                raise SignalError(f"--against {against}: the record has {known}")
            at.append(float(np.mean(sound.braking[against][1])) if against else 0.0)
    if against:
        onset = damping_onset(
            found, at, near=None if near is None else number(near, "Hz", f"--near {near[:40]}"), name=against
        )
        show("", onset)
        if out is not None:
            print(f"written: {onset.save(out)}")


def quality(
    recordings: tuple[Path, ...],
    /,
    *,
    full_scale: float | None = None,
    rate: str | None = None,
    channel: str = "0",
    begin: str | None = None,
    end: str | None = None,
) -> None:
    """Loudness, sharpness and roughness of recordings in Pa.

    Parameters
    ----------
    recordings
        .wav, .flac, .csv, .npy, .uff files
    full_scale
        what full scale (of sound files) or one unit is worth, in Pa
    rate
        sampling rate of files that do not tell it: 48kHz
    channel
        number from 0 on, or name
    begin
        where the stretch begins: 0.2s
    end
        where it ends
    """
    if not recordings:
        raise UsageError("expected one recording or more")
    ends = [None if each is None else number(each, "s", f"--{name}") for name, each in (("begin", begin), ("end", end))]
    for path in recordings:
        with _named(path):
            how = HowRead("Pa", full_scale, rate, channel)
            with Progress(f"{path.name}: roughness takes some seconds for each second of sound"):
                found = sound_quality(how.read(path), channel=how.place, begin=ends[0], end=ends[1])
            show(str(path), found)


def _found(path: Path, how: "HowRead", band: Band, least_level: float) -> SquealEvents:
    ends = BAND if band is None else ends_of(band)
    with _named(path):
        return squeal_events(how.read(path), channel=how.place, band=ends, least_level=least_level)


def ends_of(band: tuple[str, str]) -> tuple[float, float]:
    """The ends of a --band [Hz]."""
    low, high = (number(each, "Hz", f"--band {each[:40]}") for each in band)
    return low, high


@contextmanager
def _named(path: Path) -> Iterator[None]:
    """What is wrong with a recording, said with its name."""
    try:
        yield
    except SignalError as error:
        raise UsageError(f"{path.name}: {error}" if path.name not in str(error) else str(error)) from error
