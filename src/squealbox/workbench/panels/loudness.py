"""How loud a motion may be, with what that estimate rests on: told in the verdict and beside the sound."""

from typing import Any

import numpy as np

from squealbox.matrices import liveliest
from squealbox.signals import SignalError, sound_level
from squealbox.transient import Trajectory
from squealbox.workbench.frames import finite


def loudness(motion: Trajectory, dof: int, **how: Any) -> dict[str, Any]:
    """Estimated level [dB] and [dB(A)] at 1 m, None where nothing can be heard; area [m^2]; and the assumption."""
    name = motion.system.names[dof]
    about: dict[str, Any] = {"of": name, "level": None, "weighted": None, "area": None}
    if motion.system.units[dof] != "m":
        return {**about, "assumption": f"No sound level: {name} turns, and an angle alone moves no air."}
    try:
        found = sound_level(motion, dof=dof, **how)
    except SignalError as error:
        return {**about, "assumption": f"No sound level: {error}."}
    return {
        **about,
        "level": finite(found.level),
        "weighted": finite(found.weighted),
        "area": found.settings["area"],
        "assumption": found.assumption,
    }


def loudest(motion: Trajectory) -> int:
    """The freedom whose level is the motion's: the one that moves most at last, as the report takes it."""
    late = motion.q[3 * len(motion.t) // 4 :]
    return liveliest(np.ptp(late, axis=0), motion.system.units)
