"""Steady sliding under sampled loops, linearised: rows of first order with the multipliers of one sample, as ln(z)/h.

So modes, maps and critical values take a sampled loop as they take any other. Of the rows the first are q, the next q'
of what has mass, then the loops' states, the forces under way, and as many again for multipliers that turn (z < 0).
"""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from squealbox.loops import continued, driven_brake, first_order, folded, step_matrix
from squealbox.matrices import Equilibrium, Linearised
from squealbox.members import member
from squealbox.parameters import ParameterError


def linearised(system: Any, time: float, linearise: Callable[..., Linearised]) -> Linearised:
    """As `system.linearise`, which is handed over, of a system with sampled loops; leading axes one by one."""
    shape = system.shape
    parts = [_one(member(system, i), time, linearise) for i in range(int(np.prod(shape, dtype=int)))]
    size = max(len(part.K) for part in parts)
    grown = [_padded(part, size) for part in parts]
    states = [part.equilibrium for part in grown]
    names = ("q", "normal_force", "sliding_speed", "friction", "exists", "floating")
    arrays = {name: np.stack([np.asarray(getattr(s, name)) for s in states]) for name in names}
    whole = {name: value.reshape(shape + value.shape[1:]) for name, value in arrays.items()}
    worst = next((s.outcome for s in states if not s.outcome.ok), states[0].outcome)
    M, C, K = (np.stack([getattr(p, x) for p in grown]).reshape((*shape, size, size)) for x in ("M", "C", "K"))
    return Linearised(M, C, K, Equilibrium(**whole, outcome=worst))


def _one(system: Any, time: float, linearise: Callable[..., Linearised]) -> Linearised:
    rates = sorted({float(loop.sampling) for loop in system.loops if loop.sampling is not None})
    if len(rates) > 1 or any(loop.sampling is None and not loop.linear for loop in system.loops):
        given = f"sampling at {rates} Hz" if len(rates) > 1 else "a delay without sampling"
        raise ParameterError("system", "loops", given, "one rate for all sampled loops, and no other loop that is late")
    brake = driven_brake(system)
    whole = folded(brake.system, near=True)
    closed = whole.replace(K=whole.K - brake.columns.T @ brake.P, C=whole.C - brake.columns.T @ brake.R)
    found = linearise(closed, time)
    if not found.equilibrium.exists:
        return found
    columns, P, R = (np.pad(x, ((0, 0), (0, len(found.K) - whole.size))) for x in (brake.columns, brake.P, brake.R))
    A, displacement, velocity, into = first_order(found.M, found.C + columns.T @ R, found.K + columns.T @ P)
    delays = np.array([loop.late for loop in brake.loops])
    step = 1.0 / rates[0]
    matrix = step_matrix(A, into @ columns.T, P @ displacement + R @ velocity, delays, step)
    C, K = continued(_levelled(matrix, len(found.K)), step)
    state = replace(found.equilibrium, q=np.pad(found.equilibrium.q, (0, len(K) - len(found.equilibrium.q))))
    return Linearised(np.zeros(K.shape), C, K, state)


def _levelled(matrix: np.ndarray, size: int) -> Any:
    """The step with its states in units of one size; those of the displacements (size,) in front are kept."""
    from scipy.linalg import matrix_balance

    _, (scale, _) = matrix_balance(matrix, permute=False, separate=True)
    scale[:size] = np.exp(np.mean(np.log(scale[:size])))
    return matrix * scale / scale[:, None]


def _padded(part: Linearised, size: int) -> Linearised:
    """With rows behind that have no eigenvalue."""
    more = size - len(part.K)
    M, C, K = (np.pad(x, ((0, more), (0, more))) for x in (part.M, part.C, part.K))
    K[len(part.K) :, len(part.K) :] = np.eye(more)
    return Linearised(
        M, C, K, replace(part.equilibrium, q=np.pad(part.equilibrium.q, (0, size - len(part.equilibrium.q))))
    )
