"""Where stability is lost on a side of the rectangle itself, as under no load: only the side is stable, all else grows.

No curve can be followed there, for beyond the side nothing is known. The crossed edges that stand on the side are put
together to one curve along it instead.
"""

from collections.abc import Callable
from typing import Any

import numpy as np

from squealbox.stability.cells import Crossing

NEAR = 1e-9  # in shares of the axes: what is stable here and grows this far inside lies on the side


def lying_on_a_side(edges: list[Crossing], level: Callable[[Any], Any]) -> tuple[list[Any], list[Crossing]]:
    """Curves (points, 2) along the sides of the unit square, unstable on their left, and the edges left over.

    `level` is positive where a mode grows, at points (k, 2).
    """
    standing: dict[tuple[int, float], list[Crossing]] = {}
    left = []
    for edge in edges:
        axis = 0 if edge.stable[0] != edge.unstable[0] else 1
        if edge.stable[axis] in (0.0, 1.0):
            standing.setdefault((axis, edge.stable[axis]), []).append(edge)
        else:
            left.append(edge)
    curves: list[Any] = []
    for (axis, side), group in standing.items():
        points = np.array([edge.stable for edge in group])
        inside = points.copy()
        inside[:, axis] = abs(side - NEAR)
        lies = (level(points) <= 0.0) & (level(inside) > 0.0)
        left += [edge for edge, on in zip(group, lies, strict=True) if not on]
        if np.any(lies):
            sizes = np.array([edge.size for edge in group])[lies]
            curves += _pieces(points[lies], sizes, axis, side)
    return curves, left


def _pieces(points: np.ndarray, sizes: np.ndarray, axis: int, side: float) -> list[Any]:
    """Points on one side in order, cut where the next is more than a cell away."""
    order = np.argsort(points[:, 1 - axis], kind="stable")
    points, sizes = points[order], sizes[order]
    points, first = np.unique(points, axis=0, return_index=True)
    sizes = sizes[first]
    gaps = np.diff(points[:, 1 - axis]) > 1.5 * np.maximum(sizes[1:], sizes[:-1])
    # inwards is on the left when going down the low x side, up the high one, right along the low y side
    backwards = (axis == 0) == (side == 0.0)
    pieces = np.split(points, np.nonzero(gaps)[0] + 1)
    return [piece[::-1] if backwards else piece for piece in pieces]
