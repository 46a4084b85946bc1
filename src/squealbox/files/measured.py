"""Measured points mu(v) from a CSV file."""

import os
import re
from pathlib import Path
from typing import Any

import numpy as np

from squealbox.cells import cells
from squealbox.files.document import DesignFileError, Problem, read_bytes
from squealbox.files.numbers import shown
from squealbox.units import UnitError, in_si, split

LARGEST = 5_000_000  # bytes
SPEED = re.compile(r"\bv\b|speed|velocity|geschwindigkeit", re.IGNORECASE)
COEFFICIENT = re.compile(r"\b(mu|µ|μ|cof)\b|friction|coefficient|reibwert", re.IGNORECASE)


def read_points(path: str | os.PathLike[str]) -> tuple[Any, Any]:
    """Sliding speeds [m/s] and friction coefficients [-], shape (k,) each, of a CSV file; cells may carry units.

    Of more than two columns the names tell which are meant. Titles above them, lines of one text, are passed over.
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
    while len(rows) > 1 and _is_text(rows[0][1]) and sum(bool(cell.strip()) for cell in rows[0][1]) <= 1:
        rows = rows[1:]
    columns, units, width = (0, 1), ["", ""], 2
    if rows and _is_text(rows[0][1]):
        columns, width = _columns(path, *rows[0]), len(rows[0][1])
        units = [_header_unit(path, rows[0], i, x) for i, x in zip(columns, ("m/s", "-"), strict=True)]
        rows = rows[1:]
    points = []
    for number, row in rows:
        if len(row) != width:
            wanted = "two, sliding speed and friction coefficient" if width == 2 else f"{width}, as there are names"
            raise _error(path, number, f"{len(row)} cells: expected {wanted}")
        try:
            pairs = zip([row[i] for i in columns], units, ("m/s", "-"), strict=True)
            points.append(tuple(_value(cell.strip(), unit, wanted) for cell, unit, wanted in pairs))
        except UnitError as error:
            raise _error(path, number, str(error)) from error
        if points[-1][0] < 0.0:
            raise _error(path, number, f"a sliding speed of {shown(row[columns[0]].strip())}: expected 0 m/s or more")
    if not points:
        raise _error(path, 0, f"{shown(path.name)} holds no points: expected rows of speed and coefficient")
    found = np.array(points)
    return found[:, 0], found[:, 1]


def _is_text(row: list[str]) -> bool:
    return all(not cell.strip()[:1].isdigit() and cell.strip()[:1] not in ("-", "+", ".") for cell in row)


def _columns(path: Path, line: int, names: list[str]) -> tuple[int, int]:
    """Where the speed and the coefficient stand: by their names, of two columns without such names in this order."""
    found = [[i for i, name in enumerate(names) if pattern.search(name)] for pattern in (SPEED, COEFFICIENT)]
    if len(names) == 2 and [len(each) for each in found] != [1, 1]:
        return 0, 1
    if len(names) < 2 or [len(each) for each in found] != [1, 1]:
        expected = "two, sliding speed and friction coefficient, or names of which one says v or speed and one mu"
        raise _error(path, line, f"{len(names)} cells: expected {expected}")
    return found[0][0], found[1][0]


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
