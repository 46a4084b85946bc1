"""`squealbox modes`, `onset` and `map`: is steady sliding stable?"""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from cyclopts import Parameter

from squealbox.cli.inputs import RANGE, AllowCode, Changes, Ends, Option, axis, folder, read, readable, with_points
from squealbox.cli.progress import Progress
from squealbox.cli.running import ComputationFailed, UsageError
from squealbox.cli.tables import write_csv, written
from squealbox.stability import ComplexModes, CriticalValue, CriticalValues, complex_modes, critical_values, mechanism
from squealbox.stability.maps import StabilityMap, stability_map

if TYPE_CHECKING:
    from squealbox.designs import Design
    from squealbox.files import DesignFile
    from squealbox.files.analyses import Axis

Span = Annotated[tuple[str, str, str] | None, Parameter(negative="")]
ACROSS, UP = Option("--x", "--x NAME LOW HIGH"), Option("--y", "--y NAME LOW HIGH")


def modes(file: Path, *, changes: Changes = (), allow_code: AllowCode = False, out: Path | None = None) -> None:
    """Is steady sliding stable? Complex eigenvalues: frequency, growth rate and damping of each mode.

    Parameters
    ----------
    file
        design file; squealbox init writes a first one
    changes
        other values for this run: --set friction.static=0.4 load="2 kN"
    allow_code
        run the Python file of a friction law that the design file names
    out
        folder for modes.csv and modes.nc
    """
    found = read(file, changes, allow_code)
    time = found.modes.time if found.modes else 0.0
    spectrum = complex_modes(found.design, time)
    if not spectrum.outcome.ok:
        raise ComputationFailed(spectrum.outcome)
    print(f"{found.design.title}, {file}\n{spectrum.summary()}")
    if not spectrum.stable:
        print(f"What drives it: {mechanism(found.design, time)}")
    if out is not None:
        folder(out)
        print(written(spectrum.save(out / "modes.nc"), write_csv(out / "modes.csv", _mode_columns(spectrum))))


def onset(
    file: Path,
    *,
    parameter: str | None = None,
    range: Ends = None,
    changes: Changes = (),
    allow_code: AllowCode = False,
    out: Path | None = None,
) -> None:
    """The value of a parameter at which steady sliding changes its stability: where squeal begins.

    Parameters
    ----------
    file
        design file; its section [onset] says what is varied, unless the options do
    parameter
        dotted name, such as friction.static
    range
        lowest and highest value, with or without a unit: 0 1, or 20deg 160deg
    changes
        other values for this run: --set friction.static=0.4 load="2 kN"
    allow_code
        run the Python file of a friction law that the design file names
    out
        folder for a figure of frequencies and growth rates over the range, and its numbers
    """
    found = read(file, changes, allow_code)
    varied = axis(found.design, found.onset, parameter, range, RANGE)
    if out is not None:
        folder(out)
    with Progress("looking for the onset"):
        crossings = critical_values(found.design, varied.name, (varied.low, varied.high))
    if not crossings.outcome.ok:
        raise ComputationFailed(crossings.outcome)
    print(f"{found.design.title}, {file}")
    print("\n".join(_crossing(crossing, found.design, varied) for crossing in crossings))
    if out is not None:
        print(written(*_onset_files(found, varied, crossings, out)))


def map_(
    file: Path,
    *,
    x: Span = None,
    y: Span = None,
    points: int | None = None,
    changes: Changes = (),
    allow_code: AllowCode = False,
    out: Path | None = None,
) -> None:
    """Stability over two parameters: which part of the plane squeals, and how fast it grows there.

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
    changes
        other values for this run: --set friction.static=0.4 load="2 kN"
    allow_code
        run the Python file of a friction law that the design file names
    out
        folder for the figure and its numbers
    """
    found = read(file, changes, allow_code)
    given = found.map
    across = with_points(axis(found.design, given.x if given else None, *_split(x), ACROSS), points)
    up = with_points(axis(found.design, given.y if given else None, *_split(y), UP), points)
    if across.name == up.name:
        raise UsageError(f"x and y are both {up.name}: expected two different parameters")
    if out is not None:
        folder(out)
    with Progress(f"{int(across.points)} x {int(up.points)} points"):
        result = stability_map(found.design, {axis.name: axis.values for axis in (across, up)})
    if not result.outcome.ok:
        raise ComputationFailed(result.outcome)
    print(f"{found.design.title}, {file}\n{_map_summary(result, found.design, across, up)}")
    if out is not None:
        print(written(*_map_files(result, found, across, up, out)))


def _split(span: tuple[str, str, str] | None) -> tuple[str | None, tuple[str, str] | None]:
    return (None, None) if span is None else (span[0], (span[1], span[2]))


def _mode_columns(spectrum: ComplexModes) -> dict[str, Any]:
    half = spectrum.eigenvalues.shape[-1] // 2
    return {
        "mode": np.arange(1, half + 1),
        "frequency [Hz]": spectrum.frequency[:half],
        "growth rate [1/s]": spectrum.growth_rate[:half],
        "damping ratio [-]": spectrum.damping_ratio[:half],
        "angular frequency [rad/s]": spectrum.angular_frequency[:half],
    }


def _crossing(crossing: CriticalValue, design: "Design", varied: "Axis") -> str:
    value, unit = readable(design, varied, crossing.value)
    side = "above" if crossing.direction == "destabilising" else "below"
    shares = ", ".join(f"{name.replace('_', ' ')} {100.0 * share:.0f} %" for name, share in crossing.shares.items())
    first = "squeal begins" if crossing.changes_stability else "one more mode"
    place = f"{varied.name} = {float(value):.7g} {unit}".rstrip()
    return (
        f"{place}: {first}; {side} it a mode of {crossing.frequency:.6g} Hz grows, "
        f"mechanism {crossing.mechanism.replace('_', ' ')} ({shares})"
    )


def _onset_files(found: "DesignFile", varied: "Axis", crossings: CriticalValues, out: Path) -> list[Path]:
    """The crossings, and a figure and table of the modes over the range with the crossings among its points."""
    from squealbox import plots

    points = np.append(varied.values, crossings.value)
    spectra = complex_modes(found.design.replace({varied.name: np.sort(points)}))
    values, unit = readable(found.design, varied, np.sort(points))
    figure = plots.coalescence(values, spectra, name=varied.name, unit=unit, title=found.path.name)
    half = spectra.eigenvalues.shape[-1] // 2
    columns = {f"{varied.name} [{unit or '-'}]": values}
    columns |= {f"frequency {i + 1} [Hz]": spectra.frequency[:, i] for i in range(half)}
    columns |= {f"growth rate {i + 1} [1/s]": spectra.growth_rate[:, i] for i in range(half)}
    return [crossings.save(out / "onset.nc"), *plots.save(figure, out / "onset"), write_csv(out / "onset.csv", columns)]


def _map_summary(found: StabilityMap, design: "Design", across: "Axis", up: "Axis") -> str:
    """How much of the plane squeals, by which mechanism, and where it is worst, in units one reads."""
    known, unstable = np.count_nonzero(found.exists), np.count_nonzero(found.unstable)
    counts = [(name, np.count_nonzero(found.mechanism == code)) for code, name in enumerate(found.mechanism_names)]
    parts = ", ".join(f"{name.replace('_', ' ')} {count}" for name, count in counts[1:] if count)
    column, row = np.unravel_index(np.nanargmax(found.growth_rate), found.growth_rate.shape)
    (x, x_unit), (y, y_unit) = (readable(design, axis, axis.values) for axis in (across, up))
    place = f"{across.name} = {x[column]:.5g} {x_unit}".rstrip() + f", {up.name} = {y[row]:.5g} {y_unit}".rstrip()
    text = f"{unstable} of {known} points are unstable ({100.0 * unstable / known:.1f} %){parts and f': {parts}'}\n"
    text += f"the largest growth rate is {found.growth_rate[column, row]:+.5g} 1/s "
    text += f"at {found.frequency[column, row]:.5g} Hz, {place}"
    missing = found.growth_rate.size - known
    return f"{text}\n{missing} more points have no steady sliding" if missing else text


def _map_files(found: StabilityMap, file: "DesignFile", across: "Axis", up: "Axis", out: Path) -> list[Path]:
    from squealbox import plots

    (x, x_unit), (y, y_unit) = (readable(file.design, axis, axis.values) for axis in (across, up))
    labels = {"x_name": across.name, "x_unit": x_unit, "y_name": up.name, "y_unit": y_unit}
    figure = plots.stability_map(x, y, found.growth_rate.T, **labels, title=file.path.name)
    columns = {
        f"{across.name} [{x_unit or '-'}]": np.repeat(x, len(y)),
        f"{up.name} [{y_unit or '-'}]": np.tile(y, len(x)),
        "growth rate [1/s]": found.growth_rate.ravel(),
        "frequency [Hz]": found.frequency.ravel(),
        "growing modes": found.unstable_modes.ravel(),
        "mechanism": np.array([*found.mechanism_names, "none"])[found.mechanism.ravel()],
    }
    return [found.save(out / "map.nc"), *plots.save(figure, out / "map"), write_csv(out / "map.csv", columns)]
