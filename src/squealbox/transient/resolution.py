"""Do the kept instants carry the motion? Amplitude, frequency, growth and level belong to the motion, not to them.

Where they are too few (`signals.carries`) the run is made again from its start, which gives the same motion, with every
step kept.
"""

from weakref import WeakKeyDictionary

import numpy as np

from squealbox.signals import SignalError, carries
from squealbox.transient.methods import Method
from squealbox.transient.simulating import simulate
from squealbox.transient.trajectory import Trajectory

MOST_STEPS = 500_000  # kept of a run made again: some 100 MB
_again: "WeakKeyDictionary[Trajectory, Trajectory]" = WeakKeyDictionary()


def resolved(motion: Trajectory) -> Trajectory:
    """The same motion with instants that carry it: the trajectory itself, or its run made again with every step kept.

    Of a run of more steps than can be kept only the last part is made again. Raises `SignalError` for
    a run of time-stepping, whose steps are kept only where no `times` are asked for. Source: as this module.

    >>> from squealbox import MassOnBelt
    >>> coarse = simulate(MassOnBelt(), 100.0, times=9)
    >>> carries(resolved(coarse))
    True
    """
    if not motion.settings.get("contact") or len(motion.t) < 3 or motion.steps + 1 <= len(motion.t) or carries(motion):
        return motion
    if motion not in _again:
        _again[motion] = _made_again(motion)
    return _again[motion]


def _made_again(motion: Trajectory) -> Trajectory:
    given = motion.settings
    if given["contact"] == "time-stepping":
        raise SignalError(
            f"{len(motion.t)} instants are too few for the fastest oscillation of the run; expected more `times`"
        )
    first = 0
    if motion.steps > MOST_STEPS:
        first = min(int(np.ceil(len(motion.t) * (1.0 - MOST_STEPS / motion.steps))), len(motion.t) - 2)
    method = Method(given["tableau"], rtol=given["rtol"], atol=np.array(given["atol"]))
    begin = float(motion.t[first])
    return simulate(
        motion.system, float(motion.t[-1]) - begin, (motion.q[first], motion.qd[first]), None, method,
        given["contact"], width=given["width"], start_time=begin,
    )  # fmt: skip
