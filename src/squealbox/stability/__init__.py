"""Is steady sliding stable? Depends on: system, continuation, result; numba only when a kernel is needed."""

from squealbox.stability.eigenvalues import ComplexModes, Mode, complex_modes
from squealbox.stability.onset import CriticalValue, critical_value

__all__ = ["ComplexModes", "CriticalValue", "Mode", "complex_modes", "critical_value"]
