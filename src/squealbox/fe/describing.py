"""What matrix files hold, in words and columns, for the command line."""

import os
from collections.abc import Iterable

import numpy as np

from squealbox.fe.readers.matrix import FileMatrix, MatrixFileError, shown_label
from squealbox.fe.readers.opening import open_matrices
from squealbox.fe.structure import Structure, read_matrices


def described(paths: Iterable[str | os.PathLike[str]], count: int = 6, units: str | None = None) -> str:
    """Format, size, entries, symmetry, labels and digits of each matrix; of all together doubts and first frequencies.

    Raises `MatrixFileError`, also where the files do not fit together.
    """
    paths = list(paths)
    lines: list[str] = []
    kinds: list[str] = []
    for path in paths:
        file = open_matrices(path)
        lines.append(f"{file.path.name}: {file.format}")
        for matrix in file.matrices:
            kinds.append(matrix.kind)
            lines.append(f"  {_line(matrix)}")
            lines += [f"    note: {note}" for note in matrix.notes]
        lines += [f"  note: {note}" for note in file.notes]
    if "stiffness" in kinds:
        lines += _together(read_matrices(*paths, units=units), "mass" in kinds, count)
    else:
        lines.append("no matrix is known as stiffness by its name: no frequencies")
    return "\n".join(lines)


def _line(matrix: FileMatrix) -> str:
    rows, columns = matrix.matrix.shape
    words = [f"{matrix.name} ({matrix.kind})", f"{rows} x {columns}", f"{matrix.entries} entries", matrix.symmetry]
    if np.iscomplexobj(matrix.matrix.data):
        words.append("complex")
    if matrix.labels is None:
        words.append("no labels")
    else:
        nodes = len(np.unique(matrix.labels[:, 0]))
        ends = f"{shown_label(matrix.labels, 0)} to {shown_label(matrix.labels, rows - 1)}"
        words.append(f"labels of {nodes} nodes, {ends}")
    if matrix.digits:
        words.append(f"{matrix.digits} digits")
    return ", ".join(words)


def _together(structure: Structure, mass: bool, count: int) -> list[str]:
    lines = [f"together: {structure.size} freedoms"]
    if not mass:
        return [*lines, "no mass matrix: no frequencies", *(f"note: {doubt}" for doubt in structure.doubts())]
    frequencies = structure.frequencies(count)
    lines.append("first frequencies [Hz]: " + ", ".join(f"{value:.6g}" for value in frequencies))
    lines += [f"note: {doubt}" for doubt in structure.doubts(frequencies)]
    return lines


__all__ = ["MatrixFileError", "described"]
