"""Many least-squares searches side by side: every step evaluates the designs of all of them in one call.

    min over u in [0, 1]^p of sum_i rho(r_i(u)^2)

by Levenberg and Marquardt's steps, each kept in the box; parameters that do not vary are held. A start, a profile and a
polish are the same search from other places, so a calibration is some tens of calls with thousands of designs each.
"""

from collections.abc import Callable
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

Residuals = Callable[[Any], Any]  # (points, p) in [0, 1] -> (points, m)
STEP = 1e-6
STEPS = 80
WORST = 1e6  # residual of a point without an answer


def searched(
    residuals: Residuals, start: ArrayLike, free: np.ndarray, robust: bool, steps: int = STEPS
) -> tuple[Any, Any]:
    """Where each search ends, shape (b, p), and its sum of squares (b,); `free` (b, p) says what may vary."""
    u = np.clip(np.array(start, dtype=float), 0.0, 1.0)
    count, size = u.shape
    damping = np.full(count, 1e-3)
    r, jacobian = linearised(residuals, u)
    cost = losses(r, robust)
    left = np.arange(count)  # searches that go on: the others are not asked again
    for _ in range(steps):
        at, slopes, away, lift = u[left], jacobian[left], r[left], damping[left]
        weight = 1.0 / np.sqrt(1.0 + away**2) if robust else np.ones_like(away)
        moving = (
            free[left]
            & ~((at <= 0.0) & _pushes(slopes, away, weight, -1))
            & ~((at >= 1.0) & _pushes(slopes, away, weight, 1))
        )
        weighted = slopes * weight[:, :, None]
        gram = np.einsum("bmi,bmj->bij", weighted, slopes) * (moving[:, :, None] & moving[:, None, :])
        slope = np.einsum("bmi,bm->bi", weighted, away) * moving
        diagonal = np.einsum("bii->bi", gram)
        lifted = lift[:, None] * np.maximum(diagonal, 1e-12 * np.max(diagonal, axis=1, keepdims=True))
        lifted = np.where(moving, lifted + 1e-300, 1.0)
        step = -np.linalg.solve(gram + lifted[:, :, None] * np.eye(size), slope[..., None])[..., 0]
        trial = np.clip(at + np.where(np.isfinite(step), step, 0.0), 0.0, 1.0)
        further, ahead = linearised(residuals, trial)
        lower = losses(further, robust)
        better = lower <= cost[left]
        small = np.max(np.abs(trial - at), axis=1) < 1e-13
        gained = cost[left] - lower
        done = small | (better & (gained <= 1e-14 * np.maximum(cost[left], 1e-12)) & (lift < 1e-6)) | (lift > 1e10)
        taken = left[better]
        u[taken], r[taken], jacobian[taken], cost[taken] = trial[better], further[better], ahead[better], lower[better]
        damping[left] = np.where(better, np.maximum(lift * 0.1, 1e-14), lift * 10.0)
        left = left[~done]
        if not left.size:
            break
    return u, cost


def losses(r: np.ndarray, robust: bool) -> Any:
    """Sum of rho(r^2) of each point: r^2, or 2 (sqrt(1 + r^2) - 1)."""
    return np.sum(2.0 * (np.sqrt(1.0 + r**2) - 1.0) if robust else r**2, axis=1)


def linearised(residuals: Residuals, u: np.ndarray) -> tuple[Any, Any]:
    """Residuals (b, m) and their derivatives (b, m, p) by central differences, one-sided at the bounds."""
    count, size = u.shape
    shifts = STEP * np.eye(size)
    up, down = np.minimum(u[:, None, :] + shifts, 1.0), np.maximum(u[:, None, :] - shifts, 0.0)
    every = np.concatenate([u[:, None, :], up, down], axis=1).reshape(-1, size)
    values = residuals(every).reshape(count, 1 + 2 * size, -1)
    width = np.einsum("bii->bi", up - down)
    slopes = (values[:, 1 : 1 + size] - values[:, 1 + size :]) / width[:, :, None]
    return values[:, 0].copy(), np.swapaxes(slopes, 1, 2).copy()


def _pushes(jacobian: np.ndarray, r: np.ndarray, weight: np.ndarray, sign: int) -> Any:
    """Where descent would leave the box on the side of `sign`."""
    return -sign * np.einsum("bmi,bm->bi", jacobian, r * weight) > 0.0
