"""`squealbox ensemble`: what every point of a plane settles to, by transients."""

from pathlib import Path
from typing import Any

import numpy as np

from squealbox.cli.inputs import AllowCode, Changes, folder, in_motion, read, time_of
from squealbox.cli.maps import Plane, Span, axes_of
from squealbox.cli.progress import Progress
from squealbox.cli.running import ComputationFailed, UsageError
from squealbox.cli.tables import write_csv, written
from squealbox.fe.reduced_brake import ReducedBrake
from squealbox.files.analyses import Simulate
from squealbox.files.runs import start_of
from squealbox.transient import Ensemble, simulate_ensemble

DURATION = "0.05 s"


def ensemble(
    file: Path,
    *,
    x: Span = None,
    y: Span = None,
    points: int | None = None,
    duration: str = DURATION,
    changes: Changes = (),
    allow_code: AllowCode = False,
    out: Path | None = None,
) -> None:
    """Transients over two parameters, with exact contact: how large each vibration is in the end, and how fast.

    Where `map` says whether steady sliding is stable, this says what the brake does from rest. Ctrl-C ends it with the
    figure and the numbers of what is done.

    Parameters
    ----------
    file
        design file; its section [map] says what is varied, unless the options do
    x
        parameter, lowest and highest value: friction.static 0 1
    y
        the same for the other axis: theta1 20deg 160deg
    points
        number of values along each axis
    duration
        length of each transient
    changes
        other values for this run: --set friction.static=0.4 load="2 kN"
    allow_code
        run the Python file of a friction law that the design file names
    out
        folder for the figure and the numbers
    """
    found = read(file, changes, allow_code)
    across, up = axes_of(found, x, y, points)
    seconds = time_of("--duration", duration)
    if not seconds > 0.0:
        raise UsageError(f"--duration {duration}: expected a time above 0 s")
    if out is not None:
        folder(out)
    found = in_motion(found, across, up)
    start = None
    if isinstance(found.design, ReducedBrake) and found.simulate is not None:
        start = start_of(found.design.system(), Simulate(q=found.simulate.q))  # rest, in its coordinates
    space = {each.name: each.values for each in (across, up)}
    with Progress(f"{int(across.points)} x {int(up.points)} transients") as progress:
        many = simulate_ensemble(
            found.design, space, seconds, observe=("amplitude", "frequency"), grid=True, start=start,
            progress=lambda done, total, spent: progress(_pace(done, total, spent)),
        )  # fmt: skip
    plane = Plane(found.design, across, up)
    print(f"{found.design.title}, {file}\n{_summary(many, plane)}")
    if out is not None and np.any(many.ended != "not_run"):
        print(written(*_files(many, plane, found.path.name, out)))
    if many.outcome == "interrupted":  # what was done by then is shown and written all the same
        raise ComputationFailed(many.outcome)


def _pace(done: int, total: int, seconds: float) -> str:
    rate = done / seconds if seconds > 0.0 else 0.0
    left = (total - done) / rate if rate > 0.0 else np.inf
    return f"{done} of {total}, {rate:.0f}/s, {left:.0f} s left"


def _largest(many: Ensemble) -> tuple[Any, Any]:
    """Largest amplitude over the degrees of freedom, and the frequency of that one."""
    amplitude = np.where(np.isfinite(many["amplitude"]), many["amplitude"], np.nan)
    which = np.argmax(np.nan_to_num(amplitude), axis=-1)[..., None]
    return tuple(np.take_along_axis(x, which, axis=-1)[..., 0] for x in (amplitude, many["frequency"]))  # type: ignore[return-value]


def _summary(many: Ensemble, plane: Plane) -> str:
    """How the transients ended, and the largest of them."""
    amplitude, frequency = _largest(many)
    ended = ", ".join(f"{np.count_nonzero(many.ended == name)} {name}" for name in np.unique(many.ended))
    lines = [f"{many.ended.size} transients of {many.settings['duration']:g} s from rest: {ended}; {many.rate:.0f}/s"]
    if np.all(np.isnan(amplitude)):
        return "\n".join(lines)
    column, row = np.unravel_index(np.nanargmax(amplitude), amplitude.shape)
    where = plane.place((plane.axes[0].values[column], plane.axes[1].values[row]))
    lines.append(
        f"amplitude over the last fifth, largest degree of freedom: median {np.nanmedian(amplitude):.4g} m, "
        f"largest {amplitude[column, row]:.4g} m at {frequency[column, row]:.5g} Hz, {where}"
    )
    return "\n".join(lines)


def _files(many: Ensemble, plane: Plane, title: str, out: Path) -> list[Path]:
    from squealbox import plots

    amplitude, frequency = _largest(many)
    (x_name, y_name), (x_unit, y_unit) = plane.names, plane.units
    figure = plots.amplitude_map(
        plane.x, plane.y, amplitude.T, x_name=x_name, x_unit=x_unit, y_name=y_name, y_unit=y_unit, title=title
    )
    columns = {
        **plane.columns(np.repeat(plane.x, len(plane.y)), np.tile(plane.y, len(plane.x))),
        "amplitude [m]": amplitude.ravel(),
        "frequency [Hz]": frequency.ravel(),
        "events": many.events.ravel(),
        "ended": many.ended.ravel(),
    }
    return [
        many.save(out / "ensemble.nc"),
        *plots.save(figure, out / "ensemble"),
        write_csv(out / "ensemble.csv", columns),
    ]
