"""One motion by the generated step at width 1: rows of output, log of events and energy audit, as by the march."""

import time as clock
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.schedules import value_at
from squealbox.system import System
from squealbox.transient import packing
from squealbox.transient._motion import EXACT
from squealbox.transient.lanes.kernel import lane_kernel
from squealbox.transient.lanes.orders import Orders
from squealbox.transient.lanes.shape import Places, layout, parameter_rows
from squealbox.transient.lanes.table import Jobs, limits, tabulate
from squealbox.transient.latest import Latest
from squealbox.transient.methods import TAYLOR, Method, tableau
from squealbox.transient.tolerances import STANDING, fastest_speed

RUNNING = -1.0  # in the row of results of a run that has not ended
FIRST = 2_000  # trials between the first two looks at the keyboard
MOST = 200_000
LOOK = 0.02  # s that should pass between two
ROWS, EVENTS = 8_192, 1_024  # room for rows of output, touched only as they are written, and for events at first


@dataclass(frozen=True)
class Prepared:
    """What runs of one system by one method share."""

    jobs: Jobs
    rows: Places
    names: dict[str, int]
    record: Any
    scratch: Any
    kernel: Any
    slides: bool


KEPT, NUMBERS = Latest(), Latest()
LONG = 1e9  # s that no run takes: nothing of what runs share depends on their length


def prepared(system: System, scheme: int, name: str) -> Prepared:
    """The table of one job, the places of its rows, its record and its kernel."""
    found: Prepared = KEPT.of(system, (scheme, name), lambda: _prepared(system, scheme, name))
    return found


def _prepared(system: System, scheme: int, name: str) -> Prepared:
    jobs = _table(system, scheme, name)
    names = {row: 3 + i for i, row in enumerate(parameter_rows(jobs.shape))}
    packed = packing.pack(system, Method(name), scheme, 1e-3, False)
    record = np.zeros(1, dtype=packed.dtype)
    record[0] = packed
    rest = np.zeros(system.size)
    scratch = packing.scratch(record[0], rest, rest, 0.0, 0.0).base
    slides = bool(fastest_speed(system) > STANDING)
    return Prepared(jobs, layout(jobs.shape), names, record, scratch, lane_kernel(jobs.shape), slides)


def _table(system: System, scheme: int, name: str) -> Jobs:
    """The numbers of a run that depend on the system and the kind of step alone; each run has its own tolerances."""
    rest = np.zeros(system.size)
    return tabulate(system, Method(name, atol=1.0), scheme, 1e-3, (rest, rest), LONG, 0.0, (), (), False, recorded=True)


def numbers(
    system: System, made: Prepared, method: Method, width: float, duration: float, begin: float, start: tuple[Any, Any]
) -> Any:
    """The fixed numbers of a run: those of the system, and the tolerances, limits and times of this run."""
    fixed = made.jobs.fixed.copy()
    fixed[:3] = begin + duration, begin, method.most_steps
    for name, value in limits(system, method, made.jobs.own, made.jobs.shape.exact, duration, start).items():
        fixed[made.names[name]] = value
    fixed[made.names["width"]] = width
    return fixed


def _copy(record: Any) -> Any:
    """Of a record: byte by byte, not field by field."""
    return record.view(np.uint8).copy().view(record.dtype)


class Single:
    """One run, resumed until it ends."""

    def __init__(
        self, system: System, method: Method, q: np.ndarray, qd: np.ndarray, begin: float, duration: float,
        times: np.ndarray | None, scheme: int = EXACT, width: float = 1e-3,
    ) -> None:  # fmt: skip
        self.system, self.method = system, method
        made = self.made = prepared(system, scheme, method.tableau)
        atol = None if method.atol is None else np.asarray(method.atol, dtype=float).tobytes()
        how = scheme, method.tableau, method.rtol, atol, method.first_step, method.largest_step, method.most_steps
        begun = () if made.slides else (np.asarray(q).tobytes(), np.asarray(qd).tobytes())  # tells the tolerance then
        fixed = NUMBERS.of(
            system, (*how, width, duration, begin, *begun),
            lambda: numbers(system, made, method, width, duration, begin, (q, qd)),
        )  # fmt: skip
        self.fixed = fixed.copy()
        self.record, self.scratch = _copy(made.record), _copy(made.scratch)
        self.restart(q, qd, begin, begin + duration, times)

    def restart(self, q: np.ndarray, qd: np.ndarray, begin: float, end: float, times: np.ndarray | None) -> None:
        """Be ready for another run from a start of all rows."""
        made, n, m = self.made, self.system.size, len(self.system.contacts)
        self.fixed[:2] = end, begin
        first = made.names["start0"] if n else 0
        self.fixed[first : first + n], self.fixed[first + n : first + 2 * n] = q, qd
        self.lanes = np.zeros(len(made.rows))
        self.lanes[made.rows.places["alive"]] = -1.0
        self.times = np.zeros(0) if times is None else times
        self.rows = np.empty((ROWS if times is None else len(times), 6 + 2 * n + 5 * m))
        self.events = np.empty((EVENTS + m, 3))
        self.count = np.zeros(2, dtype=np.int64)
        self.out = np.full((1, 5 + 2 * n + 2 * m), RUNNING)
        self.live = np.zeros(1, dtype=np.int64)
        self.orders = Orders(
            made.jobs.table, made.jobs.varies, self.fixed, self.times, np.zeros((1, 1, 1)), np.zeros(1, dtype=np.int64),
            1, self.out, self.record, packing.rule(self.method.tableau).base, self.scratch, np.zeros(1, dtype=np.int64),
            FIRST, self.rows, self.events, self.count,
        )  # fmt: skip

    def at(self, name: str) -> float:
        """The number in a row of the state."""
        return float(self.lanes[self.made.rows.places[name]])

    def several(self, name: str, count: int) -> Any:
        """The numbers in so many rows of the state, name0, name1, ..."""
        first = self.made.rows.places[f"{name}0"] if count else 0
        return self.lanes[first : first + count].copy()

    @property
    def evaluations(self) -> int:
        """Of the equation in a trial."""
        return 1 if self.method.tableau == TAYLOR else tableau(self.method.tableau).stages

    @property
    def atol(self) -> Any:
        """Absolute tolerances of q and q'."""
        n = self.system.size
        first = self.made.names["atol0"] if n else 0
        return self.fixed[first : first + 2 * n]

    def speeds(self, t: float, qd: np.ndarray) -> list[float]:
        """Sliding velocities [m/s] at an instant."""
        return [float(value_at(c.V, t) - c.t @ qd) for c in self.system.contacts]

    def call(self, budget: int = FIRST) -> tuple[Any, tuple[Any, ...]]:
        """The kernel of this run, and what it is called with."""
        orders = self.orders._replace(every=budget, rows=self.rows, events=self.events)
        return self.made.kernel, (self.lanes, self.live, orders)

    def to(self, end: float, progress: Any = None) -> tuple[int | None, str]:
        """Run to the end; returns how the kernel says it ended, None and why where it was stopped."""
        budget, began = FIRST, clock.monotonic()
        try:
            while not self.advance(budget):
                self._make_room()
                now = clock.monotonic()
                if progress is not None:
                    progress(self.at("t"), end, now - began)
                budget = min(2 * budget, MOST)
        except KeyboardInterrupt:
            return None, f"stopped by the user at t = {self.at('t'):g} s"
        if progress is not None:
            progress(float(self.out[0, 1]), end, clock.monotonic() - began)
        return int(self.out[0, 0]), ""

    def advance(self, budget: int) -> bool:
        """So many steps; whether the run has ended."""
        kernel, given = self.call(budget)
        done: bool = kernel(*given)
        return done

    def _make_room(self) -> None:
        rows, events = self.count
        if not len(self.times) and rows + 3 > len(self.rows):
            self.rows = packing.longer(self.rows)
        if events + len(self.system.contacts) > len(self.events):
            self.events = packing.longer(self.events)

    def columns(self) -> tuple[Any, Any]:
        """Rows of output and of events, as far as they were written."""
        return self.rows[: self.count[0]], self.events[: self.count[1]]


class Pushed:
    """Runs of one system under loads that are given by numbers: the rows of a run are sums of those, found once.

    `under` gives the system in time that belongs to such numbers (count,), with a term for each even where it is zero.
    """

    def __init__(
        self, under: Callable[[Any], System], count: int, method: Method, duration: float, scheme: int, width: float
    ) -> None:
        some, none = 1.0 + 0.618 * np.arange(count), np.zeros(count)  # that cancel in no row
        system, self.scheme = under(some), scheme
        start = np.zeros(system.size)
        self.run = Single(system, method, start, start, 0.0, duration, None, scheme, width)
        bare = under(none)
        without, pack = self._numbers_by_name(bare), self._packed(bare)
        self.rises = np.zeros((count, len(self.run.fixed)))
        self.fields: dict[str, tuple[Any, Any]] = {}
        for i in range(count):
            pushed = under(np.eye(count)[i])
            for name, value in self._numbers_by_name(pushed).items():
                self.rises[i, self.run.made.names[name]] = difference(value, without.get(name, 0.0))
            for name, value in self._packed(pushed).items():
                if not np.array_equal(value, pack[name]):
                    rises = self.fields.setdefault(name, (pack[name], np.zeros((count, *value.shape))))[1]
                    rises[i] = difference(value, pack[name])
        self.origin = self.run.fixed - some @ self.rises

    def _packed(self, system: System) -> dict[str, Any]:
        record = packing.pack(system, self.run.method, self.scheme, 1e-3, False)
        return {name: record[name].copy() for name in record.dtype.names if record.dtype[name].base.kind == "f"}

    def _numbers_by_name(self, system: System) -> dict[str, float]:
        jobs = _table(system, self.scheme, self.run.method.tableau)
        return dict(zip(parameter_rows(jobs.shape), jobs.fixed[3:].tolist(), strict=True))

    def ready(
        self, given: np.ndarray, q: np.ndarray, qd: np.ndarray, begin: float, end: float, times: np.ndarray | None
    ) -> Single:
        """The run from a start of all rows under the load of the numbers given."""
        self.run.fixed[:] = self.origin + given @ self.rises
        for name, (value, rises) in self.fields.items():
            self.run.record[0][name] = value + np.tensordot(given, rises, 1)
        self.run.restart(q, qd, begin, end, times)
        return self.run


def difference(value: float | np.ndarray, before: float | np.ndarray) -> Any:
    """What is between two; nothing where both are the same infinity."""
    with np.errstate(invalid="ignore"):
        return np.where(value == before, 0.0, value - before)
