"""What a loop does to a brake: poles, margins, runs. Depends on: stability, transient, loops, system, result."""

from squealbox.control.closed_loop import ClosedLoop, closed_loop
from squealbox.control.gains import StableGains, stable_gains
from squealbox.control.placement import Placement, placement
from squealbox.control.plant import Plant, plant
from squealbox.control.push import DefeatingPush, defeating_push
from squealbox.control.runs import LoopRun, run_loops

__all__ = [
    "ClosedLoop",
    "DefeatingPush",
    "LoopRun",
    "Placement",
    "Plant",
    "StableGains",
    "closed_loop",
    "defeating_push",
    "placement",
    "plant",
    "run_loops",
    "stable_gains",
]
