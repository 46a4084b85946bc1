"""What `squealbox modes` adds for a finite-element brake: who moves and feeds, doubts, tables, shapes, coalescence."""

import dataclasses
from pathlib import Path
from typing import Any

import numpy as np

from squealbox.cli.answers import written
from squealbox.cli.inputs import small
from squealbox.family import ParameterAxis
from squealbox.fe import AssembledBrake, MeshedBrake, write_uff, write_vtu
from squealbox.files import DesignFile, Reduce, Reduced
from squealbox.stability import ONE_MESH, complex_modes, mesh_doubt, mode_table, table_text
from squealbox.waiting import Progress
from squealbox.writing import write

FRICTION = "friction.static"
POINTS = 61


def print_more(
    found: DesignFile, spectrum: Any, band: tuple[float, float], time: float, out: Path | None, mesh: float | None
) -> None:
    """Rest of the page, and the files of `--out`; `mesh` is the element size of a second mesh [m]."""
    table = mode_table(found.design, spectrum, time)
    second = None
    if isinstance(found.design, MeshedBrake):
        with Progress("meshing a second time"):
            second = mesh_doubt(found.design, spectrum, mesh)
    print("\n".join(text for text in (table_text(table), second.summary() if second else ONE_MESH) if text))
    if isinstance(found.design, AssembledBrake):
        structure = found.design.exported()
        frequencies = spectrum.frequency[: len(spectrum.eigenvalues) // 2]
        for doubt in structure.doubts(frequencies if len(frequencies) else None):
            print(f"Doubt: {doubt}.")
    if out is None:
        return
    paths = write(spectrum, out, "modes", table=table, title=found.path.name)
    paths += [] if second is None else write(second, out, "second_mesh")
    paths += _shapes(found, spectrum, out) + _coalescence(found, band, out)
    print(written(*paths))


def _shapes(found: DesignFile, spectrum: Any, out: Path) -> list[Path]:
    """VTU and UFF of the modes where places of nodes are known; a missing package is named."""
    if not isinstance(found.design, AssembledBrake):
        return []
    structure, half = found.design.exported(), len(spectrum.eigenvalues) // 2
    if structure.nodes is None or structure.labels is None or half == 0:
        print('Mode shapes need the places of nodes: nodes = "nodes.csv" under [structure].')
        return []
    paths = []
    for shape, name in ((write_vtu, "modes.vtu"), (write_uff, "modes.uff")):
        try:
            paths.append(shape(out / name, structure, spectrum.eigenvalues[:half], spectrum.right[:, :half]))
        except ModuleNotFoundError as error:
            if error.name not in ("meshio", "pyuff"):
                raise
            print(f"{name} is not written: {error}")
    return paths


def _coalescence(found: DesignFile, band: tuple[float, float], out: Path) -> list[Path]:
    """Frequencies and growth rates over friction, from 0 to its value or the range of [onset], by a reduced brake."""
    from squealbox import plots

    if FRICTION not in found.design.scalars():
        return []
    top = float(found.design.value_of(FRICTION))
    given = found.onset
    varied = given if given and given.name == FRICTION else ParameterAxis(FRICTION, 0.0, max(1.5 * top, 0.1))
    about = found.reduce or Reduced(Reduce(), {})
    asked = dataclasses.replace(found, reduce=dataclasses.replace(about, how=about.how.replace(band=np.array(band))))
    brake = small(asked, varied).design
    values = np.linspace(varied.low, varied.high, POINTS)
    with Progress("friction from low to high"):
        spectra = complex_modes(brake.replace({FRICTION: values}))
    return list(
        plots.save(plots.coalescence(values, spectra, name=FRICTION, title=found.path.name), out / "coalescence")
    )
