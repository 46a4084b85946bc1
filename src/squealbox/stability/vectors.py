"""Right and left modes out of the eigenvectors of the state matrix, merged modes included."""

from typing import Any

import numpy as np

from squealbox.system import Linearised


def mode_vectors(about: Linearised, eigenvalues: Any, states: Any, usable: Any) -> tuple[Any, Any, Any]:
    """Right modes, left modes with w^H (2 lambda M + C) u = 1, and condition numbers, from the states of `eig`."""
    size = about.M.shape[-1]
    inverse, invertible = _inverse(states)
    with np.errstate(all="ignore"):
        condition = np.linalg.norm(inverse, axis=-1) * np.linalg.norm(states, axis=-2)
        right = _phased(states[..., :size, :])
        mass = np.where(usable[..., None, None], about.M, np.eye(size))
        left = np.linalg.solve(np.swapaxes(mass, -1, -2), np.conj(np.swapaxes(inverse[..., size:], -1, -2)))
    damping = np.where(usable[..., None, None], about.C, 0.0)
    stiffness = np.where(usable[..., None, None], about.K, 0.0)
    lost = ~invertible & usable
    if np.any(lost):
        null = _left_null(mass[lost], damping[lost], stiffness[lost], eigenvalues[lost])
        left[lost], condition[lost] = null, np.inf
    slope = 2.0 * eigenvalues[..., None, :] * (mass @ right) + damping @ right
    scale = np.sum(np.conj(left) * slope, axis=-2)
    with np.errstate(all="ignore"):
        scaled = left / np.conj(scale)[..., None, :]
    return right, np.where(np.isfinite(scaled), scaled, left), condition


def _inverse(states: Any) -> tuple[Any, Any]:
    with np.errstate(all="ignore"):
        invertible = np.linalg.cond(states) < 0.01 / np.finfo(float).eps
    safe = np.where(invertible[..., None, None], states, np.eye(states.shape[-1]))
    return np.linalg.inv(safe), invertible


def _left_null(mass: Any, damping: Any, stiffness: Any, eigenvalues: Any) -> Any:
    """Left null vectors of lambda^2 M + lambda C + K by singular values: exact even where modes have merged."""
    value = eigenvalues[..., None, None]
    dynamic = value**2 * mass[..., None, :, :] + value * damping[..., None, :, :] + stiffness[..., None, :, :]
    vectors, _, _ = np.linalg.svd(dynamic)
    return np.swapaxes(vectors[..., -1], -1, -2)


def _phased(shapes: Any) -> Any:
    """Shapes of length 1 whose first largest part is real and positive."""
    size = np.abs(shapes)
    first = np.argmax(size >= (1.0 - 1e-6) * np.max(size, axis=-2, keepdims=True), axis=-2)
    largest = np.take_along_axis(shapes, first[..., None, :], axis=-2)
    return shapes * (np.conj(largest) / np.abs(largest)) / np.linalg.norm(shapes, axis=-2, keepdims=True)
