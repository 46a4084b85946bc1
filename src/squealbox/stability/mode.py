"""One eigenvalue with its mode: what an analysis hands on, and what a simulation or a cycle can start from."""

from dataclasses import dataclass
from typing import Any

import numpy as np


class OneEigenvalue:
    """What follows from the one eigenvalue a result carries."""

    eigenvalue: Any

    @property
    def angular_frequency(self) -> float:
        """|Im lambda| [rad/s]."""
        return float(abs(np.imag(self.eigenvalue)))

    @property
    def frequency(self) -> float:
        """|Im lambda| / (2 pi) [Hz]."""
        return self.angular_frequency / (2.0 * np.pi)


@dataclass(frozen=True, eq=False)
class Mode(OneEigenvalue):
    """One mode of one system, from which a simulation or a limit cycle can start.

    eigenvalue [1/s]; shape u (n,) with |u| = 1 and its largest part real; left w (n,), scaled so that
    w^H (2 lambda M + C) u = 1; steady (n,), the steady sliding displacement [m]; index, the place in the spectrum;
    entry, the place in the leading axes.
    """

    eigenvalue: complex
    shape: Any
    left: Any
    steady: Any
    index: int
    entry: tuple[int, ...] = ()

    @property
    def growth_rate(self) -> float:
        """Re lambda [1/s]; positive grows."""
        return float(np.real(self.eigenvalue))

    @property
    def damping_ratio(self) -> float:
        """-Re lambda / |lambda| [-]; negative grows."""
        return float(damping_ratio(self.eigenvalue))

    def start(self, amplitude: float, phase: float = 0.0) -> tuple[Any, Any]:
        """Displacement and velocity (q, qd) about steady sliding; `amplitude` of u in m, `phase` in rad."""
        turned = amplitude * np.exp(1j * phase) * self.shape
        return self.steady + turned.real, (self.eigenvalue * turned).real


def damping_ratio(eigenvalues: Any) -> Any:
    """-Re lambda / |lambda| [-], NaN at lambda = 0."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return -np.real(eigenvalues) / np.abs(eigenvalues)
