"""Does it match the test? A recording with its squeal events, and what the model says beside the loudest of them."""

from typing import Any

import numpy as np

from squealbox import read_recording, squeal_events
from squealbox.calibration import compare
from squealbox.design import Design
from squealbox.figure_data import FigureAxis, FigureData, heat, line
from squealbox.plots import shown
from squealbox.signals import Recording, SignalError, SquealEvents, spectrogram
from squealbox.stability import complex_modes
from squealbox.words import number as digits
from squealbox.workbench.frames import finite
from squealbox.workbench.panels.declared import Panel, Place, number, words
from squealbox.workbench.panels.panel import NONE, Answer, OptionError, Options, Work, table
from squealbox.workbench.recorded import path_of

PANEL = Panel(
    "Recording", questions=("matches",), columns=2, slow=True, layout="two", table="Squeal events",
    choices=(words("unit", "unit", ("FS", "not calibrated"), ("Pa", "Pa"), ("g", "g"), ("m/s^2", "m/s²")),
             number("1 is worth", "full_scale", 1.0, 1e-12, 1e12, of="signals.RecordingSettings"),
             number("", "lowest", 1e3, 20.0, 16e3)),
    figures=(Place("recording", "Spectrogram with the events", 230, "events",
                   "drop a recording here: WAV, FLAC, CSV, UFF"),),
)  # fmt: skip

PIECE = 0.04  # s of sound behind a column of the spectrogram
COLUMNS, ROWS = 400, 240  # of it, at most
TOP = 16e3  # Hz
MOST_EVENTS = 50


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Events, spectrogram and notes of the recording, and simulated beside measured numbers."""
    recording, events = heard(options, work)
    data: dict[str, Any] = {
        "unit": events.settings["unit"], "outcome": str(events.outcome),
        "events": [_event(events, i) for i in range(min(events.count, MOST_EVENTS))],
        "count": events.count, "marks": {"events": events.count}, "words": _words(recording, events),
    }  # fmt: skip
    modes = complex_modes(design)
    if events.count and bool(modes.exists):
        chosen = min(int(options.number("event", int(np.argmax(events.level)), 0, 1e6)), events.count - 1)
        found = compare(modes, events, event=chosen)
        rows = zip(found.names, found.simulated, found.measured, found.error, found.away, strict=True)
        compared = [_compared(*row) for row in rows if row[0] != "level"]
        data |= {"event": chosen, "table": table(("that event", "model", "measured", "apart"), compared)}
    work.progress(0.7, "spectrogram")
    picture, stretch, top = _grid(recording, events)
    lines = [
        line([events.onset[i], events.end[i]], [events.frequency[i] / 1e3] * 2,
             "s1" if i == data.get("event") else "s5", column=f"event {i + 1}")
        for i in range(min(events.count, MOST_EVENTS))
    ]  # fmt: skip
    upward = FigureAxis("frequency", "kHz", (0.0, top / 1e3), factor=1e3)
    seen = heat(picture, "decades", "amplitude", "", smooth=True)
    return Answer(data, figures=[FigureData("recording", FigureAxis("time", "s", stretch), upward, lines, heat=seen)])


def _grid(recording: Recording, events: SquealEvents) -> tuple[Any, tuple[float, float], float]:
    """The spectrogram no finer than it is seen: amplitudes, ends of its time [s], its highest frequency [Hz]."""
    sound = recording.channel(0)
    piece = min(PIECE, recording.duration / 4.0)
    overlap = float(np.clip(1.0 - recording.duration / (COLUMNS * piece), 0.0, 0.9))
    grid = spectrogram(sound, recording.t, segment=piece, overlap=overlap)
    top = min(TOP, max(0.25 * TOP, 2.5 * float(np.max(events.frequency, initial=0.0))))
    seen = np.nonzero(grid.frequency <= top)[0]
    rows, columns = -(-len(seen) // ROWS), -(-len(grid.time) // COLUMNS)
    picture = _coarser(grid.amplitude[seen], rows, columns)
    return picture, (float(grid.time[0]), float(grid.time[-1])), float(grid.frequency[seen[-1]])


def heard(options: Options, work: Work) -> tuple[Recording, SquealEvents]:
    """The recording that the options name and the squeal events in it."""
    path = path_of(options.given.get("id"))
    if path is None:
        raise OptionError("the recording is not here any more: drop it again")
    unit, scale, low = options.chosen(*PANEL.choices).values()
    work.progress(0.05, "reading")
    try:
        recording = read_recording(path) if unit == "FS" else read_recording(path, unit=unit, full_scale=scale)
        work.progress(0.2, "looking for squeal")
        return recording, squeal_events(recording, band=(low, min(TOP, 0.49 * recording.rate)))
    except (SignalError, ModuleNotFoundError) as error:
        raise OptionError(str(error).replace(f"{path.name}: ", "")) from error


def _words(recording: Recording, events: SquealEvents) -> str:
    """What was found in how much sound, and the notes of the recording."""
    counted = f"{events.outcome.message or 'No squeal event'}."
    if events.count:
        share = f"{digits(100.0 * events.occurrence, 3)} % of {digits(recording.duration, 3)} s"
        counted = f"{events.count} event{'s' if events.count > 1 else ''}, {share}."
    return " ".join([counted, *(f"{each}." for each in recording.notes)])


def _compared(name: str, simulated: Any, measured: Any, error: Any, away: Any) -> list[str]:
    """A row of what the model says beside what was measured."""
    spread = f" ± {digits(error, 2)}" if np.isfinite(error) else ""
    unit = {"frequency": "Hz", "growth rate": "1/s"}.get(name, "")
    apart = f"{digits(away, 3)} sd" if np.isfinite(away) else NONE
    return [f"{name} {unit}".strip(), shown(simulated, 5), f"{shown(measured, 5)}{spread}", apart]


def _event(events: SquealEvents, i: int) -> dict[str, float | None]:
    names = ("onset", "end", "frequency", "frequency_error", "level", "growth_rate", "growth_error", "decay_rate")
    return {name: finite(getattr(events, name)[i]) for name in names}


def _coarser(values: Any, rows: int, columns: int) -> Any:
    """The largest of each block of rows and columns: a short squeal stays in sight."""
    fit = np.pad(values, [(0, -values.shape[0] % rows), (0, -values.shape[1] % columns)], mode="edge")
    blocks = fit.reshape(fit.shape[0] // rows, rows, fit.shape[1] // columns, columns)
    return blocks.max(axis=(1, 3))
