"""Tables as text, the way spreadsheets and measuring systems of different countries write them.

Depends on: nothing.
"""

import csv
import io
import re

_COMMA = re.compile(r"([+-]?\d*),(\d+)(?=$|[eE\s])")  # a number with a decimal comma, perhaps a unit behind it
_POINT = re.compile(r"^[+-]?\d*\.\d")


def cells(raw: bytes) -> list[tuple[int, list[str]]]:
    r"""The rows of a table, each with the number of its line; empty lines and those that begin with # are left out.

    Cells are parted by semicolons, tabs or commas. Where they are parted by something else, a comma in a number is a
    decimal comma, unless some other number has a decimal point. The text is UTF-8, UTF-16 with its mark, or of the
    code page of Western Europe. Raises `ValueError` for what is no text.

    >>> cells("v [m/s];mu\n0,5;0,38\n".encode("utf-16"))
    [(1, ['v [m/s]', 'mu']), (2, ['0.5', '0.38'])]
    """
    lines = text(raw).splitlines()
    kept = [(i, line) for i, line in enumerate(lines, 1) if line.strip() and not line.lstrip().startswith("#")]
    if not kept:
        return []
    mark = next((mark for mark in (";", "\t") if mark in kept[-1][1]), ",")  # above it a title may stand
    try:
        rows = list(csv.reader(io.StringIO("\n".join(line for _, line in kept)), strict=True, delimiter=mark))
    except csv.Error as error:
        raise ValueError(f"is no table of cells: {error}") from error
    if mark != "," and not any(_POINT.match(cell.strip()) for row in rows for cell in row):
        rows = [[_with_point(cell) for cell in row] for row in rows]
    numbers = [i for i, _ in kept] if len(rows) == len(kept) else range(1, len(rows) + 1)  # cells may hold line breaks
    return list(zip(numbers, rows, strict=True))


def text(raw: bytes) -> str:
    """The text behind bytes. Raises `ValueError` where they are none."""
    if raw[:2] in (b"\xff\xfe", b"\xfe\xff"):
        return raw.decode("utf-16")
    if b"\x00" in raw:
        raise ValueError("is no text")
    try:
        return raw.decode("utf-8-sig")
    except UnicodeDecodeError:
        return raw.decode("cp1252")


def _with_point(cell: str) -> str:
    return _COMMA.sub(r"\1.\2", cell, count=1) if _COMMA.match(cell.strip()) else cell
