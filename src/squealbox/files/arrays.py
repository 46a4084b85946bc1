"""Matrices and vectors of a design file: written inline, or in a file beside it.

    K = [["130 kN/mm", 0], [0, "18 kN/mm"]]          inline, numbers in SI or with units
    K = "K.mtx"                                      beside the file, in SI
    K = { file = "K.npy", unit = "kN/mm" }           the same in another unit
    K = { file = "K.mtx", triangle = "mirrored" }    one triangle of a symmetric matrix; "as_given" for a triangular one

`.npy` (NumPy, never with pickled objects), `.mtx` (Matrix Market) and `.csv` are read. What a file says of its own
size is checked before anything of that size is made, and only files inside the folder of the design are opened.
"""

import io
from collections.abc import Mapping
from pathlib import Path
from tokenize import TokenError
from typing import Any

import numpy as np

from squealbox.files.document import Document, read_bytes
from squealbox.files.lines import Key
from squealbox.files.matrix_text import ArrayFileError, check_size, mirrored, one_sided, read_csv, read_matrix_market
from squealbox.files.numbers import WRONG, read_number, shown
from squealbox.parameters import Parameter
from squealbox.units import UnitError, in_si

TRIANGLES = ("mirrored", "as_given")
MATLAB = "; numpy.save('K.npy', scipy.io.loadmat('{}')['K']) makes one of the matrix K (sparse: K.toarray())"
LARGEST_FILE = 64_000_000  # bytes
MOST_ROWS = 2_000  # degrees of freedom; a larger finite-element model is reduced before it comes here


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
    if not isinstance(named.get("file"), str) or not set(named) <= {"file", "unit", "triangle"}:
        document.problem(key, f"{shown(value)}: expected {{ file = 'K.npy', unit = '{about.unit}' }}")
        return WRONG
    triangle = named.get("triangle", "")
    if triangle not in ("", *TRIANGLES):
        document.problem(key, f"triangle = {shown(triangle)}: expected one of {', '.join(TRIANGLES)}")
        return WRONG
    unit = named.get("unit", about.unit)
    if not document.beside:
        document.problem(
            key,
            f"{shown(named['file'])} is a file, which a pasted text or a link cannot name: use squealbox lab FILE",
        )
        return WRONG
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
    side = one_sided(array) if np.all(np.isfinite(array)) else ""
    if side and not triangle:
        document.problem(
            key,
            f"{named['file']!r} has numbers in its {side} triangle only: say triangle = 'mirrored' for a symmetric "
            "matrix of which one half is given, 'as_given' for one that is triangular",
        )
        return WRONG
    if triangle == "mirrored" and not side and np.any(array != np.diag(np.diag(array))):
        document.problem(key, f"{named['file']!r} has numbers in both triangles: triangle = 'mirrored' expects one")
        return WRONG
    return mirrored(array) if triangle == "mirrored" and side else array


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
    readers = {".npy": _npy, ".mtx": read_matrix_market, ".csv": read_csv}
    if path.suffix not in readers:
        matlab = MATLAB.format(path.name) if path.suffix.lower() == ".mat" else ""
        raise ArrayFileError(
            f"{shown(path.name)} has the ending {shown(path.suffix)}, expected .npy, .mtx or .csv{matlab}"
        )
    try:
        raw = read_bytes(path, LARGEST_FILE)
    except FileNotFoundError as error:
        raise ArrayFileError(f"there is no file {shown(path.name)} beside the design file") from error
    except (OSError, ValueError) as error:
        raise ArrayFileError(
            f"{shown(path.name)} cannot be read: {getattr(error, 'strerror', None) or error}"
        ) from error
    try:
        return readers[path.suffix](raw, MOST_ROWS)
    except ArrayFileError as error:
        raise ArrayFileError(f"{shown(path.name)} {error}") from error


def _npy(raw: bytes, most: int) -> np.ndarray:
    stream = io.BytesIO(raw)
    try:
        version = np.lib.format.read_magic(stream)
        read_header = np.lib.format.read_array_header_1_0 if version == (1, 0) else np.lib.format.read_array_header_2_0
        shape, _, dtype = read_header(stream)
    except (ValueError, TypeError, OSError, SyntaxError, RecursionError, MemoryError, TokenError) as error:
        raise ArrayFileError("is not a NumPy .npy file") from error
    if dtype.hasobject or dtype.kind not in "fiu":
        raise ArrayFileError(f"holds {dtype}, expected real numbers")
    check_size(shape, most)
    count = int(np.prod(shape, dtype=object))
    if len(raw) - stream.tell() != count * dtype.itemsize:
        raise ArrayFileError(f"says it has the shape {shape}, but is not as long as that")
    stream.seek(0)
    return np.asarray(np.lib.format.read_array(stream, allow_pickle=False), dtype=float)
