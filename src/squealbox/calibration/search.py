"""Many least-squares searches side by side: every step evaluates the designs of all of them in one call.

    min over u in [0, 1]^p of sum_i rho(r_i(u)^2)

by Levenberg and Marquardt's steps, each kept in the box; parameters that do not vary are held. A start, a profile and a
polish are the same search from other places, so a calibration is some tens of calls with thousands of designs each.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

Residuals = Callable[[Any], Any]  # (points, p) in [0, 1] -> (points, m)
STEP = 1e-6
STEPS = 80
WORST = 1e6  # residual of a point without an answer


def searched(residuals: Residuals, start: Any, free: Any, robust: bool, steps: int = STEPS) -> tuple[Any, Any]:
    """Where each search ends, shape (b, p), and its sum of squares (b,); `free` (b, p) says what may vary."""
    u = np.clip(np.array(start, dtype=float), 0.0, 1.0)
    count, size = u.shape
    damping = np.full(count, 1e-3)
    r, jacobian = linearised(residuals, u)
    cost = losses(r, robust)
    active = np.ones(count, dtype=bool)
    for _ in range(steps):
        weight = 1.0 / np.sqrt(1.0 + r**2) if robust else np.ones_like(r)
        moving = (
            free & ~((u <= 0.0) & _pushes(jacobian, r, weight, -1)) & ~((u >= 1.0) & _pushes(jacobian, r, weight, 1))
        )
        weighted = jacobian * weight[:, :, None]
        gram = np.einsum("bmi,bmj->bij", weighted, jacobian) * (moving[:, :, None] & moving[:, None, :])
        slope = np.einsum("bmi,bm->bi", weighted, r) * moving
        diagonal = np.einsum("bii->bi", gram)
        lift = damping[:, None] * np.maximum(diagonal, 1e-12 * np.max(diagonal, axis=1, keepdims=True))
        lift = np.where(moving, lift + 1e-300, 1.0)
        step = -np.linalg.solve(gram + lift[:, :, None] * np.eye(size), slope[..., None])[..., 0]
        trial = np.clip(u + np.where(np.isfinite(step), step, 0.0), 0.0, 1.0)
        trial[~active] = u[~active]
        further, slopes = linearised(residuals, trial)
        lower = losses(further, robust)
        better = active & (lower <= cost)
        small = np.max(np.abs(trial - u), axis=1) < 1e-13
        gained = cost - lower
        u[better], r[better], jacobian[better] = trial[better], further[better], slopes[better]
        done = small | (better & (gained <= 1e-14 * np.maximum(cost, 1e-12)) & (damping < 1e-6)) | (damping > 1e10)
        cost = np.where(better, lower, cost)
        damping = np.where(better, np.maximum(damping * 0.1, 1e-14), damping * 10.0)
        active &= ~done
        if not np.any(active):
            break
    return u, cost


def losses(r: Any, robust: bool) -> Any:
    """Sum of rho(r^2) of each point: r^2, or 2 (sqrt(1 + r^2) - 1)."""
    return np.sum(2.0 * (np.sqrt(1.0 + r**2) - 1.0) if robust else r**2, axis=1)


def linearised(residuals: Residuals, u: Any) -> tuple[Any, Any]:
    """Residuals (b, m) and their derivatives (b, m, p) by central differences, one-sided at the bounds."""
    count, size = u.shape
    shifts = STEP * np.eye(size)
    up, down = np.minimum(u[:, None, :] + shifts, 1.0), np.maximum(u[:, None, :] - shifts, 0.0)
    every = np.concatenate([u[:, None, :], up, down], axis=1).reshape(-1, size)
    values = residuals(every).reshape(count, 1 + 2 * size, -1)
    width = np.einsum("bii->bi", up - down)
    slopes = (values[:, 1 : 1 + size] - values[:, 1 + size :]) / width[:, :, None]
    return values[:, 0].copy(), np.swapaxes(slopes, 1, 2).copy()


def _pushes(jacobian: Any, r: Any, weight: Any, sign: int) -> Any:
    """Where descent would leave the box on the side of `sign`."""
    return -sign * np.einsum("bmi,bm->bi", jacobian, r * weight) > 0.0
