"""The modes of a reduced brake in its band, without the whole spectrum: a friction value of a sweep costs little.

In coordinates that are undamped modes, the slow ones l carry the modes of the band; the fast ones h follow nearly
statically. Two-sided static condensation gives a problem in l alone, with eigenvalues lambda_j and modes u_j, w_j, and

    x_h -= Q_hh(lambda_0)^-1 [Q x]_h
    x -= R sum_{j != k} u_j w_j^H L' Q x / (lambda - lambda_j)

with R and L the columns of the condensation and lambda the two-sided Rayleigh quotient leads from it to the modes of
the whole, all of the band at once. What does not settle to round-off is not given out: the whole spectrum is then
computed.
"""

from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from squealbox.fe.pencil import MOST_DAMPED, vibrating
from squealbox.fe.small import Small

SLOW = 2.2  # times the end of the band: coordinates above it are fast
PASSES = 40
GROUPS = 3  # of neighbouring modes, whose fast coordinates are solved for with one factor
SETTLED, ROUGH = 1e-9, 1e-7  # of |lambda|: last change of an eigenvalue; what is left of it is a thirtieth or less
RESIDUAL = 1e-4  # of |K x|: residual of a shape; its eigenvalue is better by the same factor again


class Pairs(NamedTuple):
    """Eigenvalues (k,) with Im > 0, rising; right and left (m, k) with w^H Q' u = 1; condition numbers (k,)."""

    values: Any
    right: Any
    left: Any
    condition: Any


class Condensed(NamedTuple):
    """The problem in the slow coordinates `slow` alone, with the `fast` ones following nearly statically.

    right and left (m, l) lead from the slow coordinates to all, hold is the factor of K of the fast ones.
    """

    small: Small
    right: Any
    left: Any
    fast: Any
    hold: Any


def condensed(small: Small, high: float) -> Condensed | None:
    """The slow part of a problem in undamped modes for a band up to `high` [Hz]; None where all are slow, or none."""
    mass, stiffness = small.M, small.K
    fast = np.diag(stiffness) > (SLOW * 2.0 * np.pi * high) ** 2 * np.diag(mass)
    l, h = np.flatnonzero(~fast), np.flatnonzero(fast)
    if len(l) == 0 or len(h) == 0:
        return None
    hold = lu_factor(stiffness[np.ix_(h, h)])
    right, left = np.zeros((len(mass), len(l))), np.zeros((len(mass), len(l)))
    right[l], left[l] = np.eye(len(l)), np.eye(len(l))
    right[h] = -lu_solve(hold, stiffness[np.ix_(h, l)])
    left[h] = -lu_solve(hold, stiffness[np.ix_(l, h)].T, trans=1)
    return Condensed(Small(*(left.T @ (part @ right) for part in (mass, small.C, stiffness))), right, left, h, hold)


def band_pairs(small: Small, band: tuple[float, float], *, rough: bool = False) -> Pairs | None:
    """The modes with Im in the band (f1, f2) [Hz]; None where they did not settle.

    `rough` asks for eigenvalues to some 1e-8 of their size alone, and nothing of the shapes.
    """
    mass, damping, stiffness = small.M, small.C, small.K
    low, high = (2.0 * np.pi * f for f in band)
    found = condensed(small, band[1])
    if found is None:
        return None
    slow, right, left, h, _ = found
    every, u, w, _ = slow.eigen()
    w = w / np.conj(np.sum(np.conj(w) * (2.0 * every * (slow.M @ u) + slow.C @ u), axis=0))
    light = np.abs(every.real) < 1.2 * MOST_DAMPED * np.abs(every)
    kept = np.flatnonzero((every.imag > 0.97 * low) & (every.imag < 1.03 * high) & light)
    kept = kept[np.argsort(every[kept].imag)]
    values, x, y = every[kept], right @ u[:, kept], left @ w[:, kept]
    near = every[:, None] - values  # (2 l, k); its zeros are the modes themselves
    near[kept, np.arange(len(kept))] = np.inf
    u, w, near = _single(u), _single(w), _single(near)  # corrections: single precision halves their price, costs none
    right, left = right.astype(np.float32), left.astype(np.float32)
    back_u, back_w = np.conj(u).T, np.conj(w).T
    both, back = np.concatenate([stiffness, damping]), np.concatenate([stiffness.T, damping.T])
    holds = _holds(small, h, values)
    unit = bool(np.max(np.abs(mass - np.eye(len(mass)))) < 1e-9)
    settled = False
    for made in range(PASSES):
        missed, pulled, slope = _applied(both, None if unit else mass, values, x)
        missed_left, pulled_left, _ = _applied(back, None if unit else mass.T, np.conj(values), y)
        slope = np.sum(np.conj(y) * slope, axis=0)
        step = np.sum(np.conj(y) * missed, axis=0) / slope
        moved = np.abs(step) / np.abs(values)
        if not np.all(np.isfinite(moved)):
            return None
        off = max(
            float(np.max(np.linalg.norm(rest, axis=0) / np.linalg.norm(whole, axis=0), initial=0.0))
            for rest, whole in ((missed, pulled), (missed_left, pulled_left))
        )
        values = values - step
        # the slow problem's own quotients move by nothing at first, whatever is left
        settled = bool(made > 1 and np.all(moved <= ROUGH) if rough else np.all(moved <= SETTLED) and off <= RESIDUAL)
        if settled:
            break
        rest, rest_left = _single(missed), _single(missed_left)
        for columns, held in holds:
            x[np.ix_(h, columns)] -= lu_solve(held, rest[np.ix_(h, columns)], check_finite=False)
            y[np.ix_(h, columns)] -= lu_solve(held, rest_left[np.ix_(h, columns)], 2, check_finite=False)
        x += _times(right, u @ ((back_w @ _times(left.T, rest)) / near))
        y += _times(left, w @ ((back_u @ _times(right.T, rest_left)) / np.conj(near)))
    if not settled:
        return None
    inside = np.flatnonzero((values.imag >= low) & (values.imag <= high) & vibrating(values))
    inside = inside[np.argsort(values[inside].imag, kind="stable")]
    values, x, y = values[inside], x[:, inside], y[:, inside]
    x = x / np.linalg.norm(x, axis=0)
    y = y / np.conj(np.sum(np.conj(y) * (2.0 * values * (mass @ x) + damping @ x), axis=0))
    # (u, lambda u / rate) and its dual, in the units of `Small.eigen`
    rate = np.sqrt(np.max(np.abs(stiffness)) / np.max(np.abs(mass)))
    length = np.linalg.norm(x, axis=0) * np.sqrt(1.0 + np.abs(values / rate) ** 2)
    sizes = np.linalg.norm(stiffness.T @ y / values.conj(), axis=0), np.linalg.norm(rate * (mass @ y), axis=0)
    dual = np.hypot(*sizes)
    return Pairs(values, x, y, length * dual)


def _applied(both: np.ndarray, mass: np.ndarray | None, values: np.ndarray, x: np.ndarray) -> tuple[Any, Any, Any]:
    """Q(lambda) x, K x and Q'(lambda) x from K and C stacked and M, None for the unit matrix."""
    product = _times(both, x)
    pulled, damped, heavy = product[: len(x)], product[len(x) :], (x if mass is None else _times(mass, x)) * values
    return pulled + (damped + heavy) * values, pulled, damped + 2.0 * heavy


def _single(x: np.ndarray) -> Any:
    return x.astype(np.complex64)


def _holds(small: Small, fast: np.ndarray, values: np.ndarray) -> list[tuple[Any, Any]]:
    """Columns of `values` that lie near each other, and the factor of Q of the fast coordinates in their middle."""
    inside = np.ix_(fast, fast)
    mass, damping, stiffness = (matrix[inside] for matrix in (small.M, small.C, small.K))
    found = []
    for columns in np.array_split(np.argsort(values.imag), min(GROUPS, len(values))):
        rate = 1j * np.sqrt(0.5 * (np.min(values.imag[columns]) ** 2 + np.max(values.imag[columns]) ** 2))
        found.append((columns, lu_factor(_single(stiffness + rate * damping + rate**2 * mass))))
    return found


def _times(matrix: np.ndarray, x: np.ndarray) -> Any:
    """A x for a real A and a complex x (m, k), as one real product."""
    count = x.shape[1]
    both = matrix @ np.concatenate([x.real, x.imag], axis=1)
    return both[:, :count] + 1j * both[:, count:]
