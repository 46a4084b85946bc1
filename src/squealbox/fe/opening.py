"""Shapes for the contacts that open or close between the linearisations of a brake, at a few and at all values between.

An open contact changes K by -r' n, n = k r. With the contacts of a set S opened (s = 1) or closed (s = -1), a mode u of
K0 bends to first order in its frequency, and to all orders in the springs, by

    K0^-1 R' b,   b = (1 - s H)^-1 s N u,   H = N K0^-1 R'  on S

and in a mode of angular frequency w leaving that out costs about b' R K0^-1 R' b / (2 w) [1/s]. Which contacts belong
to S between two linearisations follows from their gaps on the way.
"""

from typing import Any

import numpy as np

from squealbox.fe.pencil import SlidingPencil
from squealbox.fe.real_modes import RealModes

REACH = 1.1  # times the end of the band up to which modes are looked at
SMALLEST = 1e-12  # share of the largest energy below which a combination of contacts is round-off


def opening_directions(modes: RealModes, pencil: SlidingPencil, pushed: Any, top: float, tolerance: float) -> Any:
    """Columns (n, k) that hold the bent shapes of all modes up to `top` [Hz] but for `tolerance` [1/s] in each.

    pushed (points, contacts) is N0 + n . q, below 0 at a gap, wherever contacts may be open or closed.
    """
    table, open_ = pencil.sliding.system.contacts, pencil.sliding.lifted > 0.0
    sets = np.unique((pushed <= 0.0) & table.unilateral, axis=0)
    changing = np.flatnonzero(np.any(sets != open_, axis=0))
    below = modes.frequency < REACH * top
    if not len(changing) or not np.any(below):
        return np.zeros((pencil.size, 0))
    rows, springs, shapes = table.normal[changing], table.n[changing], modes.shapes[:, below]
    moved = modes.base.solve_many(rows.T.toarray())
    held, felt = springs @ moved, springs @ shapes
    felt = felt / np.sqrt(4.0 * np.pi * np.maximum(modes.frequency[below], 1e-3 * modes.top))
    bent = []
    for one in sets[:, changing]:
        sign = one.astype(float) - open_[changing]
        where = np.flatnonzero(sign)
        amount = np.zeros(felt.shape)
        amount[where] = np.linalg.solve(
            np.eye(len(where)) - sign[where, None] * held[np.ix_(where, where)], sign[where, None] * felt[where]
        )
        bent.append(amount)
    flexibility = rows @ moved
    values, turns = np.linalg.eigh(0.5 * (flexibility + flexibility.T))
    keep = values > SMALLEST * values[-1]
    length, turns = np.sqrt(values[keep]), turns[:, keep]
    columns = length[:, None] * (turns.T @ np.concatenate(bent, axis=1))
    main, sizes, parts = np.linalg.svd(columns, full_matrices=False)
    left = np.cumsum((sizes[:, None] * parts)[::-1] ** 2, axis=0)[::-1]  # of each column less i directions
    count = int(np.sum(np.max(left, axis=1) > tolerance))
    return moved @ (turns @ (main[:, :count] / length[:, None]))
