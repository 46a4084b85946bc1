"""How a study asks its analysis: point by point, or whole blocks of one that is batched.

An analysis is any function of a design. It may return a `Result`, a mapping of names to numbers, arrays or words, an
array, or one number. A batched analysis (`squealbox.result.batched`) is given a design whose parameters are arrays
(k,) and returns the same with a leading axis k. What goes wrong at a point is the outcome of that point alone: a batch
that fails is halved until the point to blame is found.
"""

import functools
import inspect
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.family import is_recipe, varied
from squealbox.parameters import known_names
from squealbox.result import COMPLETED, Column, Result
from squealbox.studies.block import LONGEST, Block, stacked

VALUE = "value"  # the name of an answer that has none
FAILED = "failed"  # the outcome of a point whose analysis raised an error
Answer = tuple[Any, str, Mapping[str, Column]]  # outcome names (k,), what failed ones say, columns (k, ...)
Tick = Callable[[int, int], None]


class StudyError(ValueError):
    """A study that cannot be run as it was asked for; the message is one sentence."""


@dataclass(frozen=True, eq=False)
class Task:
    """What is asked at every point.

    design : a design, or a function of one value for each parameter that returns a design or a system
    analysis : a function of it; one with a parameter `rng` is given a random generator of its own for each point
    keep : names kept of the answers; empty keeps what the result offers. A name may be any attribute of a `Result`
    units : of what a mapping or number returns
    seed : of the random generators
    """

    design: Any
    analysis: Callable[..., Any]
    keep: tuple[str, ...] = ()
    units: Mapping[str, str] = field(default_factory=dict)
    seed: int = 0

    @property
    def batched(self) -> bool:
        """True when whole blocks can be asked for at once."""
        return bool(getattr(plain_function(self.analysis), "batched", False)) and not is_recipe(self.design)

    @property
    def wants_rng(self) -> bool:
        """True when the analysis draws random numbers."""
        return "rng" in inspect.signature(self.analysis).parameters

    def design_at(self, values: Mapping[str, Any]) -> Any:
        """The design with these values of its parameters."""
        return varied(self.design, values)


def plain_function(analysis: object) -> Any:
    """The function behind `functools.partial`."""
    while isinstance(analysis, functools.partial):
        analysis = analysis.func
    return analysis


def evaluate(task: Task, start: int, points: Mapping[str, Any], tick: Tick | None = None) -> Block:
    """The answers at the points start, start + 1, ... whose values `points` holds, arrays (k,) by dotted name.

    An error becomes the outcome of a point, unless it is a `StudyError`. `tick` is told the first and the last point of
    what is asked next.
    """
    count = len(next(iter(points.values())))
    asked = _groups(points) if task.batched else iter(np.arange(count)[:, None])
    ask = functools.partial(_batch, task) if task.batched else functools.partial(_single, task, start)
    parts: list[tuple[Any, Mapping[str, Column]]] = []
    outcome, messages = np.full(count, COMPLETED, dtype=object), {}
    todo = list(asked)
    while todo:
        where = todo.pop(0)
        if tick is not None:
            tick(start + int(where[0]), start + int(where[-1]))
        try:
            names, said, columns = ask({name: values[where] for name, values in points.items()}, where)
        except StudyError:
            raise
        except Exception as error:
            if len(where) > 1:
                half = len(where) // 2
                todo[:0] = [where[:half], where[half:]]
                continue
            outcome[where] = FAILED
            messages[start + int(where[0])] = f"{type(error).__name__}: {error}"[:LONGEST]
            continue
        outcome[where] = names
        parts.append((where, columns))
        if said:
            unlucky = where[np.broadcast_to(names, len(where)) != COMPLETED]
            messages |= {start + int(place): said[:LONGEST] for place in unlucky}
    names = np.full(count, COMPLETED) if np.all(outcome == COMPLETED) else outcome.astype(str)  # conversion is slow
    return Block(start, start + count, names, stacked(parts, count), messages)


def _groups(points: Mapping[str, Any]) -> Iterator[Any]:
    """Indices of the points that agree in every parameter that is a word, which no array parameter can hold."""
    words = [values for values in points.values() if values.dtype.kind == "U"]
    count = len(next(iter(points.values())))
    if not words:
        yield np.arange(count)
        return
    table = np.stack(words, axis=-1)
    _, first, group = np.unique(table, axis=0, return_index=True, return_inverse=True)
    for code in np.argsort(first):
        yield np.flatnonzero(group.reshape(-1) == code)


def _batch(task: Task, values: Mapping[str, Any], where: np.ndarray) -> Answer:
    numbers = {name: str(v[0]) if v.dtype.kind == "U" else np.ascontiguousarray(v) for name, v in values.items()}
    answer = task.analysis(task.design_at(numbers))
    names, said, columns = _read(task, answer, batch=len(where))
    for name, column in columns.items():
        if np.shape(column.values)[:1] != (len(where),):
            raise ValueError(f"{name} has shape {np.shape(column.values)}: expected ({len(where)}, ...), a batch")
    return np.broadcast_to(names, len(where)), said, columns


def _single(task: Task, start: int, values: Mapping[str, Any], where: np.ndarray) -> Answer:
    single = {name: str(v[0]) if v.dtype.kind == "U" else float(v[0]) for name, v in values.items()}
    more = {}
    if task.wants_rng:
        more["rng"] = np.random.default_rng(np.random.SeedSequence(task.seed, spawn_key=(start + int(where[0]),)))
    name, said, columns = _read(task, task.analysis(task.design_at(single), **more), batch=None)
    return name, said, {key: column._replace(values=np.asarray(column.values)[None]) for key, column in columns.items()}


def _read(task: Task, answer: Any, batch: int | None) -> tuple[Any, str, dict[str, Column]]:
    """How it ended, what it said of that, and its columns."""
    if isinstance(answer, Result):
        if answer.outcome == "interrupted":
            raise KeyboardInterrupt
        return answer.outcomes, answer.outcome.message, _kept(task, answer)
    named = dict(answer) if isinstance(answer, Mapping) else {VALUE: answer}
    outcome = named.pop("outcome", COMPLETED)
    missing = [name for name in task.keep if name not in named]
    if missing:
        raise StudyError(f"keep = {missing[0]!r}: expected {known_names(missing[0], list(named))}")
    kept = {name: named[name] for name in task.keep or named}
    return outcome, "", {name: _column(task, name, value, batch) for name, value in kept.items()}


def _kept(task: Task, answer: Result) -> dict[str, Column]:
    offered = {name: column._replace(values=np.asarray(column.values)) for name, column in answer.columns().items()}
    if not task.keep:
        return offered
    kept = {}
    for name in task.keep:
        if name not in offered and not hasattr(answer, name):
            known = known_names(name, list(offered))
            raise StudyError(f"keep = {name!r}: expected {known}, or another attribute of {type(answer).__name__}")
        kept[name] = offered.get(name) or _column(task, name, getattr(answer, name), np.ndim(answer.outcomes) or None)
    return kept


def _column(task: Task, name: str, value: ArrayLike, batch: int | None) -> Column:
    array = np.asarray(value)
    if array.dtype.kind not in "biufcU":
        kind = type(value).__name__
        raise StudyError(f"the analysis returns a {kind} for {name}: expected numbers, truth values or words")
    own = array.ndim - (0 if batch is None else 1)
    return Column(array, tuple(f"{name}_{i}" for i in range(own)), task.units.get(name, ""), "")
