"""Systems with massless degrees of freedom: the eigenvalues that remain when M is singular.

With s a typical angular frequency and lambda = s nu, the pencil E x' = A x with x = (q, q') has

    E = [[I, 0], [0, M]],   A = [[0, I], [-K_eff, -C_eff]]      (scaled)

and a singular E. Let U2 span its left null space: U2' A x = 0 holds at every instant. So x = Z y with Z the null
space of U2' A, and what is left is (U1' E Z) y' = (U1' A Z) y, a smaller pencil with the same finite eigenvalues. That
is repeated until E can be inverted; once is static condensation of a damped massless degree of freedom, twice or more
of an undamped one. Eigenvalues at infinity are deflated exactly and not, as by QZ, spread out to 1e8 by round-off.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.result import COMPLETED, Array, Outcome, Result, quantity
from squealbox.stability.family import Steady, steady_sliding
from squealbox.system import DesignOrSystem
from squealbox.words import growing

ZERO = 1e-12  # singular values below this share of 1 (all matrices are scaled to 1) count as zero


@dataclass(frozen=True, kw_only=True, eq=False)
class FiniteSpectrum(Result):
    """The finite eigenvalues of one system, as :func:`finite_spectrum` returns them.

    The outcome is "completed"; "singular_pencil" when every number is an eigenvalue, as for a degree of freedom without
    mass, damping and stiffness; or that of steady sliding.
    """

    eigenvalues: Array = quantity("eigenvalue", "1/s", "finite eigenvalues, by falling growth rate")
    infinite: int = 0

    @property
    def growth_rate(self) -> Any:
        """Re lambda [1/s]; positive grows."""
        return np.real(self.eigenvalues)

    @property
    def frequency(self) -> Any:
        """|Im lambda| / (2 pi) [Hz]."""
        return np.abs(np.imag(self.eigenvalues)) / (2.0 * np.pi)

    def summary(self) -> str:
        """One line for each eigenvalue, conjugates once."""
        if not self.outcome.ok:
            return self.outcome.told
        shown = [value for value in self.eigenvalues if value.imag >= 0.0]
        lines = [growing(value.real, value.imag / (2.0 * np.pi)) for value in shown]
        return "\n".join([*lines, f"{self.infinite} eigenvalues at infinity"])


def finite_spectrum(design_or_system: DesignOrSystem, time: float = 0.0) -> FiniteSpectrum:
    """The finite eigenvalues of (lambda^2 M + lambda C_eff + K_eff) u = 0 about steady sliding, M singular or not.

    Parameters
    ----------
    design_or_system : without leading axes
    time : instant of schedules [s]

    Of 2n eigenvalues a massless degree of freedom takes at least one to infinity, without a damper two; `infinite`
    counts them. Raises `ValueError` for leading axes. Accuracy: that of the rank decisions, 1e-12 of the largest entry.

    >>> from squealbox.system import System
    >>> found = finite_spectrum(System(M=[[0.0]], C=[[2.0]], K=[[6.0]]))
    >>> [round(float(x), 9) for x in found.growth_rate]
    [-3.0]
    """
    steady = steady_sliding(design_or_system, time)
    if steady.K.ndim > 2:
        raise ValueError(f"leading axes {steady.K.shape[:-2]}: finite_spectrum() is for one system")
    inputs = {"system": design_or_system, "time": time}
    nothing = np.zeros(0, dtype=complex)
    if not bool(steady.equilibrium.exists):
        return FiniteSpectrum(eigenvalues=nothing, inputs=inputs, outcome=steady.equilibrium.outcome)
    left, right, rate = _pencil(steady)
    size = len(left)
    found = reduced(left, right)
    if found is None:
        message = "every number is an eigenvalue: a motion without inertia, damping and stiffness"
        return FiniteSpectrum(eigenvalues=nothing, inputs=inputs, outcome=Outcome("singular_pencil", message))
    left, right, _ = found
    values = rate * np.linalg.eigvals(np.linalg.solve(left, right)).astype(complex) if len(left) else nothing
    order = np.lexsort((-values.imag, np.abs(values.imag), -values.real))
    return FiniteSpectrum(
        eigenvalues=values[order], infinite=size - len(values), inputs=inputs, outcome=Outcome(COMPLETED)
    )


def _pencil(steady: Steady) -> tuple[Any, Any, float]:
    """E and A with entries up to about 1, and the time scale s [1/s] they are scaled with."""
    mass, damping, stiffness = (float(np.max(np.abs(matrix))) for matrix in (steady.M, steady.C, steady.K))
    rate = np.sqrt(stiffness / mass) if mass > 0.0 else stiffness / damping if damping > 0.0 else 1.0
    rate = rate if np.isfinite(rate) and rate > 0.0 else 1.0
    parts = (rate**2 * steady.M, rate * steady.C, steady.K)
    unit = max(float(np.max(np.abs(part))) for part in parts) or 1.0
    inertia, damper, spring = (part / unit for part in parts)
    zero, one = np.zeros(inertia.shape), np.eye(len(inertia))
    return np.block([[one, zero], [zero, inertia]]), np.block([[zero, one], [-spring, -damper]]), rate


def reduced(left: np.ndarray, right: np.ndarray) -> tuple[Any, Any, Any] | None:
    """A pencil with the same finite eigenvalues whose first matrix can be inverted, and what its states stand for.

    None where every number is an eigenvalue.
    """
    columns = np.eye(len(left))
    while len(left):
        u, sizes, _ = np.linalg.svd(left)
        rank = int(np.sum(sizes > ZERO))
        if rank == len(left):
            break
        constraints = u[:, rank:].T @ right
        _, strengths, rows = np.linalg.svd(constraints)
        if strengths[-1] <= ZERO:
            return None
        free = rows[len(strengths) :].T
        left, right = u[:, :rank].T @ left @ free, u[:, :rank].T @ right @ free
        columns = columns @ free
    return left, right, columns
