"""The dataset of a sweep, in memory or as a file written block by block, so that memory holds one block at a time."""

import json
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.parameters import to_plain
from squealbox.result import COMPLETED, Outcome
from squealbox.studies.block import NOT_RUN, Block, missing
from squealbox.studies.layout import FAILURE, OUTCOME, Layout, Variable, filled, slabs

if TYPE_CHECKING:
    import h5netcdf
    import xarray

SAYS = {"long_name": "how the computation at the point ended"}
PLACE = {"long_name": "number of a failed point, the last dimension fastest"}
SAID = {"long_name": "what the failed point said"}


def outcome_of(plan: Layout, interrupted: bool = False) -> Outcome:
    """How the sweep as a whole ended."""
    counts = ", ".join(f"{count} {name}" for name, count in plan.outcomes.items())
    if interrupted or plan.gaps:
        return Outcome("interrupted", f"stopped before the end: {counts}", ended=dict(plan.outcomes))
    if set(plan.outcomes) <= {COMPLETED}:
        return Outcome()
    first = next(iter(plan.messages.values()), "")
    name = "some_failed" if COMPLETED in plan.outcomes else "all_failed"
    return Outcome(name, f"{counts}; the first said: {first}" if first else counts, ended=dict(plan.outcomes))


def in_memory(plan: Layout, blocks: Iterable[Block]) -> "xarray.Dataset":
    """The blocks as a labelled dataset."""
    import xarray

    frame = plan.frame
    arrays = {
        name: np.full((frame.total, *v.tail), missing(v.dtype), dtype=v.dtype) for name, v in plan.variables.items()
    }
    ended = np.full(frame.total, NOT_RUN, dtype=_words(plan))
    for block in _within(plan, blocks):
        ended[block.start : block.stop] = block.outcome
        for name, array in arrays.items():
            array[block.start : block.stop] = filled(plan, name, block)
    variables: dict[str, Any] = {OUTCOME: (frame.dims, ended.reshape(frame.shape), SAYS)}
    for name, array in arrays.items():
        about = plan.variables[name]
        variables[plan.names[name]] = (about.dims, array.reshape(*frame.shape, *about.tail), about.attributes)
    for name, (values, attributes) in _failures(plan).items():
        variables[name] = ((FAILURE,), values, attributes)
    coordinates = {name: ((c.dim,), c.values, _about(c.unit, c.meaning)) for name, c in plan.frame.coordinates.items()}
    return xarray.Dataset(variables, coords=coordinates, attrs=attributes_of(plan))


def write_file(path: Path, plan: Layout, blocks: Iterable[Block]) -> None:
    """The blocks as a NetCDF file that xarray reads as the dataset of `in_memory`; equal blocks give equal bytes."""
    import h5netcdf

    frame = plan.frame
    with h5netcdf.File(path, "w", invalid_netcdf=True) as file:
        sizes = dict(zip(frame.dims, frame.shape, strict=True))
        for variable in plan.variables.values():
            sizes |= dict(zip(variable.dims[len(frame.dims) :], variable.tail, strict=True))
        file.dimensions = {**sizes, **({FAILURE: len(plan.messages)} if plan.messages else {})}
        for name, about in frame.coordinates.items():
            _put(file, name, (about.dim,), about.values, _about(about.unit, about.meaning))
        for name, (values, attributes) in _failures(plan).items():
            _put(file, name, (FAILURE,), values, attributes)
        width = max(len(name) for name in [NOT_RUN, *plan.outcomes])
        ended = _created(file, OUTCOME, Variable(frame.dims, (), np.dtype(f"U{width}"), SAYS), 1)
        targets = {
            name: _created(file, plan.names[name], about, _widest(about)) for name, about in plan.variables.items()
        }
        for block in _within(plan, blocks):
            words = _bytes(block.outcome)
            for index, part, shape in slabs(block.start, block.stop, frame.shape):
                ended[index] = words[part].reshape(shape)
                for name, target in targets.items():
                    values = filled(plan, name, block)[part]
                    target[index] = _stored(values.reshape(*shape, *values.shape[1:]))
        for start, stop in plan.gaps:
            _leave_open(plan, targets, ended, start, stop)
        aside = [name for name, about in frame.coordinates.items() if (name,) != (about.dim,)]
        more = {"coordinates": " ".join(aside)} if aside else {}
        for name, value in {**attributes_of(plan), **more}.items():
            file.attrs[name] = value


def _within(plan: Layout, blocks: Iterable[Block]) -> Iterator[Block]:
    """The blocks of the points there are; those of a later round may be there already when a refinement goes on."""
    return (block for block in blocks if block.stop <= plan.frame.total)


def attributes_of(plan: Layout) -> dict[str, str]:
    """The attributes of the dataset as every result writes them."""
    outcome = json.dumps(to_plain(outcome_of(plan).to_plain()))
    return {**plan.frame.attributes, "outcome": outcome}


def _leave_open(plan: Layout, targets: dict[str, Any], ended: Any, start: int, stop: int) -> None:
    """Mark what was not computed."""
    for index, _, shape in slabs(start, stop, plan.frame.shape):
        ended[index] = np.full(shape, NOT_RUN.encode())
        for name, target in targets.items():
            about = plan.variables[name]
            target[index] = _stored(np.full((*shape, *about.tail), missing(about.dtype), dtype=about.dtype))


def _failures(plan: Layout) -> dict[str, tuple[Any, dict[str, str]]]:
    if not plan.messages:
        return {}
    return {
        f"{FAILURE}_point": (np.array(list(plan.messages), dtype=np.int64), PLACE),
        f"{FAILURE}_message": (np.array(list(plan.messages.values())), SAID),
    }


def _created(file: "h5netcdf.File", name: str, about: Variable, width: int) -> Any:
    kind = about.dtype.kind
    dtype = {"U": np.dtype(f"S{max(1, about.dtype.itemsize // 4 * width)}"), "b": np.dtype("i1")}.get(kind, about.dtype)
    variable = file.create_variable(name, about.dims, dtype=dtype)
    marks = {"U": {"_Encoding": "utf-8"}, "b": {"dtype": "bool"}}.get(kind, {})
    for key, text in {**about.attributes, **marks}.items():
        variable.attrs[key] = text
    return variable


def _put(file: "h5netcdf.File", name: str, dims: tuple[str, ...], values: Any, attributes: dict[str, str]) -> None:
    encoded = _stored(values)
    if values.dtype.kind == "U":
        values = np.char.decode(encoded, "latin-1")  # as wide as its bytes
    _created(file, name, Variable(dims, (), values.dtype, attributes), 1)[...] = encoded


def _stored(values: Any) -> Any:
    kind = values.dtype.kind
    return _bytes(values) if kind == "U" else values.astype("i1") if kind == "b" else values


def _bytes(words: Any) -> Any:
    """Words as UTF-8; all the same or plain ASCII, the usual cases, on the quick road."""
    if words.size and np.all(words == words.flat[0]):
        return np.full(words.shape, str(words.flat[0]).encode())
    try:
        return words.astype("S")
    except UnicodeEncodeError:
        return np.char.encode(words, "utf-8")


def _widest(about: Variable) -> int:
    """Bytes a character may take in UTF-8."""
    return 4 if about.dtype.kind == "U" else 1


def _words(plan: Layout) -> Any:
    return np.dtype(f"U{max(len(name) for name in [NOT_RUN, *plan.outcomes])}")


def _about(unit: str, meaning: str) -> dict[str, str]:
    return {key: text for key, text in {"units": unit, "long_name": meaning}.items() if text}
