"""From a period doubling onto the branch of doubled period.

At a multiplier -1 with Phi e = -e the cycle of period T, run for 2T, has the neighbour x0 + eps e: to first order it
comes back after two turns, at the same parameter, which moves with eps^2 only (a pitchfork). So the new branch starts
along (e, 0, 0) in (x, period, parameter). e is taken along the flow onto the plane that fixes the phase:
e - f(x0) e_k/f_k(x0), which changes no orbit. Source: Kuznetsov 2004, Sec. 10.3.
"""

from typing import Any

import numpy as np

from squealbox.limit_cycles.branches.corners import corrected
from squealbox.limit_cycles.branches.shooting_path import ShootingPath
from squealbox.limit_cycles.cycles.variation import fly

NEWTON_STEPS, CLOSE = 8, 1e-11
SHIFTS = (1e-2, 1e-3, 1e-4)  # first distances from the old cycle, in its size, until the new one is met
APART = 0.5  # of twice the shift: what half a new cycle is from its start at least; the old one, run twice, is back


def settled(path: ShootingPath, x: Any, p: float) -> Any:
    """The unknowns corrected to the path at fixed p, where no multiplier but the trivial one is 1."""
    for _ in range(NEWTON_STEPS):
        change = np.linalg.solve(path.jacobian(x, p)[0] * path.scale, path.residual(x, p))
        x = x - change * path.scale
        if np.max(np.abs(change)) < CLOSE:
            break
    return x


def doubled(path: ShootingPath, x: Any, p: float) -> tuple[Any, Any]:
    """Unknowns beside the old cycle with twice its period, and the direction to start along, scaled, with p last."""
    x = settled(path, x, p)
    start, flown = path.fly(x, p)
    values, vectors = np.linalg.eig(flown.phi)
    e = np.real(vectors[:, int(np.argmin(np.abs(values + 1.0)))])
    rate = path.field(p).rate(start, flown.motion.mode[1])
    e = np.delete(e - rate * (e[path.column] / rate[path.column]), path.column) / path.scale[:-1]
    direction = np.append(e, [0.0, 0.0]) / np.linalg.norm(e)
    twice = np.append(x[:-1], 2.0 * x[-1])
    scale = np.append(path.scale, path.span)
    for shift in SHIFTS:
        guess = np.append(twice, p) / scale + shift * direction
        y = corrected(path, guess, direction, scale)
        if y is not None and half_apart(path, y * scale) > APART * 2.0 * shift:
            break
    return twice + shift * direction[:-1] * path.scale, direction


def half_apart(path: ShootingPath, unknowns: Any) -> float:
    """Distance, in the size of the cycle, of the motion after half the period from its start; unknowns end with p."""
    start, period, p = path.start(unknowns[:-1]), float(unknowns[-2]), float(unknowns[-1])
    run = fly(path.field(p), start, 0.5 * period, path.rtol)
    off = np.delete(np.concatenate([run.q[-1], run.qd[-1]]) - start, path.column) / path.scale[:-1]
    return float(np.linalg.norm(off))
