"""From a period doubling onto the branch of doubled period.

At a multiplier -1 with Phi e = -e the cycle of period T, run for 2T, has the neighbour x0 + eps e: to first order it
comes back after two turns, at the same parameter, which moves with eps^2 only (a pitchfork). So the new branch starts
along (e, 0, 0) in (x, period, parameter). e is taken along the flow onto the plane that fixes the phase:
e - f(x0) e_k/f_k(x0), which changes no orbit. Source: Kuznetsov 2004, Sec. 10.3.
"""

from typing import Any

import numpy as np

from squealbox.continuation import Equation
from squealbox.limit_cycles.branches.shooting_path import ShootingPath
from squealbox.limit_cycles.cycles.variation import fly

NEWTON_STEPS, CLOSE = 8, 1e-10
SHIFTS = (1e-2, 1e-3, 1e-4)  # first distances from the old cycle, in its size, until the new one is met
APART = 0.5  # of twice the shift: what half a new cycle is from its start at least; the old one, run twice, is back


def doubled(path: ShootingPath, x: np.ndarray, p: float) -> tuple[Any, Any]:
    """Unknowns beside the old cycle with twice its period, and the direction to start along, scaled, with p last."""
    equation = Equation.of(path)
    fixed_p = np.append(np.zeros(x.size), 1.0)  # no multiplier but the trivial one is 1 there
    old = equation.corrected(equation.y(x, p), fixed_p, NEWTON_STEPS, CLOSE).y
    x = x if old is None else equation.point(old)[0]
    start, flown = path.fly(x, p)
    values, vectors = np.linalg.eig(flown.phi)
    e = np.real(vectors[:, int(np.argmin(np.abs(values + 1.0)))])
    rate = path.field(p).rate(start, flown.motion.mode[1])
    e = np.delete(e - rate * (e[path.column] / rate[path.column]), path.column) / path.scale[:-1]
    direction = np.append(e, [0.0, 0.0]) / np.linalg.norm(e)
    twice = np.append(x[:-1], 2.0 * x[-1])
    for shift in SHIFTS:
        y = equation.corrected(equation.y(twice, p) + shift * direction, direction, NEWTON_STEPS, CLOSE).y
        if y is not None and half_apart(path, y * equation.scale) > APART * 2.0 * shift:
            break
    return twice + shift * direction[:-1] * path.scale, direction


def half_apart(path: ShootingPath, unknowns: np.ndarray) -> float:
    """Distance, in the size of the cycle, of the motion after half the period from its start; unknowns end with p."""
    start, period, p = path.start(unknowns[:-1]), float(unknowns[-2]), float(unknowns[-1])
    run = fly(path.field(p), start, 0.5 * period, path.rtol)
    off = np.delete(np.concatenate([run.q[-1], run.qd[-1]]) - start, path.column) / path.scale[:-1]
    return float(np.linalg.norm(off))
