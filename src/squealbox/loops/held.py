"""Commands held between samples: one exact step of h, and the equation of first order that has its multipliers.

With u_a held over [k h + T_a, (k + 1) h + T_a) and T_a = (l - 1) h + r, 0 < r <= h,

    x((k + 1) h) = exp(A h) x + sum_a [int_{h - r}^{h} exp(A s) ds B_a u_a(k - l)
                                       + int_0^{h - r} exp(A s) ds B_a u_a(k - l + 1)]

is exact for any delay (Astrom and Wittenmark 1997, Computer-Controlled Systems, ch. 3). Its multipliers z grow at
ln(z)/h, the eigenvalues of C x' + K x = 0 with K = -ln(Phi)/h; what dies within one sample (z = 0) has none.
"""

from typing import Any

import numpy as np

GONE = 1e-13  # of the largest multiplier: less is none


def highest_rate(system: Any) -> float:
    """Highest angular frequency [rad/s] of what has mass, without contacts and loops; 0 where nothing has."""
    heavy = np.flatnonzero(np.any(system.M != 0.0, axis=-1))
    rows = np.ix_(heavy, heavy)
    squares = np.linalg.eigvals(np.linalg.lstsq(system.M[rows], system.K[rows], rcond=None)[0])
    return float(np.sqrt(np.max(np.abs(squares), initial=0.0)))


def first_order(mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray) -> tuple[Any, Any, Any, Any]:
    """A, the rows that read q and q' from x = (q, q_m'), and what a force (n,) does to x'."""
    n = len(mass)
    light = ~np.any(mass != 0.0, axis=-1)
    z, m = np.flatnonzero(light), np.flatnonzero(~light)
    velocity, into_v = np.zeros((n, n + m.size)), np.zeros((n, n))
    velocity[m, n + np.arange(m.size)] = 1.0
    if z.size:
        own = np.linalg.inv(damping[np.ix_(z, z)])
        velocity[z, :n] = -own @ stiffness[z, :]
        velocity[z, n:] = -own @ damping[np.ix_(z, m)]
        into_v[z[:, None], z] = own
    displacement = np.hstack([np.eye(n), np.zeros((n, m.size))])
    inverse = np.linalg.inv(mass[np.ix_(m, m)])
    acceleration = -inverse @ (stiffness[m, :] @ displacement + damping[m, :] @ velocity)
    force = inverse @ (np.eye(n)[m, :] - damping[np.ix_(m, z)] @ into_v[z, :])
    return np.vstack([velocity, acceleration]), displacement, velocity, np.vstack([into_v, force])


def step_matrix(A: np.ndarray, B: np.ndarray, H: np.ndarray, delays: np.ndarray, step: float) -> Any:
    """One step of x and the forces still under way, of x' = A x + B u with u = H x late by delays (a,)."""
    d = len(A)
    behind = [max(int(np.floor(delays[a] / step + 1e-9)), 0) for a in range(len(delays))]  # whole samples
    rest = [float(delay) - l * step for delay, l in zip(delays, behind, strict=True)]
    rest = [0.0 if abs(r) < 1e-9 * step else r for r in rest]
    depth = [l + (r > 0.0) for l, r in zip(behind, rest, strict=True)]
    size = d + sum(depth)
    matrix = np.zeros((size, size))
    matrix[:d, :d], wholes = _flow(A, B, step)
    lates = {r: _flow(A, B, step - r)[1] for r in set(rest) if r != 0.0}
    at = d
    for a, (l, r, kept) in enumerate(zip(behind, rest, depth, strict=True)):
        row, whole = H[a], wholes[:, [a]]
        late = lates[r][:, [a]] if r else whole  # held over the last h - r of the step
        early = whole - late
        places = [None, *range(at, at + kept)]  # u(k), u(k - 1), ...
        for back, effect in ((l, late), (l + 1, early)):
            if not np.any(effect):
                continue
            where = places[back] if back < len(places) else None
            if back == 0:
                matrix[:d, :d] += effect @ row[None]
            elif where is not None:
                matrix[:d, where] += effect[:, 0]
        if kept:
            matrix[at, :d] = row
            for i in range(1, kept):
                matrix[at + i, at + i - 1] = 1.0
        at += kept
    return matrix


def continued(matrix: np.ndarray, step: float) -> tuple[Any, Any]:
    """C and K of rows of first order whose eigenvalues are ln(z)/h, the states of the step in front.

    A negative multiplier is a pair at half the rate, +- i pi/h, on the rows behind.
    """
    values, right = np.linalg.eig(matrix)
    right = right / np.linalg.norm(right, axis=0)
    z, left, size = values.astype(complex), np.linalg.inv(right), np.abs(values)
    kept = size > GONE * max(float(np.max(size, initial=0.0)), 1e-300)
    turning = kept & (z.real < 0.0) & (np.abs(z.imag) <= 1e-10 * size)
    rate = np.log(np.where(kept, np.where(turning, -z, z), 1.0)) / step
    P, Q, F, G = (
        ((right * part) @ left).real for part in (1.0 * kept, 1.0 * turning, rate, np.where(turning, rate, 0.0))
    )
    one, none, turn = np.eye(len(matrix)), np.zeros(matrix.shape), np.pi / step
    C = np.block([[P, none], [none, Q]])
    return C, -np.block([[F - (one - P), -turn * Q], [turn * Q, G - (one - Q)]])


def _flow(A: np.ndarray, B: np.ndarray, time: float) -> tuple[Any, Any]:
    """exp(A t) and int_0^t exp(A s) ds B."""
    from scipy.linalg import expm

    d, m = len(A), B.shape[1]
    big = np.zeros((d + m, d + m))
    big[:d, :d], big[:d, d:] = A, B
    found = expm(big * time)
    return found[:d, :d], found[:d, d:]
