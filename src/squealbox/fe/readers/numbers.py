"""Numbers from text in blocks, so a file of gigabytes is never held as text; an error names its line."""

import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from squealbox.fe.readers.matrix import MOST_FREEDOMS, MatrixFileError

BLOCK = 4_000_000  # bytes of text at a time
LONGEST_LINE = 100_000
LARGEST_FILE = 20_000_000_000  # bytes
_NUMBER = re.compile(r"[+-]?(\d+\.?\d*|\.\d+)([eEdD][+-]?\d+|[+-]\d+)?")
_NO_LETTER = re.compile(r"(?<=[0-9.])([+-]\d+)$")


def number(word: str) -> float:
    """A number as Fortran and C write it: 2.0D+06 and 2.0+6 are 2e6; `ValueError` for anything else, such as 2,5."""
    word = word.strip()
    if not _NUMBER.fullmatch(word):
        raise ValueError(f"{word[:40]!r} is not a number")
    word = word.replace("D", "E").replace("d", "e")
    value = float(word if "e" in word.lower() else _NO_LETTER.sub(r"E\1", word))
    if abs(value) == float("inf"):
        raise ValueError(f"{word[:40]!r} is no finite number")
    return value


def significant_digits(words: Sequence[str]) -> int | None:
    """The largest number of digits any of these numbers is written with."""
    counts = [len(re.sub(r"[eEdD].*$", "", word.strip()).strip("+-").replace(".", "").lstrip("0")) for word in words]
    return max(counts, default=None)


def text_lines(path: Path, stream: BinaryIO, first: int = 1) -> Iterator[tuple[int, str]]:
    """The lines of a text file with their numbers; a line that is too long or not text is a `MatrixFileError`."""
    at = first
    while raw := stream.readline(LONGEST_LINE + 1):
        if len(raw) > LONGEST_LINE:
            raise MatrixFileError(path, f"is longer than {LONGEST_LINE} characters: expected a line of text", at)
        yield at, decoded(path, raw, at)
        at += 1


def decoded(path: Path, raw: bytes, line: int) -> str:
    """A line as text without its end."""
    try:
        text = raw.decode("ascii")
    except UnicodeDecodeError as error:
        raise MatrixFileError(path, "holds characters that are not plain text", line) from error
    if "\x00" in text:
        raise MatrixFileError(path, "holds a zero byte: expected text", line)
    return text.rstrip("\r\n")


def check_last_line(path: Path, stream: BinaryIO) -> tuple[str, ...]:
    """A note where the last line has no end; `MatrixFileError` where its number is shorter than those before it too."""
    stream.seek(0, 2)
    size = stream.tell()
    stream.seek(max(size - 4000, 0))
    tail = stream.read()
    stream.seek(0)
    if tail.endswith((b"\n", b"\r")) or not tail.strip():
        return ()
    words = [line.replace(b",", b" ").split() for line in tail.splitlines()[-6:]]
    counts = [significant_digits([line[-1].decode("latin-1")]) or 0 for line in words if line]
    if len(counts) > 1 and min(counts[1:-1] or counts[:1]) >= 9 and counts[-1] < min(counts[1:-1] or counts[:1]):
        line = 1
        while block := stream.read(BLOCK):
            line += block.count(b"\n")
        raise MatrixFileError(path, "ends within a number: the file was cut short", line)
    return ("the last line has no end: the file may have been cut",)


def columns_of(path: Path, stream: BinaryIO, line: int, width: int, comma: bool, comment: bytes = b"") -> list[Any]:
    """The rest of a file as `width` columns; the first width - 1 as whole numbers, the last as floats."""
    parts: list[list[Any]] = [[] for _ in range(width)]
    while block := stream.readlines(BLOCK):
        table = _block(path, block, line, width, comma, comment)
        if table.size:
            whole = table[:, :-1]
            bad = np.flatnonzero(np.any((whole != np.round(whole)) | (abs(whole) > 2**53), axis=1))
            if bad.size:
                _slow(path, block, line, width, comma, comment)
                raise MatrixFileError(path, f"entry {bad[0] + 1} of the block from line {line} has no whole index")
            biggest = float(abs(whole).max(initial=0.0))
            kind = np.int32 if biggest < 2**31 else np.int64
            for i in range(width - 1):
                parts[i].append(table[:, i].astype(kind))
            parts[-1].append(table[:, -1].copy())
        line += len(block)
    found = []
    for i in range(width):
        found.append(np.concatenate(parts[i]) if parts[i] else np.zeros(0, dtype=float if i == width - 1 else np.int32))
        parts[i] = []
    return found


def _block(path: Path, block: list[bytes], line: int, width: int, comma: bool, comment: bytes) -> Any:
    text = b"".join(block)
    if not text.strip():
        return np.zeros((0, width))
    plain = text.replace(b"D", b"E").replace(b"d", b"e") if b"D" in text or b"d" in text else text
    odd = re.search(rb"[^0-9eE+\-., \t\r\n]", plain) or (b"," in plain and not comma)
    if not odd and not re.search(rb"[0-9.][+-]", plain):
        try:
            table = np.loadtxt(
                plain.decode("ascii").splitlines(), ndmin=2, comments=None, delimiter="," if comma else None
            )
            if table.shape[1] == width:
                return table
        except (ValueError, UnicodeDecodeError):
            return _slow(path, block, line, width, comma, comment)
    return _slow(path, block, line, width, comma, comment)


def _slow(path: Path, block: list[bytes], line: int, width: int, comma: bool, comment: bytes) -> Any:
    """Line by line: for numbers without a letter before their exponent, comments, and to find the line of an error."""
    rows = []
    for at, raw in enumerate(block, line):
        if len(raw) > LONGEST_LINE:
            raise MatrixFileError(path, f"is longer than {LONGEST_LINE} characters: expected {width} numbers", at)
        text = decoded(path, raw, at)
        if not text.strip() or (comment and raw.lstrip().startswith(comment)):
            continue
        words = text.split(",") if comma else text.split()
        if len(words) != width:
            raise MatrixFileError(path, f"{text.strip()[:60]!r} has {len(words)} numbers: expected {width}", at)
        try:
            row = [number(word) for word in words]
        except ValueError as error:
            raise MatrixFileError(path, f"{error}: expected {width} numbers", at) from error
        if any(value != round(value) or abs(value) > 2**53 for value in row[:-1]):
            raise MatrixFileError(path, f"{text.strip()[:60]!r}: expected whole numbers before the last", at)
        rows.append(row)
    return np.array(rows, dtype=float).reshape(-1, width)


def check_index(path: Path, index: np.ndarray, size: int | None, first: int | None = None) -> Any:
    """Indices from 0 for those from 1, which must be 1 to `size`; `first` is the line of the first."""
    most = MOST_FREEDOMS if size is None else size
    bad = np.flatnonzero((index < 1) | (index > most))
    if bad.size:
        line = None if first is None else first + int(bad[0])
        raise MatrixFileError(path, f"the index {index[bad[0]]}: expected 1 to {most}", line)
    return index - 1
