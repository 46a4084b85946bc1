"""One eigenvalue with its mode: what an analysis hands on, and what a simulation or a cycle can start from."""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike


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


def damping_ratio(eigenvalues: ArrayLike) -> Any:
    """-Re lambda / |lambda| [-], NaN at lambda = 0."""
    with np.errstate(invalid="ignore", divide="ignore"):
        return -np.real(eigenvalues) / np.abs(eigenvalues)


def modal_assurance(shapes: ArrayLike, others: ArrayLike) -> Any:
    """MAC of every column of `shapes` (n, k) with every column of `others` (n, m): shape (k, m).

    MAC(a, b) = |a^H b|^2 / ((a^H a) (b^H b)) is 1 for the same shape, 0 for shapes that have nothing in common. Source:
    R. J. Allemang, D. L. Brown 1982, Proc. 1st International Modal Analysis Conference, 110-116.

    Raises `SignalError` when the shapes have different numbers of rows, or one is nothing but zeros.

    >>> modal_assurance([[1.0, 0.0], [1.0, 1.0]], [[2.0], [2.0]]).round(3).tolist()
    [[1.0], [0.5]]
    """
    from squealbox.signals import SignalError

    a, b = (np.atleast_2d(np.asarray(each, dtype=complex)) for each in (shapes, others))
    if a.shape[0] != b.shape[0]:
        raise SignalError(f"shapes of {a.shape[0]} and {b.shape[0]} places: expected the same places in both")
    own, theirs = (np.sum(np.abs(each) ** 2, axis=0) for each in (a, b))
    if not (np.all(own > 0.0) and np.all(theirs > 0.0)):
        raise SignalError("a mode shape is nothing but zeros: expected motion somewhere")
    return np.abs(a.conj().T @ b) ** 2 / np.outer(own, theirs)
