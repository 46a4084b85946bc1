"""The motion over a given time and its derivative by the start, exact across events.

Between events Phi' = A(t) Phi along the motion; at an event Phi is multiplied by the saltation matrix. The motion and
its events come from `simulate`, A and f along it from `Field`. How well the integral of f meets the motion, and what
the last halving of the steps still changed of Phi, whichever is more, is kept as `mismatch`.
"""

import itertools
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from squealbox.limit_cycles.cycles.field import Autonomous, Field
from squealbox.limit_cycles.cycles.saltation import saltation
from squealbox.result import Outcome
from squealbox.transient import Method, Trajectory, simulate

PARTS = 4  # of each step of a motion, which is as long as an order of 8 lets it be at 1e-13
PERIOD_STEPS = 100_000  # a stick-slip period takes some hundred: where one takes more, no cycle is in reach


class MotionRows(NamedTuple):
    """Rows of one motion, named as those of a `Trajectory`."""

    t: Any
    q: Any
    qd: Any
    normal_force: Any
    sliding_velocity: Any
    friction_force: Any
    mode: Any
    event_time: Any
    event_contact: Any
    event_mode: Any
    steps: int
    outcome: Outcome


Moved = Trajectory | MotionRows


@dataclass(frozen=True, eq=False)
class Flight:
    """End x (2n,) and its rate; phi (2n, 2n) = dx(T)/dx(0); the motion; mismatch [-]; least |event rate| [-]."""

    x: Any
    rate: Any
    phi: Any
    motion: Moved
    mismatch: float = 0.0
    transversality: float = 1.0
    together: bool = False
    by_p: Any = None

    @property
    def outcome(self) -> Outcome:
        """How the simulation ended."""
        return self.motion.outcome


def fly(
    field: Autonomous,
    x: np.ndarray,
    duration: float,
    rtol: float = 1e-13,
    times: np.ndarray | None = None,
    most: int = PERIOD_STEPS,
) -> Trajectory:
    """The motion from x over `duration` [s], with tolerances relative to the speeds in it, in at most `most` steps."""
    n, method = field.size, method_of(field, x, rtol, most)
    return simulate(field.held_fast, duration, (x[:n], x[n:]), times, method, field.contact, width=field.width)


def method_of(field: Autonomous, x: np.ndarray, rtol: float, most: int = PERIOD_STEPS) -> Method:
    """How the motion from x is integrated to a relative tolerance."""
    speed = max(float(np.max(np.abs(x[field.size :]), initial=0.0)), float(np.max(np.abs(field.V), initial=0.0)))
    return Method("dormand-prince-8", rtol=rtol, atol=1e-2 * rtol * (speed or 1.0), most_steps=most)


def flight(
    field: Field, x: np.ndarray, duration: float, rtol: float = 1e-13, *, motion: Moved | None = None
) -> Flight:  # fmt: skip
    """The motion from x over `duration` [s] and its derivative by x: to about 1e-12, 1e-9 with a smoothed law's kink.

    Phi by Magnus steps of order 4, `PARTS` and twice as many to each step of the simulated motion; the two are
    extrapolated, and what that adds to the finer one is more than is left. So are the integrals of f along the motion
    over each smooth piece, to be compared with where the motion went: the compiled engine and `Field` are two programs
    of one equation.

    motion : that of `fly`, where it is known
    """
    motion = fly(field, x, duration, rtol) if motion is None else motion
    size = 2 * field.size
    if not motion.outcome.ok:
        return Flight(np.full(size, np.nan), np.full(size, np.nan), np.full((size, size), np.nan), motion)
    states, rows = np.hstack([motion.q, motion.qd]), smooth_rows(field, motion)
    pieces = list(itertools.pairwise(rows))
    half = len(pieces)
    edges = [subdivided(motion.t[i : k + 1], parts) for parts in (PARTS, 2 * PARTS) for i, k in pieces]
    along = between(lambda times: fly(field, x, duration, rtol, times), edges)
    phis, paths = [], []
    for times, inside, mode in zip(edges, along, 2 * [motion.mode[k] for _, k in pieces], strict=True):
        dt, matrices, rates = np.diff(times), field.jacobians(inside, mode), field.rates(inside, mode)
        phis.append(magnus(matrices[::2], matrices[1::2], dt, field.scale))
        paths.append(0.5 * dt @ (rates[::2] + rates[1::2]))
    jumps, least, together = jumps_of(field, states, motion.mode, rows[1:-1])
    coarse, fine = chained(phis[:half], jumps), chained(phis[half:], jumps)
    gone = [extrapolated(*each) for each in zip(paths[:half], paths[half:], strict=True)]
    missed = [states[k] - states[i] - way for (i, k), way in zip(pieces, gone, strict=True)]
    phi, ratio = extrapolated(coarse, fine), field.scale[:, None] / field.scale
    mismatch = max(
        _relative(field, missed, states), float(np.max(np.abs((phi - fine) * ratio)) / np.max(np.abs(phi * ratio)))
    )
    return Flight(states[-1], field.rate(states[-1], motion.mode[-1]), phi, motion, mismatch, least, together)


def quick_flight(
    field: Field, x: np.ndarray, duration: float, rtol: float = 1e-11, steps: int = 400, motion: Moved | None = None,
    beside: tuple[Field, Field, float] | None = None,
) -> Flight:  # fmt: skip
    """As `flight`, with Phi by some 400 Magnus steps in all and no second look: 1e-8 in a third of the time.

    motion : that of `fly`, where it is known
    beside : the field at two values of a parameter and their distance, for the derivative `by_p` (2n,) of the end: as
        a further state p with p' = 0 it is a column of the same matrices
    """
    motion = fly(field, x, duration, rtol) if motion is None else motion
    if not motion.outcome.ok:
        return flight(field, x, duration, rtol, motion=motion)
    states, rows = np.hstack([motion.q, motion.qd]), smooth_rows(field, motion)
    counts = [max(8, int(np.ceil(steps * (motion.t[k] - motion.t[i]) / duration))) for i, k in itertools.pairwise(rows)]
    edges = [subdivided(motion.t[[i, k]], n) for i, k, n in zip(rows[:-1], rows[1:], counts, strict=True)]
    inside = np.concatenate(between(lambda times: fly(field, x, duration, rtol, times), edges))
    mode = np.repeat(motion.mode[rows[1:]], 2 * np.array(counts), axis=0)
    size, scale, along = x.size, field.scale, field.jacobians(inside, mode)
    if beside is not None:
        along, weight = _with_parameter(field, along, inside, mode, beside)
        scale = np.append(scale, weight)
    jumps, least, _ = jumps_of(field, states, motion.mode, rows[1:-1], beside)
    ratio = scale[:, None] / scale
    dt = np.concatenate([np.diff(each) for each in edges])
    factors = _factors(along[::2] * ratio, along[1::2] * ratio, dt)
    if jumps:
        factors = np.insert(factors, np.cumsum(counts)[:-1], np.array(jumps) * ratio, axis=0)
    phi = _product(factors) / ratio
    by_p = None if beside is None else phi[:size, size]
    return Flight(states[-1], field.rate(states[-1], motion.mode[-1]), phi[:size, :size], motion, 0.0, least,
                  by_p=by_p)  # fmt: skip


def jumps_of(
    field: Field,
    states: np.ndarray,
    mode: np.ndarray,
    events: Sequence[int],
    beside: tuple[Field, Field, float] | None = None,
) -> tuple[list[Any], float, bool]:
    """Saltation matrices at rows of a motion, the least |rate| of an event, whether contacts change together."""
    if not events:
        return [], 1.0, False
    at, after = np.array(events), np.array(events) + 1
    rates = zip(field.rates(states[at], mode[at]), field.rates(states[at], mode[after]), strict=True)
    found = [saltation(field, states[i], mode[i], mode[i + 1], beside, both) for i, both in zip(at, rates, strict=True)]
    together = bool(np.any(np.sum(mode[at] != mode[after], axis=-1) > 1))
    return [jump for jump, _, _ in found], min(1.0, *(abs(rate) for _, rate, _ in found)), together


def _with_parameter(
    field: Field, by_x: np.ndarray, states: np.ndarray, mode: np.ndarray, beside: tuple[Field, Field, float]
) -> tuple[Any, float]:
    """df/d(x, p), (k, 2n + 1, 2n + 1), and what p is multiplied by to weigh as the others do."""
    low, high, distance = beside
    by_p = (high.rates(states, mode) - low.rates(states, mode)) / distance
    full = np.pad(by_x, ((0, 0), (0, 1), (0, 1)))
    full[:, :-1, -1] = by_p
    return full, float(np.max(np.abs(by_p) * field.scale)) / (field.frequency or 1.0) or 1.0


def smooth_rows(field: Field, motion: Moved) -> list[int]:
    """Rows of the motion between which it is smooth: the first, those of the events, the last."""
    changed = np.any(motion.mode[1:] != motion.mode[:-1], axis=1)
    cuts = [int(i) for i in np.flatnonzero(changed) if i > 0] if field.contact == "exact" else []
    return [0, *cuts, len(motion.t) - 1]


def chained(parts: list[Any], jumps: list[Any]) -> Any:
    """Phi over pieces one after the other, from those of the pieces and of the events between them."""
    total = parts[0]
    for part, jump in zip(parts[1:], jumps, strict=True):
        total = part @ (jump @ total)
    return total


def subdivided(t: np.ndarray, parts: int) -> Any:
    """The instants t with the intervals between them in so many equal parts."""
    inner = t[:-1, None] + np.diff(t)[:, None] * np.arange(parts) / parts
    return np.append(inner.ravel(), t[-1])


def between(run: Callable[[Any], Moved], edges: list[Any]) -> list[Any]:
    """States (2 k, 2n) at the two Gauss points of each of the k steps between the `edges` of each list.

    run : gives the motion at instants
    """
    instants = [gauss(each) for each in edges]
    wanted, place = np.unique(np.concatenate(instants), return_inverse=True)
    inner = run(wanted)
    return np.split(np.hstack([inner.q, inner.qd])[place], np.cumsum([len(t) for t in instants])[:-1])


def gauss(edges: np.ndarray) -> Any:
    """The two Gauss points of each step, in rising order."""
    middle, h = 0.5 * (edges[1:] + edges[:-1]), np.diff(edges)
    return (middle[:, None] + np.array([-1.0, 1.0]) * np.sqrt(3.0) / 6.0 * h[:, None]).ravel()


def extrapolated(coarse: np.ndarray, fine: np.ndarray) -> Any:
    """What two results of order 4 at a step and at its half lead to (Richardson)."""
    return fine + (fine - coarse) / 15.0


def magnus(a: np.ndarray, b: np.ndarray, dt: float | np.ndarray, scale: np.ndarray) -> Any:
    """Phi over steps dt, one or (k,), from df/dx at the two Gauss points of each, a and b (k, m, m): order 4 in dt.

    exp(dt (a + b)/2 + sqrt(3) dt^2 [b, a]/12), Iserles and Norsett 1999, Phil. Trans. R. Soc. A 357, 983-1019.
    """
    ratio = scale[:, None] / scale
    return _product(_factors(a * ratio, b * ratio, dt)) / ratio


def _factors(a: np.ndarray, b: np.ndarray, dt: float | np.ndarray) -> Any:
    """Phi of each of the steps."""
    dt = np.reshape(dt, (-1, 1, 1))
    return _exponential(0.5 * dt * (a + b) + np.sqrt(3.0) / 12.0 * dt**2 * (b @ a - a @ b))


def _product(factors: np.ndarray) -> Any:
    """Product of matrices (k, m, m), the first to act first."""
    while len(factors) > 1:
        if len(factors) % 2:
            factors = np.concatenate([factors, np.eye(factors.shape[-1])[None]])
        factors = factors[1::2] @ factors[::2]
    return factors[0]


def _exponential(matrices: np.ndarray) -> Any:
    """exp of small matrices (k, m, m): Taylor to order 12 after halving to a norm below 1/4, and squaring back."""
    norm = float(np.max(np.sum(np.abs(matrices), axis=-1), initial=0.0))
    halvings = max(0, int(np.ceil(np.log2(max(norm, 1e-300) / 0.25))))
    small = matrices / 2.0**halvings
    eye = np.eye(matrices.shape[-1])
    total = np.broadcast_to(eye, matrices.shape)
    for order in range(12, 0, -1):
        total = eye + small @ total / order
    for _ in range(halvings):
        total = total @ total
    return total


def _relative(field: Field, difference: Sequence[np.ndarray], states: np.ndarray) -> float:
    scaled = field.scale * difference
    return float(np.max(np.abs(scaled)) / (np.max(np.abs(field.scale * states)) + 1e-300))
