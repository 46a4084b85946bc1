"""What does the motion settle to? Depends on: transient, stability, continuation, system, friction, result."""

from squealbox.limit_cycles.cycle import Cycle
from squealbox.limit_cycles.harmonic_balance import harmonic_balance
from squealbox.limit_cycles.shooting import shooting

__all__ = ["Cycle", "harmonic_balance", "shooting"]
