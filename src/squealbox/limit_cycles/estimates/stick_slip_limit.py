"""Where stick-slip of a block on a belt ends, exactly: the slip that leaves stick and only just touches it again.

m x'' + c x' + k x = N mu(V - x') with x' = V while it sticks, c >= 0 and mu nowhere above its static limit. Sticking
ends where spring and damper pull with that limit, at x_r = (N mu_s - c V)/k, x' = V: one point, whatever went before.
So its slip is one orbit, and the stick-slip cycle exists as long as that orbit comes back to x' = V:

    G(V) = least v(t) = V - x'(t) on the return swing < 0,    G(V*) = 0 is the end.

At V* the orbit touches v = 0 with v' = 0. When mu(0+) is the static limit that is at x_r itself, so the orbit is a
cycle that only slips: stick-slip meets the unstable slip cycle there, a fold with a corner. G = 0 is one equation in V
with one orbit of high order behind it. Averaging (`averaged_limit`) has an error of second order in (c, N mu).
Source: derived here.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from squealbox.law import FrictionLaw
from squealbox.parameters import ParameterError

TURNS = 1.5  # periods of the free block in which the swing comes back to its largest velocity
REACH, LOOKS = 3.0, 1025  # of the largest belt speed: sliding speeds at which a law is looked at, and how many
RTOL = 1e-13


def return_gap(
    law: FrictionLaw, sliding_speed: float, normal_force: float, damping: float, mass: float = 1.0,
    stiffness: float = 1.0,
) -> float:  # fmt: skip
    """Least sliding speed [m/s] when the slip that begins at release swings back; below 0 it would have stuck again.

    Parameters
    ----------
    law : friction law
    sliding_speed, normal_force, damping, mass, stiffness : V [m/s], N [N], c [N s/m], m [kg], k [N/m] of the block

    Beyond v = 0 the law goes on with its tangent, so the gap is a smooth function of the speed through zero.
    """
    from scipy.integrate import solve_ivp

    limit, slope = float(law.mu(0.0)), float(law.slope_at(0.0))

    def rate(_: float, y: Sequence[float] | np.ndarray) -> Any:
        v = sliding_speed - y[1]
        mu = float(law.mu(v)) if v >= 0.0 else limit + v * slope
        return [y[1], (normal_force * mu - damping * y[1] - stiffness * y[0]) / mass]

    def turning(t: float, y: Sequence[float] | np.ndarray) -> float:
        return float(rate(t, y)[1])

    turning.direction = -1.0  # type: ignore[attr-defined]
    release = (normal_force * float(law.static_limit) - damping * sliding_speed) / stiffness
    period = 2.0 * np.pi * np.sqrt(mass / stiffness)
    done = solve_ivp(rate, (0.0, TURNS * period), [release, sliding_speed], "DOP853", events=turning, rtol=RTOL,
                     atol=1e-15 * max(abs(release), sliding_speed))  # fmt: skip
    late = np.flatnonzero(done.t_events[0] > 0.25 * period)
    return float(sliding_speed - done.y_events[0][late[0]][1]) if late.size else float("nan")


def stick_slip_limit(
    law: FrictionLaw, bounds: tuple[float, float], normal_force: float, damping: float, mass: float = 1.0,
    stiffness: float = 1.0,
) -> float:  # fmt: skip
    """Belt speed V* [m/s] up to which a block sticks and slips, from the exact condition; NaN without one in `bounds`.

    Parameters
    ----------
    law : friction law
    bounds : (low, high) of the belt speed [m/s]
    normal_force, damping, mass, stiffness : N [N], c [N s/m], m [kg], k [N/m] of the block

    Accuracy: 1e-12 of the speed, that of the orbit. Raises `ParameterError` unless 0 < low < high, and for what the
    condition does not cover: friction above its static limit somewhere, a law with memory, damping below 0.
    Source: as this module.

    >>> from squealbox import Stribeck
    >>> round(stick_slip_limit(Stribeck(0.4, 0.25, 0.3), (0.2, 0.5), 1.0, 0.2), 8)
    0.31527862
    """
    from scipy.optimize import brentq

    low, high = (float(x) for x in bounds)
    if not 0.0 < low < high:
        raise ParameterError("stick_slip_limit", "bounds", bounds, "two speeds with 0 < low < high")

    if law.has_memory:
        raise ParameterError("stick_slip_limit", "law", law, "a law without memory: bristles do not stick")
    if not damping >= 0.0:
        raise ParameterError("stick_slip_limit", "damping", damping, "a number of at least 0 N s/m")
    most = float(np.max(law.mu(np.linspace(0.0, REACH * high, LOOKS))))
    if most > float(law.static_limit) * (1.0 + 1e-12):
        expected = f"a law that is nowhere above its static limit (mu reaches {most:.4g}): its slip begins elsewhere"
        raise ParameterError("stick_slip_limit", "law", law, expected)

    def gap(speed: float) -> float:
        return return_gap(law, speed, normal_force, damping, mass, stiffness)

    ends = gap(low), gap(high)
    if not ends[0] < 0.0 < ends[1]:
        return float("nan")
    return float(brentq(gap, low, high, xtol=1e-15 * high, rtol=4.0 * np.finfo(float).eps))
