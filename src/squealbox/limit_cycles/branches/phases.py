"""Where on a cycle its period begins: at a turning point of a displacement, far from every event.

There the velocity of that degree of freedom is zero, which fixes the phase. An event that wanders over the beginning
changes which motion the start belongs to, so before that happens the path is taken up again at another turning point.
"""

from typing import Any

import numpy as np

from squealbox.limit_cycles.branches.shooting_path import ShootingPath
from squealbox.limit_cycles.cycles.cycle import Cycle
from squealbox.limit_cycles.cycles.field import Autonomous
from squealbox.limit_cycles.cycles.variation import fly

CLEAR = 0.02  # of the period: an event farther from the beginning is no matter
TURNING = 4  # steps of Newton's method to a turning point
TOUCHING = 1e-3  # and one nearer than this may be why a path does not go on


def turns(cycle: Cycle) -> list[tuple[int, int]]:
    """(row, degree of freedom) of the turning points, that of the largest displacement of the cycle first."""
    rising = cycle.qd[:-1] > 0.0
    found = [(int(i), dof) for dof in range(cycle.q.shape[1])
             for i in np.flatnonzero(rising[:, dof] != np.roll(rising[:, dof], 1))]  # fmt: skip
    dof = int(np.argmax(cycle.amplitude))
    return [(int(np.argmax(cycle.q[:-1, dof])), dof), *found]


def away(cycle: Cycle, row: int) -> float:
    """Time from a row of the cycle to the nearest event, over the period."""
    if len(cycle.event_time) == 0:
        return 1.0
    gap = np.abs(cycle.event_time - cycle.t[row]) / float(cycle.period)
    return float(np.min(np.minimum(gap, 1.0 - gap)))


def beginning(cycle: Cycle) -> tuple[int, int]:
    """(row, degree of freedom) of the turning point to begin at: the largest displacement if it is clear."""
    return max(turns(cycle), key=lambda turn: min(away(cycle, turn[0]), CLEAR))


def begun(path: ShootingPath, cycle: Cycle, p: float) -> Any:
    """Unknowns of a path through a cycle."""
    row, dof = beginning(cycle)
    return path.begin(turned(path, cycle, p, row, dof), float(cycle.period), p, dof, float(np.max(cycle.amplitude)))


def turned(path: ShootingPath, cycle: Cycle, p: float, row: int, dof: int) -> Any:
    """State (2n,) at the turning point itself, which lies between a row and the one before.

    A start off by a part of a sample may lead Newton's method from an unstable cycle, or one near a jump, to another.
    """
    field, before = path.field(p), row - 1 if row > 0 else len(cycle.t) - 2
    start = _state(field, cycle, before, path.rtol)
    gap = float(cycle.t[before + 1] - cycle.t[before])
    after = gap * cycle.qd[before, dof] / (cycle.qd[before, dof] - cycle.qd[row, dof])
    state = start
    for _ in range(TURNING):
        if not 0.0 < after <= gap:
            break
        run = fly(field, start, after, path.rtol)
        state = np.concatenate([run.q[-1], run.qd[-1]])
        after -= float(run.qd[-1, dof] / field.rate(state, run.mode[-1])[field.size + dof])
    return state


def _state(field: Autonomous, cycle: Cycle, row: int, rtol: float) -> Any:
    """The state at a row of a cycle; what is remembered is known at its beginning alone."""
    if not np.size(cycle.memory) or row == 0:
        return field.state(cycle.q[row], cycle.qd[row], cycle.memory)
    run = fly(field, field.state(cycle.q[0], cycle.qd[0], cycle.memory), float(cycle.t[row]), rtol)
    return np.concatenate([run.q[-1], run.qd[-1]])


def touches_event(path: ShootingPath, x: np.ndarray, p: float) -> bool:
    """True when an event lies next to the beginning of the period."""
    times = path.run(x, p).event_time / float(x[-1])
    return bool(np.any(np.minimum(times, 1.0 - times) < TOUCHING))


def taken_up(path: ShootingPath, last: tuple[Any, float], earlier: tuple[Any, float]) -> tuple[Any, ...] | None:
    """(path, x, p, tangent) through the same cycle from another turning point; the tangent leads on from `earlier`."""
    cycle, before = path.cycle(*last), path.cycle(*earlier)
    if np.size(cycle.memory):  # known at one instant alone, not at another turning point
        return None
    other = path.again()
    x, p = begun(other, cycle, last[1]), last[1]
    if touches_event(other, x, p):
        return None
    return other, x, p, heading(other, x, p, (cycle, before), earlier[1])


def heading(path: ShootingPath, x: np.ndarray, p: float, cycles: tuple[Cycle, Cycle], before: float) -> Any:
    """Direction in scaled variables from an earlier cycle at `before` to the one at p that begins at x."""
    cycle, earlier = cycles
    state = path.start(x)
    row = int(np.argmin(np.max(np.abs(np.hstack([cycle.q, cycle.qd]) - state) * path.field(p).scale, axis=1)))
    share = cycle.t[row] / float(cycle.period)
    dof = path.column - cycle.q.shape[1]
    beside = [(abs(earlier.t[i] / float(earlier.period) - share), i) for i, turned in turns(earlier) if turned == dof]
    row = min(beside)[1]
    old = np.append(np.delete(np.concatenate([earlier.q[row], earlier.qd[row]]), path.column), earlier.period)
    ahead = np.append((x - old) / path.scale, (p - before) / path.span)
    return ahead / np.linalg.norm(ahead)
