"""Means over a fast harmonic: E[h] = (1/2 pi) int h(v + w sin(phase)) dphase, with kinks of h at known places.

Gauss-Legendre in the phase, in panels between the kinks, graded by halves towards u = 0, where what is averaged turns.
Depends on: nothing.
"""

from collections.abc import Callable, Sequence
from typing import Any

import numpy as np

PANELS, NODES = 12, 16  # panels on each side of a reversal, each half as wide as the last, and Gauss points in each


def mean_over_phase(h: Callable[[Any], Any], v: Any, w: Any, kinks: Sequence[Any] = ()) -> Any:
    """E[h(v + w sin)] for arrays v, w of one shape (...); `h` is called with u of shape (..., panels, nodes).

    `kinks` are values |u| > 0 at which h is not smooth; u = 0 always counts as one.

    >>> round(float(mean_over_phase(np.abs, np.asarray(0.0), np.asarray(1.0))), 12) == round(2.0 / np.pi, 12)
    True
    """
    nodes, weights = np.polynomial.legendre.leggauss(NODES)
    grades = np.r_[0.0, 0.5 ** np.arange(PANELS - 1, -1, -1.0)]
    turn = np.arcsin(np.clip(-v / w, -1.0, 1.0))
    cuts = [np.arcsin(np.clip((sign * kink - v) / w, -1.0, 1.0)) for kink in kinks for sign in (1.0, -1.0)]
    below, above = ((end - turn)[..., None] * grades + turn[..., None] for end in (-0.5 * np.pi, 0.5 * np.pi))
    more = np.stack([turn, *(np.broadcast_to(cut, turn.shape) for cut in cuts)], axis=-1)
    edges = np.sort(np.concatenate([below, above, more], axis=-1), axis=-1)
    half, middle = 0.5 * np.diff(edges), 0.5 * (edges[..., 1:] + edges[..., :-1])
    u = v[..., None, None] + w[..., None, None] * np.sin(middle[..., None] + half[..., None] * nodes)
    return np.sum(h(u) * weights * half[..., None], axis=(-1, -2)) / np.pi
