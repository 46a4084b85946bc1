"""Where one brake loses its stability first, narrow windows included; tunings at which such a window just closes.

Where the state matrix is A0 + x A1, two eigenvalues add up to zero just where

    det P' (A I + I A) P = 0      on the antisymmetric products P = (e_i e_j - e_j e_i)/sqrt 2

which is linear in A: all places at which stability may change are generalised eigenvalues x (bialternate product;
Govaerts 2000, Numerical Methods for Bifurcations of Dynamical Equilibria, ch. 4). A window closes where two of them
meet. Other brakes are scanned.
"""

from functools import cache
from typing import Any

import numpy as np

from squealbox.design import Design
from squealbox.stability import growth_of, steady_sliding

MOST_ROWS = 12  # of a state matrix, whose products are 66 then
NEAR = 2e-3  # share of a margin by which the window below it may lie above the margin of another tuning
REAL = 1e-6  # imaginary part below which a place is one; beside a window that closes it is the root of round-off


def first_loss(design: Design, parameter: str, bounds: tuple[float, float]) -> float:
    """The lowest value of the parameter at which one brake loses its stability, narrow windows included; or the end.

    Where the growth rate comes near zero and turns back it is looked at more closely, ever again.
    """
    low, high = bounds
    places = changes(design, parameter, bounds)
    if places is not None:
        known = np.sort(places.real[np.abs(places.imag) < REAL])
        ends = np.concatenate([[0.0], known[(known > 0.0) & (known < 1.0)], [1.0]])
        growing = growth_of(design.replace({parameter: low + (high - low) * 0.5 * (ends[1:] + ends[:-1])})) > 0.0
        return low + (high - low) * float(ends[int(np.argmax(growing))]) if np.any(growing) else high
    values = np.linspace(low, high, 97)
    growth = growth_of(design.replace({parameter: values}))
    for _ in range(5):
        first = int(np.argmax(growth > 0.0)) if np.any(growth > 0.0) else len(values)
        inner = np.flatnonzero((growth[1:-1] >= growth[:-2]) & (growth[1:-1] >= growth[2:])) + 1
        swing = np.maximum(growth[inner] - growth[inner - 1], growth[inner] - growth[inner + 1])
        near = inner[(inner < first) & (growth[inner] > -2.0 * swing - 1e-12)]
        more = [np.linspace(values[k - 1], values[k + 1], 11)[1:-1] for k in near]
        if not more:
            break
        values, growth = _with(design, parameter, values, growth, np.concatenate(more))
    if not np.any(growth > 0.0):
        return high
    first = int(np.argmax(growth > 0.0))
    if first == 0:
        return low
    from scipy.optimize import brentq

    found: float = brentq(
        lambda x: float(growth_of(design.replace({parameter: x}))), values[first - 1], values[first], xtol=1e-13 * high
    )
    return found


def changes(design: Design, parameter: str, bounds: tuple[float, float]) -> Any:
    """Complex x (k,), of low + x (high - low), at which stability may change; None where A is not linear in it."""
    from scipy.linalg import LinAlgError, eigvals

    low, high = bounds
    about = steady_sliding(design.replace({parameter: np.array([low, 0.5 * (low + high), high])}))
    M, C, K = (np.broadcast_to(x, about.K.shape) for x in (about.M, about.C, about.K))
    n = M.shape[-1]
    if 2 * n > MOST_ROWS or not np.all(np.isfinite(K)) or not np.all(np.isfinite(C)):
        return None
    rate = np.sqrt(np.max(np.abs(K)) / (np.max(np.abs(M)) or 1.0))
    try:
        stiffness, damping = np.linalg.solve(M, K) / rate**2, np.linalg.solve(M, C) / rate
    except LinAlgError:  # rows without mass
        return None
    A = np.zeros((3, 2 * n, 2 * n))
    A[:, :n, n:], A[:, n:, :n], A[:, n:, n:] = np.eye(n), -stiffness, -damping
    if np.max(np.abs(A[1] - 0.5 * (A[0] + A[2]))) > 1e-13 * np.max(np.abs(A)):
        return None
    P, one = _products(2 * n), np.eye(2 * n)
    first, more = (P.T @ (np.kron(x, one) + np.kron(one, x)) @ P for x in (A[0], A[2] - A[0]))
    found = np.concatenate([eigvals(first, -more), eigvals(A[0], A[0] - A[2])])
    return found[np.isfinite(found)]


@cache
def _products(size: int) -> Any:
    pairs = [(i, j) for i in range(size) for j in range(i)]
    P = np.zeros((size * size, len(pairs)))
    for k, (i, j) in enumerate(pairs):
        P[i * size + j, k], P[j * size + i, k] = np.sqrt(0.5), -np.sqrt(0.5)
    return P


def _with(design: Design, parameter: str, values: np.ndarray, growth: np.ndarray, more: Any) -> tuple[Any, Any]:
    every = np.append(values, more)
    rates = np.append(growth, growth_of(design.replace({parameter: more})))
    every, places = np.unique(every, return_index=True)
    return every, rates[places]


def at_the_window(
    start: Design, near: tuple[float, float, float], parameter: str, bounds: tuple[float, float]
) -> list[tuple[float, float, float]]:
    """The best of the tunings at which the window of instability below the margin just closes.

    The margin as a function of the tuning ends at that edge, which a search only comes near: for each damping the
    frequency is solved for, at which the ends of the window meet, and the damping is searched.
    """
    from scipy.optimize import brentq, minimize_scalar

    value, frequency, damping = near
    known = (1.0 + NEAR) * (-value - bounds[0]) / (bounds[1] - bounds[0])

    def window(f: float, z: float) -> float:
        """(x1 - x2)^2 of the ends of the window nearest to closing, as shares of the bounds; NaN without one."""
        places = changes(start.replace({"frequency": f, "damping": z}), parameter, bounds)
        if places is None:
            return np.nan
        below = places[(places.real > 0.0) & (places.real < known)]
        apart = np.abs(below.imag) >= REAL
        squares = np.concatenate([np.diff(np.sort(below.real[~apart])) ** 2, -4.0 * below.imag[apart] ** 2])
        return float(squares[np.argmin(np.abs(squares))]) if len(squares) else np.nan

    def margin(log_z: float) -> tuple[float, float, float]:
        z, best = float(np.exp(log_z)), (0.0, frequency, damping)
        tried = frequency * (1.0 + np.linspace(-4e-4, 4e-4, 17))
        heights = np.array([window(float(f), z) for f in tried])
        for c in np.flatnonzero(heights[1:] * heights[:-1] < 0.0):
            f = float(brentq(lambda x: window(x, z), tried[c], tried[c + 1], xtol=1e-15 * frequency))
            closed = f + 1e-11 * frequency * (1.0 if heights[c + 1] < 0.0 else -1.0)
            there = start.replace({"frequency": closed, "damping": z})
            best = min(best, (-first_loss(there, parameter, bounds), closed, z))
        return best

    found = minimize_scalar(
        lambda x: margin(x)[0], bounds=(np.log(damping) - 0.05, np.log(damping) + 0.05), method="bounded",
        options={"xatol": 1e-7, "maxiter": 30},
    )  # fmt: skip
    best = margin(float(found.x))
    return [best] if best[0] < 0.0 else []
