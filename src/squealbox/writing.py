"""A result as files of one name: the labelled data, a table for spreadsheets, and the figure.

    write(complex_modes(brake), "out", "modes")     out/modes.nc, out/modes.csv, out/modes.png, out/modes.svg

Every command writes with it. Each file is there whole or not at all, and the numbers come first.
"""

import csv
import os
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import Any

import numpy as np

from squealbox.arguments import public
from squealbox.labelled import whole
from squealbox.registers import name_of
from squealbox.result import Result, ResultFileError

DIGITS = 10  # of a number in a table; the labelled data has them all


def _a_result(value: object) -> str:
    return "" if isinstance(value, Result) else "what an analysis returns, such as complex_modes(brake)"


def _a_name(value: object) -> str:
    told = str(value)
    inside = not ({".", ".."} & {told, *Path(told).parts} or Path(told).is_absolute() or "\0" in told)
    return "" if inside else "a name for files within the folder, without ending"


@public(result=_a_result, name=_a_name)
def write(
    result: Result, out: str | os.PathLike[str], name: str = "", *, table: Any = None, figure: Any = None, **how: Any
) -> list[Path]:
    """Write a result as a labelled dataset, a table and a figure; returns the paths.

    Parameters
    ----------
    result : of any kind
    out : folder, which is made where there is none; files of these names in it are overwritten
    name : of the files, without ending; left out, the kind of the result: complex_modes
    table : other columns than `Result.table`, head to values (k,)
    figure : another figure than `plot(result, **how)` draws; False for none

    ``out/name.nc`` holds everything, with inputs, settings, outcome and versions, and `Result.load` reads it back.
    ``out/name.csv`` has names and units in its first line and ten digits. The figure is PNG and SVG; there is none of a
    result that holds nothing to draw. Raises `ResultFileError` with a sentence where the folder is a file, nothing may
    be written there or the disc is full: which file is not written, and which are.

    >>> import tempfile
    >>> from squealbox import DrumBrake, complex_modes
    >>> [path.name for path in write(complex_modes(DrumBrake()), tempfile.mkdtemp(), "modes")]
    ['modes.nc', 'modes.csv', 'modes.png', 'modes.svg']
    """
    from squealbox import plots
    from squealbox.plots import drawable

    stem = made(out) / (name or name_of(type(result)))
    written: list[Path] = []
    with _told(written):
        written.append(result.save(stem.with_name(f"{stem.name}.nc")))
        written.append(write_table(stem.with_name(f"{stem.name}.csv"), result.table() if table is None else table))
        figure = drawable(result) and plots.plot(result, **how) if figure is None else figure
        written += plots.save(figure, stem) if figure else []
    return written


def write_table(path: Path, columns: Mapping[str, Any]) -> Path:
    """Write columns of equal length as a CSV file that spreadsheets open; the keys are its first line."""
    with whole(path) as part, part.open("w", encoding="utf-8", newline="") as stream:
        rows = csv.writer(stream, lineterminator="\n")
        rows.writerow(columns)
        rows.writerows(zip(*(_cells(np.asarray(column)) for column in columns.values()), strict=True))
    return path


def made(folder: str | os.PathLike[str]) -> Path:
    """A folder that is there, made where it was not; `ResultFileError` where there can be none."""
    path = Path(folder)
    try:
        path.mkdir(parents=True, exist_ok=True)
    except FileExistsError as error:
        raise ResultFileError(
            f"{path}: a file of that name is there, expected a folder or a name for a new one"
        ) from error
    except OSError as error:
        raise ResultFileError(
            f"{path}: no folder can be made there ({error.strerror}), expected one to write in"
        ) from error
    return path


@contextmanager
def _told(written: list[Path]) -> Iterator[None]:
    """What cannot be written, and what is, in a sentence."""
    try:
        yield
    except OSError as error:
        if error.filename is None:
            raise
        there = f"; {', '.join(path.name for path in written)} written" if written else ""
        raise ResultFileError(f"{error.filename}: cannot be written, {error.strerror}{there}") from error


def _cells(array: Any) -> list[Any]:
    return [f"{value:.{DIGITS}g}" for value in array] if array.dtype.kind == "f" else array.tolist()
