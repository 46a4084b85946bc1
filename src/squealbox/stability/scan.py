"""Where do growth rates change sign along a line? A scan in one batched call, refined where a window may hide.

The n growth rates are sorted at each value, so the k-th largest is continuous in the parameter whatever the modes do,
and every crossing of every mode is a change of sign of one of them. Modes that are neutral everywhere (undamped and
uncoupled) are left out. A system neutral as a whole (no damping, or purely gyroscopic) has no growth rate that changes
sign at its onset; for it the scanned function is `coalescence`, which is analytic through the merging of two modes.
"""

import itertools
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.stability.family import SteadyFamily
from squealbox.stability.in_band import growth_in_band
from squealbox.stability.state_matrix import spectrum
from squealbox.system import Linearised

NEUTRAL = 1e-11  # |Re lambda| below this share of the largest |lambda|, at all values, is a mode without damping
EDGE = 52  # halvings towards a value without an answer
ROUND_OFF = 1e-13  # two modes that only pass each other come out as a pair apart by the root of the round-off
DETAIL, DETAIL_IN_BAND = 17, 5  # values on which a suspicious stretch is scanned again
BATCHES, NODES = 4, 9  # in which a bracket is made narrow, and values of each
BESIDE = 1e-6  # share of the bracket beside a guess, where its sign is looked for
NEAR, NEAR_IN_BAND = 2.0, 0.5  # times the swing of a bend from which zero may lie behind it; a parabola reaches 1/8


@dataclass(frozen=True)
class Scan:
    """Values of the parameter and, for each, the functions whose signs are followed (points, functions)."""

    family: SteadyFamily
    values: Any
    functions: Any
    neutral: bool = False
    undamped: int = 0

    def at(self, value: float) -> Any:
        """The functions at one value."""
        return self.functions_at(np.array([value]))[0]

    def functions_at(self, values: np.ndarray) -> Any:
        """The functions at several values, of a reduced brake the growth rates in its band."""
        if self.family.band is None:
            return self.functions_of(self.family.at(values))
        found = growth_in_band(self.family, values)
        missing = max(self.functions.shape[-1] - found.shape[-1], 0)
        return np.pad(found, ((0, 0), (0, missing)), constant_values=np.nan)

    def functions_of(self, about: Linearised) -> Any:
        """The functions of matrices that are known, not of a reduced brake."""
        return _functions(about, self.neutral, self.undamped)

    @property
    def answered(self) -> Any:
        """True at the values where something is known, shape (points,)."""
        return np.any(np.isfinite(self.functions), axis=-1)

    @property
    def gaps(self) -> list[tuple[float, float]]:
        """Stretches (low, high) without steady sliding; low = high for a single value."""
        unknown = np.concatenate([[False], ~self.answered, [False]])
        edges = np.flatnonzero(unknown[1:] != unknown[:-1]).reshape(-1, 2)
        return [(float(self.values[i]), float(self.values[k - 1])) for i, k in edges]

    def brackets(self) -> Iterator[tuple[int, int]]:
        """(i, k): function k changes sign between values i and i + 1, in rising order of the values."""
        growing = self.functions > 0.0
        known = np.isfinite(self.functions)
        changes = (growing[1:] != growing[:-1]) & known[1:] & known[:-1]
        yield from ((int(i), int(k)) for i, k in zip(*np.nonzero(changes), strict=True))

    def jumps(self) -> Iterator[tuple[int, int, int]]:
        """(i, j, k): function k has another sign on the two sides i and j of a stretch without an answer."""
        answered = np.flatnonzero(self.answered)
        for i, j in itertools.pairwise(answered):
            if j > i + 1:
                before, after = self.functions[i], self.functions[j]
                known = np.isfinite(before) & np.isfinite(after)
                yield from ((int(i), int(j), int(k)) for k in np.flatnonzero(known & ((before > 0.0) != (after > 0.0))))

    def root(self, i: int, k: int, relative: float = 1e-12) -> float:
        """The value at which function k vanishes between values i and i + 1, by Brent's method."""
        from scipy.optimize import brentq

        low, high = float(self.values[i]), float(self.values[i + 1])
        if self.functions[i, k] == 0.0:
            return low
        tolerance = relative * max(abs(low), abs(high))
        if self.family.recipe is None and self.family.band is None:  # a batch costs hardly more than one value
            low, high = self._narrowed(low, high, k, tolerance)
            if high - low <= tolerance:
                return 0.5 * (low + high)

        def function(value: float) -> float:
            found = float(self.at(value)[k])
            if np.isnan(found):  # an unknown value met by chance: its neighbour answers
                found = float(self.at(value + (tolerance if value + tolerance < high else -tolerance))[k])
            return found

        root: float = brentq(function, low, high, xtol=tolerance, rtol=relative)
        return root

    def _narrowed(self, low: float, high: float, k: int, tolerance: float) -> tuple[float, float]:
        """The bracket of function k after a few batches, each about the root of a polynomial through the last."""
        near: Any = ()
        for _ in range(BATCHES):
            values = np.unique(np.clip([*np.linspace(low, high, NODES), *near], low, high))
            functions = self.functions_at(values)[:, k]
            change = np.flatnonzero((functions[1:] > 0.0) != (functions[:-1] > 0.0))
            if not np.all(np.isfinite(functions)) or change.size != 1:
                break  # what is less plain is left to Brent's method
            low, high = (float(x) for x in values[change[0] : change[0] + 2])
            if high - low <= tolerance:
                break
            with np.errstate(all="ignore"):  # of the inverse function, by Lagrange's formula
                shares = functions / (functions - functions[:, None])
                np.fill_diagonal(shares, 1.0)
                guess = float(values @ np.prod(shares, axis=1))
            beside = max(BESIDE * (high - low), 0.4 * tolerance)
            near = (guess - beside, guess + beside) if low < guess < high else ()
        return low, high


def scan(family: SteadyFamily, low: float, high: float, points: int, refinements: int = 3) -> Scan:
    """The functions on `points` values from low to high, and on more of them wherever two crossings may hide."""
    values = np.linspace(low, high, points)
    found = _first(family, values) if family.band is None else Scan(family, values, growth_in_band(family, values))
    found = _with(found, _beside_gaps(found))
    for _ in range(refinements):
        more = _suspicious(found)
        if more.size == 0:
            break
        found = _with(found, more)
    return found


def _first(family: SteadyFamily, values: np.ndarray) -> Scan:
    about = family.at(values)
    eigenvalues = spectrum(about)
    known = np.asarray(about.equilibrium.exists) & np.any(np.isfinite(eigenvalues), axis=-1)
    neutral = bool(np.all(is_neutral(about)[known])) if np.any(known) else False
    undamped = _left_out(about, eigenvalues, known, neutral)
    return Scan(family, values, _functions(about, neutral, undamped), neutral, undamped)


def _with(found: Scan, more: np.ndarray) -> Scan:
    """The scan with more values."""
    more = np.setdiff1d(more, found.values)
    if more.size == 0:
        return found
    values = np.concatenate([found.values, more])
    new = found.functions_at(more)
    wider = ((0, 0), (0, new.shape[-1] - found.functions.shape[-1]))
    functions = np.concatenate([np.pad(found.functions, wider, constant_values=np.nan), new])
    order = np.argsort(values, kind="stable")
    return Scan(found.family, values[order], functions[order], found.neutral, found.undamped)


def _beside_gaps(found: Scan) -> Any:
    """Values ever nearer to where the answers end: what happens beside a gap is no more than a step away from it."""
    answered, values, more = found.answered, found.values, []
    ends = np.flatnonzero(answered[1:] != answered[:-1])
    for i in ends:
        inside, outside = (values[i], values[i + 1]) if answered[i] else (values[i + 1], values[i])
        step = inside - outside
        for _ in range(EDGE):  # the last value with an answer, by halving
            middle = 0.5 * (inside + outside)
            if middle in (inside, outside):
                break
            if np.any(np.isfinite(found.at(float(middle)))):
                inside = middle
            else:
                outside = middle
        more.append(np.append(outside + step * 2.0 ** -np.arange(1, EDGE), [inside, outside]))
    inside_range = np.concatenate(more) if more else np.zeros(0)
    return inside_range[(inside_range >= values[0]) & (inside_range <= values[-1])]


def _left_out(about: Linearised, eigenvalues: np.ndarray, known: np.ndarray, neutral: bool) -> int:
    """Number of functions that say nothing: rigid-body motions, and modes that are neutral at every value."""
    if not np.any(known):
        return 0
    rigid = int(np.min(np.broadcast_to(about.equilibrium.floating, known.shape)[known]))
    return rigid if neutral else _undamped(eigenvalues[known])


def first_function(samples: list[Linearised]) -> Callable[[Linearised], Any] | None:
    """The first of the scanned functions where modes without damping call for it; None where the growth rate serves.

    `samples` are the matrices at a few values, with any leading axes.
    """
    eigenvalues = np.stack([spectrum(about) for about in samples])
    known = np.stack([np.asarray(about.equilibrium.exists) for about in samples])
    known &= np.any(np.isfinite(eigenvalues), axis=-1)
    neutral = bool(np.all(np.stack([is_neutral(about) for about in samples])[known])) if np.any(known) else False
    undamped = min((_left_out(about, values, where, neutral)
                    for about, values, where in zip(samples, eigenvalues, known, strict=True) if np.any(where)),
                   default=0)  # fmt: skip
    return (lambda about: _functions(about, neutral, undamped)[..., 0]) if neutral or undamped else None


def coalescence(eigenvalues: np.ndarray, rigid: int = 0) -> Any:
    """For spectra symmetric in lambda -> -lambda: positive where a mode grows, zero where two merge or one is zero.

    With s = lambda^2, Re (s_i - s_j)^2 is negative just where two s are a conjugate pair, and s positive where a root
    is real; both are analytic in a parameter where the eigenvalues themselves are not. `rigid` zeros are left out.
    """
    squares, half = _squares(eigenvalues)
    order = np.argsort(np.abs(squares), axis=-1, kind="stable")  # rigid-body zeros first, infinite ones last
    squares = np.take_along_axis(squares, order, axis=-1)[..., rigid:]
    worst = np.fmax.reduce(squares.real, axis=-1, initial=np.nan)
    for i in range(half - rigid):
        for j in range(i):
            worst = np.fmax(worst, -np.real((squares[..., i] - squares[..., j]) ** 2))
    return worst - ROUND_OFF


def merging(eigenvalues: np.ndarray) -> complex:
    """The eigenvalue at the onset of a neutral system: the mean of the two nearest, or zero at a divergence."""
    squares, half = _squares(eigenvalues)
    pairs = [(abs(squares[i] - squares[j]) ** 2, i, j) for i in range(half) for j in range(i)]
    nearest = min(pairs, default=(np.inf, 0, 0))
    if np.min(np.abs(squares)) <= nearest[0]:
        return 0j
    return complex(0.5 * (eigenvalues[nearest[1]] + eigenvalues[nearest[2]]))


def _squares(eigenvalues: np.ndarray) -> tuple[Any, int]:
    half = eigenvalues.shape[-1] // 2
    squares = eigenvalues[..., :half] ** 2
    scale = np.max(np.nan_to_num(np.abs(squares)), axis=-1, keepdims=True)
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
        return coalescence(eigenvalues, undamped)[..., None]
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


def _undamped(eigenvalues: np.ndarray) -> int:
    """Number of modes that are neutral at every value."""
    if eigenvalues.size == 0:
        return 0
    growth = np.abs(eigenvalues[..., : eigenvalues.shape[-1] // 2].real)
    scale = np.max(np.nan_to_num(np.abs(eigenvalues)), axis=-1, keepdims=True)
    return int(np.min(np.sum(growth <= NEUTRAL * scale, axis=-1)))


def _suspicious(found: Scan) -> Any:
    """New values around extrema that come near zero from one side: a narrow window may cross it twice unseen."""
    functions, values = found.functions, found.values
    detail, share = (DETAIL, NEAR) if found.family.band is None else (DETAIL_IN_BAND, NEAR_IN_BAND)
    middle, before, after = functions[1:-1], functions[:-2], functions[2:]
    with np.errstate(invalid="ignore"):
        bends = (middle - before) * (after - middle) <= 0.0
        swing = np.maximum(np.abs(middle - before), np.abs(after - middle))
        towards = np.sign(middle) != np.sign(2.0 * middle - before - after)  # the peak points at zero
        near = bends & towards & (np.abs(middle) <= share * swing) & (swing > 0.0)
    places = np.nonzero(np.any(near, axis=-1))[0]
    spans = [np.linspace(values[i], values[i + 2], detail)[1:-1] for i in places]
    return np.setdiff1d(np.concatenate(spans), values) if spans else np.array([])
