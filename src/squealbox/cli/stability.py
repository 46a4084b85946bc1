"""`squealbox modes` and `onset`: is steady sliding stable, and from where on is it not?"""

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from squealbox.cli.answers import keep, show, written
from squealbox.cli.finite_elements import print_more
from squealbox.cli.inputs import (
    AS_FILED,
    NOTHING_SAID,
    OneVaried,
    Said,
    folder,
    number,
    read,
    readable,
    small,
)
from squealbox.cli.options import AS_WRITTEN, Asked
from squealbox.cli.running import ComputationFailed, UsageError
from squealbox.family import ParameterAxis
from squealbox.fe import ReducedBrake
from squealbox.stability import (
    ComplexModes,
    CriticalValues,
    ModeSettings,
    complex_modes,
    critical_values,
    mechanism,
    mode_energy,
)
from squealbox.waiting import Progress
from squealbox.words import quantity_label
from squealbox.writing import write

ABOUT = {
    "modes": "is steady sliding stable? complex eigenvalues of a design file",
    "onset": "the value of a parameter at which squeal begins, and how",
}

SPECTRA = 61  # values at which the modes of a reduced brake are drawn

if TYPE_CHECKING:
    from squealbox.files import DesignFile


def modes(
    file: Path,
    *,
    asked: Asked = AS_WRITTEN,
    how: Said[ModeSettings] = NOTHING_SAID,
    second_mesh: str | None = None,
    out: Path | None = None,
) -> None:
    """Is steady sliding stable? Complex eigenvalues: frequency, growth rate and damping of each mode.

    Parameters
    ----------
    file
        design file; squealbox init writes a first one
    second_mesh
        of a brake that meshes itself: element size of the mesh it is compared with; 1.5 times its own by default
    out
        folder for the table, a figure of the eigenvalues and one of what feeds and damps the worst mode
    """
    found = read(file, asked)
    settings = how.over(found.modes or ModeSettings())
    time = settings.time
    folder(out, "modes", "mode_energy", "coalescence", "second_mesh")
    if found.design.system().is_sparse:
        _modes_in_band(found, settings, second_mesh, out)
        return
    if how.given.keys() & {"band", "certify"} or second_mesh:
        raise UsageError(
            "--band, --certify and --second-mesh: for finite-element brakes; of this one all modes are shown"
        )
    spectrum = complex_modes(found.design, time)
    if not spectrum.outcome.ok:
        raise ComputationFailed(spectrum.outcome)
    show(f"{found.design.title}, {file}", spectrum)
    if not spectrum.stable:
        print(f"What drives it: {mechanism(found.design, time)}")
    if out is not None:
        print(written(*_mode_files(spectrum, found, time, out)))


def _modes_in_band(found: "DesignFile", settings: ModeSettings, second_mesh: str | None, out: Path | None) -> None:
    """The modes of a finite-element brake in its band, each with an error bar."""
    mesh = None if second_mesh is None else number(second_mesh, "m", f"--second-mesh {second_mesh}")
    if settings.band is None:
        raise UsageError('which band? give --band 500 10kHz, or band = ["500 Hz", "10 kHz"] under [modes]')
    low, high = (float(value) for value in settings.band)
    with Progress("looking for the modes"):
        spectrum = complex_modes(found.design, settings.time, band=(low, high), certify=settings.certify)
    if not spectrum.outcome.ok:
        raise ComputationFailed(spectrum.outcome)
    show(f"{found.design.title}, {found.path}", spectrum)
    print_more(found, spectrum, (low, high), settings.time, out, mesh)


def onset(
    file: Path,
    *,
    varies: OneVaried = AS_FILED,
    asked: Asked = AS_WRITTEN,
    out: Path | None = None,
) -> None:
    """The value of a parameter at which steady sliding changes its stability: where squeal begins.

    Parameters
    ----------
    file
        design file; its section [onset] says what is varied, unless the options do
    out
        folder for a figure of frequencies and growth rates over the range, and its numbers
    """
    found = read(file, asked)
    varied = varies.of(found.design, found.onset)
    folder(out, "onset")
    found = small(found, varied)
    with Progress("looking for the onset"):
        crossings = critical_values(found.design, varied.name, (varied.low, varied.high))
    if not crossings.outcome.ok:
        raise ComputationFailed(crossings.outcome)
    keep(crossings)
    print(f"{found.design.title}, {file}")
    print("\n".join(crossing.told(7) for crossing in crossings))
    if out is not None:
        print(written(*_onset_files(found, varied, crossings, out)))


def _mode_files(spectrum: ComplexModes, found: "DesignFile", time: float, out: Path) -> list[Path]:
    """The spectrum as data, table and figure, and the energy of the worst mode where it oscillates."""
    from squealbox import plots

    paths = write(spectrum, out, "modes", title=found.path.name)
    if spectrum.most_unstable.angular_frequency > 0.0:
        fed = plots.plot(mode_energy(found.design, spectrum.most_unstable, time), title=found.path.name)
        paths += plots.save(fed, out / "mode_energy")
    return paths


def _onset_files(found: "DesignFile", varied: ParameterAxis, crossings: CriticalValues, out: Path) -> list[Path]:
    """The crossings, and a figure and table of the modes over the range with the crossings among its points."""
    from squealbox import plots

    if isinstance(found.design, ReducedBrake):
        varied = varied.replace(points=min(int(varied.points), SPECTRA))
    points = np.append(varied.values, crossings.value)
    spectra = complex_modes(found.design.replace({varied.name: np.sort(points)}))
    values, unit = readable(found.design, varied, np.sort(points))
    figure = plots.coalescence(values, spectra, name=varied.name, unit=unit, title=found.path.name)
    table = {quantity_label(varied.name, unit): values, **spectra.table()}
    return write(crossings, out, "onset", table=table, figure=figure)
