"""A quadratic eigenproblem on a basis, small and dense."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.linalg import eig


@dataclass(frozen=True)
class Small:
    """The projected matrices V'MV, V'CV, V'KV, each (m, m)."""

    M: Any
    C: Any
    K: Any

    def eigenvalues(self) -> Any:
        """Eigenvalues (2m,) alone."""
        state, rate, _ = self._state()
        return np.linalg.eigvals(state).astype(complex) * rate

    def right_shapes(self) -> tuple[Any, Any]:
        """Eigenvalues (2m,) and right shapes x (m, 2m)."""
        state, rate, _ = self._state()
        values, right = np.linalg.eig(state)
        return values.astype(complex) * rate, right[: len(self.M)]

    def eigen(self) -> tuple[Any, Any, Any, Any]:
        """Eigenvalues (2m,), right x and left y (m, 2m) of the quadratic problem, and the condition numbers (2m,)."""
        size = len(self.M)
        state, rate, inverse = self._state()
        values, left, right = eig(state, left=True, right=True)
        with np.errstate(divide="ignore"):
            condition = 1.0 / np.abs(np.sum(left.conj() * right, axis=0))
        return values * rate, right[:size], inverse.T @ left[size:], condition

    def _state(self) -> tuple[Any, float, Any]:
        size = len(self.M)
        inverse = np.linalg.inv(self.M)
        stiffness, damping = inverse @ self.K, inverse @ self.C
        rate = float(np.sqrt(np.max(np.abs(stiffness)))) or 1.0
        return (
            np.block([[np.zeros((size, size)), np.eye(size)], [-stiffness / rate**2, -damping / rate]]),
            rate,
            inverse,
        )
