"""Measured points mu(v) from a CSV file."""

import csv
import io
import os
from pathlib import Path
from typing import Any

import numpy as np

from squealbox.files.document import DesignFileError, Problem, read_bytes
from squealbox.files.numbers import shown
from squealbox.files.units import UnitError, in_si

LARGEST = 5_000_000  # bytes


def read_points(path: str | os.PathLike[str]) -> tuple[Any, Any]:
    """Sliding speeds [m/s] and friction coefficients of a CSV file of two columns; cells may carry units.

    A first line without numbers is taken for names. Raises `DesignFileError` with file and line.
    """
    path = Path(path)
    try:
        text = read_bytes(path, LARGEST).decode("utf-8-sig")
        rows = [(i, row) for i, row in enumerate(csv.reader(io.StringIO(text)), start=1) if row]
    except FileNotFoundError as error:
        raise _error(path, 0, "there is no such file") from error
    except (OSError, UnicodeDecodeError, csv.Error, ValueError) as error:
        raise _error(path, 0, f"is not a readable CSV file: {getattr(error, 'strerror', None) or error}") from error
    if rows and all(not cell.strip()[:1].isdigit() and cell.strip()[:1] not in ("-", "+", ".") for cell in rows[0][1]):
        rows = rows[1:]
    points = []
    for number, row in rows:
        if len(row) != 2:
            raise _error(path, number, f"{len(row)} cells: expected two, sliding speed and friction coefficient")
        try:
            points.append((in_si(row[0].strip(), "m/s"), in_si(row[1].strip(), "-")))
        except UnitError as error:
            raise _error(path, number, str(error)) from error
    if not points:
        raise _error(path, 0, f"{shown(path.name)} holds no points: expected rows of speed and coefficient")
    columns = np.array(points)
    return columns[:, 0], columns[:, 1]


def _error(path: Path, line: int, message: str) -> DesignFileError:
    return DesignFileError([Problem(path, line, "", message)])
