"""The modes of a reduced brake in its band, without the whole spectrum: a friction value of a sweep costs little.

In coordinates that are undamped modes, the slow ones l carry the modes of the band; the fast ones h follow nearly
statically. Two-sided static condensation gives a problem in l alone, with eigenvalues lambda_j and modes u_j, w_j, and

    x_h = -K_hh^-1 [K_hl x_l + lambda C x + lambda^2 M x]_h
    x_l -= sum_{j != k} u_j w_j^H [Q x]_l / (lambda - lambda_j)

with lambda the two-sided Rayleigh quotient leads from it to the modes of the whole, all of the band at once. What does
not settle to round-off is not given out: the whole spectrum is then computed.
"""

from typing import Any, NamedTuple

import numpy as np
from scipy.linalg import lu_factor, lu_solve

from squealbox.fe.pencil import MOST_DAMPED, vibrating
from squealbox.fe.small import Small

SLOW = 2.2  # times the end of the band: coordinates above it are fast
PASSES = 12
INNER = 2  # static solves for the fast coordinates in each pass
SETTLED = 1e-11  # of |lambda|: change of an eigenvalue at which it has settled
RESIDUAL = 1e-5  # of |K x|: residual of a shape; its eigenvalue is better by the same factor again


class Pairs(NamedTuple):
    """Eigenvalues (k,) with Im > 0, rising; right and left (m, k) with w^H Q' u = 1; condition numbers (k,)."""

    values: Any
    right: Any
    left: Any
    condition: Any


def band_pairs(small: Small, band: tuple[float, float]) -> Pairs | None:
    """The modes with Im in the band (f1, f2) [Hz]; None where they did not settle."""
    mass, damping, stiffness = small.M, small.C, small.K
    low, high = (2.0 * np.pi * f for f in band)
    fast = np.diag(stiffness) > (SLOW * high) ** 2 * np.diag(mass)
    l, h = np.flatnonzero(~fast), np.flatnonzero(fast)
    if len(l) == 0 or len(h) == 0:
        return None
    hold = lu_factor(stiffness[np.ix_(h, h)])
    right, left = np.zeros((len(mass), len(l))), np.zeros((len(mass), len(l)))
    right[l], left[l] = np.eye(len(l)), np.eye(len(l))
    right[h] = -lu_solve(hold, stiffness[np.ix_(h, l)])
    left[h] = -lu_solve(hold, stiffness[np.ix_(l, h)].T, trans=1)
    slow = Small(*(left.T @ (matrix @ right) for matrix in (mass, damping, stiffness)))
    every, u, w, _ = slow.eigen()
    w = w / np.conj(np.sum(np.conj(w) * (2.0 * every * (slow.M @ u) + slow.C @ u), axis=0))
    light = np.abs(every.real) < 1.2 * MOST_DAMPED * np.abs(every)
    kept = np.flatnonzero((every.imag > 0.97 * low) & (every.imag < 1.03 * high) & light)
    kept = kept[np.argsort(every[kept].imag)]
    values, x, y = every[kept], right @ u[:, kept], left @ w[:, kept]
    near = every[:, None] - values  # (2 l, k); its zeros are the modes themselves
    near[kept, np.arange(len(kept))] = np.inf
    over = Small(*(matrix[h] for matrix in (mass, damping, stiffness)))
    under = Small(*(matrix[:, h] for matrix in (mass, damping, stiffness)))
    settled = False
    for _pass in range(PASSES):
        for _ in range(INNER):
            x[h] -= lu_solve(hold, _applied(over, values, x))
            y[h] -= lu_solve(hold, _back(under, values, y), trans=1)
        missed, missed_left = _applied(small, values, x), _back(small, values, y)
        x[l] += u @ ((np.conj(w).T @ missed[l]) / near)
        y[l] += w @ ((np.conj(u).T @ missed_left[l]) / np.conj(near))
        slope = np.sum(np.conj(y) * (2.0 * values * (mass @ x) + damping @ x), axis=0)
        step = np.sum(np.conj(y) * _applied(small, values, x), axis=0) / slope
        values = values - step
        moved = np.abs(step) / np.abs(values)
        if not np.all(np.isfinite(moved)):
            return None
        off = (
            np.linalg.norm(missed, axis=0) / _size(stiffness, x),
            np.linalg.norm(missed_left, axis=0) / _size(stiffness.T, y),
        )
        settled = bool(np.all(moved <= SETTLED) and np.max(off, initial=0.0) <= RESIDUAL)
        if settled:
            break
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


def _applied(small: Small, values: Any, x: Any) -> Any:
    return _times(small.K, x) + _times(small.C, x) * values + _times(small.M, x) * values**2


def _back(small: Small, values: Any, y: Any) -> Any:
    back = np.conj(values)
    return _times(small.K.T, y) + _times(small.C.T, y) * back + _times(small.M.T, y) * back**2


def _size(matrix: Any, x: Any) -> Any:
    return np.linalg.norm(_times(matrix, x), axis=0)


def _times(matrix: Any, x: Any) -> Any:
    """A x for a real A and a complex x (m, k), as one real product."""
    count = x.shape[1]
    both = matrix @ np.concatenate([x.real, x.imag], axis=1)
    return both[:, :count] + 1j * both[:, count:]
