"""First natural frequencies of exported matrices, to be held against those the code itself printed."""

from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from scipy.sparse import sparray

DENSE = 300


def first_frequencies(mass: "sparray", stiffness: "sparray", count: int = 10) -> Any:
    """The lowest `count` frequencies [Hz] of K u = w^2 M u, ascending; rigid ones are 0 to rounding, as is w^2 < 0.

    Massless freedoms are allowed: the eigenvalues mu = 1 / (w^2 - s) of (K - s M)^-1 M at a shift s < 0 are looked for,
    and a massless freedom has mu = 0. An unsymmetric K may give complex w^2; their frequency is |Im sqrt(-w^2)|.

    >>> from scipy.sparse import csr_array
    >>> K = csr_array([[2e6, -1e6], [-1e6, 2e6]])
    >>> [round(float(f), 3) for f in first_frequencies(csr_array(np.eye(2)), K, 2)]
    [159.155, 275.664]
    """
    size = mass.shape[0]
    held, springs = mass.diagonal(), abs(stiffness.diagonal())
    rich = (held > 0.0) & (springs > 0.0)
    if not rich.any():
        return np.zeros(0)
    shift = -1e-6 * float(np.median(springs[rich] / held[rich]))
    count = min(count, int(np.count_nonzero(held)))
    if size <= DENSE or count > size // 3:
        from scipy.linalg import eigvals, solve

        near = solve((stiffness - shift * mass).toarray(), mass.toarray())
        mu = eigvals(near)
    else:
        mu = _by_iteration(mass, stiffness, shift, count)
    mu = mu[np.argsort(-mu.real)]
    mu = mu[mu.real > 1e-13 * abs(mu[0])][:count]
    squared = shift + 1.0 / mu
    squared = np.where(abs(squared) < 1e-6 * abs(shift), 0.0, squared)
    rate = np.sqrt(-squared.astype(complex))
    return np.sort(abs(rate.imag)) / (2.0 * np.pi)


def _by_iteration(mass: "sparray", stiffness: "sparray", shift: float, count: int) -> Any:
    from scipy.sparse.linalg import LinearOperator, eigs, splu

    near = (stiffness - shift * mass).tocsc()
    factor = splu(near, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}, diag_pivot_thresh=1e-3)
    size = mass.shape[0]
    operator = LinearOperator((size, size), matvec=lambda v: factor.solve(mass @ v), dtype=float)
    start = np.random.default_rng(1).standard_normal(size)
    values: Any = eigs(operator, k=min(count + 4, size - 2), which="LM", v0=start, return_eigenvectors=False)
    return values
