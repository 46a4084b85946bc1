"""`squealbox events`, `noise`, `damping` and `quality`: what recordings hold, one or a whole campaign."""

from collections.abc import Iterator
from contextlib import contextmanager
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


def events(
    recordings: tuple[Path, ...],
    /,
    *,
    unit: str = "",
    full_scale: float | None = None,
    rate: str | None = None,
    channel: str = "0",
    band: Band = None,
    least_level: float = LEAST_LEVEL,
    out: Path | None = None,
) -> None:
    """Find squeal events: onset, end, frequency, level, growth and decay.

    Parameters
    ----------
    recordings
        .wav, .flac, .csv, .npy, .uff files
    unit
        unit of the channels: Pa for sound pressure
    full_scale
        what full scale (of sound files) or one unit is worth: 20 for 20 Pa
    rate
        sampling rate of files that do not tell it: 48kHz
    channel
        number from 0 on, or name
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
        found = _found(path, unit, full_scale, rate, channel, band, least_level)
        show(f"{path}", found)
        if out is not None:
            print(f"written: {found.save(out)}")


def noise(
    folder: Path,
    *,
    x: str = "speed",
    y: str = "pressure",
    unit: str = "",
    full_scale: float | None = None,
    rate: str | None = None,
    channel: str = "0",
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
    unit
        unit of the channels: Pa for sound pressure
    full_scale
        what full scale or one unit is worth
    rate
        sampling rate of files that do not tell it
    channel
        number from 0 on, or name
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
            stops.append(_found(path, unit, full_scale, rate, channel, band, least_level))
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
    unit: str = "",
    full_scale: float | None = None,
    rate: str | None = None,
    channel: str = "0",
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
    unit
        unit of the channels
    full_scale
        what full scale (of sound files) or one unit is worth
    rate
        sampling rate of files that do not tell it: 48kHz
    channel
        number from 0 on, or name
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
            sound = _sound(path, unit, full_scale, rate)
            found.append(operational_modes(sound, channel=_place(channel), band=ends_of(band)))
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
            sound = _sound(path, "Pa", full_scale, rate)
            with Progress(f"{path.name}: roughness takes some seconds for each second of sound"):
                found = sound_quality(sound, channel=_place(channel), begin=ends[0], end=ends[1])
            show(str(path), found)


def _found(
    path: Path, unit: str, full_scale: float | None, rate: str | None, channel: str, band: Band, least_level: float
) -> SquealEvents:
    ends = BAND if band is None else ends_of(band)
    with _named(path):
        sound = _sound(path, unit, full_scale, rate)
        return squeal_events(sound, channel=_place(channel), band=ends, least_level=least_level)


def ends_of(band: tuple[str, str]) -> tuple[float, float]:
    """The ends of a --band [Hz]."""
    low, high = (number(each, "Hz", f"--band {each[:40]}") for each in band)
    return low, high


def _sound(path: Path, unit: str, full_scale: float | None, rate: str | None) -> Recording:
    """A recording with the braking quantities of the table beside it."""
    braking = {}
    beside = path.with_suffix(".braking.csv")
    if beside.is_file():
        table = read_recording(beside)
        braking = {name: (table.t, table.samples[:, i]) for i, name in enumerate(table.names)}
    own = None if rate is None else number(rate, "Hz", f"--rate {rate[:40]}")
    return read_recording(path, unit=unit, full_scale=full_scale, rate=own, braking=braking)


def _place(channel: str) -> int | str:
    return int(channel) if channel.isdigit() else channel


@contextmanager
def _named(path: Path) -> Iterator[None]:
    """What is wrong with a recording, said with its name."""
    try:
        yield
    except SignalError as error:
        raise UsageError(f"{path.name}: {error}" if path.name not in str(error) else str(error)) from error
