"""The kinds of loops: what senses a brake and acts on it. Each is a data sheet.

    M q'' + C q' + K q = ... + sum_a b_a u_a
    z' = A z + E q + F q' + G u            what a loop remembers
    u  = sat(P q + R q' + S z)             its force, held between samples, late by a delay

A loop senses the degree of freedom `sense` and acts on `on` (a name each). Active force control after Hewit and
Burdess 1981, Mechanism and Machine Theory 16, 535-542.
"""

from collections.abc import Sequence
from typing import Any, ClassVar

import numpy as np

from squealbox.loops.rows import Rows, lagging
from squealbox.parameters import DataSheet, ParameterError, above_zero, known_names, parameter


class Loop(DataSheet):
    """Base of the loops: `rows(names)`, and what the actuator is.

    bandwidth [Hz] of a first-order actuator, limit [N] of its force, delay [s], sampling [Hz] with `computing` samples
    of computing time, are None or 0 where the actuator is ideal. A command that is sampled or late is cut at the limit,
    held, and then followed by the actuator.
    """

    counted_from: ClassVar[int] = 0

    on: str = ""
    sense: str = ""
    bandwidth: float | None = above_zero("Hz", default=None, meaning="of a first-order actuator; ideal when left out")
    limit: float | None = above_zero("N", default=None, meaning="largest force; none when left out")
    delay: float = parameter("s", 0.0, default=0.0, meaning="by which the force is late")
    sampling: float | None = above_zero("Hz", default=None, meaning="rate; continuous when left out")
    computing: float = parameter("-", 0.0, default=0.0, meaning="computing time in samples")

    @property
    def late(self) -> float:
        """Delay and computing time together [s]."""
        return float(self.delay) + (float(self.computing) / float(self.sampling) if self.sampling is not None else 0.0)

    @property
    def linear(self) -> bool:
        """True for a loop that is rows of matrices: no delay, no sampling (a limit is looked at apart)."""
        return self.sampling is None and bool(np.all(np.asarray(self.delay) == 0.0))

    def controller(self, names: tuple[str, ...]) -> Rows:
        """The rows of the controller alone, with an ideal actuator."""
        raise NotImplementedError

    def rows(self, names: tuple[str, ...]) -> Rows:
        """The rows of controller and actuator for a system with these degrees of freedom."""
        own = self.controller(names)
        return own if self.bandwidth is None else lagging(own, self.rate)

    @property
    def rate(self) -> Any:
        """2 pi bandwidth [1/s] of the actuator; None of an ideal one."""
        return None if self.bandwidth is None else 2.0 * np.pi * np.asarray(self.bandwidth)

    def _unit(self, names: tuple[str, ...], field: str) -> Any:
        field = "sense" if field == "sense" and self.sense else "on"
        name = self.sense if field == "sense" else self.on
        if not name:
            raise ParameterError(
                type(self).__name__, field, name, f"the degree of freedom it acts on, one of {list(names)}"
            )
        if name not in names:
            raise ParameterError(type(self).__name__, field, name, known_names(name, list(names)))
        return np.eye(len(names))[names.index(name)]


class PID(Loop):
    """u = -(proportional y + integral int y + derivative y') of the displacement y it senses.

    >>> PID(on="y", proportional=2.0, derivative=0.1).rows(("x", "y")).R.tolist()
    [-0.0, -0.1]
    """

    proportional: float = parameter("N/m", default=0.0, meaning="gain of the displacement")
    integral: float = parameter("N/(m s)", default=0.0, meaning="gain of its integral")
    derivative: float = parameter("N s/m", default=0.0, meaning="gain of the velocity")

    def controller(self, names: tuple[str, ...]) -> Rows:
        y, b = self._unit(names, "sense"), self._unit(names, "on")
        gains = [np.asarray(g, dtype=float)[..., None] for g in (self.proportional, self.integral, self.derivative)]
        memory = int(bool(np.any(np.asarray(self.integral) != 0.0)))
        nothing = np.zeros((memory, memory))
        E = np.broadcast_to(y, (memory, len(names)))
        S = -gains[1] if memory else np.zeros(0)
        return Rows(nothing, E, 0.0 * E, np.zeros(memory), -gains[0] * y, -gains[2] * y, S, b)


class StateFeedback(Loop):
    """u = -(position . q + velocity . q'), a gain for each degree of freedom; those left out at the end are 0.

    >>> StateFeedback(on="y", velocity=(0.0, 0.1)).rows(("x", "y")).R.tolist()
    [-0.0, -0.1]
    """

    position: tuple[float, ...] = ()
    velocity: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("position", "velocity"):
            gains = np.atleast_1d(np.asarray(getattr(self, name), dtype=float))
            if not np.all(np.isfinite(gains)):
                raise ParameterError("StateFeedback", name, getattr(self, name), "finite numbers")
            object.__setattr__(self, name, tuple(float(g) for g in gains))

    def controller(self, names: tuple[str, ...]) -> Rows:
        n, gains = len(names), []
        for name in ("position", "velocity"):
            given = getattr(self, name)
            if len(given) > n:
                raise ParameterError("StateFeedback", name, given, f"at most {n} gains, one for each of {names}")
            gains.append(np.pad(np.array(given, dtype=float), (0, n - len(given))))
        none = np.zeros((0, n))
        return Rows(
            np.zeros((0, 0)), none, none, np.zeros(0), -gains[0], -gains[1], np.zeros(0), self._unit(names, "on")
        )


class DelayedFeedback(Loop):
    """u(t) = -(proportional y + derivative y') at t - delay: the delay is the means, not the fault.

    A displacement fed back a quarter of a period late, with a negative gain, damps. Source: Das and Mallik 2006,
    Journal of Sound and Vibration 298.
    """

    proportional: float = parameter("N/m", default=0.0, meaning="gain of the displacement")
    derivative: float = parameter("N s/m", default=0.0, meaning="gain of the velocity")

    def controller(self, names: tuple[str, ...]) -> Rows:
        y, b, none = self._unit(names, "sense"), self._unit(names, "on"), np.zeros((0, len(names)))
        position, velocity = (np.asarray(g, dtype=float)[..., None] for g in (self.proportional, self.derivative))
        return Rows(np.zeros((0, 0)), none, none, np.zeros(0), -position * y, -velocity * y, np.zeros(0), b)


class ActiveForce(Loop):
    """Active force control: the disturbance is estimated from acceleration and actuator force, and taken back.

    u = u_c - W (mass q'' - u), W = 1/(1 + time_constant s), u_c the force of the `outer` loop (none: 0). With a PD
    outer loop that is exactly a PID of Kp + Kd/tau, Kp/tau, Kd + mass/tau; without one a damper mass/tau. The
    filter's state is w - (mass/tau) q', fed by the force the actuator really has, so nothing winds up at its limit;
    without an outer loop it is the damper, cut at the limit.

    >>> ActiveForce(mass=0.1, time_constant=0.5, on="y").rows(("x", "y")).R.tolist()
    [-0.0, -0.2]
    """

    mass: float = parameter("kg", 0.0, default=0.0, meaning="estimated mass")
    time_constant: float = parameter("s", 0.0, default=1e-4, meaning="of the filter of the estimate")
    outer: Loop | None = None

    def __init__(
        self,
        mass: float | np.ndarray = 0.0,
        time_constant: float | np.ndarray = 1e-4,
        outer: Loop | None = None,
        **others: Any,
    ) -> None:
        known = {"on", "sense", "bandwidth", "limit", "delay", "sampling", "computing"}
        for name in others:
            if name not in known:
                raise ParameterError("ActiveForce", name, others[name], known_names(name, sorted(known)))
        defaults: dict[str, Any] = dict.fromkeys(("bandwidth", "limit", "sampling"))
        values = {"on": "", "sense": "", "delay": 0.0, "computing": 0.0, **defaults, **others}
        for name, value in {**values, "mass": mass, "time_constant": time_constant, "outer": outer}.items():
            object.__setattr__(self, name, value)
        self.__post_init__()

    def __post_init__(self) -> None:
        super().__post_init__()
        if np.any(np.asarray(self.time_constant) == 0.0):
            reason = "more than 0 s: without a filter the force would follow from itself at once, an algebraic loop"
            raise ParameterError("ActiveForce", "time_constant", self.time_constant, reason)
        if self.outer is not None:
            if not isinstance(self.outer, Loop):
                raise ParameterError("ActiveForce", "outer", self.outer, "a loop, such as PID(on='y'), or None")
            inner = self.outer
            if inner.bandwidth or inner.limit or inner.delay or inner.sampling:
                raise ParameterError(
                    "ActiveForce", "outer", inner, "an ideal loop: the actuator is that of ActiveForce"
                )
            object.__setattr__(self, "on", self.on or inner.on)

    def controller(self, names: tuple[str, ...]) -> Rows:
        y, b = self._unit(names, "sense"), self._unit(names, "on")
        tau, damper = np.asarray(self.time_constant), np.asarray(self.mass) / np.asarray(self.time_constant)
        if self.outer is None:
            none = np.zeros((0, len(names)))
            return Rows(np.zeros((0, 0)), none, none, np.zeros(0), 0.0 * y, -damper[..., None] * y, np.zeros(0), b)
        outer = self.outer.replace(on=self.outer.on or self.on).rows(names)
        m, lead = outer.memory, np.broadcast_shapes(np.shape(tau), np.shape(damper), np.shape(outer.P)[:-1])
        A, E, F = np.zeros((*lead, m + 1, m + 1)), np.zeros((*lead, m + 1, y.size)), np.zeros((*lead, m + 1, y.size))
        G, S = np.zeros((*lead, m + 1)), np.zeros((*lead, m + 1))
        A[..., :m, :m], E[..., :m, :], F[..., :m, :], S[..., :m] = outer.A, outer.E, outer.F, outer.S
        A[..., m, m], G[..., m], S[..., m] = -1.0 / tau, -1.0 / tau, -1.0
        F[..., m, :] = -(damper / tau)[..., None] * y
        return Rows(A, E, F, G, outer.P, outer.R - damper[..., None] * y, S, b)


LOOPS: dict[str, type[Loop]] = {
    "pid": PID,
    "state_feedback": StateFeedback,
    "delayed_feedback": DelayedFeedback,
    "active_force": ActiveForce,
}


def check_loops(loops: Sequence[Any], names: tuple[str, ...], error: type[Exception]) -> tuple[Loop, ...]:
    """The loops of a system as a tuple; `error` for what is none, a loop's own error for a name that is not there."""
    kept = tuple(loops) if isinstance(loops, (tuple, list)) else (loops,)
    for i, loop in enumerate(kept):
        if not isinstance(loop, Loop):
            raise error(f"loops[{i}] = {loop!r}: expected a loop, such as PID(on='y', derivative=0.1)")
        loop.rows(names)
    return kept
