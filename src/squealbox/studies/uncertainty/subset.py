"""How probable is squeal when it is very rare? Subset simulation: a product of conditional probabilities.

    P(g < 0) = P(g < b1) P(g < b2 | g < b1) ...   with b1 > b2 > ... > 0 such that each factor is about 0.1

The points below each level start Markov chains that stay below it. Through OpenTURNS, repeated from several seeds: the
runs are independent, so their scatter is a check on the coefficient of variation each states of itself.
Source: S.-K. Au, J. L. Beck 2001, Probabilistic Engineering Mechanics 16, 263-277.
"""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from squealbox.arguments import public
from squealbox.extras import extra
from squealbox.family import DesignOrRecipe
from squealbox.parameters import ParameterError
from squealbox.result import OF_QUANTITY, Array, Outcome, Result, quantity
from squealbox.scatter import Scattered, as_scatter
from squealbox.studies.quantity import QuantityLike, as_quantity, input_of
from squealbox.studies.uncertainty.form import lognormal_interval
from squealbox.studies.uncertainty.limit_state import LimitState, seeded

SHARE = 0.1  # conditional probability of a level


@dataclass(frozen=True, kw_only=True, eq=False)
class SubsetProbability(Result):
    """A small probability of squeal with its interval, as :func:`subset_simulation` returns it."""

    probability: Any = quantity("", "1", "P(squeal), mean of the runs")
    variation: Any = quantity("", "1", "its coefficient of variation, as the runs state it of themselves")
    low: Any = quantity("", "1", "lower end of the confidence interval")
    high: Any = quantity("", "1", "upper end of the confidence interval")
    of_runs: Array = quantity("run", "1", "P(squeal) of each run")
    variation_of_runs: Array = quantity("run", "1", "coefficient of variation each run states")
    thresholds: Array = quantity("run level", OF_QUANTITY, "the quantity at each level; NaN behind the last")
    exceedance: Array = quantity("run level", "1", "probability that the quantity is beyond that level")

    table_over: ClassVar = ("run", "level")
    headings: ClassVar = {"exceedance": "probability"}

    @property
    def spread(self) -> float:
        """Coefficient of variation of one run as the runs show it by their scatter."""
        return float(np.std(self.of_runs, ddof=1) / np.mean(self.of_runs)) if len(self.of_runs) > 1 else np.nan

    def summary(self) -> str:
        """The probability with its interval, and what the runs say about each other."""
        if not self.outcome.ok:
            return f"subset simulation: {self.outcome.told}"
        settings, about = self.settings, self.settings["quantity"]
        level = f"{100.0 * settings['level']:g} %"
        unit = f" {about['unit']}" if about["unit"] else ""
        lines = [
            f"P(squeal) = {float(self.probability):.3g}, "
            f"{level} interval {float(self.low):.3g} to {float(self.high):.3g}",
            f"squeal: {about['name']} {about['squeals']} {about['limit']:g}{unit}",
            f"{len(self.of_runs)} runs of {settings['samples']} points a level, {settings['evaluations']} evaluations; "
            f"a run states a variation of {np.mean(self.variation_of_runs):.2f}, the runs scatter by {self.spread:.2f}",
        ]
        if settings["unknown"]:
            lines.append(f"{settings['unknown']} evaluations have no answer and were taken for quiet")
        return "\n".join(lines)


@public(design=None)
def subset_simulation(
    design: DesignOrRecipe | None,
    scatter: Scattered,
    quantity: QuantityLike,
    *,
    samples: int = 2000,
    runs: int = 4,
    seed: int = 0,
    level: float = 0.95,
    smallest: float = 1e-12,
) -> SubsetProbability:
    """A small probability of squeal, by subset simulation.

    Parameters
    ----------
    design, scatter, quantity, seed, level : as for `squeal_probability`, level [-]; no derivative is taken, so a kink
        does no harm
    samples : points of a level; a probability of 10^-k takes about k levels
    runs : independent repetitions
    smallest : [-] a probability below this is given up with the outcome "too_rare"

    Accuracy: the coefficient of variation. Chains are correlated, and what a run states of itself is a little too
    small as a rule: the larger of that and the scatter of the runs makes the interval, which takes the estimate for
    lognormal. Points without an answer count as quiet; their number is told.

    >>> from squealbox.studies import Normal, Quantity, Scatter, subset_simulation
    >>> rare = Quantity(lambda at: at["a"] + at["b"], "sum", limit=6.0)  # exact: 1.1e-5
    >>> found = subset_simulation(None, Scatter({"a": Normal(0.0, 1.0), "b": Normal(0.0, 1.0)}), rare)
    >>> bool(found.low < 1.1e-5 < found.high)
    True
    """
    scatter = as_scatter(scatter)
    asked = as_quantity(quantity)
    for name, value, least in (("samples", samples, 100), ("runs", runs, 1)):
        if isinstance(value, bool) or int(value) != value or value < least:
            raise ParameterError("subset_simulation", name, value, f"a whole number of at least {least}")
    if not 0.0 < level < 1.0:
        raise ParameterError("subset_simulation", "level", level, "a number in (0, 1)")
    state = LimitState(design, scatter, asked)
    seeds = np.random.SeedSequence(seed).generate_state(int(runs))
    found = [_run(state, int(samples), int(each % (1 << 31)), smallest) for each in seeds]
    estimates = np.array([run[0] for run in found])
    stated = np.array([run[1] for run in found])
    mean = float(np.mean(estimates))
    variation = float(np.sqrt(np.sum((stated * estimates) ** 2))) / (len(found) * mean) if mean > 0.0 else np.nan
    low, high = lognormal_interval(mean, _larger(variation, estimates), level)
    lost = int(np.count_nonzero(estimates == 0.0))
    outcome = _outcome(state, lost, len(found), smallest) if lost else Outcome()
    settings = {"quantity": asked.about, "names": list(scatter.names), "samples": int(samples), "seed": seed}
    settings |= {"level": level, "smallest": smallest, "evaluations": state.evaluations, "unknown": state.unknown}
    sign = 1.0 if asked.squeals == "above" else -1.0
    return SubsetProbability(
        probability=mean,
        variation=variation,
        low=low,
        high=high,
        of_runs=estimates,
        variation_of_runs=stated,
        thresholds=_padded([asked.limit - sign * run[2] for run in found]),
        exceedance=_padded([run[3] for run in found]),
        inputs={"design": input_of(design), "scatter": scatter},
        settings=settings,
        outcome=outcome,
    )


def _outcome(state: LimitState, lost: int, runs: int, smallest: float) -> Outcome:
    """Why runs found nothing: squeal is too rare, or the quantity does not tell how far it is."""
    flat = state.ties / state.evaluations
    if flat > SHARE:
        message = (
            f"the {state.quantity.name} is exactly at its limit at {100.0 * flat:.0f} % of the points, so no level "
            "leads to squeal: ask for a quantity that tells how far squeal is, such as the margin"
        )
        return Outcome("flat_quantity", message, share=flat)
    if state.broken:
        return Outcome("broke_down", f"{lost} of {runs} runs broke down: {state.broken}", runs=lost)
    message = f"{lost} of {runs} runs found no squeal down to a probability of {smallest:g}"
    return Outcome("too_rare", message, runs=lost)


def _run(state: LimitState, samples: int, seed: int, smallest: float) -> tuple[float, float, Any, Any]:
    """P, its stated variation, the thresholds of g and the probabilities of one run."""
    with extra("studies"):
        import openturns as ot

    with seeded(seed):
        algorithm = ot.SubsetSampling(state.event())
        # A block holds one point of every chain: with larger blocks the chains of OpenTURNS take fewer steps than Au
        # and Beck's, and the estimate falls short by a third at one in a million.
        chains = max(round(SHARE * samples), 1)
        algorithm.setMaximumOuterSampling(-(-samples // chains))
        algorithm.setBlockSize(chains)
        algorithm.setConditionalProbability(SHARE)
        algorithm.setMinimumProbability(smallest)
        algorithm.setMaximumCoefficientOfVariation(-1.0)
        try:
            algorithm.run()
        except (RuntimeError, TypeError, ValueError) as error:
            if state.failure is not None:
                raise state.failure from None
            if "too small" not in str(error):  # how it says that it gave up before squeal was reached
                state.broken = " ".join(str(error).split())[:160]
            return 0.0, np.nan, np.zeros(0), np.zeros(0)
        result = algorithm.getResult()
        levels = np.array(algorithm.getThresholdPerStep()), np.array(algorithm.getProbabilityEstimatePerStep())
        return float(result.getProbabilityEstimate()), float(result.getCoefficientOfVariation()), *levels


def _larger(variation: float, estimates: np.ndarray) -> float:
    """The variation of the mean as stated, or as the scatter of three or more runs shows it, whichever is larger."""
    if estimates.size < 3 or not np.isfinite(variation):
        return variation
    return max(variation, float(np.std(estimates, ddof=1) / np.mean(estimates)) / np.sqrt(estimates.size))


def _padded(rows: list[Any]) -> Any:
    """Rows of unequal length as one array, NaN behind their ends."""
    out = np.full((len(rows), max(1, *(len(row) for row in rows))), np.nan)
    for line, row in zip(out, rows, strict=True):
        line[: len(row)] = row
    return out
