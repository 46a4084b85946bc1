"""A study file: a brake, and in its section [study] an analysis and the space it is asked over.

    design = "brake.toml"                       # or the brake itself, as in any design file

    [study]
    analysis = "modes"                          # modes, onset, simulate, ensemble, cycle

    [[study.axis]]                              # one axis of a grid
    parameter = "friction.static"
    range = [0.2, 0.5]
    points = 61

An axis may also have `values` instead of a range, `spacing = "log"`, several parameters that change `together`, or a
`sample` of ranges and distributions.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from squealbox.design import Design
from squealbox.files.arrays import path_beside
from squealbox.files.document import DesignFileError, Document, open_document
from squealbox.files.numbers import shown, wrong
from squealbox.files.reading import SECTIONS, DesignFile, design_of, read_file, section_of
from squealbox.files.sheets import read_sheet
from squealbox.files.study_axis import read_axes
from squealbox.files.varied import VARY, axes_of
from squealbox.parameters import ParameterError, known_names
from squealbox.studies import Refined, RefineSettings, Space, StudySettings

OTHERS = ("axis", "vary", "keep", "observe", "refine")


@dataclass(frozen=True)
class StudyFile:
    """What a study file says."""

    path: Path
    brake: DesignFile
    study: StudySettings
    space: Space
    keep: tuple[str, ...] = ()
    observe: tuple[str, ...] = ("amplitude", "frequency")


def read_study(path: Path, *, allow_code: bool = False) -> StudyFile:
    """The study that the file at `path` describes.

    Raises `DesignFileError`, whose `problems` are all that is wrong with the file, each with line, key and a sentence.
    """
    document = open_document(Path(path))
    document.allow_code = allow_code
    tables = dict(document.tables)
    asked = tables.pop("study", None)
    brake = _brake(document, tables)
    if asked is None:
        document.problem((), "the section [study] is missing: it says which analysis is asked over which parameters")
    found = study_of(document, asked, brake)
    if found is None or brake is None or document.problems:
        raise document.error()
    return found


def study_of(document: Document, asked: Any, brake: DesignFile | None) -> StudyFile | None:
    """What the section [study] asks of a brake; None, and problems of the document, where something is wrong in it."""
    table = asked if isinstance(asked, Mapping) else {}
    if asked is not None and not isinstance(asked, Mapping):
        wrong(document, ("study",), asked, "a section [study]")
    rest = {name: value for name, value in table.items() if name not in OTHERS}
    study = read_sheet(document, StudySettings, rest, ("study",), beside=OTHERS)
    keep = _words(document, table, "keep", ())
    observe = _words(document, table, "observe", ("amplitude", "frequency"))
    space = None
    if asked is not None:
        axes = table.get("axis")
        if VARY in table:
            own = axes_of(document, table, ("study",), brake.design if brake else None, plain="values")
            axes = [*(axis for axis, _ in own), *(axes or ())]
        space = read_axes(document, axes, brake.design if brake else None, int(study.seed) if study else 0)
    if "refine" in table:
        space = _refined(document, table["refine"], space)
    if study is not None and brake is not None and study.analysis == "onset" and brake.onset is None:
        document.problem(("study", "analysis"), "'onset' needs a section [onset] with a parameter and its range")
    if document.problems or brake is None or study is None or space is None:
        return None
    return StudyFile(document.path, brake, study, space, keep, observe)


def _refined(document: Document, table: Any, space: Space | None) -> Space | None:
    key = ("study", "refine")
    if not isinstance(table, Mapping):
        return wrong(document, key, table, "a section [study.refine] with the key of")
    read = read_sheet(document, RefineSettings, table, key)
    if read is None or space is None:
        return None
    try:
        axes = {name: values for axis in space.axes if axis.dim in axis.values for name, values in axis.values.items()}
        if len(axes) < len(space.names):
            raise ParameterError("study", "axis", "lists side by side or a sample", "ranges or values alone")
        return Refined(axes, read.of, read.level, int(read.rounds))
    except ParameterError as error:
        document.problem(key, f"{error.name}: {error.value} cannot be refined: {error.expectation}")
        return None


def _brake(document: Document, tables: dict[str, Any]) -> DesignFile | None:
    """The design with the sections that say how it is analysed; from a file of its own, or from this one."""
    sections = {name: tables.pop(name) for name in list(tables) if name in SECTIONS}
    design = _other_file(document, tables) if "design" in tables else design_of(document, tables, beside=("design",))
    read = {name: section_of(document, name, table, design) for name, table in sections.items()}
    return None if design is None else DesignFile(document.path, design, caution="; ".join(document.cautions), **read)


def _other_file(document: Document, tables: dict[str, Any]) -> Design | None:
    name = tables.pop("design")
    for key in tables:
        known = known_names(key[:60], ["design", "study", *SECTIONS])
        document.problem((key,), f"unknown key beside design = {shown(name)}, {known}")
    if not isinstance(name, str):
        wrong(document, ("design",), name, "the name of a design file beside this one, such as 'brake.toml'")
        return None
    try:
        return read_file(path_beside(document.path, name), allow_code=document.allow_code).design
    except DesignFileError as error:
        for problem in error.problems:
            document.problem(("design",), f"{problem}")
    except (OSError, ValueError) as error:
        document.problem(("design",), f"{shown(name)} cannot be read: {error}")
    return None


def _words(document: Document, table: Mapping[str, Any], name: str, default: tuple[str, ...]) -> tuple[str, ...]:
    given = table.get(name)
    if given is None:
        return default
    if isinstance(given, list) and given and all(isinstance(word, str) for word in given):
        return tuple(given)
    wrong(document, ("study", name), given, "a list of names in quotes")
    return default
