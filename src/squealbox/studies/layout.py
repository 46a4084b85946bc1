"""From blocks to one labelled dataset: which variables there are, how large, and where each block goes in them."""

import io
import json
import zipfile
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, NamedTuple

import numpy as np

from squealbox.result import COMPLETED
from squealbox.studies.block import NOT_RUN, Block, common_type, missing

OUTCOME, FAILURE = "outcome", "failure"
MOST = 1000  # failed points whose messages are kept
HEADER = 8192  # bytes HDF5 needs at most to describe a variable
Attributes = dict[str, Any]


class ColumnShape(NamedTuple):
    """What a block says of one of its columns."""

    dtype: Any
    tail: tuple[int, ...]
    dims: tuple[str, ...]
    unit: str
    meaning: str


class Summary(NamedTuple):
    """What is kept in memory of a block that is in the store."""

    columns: Mapping[str, ColumnShape]
    outcomes: Mapping[str, int]
    messages: Mapping[int, str]

    @property
    def failed(self) -> int:
        """Points that did not complete."""
        return sum(count for name, count in self.outcomes.items() if name != COMPLETED)


class Coordinate(NamedTuple):
    """The values of a parameter along a dimension."""

    dim: str
    values: Any
    unit: str
    meaning: str


@dataclass(frozen=True)
class Frame:
    """The axes of a study, and the attributes of its dataset."""

    dims: tuple[str, ...]
    shape: tuple[int, ...]
    coordinates: Mapping[str, Coordinate]
    attributes: Attributes = field(default_factory=dict)

    @property
    def total(self) -> int:
        """Number of points."""
        return int(np.prod(self.shape, dtype=np.int64))


class Variable(NamedTuple):
    """One variable of the dataset; its first dimensions are those of the frame."""

    dims: tuple[str, ...]
    tail: tuple[int, ...]
    dtype: Any
    attributes: Attributes


@dataclass(frozen=True)
class Layout:
    """The variables of a dataset by the names of their columns, how points ended, and what failed ones said."""

    frame: Frame
    variables: Mapping[str, Variable]
    names: Mapping[str, str]
    outcomes: Mapping[str, int]
    messages: Mapping[int, str]
    gaps: tuple[tuple[int, int], ...]

    @property
    def nbytes(self) -> int:
        """Size of the variables and coordinates as a file holds them, and what HDF5 needs to describe them."""
        widths = [(v.dtype.itemsize // (4 if v.dtype.kind == "U" else 1), v.tail) for v in self.variables.values()]
        outcome = max(len(name) for name in [NOT_RUN, *self.outcomes])
        per_point = outcome + sum(width * int(np.prod(tail, dtype=np.int64)) for width, tail in widths)
        axes = sum(c.values.nbytes for c in self.frame.coordinates.values())
        texts = sum(map(len, self.messages.values())) + sum(len(str(a)) for a in self.frame.attributes.values())
        return self.frame.total * per_point + axes + texts + HEADER * (8 + len(self.variables))


def summary_of(block: Block) -> Summary:
    """What is kept of a block."""
    columns = {
        name: ColumnShape(c.values.dtype, c.values.shape[1:], c.dims, c.unit, c.meaning)
        for name, c in block.columns.items()
    }
    if np.all(block.outcome == COMPLETED):
        counted = {COMPLETED: len(block)}
    else:
        names, counts = np.unique(block.outcome, return_counts=True)
        counted = {str(name): int(count) for name, count in zip(names, counts, strict=True)}
    return Summary(columns, counted, dict(sorted(block.messages.items())[:MOST]))


def layout(frame: Frame, done: Mapping[tuple[int, int], Summary]) -> Layout:
    """The variables that hold every block of `done`."""
    done = {place: summary for place, summary in done.items() if place[1] <= frame.total}
    shapes: dict[str, list[ColumnShape]] = {}
    for place in sorted(done):
        for name, shape in done[place].columns.items():
            shapes.setdefault(name, []).append(shape)
    empty = open_ranges(done, frame.total)
    sizes = _sizes(shapes)
    taken = {*frame.dims, *frame.coordinates, OUTCOME, f"{FAILURE}_point", f"{FAILURE}_message"}
    variables, names = {}, {}
    for name, found in shapes.items():
        whole = not empty and len(found) == len(done)
        variables[name] = _variable(frame, found, sizes, whole)
        names[name] = _free(name, taken)
        taken.add(names[name])
    outcomes: dict[str, int] = {}
    for summary in done.values():
        for name, count in summary.outcomes.items():
            outcomes[name] = outcomes.get(name, 0) + count
    if empty:
        outcomes[NOT_RUN] = sum(stop - start for start, stop in empty)
    said = {place: text for key in sorted(done) for place, text in done[key].messages.items()}
    first = dict(sorted(said.items())[:MOST])
    return Layout(frame, variables, names, dict(sorted(outcomes.items())), first, tuple(empty))


def frame_bytes(frame: Frame) -> bytes:
    """A frame as a NumPy archive without pickle."""
    coordinates = [[name, c.dim, c.unit, c.meaning] for name, c in frame.coordinates.items()]
    about = [list(frame.dims), list(frame.shape), coordinates, frame.attributes]
    stream = io.BytesIO()
    arrays = {f"values_{i}": c.values for i, c in enumerate(frame.coordinates.values())}
    np.savez(stream, about=np.frombuffer(json.dumps(about).encode(), dtype=np.uint8), **arrays)
    return stream.getvalue()


def frame_from(data: bytes) -> Frame:
    """The inverse of `frame_bytes`; `ValueError` for anything else."""
    try:
        with np.load(io.BytesIO(data), allow_pickle=False) as archive:
            dims, shape, coordinates, attributes = json.loads(archive["about"].tobytes())
            found = {
                name: Coordinate(dim, archive[f"values_{i}"], unit, meaning)
                for i, (name, dim, unit, meaning) in enumerate(coordinates)
            }
            return Frame(tuple(dims), tuple(shape), found, attributes)
    except (zipfile.BadZipFile, KeyError, TypeError, EOFError) as error:
        raise ValueError(f"not the axes of a study: {error}") from error


def open_ranges(done: Iterable[tuple[int, int]], total: int) -> list[tuple[int, int]]:
    """The ranges of points that no block holds."""
    found, at = [], 0
    for start, stop in sorted(done):
        if at < start:
            found.append((at, min(start, total)))
        at = max(at, stop)
    return [*found, (at, total)] if at < total else found


def slabs(start: int, stop: int, shape: tuple[int, ...]) -> Iterator[tuple[tuple[Any, ...], slice, tuple[int, ...]]]:
    """Where the points start, ..., stop - 1 lie in an array of this shape: (index, which of them, their shape)."""
    inner, at = int(np.prod(shape[1:], dtype=np.int64)), start
    while at < stop:
        row, offset = divmod(at, inner)
        if offset == 0 and stop - at >= inner:
            rows = (stop - at) // inner
            where = (slice(row, row + rows), *(slice(None),) * (len(shape) - 1))
            yield where, slice(at - start, at - start + rows * inner), (rows, *shape[1:])
            at += rows * inner
        else:
            end = min(stop, (row + 1) * inner)
            for index, part, lengths in slabs(offset, end - row * inner, shape[1:]):
                yield (row, *index), slice(part.start + at - start, part.stop + at - start), lengths
            at = end


def filled(plan: Layout, name: str, block: Block) -> Any:
    """The values of a column of a block in the type and size of its variable, (k, ...)."""
    variable = plan.variables[name]
    if name not in block.columns:
        return np.full((len(block), *variable.tail), missing(variable.dtype), dtype=variable.dtype)
    values = block.columns[name].values
    if values.shape[1:] == variable.tail:
        return values.astype(variable.dtype, copy=False)
    whole = np.full((len(block), *variable.tail), missing(variable.dtype), dtype=variable.dtype)
    values = values.reshape(*values.shape, *(1,) * (whole.ndim - values.ndim))
    whole[tuple(slice(length) for length in values.shape)] = values
    return whole


def _sizes(shapes: Mapping[str, list[ColumnShape]]) -> dict[str, int]:
    sizes: dict[str, int] = {}
    for found in shapes.values():
        for shape in found:
            for dim, length in zip(shape.dims, shape.tail, strict=True):
                sizes[dim] = max(sizes.get(dim, 0), length)
    return sizes


def _variable(frame: Frame, found: list[ColumnShape], sizes: Mapping[str, int], whole: bool) -> Variable:
    dims = max((shape.dims for shape in found), key=len)
    tail = tuple(sizes[dim] for dim in dims)
    dtype = common_type([shape.dtype for shape in found], whole and all(shape.tail == tail for shape in found))
    own = tuple(_free(dim, set(frame.dims)) for dim in dims)
    about = {"units": found[0].unit, "long_name": found[0].meaning}
    return Variable((*frame.dims, *own), tail, dtype, {key: text for key, text in about.items() if text})


def _free(name: str, taken: set[str]) -> str:
    name = name.replace("/", "_")
    while name in taken:
        name += "_"
    return name
