from .closed_loops import ClosedLoop, closed_loop
from .gains import StableGains, stable_gains
from .placements import Placement, placement
from .plants import Plant, plant
from .push import DefeatingPush, defeating_push
from .runs import LoopRun, run_loops

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
