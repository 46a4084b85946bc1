"""From a design file to a design and what is asked of it."""

import os
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from squealbox.arguments import public
from squealbox.calibration import Recorded
from squealbox.design import Design
from squealbox.designs import DESIGNS, OwnBrake, OwnMechanism
from squealbox.family import ParameterAxis, ParameterPlane
from squealbox.fe import DiscBrake, MeshedBrake, MeshedDrumBrake
from squealbox.files import analyses, countermeasures
from squealbox.files.assembled import ASSEMBLED, read_assembled
from squealbox.files.document import Document, document_of, open_document
from squealbox.files.measurements import Calibrated, read_calibrated, read_recorded
from squealbox.files.numbers import WRONG, read_choice, wrong
from squealbox.files.reduced import REDUCED, Reduced, read_reduce, read_reduced
from squealbox.files.sheets import read_sheet
from squealbox.files.uncertain import Optimise, Scattered, read_optimise, read_scatter
from squealbox.parameters import ParameterError, known_names
from squealbox.stability import ModeSettings
from squealbox.system import InvalidSystem
from squealbox.transient import MotionSettings

MESHED: dict[str, type[MeshedBrake]] = {"disc_brake": DiscBrake, "meshed_drum_brake": MeshedDrumBrake}
BRAKES: dict[str, type[Design]] = {**DESIGNS, "own": OwnBrake, "mechanism": OwnMechanism, **MESHED}
READERS = {ASSEMBLED: read_assembled, REDUCED: read_reduced}  # brakes that files beside the design describe
STUDY = "study"  # a section that `study.read_study` reads
SECTIONS: dict[str, Callable[..., Any]] = {
    "modes": analyses.read_modes,
    "reduce": read_reduce,
    "onset": analyses.read_onset,
    "branch": analyses.read_onset,
    "map": analyses.read_map,
    "simulate": analyses.read_simulate,
    "scatter": read_scatter,
    "optimise": read_optimise,
    "calibrate": read_calibrated,
    "recording": read_recorded,
}


NOTHING_RUBS = (
    "brake = {!r} has no contacts, so nothing in it rubs and nothing can squeal: give each a table [[contacts]], "
    "or write contacts = [] for a structure without friction"
)


@dataclass(frozen=True)
class DesignFile:
    """A design and the sections of its file; a section that is not there is None."""

    path: Path
    design: Design
    modes: ModeSettings | None = None
    onset: ParameterAxis | None = None
    branch: ParameterAxis | None = None
    map: ParameterPlane | None = None
    simulate: MotionSettings | None = None
    scatter: Scattered | None = None
    optimise: Optimise | None = None
    calibrate: Calibrated | None = None
    recording: Recorded | None = None
    reduce: Reduced | None = None
    study: bool = False  # does it hold a [study], which `study.read_study` reads?
    caution: str = ""  # what a reader of the results must know of the file


@public()
def read_design(path: str | os.PathLike[str], *, allow_code: bool = False) -> Design:
    """The brake that the file at `path` describes.

    A friction law that is Python code (``law = "own"``) is run only with `allow_code`.
    Raises `DesignFileError`, whose `problems` are all that is wrong with the file, each with line, key and a sentence.
    """
    return read_file(path, allow_code=allow_code).design


def read_file(path: str | os.PathLike[str], *, allow_code: bool = False) -> DesignFile:
    """The brake that the file at `path` describes, and its sections: [modes], [onset], [branch], [map],
    [simulate], [scatter], [optimise], [reduce], [calibrate] and [recording].

    A friction law that is Python code (``law = "own"``) is run only with `allow_code`.
    Raises `DesignFileError`, whose `problems` are all that is wrong with the file, each with line, key and a sentence.
    """
    document = open_document(Path(path))
    document.allow_code = allow_code
    return _file(document)


def read_text(text: str, name: str = "design.toml", *, beside: bool = True) -> DesignFile:
    """What :func:`read_file` reads from a file, from its text; `name` is what problems call it. No code is run.

    Files that the text names are looked for in the folder of `name`; without `beside` they are refused, since a text
    from elsewhere must not read the files of this machine.

    Raises `DesignFileError`, whose `problems` are all that is wrong with the text.

    >>> read_text('brake = "pad_on_disc"').design.m1
    1.0
    """
    document = document_of(Path(name), text.replace("\r\n", "\n"))
    document.beside = beside
    return _file(document)


def _file(document: Document) -> DesignFile:
    tables = dict(document.tables)
    study = tables.pop(STUDY, None)
    asked = {name: tables.pop(name) for name in SECTIONS if name in tables}
    design = design_of(document, tables)
    sections = {name: section_of(document, name, table, design) for name, table in asked.items()}
    if design is None or document.problems:
        raise document.error()
    forgot = tables.get("brake") in ("own", "mechanism") and "contacts" not in tables
    told = [NOTHING_RUBS.format(tables["brake"])] * forgot + document.cautions
    found = DesignFile(document.path, design, study=study is not None, caution="; ".join(told), **sections)
    if study is not None:
        from squealbox.files.study import study_of  # which reads the brake of a study by this module

        if study_of(document, study, found) is None:
            raise document.error()
    return found


def design_of(document: Document, tables: Mapping[str, Any], beside: tuple[str, ...] = ()) -> Design | None:
    """The brake of a file whose other sections are taken out; `beside` are keys it may have for other readers.

    When something is wrong, the design without the faulty keys, so that sections can be checked against it.
    """
    around = {name: tables[name] for name in countermeasures.SECTIONS if name in tables}
    tables = {name: value for name, value in tables.items() if name not in around}
    brake = _design(document, tables, (*beside, *countermeasures.SECTIONS))
    if brake is None or not around:
        return brake or _without_problems(document, tables)
    return countermeasures.wrapped(document, brake, around) or brake


def _design(document: Document, tables: Mapping[str, Any], beside: tuple[str, ...] = ()) -> Design | None:
    if "brake" not in tables:
        document.problem((), f"the key 'brake' is missing, expected {known_names('', [*BRAKES, *READERS])}")
        return None
    rest = {name: value for name, value in tables.items() if name != "brake"}
    if isinstance(tables["brake"], str) and tables["brake"] in READERS:
        return READERS[tables["brake"]](document, rest, (*SECTIONS, STUDY, *beside))
    kind = read_choice(document, tables["brake"], {**BRAKES, **dict.fromkeys(READERS, Design)}, ("brake",))
    if kind is WRONG:
        return None
    design: Design | None = read_sheet(document, kind, rest, (), beside=(*SECTIONS, STUDY, *beside))
    if design is None:
        return None
    try:
        with np.errstate(all="ignore"):  # an overflow is reported by the system as a value that is not finite
            design.system()
    except (InvalidSystem, ParameterError) as error:
        document.problem((), str(error))
        return None
    return design


def _without_problems(document: Document, tables: Mapping[str, Any]) -> Design | None:
    """The design of a faulty file with the faulty keys left out, to check its sections against in the same go."""
    good = {name: value for name, value in tables.items() if name not in document.faulty}
    return _design(
        Document(document.path, document.text, good, allow_code=document.allow_code, beside=document.beside), good
    )


def section_of(document: Document, name: str, table: Any, design: Design | None) -> Any:
    """A section of the file, read by its own reader."""
    if not isinstance(table, Mapping):
        return wrong(document, (name,), table, f"a section [{name}]")
    return SECTIONS[name](document, table, (name,), design)
