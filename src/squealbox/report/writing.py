"""One door to every report: a design, a design file, a result, a file of one, or a folder of them."""

import os
from pathlib import Path
from typing import Any

from squealbox.design import Design
from squealbox.fe import MeshedBrake, ReducedBrake
from squealbox.files import ONE_WAY, DesignFile, dense, promise, read_file
from squealbox.report.blocks import Page, ReportError
from squealbox.report.design_pages import design_page
from squealbox.report.examination import Examination
from squealbox.report.examining import OF_LARGE, Progress, examine, usual_friction
from squealbox.report.page import write_page
from squealbox.report.results import folder_page, result_page
from squealbox.result import Result
from squealbox.stability import ONE_MESH, complex_modes, mesh_doubt

EXPECTED = "a design file (.toml), a result (.nc) or a folder that holds results"


def report(
    what: Any,
    path: str | os.PathLike[str] | None = None,
    *,
    allow_code: bool = False,
    progress: Progress = lambda text: None,
) -> Path:
    """Write the report of a design or a result as one HTML file, and return its path.

    Parameters
    ----------
    what : a design, a `DesignFile`, an `Examination`, a result; or the path of a design file, of a result saved as
        NetCDF, or of a folder of such results, a study's among them
    path : of the HTML file; by default named after `what`, in the current folder
    allow_code : run the Python file of a friction law that a design file names
    progress : called with what is being done

    Raises `ReportError` for anything else, and what reading a file raises: `DesignFileError`, `ResultFileError`.

    >>> import tempfile, pathlib
    >>> from squealbox import DrumBrake, complex_modes
    >>> folder = pathlib.Path(tempfile.mkdtemp())
    >>> report(complex_modes(DrumBrake()), folder / "modes.html").name
    'modes.html'
    """
    target = Path(path) if path is not None else Path(f"{_name(what)}.html")
    if target.suffix.lower() not in (".html", ".htm"):
        raise ReportError(f"{target}: a report is an HTML file, expected a name that ends in .html")
    if not target.absolute().parent.is_dir():
        raise ReportError(f"{target}: the folder {target.absolute().parent} is not there")
    return write_page(page_of(what, allow_code=allow_code, progress=progress), target)


def page_of(what: Any, *, allow_code: bool = False, progress: Progress = lambda text: None) -> Page:
    """The page of anything :func:`report` takes."""
    if isinstance(what, Examination):
        return design_page(what)
    if isinstance(what, Design):
        return design_page(examine(what, progress=progress))
    if isinstance(what, DesignFile):
        return _file_page(what, progress)
    if isinstance(what, Result):
        return result_page(what)
    if isinstance(what, (str, os.PathLike)):
        return _page_at(Path(what), allow_code, progress)
    raise ReportError(f"a report of {type(what).__name__}: expected a design, a result, {EXPECTED}")


def _page_at(path: Path, allow_code: bool, progress: Progress) -> Page:
    if path.is_dir():
        return folder_page(path)
    if not path.exists():
        raise ReportError(f"{path}: there is no such file or folder, expected {EXPECTED}")
    if path.suffix.lower() == ".toml":
        return _file_page(read_file(path, allow_code=allow_code), progress)
    if path.suffix.lower() == ".nc":
        return result_page(Result.load(path), title=path.name)
    raise ReportError(f"{path}: not a file a report can be made of, expected {EXPECTED}")


def _file_page(found: DesignFile, progress: Progress) -> Page:
    whole, asked = found.design, found.simulate
    varied = found.onset or (None if isinstance(whole, ReducedBrake) else usual_friction(whole, OF_LARGE))
    sparse = whole.system().is_sparse
    found = dense(found, [varied] if sparse and varied is not None else ())
    large = isinstance(found.design, ReducedBrake)
    time = found.modes.time if found.modes else 0.0
    about = examine(
        found.design,
        onset=varied if large else found.onset,
        plane=found.map,
        simulate=found.simulate if asked is not None or not large else None,
        time=time,
        progress=progress,
    )
    title = f"{whole.title}: {found.path.name}"
    name = found.path.name
    note = (
        f"The study in this file is not run for this page: squealbox run {name} --out DIR runs it, and squealbox "
        "report DIR shows what came out. This page is about the design as the file gives it."
    )
    notes = [f"Caution: {found.caution}."] if found.caution else []
    notes += [note] if found.study else []
    if isinstance(found.design, ReducedBrake):
        notes.append(promise(found.design))
        if isinstance(whole, MeshedBrake):
            progress("a second mesh")
            modes = about.band or complex_modes(whole, time, band=found.design.reduction.band)
            notes.append(mesh_doubt(whole, modes).sentence)
        else:
            notes.append(ONE_MESH)
        if found.design.reduction.arrays["across"] is not None:
            notes.append(ONE_WAY)
    return design_page(about, title=title, command=f"squealbox report {name}", notes=tuple(notes))


def _name(what: Any) -> str:
    if isinstance(what, DesignFile):
        return what.path.stem
    if isinstance(what, (str, os.PathLike)):
        path = Path(what)
        return (path.name if path.is_dir() else path.stem) or "report"
    return type(what.design if isinstance(what, Examination) else what).__name__
