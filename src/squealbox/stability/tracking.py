"""Every mode followed along a parameter, through crossings, veering and coalescence.

Modes at two neighbouring values are paired by the bi-orthogonal criterion |w_i^H (lambda_i M + C + lambda_j M) u_j|
|w_j^H (...) u_i|, 1 for the same mode and 0 for another, whatever their scaling, and by how near their eigenvalues are
to those expected. Where the pairing is not clear the step is halved; where it stays unclear, at the coalescence itself,
the nearest eigenvalue decides and the step is marked.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.arguments import public
from squealbox.labelled import Labelled, Labels
from squealbox.result import Array, Result, quantity
from squealbox.stability.eigenvalues import MARGINAL, ComplexModes, modes_of
from squealbox.stability.family import Family, Steady

CLEAR = 0.8  # criterion from which a pairing counts as clear
HALVINGS = 12


@dataclass(frozen=True)
class TrackedPoint:
    """The modes at one value, in the order of the tracks.

    eigenvalues (2n,), right and left (n, 2n), the criterion of each pairing (2n,), and `clear`, False where a pairing
    was decided by the nearest eigenvalue.
    """

    value: float
    eigenvalues: Any
    right: Any
    left: Any
    criterion: Any
    clear: bool


@dataclass(frozen=True, kw_only=True, eq=False)
class TrackedModes(Result):
    """Modes along a parameter, the same mode always in the same column, as :func:`tracked_modes` returns it."""

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
        growing = self.growth_rate > MARGINAL * np.max(np.abs(self.eigenvalues), axis=-1, keepdims=True)
        for i in range(half):
            hertz, rate = self.frequency[:, i], self.growth_rate[:, i]
            text = f"  mode {i + 1}: {hertz[0]:.6g} to {hertz[-1]:.6g} Hz, {rate[0]:+.6g} to {rate[-1]:+.6g} 1/s"
            starts = np.nonzero(growing[1:, i] & ~growing[:-1, i])[0]
            spans = [f"{self.value[k]:.6g} and {self.value[k + 1]:.6g}" for k in starts]
            text += ", grows everywhere" if np.all(growing[:, i]) else ""
            rows.append(text + (f", begins to grow between {'; '.join(spans)}" if spans else ""))
        unclear = ", ".join(f"{value:.6g}" for value in self.value[~np.asarray(self.clear, dtype=bool)])
        return "\n".join(
            rows + [f"  modes merge, pairing decided by the nearest eigenvalue: at {unclear}"] * bool(unclear)
        )


def track(design: Any, parameter: str, values: Any, *, time: float = 0.0) -> Iterator[TrackedPoint]:
    """Walk along the values of a parameter with the modes always in the order of the first value.

    Parameters
    ----------
    design : a design, or a function of one value that returns a design or a system
    parameter : dotted name
    values : increasing or decreasing values; where the pairing between two is unclear, values between are tried too

    Values without steady sliding are passed over with NaN. Raises `ValueError` for fewer than one value.
    """
    array = np.atleast_1d(np.asarray(values, dtype=float))
    if array.ndim != 1 or array.size == 0:
        raise ValueError(f"values has shape {array.shape}: expected one or more values")
    family = Family(design, [parameter], time)
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


@public()
def tracked_modes(design: Any, parameter: str, values: Any, *, time: float = 0.0) -> TrackedModes:
    """The whole of :func:`track` as one result, a labelled dataset by ``to_dataset()``."""
    points = list(track(design, parameter, values, time=time))
    columns = {name: np.array([getattr(p, name) for p in points]) for name in ("value", "eigenvalues", "right")}
    columns |= {name: np.array([getattr(p, name) for p in points]) for name in ("criterion", "clear")}
    inputs = Family(design, [parameter], time).inputs
    arrays: dict[str, Any] = columns
    return TrackedModes(**arrays, parameter=parameter, inputs=inputs)


@dataclass(frozen=True)
class _Place:
    """Matrices and ordered modes at one value, or at each of several (a slice); `order` is that of the tracks."""

    value: Any
    mass: Any
    damping: Any
    eigenvalues: Any
    right: Any
    left: Any
    order: Any

    @staticmethod
    def of(value: Any, steady: Steady, modes: ComplexModes, i: int | slice) -> "_Place":
        order = np.arange(modes.eigenvalues.shape[-1])
        return _Place(value, steady.M[i], steady.C[i], modes.eigenvalues[i], modes.right[i], modes.left[i], order)

    def ordered(self, order: Any) -> "_Place":
        return _Place(
            self.value, self.mass, self.damping, self.eigenvalues[order], self.right[:, order], self.left[:, order],
            self.order[order],
        )  # fmt: skip

    def point(self, criterion: Any, clear: bool) -> TrackedPoint:
        return TrackedPoint(self.value, self.eigenvalues, self.right, self.left, criterion, clear)


def _followed(
    family: Family, last: _Place, here: _Place, halvings: int, known: tuple[Any, Any] | None = None
) -> tuple[_Place, Any, bool]:
    """`here` in the order of `last`, with the criterion of each pairing; unclear steps are halved."""
    order, criterion = _paired(*(_likeness(last, here) if known is None else known))
    if np.min(criterion) >= CLEAR or halvings == 0 or last.value == here.value:
        return here.ordered(order), criterion, bool(np.min(criterion) >= CLEAR)
    middle = 0.5 * (last.value + here.value)
    steady = family.at(np.array([middle]))
    modes = modes_of(steady)
    if not modes.exists[0]:
        return here.ordered(order), criterion, False
    between, first, clear = _followed(family, last, _Place.of(middle, steady, modes, 0), halvings - 1)
    after, second, clear_too = _followed(family, between, here, halvings - 1 if clear else 0)
    return after, np.minimum(first, second), clear and clear_too


def _likeness(last: _Place, here: _Place) -> tuple[Any, Any]:
    """Criterion of each mode of `last` with each of `here`, and the distance of their eigenvalues over the largest."""
    with np.errstate(all="ignore"):
        product = np.abs(_products(last, here) * np.swapaxes(_products(here, last), -1, -2))
        gaps = np.abs(last.eigenvalues[..., :, None] - here.eigenvalues[..., None, :])
        largest = np.max(np.abs(last.eigenvalues), axis=-1)[..., None, None]
        return np.where(np.isfinite(product), np.minimum(product, 1.0), 0.0), gaps / np.maximum(largest, 1e-300)


def _paired(criterion: Any, gaps: Any) -> tuple[Any, Any]:
    """Order that continues the last one, by the criterion, with the distance of eigenvalues to break ties."""
    from scipy.optimize import linear_sum_assignment

    rows, order = linear_sum_assignment(1.0 - criterion + gaps)
    chosen = criterion[rows, order]
    if np.min(chosen) < CLEAR:
        _, nearest = linear_sum_assignment(gaps)
        if np.max(gaps[rows, nearest]) < 0.1 * np.max(gaps[rows, order]):
            return nearest, criterion[rows, nearest]
    return order, chosen


def _products(a: _Place, b: _Place) -> Any:
    """w_i^H (lambda_i M + C + lambda_j M) u_j with w, lambda_i of a and u, lambda_j of b."""
    left, right = np.conj(np.swapaxes(a.left, -1, -2)), b.right
    mass, damping = left @ a.mass @ right, left @ a.damping @ right
    return (a.eigenvalues[..., :, None] + b.eigenvalues[..., None, :]) * mass + damping
