"""What a loop does to a brake: poles, margins, sampling, limits. Depends on: stability, loops, system, result."""

from squealbox.control.closed_loop import ClosedLoop, closed_loop
from squealbox.control.plant import Plant, plant

__all__ = ["ClosedLoop", "Plant", "closed_loop", "plant"]
