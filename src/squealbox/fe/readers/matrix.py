"""What a file of another code holds: matrices with labels, and how they were completed. Depends on: nothing."""

import re
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

if TYPE_CHECKING:
    from scipy.sparse import sparray

MOST_FREEDOMS = 20_000_000
MASS, STIFFNESS, DAMPING, STRUCTURAL, OTHER = "mass", "stiffness", "damping", "structural damping", "other"


class MatrixFileError(ValueError):
    """A matrix file cannot be read; one sentence with the file, the line where there is one, given and expected."""

    def __init__(self, path: Path | str, sentence: str, line: int | None = None) -> None:
        self.path, self.sentence, self.line = Path(path), sentence, line
        where = Path(path).name if line is None else f"{Path(path).name}, line {line}"
        super().__init__(f"{where}: {sentence}")


@dataclass(frozen=True, eq=False)
class FileMatrix:
    """One matrix of a file.

    name as the file calls it; kind "mass", "stiffness", "damping", "structural damping" or "other"; matrix sparse,
    shape (n, m), complete; symmetry in words; entries as stored in the file; labels shape (n, 2), node and direction of
    each row (1 to 3 displacements, 4 to 6 rotations, 0 a scalar point), or None; digits of its numbers; notes are
    sentences a user should read.
    """

    name: str
    kind: str
    matrix: Any
    symmetry: str
    entries: int
    labels: Any = None
    digits: int | None = None
    notes: tuple[str, ...] = ()
    column_labels: Any = None

    @property
    def square(self) -> bool:
        """Are there as many rows as columns?"""
        return bool(self.matrix.shape[0] == self.matrix.shape[1])


@dataclass(frozen=True, eq=False)
class MatrixFile:
    """The matrices of one file, its format in words, labels of rows that no matrix carries itself, and notes."""

    path: Path
    format: str
    matrices: tuple[FileMatrix, ...]
    notes: tuple[str, ...] = field(default=())
    constrained: Any = None


def kind_of(name: str) -> str:
    """Which matrix a name such as KAAX, MGG, BAAX, K4AAX, job_STIF1 or pad_MASS2 stands for."""
    word = name.upper().rsplit(".", 1)[0] if "." in name else name.upper()
    for mark, kind in (("STIF", STIFFNESS), ("MASS", MASS), ("DMPV", DAMPING), ("DMPS", STRUCTURAL)):
        if mark in word:
            return kind
    if word in ("K", "M", "C"):
        return {"K": STIFFNESS, "M": MASS, "C": DAMPING}[word]
    for start, kind in (("K4", STRUCTURAL), ("K", STIFFNESS), ("M", MASS), ("B", DAMPING)):
        if re.fullmatch(start + r"(2?(AA|FF|GG|HH|JJ|LL|NN|OO|PP|QQ|RR|SS|TT|XX)X?\d*)?", word):
            return kind
    return OTHER


@dataclass
class Entries:
    """Entries of a matrix, indices from 0; `lines` tells the line of the i-th one where the file is a text.

    They are let go as soon as the matrix stands, so a caller that keeps none of its own holds each entry once.
    """

    rows: Any
    columns: Any
    values: Any
    lines: Any = None

    def line(self, index: int) -> int | None:
        """The line of an entry."""
        return None if self.lines is None else int(self.lines(index))

    def free(self) -> None:
        """Let the entries go."""
        self.rows = self.columns = self.values = np.zeros(0)


def _sparse(entries: Entries, shape: tuple[int, int], path: Path, name: str) -> Any:
    from scipy.sparse import coo_array

    rows, columns, values = entries.rows, entries.columns, entries.values
    stored = len(values)
    matrix = coo_array((values, (rows, columns)), shape=shape).tocsr()
    if matrix.nnz != stored:
        order = np.lexsort((columns, rows))
        r, c = rows[order], columns[order]
        at = int(np.flatnonzero((r[1:] == r[:-1]) & (c[1:] == c[:-1]))[0])
        line = entries.line(int(max(order[at], order[at + 1])))
        where = f"row {r[at] + 1}, column {c[at] + 1}"
        raise MatrixFileError(path, f"{name} holds the entry of {where} twice: expected each entry once", line)
    return matrix


def complete(
    path: Path,
    name: str,
    kind: str,
    entries: Entries,
    size: int | tuple[int, int],
    rule: str,
    **about: Any,
) -> FileMatrix:
    """The matrix of these entries (from 0), its other half added where the file holds one half.

    `rule` is "half" (the format stores one half), "full" (all is there), or "either": if no (i, j) occurs with (j, i)
    the file is a half, if all do it is complete, if some do it is refused, because then nobody knows what is missing.
    """
    shape = (size, size) if isinstance(size, int) else size
    if max(shape) > MOST_FREEDOMS:
        raise MatrixFileError(path, f"{name} has {max(shape)} rows or columns: expected at most {MOST_FREEDOMS}")
    stored = len(entries.values)
    if stored == 0:
        raise MatrixFileError(path, f"{name} holds no entries: expected some")
    bad = np.flatnonzero(~np.isfinite(entries.values))
    if bad.size:
        value, line = entries.values[bad[0]], entries.line(int(bad[0]))
        raise MatrixFileError(path, f"{name} holds {value}: expected finite numbers", line)
    matrix = _sparse(entries, shape, path, name)
    if shape[0] != shape[1]:
        return FileMatrix(name, kind, matrix, "rectangular", stored, **about)
    twins, off, lonely = _pairs(matrix)
    if rule != "either" or twins in (0, off):
        entries.free()
    words = "diagonal" if off == 0 else "complete"
    if off and rule != "full" and twins == 0:
        from scipy.sparse import diags_array

        matrix = (matrix + matrix.T - diags_array(matrix.diagonal())).tocsr()
        words = "one half, mirrored"
        _whole_half(path, name, kind, matrix, about.get("labels"))
    elif off and rule == "half":
        raise MatrixFileError(
            path,
            f"{name} says it is one half of a symmetric matrix, but {twins // 2} pairs occur both ways: expected one",
        )
    elif off and rule == "either" and twins != off:
        i, j = lonely
        at = int(np.flatnonzero((entries.rows == i) & (entries.columns == j))[0])
        raise MatrixFileError(
            path,
            f"{name} holds {twins // 2} pairs both ways and {off - twins} entries one way, such as row {i + 1}, column "
            f"{j + 1}: expected a whole matrix or one half of it",
            entries.line(at),
        )
    if words == "complete":
        words = _symmetry(matrix)
    if kind == STIFFNESS:
        about["notes"] = (*about.get("notes", ()), *_without_diagonal(matrix, about.get("labels")))
    found = FileMatrix(name, kind, matrix, words, stored, **about)
    if kind == MASS:
        check_mass(path, found)
    return found


def _pairs(matrix: "sparray") -> tuple[int, int, tuple[int, int]]:
    """Entries off the diagonal that have a twin, all entries off the diagonal, and one without a twin."""
    from scipy.sparse import csr_array

    pattern = csr_array((np.ones(matrix.nnz, dtype=np.int8), matrix.indices, matrix.indptr), shape=matrix.shape)
    on = int(np.count_nonzero(pattern.diagonal()))
    off = pattern.nnz - on
    turned = pattern.T.tocsr()
    if np.array_equal(turned.indptr, pattern.indptr) and np.array_equal(turned.indices, pattern.indices):
        return off, off, (0, 0)
    del turned
    both = pattern.multiply(pattern.T).tocsr()
    twins = both.nnz - on
    if twins in (0, off):
        return twins, off, (0, 0)
    lonely = (pattern - both).tocoo()
    at = int(np.flatnonzero(lonely.data)[0])
    return twins, off, (int(lonely.row[at]), int(lonely.col[at]))


def _symmetry(matrix: "sparray") -> str:
    """Symmetric to the digits of a file (1e-9 of the largest of its row and column), or how far from it."""
    turned = matrix.T.tocsr()
    if np.array_equal(turned.indices, matrix.indices) and np.array_equal(turned.data, matrix.data):
        return "symmetric, both halves"
    apart = abs(matrix - turned).tocsr()
    del turned
    if apart.nnz == 0 or apart.max() == 0.0:
        return "symmetric, both halves"
    size = np.sqrt(np.maximum(abs(matrix).max(axis=1).toarray().ravel(), 1e-300))
    rows = np.repeat(np.arange(matrix.shape[0]), np.diff(apart.indptr))
    wrong = apart.data > 1e-9 * size[rows] * size[apart.indices]
    if not wrong.any():
        return "symmetric, both halves"
    skew = abs(matrix + matrix.T)
    if skew.max() == 0.0:
        return "skew-symmetric"
    return f"unsymmetric ({int(wrong.sum()) // 2} pairs differ, largest difference {apart.max():.3g})"


def _without_diagonal(matrix: "sparray", labels: np.ndarray | None) -> tuple[str, ...]:
    """A note where freedoms are coupled and have no stiffness of their own."""
    lost = np.flatnonzero((matrix.diagonal() == 0.0) & (np.diff(matrix.indptr) > 0))
    if not lost.size:
        return ()
    first = ", ".join(shown_label(labels, int(row)) for row in lost[:3])
    return (f"{lost.size} freedoms are coupled without stiffness of their own ({first}): multipliers, or a cut file",)


def shown_label(labels: np.ndarray | None, row: int) -> str:
    """How a freedom is called in a sentence: 7.1 is direction 1 of node 7."""
    return f"{labels[row][0]}.{labels[row][1]}" if labels is not None else f"row {row + 1}"


def _whole_half(path: Path, name: str, kind: str, matrix: "sparray", labels: np.ndarray | None) -> None:
    """A half without a diagonal where rows are coupled was cut, unless the freedom is internal (a multiplier)."""
    if kind not in (STIFFNESS, MASS):
        return
    lost = np.flatnonzero((matrix.diagonal() == 0.0) & (np.diff(matrix.indptr) > 0))
    if labels is not None:
        lost = lost[np.asarray(labels)[lost, 0] > 0]
    if lost.size:
        raise MatrixFileError(
            path,
            f"{name}: freedom {shown_label(labels, int(lost[0]))} is coupled to others but has no entry on the diagonal"
            f" ({lost.size} such): expected one, or the file was cut short",
        )


def check_mass(path: Path, mass: FileMatrix) -> None:
    """Raise where a mass matrix has a negative diagonal, or couples freedoms more than their own masses allow."""
    matrix = mass.matrix
    diagonal = matrix.diagonal()
    scale = float(abs(diagonal).max()) if diagonal.size else 0.0
    low = np.flatnonzero(diagonal < -1e-9 * scale)
    if low.size:
        where = shown_label(mass.labels, int(low[0]))
        raise MatrixFileError(
            path, f"{mass.name}: the mass of {where} is {diagonal[low[0]]:g}: expected none below zero"
        )
    root = np.sqrt(np.maximum(diagonal, 0.0))
    rows = np.repeat(np.arange(matrix.shape[0]), np.diff(matrix.indptr))
    over = np.flatnonzero(abs(matrix.data) > root[rows] * root[matrix.indices] * (1 + 1e-6) + 1e-9 * scale)
    if over.size:
        i, j = int(rows[over[0]]), int(matrix.indices[over[0]])
        names = f"{shown_label(mass.labels, i)} and {shown_label(mass.labels, j)}"
        raise MatrixFileError(
            path,
            f"{mass.name} couples {names} by {matrix.data[over[0]]:g}, more than their own masses "
            f"{diagonal[i]:g} and {diagonal[j]:g} allow: expected a positive semidefinite mass matrix",
        )


def with_labels(matrix: FileMatrix, labels: ArrayLike) -> FileMatrix:
    """The matrix with the labels of its rows."""
    return replace(matrix, labels=np.asarray(labels, dtype=np.int64))
