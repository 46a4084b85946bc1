"""From entries between labels to a matrix: labels in order, internal freedoms behind."""

from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.fe.readers.matrix import Entries, FileMatrix, MatrixFileError, complete


def coded(path: Path, nodes: ArrayLike, directions: ArrayLike) -> Any:
    """One whole number for each (node, direction); negative nodes, internal freedoms, sort behind all others."""
    nodes, directions = np.asarray(nodes, dtype=np.int64), np.asarray(directions, dtype=np.int64)
    if directions.size and (directions.min() < 0 or directions.max() > 99_999):
        bad = directions[(directions < 0) | (directions > 99_999)][0]
        raise MatrixFileError(path, f"the direction {bad} of a node: expected 1 to 6, or 0 for a scalar point")
    if nodes.size and abs(nodes).max() >= 2**45:
        raise MatrixFileError(path, f"the node number {nodes[abs(nodes).argmax()]}: expected at most {2**45}")
    place = np.where(nodes < 0, 2**45 - nodes, nodes)
    return place * 100_000 + directions


def decoded_labels(codes: ArrayLike) -> Any:
    """The inverse of `coded`, shape (n, 2)."""
    place, direction = np.divmod(np.asarray(codes, dtype=np.int64), 100_000)
    return np.column_stack([np.where(place > 2**45, 2**45 - place, place), direction])


def between_labels(path: Path, name: str, kind: str, entries: Entries, rule: str, **about: Any) -> FileMatrix:
    """A square matrix from entries whose rows and columns are coded labels, on the union of both."""
    codes = np.union1d(entries.rows, entries.columns)
    entries.rows = np.searchsorted(codes, entries.rows).astype(np.int32)
    entries.columns = np.searchsorted(codes, entries.columns).astype(np.int32)
    return complete(path, name, kind, entries, len(codes), rule, labels=decoded_labels(codes), **about)
