"""`squealbox diagram`: a bifurcation diagram by brute force, ensembles over a parameter, with a Poincare section."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from cyclopts import Parameter

from squealbox.cli.answers import keep
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
from squealbox.cli.tables import kept, write_csv, written
from squealbox.family import ParameterAxis
from squealbox.limit_cycles import KINDS, BifurcationDiagram, Branch, DiagramSettings, Section, bifurcation_diagram
from squealbox.parameters import known_names
from squealbox.waiting import Progress

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
    keep(result)
    print(f"{found.design.title}, {file}\n{_said(result, found.design, varied)}")
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


def _said(result: BifurcationDiagram, design: "Design", varied: ParameterAxis) -> str:
    def shown(value: float) -> str:
        read_, unit = readable(design, varied, value)
        return f"{float(read_):.6g} {unit}".rstrip()

    lines = [
        f"{varied.name} from {shown(varied.low)} to {shown(varied.high)}, {len(result.value)} values; {result.section}"
    ]
    for sweep, kind, size in zip(result.sweeps, result.kind, result.amplitude, strict=True):
        counts = ", ".join(
            f"{int(np.sum(kind == code))} {KINDS[code]}" for code in (1, 2, 0, -1) if np.any(kind == code)
        )
        moves = result.stretches((kind == 2) | (kind == 0), shown)
        where = f"; vibrates {moves}" if moves else ""
        units = _units(result)
        about = zip(units.items(), size.T, strict=True)
        most = ", ".join(f"{each} {np.nanmax(a):.3g} {unit}" for (each, unit), a in about)
        lines.append(f"{sweep}: {counts}{where}; largest amplitude {most}")
    if np.any(result.coexist):
        over = result.stretches(result.coexist, shown)
        lines.append(f"Rest and vibration coexist at {int(np.sum(result.coexist))} values, {over}.")
    if not result.outcome.ok:
        lines.append(f"Note: {result.outcome.message}")
    return result.warned(lines)


def _units(result: BifurcationDiagram) -> dict[str, str]:
    """The unit of each degree of freedom."""
    from squealbox.plots import unit_at

    return {name: unit_at(result.inputs.get("system"), name) for name in result.dofs}


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
    values, units = result.value * scale, _units(result)
    rows: dict[str, Any] = {"sweep": np.repeat(np.array(result.sweeps), len(values)),
                            name: np.tile(values, len(result.sweeps)),
                            "kind": np.array([KINDS[int(code)] for code in result.kind.ravel()])}  # fmt: skip
    for i, each in enumerate(result.dofs):
        rows |= {f"amplitude {each} [{units[each]}]": result.amplitude[..., i].ravel(),
                 f"least {each} [{units[each]}]": result.lowest[..., i].ravel(),
                 f"largest {each} [{units[each]}]": result.highest[..., i].ravel(),
                 f"frequency of {each} [Hz]": result.frequency[..., i].ravel()}  # fmt: skip
    sweep, point, _ = held = np.nonzero(np.isfinite(result.crossings))
    read_unit = units[result.read.rstrip("'")] + ("" if result.read in result.dofs else "/s")
    passed = {"sweep": np.array(result.sweeps)[sweep], name: values[point],
              f"{result.section} [{read_unit}]": result.crossings[held]}  # fmt: skip
    return [*kept(result, out / "diagram", rows, figure), write_csv(out / "section.csv", passed)]
