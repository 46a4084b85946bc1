"""How probable is squeal when parameters scatter? Samples, a count, and an interval that says how much it is worth."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from squealbox.arguments import public
from squealbox.family import DesignOrRecipe
from squealbox.parameters import ParameterError
from squealbox.result import OF_QUANTITY, Array, Outcome, Result, quantity
from squealbox.scatter import Sampling, Scattered, as_scatter, unit_points
from squealbox.studies.quantity import QuantityLike, as_quantity, evaluate, input_of
from squealbox.studies.uncertainty.replicates import binomial_interval, student_interval

ENOUGH = 5  # squealing and quiet points that every replicate must hold before their spread is trusted


@dataclass(frozen=True, kw_only=True, eq=False)
class SquealProbability(Result):
    """The probability of squeal with its confidence interval, as :func:`squeal_probability` returns it.

    `interval` says which: "clopper-pearson" (exact for independent points) or "replicates" (Student's t over
    independent randomisations of the point set).
    """

    probability: Any = quantity("", "1", "estimated probability of squeal")
    low: Any = quantity("", "1", "lower end of the confidence interval")
    high: Any = quantity("", "1", "upper end of the confidence interval")
    values: Array = quantity("point", OF_QUANTITY, "the quantity at each point; NaN is unknown")
    points: Array = quantity("point parameter", "", "values of the parameters that scatter, in SI")
    of_replicates: Array = quantity("replicate", "1", "the estimate of each randomisation")
    interval: str = ""

    derived: ClassVar = {"squeals": ("point", "1", "True where a point squeals")}
    table_over: ClassVar = ("point",)
    headings: ClassVar = {"points": "{}"}

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters that scatter, in the order of the last axis of `points`."""
        return tuple(self.settings["names"])

    @property
    def squeals(self) -> Any:
        """True where a point squeals, shape (point,)."""
        about = self.settings["quantity"]
        with np.errstate(invalid="ignore"):
            return self.values > about["limit"] if about["squeals"] == "above" else self.values < about["limit"]

    @property
    def unknown(self) -> int:
        """Number of points without an answer: refused by the design, or without steady sliding."""
        return int(np.count_nonzero(np.isnan(self.values)))

    def summary(self) -> str:
        """The probability in a sentence, how it was found, and how the quantity is spread."""
        about, settings = self.settings["quantity"], self.settings
        if not self.outcome.ok:
            return f"P(squeal): {self.outcome.told}"
        unit = f" {about['unit']}" if about["unit"] else ""
        level = f"{100.0 * settings['level']:g} %"
        lines = [
            f"P(squeal) = {float(self.probability):.4g}, {level} interval {_span(self.low, self.high)}",
            f"squeal: {about['name']} {about['squeals']} {about['limit']:g}{unit}",
            f"{self.values.size} points ({settings['method'].replace('_', ' ')}, seed {settings['seed']}), "
            + ("exact binomial interval" if self.interval == "clopper-pearson" else _replicates(self.of_replicates)),
        ]
        low, middle, high = np.nanquantile(self.values, (0.05, 0.5, 0.95), method="inverted_cdf")
        lines.append(f"{about['name']}: 5 % {low:.5g}, median {middle:.5g}, 95 % {high:.5g}{unit}")
        if self.unknown:
            lines.append(f"{self.unknown} points have no answer; the interval holds whatever they would have been")
        return "\n".join(lines)


@public(design=None)
def squeal_probability(
    design: DesignOrRecipe | None,
    scatter: Scattered,
    quantity: QuantityLike,
    *,
    samples: int = 4096,
    method: Sampling = "sobol",
    seed: int = 0,
    level: float = 0.95,
    replicates: int = 16,
) -> SquealProbability:
    """Probability that `quantity` is beyond its limit when the parameters of `design` scatter.

    Parameters
    ----------
    design : has ``replace``; or a function of the scattered values; or None, see `squealbox.studies.evaluate`
    scatter : {name: distribution}, such as {"friction.static": Normal(0.4, 0.02)}, or a `Scatter` with correlations
    quantity : a `Quantity`, or a function of a design that is positive where the brake squeals
    samples : points in all
    method : "random": Clopper and Pearson's exact interval. "latin_hypercube", "sobol": `samples` are split over
        `replicates` independent randomisations, whose spread makes the interval; with fewer than 5 squealing or quiet
        points in one of them the exact binomial interval is given instead, which is wider than such points deserve
    seed : the same seed gives the same numbers
    level : [-] confidence level, between 0 and 1

    Accuracy: the error falls with samples^-1/2 for "random", faster for the others where the boundary of squeal is
    smooth. For probabilities below about 10/samples use `reliability`.

    >>> from squealbox.studies import Normal, Scatter, squeal_probability
    >>> found = squeal_probability(None, Scatter({"x": Normal(0.0, 1.0)}), lambda at: at["x"], samples=4096)
    >>> round(float(found.probability), 2)
    0.5
    """
    scatter = as_scatter(scatter)
    asked = as_quantity(quantity)
    _check(samples, level, replicates)
    groups = 1 if method == "random" else int(replicates)
    each = -(-int(samples) // groups)
    rngs = np.random.default_rng(seed).spawn(groups)
    unit = np.concatenate([unit_points(each, len(scatter.names), method, rng) for rng in rngs])
    points = scatter.from_uniform(unit)
    values = evaluate(design, asked, points)
    with np.errstate(invalid="ignore"):
        hits, unknown = asked.excess(values) > 0.0, np.isnan(values)
    estimates = np.mean(hits.reshape(groups, each), axis=1)
    low, high, interval = _interval(hits, unknown, estimates, each, level)
    known = unknown.size - int(np.sum(unknown))
    outcome = (
        Outcome() if known else Outcome("no_answer", "the quantity is unknown at every point", points=unknown.size)
    )
    settings = {"quantity": asked.about, "names": list(scatter.names), "samples": values.size, "method": method}
    settings |= {"seed": seed, "level": level, "replicates": groups}
    return SquealProbability(
        probability=np.sum(hits) / max(known, 1) if known else np.nan,
        low=low,
        high=high,
        values=values,
        points=np.stack([points[name] for name in scatter.names], axis=-1),
        of_replicates=estimates,
        interval=interval,
        inputs={"design": input_of(design), "scatter": scatter},
        settings=settings,
        outcome=outcome,
    )


def _interval(
    hits: np.ndarray, unknown: np.ndarray, estimates: np.ndarray, each: int, level: float
) -> tuple[float, float, str]:
    fewest = min(float(np.min(estimates)), 1.0 - float(np.max(estimates))) * each
    if estimates.size < 2 or fewest < ENOUGH:
        ends = binomial_interval(int(np.sum(hits)), int(np.sum(unknown)), hits.size, level)
        return (*ends, "clopper-pearson")
    missing = np.mean(unknown.reshape(estimates.size, -1), axis=1)
    low = float(student_interval(estimates, level)[1])
    high = float(student_interval(estimates + missing, level)[2])
    return max(low, 0.0), min(high, 1.0), "replicates"


def _replicates(estimates: np.ndarray) -> str:
    return f"interval from {estimates.size} independent randomisations"


def _span(low: float | np.ndarray, high: float | np.ndarray) -> str:
    return f"{float(low):.4g} to {float(high):.4g}"


def _check(samples: int, level: float, replicates: int) -> None:
    for name, value, least in (("samples", samples, 1), ("replicates", replicates, 2)):
        if isinstance(value, bool) or int(value) != value or value < least:
            raise ParameterError("squeal_probability", name, value, f"a whole number of at least {least}")
    if not 0.0 < level < 1.0:
        raise ParameterError("squeal_probability", "level", level, "a number in (0, 1)")
