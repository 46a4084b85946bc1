"""Loops: what senses a brake and acts on it. Each is a data sheet; its rows stand beside those of the contacts.

    M q'' + C q' + K q = ... + sum_a b_a u_a
    z' = A z + E q + F q' + G u            what a loop remembers
    u  = sat(P q + R q' + S z)             its force, held between samples, late by a delay

A loop senses the degree of freedom `sense` and acts on `on` (a name each). A loop without limit, delay and sampling is
linear: `folded` writes its memory as rows without mass, which every analysis takes. A delay is such rows too, to
round-off: what is under way, at Chebyshev points of it (Breda, Maset and Vermiglio 2005, SIAM J. Sci. Comput. 27).
Active force control after Hewit and Burdess 1981, Mechanism and Machine Theory 16, 535-542.
Depends on: parameters.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.parameters import DataSheet, ParameterError, known_names, parameter

LEAST_POINTS, MOST_POINTS = 12, 72  # of a delay written as rows
LONGEST = 60.0  # radians of the brake's own motion in a delay that is written as rows
SHORTEST = 1e-7  # of such a radian: what a delay of 0 among others counts as


@dataclass(frozen=True)
class Rows:
    """The matrices of one loop; P, R, b (..., n), E, F (..., m, n), A (..., m, m), G, S (..., m).

    size (..., m) is the force a unit of each state makes, where that is known.
    """

    A: Any
    E: Any
    F: Any
    G: Any
    P: Any
    R: Any
    S: Any
    b: Any
    size: Any = None

    @property
    def memory(self) -> int:
        """Number m of states."""
        return int(np.shape(self.S)[-1])


class Loop(DataSheet):
    """Base of the loops: `rows(names)`, and what the actuator is.

    bandwidth [Hz] of a first-order actuator, limit [N] of its force, delay [s], sampling [Hz] with `computing` samples
    of computing time, are None or 0 where the actuator is ideal. A command that is sampled or late is cut at the limit,
    held, and then followed by the actuator.
    """

    on: str = ""
    sense: str = ""
    bandwidth: float | None = parameter(
        "Hz", 0.0, low_open=True, default=None, optional=True, meaning="of a first-order actuator; ideal when left out"
    )
    limit: float | None = parameter(
        "N", 0.0, low_open=True, default=None, optional=True, meaning="largest force; none when left out"
    )
    delay: float = parameter("s", 0.0, default=0.0, meaning="by which the force is late")
    sampling: float | None = parameter(
        "Hz", 0.0, low_open=True, default=None, optional=True, meaning="rate; continuous when left out"
    )
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
        return own if self.bandwidth is None else _lagging(own, self.rate)

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

    def __init__(self, mass: Any = 0.0, time_constant: Any = 1e-4, outer: Loop | None = None, **others: Any) -> None:
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


def _lagging(own: Rows, rate: Any) -> Rows:
    """Controller and first-order actuator, f' = rate (command - f), u = f."""
    m, n = own.memory, own.b.size
    vectors = (np.shape(row)[:-1] for row in (own.P, own.R, own.S))
    lead = np.broadcast_shapes(np.shape(rate), *vectors, np.shape(own.A)[:-2])
    A, E, F = np.zeros((*lead, m + 1, m + 1)), np.zeros((*lead, m + 1, n)), np.zeros((*lead, m + 1, n))
    G, S = np.zeros((*lead, m + 1)), np.zeros((*lead, m + 1))
    A[..., :m, :m], E[..., :m, :], F[..., :m, :], G[..., :m] = own.A, own.E, own.F, own.G
    A[..., m, :m], A[..., m, m], S[..., m] = rate[..., None] * own.S, -rate, 1.0
    E[..., m, :], F[..., m, :] = rate[..., None] * own.P, rate[..., None] * own.R
    return Rows(A, E, F, G, np.zeros(n), np.zeros(n), S, own.b)


def _late(own: Rows, delay: Any, rate: Any) -> Rows:
    """Rows whose force is late: w' = (2/T)(D w + D_0 c), w what is under way at Chebyshev points, w(0) = c."""
    angle = float(np.max(rate * delay))
    if angle > LONGEST:
        expected = f"delays of at most {LONGEST:g} radians of the brake's motion; closed_loop() gives the poles of longer"
        raise ParameterError("system", "loops", f"a delay of {float(np.max(delay)):g} s", expected)
    order = int(min(LEAST_POINTS + np.ceil(1.2 * angle), MOST_POINTS))
    speed = 2.0 / np.maximum(delay, SHORTEST / rate)
    points, D = chebyshev(order)
    m, n = own.memory, own.b.size
    vectors = (np.shape(row)[:-1] for row in (own.P, own.R, own.S))
    lead = np.broadcast_shapes(np.shape(speed), *vectors, np.shape(own.A)[:-2])
    A, E, F = (np.zeros((*lead, m + order, width)) for width in (m + order, n, n))
    G, S = np.zeros((*lead, m + order)), np.zeros((*lead, m + order))
    A[..., :m, :m], E[..., :m, :], F[..., :m, :], G[..., :m], S[..., -1] = own.A, own.E, own.F, own.G, 1.0
    enter = np.asarray(speed)[..., None, None] * D[1:, :1]
    A[..., m:, :m] = enter * np.asarray(own.S)[..., None, :]
    A[..., m:, m:] = np.asarray(speed)[..., None, None] * D[1:, 1:]
    E[..., m:, :], F[..., m:, :] = enter * own.P[..., None, :], enter * own.R[..., None, :]
    size = np.ones((*lead, m + order))
    size[..., :m] = force_per_state(own, rate)
    return Rows(A, E, F, G, np.zeros(n), np.zeros(n), S, own.b, size)


def chebyshev(order: int) -> tuple[Any, Any]:
    """Points cos(pi j/order) and the differentiation matrix on them (Trefethen 2000, Spectral Methods, ch. 6)."""
    points = np.cos(np.pi * np.arange(order + 1) / order)
    c = np.r_[2.0, np.ones(order - 1), 2.0] * (-1.0) ** np.arange(order + 1)
    apart = points[:, None] - points[None, :] + np.eye(order + 1)
    matrix = np.outer(c, 1.0 / c) / apart
    return points, matrix - np.diag(np.sum(matrix, axis=1))


def check_loops(loops: Any, names: tuple[str, ...], error: type[Exception]) -> tuple[Loop, ...]:
    """The loops of a system as a tuple; `error` for what is none, a loop's own error for a name that is not there."""
    kept = tuple(loops) if isinstance(loops, (tuple, list)) else (loops,)
    for i, loop in enumerate(kept):
        if not isinstance(loop, Loop):
            raise error(f"loops[{i}] = {loop!r}: expected a loop, such as PID(on='y', derivative=0.1)")
        loop.rows(names)
    return kept


def folded(system: Any, *, near: bool = False) -> Any:
    """The system with its linear loops written as rows of M, C and K; the others stay loops.

    A state z becomes a degree of freedom without mass, scaled to a displacement so that all rows are of one size. With
    `near`, loops with a limit are folded too, as linear as they are near steady sliding, and those with a delay.
    """
    chosen = [loop for loop in system.loops if (loop.sampling is None if near else loop.linear and loop.limit is None)]
    if not chosen:
        return system
    spring, rate = _size_and_rate(system, np.shape(system.K)[:-2])
    rows = [loop.rows(system.names) for loop in chosen]
    rows = [
        row if loop.linear else _late(row, np.asarray(loop.delay), rate) for row, loop in zip(rows, chosen, strict=True)
    ]
    n, more = system.size, sum(row.memory for row in rows)
    vectors = (np.shape(x)[:-1] for row in rows for x in (row.P, row.R, row.S, row.G))
    lead = np.broadcast_shapes(
        system.shape, *vectors, *(np.shape(x)[:-2] for row in rows for x in (row.A, row.E, row.F))
    )
    M, C, K = (np.zeros((*lead, n + more, n + more)) for _ in range(3))
    for into, matrix in ((M, system.M), (C, system.C), (K, system.K)):
        into[..., :n, :n] = matrix
    spring, rate = _size_and_rate(system, lead)
    at = n
    for row in rows:
        m = slice(at, at + row.memory)
        at += row.memory
        size = force_per_state(row, rate)
        unit = spring[..., None] / size  # z = unit * (a displacement)
        P, R, S = (np.broadcast_to(x, (*lead, np.shape(x)[-1])) for x in (row.P, row.R, row.S))
        C[..., :n, :n] -= row.b[:, None] * R[..., None, :]
        K[..., :n, :n] -= row.b[:, None] * P[..., None, :]
        K[..., :n, m] -= row.b[:, None] * (S * unit)[..., None, :]
        scale = (spring / rate)[..., None, None] / unit[..., :, None]
        C[..., m, :n] = -scale * (row.F + row.G[..., :, None] * R[..., None, :])
        K[..., m, :n] = -scale * (row.E + row.G[..., :, None] * P[..., None, :])
        C[..., m, m] = (spring / rate)[..., None, None] * np.eye(row.memory)
        K[..., m, m] = -scale * (row.A + row.G[..., :, None] * S[..., None, :]) * unit[..., None, :]
    return _wider(system, M, C, K, more, tuple(loop for loop in system.loops if loop not in chosen))


def _size_and_rate(system: Any, lead: tuple[int, ...]) -> tuple[Any, Any]:
    """The largest stiffness [N/m] and, with the largest mass, an angular frequency [rad/s], both (...)."""
    spring = np.max(np.abs(system.K), axis=(-1, -2)) + np.zeros(lead)
    spring = np.where(spring > 0.0, spring, 1.0)
    mass = np.max(np.abs(system.M), axis=(-1, -2))
    return spring, np.sqrt(spring / np.where(mass > 0.0, mass, 1.0))


def force_per_state(row: Rows, rate: Any) -> Any:
    """How much force a unit of each state makes within 1/rate, (..., m): directly or through others; 1 if none."""
    if row.size is not None:
        return row.size + 0.0 * np.asarray(rate)[..., None]
    size = np.abs(row.S) + 0.0 * np.asarray(rate)[..., None]
    for _ in range(row.memory):
        through = np.max(np.abs(row.A) * size[..., :, None], axis=-2, initial=0.0) / np.asarray(rate)[..., None]
        size = np.where(size > 0.0, size, through)
    return np.where(size > 0.0, size, 1.0)


def near_sliding(system: Any) -> Any:
    """The system near steady sliding, its loops as rows, delays too; `ParameterError` for loops that are sampled."""
    near = folded(system, near=True)
    for loop in near.loops:
        given = f"{type(loop).__name__}(on={loop.on!r}) with sampling"
        raise ParameterError("system", "loops", given, "loops that are rows of matrices: closed_loop() gives its poles")
    return near


def _wider(system: Any, M: Any, C: Any, K: Any, more: int, loops: tuple[Loop, ...]) -> Any:
    """The system with these matrices and its contacts and load padded by rows without force."""
    contacts = []
    for contact in system.contacts:
        given = {name: getattr(contact, name) for name in ("n", "d", "t", "normal")}
        contacts.append(contact.replace({name: padded(row, more) for name, row in given.items() if row is not None}))
    names = numbered(system.names, "loop state", more)
    load = padded_load(system.load, more)
    return system.replace(M=M, C=C, K=K, load=load, contacts=tuple(contacts), names=names, loops=loops)


def numbered(names: tuple[str, ...], name: str, more: int) -> tuple[str, ...]:
    """The names with `more` at the end that are called `name` and go on counting.

    >>> numbered(("x", "state 1"), "state", 2)
    ('x', 'state 1', 'state 2', 'state 3')
    """
    first = 1 + sum(each.rpartition(" ")[0] == name for each in names)
    return (*names, *(f"{name} {i}" for i in range(first, first + more)))


def padded(row: Any, more: int) -> Any:
    """A row (..., n) with zeros at its end."""
    return np.pad(row, [(0, 0)] * (np.ndim(row) - 1) + [(0, more)])


def padded_load(load: Any, more: int) -> Any:
    """A load, numbers (..., n) or a schedule of them, with zeros at its end."""
    if not hasattr(load, "terms"):
        return padded(load, more)
    parts: list[Any] = []
    for weight, part in load.terms():
        level = getattr(part, "level", 1.0)
        if np.ndim(level) > 0:
            weight, part = np.asarray(weight) * level, part.replace(level=1.0)
        wide = part * padded(np.asarray(weight, dtype=float), more)
        parts.append(wide)
    total = parts[0]
    for part in parts[1:]:
        total = total + part
    return total
