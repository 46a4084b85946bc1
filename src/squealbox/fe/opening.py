"""Shapes for the contacts that open or close between the linearisations of a brake, at a few and at all values between.

An open contact changes K by -r' n, n = k r. With the contacts of a set S opened (s = 1) or closed (s = -1), a mode u of
K0 bends to first order in its frequency, and to all orders in the springs, by

    K0^-1 R' b,   b = (1 - s H)^-1 s N u,   H = N K0^-1 R'  on S

and in a mode of angular frequency w leaving that out costs about b' R K0^-1 R' b / (2 w) [1/s]. Which contacts belong
to S between two linearisations follows from their gaps, taken to change evenly on the way.
"""

from typing import Any

import numpy as np

from squealbox.fe.pencil import SlidingPencil
from squealbox.fe.undamped_modes import RealModes

STEPS = 8  # of the way from the first linearisation to each other one, at each of which a set of contacts is looked at
REACH = 1.1  # times the end of the band up to which modes are looked at
SMALLEST = 1e-12  # share of the largest energy below which a combination of contacts is round-off


def opening_directions(modes: RealModes, pencils: list[SlidingPencil], top: float, tolerance: float) -> Any:
    """Columns (n, k) that hold the bent shapes of all modes up to `top` [Hz] but for `tolerance` [1/s] in each."""
    sets, table = _sets(pencils), pencils[0].sliding.system.contacts
    open_ = pencils[0].sliding.lifted > 0.0
    changing = np.flatnonzero(np.any(sets != open_, axis=0))
    below = modes.frequency < REACH * top
    if not len(changing) or not np.any(below):
        return np.zeros((pencils[0].size, 0))
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


def _sets(pencils: list[SlidingPencil]) -> Any:
    """Which contacts are open in the first pencil and on the way from it to each other one, (sets, contacts)."""
    first, *others = (pencil.sliding.pushed for pencil in pencils)
    shares = np.arange(1, STEPS + 1) / STEPS
    between = [(1.0 - share) * first + share * other for other in others for share in shares]
    return np.unique((np.stack([first, *between]) <= 0.0) & pencils[0].sliding.system.contacts.unilateral, axis=0)
