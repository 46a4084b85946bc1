"""`squealbox events` and `squealbox noise`: squeal in recordings, one or a whole campaign."""

from pathlib import Path
from typing import Annotated

import cyclopts

from squealbox.cli.inputs import number
from squealbox.cli.running import UsageError
from squealbox.signals import SignalError, SquealEvents, noise_matrix, read_recording, squeal_events
from squealbox.signals.events import BAND, LEAST_LEVEL

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
        print(f"{path}\n{found.summary()}")
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
    print(noise_matrix(stops, x=x, y=y).summary())


def _found(
    path: Path, unit: str, full_scale: float | None, rate: str | None, channel: str, band: Band, least_level: float
) -> SquealEvents:
    ends = BAND if band is None else tuple(number(each, "Hz", f"--band {each[:40]}") for each in band)
    own = None if rate is None else number(rate, "Hz", f"--rate {rate[:40]}")
    try:
        braking = {}
        beside = path.with_suffix(".braking.csv")
        if beside.is_file():
            table = read_recording(beside)
            braking = {name: (table.t, table.samples[:, i]) for i, name in enumerate(table.names)}
        sound = read_recording(path, unit=unit, full_scale=full_scale, rate=own, braking=braking)
        place = int(channel) if channel.isdigit() else channel
        return squeal_events(sound, channel=place, band=(ends[0], ends[1]), least_level=least_level)
    except SignalError as error:
        raise UsageError(f"{path.name}: {error}" if path.name not in str(error) else str(error)) from error
