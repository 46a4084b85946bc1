"""A branch by shooting, as continuation sees it: a state at a turning point and the period over the parameter.

At a largest or least displacement of one degree of freedom its velocity is zero, which fixes the phase.
"""

import copy
from collections.abc import Callable, Sequence
from dataclasses import replace
from typing import Any

import numpy as np

from squealbox.limit_cycles.cycles.cycle import Cycle, refined
from squealbox.limit_cycles.cycles.differences import by_differences, change, derived, size_of
from squealbox.limit_cycles.cycles.field import Autonomous, Field
from squealbox.limit_cycles.cycles.motions import Motions
from squealbox.limit_cycles.cycles.remembering import field_of
from squealbox.limit_cycles.cycles.shooting import cycle_through
from squealbox.limit_cycles.cycles.variation import Flight, MotionRows, Moved, fly, method_of, quick_flight
from squealbox.parameters import ParameterError
from squealbox.result import COMPLETED, Outcome
from squealbox.system import System
from squealbox.transient import TAYLOR, RunApart, is_small, system_of, usual_method

KEPT = 8  # equations, runs and flights kept between calls at the same values
STEP = 1e-5  # of the range of the parameter: of the differences of the equation, which is smooth in it
CLOSE = 1e-8  # error of a multiplier up to which differences of motions serve; beside a grazing they do not
LOOKS = 64  # in a period, for the least sliding speed


class ShootingPath:
    """Residual of shooting over (state without one velocity, period) and the parameter: a `CyclePath`.

    bounds : of the parameter, within which the numbers of the systems may turn out to be sums of it
    at_once : whether `make` makes a batch of an array of values
    """

    has_corners = True

    def __init__(
        self, make: Callable[[Any], System], rtol: float, span: float, bounds: tuple[float, float] | None = None,
        at_once: bool = False,
    ) -> None:  # fmt: skip
        self.make, self.rtol, self.span, self.bounds, self.at_once = make, rtol, span, bounds, at_once
        self.motions: Motions | None = None
        self.kept: dict[str, dict[Any, Any]] = {}
        self.column, self.scale, self.weight = 0, np.ones(1), np.ones(1)

    def begin(self, x: np.ndarray, period: float, p: float, dof: int, amplitude: float) -> Any:
        """Unknowns of a start x at which the velocity of `dof` is zero."""
        field = self.first = self.field(p)
        self.column = field.size + dof
        sizes = np.append(amplitude * 2.0 * np.pi / period / field.scale, period)
        self.scale = np.delete(sizes, self.column)
        swings = sizes[:-1].copy()
        swings[self.column] = swings[dof] * field.frequency
        self.weight = 1.0 / swings
        if self.motions is None and usual_method(field.held_fast, "exact") == TAYLOR and is_small(field.held_fast):
            method = replace(method_of(field, x, self.rtol), tableau=TAYLOR)
            self.motions = Motions(
                self._moving, p, self.span, self.bounds, method, period, self._alone and self.at_once
            )
        return np.append(np.delete(x, self.column), period)

    @property
    def _alone(self) -> bool:
        """Whether the system itself is what moves."""
        return isinstance(self.first, Field) and self.first.held_fast is self.first.system

    def _moving(self, p: Any) -> System:
        """What moves at a parameter value, or at several."""
        return system_of(self.make(p)) if self._alone else self.field(p).held_fast

    def again(self, make: Callable[[float], System] | None = None) -> "ShootingPath":
        """The path anew, to begin elsewhere on the same cycles, or over the parameter of a family beside this one."""
        other = copy.copy(self)
        other.kept, other.make = {}, make or self.make
        if make is not None and self.motions is not None:
            other.motions = copy.copy(self.motions)
            other.motions.line, other.motions.known, other.motions.moving = None, [], other._moving
        return other

    def _once(self, what: str, key: float | bytes, made: Callable[[], Any]) -> Any:
        """What was made for a key, made at the first time."""
        kept = self.kept.setdefault(what, {})
        if key not in kept:
            kept[key] = made()
            if len(kept) > KEPT:
                kept.pop(next(iter(kept)))
        return kept[key]

    def field(self, p: float) -> Autonomous:
        """The equation at a parameter value."""
        found: Autonomous = self._once("field", p, lambda: field_of(self.make(p)))
        return found

    def start(self, x: np.ndarray) -> Any:
        """State (2n,) at which a point's period begins."""
        return np.concatenate([x[: self.column], [0.0], x[self.column : -1]])

    def run(self, x: np.ndarray, p: float) -> Moved:
        """The motion of a point over its period."""
        found: Moved = self._once("run", np.append(x, p).tobytes(), lambda: self._motion(x, p))
        return found

    def _motion(self, x: np.ndarray, p: float, times: np.ndarray | None = None) -> Moved:
        """By the step that is ready for the family; by `simulate` where that cannot serve."""
        if self.motions is not None:
            try:
                run = self.motions.run(self.start(x), float(x[-1]), p, times)
            except RunApart:
                return fly(self.field(p), self.start(x), float(x[-1]), self.rtol, times)
            if run.outcome != "step_underflow":
                return run
        return fly(self.field(p), self.start(x), float(x[-1]), self.rtol, times)

    def fly(self, x: np.ndarray, p: float) -> tuple[Any, Flight]:
        """Start (2n,) and flight of a point."""
        return self.start(x), self._once("flight", np.append(x, p).tobytes(), lambda: self._derived(x, p))

    def _derived(self, x: np.ndarray, p: float) -> Flight:
        start, period, motion = self.start(x), float(x[-1]), self.run(x, p)
        found = self._by_differences(start, period, p, motion)
        if found is not None and (not isinstance(self.first, Field) or found.mismatch < CLOSE):
            return found
        field, beside = self.field(p), self.beside(p)
        if isinstance(field, Field):
            return quick_flight(field, start, period, self.rtol, motion=motion, beside=beside)
        flown = by_differences(field, start, period, self.rtol, motion=motion)
        return replace(flown, by_p=change(start, period, self.rtol, beside))

    def _by_differences(self, start: np.ndarray, period: float, p: float, motion: Moved) -> Flight | None:
        """From many motions of the step that is ready; None where it cannot serve."""
        if self.motions is None or not isinstance(motion, MotionRows) or not motion.outcome.ok:
            return None
        size, n = size_of(self.first, np.hstack([motion.q, motion.qd])), start.size
        try:
            phi, mismatch = self.motions.derivative(start, period, p, self.first.scale, size)
        except RunApart:
            return None
        scale, rate = self.first.scale, self.motions.rate(motion, p)
        grown = float(np.max(np.abs(phi[:, :n] * scale[:, None] / scale)))
        return Flight(
            np.concatenate([motion.q[-1], motion.qd[-1]]),
            rate,
            phi[:, :n],
            motion,
            mismatch * max(grown, 1.0),
            by_p=phi[:, n],
        )

    def confirmed(self, values: Sequence[float]) -> bool:
        """Whether the systems at these values are what was followed; where not, each is made from now on."""
        if self.motions is None or self.motions.confirmed(values):
            return True
        self.motions.line = None
        self.kept.clear()
        return False

    def sequence(self, x: np.ndarray, p: float) -> tuple[tuple[int, int], ...] | None:
        """(contact, new mode) of the events of a period, from a fixed first one on; None where there is no motion."""
        try:
            run = self.run(x, p) if x[-1] > 0.0 else None
        except ParameterError:
            run = None
        if run is None or not run.outcome.ok:
            return None
        events = [(int(c), int(m)) for c, m in zip(run.event_contact, run.event_mode, strict=True)]
        return min((tuple(events[i:] + events[:i]) for i in range(len(events))), default=())

    def residual(self, x: np.ndarray, p: float) -> Any:
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
        return (np.concatenate([run.q[-1], run.qd[-1]]) - self.start(x)) * self.weight

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

    def jacobian(self, x: np.ndarray, p: float) -> tuple[Any, Any]:
        """By the unknowns and by the parameter, saltation matrices included; the equation by p from differences."""
        _, flown = self.fly(x, p)
        size = flown.x.size
        if flown.by_p is None:  # the motion ended early
            return np.full((size, size), np.nan), np.full(size, np.nan)
        by_state = (flown.phi - np.eye(size))[:, np.arange(size) != self.column]
        return np.column_stack([by_state, flown.rate]) * self.weight[:, None], flown.by_p * self.weight

    def describe(self, x: np.ndarray, p: float) -> dict[str, Any]:
        """Period, extremes, multipliers, least sliding speed and longest sticking of the cycle at a point."""
        n, (low, high, _), start = self.first.system.size, self._looked_at(x, p), self.start(x)
        return {"period": float(x[-1]), "lowest": low, "highest": high, "multipliers": self.multipliers(x, p),
                "least_slip": self.least_slip(x, p), "sticking": self.sticking(x, p),
                "begin": np.concatenate([start[:n], start[self.first.size :][:n]])}  # fmt: skip

    def _looked_at(self, x: np.ndarray, p: float) -> tuple[Any, Any, Any]:
        """Least and largest displacement of each row that results know, and the sliding velocities met."""
        return self._once("look", np.append(x, p).tobytes(), lambda: self._looks(x, p))

    def _looks(self, x: np.ndarray, p: float) -> tuple[Any, Any, Any]:
        n, motion, speeds = self.first.system.size, self.run(x, p), []

        def at(times: np.ndarray) -> tuple[Any, Any]:
            wanted, place = np.unique(np.append(times, np.linspace(0.0, x[-1], LOOKS)), return_inverse=True)
            run = self._motion(x, p, wanted)
            speeds.append(run.sliding_velocity)
            return run.q[place[: times.size], :n], run.qd[place[: times.size], :n]

        low, high = refined(at, motion.t, motion.q[:, :n], motion.qd[:, :n], float(x[-1]))
        return low, high, np.vstack([motion.sliding_velocity, *speeds])

    def multipliers(self, x: np.ndarray, p: float) -> Any:
        """Floquet multipliers of the cycle at a point."""
        known = self._alone or not isinstance(self.first, Field)
        return (self.first if known else self.field(p)).multipliers(self.fly(x, p)[1].phi)

    def least_slip(self, x: np.ndarray, p: float) -> float:
        """Least sliding speed in the sense of V [m/s] at many instants of the motion."""
        known = isinstance(self.run(x, p), MotionRows) and self.motions is not None
        V = self.motions.speeds(p) if known and self.motions else self.field(p).V
        return float(np.min(self._looked_at(x, p)[2] * np.sign(V), initial=np.inf))

    def sticking(self, x: np.ndarray, p: float) -> float:
        """Longest sticking of a contact [s]."""
        motion = self.run(x, p)
        return float(np.max((motion.mode[1:] == 0).T @ np.diff(motion.t), initial=0.0))

    def cycle(self, x: np.ndarray, p: float) -> Cycle:
        """The cycle at a point, its multipliers computed anew to 1e-12; error is the scaled residual there."""
        start = self.start(x)
        field = self.field(p)
        flown = derived(field, start, float(x[-1]))
        error = float(np.max(np.abs(self.residual(x, p))))
        settings = {"contact": "exact", "width": 0.0, "shots": 1, "rtol": 1e-13}
        return cycle_through(field, start, float(x[-1]), [flown], Outcome(COMPLETED), settings, 2049, error)
