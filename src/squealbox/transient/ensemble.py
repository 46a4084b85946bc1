"""Many transients at once: eight trajectories in the lanes of each group, groups on all cores."""

import os
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from typing import TYPE_CHECKING, Any, ClassVar, Self

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import designs, public
from squealbox.cautions import of_many_runs, of_the_clock
from squealbox.family import Family, values_of
from squealbox.labelled import Labelled, Labels
from squealbox.parameters import DataSheet, ParameterError, known_names
from squealbox.result import COMPLETED, Array, Column, Outcome, Result, batched, quantity
from squealbox.system import as_system
from squealbox.transient import _march
from squealbox.transient.choosing import check_scheme, chosen_method, usual_method
from squealbox.transient.instants import instants_of
from squealbox.transient.lanes.work import HEAD, Blocks, Progress
from squealbox.transient.legs import MESSAGES, SCHEMES
from squealbox.transient.methods import Method
from squealbox.transient.observers import as_observers
from squealbox.transient.one_by_one import OneByOne
from squealbox.transient.simulating import simulate
from squealbox.transient.widened import RunApart

if TYPE_CHECKING:
    import xarray

UNBALANCED = 1 + _march.NOT_CONFIRMED  # a motion of its own whose energy audit does not close
CODES = {UNBALANCED: "energy_unbalanced", _march.COMPLETED: COMPLETED, _march.NOT_CONFIRMED: "not_confirmed"} | {
    code: name for code, (name, _) in MESSAGES.items()
}
NOT_RUN = "not_run"
THREADS = "SQUEALBOX_THREADS"  # in the environment: how many threads where nothing else is said


@dataclass(frozen=True, kw_only=True, eq=False)
class Ensemble(Result):
    """What :func:`simulate_ensemble` returns; ``...`` are the axes of the parameters.

    ended names the outcome of each trajectory ("completed", or as in `simulate`; "not_run" after an interruption).
    observed maps each observer's name to its values, (..., n), (..., contacts) or (...), with k values each where it
    returns several; parameters maps dotted names to what varied, (...). sample_q and sample_qd are (..., instants, n),
    empty when no instants were asked for. caution names contacts that left the range of their model, as at the ends of
    steps (and in the middle of Taylor's), and in how many trajectories; speeds with exact contact alone.
    """

    ended: Array = quantity("...", "", "how each trajectory ended")
    time: Array = quantity("...", "s", "instant reached")
    q: Array = quantity("... dof", "m", "displacement at that instant")
    qd: Array = quantity("... dof", "m/s", "velocity at that instant")
    steps: Array = quantity("...", "", "accepted steps")
    tried: Array = quantity("...", "", "tried steps")
    events: Array = quantity("...", "", "events: reversals, stick, slip, lift-off and landing")
    sample_time: Array = quantity("instant", "s", "instants of the samples")
    sample_q: Array = quantity("... instant dof", "m", "displacement at the samples")
    sample_qd: Array = quantity("... instant dof", "m/s", "velocity at the samples")
    parameters: Mapping[str, Any] = field(default_factory=dict, metadata={"transient": True})
    observed: Mapping[str, Any] = field(default_factory=dict, metadata={"transient": True})
    seconds: float = 0.0
    caution: str = ""

    coordinates: ClassVar = {"instant": "sample_time"}

    def __getitem__(self, name: str) -> Array:
        """The values of an observer."""
        if name not in self.observed:
            raise KeyError(f"{name!r} was not observed: there is {', '.join(self.observed) or 'nothing'}")
        return self.observed[name]

    @property
    def shape(self) -> tuple[int, ...]:
        """Axes of the parameters."""
        return tuple(np.shape(self.ended))

    @property
    def outcomes(self) -> Any:
        return self.ended

    def columns(self) -> dict[str, Column]:
        """What a study keeps: what was observed, how far the motion went, and the samples where there are any."""
        declared = super().columns()
        samples = ("sample_q", "sample_qd") if np.size(self.sample_time) else ()
        kept = {name: declared[name] for name in ("time", "steps", "events", *samples)}
        for name, values in self.observed.items():
            of, unit = self.settings["observed"][name]
            first = () if of == "system" else (of,)
            more = np.ndim(values) - len(self.shape) - len(first)
            kept[name] = Column(values, (*first, *(f"{name}_{i}" for i in range(more))), unit, f"observed {name}")
        return kept

    @property
    def rate(self) -> float:
        """Trajectories per second, compilation and parameters included."""
        return float(np.sum(self.ended != NOT_RUN)) / self.seconds if self.seconds > 0.0 else np.nan

    def labelled(self) -> Labelled:
        """As `Result.labelled`, with ``parameter_<name>`` and ``observed_<name>`` for what varied and was seen."""
        whole = super().labelled()
        axes, design = tuple(f"axis_{i}" for i in range(len(self.shape))), self.inputs.get("system")
        found = {}
        for name, values in self.parameters.items():
            unit = design.unit_of(name) if isinstance(design, DataSheet) else ""
            about = {"units": unit, "long_name": f"value of {name}"}
            found[f"parameter_{name}"] = Labels(axes, np.broadcast_to(values, self.shape), about)
        for name, values in self.observed.items():
            of, unit = self.settings["observed"][name]
            first = (of,) if of in whole.sizes else ()
            more = np.ndim(values) - len(axes) - len(first)
            about = {"units": unit, "long_name": f"observed {name}"}
            found[f"observed_{name}"] = Labels((*axes, *first, *(f"{name}_{i}" for i in range(more))), values, about)
        return self._along(whole.with_(found))

    def _along(self, whole: Labelled) -> Labelled:
        """An axis along which one parameter alone varies bears its name and its values."""
        varied: dict[str, list[str]] = {f"axis_{i}": [] for i in range(len(self.shape))}
        for name, values in self.parameters.items():
            array = np.broadcast_to(values, self.shape)
            for i, axis in enumerate(varied):
                if self.shape[i] > 1 and np.any(array != np.take(array, [0], axis=i)):
                    varied[axis].append(name)
        for axis, names in varied.items():
            if len(names) == 1 and sum(names[0] in others for others in varied.values()) == 1:
                values = np.moveaxis(np.broadcast_to(self.parameters[names[0]], self.shape), int(axis[5:]), 0)
                labels = values.reshape(len(values), -1)[:, 0]
                whole = whole.renamed({axis: names[0]}).with_({}, {names[0]: Labels((names[0],), labels, {})})
        return whole

    @classmethod
    def from_dataset(cls, dataset: "xarray.Dataset") -> Self:
        """The inverse of `to_dataset`."""
        ensemble = super().from_dataset(dataset)
        kept: dict[str, dict[str, Any]] = {"parameter_": {}, "observed_": {}}
        for variable in dataset.data_vars:
            for prefix, found in kept.items():
                if str(variable).startswith(prefix):
                    found[str(variable).removeprefix(prefix)] = dataset[variable].values
        ended = np.asarray(ensemble.ended, dtype=str)
        return replace(ensemble, parameters=kept["parameter_"], observed=kept["observed_"], ended=ended)


@batched
@public(design_or_system=designs)
def simulate_ensemble(
    design_or_system: Any,
    parameters: Mapping[str, Any] | None = None,
    duration: float = 0.05,
    method: str | Method | None = None,
    observe: Any = ("amplitude",),
    *,
    grid: bool = False,
    contact: str = "exact",
    start: Any = None,
    times: Any = None,
    rtol: float | None = None,
    atol: ArrayLike | None = None,
    width: float = 1e-3,
    start_time: float = 0.0,
    threads: int | None = None,
    progress: Progress | None = None,
) -> Ensemble:
    """Integrate the same brake at many parameters, each trajectory with its own steps and events.

    Parameters
    ----------
    design_or_system : a design whose `parameters` vary; a `System` with leading axes; or a sequence of designs or
        systems of the same structure
    parameters : dotted names, such as "friction.static", with arrays that are broadcast together; with ``grid=True``
        each array is an axis of its own
    duration : [s]
    method : as in `simulate`, with the same tolerances: "taylor", "bogacki-shampine", "dormand-prince", "tsitouras",
        "dormand-prince-8" or a `Method`; None takes "taylor" wherever the equation has a series
    observe : names out of `OBSERVERS`, or an `Observer` of your own; no trajectory is stored
    contact : "exact", "raw", "smooth" = "arctan", or "tanh", as in `simulate`
    start : as in `simulate`, the same for all; or (q, qd) whose arrays end with n and broadcast with the parameters;
        without parameters their leading axes are those of the ensemble
    times : instants at which q and qd are sampled [s], or a whole number of equal ones; they do not influence the steps
    rtol, atol, width, start_time : as in `simulate`; [-], [m/s], [m/s] and [s]
    threads : how many; None takes one for each core
    progress : called with (trajectories done, in all, seconds) about five times a second; what it raises ends the
        computation and reaches the caller

    Returns
    -------
    Ensemble. A trajectory that cannot go on says so in its own `ended`; the others are untouched. Ctrl-C returns what
    is done. The result of a trajectory does not depend, bit for bit, on the others, on its place or on `threads`. One
    in a thousand is run again with half the largest step and a tenth of the tolerances, and is "not_confirmed" where
    events or end state then differ, as of a motion that depends on its start too strongly.

    Memory: about 8 (parameters that vary + 2 n + observers' memory + 5) bytes for each trajectory, and as much for the
    tables of 65,536 at a time.

    Raises `ParameterError` or `InvalidSystem` for input that does not make sense.

    >>> from squealbox import DrumBrake
    >>> found = simulate_ensemble(DrumBrake(), {"friction.static": [0.1, 0.3]}, duration=1e-3)
    >>> found["amplitude"].shape
    (2, 2)
    """
    if contact not in SCHEMES:
        raise ParameterError("simulate_ensemble", "contact", contact, known_names(str(contact), list(SCHEMES)))
    instants = np.zeros(0)
    if times is not None:
        instants = instants_of("simulate_ensemble", times, start_time, duration, one=True)
    names, arrays, shape = _space(design_or_system, parameters, grid, start)
    named = method or _usual(design_or_system, names, arrays, contact, int(np.prod(shape, dtype=int)))
    chosen = chosen_method(named, rtol, atol)
    check_scheme("simulate_ensemble", chosen, contact)
    work = (
        chosen, SCHEMES[contact], width, start, duration, start_time, as_observers(observe), instants,
        _threads(threads), progress,
    )  # fmt: skip
    job, together = Blocks(*work), True
    try:
        job.run(design_or_system, names, arrays, shape)
    except RunApart:
        together = False
    if not together:
        job = OneByOne(*work)
        job.simulate = partial(simulate, contact=contact)
        job.usual = lambda system: chosen if method else chosen_method(usual_method(system, contact), rtol, atol)
        job.codes = {name: code for code, name in CODES.items()}
        job.run(design_or_system, names, arrays, shape)
    settings = {
        "duration": duration, "start_time": start_time, "contact": contact, "width": width, "grid": grid,
        "tableau": job.method.tableau, "rtol": job.method.rtol, "observe": [each.name for each in job.observers],
        "one_by_one": not together, "observed": {each.name: [each.of, each.unit] for each in job.observers},
    }  # fmt: skip
    several = isinstance(design_or_system, (list, tuple))
    inputs = {"systems": list(design_or_system)} if several else {"system": design_or_system}
    return _result(job, dict(zip(names, arrays, strict=True)), shape, inputs, settings)


def _result(
    work: Blocks, parameters: dict[str, Any], shape: tuple[int, ...], inputs: dict[str, Any], settings: dict[str, Any]
) -> Ensemble:
    """The blocks as one result."""
    assert work.system is not None
    n, m = work.system.size, len(work.system.contacts)
    total = int(np.prod(shape, dtype=int))
    rows = np.concatenate(work.rows)
    if len(rows) < total:
        rest = np.full((total - len(rows), rows.shape[1]), np.nan)
        rest[:, 0] = -1.0
        rows = np.concatenate([rows, rest])
    names = np.array([CODES.get(code, NOT_RUN) for code in range(-1, max(CODES) + 1)])
    ended = names[rows[:, 0].astype(int) + 1]
    at, observed = HEAD + 2 * n, {}
    for each in work.observers:
        watch = each.watch()
        copies, width = watch.copies(n, m), watch.width
        memory = rows[:, at : at + copies * width].reshape(total, copies, width)[..., : len(watch.start)]
        values = each.value(memory)
        values = values[:, 0] if each.of == "system" else values
        observed[each.name] = values.reshape(*shape, *values.shape[1:])
        at += copies * width
    late = of_the_clock(settings["start_time"], settings["duration"])
    samples = np.concatenate(work.samples) if work.times.size else np.zeros((total, 0, 2 * n))
    if len(samples) < total:
        samples = np.concatenate([samples, np.full((total - len(samples), *samples.shape[1:]), np.nan)])
    samples = samples.reshape(*shape, work.times.size, 2 * n)
    return Ensemble(
        inputs=inputs,
        settings=settings,
        outcome=_outcome(ended, work.interrupted),
        ended=ended.reshape(shape),
        time=rows[:, 1].reshape(shape),
        q=rows[:, HEAD : HEAD + n].reshape(*shape, n),
        qd=rows[:, HEAD + n : HEAD + 2 * n].reshape(*shape, n),
        steps=_counts(rows[:, 2]).reshape(shape),
        tried=_counts(rows[:, 3]).reshape(shape),
        events=_counts(rows[:, 4]).reshape(shape),
        sample_time=work.times,
        sample_q=samples[..., :n],
        sample_qd=samples[..., n:],
        parameters=parameters,
        observed=observed,
        caution="; ".join([*of_many_runs(work.system, *np.split(rows[:, at:], 3, axis=1)), *late]),
        seconds=work.elapsed(),
    )


def _counts(column: np.ndarray) -> Any:
    return np.nan_to_num(column).astype(np.int64)


def _usual(design: Any, names: tuple[str, ...], arrays: list[Any], contact: str, count: int) -> str:
    """The method of runs that name none, as `simulate` would take it."""
    first = design[0] if isinstance(design, (list, tuple)) and design else design
    if names:
        first = design.replace({name: float(np.ravel(array)[0]) for name, array in zip(names, arrays, strict=True)})
    return usual_method(as_system(first), contact, count)


def _outcome(ended: np.ndarray, interrupted: bool) -> Outcome:
    names, counts = np.unique(ended, return_counts=True)
    found = {str(name): int(count) for name, count in zip(names, counts, strict=True)}
    said = ", ".join(f"{count} {name}" for name, count in found.items())
    if interrupted:
        return Outcome("interrupted", f"stopped by the user: {said}", ended=found)
    if set(found) <= {COMPLETED}:
        return Outcome(COMPLETED)
    return Outcome("some_failed", f"{said}: each says so in `ended`", ended=found)


def _threads(threads: int | None) -> int:
    if threads is None and os.environ.get(THREADS, "").isdigit():
        return max(1, int(os.environ[THREADS]))  # set for processes that share a machine
    if threads is None:
        return len(os.sched_getaffinity(0)) if hasattr(os, "sched_getaffinity") else os.cpu_count() or 1
    return int(threads)


def _space(
    design: Any, parameters: Mapping[str, Any] | None, grid: bool, start: Any
) -> tuple[tuple[str, ...], list[Any], Any]:
    """Names, arrays and the common shape of the parameters, or of the starts where nothing else has a shape."""
    if not parameters:
        if isinstance(design, (list, tuple)):
            return (), [], (len(design),)
        return (), [], as_system(design).shape or _shape_of_starts(start)
    if isinstance(design, (list, tuple)):
        raise ParameterError(
            "simulate_ensemble", "parameters", list(parameters), "one design or system: of several each is run as it is"
        )
    Family(design, parameters)  # says what it does not have
    arrays = [values_of("simulate_ensemble", *each, axes=True) for each in parameters.items()]
    if grid:
        arrays = list(np.meshgrid(*arrays, indexing="ij"))
    try:
        shape = np.broadcast_shapes(*(array.shape for array in arrays))
    except ValueError as error:
        shapes = {name: np.shape(value) for name, value in parameters.items()}
        raise ParameterError(
            "simulate_ensemble", "parameters", shapes, "shapes that broadcast, or grid=True for the outer product"
        ) from error
    return tuple(parameters), arrays, shape


def _shape_of_starts(start: Any) -> tuple[int, ...]:
    """Leading axes of (q, qd); none for words, and for what `Blocks` will refuse."""
    if start is None or isinstance(start, str):
        return ()
    try:
        return np.broadcast_shapes(*(np.shape(part)[:-1] for part in start))
    except (TypeError, ValueError):
        return ()
