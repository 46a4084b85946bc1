"""The analyses a study file names, as functions that can be sent to other processes."""

import functools
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from squealbox.files import StudyFile
    from squealbox.transient import MotionSettings

UNITS = {"amplitude": "m", "frequency": "Hz", "growth_rate": "1/s", "settled_at": "s", "time": "s"}


def analysis_of(found: "StudyFile") -> Callable[..., Any]:
    """What the file asks for, with the settings of its sections."""
    brake = found.brake
    match found.study.analysis:
        case "modes":
            from squealbox.stability import complex_modes

            return functools.partial(complex_modes, time=brake.modes.time if brake.modes else 0.0)
        case "onset":
            from squealbox.stability import critical_value

            varied = brake.onset
            assert varied is not None
            ends = (varied.low, varied.high)
            return functools.partial(critical_value, parameter=varied.name, bounds=ends, points=int(varied.points))
        case "simulate":
            from squealbox.transient import MotionSettings

            return functools.partial(judged_motion, settings=brake.simulate or MotionSettings())
        case "ensemble":
            from squealbox.transient import simulate_ensemble, usual_duration

            seconds = found.study.duration or usual_duration(brake.design)
            return functools.partial(simulate_ensemble, duration=seconds, observe=found.observe)
        case _:
            from squealbox.limit_cycles import shooting

            return shooting


def judged_motion(design: Any, settings: "MotionSettings") -> dict[str, Any]:
    """The verdict on a transient, for each degree of freedom."""
    from squealbox.transient import verdict

    system = design.system()
    motion = settings.run_closely(system)
    each = [verdict(motion, dof=i) for i in range(system.size)]
    names = ("amplitude", "frequency", "growth_rate", "settled_at")
    numbers = {name: np.array([float(getattr(one, name)) for one in each]) for name in names}
    return {
        **numbers,
        "fate": np.array([one.fate for one in each]),
        "time": float(motion.t[-1]),
        "steps": motion.steps,
        "outcome": str(motion.outcome),
    }
