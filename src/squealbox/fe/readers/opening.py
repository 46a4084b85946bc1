"""Which format is it? By content, not by ending; then the reader of that format."""

import os
import re
from dataclasses import replace
from pathlib import Path
from typing import Any, BinaryIO

import numpy as np

from squealbox.fe.readers import abaqus, ansys, arrays, market, nastran, op4, optistruct
from squealbox.fe.readers.matrix import MatrixFile, MatrixFileError, with_labels
from squealbox.fe.readers.numbers import LARGEST_FILE, check_last_line, text_lines

HEAD = 20_000
KNOWN = "Abaqus .mtx, Nastran .pch or .op4, Ansys .full, MatrixMarket, OptiStruct .full.mat, CalculiX .sti, .mat, .npz"


def open_matrices(path: str | os.PathLike[str]) -> MatrixFile:
    """The matrices of one file of any known format; `MatrixFileError` says in one sentence what is wrong with it."""
    path = Path(path)
    try:
        size = path.stat().st_size
        if path.is_dir() or size > LARGEST_FILE:
            raise MatrixFileError(path, "is a folder" if path.is_dir() else f"has {size} bytes: too many")
        with path.open("rb") as stream:
            head = stream.read(HEAD)
    except OSError as error:
        raise MatrixFileError(path, f"cannot be read: {error.strerror or error}") from error
    if not head.strip():
        raise MatrixFileError(path, "is empty: expected a matrix")
    found = _binary(path, head)
    if found is not None:
        return found
    with path.open("rb") as stream:
        ends = check_last_line(path, stream)
    found = _text(path, head)
    return replace(found, notes=(*found.notes, *ends)) if ends else found


def _binary(path: Path, head: bytes) -> MatrixFile | None:
    if head.startswith(b"\x93NUMPY"):
        return arrays.read_npy(path)
    if head.startswith(b"PK"):
        return arrays.read_npz(path)
    if head.startswith(b"MATLAB 5.0") or (path.suffix == ".mat" and head[:4] in _VERSION_4 and b"\x00" in head):
        return arrays.read_mat(path)
    if head.startswith((b"\x89HDF", b"MATLAB 7.3")):
        raise MatrixFileError(path, "is an HDF5 file (MATLAB version 7.3): expected one saved with -v7")
    if ansys.is_full(head):
        return ansys.read_full(path, memoryview(path.read_bytes()))
    layout = op4.binary_layout(head)
    if layout:
        with path.open("rb") as stream:
            return op4.read_binary_op4(path, stream, layout)
    if b"\x00" in head:
        raise MatrixFileError(path, f"is a binary file of no known kind: expected {KNOWN}")
    return None


_VERSION_4 = tuple(kind.to_bytes(4, "little") for kind in (0, 10, 20, 30, 40, 50))


def _text(path: Path, head: bytes) -> MatrixFile:
    lines = [line.strip() for line in head.decode("latin-1").splitlines()[:-1] or [head.decode("latin-1")]]
    first = next((line for line in lines if line), "")
    with path.open("rb") as stream:
        if first.startswith("%%"):
            return market.read_market(path, stream)
        if first.split()[0].upper() in optistruct.NAMES:
            return optistruct.read_full_mat(path, stream)
        if re.match(r"\*(\*|USER|MATRIX|HEADING)", first.upper()):
            return abaqus.read_substructure(path, stream)
        if op4.HEADER.match(first):
            return op4.read_text_op4(path, stream)
        words = re.split(r"\s*,\s*|\s+", first.strip(", "))
        number = re.compile(r"[+-]?[\d.]+([eEdD]?[+-]?\d+)?")
        if all(number.fullmatch(word) for word in words) and len(words) in (3, 5):
            if len(words) == 5:
                return abaqus.read_matrix_input(path, stream, first)
            return _coordinates(path, stream, first)
        if path.suffix.lower() in (".mtx", ".sti", ".mas"):
            raise MatrixFileError(path, f"{first[:60]!r}: expected row, column and value, or a known header", 1)
        if path.suffix.lower() == ".op4":
            raise MatrixFileError(path, f"{first[:60]!r}: expected the header of an OP4 matrix", 1)
        if _bulk(path, lines):
            return nastran.read_dmig(path, stream)
    raise MatrixFileError(path, f"{first[:60]!r} is of no known kind: expected {KNOWN}", 1)


def _bulk(path: Path, lines: list[str]) -> bool:
    """Does it look like a punch or bulk data file of Nastran?"""
    return path.suffix.lower().startswith((".pch", ".bdf", ".dat", ".pnh")) or any(
        line.upper().startswith(("DMIG", "$", "GRID", "BEGIN")) for line in lines[:50]
    )


def _coordinates(path: Path, stream: BinaryIO, first: str) -> MatrixFile:
    calculix = path.suffix.lower() in (".sti", ".mas")
    found: MatrixFile = abaqus.read_coordinates(
        path, stream, first, half=calculix, code="CalculiX" if calculix else "Abaqus"
    )
    if not calculix:
        return found
    beside = path.with_suffix(".dof")
    if not beside.exists():
        note = f"no {beside.name} beside it: its rows have no labels"
        return MatrixFile(path, found.format, found.matrices, (note,))
    labels = read_dof(beside)
    (matrix,) = found.matrices
    size = len(labels)
    if matrix.matrix.shape[0] > size or (matrix.kind == "stiffness" and matrix.matrix.shape[0] != size):
        raise MatrixFileError(path, f"has {matrix.matrix.shape[0]} rows, {beside.name} names {size}: expected as many")
    matrix.matrix.resize((size, size))
    return MatrixFile(path, found.format, (with_labels(matrix, labels),))


def read_dof(path: Path) -> list[tuple[int, int]]:
    """The labels of a CalculiX .dof: one ``node.direction`` a line, a text and no decimal number (3.10 is not 3.1)."""
    labels = []
    with path.open("rb") as stream:
        for at, text in text_lines(path, stream):
            if not text.strip():
                continue
            match = re.fullmatch(r"(\d{1,12})\.(\d{1,2})", text.strip())
            if not match:
                raise MatrixFileError(path, f"{text.strip()[:40]!r}: expected node.direction, such as 3.1", at)
            labels.append((int(match[1]), int(match[2])))
    if len(set(labels)) != len(labels) or not labels:
        raise MatrixFileError(path, "names a freedom twice, or none: expected each once")
    return labels


def read_labels(path: str | os.PathLike[str], rows: int) -> Any:
    """Labels of `rows` rows, shape (rows, 2): a .dof, a list of nodes (each with as many directions), or a CSV.

    Raises `MatrixFileError`.
    """
    path = Path(path)
    try:
        head = path.read_bytes()[:HEAD]
    except OSError as error:
        raise MatrixFileError(path, f"cannot be read: {error.strerror or error}") from error
    if path.suffix.lower() == ".dof":
        labels = np.array(read_dof(path), dtype=np.int64)
    elif path.suffix.lower() == ".csv" and b"," in head:
        labels = _label_table(path)
    else:
        nodes = market.read_vector(path)
        each, left = divmod(rows, max(len(nodes), 1))
        if left or not 1 <= each <= 6:
            raise MatrixFileError(path, f"names {len(nodes)} nodes for {rows} rows: expected 1 to 6 rows of each node")
        labels = np.column_stack([np.repeat(nodes, each), np.tile(np.arange(1, each + 1), len(nodes))])
    if len(labels) != rows:
        raise MatrixFileError(path, f"names {len(labels)} freedoms, the matrices have {rows} rows: expected as many")
    return labels


def _label_table(path: Path) -> Any:
    labels: list[tuple[int, int]] = []
    with path.open("rb") as stream:
        for at, text in text_lines(path, stream):
            if not text.strip() or (not labels and not re.match(r"\s*[+-]?\d", text)):
                continue
            if not re.fullmatch(r"\s*-?\d{1,12}\s*,\s*\d{1,2}\s*", text):
                raise MatrixFileError(path, f"{text.strip()[:40]!r}: expected node, direction", at)
            node, direction = text.split(",")
            labels.append((int(node), int(direction)))
    return np.array(labels, dtype=np.int64).reshape(-1, 2)
