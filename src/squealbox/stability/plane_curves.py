"""Geometry of curves traced in the unit square."""

from typing import Any

import numpy as np


def onto_side(inside: np.ndarray, outside: np.ndarray) -> Any:
    """Where the way from a point in the square to one beyond it leaves the square."""
    way = outside - inside
    ends = np.where(way > 0.0, 1.0, 0.0)
    shares = np.divide(ends - inside, way, out=np.ones(2), where=way != 0.0)
    return np.clip(inside + np.min(np.clip(shares, 0.0, 1.0)) * way, 0.0, 1.0)


def between(a: np.ndarray, b: np.ndarray, start: np.ndarray, first: np.ndarray, tangent: np.ndarray) -> bool:
    """True when the start lies on the step from a to b, which goes the same way."""
    span = b - a
    share = (start - a) @ span / (span @ span)
    off = np.linalg.norm(start - a - share * span)
    return bool(0.0 < share <= 1.0 and off < 0.1 * np.linalg.norm(span) and first @ tangent > 0.0)


def passed(point: np.ndarray, gradient: np.ndarray, curves: list[Any], tangents: list[Any], near: float) -> bool:
    """True when a traced curve runs through `point` with its unstable side on the same side."""
    for points, directions in zip(curves, tangents, strict=True):
        chord = points[1:] - points[:-1]
        length = np.linalg.norm(chord, axis=-1)
        beside = np.linalg.norm(0.5 * (points[1:] + points[:-1]) - point, axis=-1) < 0.6 * length + 1e-4
        for i in np.nonzero(beside)[0]:
            s = np.linspace(0.0, 1.0, 33)[:, None]
            curve = _hermite(points[i], points[i + 1], directions[i] * length[i], directions[i + 1] * length[i], s)
            distance = np.linalg.norm(curve - point, axis=-1)
            left = np.array([-chord[i, 1], chord[i, 0]])
            if np.min(distance) < 0.02 * length[i] + 1e-6 + near and left @ gradient > 0.0:
                return True
    return False


def _hermite(a: np.ndarray, b: np.ndarray, slope_a: np.ndarray, slope_b: np.ndarray, s: np.ndarray) -> Any:
    return (
        (2.0 * s**3 - 3.0 * s**2 + 1.0) * a
        + (s**3 - 2.0 * s**2 + s) * slope_a
        + (3.0 * s**2 - 2.0 * s**3) * b
        + (s**3 - s**2) * slope_b
    )
