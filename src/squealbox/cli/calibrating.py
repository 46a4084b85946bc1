"""`squealbox calibrate` and `squealbox compare`: a design beside what was measured of the brake."""

from pathlib import Path

from squealbox.calibration import CalibrateSettings, Comparison, Recorded, compare, from_events, read_mode_table
from squealbox.calibration import calibrate as fitted
from squealbox.cli.answers import show, written
from squealbox.cli.inputs import NOTHING_SAID, Said, folder, keywords, read
from squealbox.cli.options import AS_WRITTEN, Asked
from squealbox.cli.running import ComputationFailed, UsageError
from squealbox.files import DesignFile, write_design
from squealbox.signals import BAND, EventSettings, Recording, SignalError, SquealEvents, squeal_events
from squealbox.stability import ComplexModes, complex_modes
from squealbox.waiting import Progress
from squealbox.writing import write

ABOUT = {
    "calibrate": "parameters fitted to what was measured, with what stays open",
    "compare_": "a design beside the squeal of a recording: frequency, growth, level",
}


def calibrate(
    file: Path,
    *,
    how: Said[CalibrateSettings] = NOTHING_SAID,
    out: Path | None = None,
    heard: bool = False,
    asked: Asked = AS_WRITTEN,
) -> None:
    """Fit parameters to what was measured: values, intervals, and what the data cannot tell apart.

    Parameters
    ----------
    file
        design file with a section [calibrate]
    out
        design file with the fitted values
    heard
        take frequency and growth of the loudest event of the [recording] as measured too
    """
    found = read(file, asked)
    if found.calibrate is None:
        raise UsageError(f"{file}: has no section [calibrate], which says what is fitted to what")
    measured, settings = list(found.calibrate.measured), how.over(found.calibrate.how)
    if heard:
        *_, events = _heard(found, own=complex_modes(found.design))
        measured += from_events(events, int(events.level.argmax())) if events.count else []
    with Progress("calibrating"):
        result = fitted(found.design, found.calibrate.parameters, measured, **keywords(settings))
    if result.outcome == "no_fit":
        raise ComputationFailed(result.outcome)
    show("", result)
    if out is not None:
        write_design(result.design, out)
        print(f"written: {out}")


def compare_(
    file: Path,
    recording: Path | None = None,
    *,
    how: Said[EventSettings] = NOTHING_SAID,
    modes: Path | None = None,
    out: Path | None = None,
    asked: Asked = AS_WRITTEN,
) -> None:
    """The modes and the motion of a design beside the loudest squeal event of a recording, or a table of modes.

    Parameters
    ----------
    file
        design file; its section [simulate] says what is run, [recording] what it is compared with
    recording
        another recording than that of the section
    modes
        table (.csv) or universal file of the modes of a test or another code, to compare with those of the design
    out
        folder for each comparison, with a figure, and the spectrogram of the motion beside that of the recording
    """
    found = read(file, asked)
    figures: dict[str, Comparison] = {}
    folder(out, "mode_table", "modes", "motion", "spectrograms")
    try:
        own = complex_modes(found.design)
        if modes is not None:
            figures["mode_table"] = compare(own, read_mode_table(modes))
            show("modes", figures["mode_table"])
        if modes is None or recording is not None:
            sound, channel, events = _heard(found, recording, how, own)
            figures["modes"] = compare(own, events)
            show("modes", figures["modes"])
            if found.simulate is not None:
                with Progress("simulating"):
                    motion = found.simulate.run_closely(found.design.system())
                figures["motion"] = compare(motion, events)
                show("motion", figures["motion"])
    except SignalError as error:
        raise UsageError(str(error)) from error
    if out is not None:
        from squealbox import plots

        paths = [path for name, result in figures.items() for path in write(result, out, name)]
        if "motion" in figures:
            beside = plots.spectrograms_beside(motion, sound, events, channel=channel)
            paths += plots.save(beside, out / "spectrograms")
        print(written(*paths))


def _heard(
    found: DesignFile,
    recording: Path | None = None,
    how: Said[EventSettings] = NOTHING_SAID,
    own: ComplexModes | None = None,
) -> tuple[Recording, int | str, SquealEvents]:
    """The recording of the section or the one that is named, the channel of it that is heard, and its squeal events.

    `own` are the modes that are expected in it, where no band is given.
    """
    about = found.recording
    if about is None and recording is None:
        raise UsageError(f"{found.path}: has no section [recording], and no recording is named")
    if recording is not None or about is None:
        about = Recorded(file=str(recording), unit="Pa")
    about = how.over(about)
    path = Path(about.file) if recording is not None else found.path.parent / about.file
    try:
        sound = about.read(path)
        ends = _around(own) if about.band is None else tuple(about.band)
        events = squeal_events(sound, channel=about.place, band=ends, least_level=about.least_level)
    except SignalError as error:
        raise UsageError(str(error)) from error
    return sound, about.place, events


def _around(own: ComplexModes | None) -> tuple[float, float]:
    """Where squeal is usual [Hz], and as far down as half the frequency of the mode that grows most, which is said."""
    low = BAND[0] if own is None or not own.unstable_modes else 0.5 * own.most_unstable.frequency
    if low < BAND[0]:
        print(f"squeal is looked for from {low:.0f} Hz on, half the frequency of the mode that grows most")
    return min(low, BAND[0]), BAND[1]
