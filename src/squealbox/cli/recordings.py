"""`squealbox events`, `noise`, `damping` and `quality`: what recordings hold, one or a whole campaign."""

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Annotated

import cyclopts
import numpy as np

from squealbox.cli.answers import show
from squealbox.cli.inputs import NOTHING_SAID, Said, number
from squealbox.cli.running import UsageError
from squealbox.signals import (
    BAND,
    EventSettings,
    Recording,
    RecordingSettings,
    SignalError,
    SquealEvents,
    damping_onset,
    noise_matrix,
    operational_modes,
    read_recording,
    sound_quality,
    squeal_events,
)
from squealbox.waiting import Progress

ABOUT = {
    "events": "squeal events in recordings: when, which frequency, how loud, how quick",
    "noise": "a folder of stops: how often it squeals, at which speed and pressure",
    "damping": "damping of the modes before squeal, and the onset it points to",
    "quality": "loudness, sharpness and roughness of recordings",
}

SOUNDS = (".wav", ".flac", ".csv", ".uff", ".unv")


def events(
    recordings: tuple[Path, ...],
    /,
    *,
    how: Said[EventSettings] = NOTHING_SAID,
    out: Path | None = None,
) -> None:
    """Find squeal events: onset, end, frequency, level, growth and decay.

    Parameters
    ----------
    recordings
        .wav, .flac, .csv, .npy, .uff files
    out
        file for the events as a dataset (.nc), of one recording
    """
    if not recordings:
        raise UsageError("expected one recording or more")
    if out is not None and len(recordings) > 1:
        raise UsageError("--out: expected one recording")
    settings = how.over(EventSettings())
    for path in recordings:
        found = _found(path, settings)
        show(f"{path}", found)
        if out is not None:
            print(f"written: {found.save(out)}")


def noise(
    folder: Path,
    *,
    x: str = "speed",
    y: str = "pressure",
    how: Said[EventSettings] = NOTHING_SAID,
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
    """
    if not folder.is_dir():
        raise UsageError(f"{folder}: expected a folder of recordings")
    paths = sorted(p for p in folder.iterdir() if p.suffix.lower() in SOUNDS and not p.name.endswith(".braking.csv"))
    if not paths:
        raise UsageError(f"{folder}: holds no recordings ({', '.join(SOUNDS)})")
    stops, refused, settings = [], [], how.over(EventSettings())
    for path in paths:
        try:
            stops.append(_found(path, settings))
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
    how: Said[RecordingSettings] = NOTHING_SAID,
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
    found, at, settings = [], [], how.over(RecordingSettings())
    low, high = (number(each, "Hz", f"--band {each[:40]}") for each in band)
    for path in recordings:
        with _named(path):
            sound = _read(path, settings)
            found.append(operational_modes(sound, channel=settings.place, band=(low, high)))
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
    how: Said[RecordingSettings] = NOTHING_SAID,
    begin: str | None = None,
    end: str | None = None,
) -> None:
    """Loudness, sharpness and roughness of recordings in Pa.

    Parameters
    ----------
    recordings
        .wav, .flac, .csv, .npy, .uff files
    begin
        where the stretch begins: 0.2s
    end
        where it ends
    """
    if not recordings:
        raise UsageError("expected one recording or more")
    ends = [None if each is None else number(each, "s", f"--{name}") for name, each in (("begin", begin), ("end", end))]
    settings = how.over(RecordingSettings(unit="Pa"))
    for path in recordings:
        with _named(path):
            with Progress(f"{path.name}: roughness takes some seconds for each second of sound"):
                found = sound_quality(_read(path, settings), channel=settings.place, begin=ends[0], end=ends[1])
            show(str(path), found)


def _read(path: Path, how: RecordingSettings) -> Recording:
    """A recording with the braking quantities of the table beside it."""
    braking = {}
    beside = path.with_suffix(".braking.csv")
    if beside.is_file():
        table = read_recording(beside)
        braking = {name: (table.t, table.samples[:, i]) for i, name in enumerate(table.names)}
    return how.read(path, braking)


def _found(path: Path, how: EventSettings) -> SquealEvents:
    ends = BAND if how.band is None else tuple(how.band)
    with _named(path):
        return squeal_events(_read(path, how), channel=how.place, band=ends, least_level=how.least_level)


@contextmanager
def _named(path: Path) -> Iterator[None]:
    """What is wrong with a recording, said with its name."""
    try:
        yield
    except SignalError as error:
        raise UsageError(f"{path.name}: {error}" if path.name not in str(error) else str(error)) from error
