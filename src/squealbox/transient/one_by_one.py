"""Ensembles whose members no kernel carries together: each is a run of `simulate`, looked at by the same observers.

Such are loops that are sampled or late, limits that vary, rigid contacts, designs of one size but of other structure,
and brakes with more freedoms and contacts than a kernel's text can spell out (60 coordinates with 100 contacts).
Observers see rows of a run at most `STEP` of its fastest swing apart, its events among them, with q'' of the cubic
through q and q' of both ends.
"""

from collections.abc import Callable, Iterator, Sequence
from types import SimpleNamespace
from typing import Any

import numpy as np

from squealbox.cautions import least_coefficient
from squealbox.loops import highest_rate
from squealbox.members import member
from squealbox.parameters import ParameterError
from squealbox.system import System, as_system
from squealbox.transient.lanes.work import Blocks
from squealbox.transient.methods import Method
from squealbox.transient.observers import Observer
from squealbox.transient.trajectory import Trajectory
from squealbox.transient.widened import RunApart

STEP = 1.0 / 32.0  # rad; an extreme is then off by less than 1e-8 of the swing
LEAST = 32  # parts of a run
TOGETHER = 64  # runs that observers look at side by side
Run = Callable[..., Trajectory]


class OneByOne(Blocks):
    """Members one after another, and the rows of results they leave, as `Blocks` makes them.

    `simulate` is the function of that name with the contact scheme of the ensemble, `usual` the method a system takes,
    `codes` how a run may end.
    """

    simulate: Run
    usual: Callable[[System], Method]
    codes: dict[str, int]
    waiting: list[tuple[list[Any], Trajectory, list[Any]]]  # head of a row, its motion, and what follows the observers

    def run(self, design: Any, names: tuple[str, ...], arrays: list[Any], shape: tuple[int, ...]) -> None:
        """All members in order, or until Ctrl-C."""
        total, self.waiting = int(np.prod(shape, dtype=int)), []
        flat = [np.broadcast_to(array, shape).ravel() for array in arrays]
        try:
            for i in range(total):
                values = {name: float(array[i]) for name, array in zip(names, flat, strict=True)}
                self._keep(self._member(design, values, i), self._start(shape, i))
                if len(self.waiting) == TOGETHER:
                    self._look()
                if self.progress is not None:
                    self.progress(i + 1, total, self.elapsed())
        except KeyboardInterrupt:
            if not self.rows and not self.waiting:
                raise
            self.interrupted = True
        self._look()

    @staticmethod
    def _member(design: Any, values: dict[str, float], i: int) -> System:
        if values:
            return as_system(design.replace(values))
        return as_system(design[i]) if isinstance(design, (list, tuple)) else member(as_system(design), i)

    def _start(self, shape: tuple[int, ...], i: int) -> Any:
        """The start of one member: as given, or its own of arrays with leading axes."""
        if not isinstance(self.start, (tuple, list)):
            return self.start
        try:
            parts = [np.asarray(part, dtype=float) for part in self.start]
            return tuple(np.broadcast_to(x, (*shape, x.shape[-1])).reshape(-1, x.shape[-1])[i] for x in parts)
        except (TypeError, ValueError, IndexError) as error:
            expected = '"rest", "sliding" or (q, qd) of shape (..., n)'
            raise ParameterError("simulate_ensemble", "start", self.start, expected) from error

    def _keep(self, system: System, start: Any) -> None:
        """One run: what it leaves, for observers to look at, and its samples."""
        swing = highest_rate(system)
        chosen = self.usual(system)
        given = {"start_time": self.begin, "width": self.width}
        count = max(int(np.ceil(self.duration * swing / STEP)), LEAST)
        instants = self.begin + self.duration * np.arange(count + 1) / count
        motion = self.simulate(system, self.duration, start, instants, chosen, **given)
        if len(motion.event_time):
            instants = np.union1d(instants, motion.event_time)
            motion = self.simulate(system, self.duration, start, instants, chosen, **given)
        if motion.outcome == "interrupted":
            raise KeyboardInterrupt
        known: System = motion.inputs["system"]
        if self.system is None:
            self.system = known
        elif self.system.names != known.names or len(self.system.contacts) != len(known.contacts):
            raise RunApart("members have other degrees of freedom or contacts: run them apart")
        counts = motion.steps, motion.steps + motion.rejected, len(motion.event_time)
        head = [self.codes[str(motion.outcome)], motion.t[-1], *counts]
        m = len(known.contacts)
        lowest, fastest = np.min(motion.normal_force, axis=0), np.max(np.abs(motion.sliding_velocity), axis=0)
        least = [least_coefficient(c, np.array([v]))[0] for c, v in zip(known.contacts, fastest[:m], strict=True)]
        self.waiting.append(([*head, *motion.q[-1], *motion.qd[-1]], motion, [*lowest[:m], *fastest[:m], *least]))
        if self.times.size:
            asked = self.simulate(system, self.duration, start, self.times, chosen, **given)
            whole = np.full((1, self.times.size, 2 * known.size), np.nan)
            whole[0, : len(asked.t)] = np.hstack([asked.q, asked.qd])
            self.samples.append(whole)

    def _look(self) -> None:
        """Rows of results of the runs that wait for it."""
        if not self.waiting:
            return
        heads, motions, tails = zip(*self.waiting, strict=True)
        seen = [self._seen(each, motions) for each in self.observers]
        self.rows.append(np.hstack([np.array(heads, dtype=float), *seen, np.array(tails, dtype=float)]))
        self.waiting = []

    def _seen(self, observer: Observer, motions: Sequence[Trajectory]) -> Any:
        """Memory and coefficients of an observer at the end of some runs, for each of its copies: (runs, numbers)."""
        n, m = motions[0].q.shape[1], motions[0].mode.shape[1]
        watch, runs = observer.watch(), len(motions)
        copies = watch.copies(n, m)
        p = (self.begin + (1.0 - observer.last) * self.duration, *observer.settings)
        size = (runs,) if observer.of == "system" else (runs, copies)
        memory: Any = tuple(np.full(size, x) for x in watch.start)
        for goes_on, before, after in _steps(motions, observer.of):
            new = observer.update(memory, p, before, after)
            memory = tuple(np.where(goes_on, x, old) for x, old in zip(new, memory, strict=True))
        table = np.empty((runs, copies, watch.width))
        for k, value in enumerate((*memory, *p)):
            table[..., k] = value[:, None] if np.ndim(value) == 1 else value
        return table.reshape(runs, -1)


def _steps(motions: Sequence[Trajectory], of: str) -> Iterator[tuple[Any, Any, Any]]:
    """Which runs have a next step, and both ends of it as an observer of that kind sees them, all runs at once."""
    names = ("t", "q", "qd", "sliding_velocity", "normal_force", "mode", "work_friction")
    longest = max(len(motion.t) for motion in motions)
    rows = {name: np.stack([_prolonged(getattr(each, name), longest) for each in motions], axis=1) for name in names}
    for i in range(longest - 1):
        h = (rows["t"][i + 1] - rows["t"][i])[:, None]
        goes_on, h = h > 0.0, np.where(h > 0.0, h, 1.0)
        rise, (v, u) = (rows["q"][i + 1] - rows["q"][i]) / h, rows["qd"][i : i + 2]
        ends = []
        for j, bent in ((i, (6.0 * rise - 4.0 * v - 2.0 * u) / h), (i + 1, (4.0 * u + 2.0 * v - 6.0 * rise) / h)):
            t, seen = rows["t"][j][:, None], {"q": rows["q"][j], "qd": rows["qd"][j], "qdd": bent}
            if of == "system":
                t, seen = t[:, 0], {name: tuple(values.T) for name, values in seen.items()}
            elif of == "contact":
                seen = {"velocity": rows["sliding_velocity"][j], "normal": rows["normal_force"][j]}
                seen |= {"mode": rows["mode"][i + 1], "work": rows["work_friction"][j]}
            ends.append(SimpleNamespace(t=t, **seen))
        yield goes_on[:, 0] if of == "system" else goes_on, *ends


def _prolonged(array: np.ndarray, count: int) -> Any:
    """The rows, and the last of them as often again as are missing."""
    return np.concatenate([array, np.repeat(array[-1:], count - len(array), axis=0)])
