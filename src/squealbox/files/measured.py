"""Measured points mu(v) from a CSV file."""

import os
import re
from pathlib import Path
from typing import Any

import numpy as np

from squealbox.cells import cells
from squealbox.files.document import DesignFileError, Problem, read_bytes
from squealbox.files.numbers import shown
from squealbox.files.units import UnitError, in_si, split

LARGEST = 5_000_000  # bytes


def read_points(path: str | os.PathLike[str]) -> tuple[Any, Any]:
    """Sliding speeds [m/s] and friction coefficients of a CSV file of two columns; cells may carry units.

    A first line without numbers is taken for names, with a unit in brackets or behind a comma or slash where there is
    one: ``speed [mm/s]``, ``v (km/h)``, ``v in rpm`` (refused: not a speed).
    Raises `DesignFileError` with file and line.
    """
    path = Path(path)
    try:
        rows = cells(read_bytes(path, LARGEST))
    except FileNotFoundError as error:
        raise _error(path, 0, "there is no such file") from error
    except (OSError, ValueError) as error:
        raise _error(path, 0, f"is not a readable CSV file: {getattr(error, 'strerror', None) or error}") from error
    if rows and all(not cell.strip()[:1].isdigit() and cell.strip()[:1] not in ("-", "+", ".") for cell in rows[0][1]):
        units = [_header_unit(path, rows[0], i, wanted) for i, wanted in enumerate(("m/s", "-")[: len(rows[0][1])])]
        rows = rows[1:]
    else:
        units = ["", ""]
    points = []
    for number, row in rows:
        if len(row) != 2:
            raise _error(path, number, f"{len(row)} cells: expected two, sliding speed and friction coefficient")
        try:
            pairs = zip(row, units, ("m/s", "-"), strict=True)
            points.append(tuple(_value(cell.strip(), unit, wanted) for cell, unit, wanted in pairs))
        except UnitError as error:
            raise _error(path, number, str(error)) from error
        if points[-1][0] < 0.0:
            raise _error(path, number, f"a sliding speed of {shown(row[0].strip())}: expected 0 m/s or more")
    if not points:
        raise _error(path, 0, f"{shown(path.name)} holds no points: expected rows of speed and coefficient")
    columns = np.array(points)
    return columns[:, 0], columns[:, 1]


def _value(cell: str, unit: str, wanted: str) -> float:
    """A cell in SI; its own unit, or that of the header."""
    number, own = split(cell)
    return in_si(cell, wanted) if own or not unit else in_si(f"{number!r} {unit}", wanted)


def _header_unit(path: Path, first: tuple[int, list[str]], index: int, wanted: str) -> str:
    """The unit a name carries: in brackets, or behind a comma, a slash or the word ``in``; "" for none.

    Raises `DesignFileError` for a unit that measures something else.
    """
    line, cells = first
    name = cells[index].strip()
    found = re.search(r"[\[(<{]([^\[\](){}<>]*)[\])>}]\s*$", name) or re.search(r"(?:,|;|\bin\b)\s*(\S.*)$", name)
    if found is None:
        tail = re.search(r"(?:^|[\s_])([A-Za-zµμ°%]+(?:/[A-Za-z0-9^]+)+|rpm|mph)$", name) or re.search(
            r"\s/\s(\S+)$", name
        )
        if tail is None:
            return ""
        found = tail
    text = found[1].strip()
    if text in ("", "-", "1"):
        return ""
    try:
        in_si(f"1 {text}", wanted)
    except UnitError as error:
        raise _error(path, line, f"the header {shown(name)}: {error}") from error
    return text


def _error(path: Path, line: int, message: str) -> DesignFileError:
    return DesignFileError([Problem(path, line, "", message)])
