"""What an optimisation wants: goals and constraints, each a quantity, plain or over scatter."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np

from squealbox.distributions import Distribution, Lognormal
from squealbox.family import DesignOrRecipe
from squealbox.parameters import ParameterError
from squealbox.scatter import Scatter
from squealbox.studies.quantity import Quantity, as_quantity, evaluate

Over = Literal["nominal", "mean", "quantile", "probability"]


@dataclass(frozen=True)
class Goal:
    """A quantity to make small or large.

    Parameters
    ----------
    quantity : a `Quantity` or a function of a design
    sense : "minimise" or "maximise"
    over : what is taken of it: "nominal", its value without scatter; over the scatter its "mean", its "quantile" on the
        bad side, or the "probability" of squeal
    share : of the quantile: 0.95 is the value that 95 % of the brakes better

    >>> from squealbox.studies import Goal
    >>> Goal(lambda design: design["k"], "maximise").factor
    -1.0
    """

    quantity: Any
    sense: Literal["minimise", "maximise"] = "minimise"
    over: Over = "nominal"
    share: float = 0.95

    def __post_init__(self) -> None:
        object.__setattr__(self, "quantity", as_quantity(self.quantity))
        if self.sense not in ("minimise", "maximise"):
            raise ParameterError("Goal", "sense", self.sense, "'minimise' or 'maximise'")
        _check_over("Goal", self.over, self.share)

    @property
    def factor(self) -> float:
        """1 to minimise, -1 to maximise."""
        return 1.0 if self.sense == "minimise" else -1.0

    @property
    def name(self) -> str:
        """The goal in words, for tables and axes."""
        return _named(self.quantity, self.over, self.share)

    def measure(self, values: np.ndarray) -> Any:
        """The number wanted of samples (candidates, samples): shape (candidates,)."""
        return measured(self.quantity, values, self.over, self.share, self.factor)


@dataclass(frozen=True)
class Constraint:
    """A quantity that has to stay at or above `low` and at or below `high`; `over` and `share` as for a `Goal`."""

    quantity: Any
    low: float = -np.inf
    high: float = np.inf
    over: Over = "nominal"
    share: float = 0.95

    def __post_init__(self) -> None:
        object.__setattr__(self, "quantity", as_quantity(self.quantity))
        if not self.low < self.high or (np.isinf(self.low) and np.isinf(self.high)):
            raise ParameterError(
                "Constraint", "low, high", (self.low, self.high), "low < high, at least one of them finite"
            )
        _check_over("Constraint", self.over, self.share)

    @property
    def name(self) -> str:
        """The constrained number in words."""
        return _named(self.quantity, self.over, self.share)

    def measure(self, values: np.ndarray) -> Any:
        """The constrained number of samples (candidates, samples): shape (candidates,)."""
        return measured(self.quantity, values, self.over, self.share, 1.0 if np.isfinite(self.high) else -1.0)

    def violation(self, measure: np.ndarray) -> Any:
        """How far the number is outside, zero or below where it is within."""
        return np.maximum(self.low - measure, measure - self.high)


def measured(quantity: Quantity, values: np.ndarray, over: Over, share: float, factor: float) -> Any:
    """What is taken of samples (candidates, samples); an unknown sample counts as squeal, or as the worst value."""
    if over == "nominal":
        return values[:, 0]
    if over == "probability":
        with np.errstate(invalid="ignore"):
            return np.mean((quantity.excess(values) > 0.0) | np.isnan(values), axis=1)
    if over == "mean":
        return np.mean(values, axis=1)
    bad = np.where(np.isnan(values), np.inf, factor * values)
    return factor * np.quantile(bad, share, axis=1, method="inverted_cdf")


class Candidates:
    """The numbers of goals and constraints at candidate designs, all of them in one batched call for each quantity.

    A scattered parameter that is also varied keeps its scatter about the varied value: x value/mean for a lognormal
    one, x - mean + value for any other. The samples are the same for every candidate, so that candidates are compared
    and not samples.
    """

    def __init__(
        self, design: DesignOrRecipe | None, names: list[str], scatter: Scatter | None, samples: int, seed: int
    ) -> None:
        self.design, self.names = design, names
        self.sample = {} if scatter is None else scatter.sample(samples, "sobol", seed)
        self.given: Mapping[str, Distribution] = {} if scatter is None else scatter.distributions
        self.size = samples
        self.evaluations = 0

    def measures(self, asked: list[Any], x: np.ndarray) -> Any:
        """The number of each goal or constraint at candidates (count, variables): shape (count, len(asked))."""
        columns = []
        seen: dict[tuple[int, bool], Any] = {}
        for each in asked:
            key = (id(each.quantity), each.over == "nominal")
            if key not in seen:
                seen[key] = self._values(each.quantity, x, nominal=key[1])
            columns.append(each.measure(seen[key]))
        return np.stack(columns, axis=-1)

    def _values(self, quantity: Quantity, x: np.ndarray, *, nominal: bool) -> Any:
        points: dict[str, Any] = {}
        count = len(x)
        size = 1 if nominal else self.size
        for i, name in enumerate(self.names):
            points[name] = np.repeat(x[:, i], size)
        if not nominal:
            for name, sample in self.sample.items():
                points[name] = self._about(name, points.get(name), np.tile(sample, count))
        self.evaluations += count * size
        return evaluate(self.design, quantity, points, strict=False).reshape(count, size)

    def _about(self, name: str, varied: np.ndarray | None, sample: np.ndarray) -> Any:
        """A sample of a parameter, about its varied value where it is varied."""
        if varied is None:
            return sample
        given = self.given[name]
        return varied * sample / given.average if isinstance(given, Lognormal) else varied + sample - given.average


def _named(quantity: Quantity, over: Over, share: float) -> str:
    if over == "nominal":
        return quantity.name
    if over == "quantile":
        return f"{100.0 * share:g} % quantile of {quantity.name}"
    return f"mean {quantity.name}" if over == "mean" else f"P(squeal) by {quantity.name}"


def _check_over(owner: str, over: str, share: float) -> None:
    if over not in ("nominal", "mean", "quantile", "probability"):
        raise ParameterError(owner, "over", over, "'nominal', 'mean', 'quantile' or 'probability'")
    if not 0.0 < share < 1.0:
        raise ParameterError(owner, "share", share, "a number in (0, 1)")
