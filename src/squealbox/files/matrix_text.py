"""Numbers and matrices in text as other programs write them: Matrix Market and CSV, with Fortran's exponents.

    2.0D+06   2.0q6   2.0+6   2.e6          all 2,000,000

Every token is read to its end: a number that stops at an odd character is refused, never cut. What a matrix leaves open
(a symmetric header over two different triangles, an entry given twice, a pattern without numbers) is refused as well.
"""

import re
from typing import Any

import numpy as np

from squealbox.cells import cells
from squealbox.files.numbers import shown

LONGEST_NUMBER = 60  # characters
_NUMBER = re.compile(r"[+-]?(?:[0-9]+\.?[0-9]*|\.[0-9]+)(?:[eEdDqQ][+-]?[0-9]+|[+-][0-9]+)?")
_EXPONENT = re.compile(r"(?<=[0-9.])(?:[eEdDqQ]|(?=[+-]))")
_COMMA = re.compile(r"[+-]?[0-9]*,[0-9]+(?:[eEdDqQ][+-]?[0-9]+|[+-][0-9]+)?")


class ArrayFileError(ValueError):
    """A file beside the design is not a matrix; the message is one sentence."""


def number(text: str, where: str) -> float:
    """The number a token stands for. Raises `ArrayFileError` when any part of it is no number."""
    if len(text) <= LONGEST_NUMBER and _NUMBER.fullmatch(text):
        value = float(_EXPONENT.sub("e", text, count=1))
        if np.isfinite(value):
            return value
        raise ArrayFileError(f"{where}: {shown(text)} is too large to compute with")
    if _COMMA.fullmatch(text):
        raise ArrayFileError(f"{where}: {shown(text)} has a decimal comma, expected a decimal point")
    raise ArrayFileError(f"{where}: {shown(text)} is not a number")


def read_csv(raw: bytes, most: int) -> Any:
    """A table of numbers, cells parted by commas, semicolons or tabs; lines that begin with # are comments."""
    try:
        rows = [row for _, row in cells(raw)]
    except ValueError as error:
        raise ArrayFileError("is not a .csv file of numbers") from error
    check_size((len(rows), max((len(row) for row in rows), default=0)), most)
    widths = sorted({len(row) for row in rows})
    if len(widths) != 1:
        raise ArrayFileError(f"has rows of different lengths, {widths[0]} and {widths[-1]}")
    return np.array([[number(cell.strip(), f"row {i + 1}") for cell in row] for i, row in enumerate(rows)])


def read_matrix_market(raw: bytes, most: int) -> Any:
    """The matrix of a Matrix Market file, coordinate or array, general, symmetric or skew-symmetric.

    Source: R. F. Boisvert, R. Pozo, K. A. Remington, The Matrix Market Exchange Formats, NISTIR 5935, 1996.
    """
    try:
        lines = raw.decode("utf-8-sig").splitlines()
    except UnicodeDecodeError as error:
        raise ArrayFileError("is not a Matrix Market .mtx file: it is not text") from error
    form, symmetry = _header(lines)
    body = [(i, line.split()) for i, line in enumerate(lines[1:], start=2) if line.strip() and line.lstrip()[0] != "%"]
    if not body:
        raise ArrayFileError("is not a Matrix Market .mtx file: the line with its size is missing")
    line, sizes = body[0]
    expected = 3 if form == "coordinate" else 2
    if len(sizes) != expected:
        raise ArrayFileError(f"line {line}: {len(sizes)} numbers, expected the {expected} of its size")
    counts = [_whole(size, line) for size in sizes]
    shape = (counts[0], counts[1])
    check_size(shape, most)
    if symmetry != "general" and shape[0] != shape[1]:
        raise ArrayFileError(f"says it is {symmetry} and has the shape {shape}, expected a square matrix")
    if form == "coordinate":
        return _coordinates(body[1:], shape, counts[2], symmetry)
    return _columns(body[1:], shape, symmetry)


def check_size(shape: tuple[int, ...], most: int) -> None:
    """Raises `ArrayFileError` unless there are one or two axes of 1 to `most` numbers."""
    if not shape or len(shape) > 2 or any(not 1 <= int(size) <= most for size in shape):
        raise ArrayFileError(f"has the shape {shape}, expected one or two axes of 1 to {most} numbers")


def one_sided(matrix: Any) -> str:
    """Which side of its diagonal a square matrix has numbers on: "lower", "upper", or "" for both or none."""
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1]:
        return ""
    below, above = np.any(np.tril(matrix, -1)), np.any(np.triu(matrix, 1))
    return "" if below == above else "lower" if below else "upper"


def mirrored(matrix: Any) -> Any:
    """The symmetric matrix of which one triangle is given."""
    return matrix + matrix.T - np.diag(np.diag(matrix))


def _header(lines: list[str]) -> tuple[str, str]:
    words = lines[0].lower().split() if lines else []
    if len(words) != 5 or words[0] != "%%matrixmarket":
        raise ArrayFileError("is not a Matrix Market .mtx file: its first line is not %%MatrixMarket and four words")
    _, what, form, kind, symmetry = words
    if what != "matrix" or form not in ("coordinate", "array"):
        raise ArrayFileError(f"holds a {shown(f'{what} {form}')}, expected a matrix, coordinate or array")
    if kind == "pattern":
        raise ArrayFileError("holds a pattern without numbers, expected real ones")
    if kind not in ("real", "integer"):
        raise ArrayFileError(f"holds {shown(kind)} numbers, expected real ones")
    if symmetry not in ("general", "symmetric", "skew-symmetric"):
        raise ArrayFileError(f"is {shown(symmetry)}, expected general, symmetric or skew-symmetric")
    return form, symmetry


def _whole(text: str, line: int) -> int:
    if not re.fullmatch(r"\+?[0-9]{1,12}", text):
        raise ArrayFileError(f"line {line}: {shown(text)} is not a whole number")
    return int(text)


def _coordinates(body: list[tuple[int, list[str]]], shape: tuple[int, int], count: int, symmetry: str) -> Any:
    if len(body) != count:
        raise ArrayFileError(f"says it has {count} entries and has {len(body)}")
    matrix, given = np.zeros(shape), np.zeros(shape, dtype=bool)
    for line, words in body:
        if len(words) != 3:
            raise ArrayFileError(f"line {line}: {len(words)} numbers, expected row, column and value")
        i, j = _whole(words[0], line) - 1, _whole(words[1], line) - 1
        if not (0 <= i < shape[0] and 0 <= j < shape[1]):
            raise ArrayFileError(
                f"line {line}: entry ({i + 1}, {j + 1}) is outside {shape[0]} rows and {shape[1]} columns"
            )
        if given[i, j]:
            raise ArrayFileError(f"line {line}: entry ({i + 1}, {j + 1}) is given twice")
        matrix[i, j], given[i, j] = number(words[2], f"line {line}"), True
    return matrix if symmetry == "general" else _completed(matrix, given, symmetry)


def _completed(matrix: Any, given: Any, symmetry: str) -> Any:
    """The other triangle; where both are given they must say the same."""
    sign = 1.0 if symmetry == "symmetric" else -1.0
    if sign < 0.0 and np.any(np.diag(matrix)):
        raise ArrayFileError("says it is skew-symmetric and has numbers on its diagonal")
    both = given & given.T
    if np.any(matrix[both] != sign * matrix.T[both]):
        i, j = np.argwhere(both & (matrix != sign * matrix.T))[0]
        raise ArrayFileError(
            f"says it is {symmetry}, but entry ({i + 1}, {j + 1}) is {matrix[i, j]:g} and ({j + 1}, {i + 1}) is "
            f"{matrix[j, i]:g}"
        )
    return np.where(given, matrix, sign * matrix.T)


def _columns(body: list[tuple[int, list[str]]], shape: tuple[int, int], symmetry: str) -> Any:
    values = [number(word, f"line {line}") for line, words in body for word in words]
    rows, columns = shape
    if symmetry == "general":
        places = [(i, j) for j in range(columns) for i in range(rows)]
    else:
        first = 0 if symmetry == "symmetric" else 1
        places = [(i, j) for j in range(columns) for i in range(j + first, rows)]
    if len(values) != len(places):
        raise ArrayFileError(f"has {len(values)} numbers, expected {len(places)} for {rows} by {columns}, {symmetry}")
    matrix, given = np.zeros(shape), np.zeros(shape, dtype=bool)
    where = tuple(np.array(places, dtype=int).reshape(-1, 2).T)
    matrix[where], given[where] = values, True
    return matrix if symmetry == "general" else _completed(matrix, given, symmetry)
