"""Loops: what senses a brake and acts on it; their rows stand beside those of the contacts. Depends on: parameters."""

from squealbox.loops.kinds import LOOPS, PID, ActiveForce, DelayedFeedback, Loop, StateFeedback, check_loops
from squealbox.loops.rows import Rows, folded, near_sliding

__all__ = [
    "LOOPS",
    "PID",
    "ActiveForce",
    "DelayedFeedback",
    "Loop",
    "Rows",
    "StateFeedback",
    "check_loops",
    "folded",
    "near_sliding",
]
