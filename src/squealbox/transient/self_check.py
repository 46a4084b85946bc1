"""What a finished run is asked before it says `completed`: does its energy audit close?

The other question, whether events were passed over, is asked on the way: every sixteenth step is looked at in twice as
many places (`_march.modes_held`, `lanes.recording.series_held`).
"""

from dataclasses import replace

import numpy as np

from squealbox.result import Outcome
from squealbox.system import System
from squealbox.transient.trajectory import Trajectory

CLOSES = 1e-4  # share of the energy turned over that no run at a usual tolerance comes near
SMOOTHED = 1e-2  # the same with a smoothed sgn, which creeps at speeds below any tolerance
LOOSE = 1e3  # times rtol, where that is larger
LARGEST = 1e140  # of a row, whose square is an energy


def checked(motion: Trajectory, first: np.ndarray, last: np.ndarray, size: int) -> Trajectory:
    """The motion; with the outcome "energy_unbalanced" where it completed and its energy audit does not close.

    `first` and `last` are rows, of `size` freedoms, where the run began and ended, whatever instants were asked for.
    They tell most, at a small share of the cost of the audit; it is asked only where they do not close.
    """
    if not motion.outcome.ok or motion.system.is_sparse:
        return motion
    rtol = float(motion.settings["rtol"])
    limit = max(CLOSES if motion.settings["contact"] == "exact" else SMOOTHED, LOOSE * rtol)
    if not np.all(np.abs([first, last]) < LARGEST):  # a motion beyond all numbers, or a work that nobody counted
        return motion
    missing, turned_over, held = _unclosed(motion.system, first, last, size)
    if missing <= limit * turned_over + LOOSE * max(rtol, np.finfo(float).eps) * held:
        return motion
    whole = len(motion.t) > 1 and (motion.t[0], motion.t[-1]) == (first[0], last[0])
    residual = motion.energy.relative_residual if whole else missing / max(turned_over, held)
    if residual <= limit:
        return motion
    why = f"the energy audit closes to {residual:.2g} of what was turned over, not to {limit:.2g}"
    return replace(motion, outcome=Outcome("energy_unbalanced", why, residual=residual, time=float(motion.t[-1])))


def _unclosed(system: System, first: np.ndarray, last: np.ndarray, size: int) -> tuple[float, float, float]:
    """What is missing from one row to another, the largest term, and the energy that the springs hold throughout [J].

    Where a motion is small about a large deflection, the springs' energy tells its change to rtol of itself only.
    """
    n, m = system.size, len(system.contacts)
    kinetic, strain = [], []
    for row in (first, last):
        q, qd = row[1 : 1 + n], row[1 + size : 1 + size + n]
        kinetic.append(0.5 * float(qd @ system.M @ qd))
        strain.append(0.5 * float(q @ system.K @ q))
    works = (last - first)[1 + 2 * size : 6 + 2 * size + m].tolist()
    change = kinetic[1] - kinetic[0] + strain[1] - strain[0]
    missing = abs(change - sum(works) + 2.0 * works[m + 2])  # what is dissipated is not given
    return missing, max(*kinetic, abs(change), *map(abs, works)), max(map(abs, strain))
