"""The answers at consecutive points of a study, and how they are written as bytes.

A block is a NumPy archive: no pickle, nothing in it is ever executed. Points that failed have an outcome and a message,
and hold NaN (words: nothing) in every column.
"""

import io
import json
import zipfile
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from squealbox.result import COMPLETED, Column

NOT_RUN = "not_run"
LONGEST = 500  # characters kept of a message


@dataclass(frozen=True, eq=False)
class Block:
    """Points start, ..., stop - 1: how each ended, by name (k,), what failed ones said, and columns (k, ...)."""

    start: int
    stop: int
    outcome: Any
    columns: Mapping[str, Column]
    messages: Mapping[int, str] = field(default_factory=dict)

    def __len__(self) -> int:
        return self.stop - self.start

    @property
    def failed(self) -> int:
        """Number of points that did not complete."""
        return int(np.count_nonzero(self.outcome != COMPLETED))

    @property
    def nbytes(self) -> int:
        """Size of the columns in memory."""
        return sum(column.values.nbytes for column in self.columns.values())

    def to_bytes(self) -> bytes:
        """The block as a NumPy archive."""
        if np.all(self.outcome == COMPLETED):  # sorting words is slow
            names, codes = np.array([COMPLETED]), np.zeros(len(self), dtype=np.intp)
        else:
            names, codes = np.unique(self.outcome, return_inverse=True)
        about = {
            "start": self.start,
            "stop": self.stop,
            "outcomes": [str(name) for name in names],
            "messages": {str(place): text for place, text in self.messages.items()},
            "columns": [[name, list(c.dims), c.unit, c.meaning] for name, c in self.columns.items()],
        }
        arrays = {f"column_{i}": column.values for i, column in enumerate(self.columns.values())}
        stream = io.BytesIO()
        note = np.frombuffer(json.dumps(about).encode(), dtype=np.uint8)
        np.savez(stream, about=note, outcome=codes.astype(np.uint16), **arrays)
        return stream.getvalue()

    @classmethod
    def from_bytes(cls, data: bytes) -> "Block":
        """The inverse of `to_bytes`; `ValueError` for anything else."""
        try:
            with np.load(io.BytesIO(data), allow_pickle=False) as archive:
                about = json.loads(archive["about"].tobytes())
                columns = {
                    name: Column(archive[f"column_{i}"], tuple(dims), unit, meaning)
                    for i, (name, dims, unit, meaning) in enumerate(about["columns"])
                }
                outcome = np.array(about["outcomes"] or [""])[archive["outcome"]]
                messages = {int(place): text for place, text in about["messages"].items()}
                return cls(about["start"], about["stop"], outcome, columns, messages)
        except (zipfile.BadZipFile, KeyError, IndexError, TypeError, EOFError) as error:
            raise ValueError(f"not a block of a study: {error}") from error


def failure(start: int, count: int, name: str, message: str) -> Block:
    """A block of points that all failed in the same way."""
    said = {start + i: message[:LONGEST] for i in range(count)}
    return Block(start, start + count, np.full(count, name), {}, said)


def joined(parts: Iterable[Block]) -> Block:
    """Consecutive blocks as one."""
    blocks = sorted(parts, key=lambda part: part.start)
    start, count = blocks[0].start, blocks[-1].stop - blocks[0].start
    places = [np.arange(part.start - start, part.stop - start) for part in blocks]
    columns = stacked([(where, part.columns) for where, part in zip(places, blocks, strict=True)], count)
    messages = {place: text for part in blocks for place, text in part.messages.items()}
    return Block(start, start + count, np.concatenate([part.outcome for part in blocks]), columns, messages)


def stacked(parts: Iterable[tuple[Any, Mapping[str, Column]]], count: int) -> dict[str, Column]:
    """Columns given for some of `count` rows each, as columns of all rows.

    Rows nobody gave, and entries beyond the length of a shorter row, are NaN; whole numbers and truth values become
    floats then, and words are empty.
    """
    found: dict[str, list[tuple[Any, Column]]] = {}
    for where, columns in parts:
        for name, column in columns.items():
            found.setdefault(name, []).append((where, column))
    return {name: _filled(given, count) for name, given in found.items()}


def _filled(given: list[tuple[Any, Column]], count: int) -> Column:
    first = given[0][1]
    arrays = [np.asarray(column.values) for _, column in given]
    ndim = max(array.ndim for array in arrays)
    arrays = [array.reshape(*array.shape, *(1,) * (ndim - array.ndim)) for array in arrays]
    tail = tuple(max(array.shape[i] for array in arrays) for i in range(1, ndim))
    if len(given) == 1 and len(given[0][0]) == count:
        return first._replace(values=arrays[0])
    whole = sum(len(where) for where, _ in given) == count and all(array.shape[1:] == tail for array in arrays)
    dtype = common_type([array.dtype for array in arrays], whole)
    values = np.full((count, *tail), missing(dtype), dtype=dtype)
    for (where, _), array in zip(given, arrays, strict=True):
        values[(where, *(slice(length) for length in array.shape[1:]))] = array
    longest = max((column.dims for _, column in given), key=len)
    return Column(values, longest, first.unit, first.meaning)


def common_type(types: list[Any], whole: bool) -> Any:
    """The type that holds all; one with room for NaN when something is missing."""
    kinds = {dtype.kind for dtype in types}
    if "U" in kinds:
        return max((dtype for dtype in types if dtype.kind == "U"), key=lambda dtype: dtype.itemsize)
    dtype = np.result_type(*types)
    return dtype if whole or dtype.kind in "fc" else np.result_type(dtype, np.float64)


def missing(dtype: np.dtype[Any]) -> Any:
    """What stands for no value."""
    return {"f": np.nan, "c": complex(np.nan, np.nan), "U": ""}.get(np.dtype(dtype).kind, 0)
