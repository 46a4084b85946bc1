"""Forced motion that repeats: loads, speeds or normal forces move with a period T, x(t0 + T) = x(t0).

Newton's method on the flow over one period, with its exact derivative. Between events Phi' = A(t) Phi; at an event
h = 0

    S = I + (f+ - f-) h_x' / (h_x . f- + h_t)

because the surface itself moves, v = V(t) - t.q' or N = N0(t) + n.q. A contact that sticks follows its counter-body,
t.q'' = V'(t). The eigenvalues of Phi over T are the Floquet multipliers: the motion is stable where all are inside the
unit circle, and no one of them is 1 of itself, as it is for a free cycle.
Source: Leine and Nijmeijer 2004, Dynamics and Bifurcations of Non-Smooth Mechanical Systems, Springer, Ch. 7.
"""

import itertools
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from fractions import Fraction
from typing import Any, ClassVar

import numpy as np

from squealbox.arguments import public
from squealbox.continuation import StepControl, follow
from squealbox.limit_cycles.cycles.cycle import stability_of
from squealbox.limit_cycles.cycles.field import Field
from squealbox.limit_cycles.cycles.saltation import surface
from squealbox.limit_cycles.cycles.variation import (
    PARTS,
    between,
    chained,
    extrapolated,
    gauss,
    magnus,
    smooth_rows,
    subdivided,
)
from squealbox.parameters import ParameterError
from squealbox.result import COMPLETED, Array, Outcome, Result, quantity
from squealbox.schedules import Constant, Schedule, Sinusoid, value_at
from squealbox.start import Start, StartLike
from squealbox.system import DesignOrSystem, System, as_system, equilibrium
from squealbox.transient import Method, Trajectory, simulate
from squealbox.words import sizes_told

MOST_ROUNDS = 1000  # periods of one harmonic within which the others must come back
INSTANT = 1e-6  # share of the period over which an event function is differenced in time


@dataclass(frozen=True, kw_only=True, eq=False)
class ForcedCycle(Result):
    """One period of a forced motion, as :func:`forced_cycle` returns it."""

    period: Any = quantity("", "s", "period of what forces it")
    t: Array = quantity("time", "s", "instants of one period")
    q: Array = quantity("time dof", "m", "displacement")
    qd: Array = quantity("time dof", "m/s", "velocity")
    mode: Array = quantity("time contact", "1", "state of contact: -1, 1 slip, 0 stick, 2 open")
    multipliers: Array = quantity("multiplier", "1", "Floquet multipliers, largest first")
    error: Any = quantity("", "1", "last scaled residual")
    events: int = 0

    coordinates: ClassVar = {"time": "t"}
    table_over: ClassVar = ("time",)

    @property
    def system(self) -> System:
        """The system that moves."""
        return as_system(self.inputs["system"])

    @property
    def frequency(self) -> float:
        """1 / period [Hz]."""
        return 1.0 / float(self.period)

    @property
    def stable(self) -> bool:
        """True where every disturbance dies out."""
        return self.stability == "stable"

    @property
    def stability(self) -> str:
        """As `stability_of` the multipliers."""
        return stability_of(self.multipliers) if self.outcome.ok else "unstable"

    @property
    def growth_rate(self) -> float:
        """ln|largest multiplier| / T [1/s]; positive grows."""
        return float(np.log(np.max(np.abs(self.multipliers))) / self.period)

    @property
    def damping(self) -> float:
        """-ln|product of the multipliers| / T [1/s]: the divergence, sum of damping over mass in the mean."""
        with np.errstate(divide="ignore"):
            return float(-np.sum(np.log(np.abs(self.multipliers))) / self.period)

    @property
    def amplitude(self) -> Any:
        """Half the difference of the extremes of each displacement [m]."""
        return 0.5 * np.ptp(self.q, axis=0)

    def summary(self) -> str:
        """Period, stability and amplitudes."""
        if not self.outcome.ok:
            return self.outcome.told
        system = self.kept_system()
        sizes = sizes_told(system.names, self.amplitude, system.units)
        return (
            f"forced motion of period {float(self.period):.6g} s is {self.stability}: growth rate "
            f"{self.growth_rate:+.6g} 1/s, {self.events} events, amplitude {sizes}"
        )

    def __repr__(self) -> str:
        return self.summary()


class Moving(Field):
    """The field of a system whose loads, speeds and normal forces move, at one instant after the other."""

    def __init__(self, system: System, time: float) -> None:
        super().__init__(_frozen(system, time))
        self.moving, self.rising = system, np.zeros(len(system.contacts))
        self.inverse = np.linalg.inv(system.M)
        self.at(time)

    def at(self, time: float | np.ndarray) -> "Moving":
        """The same field at another instant [s], or for `jacobians` at instants (k,)."""
        rows, shape = self.moving.contacts, np.shape(time)
        self.N0, self.V = (
            np.array([np.broadcast_to(value_at(getattr(c, x), time), shape) for c in rows]).T.reshape(*shape, len(rows))
            for x in ("N0", "V")
        )
        if shape == ():
            self.rising = np.array([float(c.V.rate(time)) if isinstance(c.V, Schedule) else 0.0 for c in rows])
            self.mf = self.inverse @ np.asarray(value_at(self.moving.load, time))
        return self

    def _holding(self, stuck: np.ndarray, a: np.ndarray) -> Any:
        own = self.t[stuck] @ a - (self.rising[stuck] if np.ndim(a) == 1 else 0.0)
        return -np.linalg.lstsq(self.t[stuck] @ self.md[stuck].T, own, rcond=1e-12)[0]


@public()
def forced_cycle(
    design_or_system: DesignOrSystem,
    start: StartLike = None,
    *,
    rounds: int = 1,
    rtol: float = 1e-12,
    tolerance: float = 1e-9,
    most_steps: int = 20,
) -> ForcedCycle:
    """The motion a brake repeats when loads, speeds or normal forces move periodically, and its Floquet multipliers.

    Parameters
    ----------
    design_or_system : with `Sinusoid` schedules of commensurate frequencies, such as `Dithered(brake, direct=True)`
    start : near the motion, as for `simulate`; None takes steady sliding at the first instant
    rounds : periods of the forcing after which it repeats; 2 beyond a doubling
    rtol : relative tolerance of the integration [-]
    tolerance : largest scaled residual accepted as converged [-]

    Returns
    -------
    ForcedCycle, with outcome "completed", "no_convergence" or how the simulation ended.

    >>> from squealbox import Contact, Coulomb, Sinusoid, System
    >>> speed = Sinusoid(mean=0.5, amplitude=1.0, frequency=3.0)
    >>> belt = Contact(n=[0.0], d=[1.0], t=[1.0], N0=1.0, V=speed, law=Coulomb(0.4))
    >>> forced_cycle(System([[1.0]], [[0.02]], [[1.0]], 0.0, (belt,))).stable
    True
    """
    system = as_system(design_or_system)
    if system.shape != ():
        raise ParameterError("forced_cycle", "system", f"leading axes {system.shape}", "one system, without them")
    if int(rounds) != rounds or rounds < 1:
        raise ParameterError("forced_cycle", "rounds", rounds, "a whole number of at least 1")
    period = int(rounds) * common_period(system)
    x = _start(system, start)
    history: list[float] = []
    scale = Field(_frozen(system, 0.0)).scale
    settings = {"rounds": int(rounds), "rtol": rtol, "tolerance": tolerance}
    for _ in range(most_steps):
        motion, end, phi, events = _flight(system, x, period, rtol)
        if not motion.outcome.ok:
            return _made(
                design_or_system, settings, period, motion, np.full(x.size, np.nan), np.inf, events, motion.outcome
            )
        size = float(np.max(np.abs(np.hstack([motion.q, motion.qd]) * scale))) or 1.0
        history.append(float(np.max(np.abs((end - x) * scale))) / size)
        if history[-1] <= tolerance:
            values = np.linalg.eigvals(phi).astype(complex)
            values = values[np.argsort(-np.abs(values), kind="stable")]
            return _made(design_or_system, settings, period, motion, values, history[-1], events, Outcome(COMPLETED))
        x = x + np.linalg.lstsq(np.eye(x.size) - phi, end - x, rcond=1e-14)[0]
    message = f"Newton's method stopped at a scaled residual of {history[-1]:.3g}: give a start nearer to the motion"
    outcome = Outcome("no_convergence", message, history=history)
    return _made(design_or_system, settings, period, motion, np.full(x.size, np.nan), history[-1], events, outcome)


def forced_branch(
    family: Callable[[float], DesignOrSystem],
    values: Sequence[float] | np.ndarray,
    start: StartLike = None,
    **keywords: Any,
) -> Iterator[ForcedCycle]:
    """Forced motions over a parameter such as amplitude or frequency: `family(value)` is the brake.

    An iterator: each motion starts from the last that was found, and one that is not found does not end it.
    """
    for value in values:
        found = forced_cycle(family(value), start, **keywords)
        if found.outcome.ok:
            start = (found.q[0], found.qd[0])
        yield found


def forced_path(
    family: Callable[[float], DesignOrSystem], bounds: tuple[float, float], begin: float, start: StartLike = None,
    *, direction: float = 1.0, first: float = 0.02, largest: float = 0.1, most_points: int = 500, rtol: float = 1e-10,
) -> Iterator[tuple[float, ForcedCycle]]:  # fmt: skip
    """Forced motions along a parameter such as amplitude or frequency, by arclength: through folds.

    Parameters
    ----------
    family : `family(value)` is the brake
    bounds, begin : (low, high) of the value and the one to begin with, in its own unit
    start : near the first motion, as for `forced_cycle`
    direction : +1 walks upwards first, -1 downwards [-]
    first, largest : step lengths [-], a length of 1 from bound to bound or the motion it begins with
    rtol : relative tolerance of the integration [-]

    Yields (value, motion); unstable motions between two folds are among them. A walk that no step leads on, short of
    a bound and of `most_points`, ends with its last motion again, whose outcome says why.

    >>> from squealbox import Contact, Coulomb, Sinusoid, System
    >>> def block(force):
    ...     return System([[1.0]], [[0.2]], [[1.0]], load=Sinusoid(0.0, force, 0.1) * [1.0])
    >>> points = list(forced_path(block, (0.1, 0.5), 0.1, ([0.0], [0.0]), largest=0.5))
    >>> points[-1][0]
    0.5
    """
    low, high = bounds
    if not low <= begin <= high:
        raise ParameterError("forced_path", "begin", begin, f"a value within the bounds, {low:g} to {high:g}")
    found = forced_cycle(family(begin), start, rtol=rtol)
    if not found.outcome.ok:
        yield begin, found
        return
    x = np.concatenate([found.q[0], found.qd[0]])
    unit = np.max(np.abs(np.hstack([found.q, found.qd])), axis=0)
    unit = np.where(unit > 0.0, unit, float(np.max(unit)) or 1.0)

    def end(x: np.ndarray, p: float) -> Any:
        system = as_system(family(float(p)))
        period, n = common_period(system), system.size
        motion = simulate(system, period, (x[:n], x[n:]), [0.0, period], _method(system, x, period, rtol))
        return np.concatenate([motion.q[-1], motion.qd[-1]]) if motion.outcome.ok else np.full(x.shape, np.nan)

    def residual(x: np.ndarray, p: float) -> Any:
        return (end(x, p) - x) / unit

    def jacobian(x: np.ndarray, p: float) -> tuple[Any, Any]:
        system, step = as_system(family(float(p))), 1e-5 * (high - low)
        phi = _flight(system, x, common_period(system), rtol)[2]
        by_p = (end(x, p + step) - end(x, p - step)) / (2.0 * step)
        return (phi - np.eye(x.size)) / unit[:, None], by_p / unit

    control = StepControl(first=first, largest=largest, tolerance=1e-8, most_points=most_points)
    walk = follow(residual, x, begin, jacobian=jacobian, control=control, bounds=bounds, x_scale=unit,
                  p_scale=high - low, closes=False, direction=direction)  # fmt: skip
    at = begin
    for point in walk:
        at, (q, qd) = float(point.p), np.split(point.x, 2)
        found = forced_cycle(family(at), (q, qd), rtol=rtol)
        yield at, found
    if not walk.outcome.ok and walk.outcome != "most_points":
        yield at, replace(found, outcome=walk.outcome)


def common_period(system: System) -> float:
    """The period [s] of everything that moves; `ParameterError` when nothing does, or not with one period."""
    frequencies = []
    for value in (system.load, *(c.N0 for c in system.contacts), *(c.V for c in system.contacts)):
        for weight, part in value.terms() if isinstance(value, Schedule) else ():
            if isinstance(part, Constant) or not np.any(weight):
                continue
            if not isinstance(part, Sinusoid):
                raise ParameterError("forced_cycle", "system", part, "schedules that repeat: Sinusoid or Constant")
            if part.amplitude != 0.0 and part.frequency > 0.0:
                frequencies.append(float(part.frequency))
    if not frequencies:
        expected = "a load, speed or normal force that moves; shooting() finds free cycles"
        raise ParameterError("forced_cycle", "system", "everything is constant", expected)
    base = min(frequencies)
    ratios = [Fraction(f / base).limit_denominator(MOST_ROUNDS) for f in frequencies]
    if any(abs(float(ratio) * base - f) > 1e-12 * f for ratio, f in zip(ratios, frequencies, strict=True)):
        raise ParameterError("forced_cycle", "system", frequencies, "frequencies in ratios of whole numbers up to 1000")
    return float(np.lcm.reduce([ratio.denominator for ratio in ratios])) / base


def _flight(system: System, x: np.ndarray, period: float, rtol: float) -> tuple[Trajectory, Any, Any, int]:
    """The motion over one period, its end, its derivative by the start, and the number of events.

    The derivative as in `variation.flight`: Magnus steps of order 4 and half as long ones, extrapolated.
    """
    n, start = system.size, (x[: system.size], x[system.size :])
    method = _method(system, x, period, rtol)
    motion = simulate(system, period, start, None, method)
    if not motion.outcome.ok:
        return motion, x, np.eye(2 * n), 0
    states, field = np.hstack([motion.q, motion.qd]), Moving(system, 0.0)
    rows = smooth_rows(field, motion)
    pieces = list(itertools.pairwise(rows))
    edges = [subdivided(motion.t[i : k + 1], parts) for parts in (PARTS, 2 * PARTS) for i, k in pieces]
    along = between(lambda times: simulate(system, period, start, times, method), edges)
    phis = []
    for own, inside, (_, k) in zip(edges, along, 2 * pieces, strict=True):
        matrices = field.at(gauss(own)).jacobians(inside, motion.mode[k])
        phis.append(magnus(matrices[::2], matrices[1::2], np.diff(own), field.scale))
    jumps = [
        _jump(field, states[i], motion.mode[i], motion.mode[i + 1], float(motion.t[i]), period) for i, _ in pieces[1:]
    ]
    coarse, fine = chained(phis[: len(pieces)], jumps), chained(phis[len(pieces) :], jumps)
    return motion, states[-1], extrapolated(coarse, fine), len(rows) - 2


def _method(system: System, x: np.ndarray, period: float, rtol: float) -> Method:
    speed = float(np.max(np.abs(x[system.size :]), initial=0.0)) + max(
        (abs(float(value_at(c.V, 0.0))) for c in system.contacts), default=0.0
    )
    return Method("dormand-prince-8", rtol=rtol, atol=1e-2 * rtol * (speed or 1.0), largest_step=period / 20.0)


def _jump(field: Moving, x: np.ndarray, before: np.ndarray, after: np.ndarray, time: float, period: float) -> Any:
    """Saltation at a surface that moves."""
    own = np.flatnonzero(np.not_equal(before, after))
    field.at(time)
    surfaces = [surface(field, x, before, int(c)) for c in own]
    cause = int(np.argmin([abs(value) / (size + 1e-300) for value, size, _ in surfaces]))
    gradient = surfaces[cause][2]
    f_before, f_after = field.rate(x, before), field.rate(x, after)
    step = INSTANT * period
    late, early = (surface(field.at(time + s), x, before, int(own[cause]))[0] for s in (step, -step))
    rate = float(gradient @ f_before) + (late - early) / (2.0 * step)
    return np.eye(len(x)) + np.outer(f_after - f_before, gradient) / rate


def _frozen(system: System, time: float) -> System:
    contacts = tuple(
        contact.replace(N0=float(value_at(contact.N0, time)), V=float(value_at(contact.V, time)))
        for contact in system.contacts
    )
    return system.replace(contacts=contacts, load=np.asarray(value_at(system.load, time), dtype=float))


def _start(system: System, start: StartLike) -> Any:
    if start is not None:
        return Start.of("forced_cycle", start, system).state
    steady = equilibrium(_frozen(system, 0.0)) if not any(isinstance(c.V, Schedule) for c in system.contacts) else None
    q = steady.q if steady is not None and bool(steady.exists) else np.zeros(system.size)
    return np.concatenate([q, np.zeros(system.size)])


def _made(
    design: DesignOrSystem, settings: dict[str, Any], period: float, motion: Trajectory, values: np.ndarray,
    error: float, events: int, outcome: Outcome,
) -> ForcedCycle:  # fmt: skip
    return ForcedCycle(
        period=np.asarray(period), t=motion.t, q=motion.q, qd=motion.qd, mode=motion.mode, multipliers=values,
        error=np.asarray(error), events=events, inputs={"system": design}, settings=settings, outcome=outcome,
    )  # fmt: skip
