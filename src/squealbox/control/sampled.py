"""Loops that are held between samples: discrete multipliers by exact steps.

With one rate h = 1/sampling a step is that of `loops.held`. Growth is ln|z|/h. With loop a
broken, L(z) = h (z I - Phi)^-1 b on the unit circle says its margins of gain and phase, as L(i w) does of a continuous
one.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.control.plants import Plant
from squealbox.loops import step_matrix
from squealbox.parameters import ParameterError

GRID = 3001  # places on the unit circle looked at between two frequencies, and as many even ones
MOST_STATES = 300  # forces under way up to which further delays of several loops are looked at
FEW = 40  # samples of further delay up to which those of one loop are


def held(
    plant: Plant, rate: float | None = None, delay: np.ndarray | None = None, gains: np.ndarray | None = None
) -> Any:
    """The matrix of one step of x and the forces still under way; loops without sampling are closed continuously.

    rate [Hz], delay (a,) [s] replace those of the loops, gains (a,) [-] multiply their commands. `ParameterError` for
    several rates.
    """
    H = plant.H if gains is None else plant.H * np.asarray(gains, dtype=float)[:, None]
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
    A = plant.A + plant.B[:, ~sampled] @ H[~sampled]
    chosen = np.flatnonzero(sampled)
    return step_matrix(A, plant.B[:, chosen], H[chosen], delays[chosen], step), step


def multipliers(plant: Plant, rate: float | None = None, delay: np.ndarray | None = None) -> tuple[Any, float]:
    """The multipliers of one sample, largest first, and its length [s]."""
    matrix, step = held(plant, rate, delay)
    values = np.linalg.eigvals(matrix).astype(complex)
    return values[np.argsort(-np.abs(values))], step


def gain_margin(plant: Plant, a: int) -> tuple[float, float]:
    """Between which factors the gain of sampled loop a may lie (0 and inf where it has no bound)."""
    gain = _opened(plant, a)
    angles = _roots(lambda angle: gain(angle).imag)
    values = np.real(gain(np.r_[0.0, angles, np.pi]))
    factors = 1.0 / values[np.isfinite(values) & (values > 0.0)]
    return float(max(factors[factors < 1.0], default=0.0)), float(min(factors[factors > 1.0], default=np.inf))


def phase_margin(plant: Plant, a: int) -> float:
    """The least angle [rad] by which sampled loop a may turn; pi where its gain is nowhere 1."""
    gain = _opened(plant, a)
    angles = _roots(lambda angle: np.log(np.abs(gain(angle))))
    return float(np.min(np.abs(np.angle(gain(angles))), initial=np.pi))


def delay_margin(plant: Plant) -> float:
    """The further delay [s] of all sampled loops that takes stability away; inf where none does.

    NaN where several loops hold it for longer than `MOST_STATES` forces under way.
    """
    chosen = np.flatnonzero(plant.sampling > 0.0)
    most = FEW if len(chosen) == 1 else MOST_STATES / len(chosen)
    sampled, step = plant.sampling > 0.0, 1.0 / float(np.max(plant.sampling))

    def growth(more: float) -> float:
        return float(np.log(np.abs(multipliers(plant, delay=plant.delay + more * sampled)[0][0])))

    low, stride = 0.0, 0.3 / float(np.max(np.abs(np.linalg.eigvals(plant.closed))))
    from scipy.optimize import brentq

    while (low + stride) / step < most:
        if growth(low + stride) > 0.0:
            found: float = brentq(growth, low, low + stride, xtol=1e-15 * step, rtol=1e-13)
            return found
        low += stride
    return _one_delay_margin(plant, int(chosen[0]), low) if len(chosen) == 1 else float("nan")


def _one_delay_margin(plant: Plant, a: int, known: float) -> float:
    """Beyond a delay known to be stable, by the phase where |L| = 1: whole samples turn it by their angle."""
    from scipy.optimize import brentq

    step = 1.0 / float(plant.sampling[a])
    whole, rest = divmod(float(plant.delay[a]) / step, 1.0)

    def samples(part: float, angle: float | None = None) -> Any:
        """Angles with |L| = 1 at this part of a sample, and how many whole samples more put L on 1."""
        late = np.array(plant.delay)
        late[a] = part * step
        gain = _opened(plant.replaced(late), a)
        angles = _roots(lambda x: np.log(np.abs(gain(x))))
        if angle is not None and len(angles):
            angles = angles[[int(np.argmin(np.abs(angles - angle)))]]
        turns = np.angle(gain(angles)) % (2.0 * np.pi)
        return angles, turns / angles if len(angles) else turns

    best = np.inf
    for angle, count in zip(*samples(rest), strict=True):
        while count + rest < whole + rest + known / step:
            count += 2.0 * np.pi / angle
        for least in (np.floor(count + rest), np.floor(count + rest) - 1.0, np.floor(count + rest) + 1.0):

            def off(part: float, angle: float = angle, least: float = least) -> float:
                _, found = samples(part, angle)
                turn = 2.0 * np.pi / angle
                return float((found[0] - least + 0.5 * turn) % turn - 0.5 * turn) if len(found) else np.nan

            ends = off(0.0), off(1.0 - 1e-12)
            if ends[0] * ends[1] <= 0.0:
                part = float(brentq(off, 0.0, 1.0 - 1e-12, xtol=1e-13))
                more = (least + part - whole - rest) * step
                best = min(best, more) if more > known else best
    return best


def loop_gain(plant: Plant, a: int, frequencies: ArrayLike) -> Any:
    """L(exp(i w h)) of sampled loop a, the others closed, at frequencies [Hz]."""
    return _opened(plant, a)(2.0 * np.pi * np.asarray(frequencies, dtype=float) / np.max(plant.sampling))


def _opened(plant: Plant, a: int) -> Any:
    """L on the unit circle as a function of the angle (...)."""
    if plant.sampling[a] == 0.0:
        raise ParameterError("closed_loop", "loop", a, "a sampled loop: beside sampled ones no other has margins")
    others = np.arange(len(plant.loops)) != a
    open_, _ = held(plant, gains=1.0 * others)
    added = held(plant)[0] - open_  # of rank 1: b h
    left, sizes, right = np.linalg.svd(added)
    b, h = left[:, 0] * sizes[0], right[0]

    def gain(angle: ArrayLike) -> Any:
        z = np.exp(1j * np.asarray(angle, dtype=float))[..., None, None]
        with np.errstate(all="ignore"):
            return (h @ np.linalg.solve(z * np.eye(len(open_)) - open_, b.astype(complex)[:, None]))[..., 0]

    return gain


def _roots(function: Callable[[Any], Any]) -> Any:
    """Angles in (0, pi) at which a function of the angle changes its sign."""
    from scipy.optimize import brentq

    angles = np.union1d(np.geomspace(1e-7, 3.0, GRID), np.linspace(0.0, np.pi, GRID + 1)[1:-1])
    values = function(angles)
    places = np.flatnonzero(np.sign(values[1:]) * np.sign(values[:-1]) < 0.0)
    return np.array([brentq(function, angles[i], angles[i + 1], xtol=1e-15, rtol=1e-14) for i in places])


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
