"""Poincare sections and Lyapunov exponents of motions with stick and slip.

The section is crossed where the velocity of one degree of freedom falls through zero, that is at its maxima. The
Lyapunov exponents come from the derivative of the flow, saltation matrices included, re-orthonormalised by QR:
sum log|R_ii| / time. A sticking phase forgets a direction; its exponent is minus infinity.
Sources: Benettin, Galgani, Giorgilli and Strelcyn 1980, Meccanica 15, 9-30; Mueller 1995, Chaos, Solitons and
Fractals 5, 1671-1681 (jumps at events).
"""

from typing import Any

import numpy as np

from squealbox.limit_cycles.field import Field
from squealbox.limit_cycles.variation import quick_flight
from squealbox.system import as_system
from squealbox.transient import Trajectory


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


def lyapunov_exponents(design_or_system: Any, start: Any, span: float, spans: int, *, rtol: float = 1e-11) -> Any:
    """Lyapunov exponents [1/s] in falling order, shape (2n,), over `spans` stretches of `span` seconds from (q, qd).

    -inf where sticking forgets a direction. Accuracy: statistical, about 1/(spans span); NaN when a run fails.

    >>> from squealbox import Contact, Coulomb, System
    >>> belt = Contact(n=[0.0], d=[1.0], t=[1.0], N0=1.0, V=0.1, law=Coulomb(0.4, 0.25))
    >>> block = System([[1.0]], [[0.0]], [[1.0]], 0.0, (belt,))
    >>> bool(abs(lyapunov_exponents(block, ([0.4], [0.0999]), 7.317597861, 40)[0]) < 0.02)
    True
    """
    field = Field(as_system(design_or_system))
    x = np.concatenate([np.asarray(part, dtype=float) for part in start])
    frame, total = np.eye(x.size), np.zeros(x.size)
    for _ in range(spans):
        flown = quick_flight(field, x, span, rtol)
        if not flown.outcome.ok:
            return np.full(x.size, np.nan)
        x = flown.x
        frame, growth = np.linalg.qr(flown.phi * (field.scale[:, None] / field.scale) @ frame)
        size = np.abs(np.diag(growth))
        with np.errstate(divide="ignore"):
            total += np.where(size > 1e-13, np.log(size), -np.inf)
    return np.sort(total / (span * spans))[::-1]
