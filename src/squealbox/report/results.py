"""Results of any kind as pages and sections: how each ended, its key numbers, its figure, arrays and settings."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np

from squealbox import plots
from squealbox.design import Design
from squealbox.matrices import liveliest
from squealbox.plots import ARRAYS, array_rows, has_drawing, has_figure, numeric_answers, parameter_rows, setting_rows
from squealbox.remedies import Remedies
from squealbox.report.blocks import Code, Page, Picture, Points, ReportError, Section, Sound, Table, Text
from squealbox.report.pictures import picture, wav
from squealbox.result import Result, provenance
from squealbox.signals import LEAST, equal_steps
from squealbox.studies import Sweep
from squealbox.transient import Trajectory, verdict
from squealbox.words import AUDIBLE

MOST_RESULTS = 40  # of a folder on one page
MOST_ANSWERS = 6  # of a sweep that are drawn


def result_page(result: Result, *, title: str = "") -> Page:
    """The page of one result, with the design or system it was computed from where it kept one."""
    kind = type(result).__name__
    sections = [Section(kind, tuple(_about(result)))]
    design = _design_of(result)
    if design is not None:
        sections.append(Section("The brake", tuple(_design(design))))
    sections.append(Section("Arrays, settings and versions", result_section(kind, result).blocks))
    return Page(title or kind, result.outcome.told, tuple(sections), _made())


def folder_page(folder: Path) -> Page:
    """The page of a folder of results: every NetCDF file in it that holds one, in order of their names."""
    paths = sorted(path for path in folder.glob("*.nc") if path.is_file())
    if not paths:
        raise ReportError(f"{folder}: holds no results, expected NetCDF files (.nc) as `--out` and `save` write them")
    if len(paths) > MOST_RESULTS:
        raise ReportError(f"{folder}: holds {len(paths)} results, expected at most {MOST_RESULTS} on one page")
    results = [(path, Result.load(path)) for path in paths]
    sections = tuple(Section(f"{type(each).__name__}: {path.name}", tuple(_about(each))) for path, each in results)
    design = next((kept for _, each in results if (kept := _design_of(each)) is not None), None)
    brake = (Section("The brake", tuple(_design(design))),) if design is not None else ()
    details = tuple(Section(path.name, result_section(path.name, each).blocks, folded=True) for path, each in results)
    last = Section("Arrays, settings and versions", details)
    return Page(
        folder.resolve().name, f"{len(results)} result{'s' * (len(results) > 1)}.", (*sections, *brake, last), _made()
    )


def _design_of(result: Result) -> Design | None:
    """The design a result was computed from, where it kept one."""
    return next((kept for kept in result.inputs.values() if isinstance(kept, Design)), None)


def _about(result: Result) -> Iterator[Any]:
    """What the result says: its summary, its key numbers, its figure, a motion also its verdicts and sound."""
    yield Text(f"Outcome: {result.outcome.told}.")
    told = getattr(result, "summary", None)
    if isinstance(result, Remedies):
        yield from _cures(result)
    elif told is not None:
        yield Code(told())
    if result.warning:
        yield Text(result.warned())
    numbers = tuple((name, f"{value} {unit}".rstrip()) for name, value, unit in plots.facts(result))
    if numbers:
        yield Table(("", "value"), numbers)
    if isinstance(result, Sweep):
        for name in numeric_answers(result)[:MOST_ANSWERS]:
            yield picture(plots.plot(result, answer=name), f"{name.replace('_', ' ')}.")
    elif has_figure(result):
        yield picture(plots.plot(result), f"{type(result).__name__}.")
    if isinstance(result, Trajectory) and len(result.t) >= LEAST:
        yield from _motion(result)


def _cures(found: Remedies) -> Iterator[Any]:
    """The ranked table of cures with their cautions, and the line of Python of each."""
    yield Text(found.without())
    yield Table(found.heads(), tuple(found.rows()))
    if found.assumption:
        yield Text(found.assumption)
    yield Code("\n".join(map(str, found.line)))


def _motion(motion: Trajectory) -> Iterator[Any]:
    verdicts = [verdict(motion, dof=i) for i in range(motion.system.size)]
    yield Points(tuple(f"{name}: {one.text}" for name, one in zip(motion.system.names, verdicts, strict=True)))
    dof = liveliest([float(one.amplitude) for one in verdicts], motion.system.units)
    pitch = float(np.nan_to_num(verdicts[dof].frequency))
    if AUDIBLE[0] <= pitch <= AUDIBLE[1] and equal_steps(motion.t):
        yield Sound(wav(motion, dof), f"The motion of {motion.system.names[dof]} as sound, at its true frequency.")


def _design(design: Design) -> Iterator[Any]:
    yield Text(f"{design.title}. {design.source}")
    if has_drawing(design):
        yield picture(plots.brake_drawing(design), "The brake, angles to scale.", f"Drawing of {design.title}")
    yield Table(("parameter", "value", "may be", "meaning", "source"), tuple(parameter_rows(design)))


def _made() -> str:
    return f"Made by {', '.join(f'{name} {version}' for name, version in provenance().items())}."


def result_section(title: str, result: Result, pictures: tuple[Picture, ...] = (), *, folded: bool = False) -> Section:
    """A section about one result: how it ended, its pictures, its arrays, its settings and versions."""
    return Section(
        title,
        (
            Text(f"Outcome: {result.outcome.told}."),
            *pictures,
            Table(ARRAYS, tuple(array_rows(result))),
            Table(("", "", ""), tuple(setting_rows(result)), "Settings and versions"),
        ),
        folded,
    )
