"""What a loop does to a brake: poles, margins, runs. Depends on: stability, transient, loops, system, result."""

from squealbox.control.closed_loop import ClosedLoop, closed_loop
from squealbox.control.plant import Plant, plant
from squealbox.control.runs import LoopRun, run_loops

__all__ = ["ClosedLoop", "LoopRun", "Plant", "closed_loop", "plant", "run_loops"]
