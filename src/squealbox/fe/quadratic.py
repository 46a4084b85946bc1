"""The full quadratic eigenproblem near a point, (lambda^2 M + lambda C + K) u = 0, by shift-invert Arnoldi.

With time in units of 1/|s| and the residual as second unknown the companion form of the shifted problem is

    (lambda - s)^-1 is an eigenvalue of [u, v] -> [p, u + s p],   Q(s) p = -(C + s M) u - M v,   v = lambda u

so one factor of Q(s) serves all eigenvalues about s. Unscaled, the two halves of [u, v] differ by |lambda| and digits
are lost; here v is lambda u / |s|. A band is covered by disks about points on the imaginary axis, each as large as the
farthest eigenvalue that was found about its centre; they overlap so far that they hold every damping ratio below 0.1.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from scipy.sparse.linalg import ArpackNoConvergence, LinearOperator, eigs

from squealbox.factorisation import Factor, factor
from squealbox.fe.pencil import MOST_DAMPED, Pencil, vibrating

MOST_SHIFTS = 60  # disks that a band may take before the search gives up


@dataclass(frozen=True)
class FullModes:
    """Eigenvalues (k,) [1/s] with Im > 0 and shapes (n, k), |u| = 1; backward_error (k,); covered: the band's disks
    leave no gap on the imaginary axis; factorisations: how many were needed.
    """

    eigenvalues: Any
    shapes: Any
    backward_error: Any
    covered: bool
    factorisations: int


def modes_near(pencil: Pencil, shift: complex, count: int, base: Factor | None = None) -> tuple[Any, Any]:
    """The `count` eigenvalues nearest to `shift` [1/s] and shapes (n, count); `base` is a factor of Q(shift)."""
    size, scale = pencil.size, abs(shift)
    base = factor(pencil.at(shift)) if base is None else base

    def applied(state: np.ndarray) -> Any:
        u, v = state[:size], state[size:] * scale
        p = -base.solve(pencil.C @ u + shift * (pencil.M @ u) + pencil.M @ v)
        return np.concatenate([p, (u + shift * p) / scale])

    operator = LinearOperator((2 * size, 2 * size), matvec=applied, dtype=complex)
    start = np.random.default_rng(3).standard_normal(2 * size).astype(complex)
    count = min(count, 2 * size - 2)
    try:
        inverse, states = eigs(operator, k=count, which="LM", v0=start, tol=0.0, ncv=min(2 * size, 2 * count + 20))
    except ArpackNoConvergence as error:
        inverse, states = error.eigenvalues, error.eigenvectors
    values = shift + 1.0 / inverse
    shapes = states[:size] / np.linalg.norm(states[:size], axis=0)
    return values, shapes


def full_modes(pencil: Pencil, band: tuple[float, float], count: int = 60) -> FullModes:
    """All modes of frequency between `band` (f1, f2) [Hz] in disks about the imaginary axis.

    Pairs whose damping ratio is above 0.1 in size are left out, as on a basis.
    """
    low, high = (2.0 * np.pi * float(f) for f in band)
    gaps, values, shapes, made = [(low, high)], [], [], 0
    while gaps and made < MOST_SHIFTS:
        start, end = gaps.pop()
        centre = 0.5 * (start + end)
        found, columns = modes_near(pencil, 1j * centre, count)
        made += 1
        radius = float(np.max(np.abs(found - 1j * centre), initial=0.0)) if len(found) else 0.0
        depth = MOST_DAMPED * (centre + radius)
        reach = 0.98 * np.sqrt(max(radius**2 - depth**2, 0.0))
        near = np.abs(found - 1j * centre) <= radius
        keep = near & (found.imag >= low) & (found.imag <= high) & vibrating(found)
        values.append(found[keep])
        shapes.append(columns[:, keep])
        if reach <= 0.0:  # too few eigenvalues for the disk to reach down to them
            count *= 2
            gaps.append((start, end))
            continue
        for part in ((start, centre - reach), (centre + reach, end)):
            if part[1] - part[0] > 1e-9 * high:
                gaps.append(part)
    every, columns = np.concatenate(values), np.concatenate(shapes, axis=1)
    every, columns = _once(every, columns)
    errors = pencil.backward_error(every, columns)
    return FullModes(every, columns, errors, not gaps, made)


def _once(values: np.ndarray, shapes: np.ndarray) -> tuple[Any, Any]:
    """Each mode once: the disks overlap, so an eigenvalue may have been found twice with the same shape."""
    order = np.argsort(values.imag, kind="stable")
    kept: list[int] = []
    for i in order:
        alike = [j for j in kept[-12:] if abs(values[i] - values[j]) <= 1e-9 * abs(values[i])]
        if alike:
            basis, _ = np.linalg.qr(shapes[:, alike])
            rest = shapes[:, i] - basis @ (basis.conj().T @ shapes[:, i])
            if np.linalg.norm(rest) < 1e-3:
                continue
        kept.append(int(i))
    return values[kept], shapes[:, kept]
