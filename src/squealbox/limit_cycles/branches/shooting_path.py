"""A branch by shooting, as continuation sees it: a state at a turning point and the period over the parameter.

At a largest or least displacement of one degree of freedom its velocity is zero, which fixes the phase.
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from squealbox.limit_cycles.cycles.cycle import Cycle, extremes
from squealbox.limit_cycles.cycles.differences import by_differences, change, derived
from squealbox.limit_cycles.cycles.field import Autonomous, Field
from squealbox.limit_cycles.cycles.remembering import field_of
from squealbox.limit_cycles.cycles.shooting import cycle_through
from squealbox.limit_cycles.cycles.variation import Flight, fly, quick_flight
from squealbox.parameters import ParameterError
from squealbox.result import COMPLETED, Outcome
from squealbox.system import System
from squealbox.transient import Trajectory

KEPT = 8  # equations, runs and flights kept between calls at the same values
STEP = 1e-5  # of the range of the parameter: of the differences of the equation, which is smooth in it


def _trim(kept: dict[Any, Any]) -> None:
    if len(kept) > KEPT:
        kept.pop(next(iter(kept)))


class ShootingPath:
    """Residual of shooting over (state without one velocity, period) and the parameter, from a largest displacement."""

    def __init__(self, make: Callable[[float], System], rtol: float, span: float) -> None:
        self.make, self.rtol, self.span = make, rtol, span
        self.fields: dict[float, Autonomous] = {}
        self.runs: dict[bytes, Trajectory] = {}
        self.flights: dict[bytes, Flight] = {}
        self.column, self.scale = 0, np.ones(1)

    def begin(self, x: Any, period: float, p: float, dof: int, amplitude: float) -> Any:
        """Unknowns of a start x at which the velocity of `dof` is zero."""
        field = self.field(p)
        self.column = field.size + dof
        sizes = np.append(amplitude * 2.0 * np.pi / period / field.scale, period)
        self.scale = np.delete(sizes, self.column)
        return np.append(np.delete(x, self.column), period)

    def field(self, p: float) -> Autonomous:
        """The equation at a parameter value."""
        if p not in self.fields:
            self.fields[p] = field_of(self.make(p))
            _trim(self.fields)
        return self.fields[p]

    def start(self, x: Any) -> Any:
        """State (2n,) at which a point's period begins."""
        return np.insert(x[:-1], self.column, 0.0)

    def run(self, x: Any, p: float) -> Trajectory:
        """The motion of a point over its period."""
        key = np.append(x, p).tobytes()
        if key not in self.runs:
            self.runs[key] = fly(self.field(p), self.start(x), float(x[-1]), self.rtol)
            _trim(self.runs)
        return self.runs[key]

    def fly(self, x: Any, p: float) -> tuple[Any, Flight]:
        """Start (2n,) and flight of a point."""
        key = np.append(x, p).tobytes()
        start = self.start(x)
        if key not in self.flights:
            self.flights[key] = self._derived(self.field(p), start, float(x[-1]), self.run(x, p), self.beside(p))
            _trim(self.flights)
        return start, self.flights[key]

    def _derived(self, field: Any, x: Any, period: float, motion: Trajectory, beside: tuple[Any, Any, float]) -> Flight:
        if isinstance(field, Field):
            return quick_flight(field, x, period, self.rtol, motion=motion, beside=beside)
        flown = by_differences(field, x, period, self.rtol, motion=motion)
        return replace(flown, by_p=change(x, period, self.rtol, beside))

    def sequence(self, x: Any, p: float) -> tuple[tuple[int, int], ...] | None:
        """(contact, new mode) of the events of a period, from a fixed first one on; None where there is no motion."""
        try:
            run = self.run(x, p) if x[-1] > 0.0 else None
        except ParameterError:
            run = None
        if run is None or not run.outcome.ok:
            return None
        events = [(int(c), int(m)) for c, m in zip(run.event_contact, run.event_mode, strict=True)]
        return min((tuple(events[i:] + events[:i]) for i in range(len(events))), default=())

    def residual(self, x: Any, p: float) -> Any:
        """Scaled x(T) - x(0), shape (2n,); NaN, which continuation refuses, where the parameter leaves its range."""
        nothing = np.full(len(x), np.nan)
        if not (np.all(np.isfinite(x)) and x[-1] > 0.0):
            return nothing
        try:
            run = self.run(x, p)
        except ParameterError:
            return nothing
        if not run.outcome.ok:
            return nothing
        return (np.concatenate([run.q[-1], run.qd[-1]]) - self.start(x)) * self._weight()

    def _weight(self) -> Any:
        sizes = np.insert(self.scale[:-1], self.column, np.nan)
        n = len(sizes) // 2
        sizes[self.column] = self.scale[self.column - n] * self.field_frequency
        return 1.0 / sizes

    @property
    def field_frequency(self) -> float:
        """The frequency by which a velocity is a displacement [rad/s]."""
        return next(iter(self.fields.values())).frequency

    def beside(self, p: float) -> tuple[Any, Any, float]:
        """The equation on both sides of a parameter value, or on the one side its range allows, and their distance."""
        step, ends = STEP * self.span, []
        for value in (p - step, p + step):
            try:
                ends.append((value, field_of(self.make(value))))
            except ParameterError:
                ends.append((p, self.field(p)))
        (low, first), (high, second) = ends
        return first, second, high - low

    def jacobian(self, x: Any, p: float) -> tuple[Any, Any]:
        """By the unknowns and by the parameter, saltation matrices included; the equation by p from differences."""
        _, flown = self.fly(x, p)
        size = flown.x.size
        if flown.by_p is None:  # the motion ended early
            return np.full((size, size), np.nan), np.full(size, np.nan)
        by_state = np.delete(flown.phi - np.eye(size), self.column, axis=1)
        weight = self._weight()
        return np.column_stack([by_state, flown.rate]) * weight[:, None], flown.by_p * weight

    def describe(self, x: Any, p: float) -> dict[str, Any]:
        """Period, extremes, multipliers, least sliding speed and longest sticking of the cycle at a point."""
        _, flown = self.fly(x, p)
        motion = flown.motion
        n = self.field(p).system.size
        low, high = extremes(motion.t, motion.q[:, :n], motion.qd[:, :n])
        least_slip, sticking = self.sliding(x, p)
        return {"period": float(x[-1]), "lowest": low, "highest": high,
                "multipliers": self.multipliers(x, p),
                "least_slip": least_slip, "sticking": sticking,
                "begin": np.concatenate([motion.q[0, :n], motion.qd[0, :n]])}  # fmt: skip

    def multipliers(self, x: Any, p: float) -> Any:
        """Floquet multipliers of the cycle at a point."""
        return self.field(p).multipliers(self.fly(x, p)[1].phi)

    def sliding(self, x: Any, p: float) -> tuple[float, float]:
        """Least sliding speed in the sense of V [m/s] at the instants of the motion, and longest sticking [s]."""
        motion = self.run(x, p)
        slip = motion.sliding_velocity * np.sign(self.field(p).V)
        sticking = np.sum((motion.mode[1:] == 0) * np.diff(motion.t)[:, None], axis=0)
        return float(np.min(slip, initial=np.inf)), float(np.max(sticking, initial=0.0))

    def least_slip(self, x: Any, p: float) -> float:
        """Least sliding speed in the sense of V [m/s] at the instants of the motion."""
        return self.sliding(x, p)[0]

    def cycle(self, x: Any, p: float) -> Cycle:
        """The cycle at a point, its multipliers computed anew to 1e-12; error is the scaled residual there."""
        start = self.start(x)
        field = self.field(p)
        flown = derived(field, start, float(x[-1]))
        error = float(np.max(np.abs(self.residual(x, p))))
        settings = {"contact": "exact", "width": 0.0, "shots": 1, "rtol": 1e-13}
        return cycle_through(field, start, float(x[-1]), [flown], Outcome(COMPLETED), settings, 2049, error)
