"""Abaqus: *MATRIX OUTPUT in its text formats, and *SUBSTRUCTURE MATRIX OUTPUT.

COORDINATE is ``row column value`` with both triangles and no labels. MATRIX INPUT is ``node,dof, node,dof, value`` with
one half, and which half changes from line to line; negative nodes are internal freedoms. An unsymmetric export holds
(i, j) and (j, i), and nothing in the file says so. A substructure says its node numbers in comment lines only.
"""

import re
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from squealbox.fe.readers.labels import between_labels, coded, decoded_labels
from squealbox.fe.readers.matrix import (
    DAMPING,
    MASS,
    MOST_FREEDOMS,
    OTHER,
    STIFFNESS,
    STRUCTURAL,
    Entries,
    FileMatrix,
    MatrixFile,
    MatrixFileError,
    complete,
    kind_of,
)
from squealbox.fe.readers.numbers import (
    check_index,
    columns_of,
    number,
    significant_digits,
    text_lines,
)

KINDS = {"STIFFNESS": STIFFNESS, "MASS": MASS, "VISCOUS DAMPING": DAMPING, "STRUCTURAL DAMPING": STRUCTURAL}


def read_coordinates(path: Path, stream: BinaryIO, first: str, *, half: bool = False, code: str = "Abaqus") -> Any:
    """``row column value`` from 1 without a header; `half` when the format stores one half only."""
    rows, columns, values = columns_of(path, stream, 1, 3, comma=False)
    name = path.name if code == "Abaqus" else {".sti": "K", ".mas": "M"}.get(path.suffix.lower(), path.name)
    rows, columns = check_index(path, rows, None, 1), check_index(path, columns, None, 1)
    kind = kind_of(name) if kind_of(name) != OTHER else kind_of(path.stem)
    size = int(max(rows.max(initial=-1), columns.max(initial=-1))) + 1
    used = np.zeros(size, dtype=bool)
    used[rows] = used[columns] = True
    empty = np.flatnonzero(~used)
    if len(empty) > 0.9 * size + 10:
        raise MatrixFileError(
            path, f"reaches row {size} with {size - len(empty)} rows in use: expected a matrix without such a gap"
        )
    if empty.size and kind == STIFFNESS:
        raise MatrixFileError(
            path, f"row {empty[0] + 1} of {size} has no entry ({empty.size} such): expected stiffness in every row"
        )
    notes = (f"{empty.size} of {size} rows have no entry",) if empty.size else ()
    digits = significant_digits(first.split()[-1:])
    entries = Entries(rows, columns, values, lambda i: i + 1)
    del rows, columns, values
    matrix = complete(
        path,
        name,
        kind,
        entries,
        size,
        "half" if half else "either",
        digits=digits,
        notes=notes,
    )
    words = f"{code}, coordinate text" if code != "CalculiX" else "CalculiX matrix storage"
    return MatrixFile(path, words, (matrix,))


def read_matrix_input(path: Path, stream: BinaryIO, first: str) -> MatrixFile:
    """``row node, row dof, column node, column dof, value``; half or complete is found by pairs."""
    node, direction, other, along, values = columns_of(path, stream, 1, 5, comma="," in first)
    entries = Entries(coded(path, node, direction), coded(path, other, along), values, lambda i: i + 1)
    del node, direction, other, along
    digits = significant_digits(re.split(r"[,\s]+", first.strip())[-1:])
    kind = kind_of(path.stem)
    found = between_labels(path, path.name, kind, entries, "either", digits=digits)
    return MatrixFile(path, "Abaqus, matrix input text", (found,))


def read_substructure(path: Path, stream: BinaryIO) -> MatrixFile:
    """*USER ELEMENT, NODES=, LINEAR[, UNSYM] and its *MATRIX blocks."""
    state = _Substructure(path)
    for at, text in text_lines(path, stream):
        state.line(at, text)
    return state.finished()


class _Substructure:
    """What has been read so far: nodes from comments, freedoms from data lines, numbers of each matrix."""

    def __init__(self, path: Path) -> None:
        self.path, self.count, self.unsymmetric = path, 0, False
        self.nodes: list[int] = []
        self.directions: list[list[int]] = []
        self.part, self.listing = "", False
        self.blocks: list[tuple[str, int, list[float]]] = []
        self.node_order: list[tuple[int, list[int]]] = []

    def line(self, at: int, text: str) -> None:
        """Take one line."""
        if text.startswith("**"):
            self._comment(at, text[2:].strip())
        elif text.startswith("*"):
            self._keyword(at, text.upper())
        elif text.strip():
            self._data(at, text)

    def _comment(self, at: int, words: str) -> None:
        if "ELEMENT NODES" in words.upper():
            self.listing = True
        elif self.listing and re.fullmatch(r"[\d,\s]+", words):
            self.nodes += [int(word) for word in re.split(r"[,\s]+", words.strip(", ")) if word]
        else:
            self.listing = False

    def _keyword(self, at: int, text: str) -> None:
        self.listing = False
        if text.startswith("*USER ELEMENT"):
            found = re.search(r"NODES\s*=\s*(\d+)", text)
            if not found or int(found[1]) > MOST_FREEDOMS:
                raise MatrixFileError(self.path, "*USER ELEMENT without NODES= and their number", at)
            if self.count:
                raise MatrixFileError(self.path, "a second *USER ELEMENT: expected one substructure in a file", at)
            self.count, self.unsymmetric, self.part = int(found[1]), "UNSYM" in text, "freedoms"
        elif text.startswith("*MATRIX"):
            found = re.search(r"TYPE\s*=\s*([A-Z ]+?)\s*(,|$)", text)
            if not found or found[1] not in KINDS:
                known = ", ".join(KINDS)
                raise MatrixFileError(self.path, f"{text.strip()[:60]!r}: expected TYPE= one of {known}", at)
            self.part = "matrix"
            self.blocks.append((found[1], at, []))
        else:
            self.part = "other"

    def _data(self, at: int, text: str) -> None:
        words = [word for word in text.split(",") if word.strip()]
        try:
            if self.part == "freedoms":
                whole = [int(word) for word in words]
                if not self.directions or len(whole) < 2 or not self.node_order_line(whole):
                    self.directions.append(whole)
            elif self.part == "matrix":
                self.blocks[-1][2].extend(number(word) for word in words)
        except ValueError as error:
            raise MatrixFileError(self.path, f"{str(error)[:80]}: expected numbers between commas", at) from error

    def node_order_line(self, whole: list[int]) -> bool:
        """A further line ``position, dof, dof ...`` gives other freedoms from that node on."""
        if 2 <= whole[0] <= self.count and all(1 <= value <= 30 for value in whole[1:]):
            self.node_order.append((whole[0], whole[1:]))
            return True
        return False

    def _labels(self) -> Any:
        if not self.count or not self.directions:
            raise MatrixFileError(self.path, "no *USER ELEMENT with its line of freedoms: expected a substructure")
        if len(self.nodes) != self.count:
            raise MatrixFileError(
                self.path, f"names {len(self.nodes)} nodes in its comments, *USER ELEMENT says {self.count}"
            )
        first = [value for line in self.directions for value in line]
        changes = dict(self.node_order)
        labels, now = [], first
        for i, node in enumerate(self.nodes, 1):
            now = changes.get(i, now)
            labels += [(node, value) for value in now]
        codes = coded(self.path, *np.array(labels).T)
        if len(np.unique(codes)) != len(codes):
            raise MatrixFileError(self.path, "names a node or a freedom twice: expected each once")
        return decoded_labels(codes)

    def finished(self) -> MatrixFile:
        """The matrices, each as long as its nodes say."""
        labels = self._labels()
        if not self.blocks:
            raise MatrixFileError(self.path, "holds no *MATRIX: expected a stiffness matrix")
        return MatrixFile(
            self.path, "Abaqus substructure", tuple(self._matrix(labels, *block) for block in self.blocks)
        )

    def _matrix(self, labels: np.ndarray, name: str, line: int, numbers: list[float]) -> FileMatrix:
        size = len(labels)
        half = size * (size + 1) // 2
        whole = self.unsymmetric and len(numbers) != half  # also an unsymmetric one writes its mass as a half
        expected = size * size if whole else half
        if len(numbers) != expected:
            raise MatrixFileError(
                self.path,
                f"{name} has {len(numbers)} numbers: expected {expected} for {size} freedoms",
                line,
            )
        if whole:
            rows, columns = np.divmod(np.arange(expected), size)
        else:
            rows, columns = np.tril_indices(size)
        values = np.array(numbers)
        rule = "full" if whole else "half"
        return complete(
            self.path, name, KINDS[name], Entries(rows, columns, values), size, rule, labels=labels, digits=14
        )
