"""`sweep`: any analysis over a space of parameters, as one labelled dataset; and `Sweep`, what it returns."""

import functools
import json
import os
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any, Self

import numpy as np

from squealbox.arguments import named, public
from squealbox.family import DesignOrRecipe
from squealbox.parameters import DataSheet, from_plain, to_plain
from squealbox.result import Outcome, Result, ResultFileError, provenance
from squealbox.studies.analysis import StudyError, Task
from squealbox.studies.block import Block
from squealbox.studies.dataset import in_memory, write_file
from squealbox.studies.executors import Executor, executor
from squealbox.studies.fingerprint import plain, record
from squealbox.studies.layout import Coordinate, Frame, Summary, layout, summary_of
from squealbox.studies.space import Space, as_space
from squealbox.studies.store import RESULT, Store, StoreDamaged
from squealbox.studies.work import Progress, WorkInPieces

if TYPE_CHECKING:
    import xarray

PARTIAL = "partial.nc"


@dataclass(frozen=True, kw_only=True, eq=False)
class Sweep(Result):
    """An analysis over a space of parameters, as :func:`sweep` returns it.

    dataset is an `xarray.Dataset` with the parameters as coordinates (dotted names), ``outcome`` (how each point ended)
    and a variable for each answer, with units. Where a point failed, numbers are NaN, and ``failure_point`` and
    ``failure_message`` say why. It is read from its file as needed when the sweep has a folder.
    """

    dataset: Any = field(metadata={"transient": True})

    def __getitem__(self, name: str) -> "xarray.DataArray":
        """A variable or coordinate of the dataset."""
        if name not in self.dataset:
            raise KeyError(f"{name!r}: there is {', '.join(map(str, [*self.dataset.data_vars, *self.dataset.coords]))}")
        found: xarray.DataArray = self.dataset[name]
        return found

    @property
    def outcomes(self) -> Any:
        """How each point ended, an array of names over the axes of the space."""
        return np.asarray(self.dataset["outcome"].values, dtype=str)

    @property
    def failures(self) -> dict[int, str]:
        """Number of a failed point (the last axis fastest) to what it said."""
        if "failure_point" not in self.dataset:
            return {}
        points, said = self.dataset["failure_point"].values, self.dataset["failure_message"].values
        return {int(point): str(text) for point, text in zip(points, said, strict=True)}

    def to_dataset(self) -> "xarray.Dataset":
        found: xarray.Dataset = self.dataset
        return found

    def _write(self, path: str) -> None:
        self.dataset.to_netcdf(path, engine="h5netcdf", invalid_netcdf=True)

    def to_dataframe(self) -> Any:
        """One row for each point: its parameters, how it ended, and every number of every answer, as `table` has it."""
        import xarray

        return xarray.Dataset({name: ("point", values) for name, values in self.table().items()}).to_dataframe()

    @classmethod
    def from_dataset(cls, dataset: "xarray.Dataset") -> Self:
        texts = {name: json.loads(dataset.attrs[name]) for name in ("inputs", "settings", "outcome", "provenance")}
        texts["outcome"], texts["inputs"] = Outcome.from_plain(texts["outcome"]), from_plain(texts["inputs"])
        return cls(dataset=dataset.drop_encoding(), **texts)

    @classmethod
    def opened(cls, path: str | os.PathLike[str]) -> Self:
        """The sweep in a file, whose arrays are read when they are asked for."""
        import xarray

        try:
            return cls.from_dataset(xarray.open_dataset(path, engine="h5netcdf"))
        except (OSError, ValueError, KeyError, TypeError, RuntimeError) as error:
            raise ResultFileError(f"{path}: not a readable sweep: {error}") from error

    def summary(self) -> str:
        """A line on the space and how the points ended, and one for each answer with its range."""
        names, counts = np.unique(self.outcomes, return_counts=True)
        ended = ", ".join(f"{count} {name}" for name, count in zip(names, counts, strict=True))
        axes = " x ".join(f"{dim} ({self.dataset.sizes[dim]})" for dim in self.dataset["outcome"].dims)
        lines = [f"{int(np.sum(counts))} points, {axes}: {ended}"]
        lines += [_ranged(self.dataset[name]) for name in self.answers]
        return "\n".join(lines + [self.outcome.message] * (bool(self.failures) and not self.outcome.ok))

    @property
    def answers(self) -> list[str]:
        """Names of the variables the analysis gave."""
        aside = ("outcome", "failure_point", "failure_message")
        return [str(name) for name in self.dataset.data_vars if name not in aside]

    def table(self, rows: int | None = None, *, widest: int | None = None) -> dict[str, Any]:
        """Columns with a row for each point, the last axis fastest: parameters, outcome, every number of every answer.

        The keys are names with units, ``load [N]``. `rows` and `widest` leave out later points, and the later numbers
        of an answer that has many.
        """
        dims = self["outcome"].dims
        shape = self["outcome"].shape
        first = slice(0, rows)
        columns: dict[str, Any] = {}
        for name, values in self.dataset.coords.items():
            place = [values.sizes[dim] if dim in values.dims else 1 for dim in dims]
            whole = np.broadcast_to(np.asarray(values.values).reshape(place), shape)
            columns[_headed(str(name), values)] = whole.reshape(-1)[first]
        columns["outcome"] = self.outcomes.reshape(-1)[first]
        for name in self.answers:
            values = self.dataset[name]
            flat = np.asarray(values.values).reshape(int(np.prod(shape)), -1)[first, :widest]
            flat = flat[:, : self.told(values)]
            for i, column in enumerate(flat.T):
                label = name if values.ndim == len(dims) else f"{name} {i + 1}"
                columns[_headed(label, values)] = column
        return columns

    def told(self, values: "xarray.DataArray") -> int | None:
        """How many of the numbers of an answer a table tells: of modes beside their conjugates the first half."""
        if values.dims[-1:] != (MODE,) or "frequency" not in self.dataset or values.sizes[MODE] % 2:
            return None
        frequency = np.asarray(self.dataset["frequency"].values)
        half = values.sizes[MODE] // 2
        twice = frequency.shape[-1] == 2 * half
        return half if twice and np.array_equal(frequency[..., :half], frequency[..., half:], equal_nan=True) else None


MODE = "mode"  # a dimension of complex modes: n of them, then their conjugates


class Memory:
    """The blocks of a sweep that has no folder."""

    def __init__(self) -> None:
        self.done: dict[tuple[int, int], Summary] = {}
        self._blocks: list[Block] = []

    def add(self, block: Block) -> None:
        """Keep a block."""
        self._blocks.append(block)
        self.done[block.start, block.stop] = summary_of(block)

    def blocks(self) -> Iterator[Block]:
        """The blocks, in the order of their points."""
        return iter(sorted(self._blocks, key=lambda block: block.start))

    def log(self, text: str) -> None:
        """Nothing is written."""


@public(space=named, design=None)
def sweep(
    design: DesignOrRecipe,
    space: Space | Mapping[str, Any],
    analysis: Callable[..., Any],
    *,
    out: str | os.PathLike[str] | None = None,
    keep: Sequence[str] = (),
    units: Mapping[str, str] | None = None,
    seed: int = 0,
    chunk: int | None = None,
    workers: int | None = None,
    scheduler: str | None = None,
    time_limit: float | None = None,
    progress: Progress | None = None,
) -> Sweep:
    """Ask `analysis` of `design` at every point of `space`; with `out`, nothing that was finished can be lost.

    Parameters
    ----------
    design : a design; or a function of one value for each parameter, in order, that returns a design or a system
    space : a mapping of dotted names to values (a grid), or a `Space`
    analysis : a function of a design that returns a `Result`, a mapping of names to numbers, arrays or words, an array
        or a number. One marked by `squealbox.studies.batched` is given designs whose parameters are arrays. One with a
        parameter ``rng`` is given a generator that depends on `seed` and the number of the point alone
    out : folder of the study; a run that was stopped or killed goes on from there when it is called again
    keep : names out of what the analysis returns, or any attribute of its `Result`; left out, what the result offers
    units : of the names a mapping returns
    seed : of the random generators
    chunk : points in a block; left out, a block takes about a second, by measuring
    workers : number of supervised processes on this machine; left out, this process computes
    scheduler : address of a Dask scheduler, such as "tcp://head:8786", whose workers compute
    time_limit : of a block that a worker process computes [s]; left out, 30 s. A block that is late is taken apart,
        so a single point has this long before it is given up
    progress : called with a `Pace` after each block

    Returns
    -------
    Sweep. A point whose analysis raises an error has the outcome "failed" and its message; the others are untouched.
    With workers, a point that hangs is "time_limit" and one that kills its process three times is "worker_died".
    Answers do not depend on who computes them, bit for bit, for an analysis whose answer at a point depends on that
    point alone.
    Ctrl-C returns what is done, with the outcome "interrupted". Equal studies give equal files, byte for byte.

    Raises `ParameterError` for a name the design does not have, `StudyError` for what cannot be asked, and `StoreError`
    when the folder cannot be used: it holds another study or something else, is being written to, damaged, or full.

    >>> from squealbox import DrumBrake, complex_modes
    >>> table = sweep(DrumBrake(), {"friction.static": [0.3, 0.5], "load": [1e3, 2e3, 3e3]}, complex_modes)
    >>> table["largest_growth_rate"].dims, table.outcome.ok
    (('friction.static', 'load'), True)
    """
    points = as_space(space).fresh()
    kept = (keep,) if isinstance(keep, str) else tuple(keep)
    task = Task(design, analysis, kept, dict(units or {}), int(seed))
    execute = executor(workers, scheduler, time_limit)
    _check(task, points, chunk)
    run = functools.partial(_run, task, points, execute, chunk, progress)
    if out is None:
        memory = Memory()
        run(memory)
        return Sweep.from_dataset(in_memory(layout(frame_of(task, points), memory.done), memory.blocks()))
    with Store.created_or_resumed(Path(out), record(task, points)) as store:
        if store.finished:
            return Sweep.opened(store.result())
        run(store)
        return Sweep.opened(consolidated(store, frame_of(task, points)))


def open_sweep(path: str | os.PathLike[str]) -> Sweep:
    """What the folder of a study holds at this moment, also while it is being written; nothing is changed.

    Raises `StoreError` when it is no such folder or damaged. Points that are not finished are "not_run".
    """
    store = Store.opened(Path(path))
    if not store.finished:
        try:
            return Sweep.from_dataset(in_memory(layout(store.frame(), store.done), store.blocks()))
        except StoreDamaged:
            store = Store.opened(Path(path))  # it may have been finished while its blocks were read
            if not store.finished:
                raise
    return Sweep.opened(store.result())


def consolidated(store: Store, frame: Frame) -> Path:
    """The file of all blocks: the finished one when none is missing, otherwise one beside it of what there is."""
    plan = layout(frame, store.done)
    part = store.path / (PARTIAL if plan.gaps else RESULT)
    part = part.with_name(part.name + ".part")
    store.reserve(part, plan.nbytes)
    with store.explained():
        write_file(part, plan, store.blocks())
    if plan.gaps:
        os.replace(part, store.path / PARTIAL)
        return store.path / PARTIAL
    (store.path / PARTIAL).unlink(missing_ok=True)
    return store.finish(part)


def frame_of(task: Task, points: Space) -> Frame:
    """The axes with the units the design declares, and what a file says of the study."""
    about = dict(_declared(task.design))
    axes = points.coordinates()
    coordinates = {name: Coordinate(dim, v, *about.get(name, ("", ""))) for name, (dim, v) in axes.items()}
    inputs = {"design": task.design if isinstance(task.design, DataSheet) else plain(task.design)}
    study = record(task, points)
    settings = {name: study[name] for name in ("analysis", "space", "keep", "units", "seed")}
    texts = {"inputs": inputs, "settings": settings, "provenance": provenance()}
    attributes = {name: json.dumps(to_plain(value)) for name, value in texts.items()}
    return Frame(points.dims, points.shape, coordinates, {"kind": Sweep.kind_name(), **attributes})


def _run(
    task: Task, points: Space, execute: Executor, chunk: int | None, progress: Progress | None, target: Store | Memory
) -> None:
    """All that is left, round by round where the space grows; or until Ctrl-C."""
    growing = True
    while growing:
        if isinstance(target, Store):
            target.keep_frame(frame_of(task, points))
        work = WorkInPieces(task, points, target, chunk=chunk, progress=progress)
        target.log(f"begins: {work.left} of {len(points)} points to compute")
        try:
            execute(work)
        except KeyboardInterrupt:
            target.log(f"stopped by the user: {work.pace}")
            return
        target.log(f"done: {work.pace}; {work.computed:.3g} s of analysis in {work.blocks} blocks")
        growing = points.grow(target.blocks())


def _check(task: Task, points: Space, chunk: int | None) -> None:
    if not callable(task.analysis):
        raise StudyError(f"analysis = {task.analysis!r}: expected a function of a design")
    if chunk is not None and (isinstance(chunk, bool) or int(chunk) != chunk or chunk < 1):
        raise StudyError(f"chunk = {chunk!r}: expected a whole number of at least 1")
    if isinstance(task.design, DataSheet):
        for name in points.names:
            task.design.value_of(name)
    elif not callable(task.design):
        raise StudyError(f"design is a {type(task.design).__name__}: expected a design, or a function that makes one")


def _declared(design: object) -> Iterator[tuple[str, tuple[str, str]]]:
    """Dotted name to unit and meaning, aliases included."""
    if not isinstance(design, DataSheet):
        return
    for name, about, _ in design.leaves():
        yield name, (about.unit if about.unit != "-" else "1", about.meaning)
    brake = getattr(design, "innermost", design)  # of a brake within countermeasures
    for alias, names in brake.aliases.items():
        first = brake.parameters().get(names[0])
        if first is not None:
            yield alias, (first.unit if first.unit != "-" else "1", first.meaning)


def _headed(name: str, values: "xarray.DataArray") -> str:
    unit = values.attrs.get("units", "")
    return f"{name} [{unit}]" if unit not in ("", "1") else name


def _ranged(values: "xarray.DataArray") -> str:
    """A variable in a line: its name, dimensions of its own, range and unit."""
    array = np.asarray(values.values)
    unit = values.attrs.get("units", "")
    if array.dtype.kind in "OU":
        names, counts = np.unique(array.astype(str), return_counts=True)
        most = sorted(zip(counts, names, strict=True), reverse=True)[:8]
        return f"  {values.name}: " + ", ".join(f"{count} {word or 'none'}" for count, word in most)
    if array.dtype.kind == "b":
        return f"  {values.name}: true at {np.count_nonzero(array)} of {array.size}"
    size = np.abs(array) if array.dtype.kind == "c" else array
    known = size[np.isfinite(size)]
    span = f"{np.min(known):.6g} to {np.max(known):.6g}" if known.size else "nothing finite"
    return f"  {values.name}: {span}{'' if unit in ('', '1') else f' {unit}'}"
