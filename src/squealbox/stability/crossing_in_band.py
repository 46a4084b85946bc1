"""Where the modes of a reduced brake cross zero growth between two values of a scan, as the full brake would have it.

The modes of both ends are paired by nearness of their eigenvalues, and each that changes its sign is followed to its
crossing. There the estimate of what the reduction misses of that very eigenvalue (`ReducedBrake.missed`) moves the
value, and what it says in the end is the value's doubt: a reduction is checked at a few points of its range, and
between them it may be off by many times what it promises there.
"""

from typing import Any

import numpy as np

from squealbox.stability import ComplexModes
from squealbox.stability.eigenvalues import complex_modes
from squealbox.stability.family import steady_sliding
from squealbox.stability.in_band import IDLE, eigenvalues_in_band
from squealbox.stability.mechanisms import mechanism_at
from squealbox.stability.scan import Scan

CLOSE, ENOUGH = 1e-3, 1e-2  # shares of a step of the scan at which the corrections take over, and at which they end
APART = 0.02  # of an eigenvalue: so far apart, two are as little alike as two shapes that have nothing in common
MOST = 30  # values tried
CORRECTIONS = 3  # of a value by the estimate of the reduction's error
SHORT = 4.0  # of the estimate: where other contacts are open than at the reference it may be a third of what is missed


def crossings_between(found: Scan, i: int) -> list[dict[str, Any]]:
    """What `onset` tells of every crossing between the values i and i + 1 of a `Scan`, in rising order."""
    low, high = float(found.values[i]), float(found.values[i + 1])
    before, after = (complex_modes(found.family.one(value), found.family.time) for value in (low, high))
    rows = [_row(found, low, high, *pair) for pair in _changing(before, after)]
    count = int(np.sum(found.functions[i] > 0.0))
    for row in sorted(rows, key=lambda row: row["value"]):
        row["unstable_below"] = count
        count += 1 if row["direction"] == "destabilising" else -1
        row["unstable_above"] = count
    return sorted(rows, key=lambda row: row["value"])


def _changing(before: ComplexModes, after: ComplexModes) -> list[tuple[complex, complex]]:
    """The pairs of eigenvalues of both ends of which one grows and the other does not.

    Two modes are alike by their eigenvalues and by |2 lambda w^H u|, which is 1 for one and the same: a reduced brake's
    coordinates have V' M V = I.
    """
    from scipy.optimize import linear_sum_assignment

    (a, b), n, m = (x.eigenvalues for x in (before, after)), before.eigenvalues.size // 2, after.eigenvalues.size // 2
    likeness = np.abs(2.0 * a[:n, None] * (before.left[:, :n].conj().T @ after.right[:, :m]))
    apart = np.abs(a[:n, None] - b[:m]) / (APART * np.abs(a[:n, None]))
    pairs = zip(*linear_sum_assignment(apart - np.minimum(likeness, 1.0)), strict=True)
    every = [(complex(a[i]), complex(b[j])) for i, j in pairs]
    return [(a, b) for a, b in every if (a.real > IDLE * abs(a)) != (b.real > IDLE * abs(b))]


def _row(found: Scan, low: float, high: float, before: complex, after: complex) -> dict[str, Any]:
    value, eigenvalue, slope = _followed(found, low, high, before, after)
    there, modes, place, off = _with_error(found, value, eigenvalue)
    for _ in range(CORRECTIONS):
        last, left = complex(modes.eigenvalues[place]), value
        value = left - (last.real + (off or 0.0).real) / slope
        if not low < value < high:  # it jumps here, as a contact opens: no slope leads further
            value = left
            break
        there, modes, place, off = _with_error(found, value, last)
        secant = (modes.growth_rate[place] - last.real) / (value - left) if value != left else 0.0
        slope = secant if secant * slope > 0.0 else slope
        if abs(value - left) <= ENOUGH * (high - low):
            break
    eigenvalue = complex(modes.eigenvalues[place])
    rate, band, time = abs(eigenvalue.imag), found.family.band, found.family.time
    rank = int(np.sum(modes.growth_rate[: len(modes.eigenvalues) // 2] > eigenvalue.real))
    why = mechanism_at(steady_sliding(there, time), rate, rank=rank, band=band)
    missed = there.error if off is None else SHORT * abs(off)
    doubt = missed + abs(eigenvalue.real + (off or 0.0).real) + IDLE * rate
    return {
        "value": value,
        "uncertainty": float(min(doubt / abs(slope), high - low)),
        "eigenvalue": eigenvalue,
        "shape": modes.right[:, place],
        "direction": "destabilising" if after.real > before.real else "stabilising",
        "mechanism": why.name,
        "base": why.base,
        "circulation": why.circulation,
        "slope": why.slope,
    }


def _followed(found: Scan, low: float, high: float, before: complex, after: complex) -> tuple[float, complex, float]:
    """Value at which a mode known at both ends neither grows nor decays, its eigenvalue and the slope of its growth."""
    known = [(low, before), (high, after)]
    ends, stays = [(low, before.real), (high, after.real)], -1
    for _ in range(MOST):
        (a, first), (b, last) = ends
        value = a + (b - a) * first / (first - last)
        (x, one), (z, other) = sorted(known, key=lambda point: abs(point[0] - value))[:2]
        every = _eigenvalues(found, value)
        there = complex(every[np.argmin(np.abs(every - (one + (other - one) * (value - x) / (z - x))))])
        known.append((value, there))
        side = int((there.real > 0.0) == (last > 0.0))  # the end it takes the place of
        again, stays = side == stays, side
        near = min(abs(value - point) for point, _ in known[:-1])
        ends[side] = (value, there.real)
        if again:  # Illinois: an end that stays twice counts half
            ends[1 - side] = (ends[1 - side][0], 0.5 * ends[1 - side][1])
        if there.real == 0.0 or near <= CLOSE * (high - low):
            break
    (x, one), (z, other) = sorted(known, key=lambda point: abs(point[0] - value))[:2]
    slope, whole = (one.real - other.real) / (x - z), (after.real - before.real) / (high - low)
    return value, known[-1][1], slope if slope * whole > 0.0 else whole


def _eigenvalues(found: Scan, value: float) -> Any:
    return eigenvalues_in_band(found.family.one(value), found.family.time)


def _with_error(found: Scan, value: float, eigenvalue: complex) -> tuple[Any, Any, int, complex | None]:
    """The reduced brake at a value, its modes, the one nearest to an eigenvalue, and what this lacks where known."""
    there = found.family.one(value)
    modes = complex_modes(there, found.family.time)
    half = modes.eigenvalues[: len(modes.eigenvalues) // 2]
    place = int(np.nanargmin(np.abs(half - eigenvalue)))
    off = there.missed(complex(half[place]), modes.right[:, place], modes.left[:, place])
    return there, modes, place, off
