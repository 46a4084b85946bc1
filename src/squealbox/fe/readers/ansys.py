"""The assembled file of Ansys, `job.full`, as its sparse solver writes it.

A file of records ``length, flags, data, length`` in words of 4 bytes. The record behind the standard header says how
many equations and terms there are and where K, M, C and the freedoms begin; each row of a matrix is a record of columns
from 1 and one of values, upper half only. Freedoms with a negative mark are constrained: their rows are emptied, and
they are named.
"""

from pathlib import Path
from typing import Any

import numpy as np

from squealbox.fe.readers.matrix import (
    DAMPING,
    MASS,
    MOST_FREEDOMS,
    STIFFNESS,
    Entries,
    FileMatrix,
    MatrixFile,
    MatrixFileError,
    complete,
)

# Places in the header: (terms low, terms high, pointer low, pointer high)
PLACES = {"K": (STIFFNESS, 8, 9, 18, 19), "M": (MASS, 33, 21, 26, 27), "C": (DAMPING, 34, 39, 28, 29)}
EQUATIONS, MATRICES_UNSYMMETRIC, LUMPED, NODES, FREEDOMS = 1, 13, 10, 32, (35, 36)


class _Records:
    """Records by their place in words."""

    def __init__(self, path: Path, raw: Any) -> None:
        self.path, self.raw, self.words = path, raw, len(raw) // 4

    def at(self, place: int) -> tuple[Any, int]:
        """The numbers of the record at `place`, and the place of the next one."""
        if not 0 <= place <= self.words - 3:
            raise MatrixFileError(
                self.path, f"points to word {place} of {self.words}: the file was cut short or damaged"
            )
        length = int(np.frombuffer(self.raw, "<i4", 1, 4 * place)[0])
        flags = self.raw[4 * place + 7]
        end = place + 2 + length
        if not length >= 0 or end >= self.words:
            raise MatrixFileError(self.path, f"a record of {length} words at word {place}: expected it within the file")
        if int(np.frombuffer(self.raw, "<i4", 1, 4 * end)[0]) != length:
            raise MatrixFileError(self.path, f"the record at word {place} does not end as it begins: a damaged file")
        data = self.raw[4 * place + 8 : 4 * end]
        if flags & 0x28:
            raise MatrixFileError(self.path, f"the record at word {place} is compressed: expected a plain one")
        kind = {0x80: "<i4", 0xC0: "<i2", 0x00: "<f8", 0x40: "<f4"}[flags & 0xC0]
        if flags & 0x10:
            return _windows(self.path, data, kind, place), end + 1
        return np.frombuffer(data, kind, len(data) // int(kind[-1])), end + 1


def _windows(path: Path, data: bytes, kind: str, place: int) -> Any:
    """A record stored as windows: one value, a run of values, or one value repeated."""
    ints = np.frombuffer(data, "<i4", len(data) // 4)
    step = max(int(kind[-1]) // 4, 1)
    try:
        size, count, at = int(ints[0]), int(ints[1]), 2
        if not 0 <= size <= 6 * MOST_FREEDOMS:
            raise IndexError
        found = np.zeros(size, kind)
        for _ in range(count):
            start, at = int(ints[at]), at + 1
            if start > 0:
                found[start] = np.frombuffer(data, kind, 1, 4 * at)[0]
                at += step
                continue
            length, at = int(ints[at]), at + 1
            values = np.frombuffer(data, kind, length if length > 0 else 1, 4 * at)
            found[-start : -start + abs(length)] = values
            at += step * len(values)
    except (IndexError, ValueError) as error:
        raise MatrixFileError(
            path, f"the record at word {place} has damaged windows: expected values in them"
        ) from error
    return found


def read_full(path: Path, raw: Any) -> MatrixFile:
    """K, M and C of a .full file with their labels."""
    records = _Records(path, raw)
    _, place = records.at(0)
    header, place = records.at(place)
    if len(header) < 85 or header.dtype.kind != "i" or header[0] >= 0:
        raise MatrixFileError(path, "is not a .full file of the sparse solver: expected its header")
    size, nodes = int(header[EQUATIONS]), int(header[NODES])
    if not 1 <= size <= MOST_FREEDOMS or not 1 <= nodes <= size:
        raise MatrixFileError(path, f"says {size} equations and {nodes} nodes: expected at least one of each")
    if header[MATRICES_UNSYMMETRIC]:
        raise MatrixFileError(path, "holds unsymmetric matrices: expected symmetric ones; export them by *EXPORT,MMF")
    if header[LUMPED]:
        raise MatrixFileError(path, "holds a lumped mass matrix: expected a consistent one; export it by *EXPORT,MMF")
    labels, constrained = _labels(records, header, place, size, nodes)
    found, notes = [], []
    for name, (kind, low, high, at, above) in PLACES.items():
        terms = _long(header, low, high)
        if terms == 0:
            if name == "M":
                notes.append("no mass matrix: the analysis was static; a modal one writes it")
            continue
        found.append(_matrix(records, name, kind, terms, _long(header, at, above), size, labels, constrained))
    if not found:
        raise MatrixFileError(path, "says it holds no terms of any matrix: expected a stiffness matrix")
    gone = int(constrained.sum())
    if gone:
        first = ", ".join(f"{a}.{b}" for a, b in labels[constrained][:3])
        notes.append(f"{gone} of {size} freedoms are constrained ({first}, ...): their rows are empty")
    return MatrixFile(path, "Ansys .full", tuple(found), tuple(notes), labels[constrained] if gone else None)


def _long(header: np.ndarray, low: int, high: int) -> int:
    return (int(header[low]) & 0xFFFFFFFF) | (int(header[high]) << 32)


def _labels(records: _Records, header: np.ndarray, place: int, size: int, nodes: int) -> tuple[Any, Any]:
    _, place = records.at(place)  # which kinds of freedoms there are
    numbers, _ = records.at(place)
    counts, place = records.at(_long(header, *FREEDOMS))
    marks, _ = records.at(place)
    lengths = {len(numbers), len(counts)}
    if lengths != {nodes} or len(marks) != size or counts.sum() != size or (counts < 0).any() or not marks.all():
        raise MatrixFileError(records.path, "names freedoms of other nodes than it counts: a damaged file")
    return np.column_stack([np.repeat(numbers, counts), abs(marks)]).astype(np.int64), marks < 0


def _matrix(
    records: _Records,
    name: str,
    kind: str,
    terms: int,
    place: int,
    size: int,
    labels: np.ndarray,
    constrained: np.ndarray,
) -> FileMatrix:
    rows, columns, values, count = [], [], [], 0
    for row in range(size):
        index, place = records.at(place)
        data, place = records.at(place)
        if len(index) != len(data) or index.dtype.kind != "i" or data.dtype.kind != "f":
            raise MatrixFileError(records.path, f"row {row + 1} of {name} has {len(index)} columns, {len(data)} values")
        if len(index) and (index.min() < row + 1 or index.max() > size):
            raise MatrixFileError(
                records.path, f"row {row + 1} of {name} reaches outside the upper half: a damaged file"
            )
        rows.append(np.full(len(index), row, np.int32))
        columns.append(index.astype(np.int32) - 1)
        values.append(data.astype(float))
        count += len(index)
    if count != terms:
        raise MatrixFileError(records.path, f"{name} has {count} terms, the header says {terms}: a damaged file")
    r, c, v = (np.concatenate(parts) for parts in (rows, columns, values))
    free = ~(constrained[r] | constrained[c])
    return complete(
        records.path, name, kind, Entries(r[free], c[free], v[free]), size, "half", labels=labels, digits=16
    )


def is_full(raw: bytes) -> bool:
    """Does a file begin with the standard header of Ansys: 100 whole numbers?"""
    return raw[:4] == b"\x64\x00\x00\x00" and raw[4:8] == b"\x00\x00\x00\x80"
