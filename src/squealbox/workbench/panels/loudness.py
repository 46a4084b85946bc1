"""How loud a motion may be, with what that estimate rests on: told in the verdict and beside the sound."""

from typing import Any

from squealbox.signals import SignalError, sound_level
from squealbox.transient import Trajectory
from squealbox.workbench.frames import finite


def loudness(motion: Trajectory, dof: int, **how: Any) -> dict[str, Any]:
    """Estimated level [dB] and [dB(A)] at 1 m, None where nothing can be heard; area [m^2]; and the assumption."""
    try:
        found = sound_level(motion, dof=dof, **how)
    except SignalError as error:
        return {"level": None, "weighted": None, "area": None, "assumption": f"No sound level: {error}."}
    return {
        "level": finite(found.level),
        "weighted": finite(found.weighted),
        "area": found.settings["area"],
        "assumption": found.assumption,
    }
