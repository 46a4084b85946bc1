"""Where one brake loses its stability first, narrow windows included; tunings at which such a window just closes."""

from typing import Any

import numpy as np

from squealbox.stability.family import steady_sliding
from squealbox.stability.spectra import largest_growth


def growth_of(design: Any) -> Any:
    """The largest growth rate [1/s] of a design of arrays; inf without steady sliding."""
    growth: Any = largest_growth(steady_sliding(design))[0]
    return np.where(np.isfinite(growth), growth, np.inf)


def first_loss(design: Any, parameter: str, bounds: tuple[float, float]) -> float:
    """The lowest value of the parameter at which one brake loses its stability, narrow windows included; or the end.

    Where the growth rate comes near zero and turns back it is looked at more closely, ever again.
    """
    low, high = bounds
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


def _with(design: Any, parameter: str, values: Any, growth: Any, more: Any) -> tuple[Any, Any]:
    every = np.append(values, more)
    rates = np.append(growth, growth_of(design.replace({parameter: more})))
    every, places = np.unique(every, return_index=True)
    return every, rates[places]


def at_the_window(start: Any, near: tuple[float, float, float], parameter: str) -> list[tuple[float, float, float]]:
    """The best of the tunings at which the window of instability below the margin just closes.

    The margin as a function of the tuning ends at that edge, which a search only comes near: for each damping the
    frequency is solved for, and the damping is searched.
    """
    from scipy.optimize import brentq, minimize_scalar

    value, frequency, damping = near
    end = -value
    own = start.replace(frequency=frequency, damping=damping)
    values = np.linspace(0.8 * end, end, 801)
    growth = growth_of(own.replace({parameter: values}))
    inner = np.flatnonzero((growth[1:-1] >= growth[:-2]) & (growth[1:-1] >= growth[2:])) + 1
    if not inner.size:
        return []
    place = float(values[inner[int(np.argmax(growth[inner]))]])
    wide = 0.6 * (end - place)

    def at(f: float, z: float, x: float) -> float:
        return float(growth_of(start.replace({"frequency": f, "damping": z, parameter: x})))

    def peak(f: float, z: float) -> tuple[float, float]:
        coarse = np.linspace(place - wide, place + wide, 41)
        rates = growth_of(start.replace({"frequency": f, "damping": z, parameter: coarse}))
        inside = np.flatnonzero((rates[1:-1] >= rates[:-2]) & (rates[1:-1] >= rates[2:])) + 1
        if not inside.size:
            return -np.inf, place
        k = int(inside[np.argmax(rates[inside])])
        found = minimize_scalar(
            lambda x: -at(f, z, x), bounds=(coarse[k - 1], coarse[k + 1]), method="bounded",
            options={"xatol": 1e-9 * end},
        )  # fmt: skip
        return -float(found.fun), float(found.x)

    def margin(log_z: float) -> tuple[float, float, float]:
        z = float(np.exp(log_z))
        shares = 1.0 + np.array([-4e-4, -2e-4, -1e-4, 0.0, 1e-4, 2e-4, 4e-4])
        heights = np.array([peak(frequency * share, z)[0] for share in shares])
        known = np.isfinite(heights)
        changes = np.flatnonzero((np.sign(heights[1:]) != np.sign(heights[:-1])) & known[1:] & known[:-1])
        best = (0.0, frequency, z)
        for c in changes:
            low, high = frequency * shares[c], frequency * shares[c + 1]
            f = float(brentq(lambda x: peak(x, z)[0], low, high, xtol=1e-13 * frequency))
            top = peak(f, z)[1]
            beyond = np.linspace(top + 0.02 * wide, end + wide, 400)
            rates = growth_of(start.replace({"frequency": f, "damping": z, parameter: beyond}))
            first = int(np.argmax(rates > 0.0))
            if first > 0:
                last = float(brentq(lambda x, f=f: at(f, z, x), beyond[first - 1], beyond[first], xtol=1e-13 * end))
                best = min(best, (-last, f, z))
        return best

    found = minimize_scalar(
        lambda x: margin(x)[0],
        bracket=(np.log(damping) - 0.02, np.log(damping) + 0.02),
        options={"xtol": 1e-6, "maxiter": 25},
    )
    best = margin(float(found.x))
    return [best] if best[0] < 0.0 else []
