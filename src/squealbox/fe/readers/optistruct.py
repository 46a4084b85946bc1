"""OptiStruct .full.mat: named blocks STIFFNESS, MASS and DOFS, dense or sparse, by columns.

Read from its public description (OUTPUT, MATRIX, FULL); no file written by the program has been tried. A block is

    name  id  number type (1 whole, 2 real, 3 complex)  matrix type (1 dense, 3 sparse)  columns  rows  format
    column  first row  last row                          then the values of these rows, as many a line as there are

DOFS has a row ``node, direction`` for each freedom.
"""

import re
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from squealbox.fe.readers.matrix import (
    MASS,
    MOST_FREEDOMS,
    STIFFNESS,
    Entries,
    FileMatrix,
    MatrixFile,
    MatrixFileError,
    complete,
    with_labels,
)
from squealbox.fe.readers.numbers import number, text_lines

NAMES = {"STIFFNESS": STIFFNESS, "MASS": MASS, "DOFS": "labels"}


@dataclass
class _Block:
    name: str
    kind: int
    sparse: bool
    columns: int
    rows: int
    line: int
    entries: list[tuple[int, int, float]] = field(default_factory=list)
    column: int = 0
    row: int = 0
    last: int = -1


def read_full_mat(path: Path, stream: BinaryIO) -> MatrixFile:
    """K, M and the labels of their rows."""
    blocks: list[_Block] = []
    for at, text in text_lines(path, stream):
        words = text.replace(",", " ").split()
        if not words:
            continue
        if words[0].upper() in NAMES:
            if blocks:
                _ended(path, at, blocks[-1])
            blocks.append(_header(path, at, words))
        elif not blocks:
            raise MatrixFileError(path, f"{text.strip()[:40]!r}: expected STIFFNESS, MASS or DOFS", at)
        else:
            _line(path, at, words, blocks[-1])
    if not blocks:
        raise MatrixFileError(path, "holds no STIFFNESS, MASS or DOFS")
    _ended(path, blocks[-1].line, blocks[-1])
    labels = next((_labels(path, block) for block in blocks if block.name == "DOFS"), None)
    found = tuple(_matrix(path, block, labels) for block in blocks if block.name != "DOFS")
    if not found:
        raise MatrixFileError(path, "holds labels and no matrix: expected STIFFNESS or MASS")
    note = "read from the public description of the format; compare first frequencies with the code's own"
    return MatrixFile(path, "OptiStruct .full.mat", found, (note,))


def _header(path: Path, at: int, words: list[str]) -> _Block:
    try:
        _, kind, layout, columns, rows = (int(word) for word in words[1:6])
    except ValueError as error:
        raise MatrixFileError(
            path, f"{' '.join(words)[:60]!r}: expected name, id, types, columns and rows", at
        ) from error
    if kind not in (1, 2) or layout not in (1, 3) or not (0 < columns <= MOST_FREEDOMS and 0 < rows <= MOST_FREEDOMS):
        raise MatrixFileError(
            path,
            f"number type {kind}, matrix type {layout}, {columns} columns, {rows} rows: expected real or whole",
            at,
        )
    return _Block(words[0].upper(), kind, layout == 3, columns, rows, at)


def _line(path: Path, at: int, words: list[str], block: _Block) -> None:
    if block.row > block.last:
        if len(words) != 3 or not all(re.fullmatch(r"\d{1,9}", word) for word in words):
            raise MatrixFileError(path, f"{' '.join(words)[:40]!r}: expected column, first and last row", at)
        block.column, block.row, block.last = (int(word) for word in words)
        if not (1 <= block.column <= block.columns and 1 <= block.row <= block.last <= block.rows):
            raise MatrixFileError(path, f"{' '.join(words)[:40]!r} is outside {block.rows} x {block.columns}", at)
        return
    if len(words) > block.last - block.row + 1:
        raise MatrixFileError(
            path, f"{len(words)} numbers where {block.last - block.row + 1} are left in the column", at
        )
    try:
        values = [number(word) for word in words]
    except ValueError as error:
        raise MatrixFileError(path, f"{error}: expected numbers of column {block.column}", at) from error
    block.entries += [(block.row + i, block.column, value) for i, value in enumerate(values)]
    block.row += len(values)


def _ended(path: Path, at: int, block: _Block) -> None:
    if block.row <= block.last:
        raise MatrixFileError(path, f"{block.name} ends within column {block.column}: the file was cut short", at)
    if not block.sparse and len({column for _, column, _ in block.entries}) != block.columns:
        raise MatrixFileError(path, f"{block.name} is dense and lacks columns: the file was cut short", at)


def _labels(path: Path, block: _Block) -> Any:
    labels = np.zeros((max(block.rows, block.columns), 2), dtype=np.int64)
    turned = block.rows == 2 and block.columns != 2
    for row, column, value in block.entries:
        i, j = (column, row) if turned else (row, column)
        if j > 2 or value != round(value) or abs(value) > 2**45:
            raise MatrixFileError(
                path, "DOFS is not a table of node and direction: expected whole numbers in two columns"
            )
        labels[i - 1, j - 1] = int(value)
    return labels


def _matrix(path: Path, block: _Block, labels: np.ndarray | None) -> FileMatrix:
    rows, columns, values = (np.array(part) for part in zip(*block.entries, strict=True))
    keep = values != 0.0
    if block.rows != block.columns:
        raise MatrixFileError(
            path, f"{block.name} has {block.rows} rows and {block.columns} columns: expected a square one"
        )
    found = complete(
        path,
        block.name,
        NAMES[block.name],
        Entries(rows[keep] - 1, columns[keep] - 1, values[keep]),
        block.rows,
        "either",
    )
    if labels is None:
        return found
    if len(labels) != block.rows:
        raise MatrixFileError(path, f"DOFS names {len(labels)} freedoms, {block.name} has {block.rows} rows")
    return with_labels(found, labels)
