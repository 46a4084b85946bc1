"""The motion over a given time and its derivative by the start, exact across events.

Between events Phi' = A(t) Phi along the motion; at an event Phi is multiplied by the saltation matrix. The motion and
its events come from `simulate`; each smooth piece is integrated again together with Phi, by another implementation
(`scipy.integrate.DOP853`), and how well the two meet is kept as `mismatch`.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.limit_cycles.field import Field
from squealbox.limit_cycles.saltation import saltation
from squealbox.result import Outcome
from squealbox.transient import Method, Trajectory, simulate


@dataclass(frozen=True, eq=False)
class Flight:
    """End x (2n,) and its rate; phi (2n, 2n) = dx(T)/dx(0); the motion; mismatch [-]; least |event rate| [-]."""

    x: Any
    rate: Any
    phi: Any
    motion: Trajectory
    mismatch: float = 0.0
    transversality: float = 1.0
    together: bool = False

    @property
    def outcome(self) -> Outcome:
        """How the simulation ended."""
        return self.motion.outcome


def fly(field: Field, x: Any, duration: float, rtol: float = 1e-13, times: Any = None) -> Trajectory:
    """The motion from x over `duration` [s], with tolerances relative to the speeds in it."""
    n = field.size
    speed = max(float(np.max(np.abs(x[n:]), initial=0.0)), float(np.max(np.abs(field.V), initial=0.0)))
    method = Method("dormand-prince-8", rtol=rtol, atol=1e-2 * rtol * (speed or 1.0))
    start = (x[:n], x[n:])
    return simulate(field.system, duration, start, times, method, field.contact, width=field.width)


def flight(field: Field, x: Any, duration: float, rtol: float = 1e-13) -> Flight:
    """The motion from x over `duration` [s] and its derivative by x."""
    motion = fly(field, x, duration, rtol)
    size = 2 * field.size
    if not motion.outcome.ok:
        return Flight(np.full(size, np.nan), np.full(size, np.nan), np.full((size, size), np.nan), motion)
    states = np.hstack([motion.q, motion.qd])
    phi, mismatch, least, together = np.eye(size), 0.0, 1.0, False
    cuts = _cuts(motion) if field.contact == "exact" else []
    rows = [0, *cuts, len(motion.t) - 1]
    for piece, (i, k) in enumerate(zip(rows[:-1], rows[1:], strict=True)):
        if piece > 0:
            before, after = motion.mode[i], motion.mode[i + 1]
            jump, rate, _ = saltation(field, states[i], before, after)
            phi, least = jump @ phi, min(least, abs(rate))
            together = together or int(np.sum(before != after)) > 1
        if k > i:
            end, part = _piece(field, states[i], motion.mode[k], motion.t[k] - motion.t[i], rtol)
            mismatch = max(mismatch, _relative(field, end - states[k], states))
            phi = part @ phi
    return Flight(states[-1], field.rate(states[-1], motion.mode[-1]), phi, motion, mismatch, least, together)


def _relative(field: Field, difference: Any, states: Any) -> float:
    scaled = field.scale * difference
    return float(np.max(np.abs(scaled)) / (np.max(np.abs(field.scale * states)) + 1e-300))


def _cuts(motion: Trajectory) -> list[int]:
    """Rows of the events: a row holds the mode in which it was reached, so the next row differs."""
    changed = np.any(motion.mode[1:] != motion.mode[:-1], axis=1)
    return [int(i) for i in np.flatnonzero(changed) if i > 0]


def _piece(field: Field, x: Any, mode: Any, duration: float, rtol: float) -> tuple[Any, Any]:
    """End state and fundamental matrix of one smooth piece, integrated in states scaled to one unit."""
    from scipy.integrate import solve_ivp

    size, scale = x.size, field.scale
    ratio = scale[:, None] / scale

    def rates(_: float, y: Any) -> Any:
        state = y[:size] / scale
        a = field.jacobian(state, mode) * ratio
        return np.concatenate([field.rate(state, mode) * scale, (a @ y[size:].reshape(size, size)).ravel()])

    start = np.concatenate([x * scale, np.eye(size).ravel()])
    largest = max(float(np.max(np.abs(start[:size]))), float(np.max(np.abs(field.V), initial=0.0)))
    atol = np.concatenate([np.full(size, 0.1 * rtol * largest), np.full(size * size, 0.1 * rtol)])
    done = solve_ivp(rates, (0.0, duration), start, "DOP853", rtol=max(rtol, 3e-14), atol=atol)
    end = done.y[:, -1] if done.success else np.full(start.size, np.nan)
    return end[:size] / scale, end[size:].reshape(size, size) / ratio
