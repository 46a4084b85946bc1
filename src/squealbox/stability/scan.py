"""Where do growth rates change sign along a line? A scan in one batched call, refined where a window may hide.

The n growth rates are sorted at each value, so the k-th largest is continuous in the parameter whatever the modes do,
and every crossing of every mode is a change of sign of one of them. Modes that are neutral everywhere (undamped and
uncoupled) are left out. A system neutral as a whole (no damping, or purely gyroscopic) has no growth rate that changes
sign at its onset; for it the scanned function is `coalescence`, which is analytic through the merging of two modes.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.stability.eigenvalues import spectrum
from squealbox.stability.family import Family
from squealbox.system import Linearised

NEUTRAL = 1e-11  # |Re lambda| below this share of the largest |lambda|, at all values, is a mode without damping
DETAIL = 17  # values on which a suspicious stretch is scanned again


@dataclass(frozen=True)
class Scan:
    """Values of the parameter and, for each, the functions whose signs are followed (points, functions)."""

    family: Family
    values: Any
    functions: Any
    neutral: bool
    undamped: int

    def at(self, value: float) -> Any:
        """The functions at one value."""
        return _functions(self.family.at(np.array([value])), self.neutral, self.undamped)[0]

    def brackets(self) -> Iterator[tuple[int, int]]:
        """(i, k): function k changes sign between values i and i + 1, in rising order of the values."""
        growing = self.functions > 0.0
        known = np.isfinite(self.functions)
        changes = (growing[1:] != growing[:-1]) & known[1:] & known[:-1]
        yield from ((int(i), int(k)) for i, k in zip(*np.nonzero(changes), strict=True))

    def root(self, i: int, k: int, relative: float = 1e-12) -> float:
        """The value at which function k vanishes between values i and i + 1, by Brent's method."""
        from scipy.optimize import brentq

        low, high = float(self.values[i]), float(self.values[i + 1])
        if self.functions[i, k] == 0.0:
            return low
        tolerance = relative * max(abs(low), abs(high))
        root: float = brentq(lambda value: float(self.at(value)[k]), low, high, xtol=tolerance, rtol=relative)
        return root


def scan(family: Family, low: float, high: float, points: int, refinements: int = 3) -> Scan:
    """The functions on `points` values from low to high, and on more of them wherever two crossings may hide."""
    values = np.linspace(low, high, points)
    about = family.at(values)
    eigenvalues = spectrum(about)
    known = np.isfinite(eigenvalues[..., 0])
    neutral = bool(np.all(is_neutral(about)[known])) if np.any(known) else False
    undamped = 0 if neutral else _undamped(eigenvalues[known])
    found = Scan(family, values, _functions(about, neutral, undamped), neutral, undamped)
    for _ in range(refinements):
        more = _suspicious(found)
        if more.size == 0:
            break
        values = np.concatenate([found.values, more])
        functions = np.concatenate([found.functions, _functions(family.at(more), neutral, undamped)])
        order = np.argsort(values, kind="stable")
        found = Scan(family, values[order], functions[order], neutral, undamped)
    return found


def first_function(samples: list[Linearised]) -> Callable[[Linearised], Any] | None:
    """The first of the scanned functions where modes without damping call for it; None where the growth rate serves.

    `samples` are the matrices at a few values, with any leading axes.
    """
    eigenvalues = np.stack([spectrum(about) for about in samples])
    known = np.isfinite(eigenvalues[..., 0])
    neutral = bool(np.all(np.stack([is_neutral(about) for about in samples])[known])) if np.any(known) else False
    undamped = 0 if neutral else _undamped(eigenvalues[known])
    return (lambda about: _functions(about, neutral, undamped)[..., 0]) if neutral or undamped else None


def coalescence(eigenvalues: Any) -> Any:
    """For spectra symmetric in lambda -> -lambda: positive where a mode grows, zero where two merge or one is zero.

    With s = lambda^2, Re (s_i - s_j)^2 is negative just where two s are a conjugate pair, and s positive where a root
    is real; both are analytic in a parameter where the eigenvalues themselves are not.
    """
    squares, half = _squares(eigenvalues)
    worst = np.max(squares.real, axis=-1)
    for i in range(half):
        for j in range(i):
            worst = np.maximum(worst, -np.real((squares[..., i] - squares[..., j]) ** 2))
    return worst


def merging(eigenvalues: Any) -> complex:
    """The eigenvalue at the onset of a neutral system: the mean of the two nearest, or zero at a divergence."""
    squares, half = _squares(eigenvalues)
    pairs = [(abs(squares[i] - squares[j]) ** 2, i, j) for i in range(half) for j in range(i)]
    nearest = min(pairs, default=(np.inf, 0, 0))
    if np.min(np.abs(squares)) <= nearest[0]:
        return 0j
    return complex(0.5 * (eigenvalues[nearest[1]] + eigenvalues[nearest[2]]))


def _squares(eigenvalues: Any) -> tuple[Any, int]:
    half = eigenvalues.shape[-1] // 2
    squares = eigenvalues[..., :half] ** 2
    scale = np.max(np.abs(squares), axis=-1, keepdims=True)
    return squares / np.where(scale > 0.0, scale, 1.0), half


def on_divergence(about: Linearised) -> Any:
    """True where K_eff is singular: steady sliding is not unique there, but an eigenvalue is known to be zero."""
    state = about.equilibrium
    if state.outcome != "singular":
        return np.zeros(np.shape(state.exists), dtype=bool)
    return ~np.asarray(state.exists) & np.all(state.sliding_speed != 0.0, axis=-1)


def _functions(about: Linearised, neutral: bool, undamped: int) -> Any:
    functions = _smooth_functions(about, neutral, undamped)
    return np.where(on_divergence(about)[..., None], 0.0, functions)


def _smooth_functions(about: Linearised, neutral: bool, undamped: int) -> Any:
    eigenvalues = spectrum(about)
    if neutral:
        return coalescence(eigenvalues)[..., None]
    growth = eigenvalues[..., : eigenvalues.shape[-1] // 2].real
    if undamped:
        nearest = np.argsort(np.abs(growth), axis=-1, kind="stable")[..., undamped:]
        growth = np.take_along_axis(growth, nearest, axis=-1)
    return -np.sort(-growth, axis=-1)


def is_neutral(about: Linearised) -> Any:
    """True where the spectrum is symmetric in lambda -> -lambda: no damping at all, or purely gyroscopic coupling."""
    size = np.max(np.abs(about.K), axis=(-1, -2))
    scale = np.sqrt(size * np.max(np.abs(about.M), axis=(-1, -2)))
    none = np.max(np.abs(about.C), axis=(-1, -2)) <= 1e-15 * scale
    skew = np.max(np.abs(about.C + np.swapaxes(about.C, -1, -2)), axis=(-1, -2)) <= 1e-15 * scale
    symmetric = np.max(np.abs(about.K - np.swapaxes(about.K, -1, -2)), axis=(-1, -2)) <= 1e-15 * size
    return none | (skew & symmetric)


def _undamped(eigenvalues: Any) -> int:
    """Number of modes that are neutral at every value."""
    if eigenvalues.size == 0:
        return 0
    growth = np.abs(eigenvalues[..., : eigenvalues.shape[-1] // 2].real)
    scale = np.max(np.abs(eigenvalues), axis=-1, keepdims=True)
    return int(np.min(np.sum(growth <= NEUTRAL * scale, axis=-1)))


def _suspicious(found: Scan) -> Any:
    """New values around extrema that come near zero from one side: a narrow window may cross it twice unseen."""
    functions, values = found.functions, found.values
    middle, before, after = functions[1:-1], functions[:-2], functions[2:]
    with np.errstate(invalid="ignore"):
        bends = (middle - before) * (after - middle) <= 0.0
        swing = np.maximum(np.abs(middle - before), np.abs(after - middle))
        towards = np.sign(middle) != np.sign(2.0 * middle - before - after)  # the peak points at zero
        near = bends & towards & (np.abs(middle) <= 2.0 * swing) & (swing > 0.0)
    places = np.nonzero(np.any(near, axis=-1))[0]
    spans = [np.linspace(values[i], values[i + 2], DETAIL)[1:-1] for i in places]
    return np.setdiff1d(np.concatenate(spans), values) if spans else np.array([])
