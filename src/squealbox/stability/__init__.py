"""Is steady sliding stable? Depends on: system, continuation, result; numba only when a kernel is needed."""

from squealbox.stability.eigenvalues import ComplexModes, Mode, complex_modes
from squealbox.stability.mechanism import Mechanism, mechanism
from squealbox.stability.onset import CriticalValue, CriticalValues, critical_value, critical_values

__all__ = [
    "ComplexModes",
    "CriticalValue",
    "CriticalValues",
    "Mechanism",
    "Mode",
    "complex_modes",
    "critical_value",
    "critical_values",
    "mechanism",
]
