"""Between which values can the answer lie, when all that is known of each parameter is an interval?

The least and the largest value over a box are two global optimisations. Both ends found are values that do occur, so
the true range contains the range found. That nothing lies outside is not proved: the search is heuristic. Every corner
of the box is looked at too (up to 12 parameters), so the range is exact for a quantity that is monotone in each
parameter; and the search is run from several seeds, whose agreement is reported.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from itertools import product
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import public
from squealbox.family import DesignOrRecipe, bounds_of
from squealbox.parameters import ParameterError
from squealbox.result import OF_QUANTITY, Array, Outcome, Result, quantity
from squealbox.studies.quantity import QuantityLike, as_quantity, evaluate, input_of

MOST_CORNERS = 12  # parameters up to which every corner of the box is looked at


@dataclass(frozen=True, kw_only=True, eq=False)
class IntervalBounds(Result):
    """The range of a quantity over a box, as :func:`interval_bounds` returns it."""

    low: Any = quantity("", OF_QUANTITY, "least value found")
    high: Any = quantity("", OF_QUANTITY, "largest value found")
    low_at: Array = quantity("parameter", "", "parameters of the least value")
    high_at: Array = quantity("parameter", "", "parameters of the largest value")
    lows: Array = quantity("run", OF_QUANTITY, "least value of each run of the search")
    highs: Array = quantity("run", OF_QUANTITY, "largest value of each run of the search")
    nominal: Any = quantity("", OF_QUANTITY, "value in the middle of the box")

    table_over: ClassVar = ("parameter",)
    headings: ClassVar = {"low_at": "least at", "high_at": "largest at"}

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters, in order."""
        return tuple(self.settings["names"])

    @property
    def agreement(self) -> float:
        """Largest disagreement of the runs about an end, as a share of the range found; 0 when they agree."""
        width = float(self.high - self.low)
        gap = max(float(np.ptp(self.lows)), float(np.ptp(self.highs)))
        return gap / width if width > 0.0 else 0.0

    @property
    def always_quiet(self) -> bool:
        """True when no squealing point was found in the box."""
        about = self.settings["quantity"]
        return bool(self.high <= about["limit"] if about["squeals"] == "above" else self.low >= about["limit"])

    def summary(self) -> str:
        """The range, where its ends are, and what is guaranteed."""
        about = self.settings["quantity"]
        if not self.outcome.ok:
            return f"interval: {self.outcome.told}"
        unit = f" {about['unit']}" if about["unit"] else ""
        lines = [f"{about['name']} lies in [{float(self.low):.6g}, {float(self.high):.6g}]{unit} at least"]
        for word, at in (("least", self.low_at), ("largest", self.high_at)):
            where = ", ".join(f"{name} = {value:.6g}" for name, value in zip(self.names, at, strict=True))
            lines.append(f"  {word} at {where}")
        several = f"{self.lows.size} searches agree to {100.0 * self.agreement:.2g} % of the range"
        searched = several if self.lows.size > 1 else "one search, which no other confirms"
        lines.append(f"{searched}; both ends do occur, and nothing beyond them was found, which is no proof")
        return "\n".join(lines)


@public(design=None)
def interval_bounds(
    design: DesignOrRecipe | None,
    box: Mapping[str, tuple[float, float]],
    quantity: QuantityLike,
    *,
    seed: int = 0,
    runs: int = 3,
) -> IntervalBounds:
    """Least and largest value of `quantity` while each parameter stays within its interval.

    Parameters
    ----------
    design, quantity : as for `squeal_probability`
    box : dotted name to (low, high), in SI
    runs : searches from different seeds (`scipy.optimize.differential_evolution`, a population in one batched call)

    Unknown values are passed over; when there is nothing else the outcome is "no_answer".
    Raises `ParameterError` for a box that is none.

    >>> from squealbox.studies import interval_bounds
    >>> found = interval_bounds(None, {"x": (-1.0, 2.0)}, lambda at: at["x"] ** 2)
    >>> round(float(found.low), 9), round(float(found.high), 9)
    (0.0, 4.0)
    """
    asked = as_quantity(quantity)
    names, ends = checked_box(box, "interval_bounds")

    def values_at(points: ArrayLike) -> Any:
        return evaluate(design, asked, dict(zip(names, np.asarray(points).T, strict=True)))

    middle = values_at(np.mean(ends, axis=1)[None])[0]
    found = [_extremes(values_at, ends, seed + run) for run in range(int(runs))]
    lows, highs = (np.array([run[side][0] for run in found]) for side in (0, 1))
    known = bool(np.any(np.isfinite(lows)))
    least, largest = (int(np.argmin(lows)), int(np.argmax(highs)))
    outcome = Outcome() if known else Outcome("no_answer", "the quantity is unknown all over the box")
    settings = {"quantity": asked.about, "names": names, "box": ends.tolist(), "seed": seed, "runs": int(runs)}
    return IntervalBounds(
        low=lows[least] if known else np.nan,
        high=highs[largest] if known else np.nan,
        low_at=found[least][0][1],
        high_at=found[largest][1][1],
        lows=lows,
        highs=highs,
        nominal=middle,
        inputs={"design": input_of(design)},
        settings=settings,
        outcome=outcome,
    )


def checked_box(box: Mapping[str, Any], owner: str) -> tuple[list[str], Any]:
    """Names and ends of a box, shape (d, 2). Raises `ParameterError` when it is none."""
    if not isinstance(box, Mapping) or not box:
        raise ParameterError(owner, "box", box, "names with (low, high) each, at least one")
    return [str(name) for name in box], np.array([bounds_of(owner, str(name), ends) for name, ends in box.items()])


def _extremes(values_at: Callable[[Any], Any], ends: np.ndarray, seed: int) -> list[tuple[float, Any]]:
    """(value, place) of the least and of the largest value that one run finds."""
    corners = np.array(list(product(*ends))) if len(ends) <= MOST_CORNERS else np.mean(ends, axis=1)[None]
    at_corners = values_at(corners)
    found = []
    for sign in (1.0, -1.0):
        value, place = _least(values_at, sign, ends, seed)
        seen = np.where(np.isnan(at_corners), np.inf, sign * at_corners)
        best = int(np.argmin(seen))
        if seen[best] < value:
            value, place = float(seen[best]), corners[best]
        found.append((sign * value, place))
    return found


def _least(values_at: Callable[[Any], Any], sign: float, ends: np.ndarray, seed: int) -> tuple[float, Any]:
    from scipy.optimize import differential_evolution

    def goal(x: np.ndarray) -> Any:
        values = sign * np.atleast_1d(values_at(np.atleast_2d(x.T)))
        values = np.where(np.isnan(values), np.inf, values)
        return values if x.ndim == 2 else float(values[0])

    found = differential_evolution(
        goal, ends, rng=seed, vectorized=True, updating="deferred", polish=True, tol=1e-6, popsize=15, maxiter=60
    )
    return float(found.fun), np.asarray(found.x)
