"""`squealbox diagram`: a bifurcation diagram by brute force, ensembles over a parameter, with a Poincare section."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np
from cyclopts import Parameter

from squealbox.cli.answers import show, written
from squealbox.cli.branches import all_branches
from squealbox.cli.inputs import (
    AS_FILED,
    NOTHING_SAID,
    OneVaried,
    Said,
    folder,
    in_motion,
    keywords,
    number,
    read,
    readable,
)
from squealbox.cli.options import AS_WRITTEN, Asked
from squealbox.cli.running import ComputationFailed, UsageError
from squealbox.family import ParameterAxis
from squealbox.limit_cycles import BifurcationDiagram, Branch, DiagramSettings, Section, bifurcation_diagram
from squealbox.parameters import known_names
from squealbox.waiting import Progress
from squealbox.words import unit_at
from squealbox.writing import write, write_table

ABOUT = {"diagram": "what transients settle to over a parameter, with a Poincare section"}

if TYPE_CHECKING:
    from squealbox.design import Design

Drawn = Annotated[bool, Parameter(negative="")]
WAYS = {"rises": 1, "falls": -1, "passes": 0}
NAMED = {"maxima": Section.maxima, "minima": Section.minima, "return": Section.returns}


def diagram(
    file: Path,
    *,
    varies: OneVaried = AS_FILED,
    how: Said[DiagramSettings] = NOTHING_SAID,
    dof: str | None = None,
    section: str = "maxima",
    branches: Drawn = False,
    asked: Asked = AS_WRITTEN,
    out: Path | None = None,
) -> None:
    """What the motion settles to over a range of a parameter, by transients alone: a bifurcation diagram.

    A sweep up or down goes on from value to value with the state in which the last one ended; "rest" starts each anew.
    Where they differ, attractors coexist. Several points of the section at one value are a cycle of several turns, or
    a motion that never repeats itself.

    Parameters
    ----------
    file
        design file; its section [branch] says what is varied, unless the options do
    dof
        degree of freedom that is drawn, or y' for its velocity in a plane of --section; the largest unless said
    section
        maxima or minima of it; return (its velocity where it rises through steady sliding); or a plane: "x' falls 0.1",
        "x rises 2um", "v1 falls 0" with v1, v2 ... the sliding velocities of the contacts
    branches
        follow the cycles as well (as squealbox branch) and draw them beneath
    out
        folder for a figure, the tables diagram.csv and section.csv, and diagram.nc
    """
    found = read(file, asked)
    varied = varies.of(found.design, found.branch)
    found, settings = in_motion(found, varied), how.over(DiagramSettings())
    plane = _section(found.design, section, dof)
    folder(out, "diagram", "section")
    with Progress(f"{varied.points} values") as progress:
        result = bifurcation_diagram(found.design, varied.name, varied.values, section=plane, **keywords(settings))
        if np.all(result.kind < 0):
            raise ComputationFailed(result.outcome)
        progress("following the cycles")
        _, several = all_branches(found.design, varied, progress=progress) if branches else (None, ())
    show(f"{found.design.title}, {file}", result)
    if out is not None:
        print(written(*_files(result, several, found.design, varied, found.path.name, out)))


def _section(design: "Design", text: str, dof: str | None) -> Section:
    """The section of --section and --dof."""
    system = design.system()
    name = system.names[-1] if dof is None else dof
    known = [*system.names, *(f"{each}'" for each in system.names)]
    if name not in known:
        raise UsageError(f"--dof {name[:40]}: {known_names(name[:40], known)}")
    if text in NAMED:
        if name.endswith("'"):
            raise UsageError(f"--dof {name[:40]}: expected a displacement for --section {text}")
        return NAMED[text](name)
    words = text.split()
    if len(words) not in (2, 3) or words[1] not in WAYS:
        shapes = 'maxima, minima, return, or a plane such as "x\' falls 0.1", "x rises 2um" or "v1 falls 0"'
        raise UsageError(f"--section {text[:60]}: expected {shapes}")
    where, way = words[0], WAYS[words[1]]
    planes = [*known, *(f"v{i + 1}" for i, _ in enumerate(system.contacts))]
    if where not in planes:
        raise UsageError(f"--section {text[:60]}: {known_names(where[:40], planes)}")
    turns = system.units[system.names.index(where.rstrip("'"))] if where in known else "m"
    unit = turns if where in system.names else f"{turns}/s"
    return Section(name, where, number(words[2], unit, f"--section {text[:60]}") if len(words) == 3 else 0.0, way)


def _files(
    result: BifurcationDiagram,
    several: tuple[Branch, ...],
    design: "Design",
    varied: ParameterAxis,
    title: str,
    out: Path,
) -> list[Path]:
    """Figure, tables and data."""
    from squealbox import plots

    scale, unit = readable(design, varied, 1.0)
    name = f"{varied.name} [{unit or '-'}]"
    dof = result.dofs.index(result.read.rstrip("'"))
    figure = plots.amplitude_and_section(result, branches=several, dof=dof, name=name, scale=1.0 / scale, title=title)
    sweep, point, _ = held = np.nonzero(np.isfinite(result.crossings))
    read_unit = unit_at(result.kept_system(), result.read.rstrip("'"), moves=result.read not in result.dofs)
    passed = {"sweep": np.array(result.sweeps)[sweep], name: result.value[point] * scale,
              f"{result.section} [{read_unit}]": result.crossings[held]}  # fmt: skip
    return [*write(result, out, "diagram", figure=figure), write_table(out / "section.csv", passed)]
