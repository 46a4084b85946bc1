"""The dataset of a sweep, in memory or as a file written block by block, so that memory holds one block at a time."""

import json
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.labelled import about, created, in_bytes, put, put_attributes, stored
from squealbox.parameters import to_plain
from squealbox.result import COMPLETED, Outcome
from squealbox.studies.block import NOT_RUN, Block, missing
from squealbox.studies.layout import FAILURE, OUTCOME, Layout, Variable, filled, slabs

if TYPE_CHECKING:
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
        v = plan.variables[name]
        variables[plan.names[name]] = (v.dims, array.reshape(*frame.shape, *v.tail), v.attributes)
    for name, (values, attributes) in _failures(plan).items():
        variables[name] = ((FAILURE,), values, attributes)
    coordinates = {name: ((c.dim,), c.values, about(c.unit, c.meaning)) for name, c in plan.frame.coordinates.items()}
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
        for name, c in frame.coordinates.items():
            put(file, name, (c.dim,), c.values, about(c.unit, c.meaning))
        for name, (values, attributes) in _failures(plan).items():
            put(file, name, (FAILURE,), values, attributes)
        width = max(len(name) for name in [NOT_RUN, *plan.outcomes])
        ended = created(file, OUTCOME, frame.dims, np.dtype(f"U{width}"), SAYS)
        targets = {
            name: created(file, plan.names[name], v.dims, v.dtype, v.attributes, _widest(v))
            for name, v in plan.variables.items()
        }
        for block in _within(plan, blocks):
            words = in_bytes(block.outcome)
            for index, part, shape in slabs(block.start, block.stop, frame.shape):
                ended[index] = words[part].reshape(shape)
                for name, target in targets.items():
                    values = filled(plan, name, block)[part]
                    target[index] = stored(values.reshape(*shape, *values.shape[1:]))
        for start, stop in plan.gaps:
            _leave_open(plan, targets, ended, start, stop)
        put_attributes(file, {name: (c.dim,) for name, c in frame.coordinates.items()}, attributes_of(plan))


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
            v = plan.variables[name]
            target[index] = stored(np.full((*shape, *v.tail), missing(v.dtype), dtype=v.dtype))


def _failures(plan: Layout) -> dict[str, tuple[Any, dict[str, str]]]:
    if not plan.messages:
        return {}
    return {
        f"{FAILURE}_point": (np.array(list(plan.messages), dtype=np.int64), PLACE),
        f"{FAILURE}_message": (np.array(list(plan.messages.values())), SAID),
    }


def _widest(variable: Variable) -> int:
    """Bytes a character may take in UTF-8."""
    return 4 if variable.dtype.kind == "U" else 1


def _words(plan: Layout) -> Any:
    return np.dtype(f"U{max(len(name) for name in [NOT_RUN, *plan.outcomes])}")
