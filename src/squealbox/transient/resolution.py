"""Do the kept instants carry the motion? Amplitude, frequency, growth and level belong to the motion, not to them.

Of a trajectory both displacement and velocity are known. Where the instants are close enough,

    (q_k+1 - q_k) / h = (qd_k + qd_k+1) / 2 + O((omega h)^2 / 12),

and the two sides differ by as much as the velocity itself where there are fewer than about three instants in a period:
such a record is aliased. The run is then made again from its start, which gives the same motion, with every step kept.
"""

from weakref import WeakKeyDictionary

import numpy as np

from squealbox.signals import SignalError
from squealbox.transient.methods import Method
from squealbox.transient.simulate import simulate
from squealbox.transient.trajectory import Trajectory

COARSE = 0.05  # of the velocity: some eight instants in a period
MOST_STEPS = 500_000  # kept of a run made again: some 100 MB
_again: "WeakKeyDictionary[Trajectory, Trajectory]" = WeakKeyDictionary()


def carries(motion: Trajectory) -> bool:
    """True where the kept instants of a trajectory are close enough in time for its fastest oscillation.

    Source: as this module.

    >>> from squealbox import MassOnBelt
    >>> carries(simulate(MassOnBelt(), 100.0, times=9)), carries(simulate(MassOnBelt(), 10.0, times=999))
    (False, True)
    """
    t, q, qd = motion.t, motion.q, motion.qd
    if len(t) < 3:
        return True
    h = np.diff(t)[:, None]
    moved, speed = np.diff(q, axis=0), 0.5 * h * (qd[1:] + qd[:-1])
    late, went = t[1:] > t[-1] - 0.25 * (t[-1] - t[0]), h * np.abs(qd[1:])
    unit = np.max(went, axis=0) + np.max(np.abs(moved), axis=0) + 1e-300  # a motion that blows up has no squares
    for stretch in (late, np.ones(len(late), dtype=bool)):
        missed = np.sqrt(np.sum(((moved - speed) / unit)[stretch] ** 2, axis=0))
        size = np.sqrt(np.sum((went / unit)[stretch] ** 2, axis=0)) + 1e-9 * np.ptp(q, axis=0) / unit + 1e-300
        if np.any(missed > COARSE * size):
            return False
    return True


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
