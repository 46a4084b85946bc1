"""How often a closed motion goes round: what comes back after T may have come back before.

A run that has not quite settled passes its start more closely after several turns than after one, and Newton's method
then converges on the cycle wound m times. It solves the same equation; its period and multipliers are powers of the
true ones. By the standard of convergence itself, the motion closes after T/m as well:

    |x(T/m) - x(0)| <= tolerance, scaled as the residual of shooting
"""

import numpy as np

from squealbox.limit_cycles.cycles.field import Autonomous
from squealbox.limit_cycles.cycles.variation import fly

MOST = 64  # rounds looked for


def rounds(field: Autonomous, x: np.ndarray, period: float, size: float, rtol: float, tolerance: float) -> int:
    """The largest m up to 64 for which the cycle from x closes after period/m; `size` is that of its scaled states."""
    parts = np.arange(MOST, 0, -1)
    run = fly(field, x, period, rtol, np.r_[0.0, period / parts])
    if not run.outcome.ok:
        return 1
    away = np.max(np.abs((np.hstack([run.q, run.qd])[1:] - x) * field.scale), axis=1)
    closed = np.flatnonzero(away <= tolerance * size)
    return int(parts[closed[0]]) if closed.size else 1
