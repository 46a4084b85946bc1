"""Growth before decay: how far a stable, non-normal system can swell before its eigenvalues are obeyed.

States are measured by the mechanical energy (q', M q')/2 + (q, K_sym q)/2, or, where K_sym is not positive definite,
with a typical stiffness in its place. With A the state matrix in coordinates where that is the length squared: the
numerical abscissa max eig (A + A')/2 is the fastest growth at the first instant, max |exp(A t)| the largest
amplification ever, and the pseudospectrum min sigma(z - A) tells which perturbation of A moves an eigenvalue to z.
Source: Trefethen and Embree 2005, Spectra and Pseudospectra; Schmid 2007, Annual Review of Fluid Mechanics 39.
"""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import public
from squealbox.result import Array, Outcome, Result, quantity
from squealbox.stability.family import Steady, steady_sliding
from squealbox.system import DesignOrSystem

PER_PERIOD = 12  # instants of the envelope in the shortest period
MOST_POINTS = 20000


@dataclass(frozen=True, kw_only=True, eq=False)
class TransientGrowth(Result):
    """Largest amplification of the norm over time and the start that attains it; see :func:`transient_growth`."""

    numerical_abscissa: Any = quantity("", "1/s", "fastest growth rate of the norm at the first instant")
    spectral_abscissa: Any = quantity("", "1/s", "largest growth rate of the eigenvalues")
    amplification: Any = quantity("", "1", "largest norm over the norm at the start; energy grows by its square")
    time: Any = quantity("", "s", "instant at which it is reached")
    start_q: Array = quantity("dof", "m", "optimal start, displacement from steady sliding, energy 1 J")
    start_qd: Array = quantity("dof", "m/s", "optimal start, velocity")
    instants: Array = quantity("instant", "s", "instants of the envelope")
    envelope: Array = quantity("instant", "1", "largest amplification possible at each instant")

    coordinates: ClassVar = {"instant": "instants"}
    table_over: ClassVar = ("instant",)

    def summary(self) -> str:
        """Amplification, when, and the two abscissae."""
        return (
            f"largest amplification {float(self.amplification):.6g} at {float(self.time):.6g} s; growth rate at the "
            f"first instant {float(self.numerical_abscissa):+.6g} 1/s, "
            f"of the eigenvalues {float(self.spectral_abscissa):+.6g} 1/s"
        )


@public()
def transient_growth(
    design_or_system: DesignOrSystem, duration: float | None = None, *, points: int = 400, at: float = 0.0
) -> TransientGrowth:
    """Numerical abscissa, largest transient amplification and the optimal start of one system.

    Parameters
    ----------
    design_or_system : without leading axes
    duration : span searched [s]; by default eight decay times of the slowest mode, or ten periods without decay
    points : least number of instants of the envelope, between which the largest is refined; 12 in the shortest period
    at : instant of schedules [s]

    An unstable system grows without bound: the outcome is then "unstable" and the numbers hold for `duration`. Raises
    `ValueError` without steady sliding.
    """
    steady = _single(design_or_system, at)
    matrix, root = _energy_coordinates(steady)
    values = np.linalg.eigvals(matrix)
    spectral, slowest = float(np.max(values.real)), float(np.min(np.abs(values)))
    if duration is None:
        duration = 8.0 / -spectral if spectral < -1e-9 * np.max(np.abs(values)) else 20.0 * np.pi / max(slowest, 1e-300)
    per_period = float(np.max(np.abs(values.imag))) * duration / (2.0 * np.pi) * PER_PERIOD
    instants = np.linspace(0.0, duration, int(np.clip(per_period, points, MOST_POINTS)))
    envelope = _norms(matrix, instants)
    time, amplification = _largest(matrix, instants, envelope)
    from scipy.linalg import expm

    _, _, rows = np.linalg.svd(expm(matrix * time))
    start = np.linalg.solve(root, rows[0]) * np.sqrt(2.0)
    half = start.size // 2
    grown = Outcome("unstable", "an eigenvalue grows, so the amplification has no bound; numbers hold for the duration")
    return TransientGrowth(
        numerical_abscissa=float(np.linalg.eigvalsh(0.5 * (matrix + matrix.T))[-1]),
        spectral_abscissa=spectral,
        amplification=amplification,
        time=time,
        start_q=start[:half],
        start_qd=start[half:],
        instants=instants,
        envelope=envelope,
        inputs={"system": design_or_system, "at": at},
        settings={"duration": duration, "points": points},
        outcome=grown if spectral > 1e-9 * float(np.max(np.abs(values))) else Outcome(),
    )


@public()
def pseudospectrum(design_or_system: DesignOrSystem, real: ArrayLike, imaginary: ArrayLike, at: float = 0.0) -> Any:
    """Least singular value of z - A [1/s] on the grid z = real + i imaginary, shape (len(imaginary), len(real)).

    `at` [s]: instant at which schedules are taken.

    A is taken in energy coordinates, so a contour at epsilon encloses where a perturbation of A of that size in the
    energy norm can move eigenvalues. Raises `ValueError` without steady sliding.
    """
    matrix, _ = _energy_coordinates(_single(design_or_system, at))
    z = np.asarray(real, dtype=float)[None, :] + 1j * np.asarray(imaginary, dtype=float)[:, None]
    return np.linalg.svd(z[..., None, None] * np.eye(matrix.shape[0]) - matrix, compute_uv=False)[..., -1]


def _single(design_or_system: DesignOrSystem, time: float) -> Steady:
    steady = steady_sliding(design_or_system, time)
    if steady.K.ndim > 2:
        raise ValueError(f"leading axes {steady.K.shape[:-2]}: expected one system")
    if not bool(steady.equilibrium.exists):
        raise ValueError(f"no steady sliding: {steady.equilibrium.outcome} ({steady.equilibrium.outcome.message})")
    return steady


def _energy_coordinates(steady: Steady) -> tuple[Any, Any]:
    """The state matrix in coordinates whose squared length is twice the energy, and the root that leads there."""
    size = steady.M.shape[-1]
    least = float(np.linalg.eigvalsh(0.5 * (steady.M + steady.M.T))[0])
    if not least > np.finfo(float).eps * np.max(np.abs(steady.M)):
        raise ValueError(f"M has the eigenvalue {least:.6g} kg: an energy needs a positive definite mass")
    symmetric = 0.5 * (steady.K + steady.K.T)
    if np.linalg.eigvalsh(symmetric)[0] <= 0.0:
        symmetric = steady.M * np.linalg.norm(steady.K, 2) / np.linalg.norm(steady.M, 2)
    zero = np.zeros((size, size))
    root = np.block([[np.linalg.cholesky(symmetric).T, zero], [zero, np.linalg.cholesky(steady.M).T]])
    lower = np.linalg.solve(steady.M, np.hstack([steady.K, steady.C]))
    plain = np.vstack([np.hstack([zero, np.eye(size)]), -lower])
    return root @ plain @ np.linalg.inv(root), root


def _norms(matrix: np.ndarray, instants: np.ndarray) -> Any:
    """|exp(A t)| at equally spaced instants, by repeated multiplication."""
    from scipy.linalg import expm

    step = expm(matrix * (instants[1] - instants[0]))
    power = np.eye(matrix.shape[0])
    norms = np.empty(len(instants))
    for i in range(len(instants)):
        norms[i] = np.linalg.norm(power, 2)
        power = step @ power
    return norms


def _largest(matrix: np.ndarray, instants: np.ndarray, envelope: np.ndarray) -> tuple[float, float]:
    from scipy.linalg import expm
    from scipy.optimize import minimize_scalar

    i = int(np.argmax(envelope))
    low, high = instants[max(i - 1, 0)], instants[min(i + 1, len(instants) - 1)]
    found = minimize_scalar(
        lambda t: -float(np.linalg.norm(expm(matrix * t), 2)),
        bounds=(low, high),
        method="bounded",
        options={"xatol": 1e-12},
    )
    if -float(found.fun) > envelope[i]:
        return float(found.x), -float(found.fun)
    return float(instants[i]), float(envelope[i])
