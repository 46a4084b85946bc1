"""Stability of two degrees of freedom without eigenvalues: characteristic polynomial, Routh-Hurwitz, closed roots.

A second road to the same answers, used as a check of the eigenvalue solvers; the compiled twins for maps of millions of
points are in `kernels_two_dof` and are reached through `spectra`.
"""

from typing import Any

import numpy as np

from squealbox.stability.family import steady_sliding
from squealbox.system import DesignOrSystem, Linearised


def characteristic_polynomial(about: Linearised) -> Any:
    """Coefficients (..., 5) of det(s^2 M + s C + K), highest power first, for two degrees of freedom."""
    if about.M.shape[-1] != 2:
        raise ValueError(f"{about.M.shape[-1]} degrees of freedom: the closed form is for 2")
    m, c, k = about.M, about.C, about.K
    a4 = _mixed(m, m)
    a3 = _mixed(m, c) + _mixed(c, m)
    a2 = _mixed(m, k) + _mixed(c, c) + _mixed(k, m)
    a1 = _mixed(c, k) + _mixed(k, c)
    return np.stack(np.broadcast_arrays(a4, a3, a2, a1, _mixed(k, k)), axis=-1)


def hurwitz_determinants(coefficients: np.ndarray) -> Any:
    """The quantities a3, a1, a0 and a1 (a3 a2 - a1) - a3^2 a0 of the monic quartic, (..., 4).

    All are positive just when every real part is negative. The last vanishes where a pair is on the imaginary axis, or
    two real roots cancel.
    """
    a = coefficients[..., 1:] / coefficients[..., :1]
    a3, a2, a1, a0 = (a[..., i] for i in range(4))
    return np.stack([a3, a1, a0, a1 * (a3 * a2 - a1) - a3**2 * a0], axis=-1)


def routh_hurwitz(design_or_system: DesignOrSystem, time: float = 0.0) -> Any:
    """True where steady sliding of two degrees of freedom is asymptotically stable, (...); False without equilibrium.

    `time` [s]: instant at which schedules are taken.

    >>> from squealbox.system import System
    >>> bool(routh_hurwitz(System(M=[[1, 0], [0, 1]], C=[[1, 0], [0, 1]], K=[[2, 1], [1, 2]])))
    True
    """
    about = steady_sliding(design_or_system, time)
    with np.errstate(all="ignore"):
        determinants = hurwitz_determinants(characteristic_polynomial(about))
    return np.all(determinants > 0.0, axis=-1)


def undamped_squares(about: Linearised) -> tuple[Any, Any]:
    """The two values of lambda^2 of M q'' + K q = 0, complex (...): they merge where flutter begins without damping."""
    a, b, c = _mixed(about.M, about.M), _mixed(about.M, about.K) + _mixed(about.K, about.M), _mixed(about.K, about.K)
    root = np.sqrt(np.asarray(b**2 - 4.0 * a * c, dtype=complex))
    far = -(b + np.where(np.real(np.conj(b) * root) >= 0.0, root, -root)) / 2.0  # no cancellation
    with np.errstate(all="ignore"):
        near = np.where(far == 0.0, 0.0, c / far)
    return far / a, near


def _mixed(a: np.ndarray, b: np.ndarray) -> Any:
    return a[..., 0, 0] * b[..., 1, 1] - a[..., 0, 1] * b[..., 1, 0]
