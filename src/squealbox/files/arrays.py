"""Matrices and vectors of a design file: written inline, or in a file beside it.

    K = [["130 kN/mm", 0], [0, "18 kN/mm"]]          inline, numbers in SI or with units
    K = "K.mtx"                                      beside the file, in SI
    K = { file = "K.npy", unit = "kN/mm" }           the same in another unit

`.npy` (NumPy, never with pickled objects), `.mtx` (Matrix Market) and `.csv` are read. What a file says of its own
size is checked before anything of that size is made, and only files inside the folder of the design are opened.
"""

import csv
import io
from collections.abc import Mapping
from pathlib import Path
from tokenize import TokenError
from typing import Annotated, Any

import numpy as np

from squealbox.files.document import Document, read_bytes
from squealbox.files.lines import Key
from squealbox.files.numbers import WRONG, read_number, shown
from squealbox.files.units import UnitError, in_si
from squealbox.parameters import Parameter

Vector = Annotated[Any, 1]  # how a data sheet declares a field that a file may hold beside itself
Matrix = Annotated[Any, 2]

LARGEST_FILE = 64_000_000  # bytes
MOST_ROWS = 2_000  # degrees of freedom; a larger finite-element model is reduced before it comes here


class ArrayFileError(ValueError):
    """A file beside the design is not a matrix; the message is one sentence."""


def read_array(document: Document, value: Any, about: Parameter, key: Key, ndim: int) -> Any:
    """An array of `ndim` axes (1 or 2) in the unit of `about`, or `WRONG`."""
    if isinstance(value, (str, Mapping)):
        array = _beside(document, value, about, key, ndim)
    else:
        array = _inline(document, value, about, key, ndim)
    if array is WRONG:
        return WRONG
    if array.size and not about.accepts(array):
        bad = np.argwhere(~np.isfinite(array))
        where = f"entry {bad[0].tolist()} is {array[tuple(bad[0])]}" if bad.size else "an entry is outside"
        document.problem(key, f"{where}: expected finite numbers in {about.range}")
        return WRONG
    return array


def _inline(document: Document, value: Any, about: Parameter, key: Key, ndim: int) -> Any:
    expected = "a list of rows, [[1, 0], [0, 1]], or a file" if ndim == 2 else "a list of numbers, [1, 0], or a file"
    rows_missing = ndim == 2 and isinstance(value, list) and not all(isinstance(row, list) and row for row in value)
    if not isinstance(value, list) or not value or rows_missing:
        document.problem(key, f"{shown(value)}: expected {expected}")
        return WRONG
    if ndim == 2:
        widths = sorted({len(row) for row in value})
        if len(widths) > 1:
            document.problem(key, f"rows of {widths[0]} and {widths[-1]} numbers: expected rows of one length")
            return WRONG
        rows = [_numbers(document, row, about, (*key, i)) for i, row in enumerate(value)]
    else:
        rows = _numbers(document, value, about, key)
    flat = [number for row in rows for number in row] if ndim == 2 else rows
    return WRONG if any(number is WRONG for number in flat) else np.array(rows, dtype=float)


def _numbers(document: Document, row: list[Any], about: Parameter, key: Key) -> list[Any]:
    return [read_number(document, item, about, (*key, i)) for i, item in enumerate(row)]


def _beside(document: Document, value: Any, about: Parameter, key: Key, ndim: int) -> Any:
    named = {"file": value} if isinstance(value, str) else value
    if not isinstance(named.get("file"), str) or not set(named) <= {"file", "unit"}:
        document.problem(key, f"{shown(value)}: expected {{ file = 'K.npy', unit = '{about.unit}' }}")
        return WRONG
    unit = named.get("unit", about.unit)
    try:
        if not isinstance(unit, str):
            raise UnitError(f"unit {shown(unit)}: expected a unit in quotes, such as '{about.unit}'")
        factor = in_si(f"1 {unit}", about.unit)
        array = load_array(path_beside(document.path, named["file"])) * factor
    except (ArrayFileError, UnitError) as error:
        document.problem(key, str(error))
        return WRONG
    if ndim == 1 and array.ndim == 2 and 1 in array.shape:
        array = array.ravel()
    if array.ndim != ndim:
        document.problem(key, f"{named['file']!r} has the shape {array.shape}: expected {ndim} axes")
        return WRONG
    return array


def path_beside(design: Path, name: str) -> Path:
    """The file `name` in the folder of `design` or below it; `ArrayFileError` for any other place."""
    folder = design.resolve().parent
    try:
        path = (folder / name).resolve()
    except (OSError, ValueError, RuntimeError) as error:
        raise ArrayFileError(f"{shown(name)} is not a file name") from error
    if not path.is_relative_to(folder):
        raise ArrayFileError(f"{shown(name)} is outside the folder of the design file, expected a file in it")
    return path


def load_array(path: Path) -> np.ndarray:
    """The real numbers of a `.npy`, `.mtx` or `.csv` file; `ArrayFileError` names what is wrong with it."""
    readers = {".npy": _npy, ".mtx": _mtx, ".csv": _csv}
    if path.suffix not in readers:
        raise ArrayFileError(f"{shown(path.name)} has the ending {shown(path.suffix)}, expected .npy, .mtx or .csv")
    try:
        raw = read_bytes(path, LARGEST_FILE)
    except FileNotFoundError as error:
        raise ArrayFileError(f"there is no file {shown(path.name)} beside the design file") from error
    except (OSError, ValueError) as error:
        raise ArrayFileError(
            f"{shown(path.name)} cannot be read: {getattr(error, 'strerror', None) or error}"
        ) from error
    try:
        return readers[path.suffix](raw)
    except ArrayFileError as error:
        raise ArrayFileError(f"{shown(path.name)} {error}") from error


def _npy(raw: bytes) -> np.ndarray:
    stream = io.BytesIO(raw)
    try:
        version = np.lib.format.read_magic(stream)
        read_header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, _, dtype = read_header(stream)
    except (ValueError, TypeError, OSError, SyntaxError, RecursionError, MemoryError, TokenError) as error:
        raise ArrayFileError("is not a NumPy .npy file") from error
    if dtype.hasobject or dtype.kind not in "fiu":
        raise ArrayFileError(f"holds {dtype}, expected real numbers")
    _check_size(shape)
    count = int(np.prod(shape, dtype=object))
    if len(raw) - stream.tell() != count * dtype.itemsize:
        raise ArrayFileError(f"says it has the shape {shape}, but is not as long as that")
    stream.seek(0)
    return np.asarray(np.lib.format.read_array(stream, allow_pickle=False), dtype=float)


def _mtx(raw: bytes) -> np.ndarray:
    from scipy.io import mminfo, mmread

    try:
        rows, columns, entries, form, kind, _ = mminfo(io.BytesIO(raw))
        if kind == "complex" or form not in ("coordinate", "array"):
            raise ArrayFileError(f"holds {kind} numbers, expected real ones")
        _check_size((rows, columns))
        if entries > len(raw):  # an entry takes more than a byte
            raise ArrayFileError(f"says it has {entries} entries, but is not as long as that")
        matrix = mmread(io.BytesIO(raw))
    except ArrayFileError:
        raise
    except (ValueError, TypeError, OverflowError, OSError, MemoryError, IndexError) as error:
        raise ArrayFileError("is not a Matrix Market .mtx file") from error
    return np.asarray(matrix.toarray() if hasattr(matrix, "toarray") else matrix, dtype=float)


def _csv(raw: bytes) -> np.ndarray:
    try:
        rows = [row for row in csv.reader(io.StringIO(raw.decode("utf-8-sig")), strict=True) if row]
    except (UnicodeDecodeError, csv.Error) as error:
        raise ArrayFileError("is not a .csv file of numbers") from error
    _check_size((len(rows), max((len(row) for row in rows), default=0)))
    if len({len(row) for row in rows}) != 1:
        raise ArrayFileError("has rows of different lengths")
    numbers = []
    for i, row in enumerate(rows):
        for cell in row:
            try:
                numbers.append(in_si(cell, ""))
            except UnitError as error:
                raise ArrayFileError(f"row {i + 1}: {shown(cell)} is not a number") from error
    return np.array(numbers).reshape(len(rows), -1)


def _check_size(shape: tuple[int, ...]) -> None:
    if not shape or len(shape) > 2 or any(not 1 <= int(size) <= MOST_ROWS for size in shape):
        raise ArrayFileError(f"has the shape {shape}, expected one or two axes of 1 to {MOST_ROWS} numbers")
