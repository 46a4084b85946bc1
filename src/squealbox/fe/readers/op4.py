"""Nastran OUTPUT4: text or binary, either byte order, words of 4 or 8 bytes, dense or in strings (bigmat and not).

    header      columns, rows (negative: bigmat), form, type, name[, format of the text]
    column      number, first row (0: strings), words, then the values or the strings; number columns + 1 ends a matrix
    string      length * 65536 + first row, or length and first row in bigmat; length counts words, and one more

Types are 1 real single, 2 real double, 3 and 4 the complex ones. No labels, and form 1 may well be symmetric.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from squealbox.fe.readers.matrix import (
    MOST_FREEDOMS,
    OTHER,
    Entries,
    FileMatrix,
    MatrixFile,
    MatrixFileError,
    complete,
    kind_of,
)
from squealbox.fe.readers.numbers import number, text_lines

HEADER = re.compile(r"\s*(\d+)\s+(-?\d+)\s+(\d+)\s+([1-4])(\S{0,8})\s*(?:1[Pp],)?(\d+)[EDed](\d+)\.(\d+)\s*$")


@dataclass
class _Columns:
    """The entries of a matrix while its columns come."""

    path: Path
    name: str
    columns: int
    rows: int
    form: int
    type: int
    digits: int
    parts: list[tuple[Any, Any, Any]] = field(default_factory=list)

    def __post_init__(self) -> None:
        self.bigmat = self.rows < 0 or self.rows >= 65536
        self.rows = abs(self.rows)
        self.per = 2 if self.type > 2 else 1
        if not (1 <= self.columns <= MOST_FREEDOMS and 1 <= self.rows <= MOST_FREEDOMS and 1 <= self.type <= 4):
            raise MatrixFileError(
                self.path,
                f"{self.name[:16]!r} has {self.columns} columns, {self.rows} rows, type {self.type}: no OP4 matrix",
            )

    def take(self, column: int, row: int, values: np.ndarray, line: int | None = None) -> None:
        """Values from `row` on of `column`, both from 1."""
        if self.per == 2:
            if len(values) % 2:
                raise MatrixFileError(
                    self.path, f"column {column} of {self.name} holds half a complex number: expected pairs", line
                )
            values = values[0::2] + 1j * values[1::2]
        if not 1 <= row <= self.rows - len(values) + 1 or not 1 <= column <= self.columns:
            raise MatrixFileError(
                self.path,
                f"column {column} of {self.name} has rows {row} to {row + len(values) - 1}: expected 1 to {self.rows}",
                line,
            )
        keep = np.flatnonzero(values)
        rows = (row - 1 + keep).astype(np.int32)
        self.parts.append((rows, np.full(len(keep), column - 1, np.int32), values[keep]))

    def finished(self) -> FileMatrix:
        """The matrix."""
        empty: Any = (np.zeros(0, np.int32), np.zeros(0, np.int32), np.zeros(0))
        rows, columns, values = (np.concatenate(parts) for parts in zip(*(self.parts or [empty]), strict=True))
        self.parts = []
        square = self.rows == self.columns
        size: Any = self.rows if square else (self.rows, self.columns)
        kind = kind_of(self.name) if square and self.form in (1, 6) else OTHER
        notes: tuple[str, ...] = ()
        if len(values) == 0:
            from scipy.sparse import csr_array

            return FileMatrix(self.name, kind, csr_array((self.rows, self.columns)), "empty", 0, digits=self.digits)
        found = complete(
            self.path, self.name, kind, Entries(rows, columns, values), size, "full", digits=self.digits, notes=notes
        )
        if square and self.form == 6 and found.symmetry.startswith("unsymmetric"):
            one = (rows >= columns).all() or (rows <= columns).all()
            if not one:
                raise MatrixFileError(
                    self.path, f"{self.name} says form 6, symmetric, and is {found.symmetry}: a damaged file"
                )
            found = complete(
                self.path, self.name, kind, Entries(rows, columns, values), size, "half", digits=self.digits
            )
        return found


def read_text_op4(path: Path, stream: BinaryIO) -> MatrixFile:
    """The matrices of a text OP4."""
    lines = text_lines(path, stream)
    found = []
    for at, text in lines:
        if not text.strip():
            continue
        match = HEADER.match(text)
        if not match:
            raise MatrixFileError(path, f"{text.strip()[:60]!r}: expected the header of an OP4 matrix", at)
        columns, rows, form, type_ = (int(match[i]) for i in range(1, 5))
        per, width, digits = int(match[6]), int(match[7]), int(match[8]) + 1
        if not (1 <= per <= 20 and 8 <= width <= 40):
            raise MatrixFileError(path, f"{per} numbers of width {width} a line: expected a format such as 5E16.9", at)
        matrix = _Columns(path, match[5] or "unnamed", columns, rows, form, type_, digits)
        _text_columns(path, at, lines, matrix, per, width)
        found.append(matrix.finished())
    if not found:
        raise MatrixFileError(path, "holds no matrix: expected an OP4 file")
    return MatrixFile(path, "Nastran OP4, text", tuple(found))


def _text_columns(
    path: Path, at: int, lines: Iterator[tuple[int, str]], matrix: _Columns, per: int, width: int
) -> None:
    for at, text in lines:
        column, row, words = _three(path, at, text)
        if column == matrix.columns + 1:
            _values(path, at, lines, words, per, width)
            return
        if row > 0:
            matrix.take(column, row, _values(path, at, lines, words, per, width), at)
            continue
        left = words
        while left > 0:
            at, first, length, used = _string(path, at, lines, matrix)
            left -= used + length
            size = 2 if matrix.type in (2, 4) else 1
            if left < 0 or length % size:
                raise MatrixFileError(path, f"a string of {length} words in column {column}: expected fewer", at)
            matrix.take(column, first, _values(path, at, lines, length // size, per, width), at)
    raise MatrixFileError(path, f"ends within {matrix.name}: expected column {matrix.columns + 1} at its end", at)


def _string(path: Path, at: int, lines: Iterator[tuple[int, str]], matrix: _Columns) -> tuple[int, int, int, int]:
    at, text = next(lines, (at + 1, ""))
    try:
        ints = [int(word) for word in text.split()]
    except ValueError as error:
        raise MatrixFileError(path, f"{text.strip()[:40]!r}: expected the length and row of a string", at) from error
    if len(ints) != (2 if matrix.bigmat else 1):
        raise MatrixFileError(path, f"{text.strip()[:40]!r}: expected the length and row of a string", at)
    length, first = (ints[0], ints[1]) if matrix.bigmat else divmod(ints[0], 65536)
    if length < 2 or first < 1:
        raise MatrixFileError(path, f"a string of length {length} from row {first}: expected at least one value", at)
    return at, first, length - 1, len(ints)


def _three(path: Path, at: int, text: str) -> tuple[int, int, int]:
    words = [text[0:8], text[8:16], text[16:24]]
    try:
        column, row, count = (int(word) for word in (words if not text[24:].strip() else text.split()))
    except ValueError as error:
        raise MatrixFileError(path, f"{text.strip()[:40]!r}: expected column, row and number of words", at) from error
    if column < 1 or row < 0 or not 0 <= count <= 4 * MOST_FREEDOMS:
        raise MatrixFileError(path, f"{text.strip()[:40]!r}: expected column, row and number of words", at)
    return column, row, count


def _values(path: Path, at: int, lines: Iterator[tuple[int, str]], count: int, per: int, width: int) -> Any:
    values: list[float] = []
    while len(values) < count:
        at, text = next(lines, (at + 1, ""))
        expected = min(per, count - len(values))
        words = [text[i : i + width] for i in range(0, len(text.rstrip()), width)]
        if len(words) != expected:
            raise MatrixFileError(path, f"{text.strip()[:40]!r}: expected {expected} numbers of width {width}", at)
        try:
            values += [number(word) for word in words]
        except ValueError as error:
            raise MatrixFileError(path, f"{error}: expected {expected} numbers of width {width}", at) from error
    return np.array(values)


def binary_layout(raw: bytes) -> tuple[str, int] | None:
    """Byte order and size of a word of a binary OP4, from its first bytes; None if it is none."""
    for order, name in (("<", "little"), (">", "big")):
        for length, word in ((24, 4), (48, 8)):
            if int.from_bytes(raw[:4], name) == length and len(raw) >= 8 + length:  # type: ignore[arg-type]
                return order, word
    return None


class _Binary:
    """Records of a Fortran file: length, data, length."""

    def __init__(self, path: Path, stream: BinaryIO, order: str, word: int) -> None:
        self.path, self.stream, self.order, self.word = path, stream, order, word
        self.size = path.stat().st_size

    def record(self) -> bytes | None:
        """The next record; None at the end of the file."""
        place = self.stream.tell()
        mark = self.stream.read(4)
        if not mark:
            return None
        length = int(np.frombuffer(mark, self.order + "i4")[0]) if len(mark) == 4 else -1
        if not 0 <= length <= self.size - place - 8:
            raise MatrixFileError(
                self.path, f"a record of {length} bytes at byte {place}: expected it to end within the file"
            )
        data = self.stream.read(length)
        if self.stream.read(4) != mark:
            raise MatrixFileError(self.path, f"the record at byte {place} does not end as it begins: a damaged file")
        return data

    def ints(self, data: bytes, count: int) -> list[int]:
        """The first whole numbers of a record."""
        if len(data) < count * self.word:
            raise MatrixFileError(self.path, f"a record of {len(data)} bytes: expected {count} whole numbers in it")
        return [int(value) for value in np.frombuffer(data, f"{self.order}i{self.word}", count)]


def read_binary_op4(path: Path, stream: BinaryIO, layout: tuple[str, int]) -> MatrixFile:
    """The matrices of a binary OP4."""
    records = _Binary(path, stream, *layout)
    found = []
    while (head := records.record()) is not None:
        if len(head) != 24 * records.word // 4:
            raise MatrixFileError(path, f"a header of {len(head)} bytes: expected {24 * records.word // 4}")
        columns, rows, form, type_ = records.ints(head, 4)
        name = head[4 * records.word :].decode("latin-1").split("\x00")[0].strip()
        if not re.fullmatch(r"[A-Za-z0-9_$.-]{1,16}", name):
            raise MatrixFileError(path, f"a matrix called {name[:16]!r}: expected letters and digits")
        digits = 7 if type_ in (1, 3) and records.word == 4 else 16
        matrix = _Columns(path, name, columns, rows, form, type_, digits)
        _binary_columns(records, matrix)
        found.append(matrix.finished())
    return MatrixFile(path, "Nastran OP4, binary", tuple(found))


def _binary_columns(records: _Binary, matrix: _Columns) -> None:
    double = records.word == 8 or matrix.type in (2, 4)
    kind, bytes_each = records.order + ("f8" if double else "f4"), 8 if double else 4
    while (data := records.record()) is not None:
        column, row, words = records.ints(data, 3)
        if column == matrix.columns + 1:
            return
        body = data[3 * records.word :]
        if len(body) != words * records.word or words < 0:
            raise MatrixFileError(
                records.path,
                f"column {column} of {matrix.name} has {len(body)} bytes for {words} words: a damaged file",
            )
        if row > 0:
            if len(body) % bytes_each:
                raise MatrixFileError(records.path, f"column {column} of {matrix.name} ends within a number")
            matrix.take(column, row, np.frombuffer(body, kind).astype(float))
            continue
        at = 0
        while at < len(body):
            ints = records.ints(body[at:], 2 if matrix.bigmat else 1)
            length, first = (ints[0], ints[1]) if matrix.bigmat else divmod(ints[0], 65536)
            at += len(ints) * records.word
            end = at + (length - 1) * records.word
            if length < 2 or end > len(body) or (end - at) % bytes_each:
                raise MatrixFileError(
                    records.path, f"a string of length {length} in column {column} of {matrix.name}: expected it to fit"
                )
            matrix.take(column, first, np.frombuffer(body[at:end], kind).astype(float))
            at = end
    raise MatrixFileError(records.path, f"ends within {matrix.name}: expected column {matrix.columns + 1} at its end")
