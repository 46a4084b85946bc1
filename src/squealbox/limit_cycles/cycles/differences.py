"""The derivative of a motion from motions beside it, all in one call of the compiled step: it asks for no equation.

Central differences over h, 2h and 4h, extrapolated twice (Romberg). h is a share of the motion that falls until the
last two extrapolations agree, so that all these motions meet the same events; where no h does, beside a corner or a
grazing, `mismatch` says so.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from squealbox.limit_cycles.cycles.field import Autonomous, Field
from squealbox.limit_cycles.cycles.variation import Flight, Moved, flight, fly, method_of
from squealbox.transient import Ends

SHARES = (1e-4, 1e-5, 1e-6, 1e-7)  # of the motion
WAYS = np.array([[1.0], [-1.0], [2.0], [-2.0], [4.0], [-4.0]])
ALIKE = 1e-9  # two extrapolations, of their largest entry


def by_differences(field: Autonomous, x: np.ndarray, duration: float, rtol: float = 1e-13, *, motion: Moved) -> Flight:
    """As `variation.flight`, to some 1e-10 of the largest entry.

    motion : that of `fly`, which reached the end
    """
    states, flows = np.hstack([motion.q, motion.qd]), field.flows(method_of(field, x, rtol), duration)
    phi, mismatch = extrapolated(lambda starts: flows.to(duration, starts), x, field.scale, size_of(field, states))
    return Flight(states[-1], field.rate(states[-1], motion.mode[-1]), phi, motion, mismatch)


def size_of(field: Autonomous, states: np.ndarray) -> float:
    """The largest swing in a motion [m/s]."""
    return float(np.max(np.ptp(states, axis=0) * field.scale)) or float(np.max(np.abs(field.V), initial=0.0)) or 1.0


def extrapolated(flow: Callable[[Any], Ends], x: np.ndarray, scale: np.ndarray, size: float) -> tuple[Any, float]:
    """The derivative of an end by its start and by what else x (m,) holds behind that; and its mismatch.

    flow : leads many x (k, m) to their `Ends`; scale (m,) : what makes values of `size` of those of x
    """
    best, mismatch = np.zeros((0, 0)), np.inf
    for share in SHARES:
        steps = share * size / scale
        there = flow(x + np.kron(WAYS, np.diag(steps)))
        ends = there.states.reshape(3, 2, x.size, -1)
        slopes = [(ends[k, 0] - ends[k, 1]).T / (2.0 * 2**k * steps) for k in range(3)]
        once = [(4.0 * slopes[k] - slopes[k + 1]) / 3.0 for k in range(2)]
        phi = (16.0 * once[0] - once[1]) / 15.0
        left, largest = (np.abs(each * scale[: len(phi), None] / scale) for each in (phi - once[0], phi))
        sizes = np.maximum(np.max(largest, axis=0), np.max(largest[:, : len(phi)]))
        off = float(np.max(np.max(left, axis=0) / sizes)) if np.all(there.ok) else np.inf
        if off < mismatch or not best.size:
            best, mismatch = phi, off
        if mismatch < ALIKE:
            break
    return best, mismatch


def derived(
    field: Autonomous, x: np.ndarray, duration: float, rtol: float = 1e-13, *, motion: Moved | None = None
) -> Flight:
    """The motion and its derivative: by the equation where `field` is one, else by differences."""
    motion = fly(field, x, duration, rtol) if motion is None else motion
    if isinstance(field, Field):
        return flight(field, x, duration, rtol, motion=motion)
    return by_differences(field, x, duration, rtol, motion=motion)


def change(x: np.ndarray, duration: float, rtol: float, beside: tuple[Any, Any, float]) -> Any:
    """How the end (2n,) changes with a parameter, from fields at two of its values and their distance."""
    ends = []
    for each in beside[:2]:
        run = fly(each, x, duration, rtol, np.array([duration]))
        ends.append(np.concatenate([run.q[-1], run.qd[-1]]) if run.outcome.ok else np.full(x.size, np.nan))
    return (ends[1] - ends[0]) / beside[2]
