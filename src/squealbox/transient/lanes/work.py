"""The blocks of an ensemble: tables in, one kernel on all threads, rows of results out."""

import threading
import time
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from squealbox.cautions import least_coefficient
from squealbox.start import Start
from squealbox.system import System, as_system
from squealbox.transient import packing
from squealbox.transient._march import COMPLETED, NOT_CONFIRMED
from squealbox.transient.choosing import pays
from squealbox.transient.lanes.batch import stacked
from squealbox.transient.lanes.orders import Orders
from squealbox.transient.lanes.shape import layout, parameter_rows
from squealbox.transient.lanes.table import Jobs, tabulate
from squealbox.transient.limited import in_time
from squealbox.transient.methods import Method
from squealbox.transient.observers import Observer
from squealbox.transient.widened import RunApart, base_of, start_of

BLOCK = 65_536  # trajectories whose parameters lie in memory together
GROUPS = 2  # groups of lanes that a thread advances in turn: one hides the latency of the other
EVERY = 2_000  # trials of each group between two looks at the stop flag, some milliseconds
ONE_IN = 1_000  # trajectories is run once more, looked at more closely
SHARE = 1e-3  # of the end state by which the two may differ
HEAD = 5  # numbers of a row of results before its state: how it ended, time, accepted, tried, events
Progress = Callable[[int, int, float], None]


class Blocks:
    """The blocks of one ensemble, their threads and what they leave."""

    def __init__(
        self, method: Method, scheme: int, width: float, start: Any, duration: float, begin: float,
        observers: tuple[Observer, ...], times: np.ndarray, threads: int, progress: Progress | None,
    ) -> None:  # fmt: skip
        self.method, self.scheme, self.width, self.start = method, scheme, width, start
        self.duration, self.begin, self.observers, self.times = duration, begin, observers, times
        self.threads, self.progress = threads, progress
        self.rows: list[Any] = []
        self.samples: list[Any] = []
        self.system: System | None = None
        self.interrupted = False
        self.began = time.monotonic()

    def elapsed(self) -> float:
        """Seconds since the beginning."""
        return time.monotonic() - self.began

    def run(self, design: Any, names: tuple[str, ...], arrays: list[Any], shape: tuple[int, ...]) -> None:
        """Work through all blocks, or until Ctrl-C."""
        total = int(np.prod(shape, dtype=int))
        flat = [np.broadcast_to(array, shape).ravel() for array in arrays]
        size = BLOCK if names else max(total, 1)
        for first in range(0, total, size):
            part = slice(first, min(first + size, total))
            several = isinstance(design, (list, tuple))
            made = None if several else as_system(
                design.replace(dict(zip(names, (a[part] for a in flat), strict=True))) if names else design
            )  # fmt: skip
            self._block(stacked(design) if made is None else in_time(made), made, shape, part, total)
            if self.interrupted:
                break

    def _block(self, system: System, made: Any, shape: tuple[int, ...], part: slice, total: int) -> None:
        count = part.stop - part.start
        self.system = self.system or base_of(system)
        if not pays(system, self.method.tableau, total):
            raise RunApart("a kernel of so many freedoms and contacts takes longer to compile than they run apart")
        members, base = (shape, part), base_of(system)
        begin = Start.of("simulate_ensemble", self.start, base, self.begin, modes_of=made, members=members)
        start = start_of(system, begin, self.begin)
        watches = tuple(each.watch() for each in self.observers)
        begins = [self.begin + (1.0 - each.last) * self.duration for each in self.observers]
        coefficients = [x for each, t in zip(self.observers, begins, strict=True) for x in (t, *each.settings)]
        jobs = tabulate(
            system, self.method, self.scheme, self.width, start, self.duration, self.begin, watches,
            tuple(coefficients), self.times.size > 0,
        )  # fmt: skip
        if len(jobs.table) < count:
            jobs = replace(jobs, table=np.broadcast_to(jobs.table, (count, jobs.table.shape[1])).copy())
        seen = base_of(system).size
        memory = sum(w.copies(seen, len(system.contacts)) * w.width for w in watches)
        m = len(system.contacts)
        width = HEAD + 2 * system.size + memory + 2 * m
        out = np.full((count, width), np.nan)
        out[:, 0] = -1.0
        samples = np.full((count, max(self.times.size, 1), 2 * system.size) if self.times.size else (1, 1, 1), np.nan)
        n = system.size
        shown = [*range(HEAD + seen), *range(HEAD + n, HEAD + n + seen), *range(HEAD + 2 * n, width)]
        least = np.full((count, m), np.nan)
        try:
            self._compute(jobs, out, samples, count, part.start, total)
            least = self._least(system, out[:, width - m :])
        finally:
            whole = n == seen
            self.rows.append(np.hstack([out if whole else out[:, shown], least]))
            keep = [*range(seen), *range(n, n + seen)]
            self.samples.append(samples if whole or not self.times.size else samples[:, :, keep])

    @staticmethod
    def _least(system: System, fastest: np.ndarray) -> Any:
        """The least coefficient (runs, contacts) that each run can have met."""
        batch = system.shape or fastest.shape[:1]
        found = [
            least_coefficient(c, v.reshape(batch)).ravel() for c, v in zip(system.contacts, fastest.T, strict=True)
        ]
        return np.reshape(found, fastest.shape[::-1]).T

    def _compute(self, jobs: Jobs, out: np.ndarray, samples: np.ndarray, count: int, before: int, total: int) -> None:
        from squealbox.transient.lanes.kernel import lane_kernel

        kernel = lane_kernel(jobs.shape)
        record = packing.pack(jobs.template, self.method, self.scheme, self.width, False)
        rule = packing.rule(self.method.tableau)
        counter, stop = np.zeros(1, dtype=np.int64), np.zeros(1, dtype=np.int64)
        rows = layout(jobs.shape)
        lanes = jobs.shape.lanes
        size = len(rows) * lanes
        workers = max(1, min(self.threads, -(-count // lanes)))
        failures: list[BaseException] = []

        def run(jobs: Jobs, samples: np.ndarray, counter: np.ndarray, count: int, out: np.ndarray) -> None:
            groups, live = on_a_line(GROUPS * size), np.zeros(GROUPS, dtype=np.int64)
            groups[rows.places["alive"] * lanes] = -1.0
            n = jobs.shape.n
            scratch = packing.scratch(record, np.zeros(n), np.zeros(n), self.begin, 0.0)
            orders = Orders(
                jobs.table, jobs.varies, jobs.fixed, self.times, samples, counter, count, out,
                record.copy(), rule, scratch, stop, EVERY,
            )  # fmt: skip
            kernel(groups, live, orders)

        def work() -> None:
            try:
                run(jobs, samples, counter, count, out)
            except BaseException as error:  # handed to the caller below
                failures.append(error)

        threads = [threading.Thread(target=work, daemon=True) for _ in range(workers)]
        self._watch(threads, counter, stop, before, total)
        if failures:
            raise failures[0]
        chosen = np.arange((ONE_IN // 2 - before) % ONE_IN, count, ONE_IN)
        if len(chosen) and not self.interrupted:
            again = np.full((len(chosen), out.shape[1]), np.nan)
            closer = looked_at_closely(jobs, chosen)
            run(closer, samples[:1].repeat(len(chosen), 0), np.zeros(1, dtype=np.int64), len(chosen), again)
            out[chosen, 0] = confirmed(closer, out[chosen], again)

    def _watch(
        self, threads: list[threading.Thread], counter: np.ndarray, stop: np.ndarray, before: int, total: int
    ) -> None:
        for thread in threads:
            thread.start()
        try:
            for thread in threads:
                while thread.is_alive():
                    thread.join(0.2)
                    if self.progress is not None:
                        self.progress(min(before + int(counter[0]), total), total, self.elapsed())
        except BaseException as error:  # Ctrl-C, or what `progress` raised
            stop[0] = 1
            for thread in threads:
                thread.join()
            if not isinstance(error, KeyboardInterrupt):
                raise
            self.interrupted = True


def looked_at_closely(jobs: Jobs, chosen: np.ndarray) -> Jobs:
    """Some of the jobs, with half the largest step, so half the interval of the search, and a tenth of tolerances."""
    table, fixed = jobs.table[chosen].copy(), jobs.fixed.copy()
    for row, name in enumerate(parameter_rows(jobs.shape)):
        closer = 0.5 if name in ("largest", "first") else 0.1 if name == "rtol" or name.startswith("atol") else 1.0
        if jobs.varies[row] >= 0:
            table[:, jobs.varies[row]] *= closer
        else:
            fixed[3 + row] *= closer
    return replace(jobs, table=table, fixed=fixed)


def confirmed(jobs: Jobs, first: np.ndarray, again: np.ndarray) -> Any:
    """How runs ended: as before, or NOT_CONFIRMED where one that completed differs from its closer repetition.

    Different are events that number more than one apart, as one may lie at the very end, and an end state off by more
    than a thousandth: of a motion that depends so strongly on its start the engine knows no end state.
    """
    n = jobs.shape.n
    q, other = first[:, HEAD : HEAD + n], again[:, HEAD : HEAD + n]
    row = parameter_rows(jobs.shape).index("atol0") if n else 0
    least = jobs.table[:, jobs.varies[row]] if jobs.varies[row] >= 0 else jobs.fixed[3 + row]
    size = np.max(np.abs(np.concatenate([q, other], axis=1)), axis=1, initial=0.0)
    off = np.max(np.abs(q - other), axis=1, initial=0.0) > SHARE * size + 1e6 * least
    differs = off | (np.abs(first[:, 4] - again[:, 4]) > 1.0) | (again[:, 0] != COMPLETED)
    return np.where((first[:, 0] == COMPLETED) & differs, NOT_CONFIRMED, first[:, 0])


def on_a_line(count: int) -> Any:
    """Zeros that begin with a line of the cache, as the packed loads and stores of `vectors` expect."""
    room = np.zeros(count + 8)
    return room[-room.ctypes.data // 8 % 8 :][:count]
