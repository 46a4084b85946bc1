"""Poincare sections and Lyapunov exponents of motions with stick and slip.

A section is a plane of the state space, or the plane where the velocity of one degree of freedom falls through zero,
that is at its maxima. The Lyapunov exponents come from the derivative of the flow, saltation matrices included,
re-orthonormalised by QR: sum log|R_ii| / time. A sticking phase forgets a direction; its exponent is minus infinity.
Sources: Benettin, Galgani, Giorgilli and Strelcyn 1980, Meccanica 15, 9-30; Mueller 1995, Chaos, Solitons and
Fractals 5, 1671-1681 (jumps at events).
"""

from typing import Any

import numpy as np

from squealbox.limit_cycles.field import Field
from squealbox.limit_cycles.variation import quick_flight
from squealbox.parameters import ParameterError
from squealbox.system import as_system
from squealbox.transient import Trajectory

LOST = 1e-13  # growth over a span below which a direction is forgotten


def maxima(motion: Trajectory, dof: int = 0) -> tuple[Any, Any]:
    """Instants [s] and displacements [m] of the maxima of one degree of freedom: its Poincare section.

    Found on the Hermite cubic of each interval of output, with an error of order 4 in it.

    >>> from squealbox import DrumBrake, simulate
    >>> len(maxima(simulate(DrumBrake(), 1e-3, times=2001))[0]) > 1
    True
    """
    t, x, v = motion.t, motion.q[:, dof], motion.qd[:, dof]
    i = np.flatnonzero((v[:-1] > 0.0) & (v[1:] <= 0.0))
    h, rise = t[i + 1] - t[i], x[i + 1] - x[i]
    a, b = h * (v[i] + v[i + 1]) - 2.0 * rise, 3.0 * rise - h * (2.0 * v[i] + v[i + 1])
    s = -h * v[i] / (b - np.sqrt(np.maximum(b * b - 3.0 * a * h * v[i], 0.0)))
    return t[i] + s * h, x[i] + s * (h * v[i] + s * (b + s * a))


def poincare_section(motion: Trajectory, normal: Any, offset: float = 0.0, *, direction: int = 1) -> tuple[Any, Any]:
    """Instants [s] and states (k, 2n) at which normal.(q, q') passes offset: a Poincare section on any plane.

    Parameters
    ----------
    motion : with enough instants of output: error of order 4 in their distance in q, of order 3 in q'
    normal : (2n,), weights of displacements and velocities; offset : where the plane lies, in the unit of the product
    direction : +1 only where the product rises through offset, -1 only where it falls, 0 both

    Raises `ParameterError` for a normal of another length, or zero. Source: Parker and Chua 1989, Practical Numerical
    Algorithms for Chaotic Systems, Ch. 2 (its method, on the Hermite cubic of each interval of output).

    >>> from squealbox import DrumBrake, simulate
    >>> motion = simulate(DrumBrake(), 1e-3, times=2001)
    >>> instants, states = poincare_section(motion, [0.0, 0.0, 1.0, 0.0], direction=-1)  # x' falls through zero
    >>> bool(abs(states[0, 2]) < 1e-12), states.shape[1]
    (True, 4)
    """
    n = motion.q.shape[1]
    weights = np.asarray(normal, dtype=float)
    if weights.shape != (2 * n,) or not np.all(np.isfinite(weights)) or not np.any(weights):
        raise ParameterError("poincare_section", "normal", normal, f"{2 * n} finite weights, not all zero")
    beside = np.hstack([motion.q, motion.qd]) @ weights - offset
    rises, falls = (beside[:-1] < 0.0) & (beside[1:] >= 0.0), (beside[:-1] > 0.0) & (beside[1:] <= 0.0)
    i = np.flatnonzero({1: rises, -1: falls}.get(int(direction), rises | falls))
    low, high = np.zeros(len(i)), np.ones(len(i))
    for _ in range(60):  # bisection, of all crossings at once
        middle = 0.5 * (low + high)
        before = (_between(motion, i, middle) @ weights - offset) * np.sign(beside[i]) > 0.0
        low, high = np.where(before, middle, low), np.where(before, high, middle)
    share = 0.5 * (low + high)
    return motion.t[i] + share * (motion.t[i + 1] - motion.t[i]), _between(motion, i, share)


def _between(motion: Trajectory, i: Any, share: Any) -> Any:
    """States (k, 2n) at shares of the intervals i: the Hermite cubic of q, and its derivative."""
    s, h = share[:, None], (motion.t[i + 1] - motion.t[i])[:, None]
    q, v, rise = motion.q[i], h * motion.qd[i], motion.q[i + 1] - motion.q[i]
    w = h * motion.qd[i + 1]
    b, a = 3.0 * rise - 2.0 * v - w, v + w - 2.0 * rise
    return np.hstack([q + s * (v + s * (b + s * a)), (v + s * (2.0 * b + s * 3.0 * a)) / h])


def lyapunov_exponents(
    design_or_system: Any, start: Any, span: float, spans: int, *, rtol: float = 1e-11, history: bool = False
) -> Any:
    """Lyapunov exponents [1/s] in falling order, shape (2n,), over `spans` stretches of `span` seconds from (q, qd).

    Parameters
    ----------
    design_or_system : with constant loads and speeds; a harmonic drive is one more degree of freedom without damping,
        coupled one way, which adds two exponents 0
    start : (q, qd), on the attractor: leave transients behind first
    span : [s] between two orthonormalisations, such as a period; spans : how many
    history : return the estimates after each span, shape (spans, 2n), which tell whether they have converged

    -inf where sticking forgets a direction. Accuracy: statistical, about 1/(spans span) for regular motions, slower,
    as 1/sqrt, for chaotic ones; NaN when a run fails. Source: as this module.

    >>> from squealbox import Contact, Coulomb, System
    >>> belt = Contact(n=[0.0], d=[1.0], t=[1.0], N0=1.0, V=0.1, law=Coulomb(0.4, 0.25))
    >>> block = System([[1.0]], [[0.0]], [[1.0]], 0.0, (belt,))
    >>> bool(abs(lyapunov_exponents(block, ([0.4], [0.0999]), 7.317597861, 40)[0]) < 0.02)
    True
    """
    field = Field(as_system(design_or_system))
    x = np.concatenate([np.asarray(part, dtype=float) for part in start])
    frame, total = np.eye(x.size), np.zeros(x.size)
    seen = np.full((spans, x.size), np.nan)
    for k in range(spans):
        flown = quick_flight(field, x, span, rtol)
        if not flown.outcome.ok:
            return seen if history else np.full(x.size, np.nan)
        x = flown.x
        frame, total = _grown(flown.phi * (field.scale[:, None] / field.scale) @ frame, total)
        seen[k] = np.sort(total / (span * (k + 1)))[::-1]
    return seen if history else seen[-1]


def _grown(moved: Any, total: Any) -> tuple[Any, Any]:
    """The frame orthonormal again, and the sums of logarithms; directions that were forgotten come last.

    A column that falls into the span of those before it grows no more. Left in its place, the arbitrary direction that
    QR puts there would take the growth of a later column, and that of a forgotten direction would be counted twice.
    """
    size = np.abs(np.diag(np.linalg.qr(moved)[1]))
    order = np.argsort(size <= LOST, kind="stable")
    frame, growth = np.linalg.qr(moved[:, order])
    size = np.abs(np.diag(growth))
    with np.errstate(divide="ignore"):
        return frame, total[order] + np.where(size > LOST, np.log(size), -np.inf)
