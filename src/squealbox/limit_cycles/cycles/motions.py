"""The motions of a family of systems over one parameter, by one generated step: a system is a row of numbers.

What depends on the structure alone is made once. Where the numbers N are sums over the parameter,

    N(p) = N(low) + (p - low) N',    N' = (N(high) - N(low)) / (high - low)

as those of friction, speeds and loads are, no further system is made on the way; `confirmed` compares them with those
of the systems themselves. Else N is that of the system at p, and N' from two beside it.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

from squealbox.limit_cycles.cycles.differences import extrapolated
from squealbox.limit_cycles.cycles.variation import MotionRows
from squealbox.parameters import ParameterError
from squealbox.system import System
from squealbox.transient import (
    EXACT,
    OPEN,
    Ends,
    Flows,
    Method,
    RunApart,
    Single,
    by_step,
    difference,
    entries,
    parameter_rows,
    rows_of_all,
    tabulate,
)

TRIED = (0.0, 0.138, 0.618, 1.0)  # shares of the bounds at which numbers that are sums are met
ROUND_OFF = 1e-13  # of a number
NEAR = 1e-7  # of the span, within which numbers are sums
KEPT = 8
STEP = 1e-5  # of the span: of the slope of numbers that are no sums
INSTANT = 1e-5  # over the highest frequency: of the differences that give a rate where rows have no mass
FINE = 1e-13  # relative tolerance of the motions whose differences are taken


class Motions:
    """Motions of `moving(p)` over about `duration` [s]; `span` is a typical change of p.

    bounds : of p, within which the numbers may turn out to be sums; None does not ask
    at_once : whether `moving` makes a batch of an array of p

    Raises `RunApart` where the system has another structure than at the first p, and what `moving` raises.
    """

    def __init__(
        self, moving: Callable[[Any], System], p: float, span: float, bounds: tuple[float, float] | None,
        method: Method, duration: float, at_once: bool = False,
    ) -> None:  # fmt: skip
        self.moving, self.span, self.method, self.duration, self.at_once = moving, span, method, duration, at_once
        system = moving(p)
        n, rest = system.size, np.zeros(system.size)
        self.single = Single(system, method, rest, rest, 0.0, duration, None)
        self.shape, self.size = self.single.made.jobs.shape, n
        self.place = {name: row for row, name in enumerate(parameter_rows(self.shape))}
        self.known: list[tuple[float, Any, Any, tuple[float, ...]]] = []
        self.line = None if bounds is None else self._line(*bounds)
        tried = [moving(p)] if self.line is None or bounds is None else [moving(each) for each in _tried(*bounds)]
        self.flows = Flows(tried, Method(method.tableau, FINE, FINE / method.rtol * np.asarray(method.atol)), EXACT,
                           1e-3, duration)  # fmt: skip
        self.seen = [self.place[name] for name in self.flows.names]
        left_out = set(entries(n, self.shape.m)) - set(self.flows.names)
        self.left_out = [row for name, row in self.place.items() if name in left_out]

    def _line(self, low: float, high: float) -> tuple[Any, Any, Any, float] | None:
        """Numbers at the lower bound, their slope, their sizes and that bound, where they are sums of the parameter."""
        try:
            first, *between, last = self._of_systems(_tried(low, high))
        except (ParameterError, RunApart):
            return None
        line = first, difference(last, first) / (high - low), np.maximum(np.abs(first), np.abs(last)), low
        met = zip(_tried(low, high)[1:-1], between, strict=True)
        return line if all(_alike(_on(line, p), each, line) for p, each in met) else None

    def _of_systems(self, values: Sequence[float]) -> Any:
        """The numbers (k, rows) of the systems at values of the parameter."""
        if not self.at_once:
            return np.concatenate([self._tabulated(self.moving(p)) for p in values])
        return self._tabulated(self.moving(np.asarray(values, dtype=float)))

    def _tabulated(self, system: System) -> Any:
        rest = np.zeros((*system.shape, self.size))
        jobs = tabulate(system, self.method, EXACT, 1e-3, (rest, rest), self.duration, 0.0, (), (), False,
                        recorded=True)  # fmt: skip
        if jobs.shape != self.shape:
            raise RunApart("the system has another structure here")
        return rows_of_all(jobs)

    def numbers(self, p: float) -> tuple[Any, Any]:
        """The numbers at a parameter value, and their slope."""
        if self.line is not None:
            return _on(self.line, p), self.line[1]
        for at, found, slope, ways in self.known:
            low, high = ways[0] * NEAR * self.span, ways[2] * NEAR * self.span
            if low <= p - at <= high:  # half the curvature times 1e-14 of the span squared: round-off
                return found + (p - at) * slope, slope
        found, slope, ways = self._beside(p)
        if np.any(found[self.left_out]):
            raise RunApart("the system has another structure here")
        self.known = [(p, found, slope, ways), *self.known[: KEPT - 1]]
        return found, slope

    def _beside(self, p: float) -> tuple[Any, Any, tuple[float, ...]]:
        """Numbers and slope from systems to both sides, or to the one the range of the parameter allows: -1, 0 or 1."""
        for ways in ((-1.0, 0.0, 1.0), (0.0, 0.0, 1.0), (-1.0, 0.0, 0.0)):
            values = [p + STEP * self.span * way for way in ways]
            try:
                before, here, after = self._of_systems(values)
            except ParameterError as error:
                refused = error
            else:
                return here, difference(after, before) / (values[2] - values[0]), ways
        raise refused

    def confirmed(self, values: Sequence[float]) -> bool:
        """Whether numbers taken for sums are those of the systems at these values of the parameter."""
        line = self.line
        if line is None or not len(values):
            return True
        try:
            return all(
                _alike(_on(line, p), each, line) for p, each in zip(values, self._of_systems(values), strict=True)
            )
        except (ParameterError, RunApart):
            return False

    def run(self, x: np.ndarray, duration: float, p: float, times: np.ndarray | None = None) -> MotionRows:
        """The motion from x (2n,) at a parameter value: its steps, or at instants."""
        n, m = self.size, self.shape.m
        self.single.fixed[3:] = self.numbers(p)[0]
        self.single.restart(x[:n], x[n:], 0.0, duration, times)
        leg = by_step(self.single, duration)
        events = leg.events
        return MotionRows(*leg.parts(n), *leg.of_contacts(m), events[:, 0], events[:, 1].astype(int),
                          events[:, 2].astype(int), leg.steps[0], leg.outcome)  # fmt: skip

    def rate(self, motion: MotionRows, p: float) -> Any:
        """x' at the end of a motion, (2n,)."""
        numbers = self.numbers(p)[0]
        n, m, x = self.size, self.shape.m, np.concatenate([motion.q[-1], motion.qd[-1]])
        if self.shape.kinds:
            h = INSTANT / self._number(numbers, "highest")
            middle, late = (self._ends(numbers[None], x[None], k * h, 0).states[0] for k in (1, 2))
            return (4.0 * middle - 3.0 * x - late) / (2.0 * h)
        mk, mc = (self._matrix(numbers, name, n, n) for name in ("mk", "mc"))
        md, mw = (self._matrix(numbers, name, m, n) for name in ("md", "mw"))
        opened = np.where(motion.mode[-1] == OPEN, motion.normal_force[-1], 0.0)
        load = np.array([self._number(numbers, f"f{i}") for i in range(n)])
        a = load - mk @ x[:n] - mc @ x[n:] + motion.friction_force[-1] @ md + opened @ mw
        return np.concatenate([x[n:], a])

    def speeds(self, p: float) -> Any:
        """V of each contact [m/s]."""
        numbers = self.numbers(p)[0]
        return np.array([self._number(numbers, f"V{c}") for c in range(self.shape.m)])

    def _matrix(self, numbers: np.ndarray, name: str, rows: int, columns: int) -> Any:
        found = [self._number(numbers, f"{name}{i}_{j}") for i in range(rows) for j in range(columns)]
        return np.reshape(found, (rows, columns))

    def _number(self, numbers: np.ndarray, name: str) -> float:
        return float(numbers[self.place[name]]) if name in self.place else 0.0

    def _ends(self, numbers: np.ndarray, starts: np.ndarray, duration: float, of: float | np.ndarray) -> Ends:
        self.flows.numbers = numbers[:, self.seen]
        return self.flows.to(duration, starts, of)

    def derivative(self, x: np.ndarray, duration: float, p: float, scale: np.ndarray, size: float) -> tuple[Any, float]:
        """The derivative of the end by the start and by the parameter, (2n, 2n + 1), as `extrapolated` has it.

        scale (2n,), size : what makes velocities of a state [1/s or 1], and the largest in the motion [m/s]
        """
        numbers, slope = self.numbers(p)

        def flow(beside: np.ndarray) -> Ends:
            along = beside[:, -1:]
            return self._ends(numbers + along * slope, beside[:, :-1], duration, np.arange(len(beside)))

        return extrapolated(flow, np.append(x, 0.0), np.append(scale, size / self.span), size)


def _tried(low: float, high: float) -> list[float]:
    return [low + share * (high - low) for share in TRIED]


def _on(line: tuple[Any, Any, Any, float], p: float) -> Any:
    return line[0] + (p - line[3]) * line[1]


def _alike(value: np.ndarray, other: np.ndarray, line: tuple[Any, Any, Any, float]) -> bool:
    """Whether two rows of numbers are the same but for round-off."""
    with np.errstate(invalid="ignore"):
        return bool(np.all((value == other) | (np.abs(value - other) <= ROUND_OFF * line[2])))
