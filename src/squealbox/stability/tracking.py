"""Every mode followed along a parameter, through crossings, veering and coalescence.

Modes at two neighbouring values are paired by the bi-orthogonal criterion |w_i^H (lambda_i M + C + lambda_j M) u_j|
|w_j^H (...) u_i|, 1 for the same mode and 0 for another, whatever their scaling, and by how near their eigenvalues are
to those expected. Where the pairing is not clear the step is halved; where it stays unclear, at the coalescence itself,
the nearest eigenvalue decides and the step is marked. Of a reduced brake only the modes of its band are followed: a
mode may leave the band, or come into it, only at an edge of it.
"""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import public
from squealbox.family import DesignOrRecipe, Varied
from squealbox.fe import MOST_DAMPED, band_pairs, vibrating
from squealbox.labelled import Labelled, Labels
from squealbox.result import Array, Result, quantity
from squealbox.stability.eigenvalues import MARGINAL, ComplexModes, modes_of
from squealbox.stability.family import Steady, SteadyFamily

CLEAR = 0.8  # criterion from which a pairing counts as clear
HALVINGS = 12
NOWHERE = complex(np.nan, np.nan)
Band = tuple[float, float]  # [Hz]
EDGE = 0.03  # share of a frequency, or of a damping ratio, within which a mode may leave or enter the band of a step


@dataclass(frozen=True)
class TrackedPoint:
    """The modes at one value, in the order of the tracks.

    eigenvalues (2n,), right and left (n, 2n), the criterion of each pairing (2n,), and `clear`, False where a pairing
    was decided by the nearest eigenvalue. Of a reduced brake, instead of 2n, twice the tracks there are by then, the
    conjugates last, and NaN where a mode is not in the band.
    """

    value: float
    eigenvalues: Any
    right: Any
    left: Any
    criterion: Any
    clear: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class TrackedModes(Result):
    """Modes along a parameter, the same mode always in the same column, as :func:`tracked_modes` returns it.

    Of a reduced brake a column is a mode that was in the band at any of the values, NaN where it is not.
    """

    value: Array = quantity("value", "", "the parameter, in its own unit")
    eigenvalues: Array = quantity("value mode", "1/s", "eigenvalue of each track")
    right: Array = quantity("value dof mode", "1", "right modes, |u| = 1")
    criterion: Array = quantity("value mode", "1", "bi-orthogonal criterion of the pairing with the value before")
    clear: Array = quantity("value", "1", "False where a pairing was decided by the nearest eigenvalue")
    parameter: str = ""

    @property
    def growth_rate(self) -> Array:
        """Re lambda [1/s], (values, modes)."""
        return np.real(self.eigenvalues)

    @property
    def frequency(self) -> Array:
        """|Im lambda| / (2 pi) [Hz], (values, modes)."""
        return np.abs(np.imag(self.eigenvalues)) / (2.0 * np.pi)

    def labelled(self) -> Labelled:
        """The arrays with the parameter as coordinate, and growth rate and frequency beside the eigenvalues."""
        rate = Labels(("value", "mode"), self.growth_rate, {"units": "1/s", "long_name": "growth rate"})
        hertz = Labels(("value", "mode"), self.frequency, {"units": "Hz", "long_name": "frequency"})
        return super().labelled().with_({"growth_rate": rate, "frequency": hertz})

    def summary(self) -> str:
        """Each mode with its frequency and growth rate at both ends, and the values between which it begins to grow."""
        first, last = float(self.value[0]), float(self.value[-1])
        half = self.eigenvalues.shape[-1] // 2
        rows = [f"{half} modes along {self.parameter} = {first:.6g} to {last:.6g}, {len(self.value)} values"]
        size = np.max(np.abs(np.nan_to_num(self.eigenvalues)), axis=-1, keepdims=True)
        growing, there = self.growth_rate > MARGINAL * size, np.isfinite(self.growth_rate)
        for i in range(half):
            k = np.flatnonzero(there[:, i])
            if not len(k):
                continue
            begin, end = k[[0, -1]]
            hertz, rate = self.frequency[[begin, end], i], self.growth_rate[[begin, end], i]
            text = f"  mode {i + 1}: {hertz[0]:.6g} to {hertz[1]:.6g} Hz, {rate[0]:+.6g} to {rate[1]:+.6g} 1/s"
            if len(k) < len(self.value):
                text += f", known at {len(k)} of {len(self.value)} values"
                text += f", from {self.value[begin]:.6g} to {self.value[end]:.6g}"
            starts = np.nonzero(growing[1:, i] & there[:-1, i] & ~growing[:-1, i])[0]
            spans = [f"{self.value[at]:.6g} and {self.value[at + 1]:.6g}" for at in starts]
            text += ", grows everywhere" if np.all(growing[k, i]) else ""
            rows.append(text + (f", begins to grow between {'; '.join(spans)}" if spans else ""))
        unclear = ", ".join(f"{value:.6g}" for value in self.value[~np.asarray(self.clear, dtype=bool)])
        return "\n".join(
            rows + [f"  modes merge, pairing decided by the nearest eigenvalue: at {unclear}"] * bool(unclear)
        )


def track(
    design: DesignOrRecipe, parameter: Varied, values: ArrayLike | None = None, *, time: float = 0.0
) -> Iterator[TrackedPoint]:
    """Walk along the values of a parameter with the modes always in the order of the first value.

    Parameters
    ----------
    design : a design, or a function of one value that returns a design or a system
    parameter, values : {name: values}, increasing or decreasing, such as {"friction.static": np.linspace(0, 1, 50)}; or
        the name and the values one after the other. Where the pairing between two is unclear, values between are tried
    time : [s] instant at which schedules are taken

    Values without steady sliding are passed over with NaN. Of a reduced brake the modes in its band are followed: one
    that leaves the band is NaN from there on and takes up its own place again where it comes back, one that comes into
    the band for the first time stands behind the others. Raises `ParameterError` for fewer than one value.
    """
    yield from _tracked(SteadyFamily.along("track", design, parameter, values, count=1, time=time))


def _tracked(family: SteadyFamily) -> Iterator[TrackedPoint]:
    array = family.spans[0]
    if family.band is not None:
        yield from _track_in_band(family, family.band, array)
        return
    steady = family.at(array)
    modes = modes_of(steady)
    # Of all neighbours at once: most steps are clear, and no more is asked of them.
    neighbours = _likeness(_Place.of(array, steady, modes, slice(-1)), _Place.of(array, steady, modes, slice(1, None)))
    last: _Place | None = None
    for i, value in enumerate(array):
        here = _Place.of(float(value), steady, modes, i)
        if not bool(modes.exists[i]):
            yield here.point(np.zeros(here.eigenvalues.size), False)
            continue
        if last is None:
            last = here
            yield here.point(np.ones(here.eigenvalues.size), True)
            continue
        known = None
        if modes.exists[i - 1]:
            known = (neighbours[0][i - 1][last.order], neighbours[1][i - 1][last.order])
        last, criterion, clear = _followed(family, last, here, HALVINGS, known)
        yield last.point(criterion, clear)


def _track_in_band(family: SteadyFamily, band: Band, values: np.ndarray) -> Iterator[TrackedPoint]:
    last: _Place | None = None
    for value in values:
        here = _place_in_band(family, band, float(value))
        if here is None:
            width, size = (0, 0) if last is None else (len(last.order), len(last.right))
            nothing = np.full((size, 2 * width), NOWHERE)
            none = np.full(2 * width, NOWHERE)
            yield TrackedPoint(float(value), none, nothing, nothing, np.zeros(2 * width), False)
            continue
        criterion, clear = np.ones(len(here.order)), True
        if last is not None:
            here, criterion, clear = _followed(family, last, here, HALVINGS)
        last = here
        yield _both(last, criterion, clear)


def _place_in_band(family: SteadyFamily, band: Band, value: float) -> "_Place | None":
    """The modes with Im > 0 in the band at one value; None where there is no steady sliding."""
    design = family.one(value)
    parts = design.parts()
    pairs = None if parts is None else band_pairs(parts[0], band)
    if parts is not None and pairs is not None:
        small = parts[0]
        order = np.arange(len(pairs.values))
        return _Place(value, small.M, small.C, pairs.values, pairs.right, pairs.left, order)
    steady = family.at(np.array([value]))
    modes = modes_of(steady)
    if not modes.exists[0]:
        return None
    whole = _Place.of(value, steady, modes, 0)
    inside = vibrating(whole.eigenvalues) & ~_outside(whole.eigenvalues, band, 0.0)
    found = whole.ordered(np.flatnonzero(inside))
    return replace(found, order=np.arange(len(found.order)))


@public()
def tracked_modes(
    design: DesignOrRecipe, parameter: Varied, values: ArrayLike | None = None, *, time: float = 0.0
) -> TrackedModes:
    """The whole of :func:`track` as one result, a labelled dataset by ``to_dataset()``.

    `time` [s]: instant at which schedules are taken.
    """
    family = SteadyFamily.along("tracked_modes", design, parameter, values, count=1, time=time)
    points = list(_tracked(family))
    columns = {name: np.array([getattr(p, name) for p in points]) for name in ("value", "clear")}
    columns |= {name: _stacked([getattr(p, name) for p in points]) for name in ("eigenvalues", "right", "criterion")}
    arrays: dict[str, Any] = columns
    return TrackedModes(**arrays, parameter=family.name, inputs=family.inputs)


def _stacked(arrays: list[Any]) -> Any:
    """Arrays of one shape but for their last axis, filled up by NaN: each of its halves at the end."""
    most = np.max([np.shape(each) for each in arrays], axis=0)
    if all(np.shape(each) == tuple(most) for each in arrays):
        return np.array(arrays)
    nothing = NOWHERE if np.iscomplexobj(arrays[0]) else np.nan
    whole = np.full((len(arrays), *most), nothing)
    for row, each in zip(whole, arrays, strict=True):
        half = each.shape[-1] // 2
        if half:
            row[..., :half], row[..., most[-1] // 2 : most[-1] // 2 + half] = each[..., :half], each[..., half:]
    return whole


@dataclass(frozen=True)
class _Place:
    """Matrices and ordered modes at one value, or at each of several (a slice); `order` is that of the tracks.

    In a band the order of a track that is not there is -1, and its mode the one it was seen with last.
    """

    value: Any
    mass: Any
    damping: Any
    eigenvalues: Any
    right: Any
    left: Any
    order: Any

    @staticmethod
    def of(value: float | np.ndarray, steady: Steady, modes: ComplexModes, i: int | slice) -> "_Place":
        order = np.arange(modes.eigenvalues.shape[-1])
        return _Place(value, steady.M[i], steady.C[i], modes.eigenvalues[i], modes.right[i], modes.left[i], order)

    def ordered(self, order: np.ndarray) -> "_Place":
        return _Place(
            self.value, self.mass, self.damping, self.eigenvalues[order], self.right[:, order], self.left[:, order],
            self.order[order],
        )  # fmt: skip

    def after(self, last: "_Place", order: np.ndarray) -> "_Place":
        """The modes here in the order of the tracks of `last`, and those that came behind them."""
        if np.all(order >= 0):
            return self.ordered(order)
        gone = np.flatnonzero(order < 0)
        found = {}
        for name in ("eigenvalues", "right", "left"):
            here, before = getattr(self, name), getattr(last, name)
            found[name] = np.zeros((*here.shape[:-1], len(order)), dtype=complex)
            found[name][..., order >= 0] = here[..., order[order >= 0]]
            found[name][..., gone] = before[..., gone]
        return _Place(self.value, self.mass, self.damping, **found, order=order)

    def point(self, criterion: np.ndarray, clear: bool) -> TrackedPoint:
        return TrackedPoint(self.value, self.eigenvalues, self.right, self.left, criterion, clear)


def _both(place: _Place, criterion: np.ndarray, clear: bool) -> TrackedPoint:
    """What is there of the tracks in a band, with the conjugates behind."""
    there = place.order >= 0
    seen = (np.where(there, each, NOWHERE) for each in (place.eigenvalues, place.right, place.left))
    values, right, left = (np.concatenate([each, each.conj()], axis=-1) for each in seen)
    return TrackedPoint(place.value, values, right, left, np.tile(criterion, 2), clear)


def _followed(
    family: SteadyFamily, last: _Place, here: _Place, halvings: int, known: tuple[Any, Any] | None = None
) -> tuple[_Place, Any, bool]:
    """`here` in the order of `last`, with the criterion of each pairing; unclear steps are halved."""
    edges = tuple(_outside(place.eigenvalues, family.band, EDGE) for place in (last, here))
    order, criterion, clear = _paired(last.order >= 0, *(_likeness(last, here) if known is None else known), *edges)
    if clear or halvings == 0 or last.value == here.value:
        return here.after(last, order), criterion, clear
    middle = 0.5 * (last.value + here.value)
    between: _Place | None
    if family.band is None:
        steady = family.at(np.array([middle]))
        modes = modes_of(steady)
        between = _Place.of(middle, steady, modes, 0) if modes.exists[0] else None
    else:
        between = _place_in_band(family, family.band, middle)
    if between is None:
        return here.after(last, order), criterion, False
    between, first, clear = _followed(family, last, between, halvings - 1)
    after, second, clear_too = _followed(family, between, here, halvings - 1 if clear else 0)
    first = np.pad(np.where(np.isnan(first), 1.0, first), (0, len(second) - len(first)), constant_values=1.0)
    return after, np.minimum(first, second), clear and clear_too


def _outside(eigenvalues: np.ndarray, band: Band | None, edge: float) -> Any:
    """True where a mode is beyond the band, or by a share `edge` as good as that; nowhere without a band."""
    if band is None:
        return np.zeros(eigenvalues.shape, dtype=bool)
    hertz, damped = np.abs(eigenvalues.imag) / (2.0 * np.pi), np.abs(eigenvalues.real) / np.abs(eigenvalues)
    inside = (hertz >= band[0] * (1.0 + edge)) & (hertz <= band[1] * (1.0 - edge))
    return ~(inside & (damped < MOST_DAMPED * (1.0 - edge)))


def _likeness(last: _Place, here: _Place) -> tuple[Any, Any]:
    """Criterion of each mode of `last` with each of `here`, and the distance of their eigenvalues over the largest."""
    with np.errstate(all="ignore"):
        product = np.abs(_products(last, here) * np.swapaxes(_products(here, last), -1, -2))
        gaps = np.abs(last.eigenvalues[..., :, None] - here.eigenvalues[..., None, :])
        largest = np.max(np.abs(last.eigenvalues), axis=-1, initial=0.0)[..., None, None]
        return np.where(np.isfinite(product), np.minimum(product, 1.0), 0.0), gaps / np.maximum(largest, 1e-300)


def _paired(
    there: np.ndarray, criterion: np.ndarray, gaps: np.ndarray, leaving: np.ndarray, coming: np.ndarray
) -> tuple[Any, Any, bool]:
    """Order that continues the tracks `there`, criterion of each and whether that is clear.

    By the criterion, with the distance of eigenvalues to break ties. A track that is `leaving` and a mode that is
    `coming` may stay alone: the order of the track is then -1, and the mode stands behind all others.
    """
    from scipy.optimize import linear_sum_assignment

    tracks = np.flatnonzero(there)
    rows, columns = linear_sum_assignment((1.0 - criterion + gaps)[tracks])
    rows = tracks[rows]
    # one that leaves and one that comes; nearer to each other they may be one that changes fast, and the step is halved
    two = (criterion[rows, columns] < CLEAR) & leaving[rows] & coming[columns] & (gaps[rows, columns] > 2.0 * EDGE)
    rows, columns = rows[~two], columns[~two]
    if np.min(criterion[rows, columns], initial=1.0) < CLEAR:
        _, nearest = linear_sum_assignment(gaps[np.ix_(rows, columns)])
        if np.max(gaps[rows, columns[nearest]]) < 0.1 * np.max(gaps[rows, columns]):
            columns = columns[nearest]
    order, chosen = np.full(len(there), -1), np.full(len(there), np.nan)
    order[rows], chosen[rows] = columns, criterion[rows, columns]
    lost, new = np.setdiff1d(tracks, rows), np.setdiff1d(np.arange(criterion.shape[1]), columns)
    clear = bool(np.all(chosen[rows] >= CLEAR) and np.all(leaving[lost]) and np.all(coming[new]))
    gone = np.flatnonzero(~there)
    if len(gone) and len(new):  # seen before: its own mode comes back
        again, which = linear_sum_assignment((1.0 - criterion)[np.ix_(gone, new)])
        alike = criterion[gone[again], new[which]] >= CLEAR
        again, which = gone[again[alike]], new[which[alike]]
        order[again], chosen[again] = which, criterion[again, which]
        new = np.setdiff1d(new, which)
    return np.append(order, new), np.append(chosen, np.ones(len(new))), clear


def _products(a: _Place, b: _Place) -> Any:
    """w_i^H (lambda_i M + C + lambda_j M) u_j with w, lambda_i of a and u, lambda_j of b."""
    left, right = np.conj(np.swapaxes(a.left, -1, -2)), b.right
    mass, damping = left @ a.mass @ right, left @ a.damping @ right
    return (a.eigenvalues[..., :, None] + b.eigenvalues[..., None, :]) * mass + damping
