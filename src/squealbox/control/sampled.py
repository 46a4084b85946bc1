"""Loops that are held between samples: discrete multipliers by exact steps.

With one rate h = 1/sampling, u_a held over [k h + T_a, (k + 1) h + T_a) and T_a = (l - 1) h + r, 0 < r <= h,

    x((k + 1) h) = exp(A h) x + sum_a [int_{h - r}^{h} exp(A s) ds B_a u_a(k - l)
                                       + int_0^{h - r} exp(A s) ds B_a u_a(k - l + 1)]

is exact for any delay (Astrom and Wittenmark 1997, Computer-Controlled Systems, ch. 3). Growth is ln|z|/h.
"""

from typing import Any

import numpy as np

from squealbox.control.plant import Plant
from squealbox.parameters import ParameterError


def held(plant: Plant, rate: float | None = None, delay: Any = None) -> Any:
    """The matrix of one step of x and the forces still under way; loops without sampling are closed continuously.

    rate [Hz] and delay (a,) [s] replace those of the loops. `ParameterError` for several rates.
    """
    sampled = plant.sampling > 0.0
    if rate is None:
        rates = sorted(set(plant.sampling[sampled].tolist()))
        if len(rates) > 1:
            raise ParameterError("closed_loop", "sampling", rates, "one rate for all sampled loops")
        rate = float(rates[0])
    else:
        sampled = np.ones(len(sampled), dtype=bool)
    delays = np.asarray(plant.delay if delay is None else delay, dtype=float)
    if np.any(delays[~sampled] > 0.0):
        raise ParameterError("closed_loop", "delay", float(delays[~sampled].max()), "0 beside sampled loops")
    step = 1.0 / rate
    A = plant.A + plant.B[:, ~sampled] @ plant.H[~sampled]
    d, chosen = len(A), np.flatnonzero(sampled)
    behind = [max(int(np.floor(delays[a] / step + 1e-9)), 0) for a in chosen]  # whole samples
    rest = [delays[a] - l * step for a, l in zip(chosen, behind, strict=True)]
    rest = [0.0 if abs(r) < 1e-9 * step else r for r in rest]
    depth = [l + (r > 0.0) for l, r in zip(behind, rest, strict=True)]
    size = d + sum(depth)
    matrix = np.zeros((size, size))
    matrix[:d, :d] = _flow(A, plant.B[:, :0], step)[0]
    at = d
    for a, l, r, kept in zip(chosen, behind, rest, depth, strict=True):
        column, row = plant.B[:, [a]], plant.H[a]
        _, late = _flow(A, column, step - r)  # held over the last h - r of the step
        _, whole = _flow(A, column, step)
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
    return matrix, step


def multipliers(plant: Plant, rate: float | None = None, delay: Any = None) -> tuple[Any, float]:
    """The multipliers of one sample, largest first, and its length [s]."""
    matrix, step = held(plant, rate, delay)
    values = np.linalg.eigvals(matrix).astype(complex)
    return values[np.argsort(-np.abs(values))], step


def aliased(plant: Plant) -> tuple[float, float] | None:
    """The highest frequency of an oscillating mode above half the sampling rate, and what it is taken for [Hz]."""
    rates = plant.sampling[plant.sampling > 0.0]
    if not len(rates):
        return None
    rate = float(np.min(rates))
    own = np.linalg.eigvals(plant.A)
    frequencies = np.abs(own.imag[(own.imag > 0.0) & (own.real > -np.abs(own.imag))]) / (2.0 * np.pi)
    above = frequencies[frequencies > 0.5 * rate]
    if not len(above):
        return None
    worst = float(np.max(above))
    return worst, abs(worst - rate * round(worst / rate))


def _flow(A: Any, B: Any, time: float) -> tuple[Any, Any]:
    """exp(A t) and int_0^t exp(A s) ds B."""
    from scipy.linalg import expm

    d, m = len(A), B.shape[1]
    big = np.zeros((d + m, d + m))
    big[:d, :d], big[:d, d:] = A, B
    found = expm(big * time)
    return found[:d, :d], found[:d, d:]
