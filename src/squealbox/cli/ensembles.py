"""`squealbox ensemble`: what every point of a plane settles to, by transients."""

from pathlib import Path
from typing import Any

import numpy as np

from squealbox.cli.answers import keep, written
from squealbox.cli.inputs import folder, in_motion, number, read
from squealbox.cli.maps import AS_FILED, Plane, TwoVaried
from squealbox.cli.options import AS_WRITTEN, Asked
from squealbox.cli.running import ComputationFailed, UsageError
from squealbox.fe import ReducedBrake
from squealbox.matrices import liveliest
from squealbox.system import as_system
from squealbox.transient import Ensemble, MotionSettings, simulate_ensemble, usual_duration
from squealbox.waiting import Progress
from squealbox.words import quantity
from squealbox.writing import write

ABOUT = {"ensemble": "transients over two parameters: amplitude and frequency of each"}


def ensemble(
    file: Path,
    *,
    over: TwoVaried = AS_FILED,
    duration: str | None = None,
    asked: Asked = AS_WRITTEN,
    out: Path | None = None,
) -> None:
    """Transients over two parameters, with exact contact: how large each vibration is in the end, and how fast.

    Where `map` says whether steady sliding is stable, this says what the brake does from rest. Ctrl-C ends it with the
    figure and the numbers of what is done.

    Parameters
    ----------
    file
        design file; its section [map] says what is varied, unless the options do
    duration
        length of each transient; left out, 200 periods of the worst mode of the brake in the file
    out
        folder for the figure and the numbers
    """
    found = read(file, asked)
    across, up = over.of(found)
    seconds = usual_duration(found.design) if duration is None else number(duration, "s", f"--duration {duration[:60]}")
    if not seconds > 0.0:
        raise UsageError(f"--duration {duration}: expected a time above 0 s")
    folder(out, "ensemble")
    found = in_motion(found, across, up)
    start = None
    if isinstance(found.design, ReducedBrake) and found.simulate is not None:
        start = MotionSettings(q=found.simulate.q).start_of(found.design.system())  # rest, in its coordinates
    space = {each.name: each.values for each in (across, up)}
    with Progress(f"{int(across.points)} x {int(up.points)} transients") as progress:
        many = simulate_ensemble(
            found.design, space, seconds, observe=("amplitude", "frequency"), grid=True, start=start,
            progress=lambda done, total, spent: progress(_pace(done, total, spent)),
        )  # fmt: skip
    plane = Plane(found.design, across, up)
    keep(many)
    print(f"{found.design.title}, {file}\n{_summary(many, plane)}")
    if out is not None and np.any(many.ended != "not_run"):
        print(written(*_files(many, plane, found.path.name, out)))
    if many.outcome == "interrupted":  # what was done by then is shown and written all the same
        raise ComputationFailed(many.outcome)


def _pace(done: int, total: int, seconds: float) -> str:
    rate = done / seconds if seconds > 0.0 else 0.0
    left = (total - done) / rate if rate > 0.0 else np.inf
    return f"{done} of {total}, {rate:.0f}/s, {left:.0f} s left"


def _largest(many: Ensemble, design: Any) -> tuple[Any, Any, str, str]:
    """Amplitude of the freedom that moves most, in each run alike among those of one unit; frequency, name, unit."""
    system = as_system(design)
    amplitude = np.where(np.isfinite(many["amplitude"]), many["amplitude"], np.nan)
    sizes = np.nan_to_num(amplitude)
    unit = system.units[liveliest(np.max(sizes.reshape(-1, system.size), axis=0), system.units)]
    alike = np.array([each == unit for each in system.units])
    which = np.argmax(np.where(alike, sizes, -1.0), axis=-1)[..., None]
    size, pitch = (np.take_along_axis(x, which, axis=-1)[..., 0] for x in (amplitude, many["frequency"]))
    return size, pitch, "largest degree of freedom" if unit == "m" else "largest rotation", unit


def _summary(many: Ensemble, plane: Plane) -> str:
    """How the transients ended, and the largest of them."""
    amplitude, frequency, which, unit = _largest(many, plane.design)
    ended = ", ".join(f"{np.count_nonzero(many.ended == name)} {name}" for name in np.unique(many.ended))
    lines = [f"{many.ended.size} transients of {many.settings['duration']:g} s from rest: {ended}; {many.rate:.0f}/s"]
    if np.all(np.isnan(amplitude)):
        return many.warned(lines)
    column, row = np.unravel_index(np.nanargmax(amplitude), amplitude.shape)
    at = zip(plane.names, (plane.axes[0].values[column], plane.axes[1].values[row]), strict=True)
    where = ", ".join(f"{name} = {many.read_value(name, value)}" for name, value in at)
    lines.append(
        f"amplitude over the last fifth, {which}: median {quantity(np.nanmedian(amplitude), unit)}, largest "
        f"{quantity(amplitude[column, row], unit)} at {quantity(frequency[column, row], 'Hz', 6)}, {where}"
    )
    return many.warned(lines)


def _files(many: Ensemble, plane: Plane, title: str, out: Path) -> list[Path]:
    from squealbox import plots

    amplitude, frequency, which, unit = _largest(many, plane.design)
    figure = plots.amplitude_map(
        plane.x, plane.y, amplitude.T, **plane.labels, title=title, unit=unit, name=f"amplitude, {which}"
    )
    largest = {f"amplitude [{unit}]": amplitude.ravel(), "frequency [Hz]": frequency.ravel()}
    return write(many, out, "ensemble", table={**many.table(), **largest}, figure=figure)
