"""How probable is squeal when it is rare? The first-order reliability method, checked by importance sampling.

With z the independent standard normal numbers behind the parameters (`Scatter.from_normal`), squeal is g(z) < 0. The
design point z* is the squealing point nearest to 0, the most probable one; g is taken for straight there:

    P = Phi(-beta),   beta = |z*|   (negative where the median itself squeals)

z* comes from the search of Abdo and Rackwitz in OpenTURNS, from 0 and from squealing points of a first wide sample; the
nearest of what they reach is taken. Points drawn about z* and about the squealing points of that sample, some of them
widely, then give P without the assumption (see `importance.py`).
Source: O. Ditlevsen, H. O. Madsen, Structural Reliability Methods, 1996, chapters 5 and 9.
"""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from squealbox.arguments import public
from squealbox.extras import extra
from squealbox.family import DesignOrRecipe, unit_of
from squealbox.parameters import ParameterError
from squealbox.result import OF_QUANTITY, Array, Outcome, Result, quantity
from squealbox.scatter import Scatter, Scattered, as_scatter
from squealbox.studies.quantity import QuantityLike, as_quantity, input_of
from squealbox.studies.uncertainty.importance import wide_sample
from squealbox.studies.uncertainty.limit_state import LimitState, seeded

ALONG = 61  # points on the line through the design point
CLOSE = 1e-4  # |g| at the design point, as a share of its change over one standard deviation


@dataclass(frozen=True, kw_only=True, eq=False)
class DesignPoint(Result):
    """The most probable squealing point and what follows from it, as :func:`form` returns it.

    `importance` are the squares of alpha = z*/|z*|, which add up to one. With correlated parameters they belong to the
    independent numbers behind them, in the order of the parameters, each after those before it are accounted for.
    """

    probability: Any = quantity("", "1", "P(squeal) by FORM, Phi(-beta)")
    beta: Any = quantity("", "1", "reliability index")
    sampled: Any = quantity("", "1", "P(squeal) by importance sampling about the design point")
    low: Any = quantity("", "1", "lower end of its confidence interval")
    high: Any = quantity("", "1", "upper end of its confidence interval")
    point: Array = quantity("parameter", "", "parameters at the design point, in SI")
    median: Array = quantity("parameter", "", "parameters at their medians, in SI")
    normal_point: Array = quantity("parameter", "1", "z*, the design point in standard normal numbers")
    importance: Array = quantity("parameter", "1", "alpha^2, share of each parameter")
    distance: Array = quantity("along", "1", "distance from the median along z*, in standard deviations")
    values: Array = quantity("along", OF_QUANTITY, "the quantity there")

    table_over: ClassVar = ("parameter",)
    headings: ClassVar = {"point": "squeals at", "normal_point": "in standard deviations"}

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters, in order."""
        return tuple(self.settings["names"])

    @property
    def straight(self) -> bool:
        """True when importance sampling does not contradict FORM."""
        return bool(self.low <= self.probability <= self.high)

    def summary(self) -> str:
        """Both probabilities, and a table of the design point, the most important parameter first."""
        if not self.outcome.ok:
            return f"FORM: {self.outcome.told}"
        settings, about = self.settings, self.settings["quantity"]
        level = f"{100.0 * settings['level']:g} %"
        agrees = "agrees" if self.straight else "the boundary is curved or has other near points: take this one"
        lines = [
            f"P(squeal) = {float(self.probability):.4g} by FORM, beta = {float(self.beta):.4f}",
            f"P(squeal) = {float(self.sampled):.4g}, {level} interval {float(self.low):.4g} to {float(self.high):.4g}, "
            f"by importance sampling ({agrees})",
            f"squeal: {about['name']} {about['squeals']} {about['limit']:g} {about['unit']}".rstrip()
            + f"; {settings['evaluations']} evaluations",
        ]
        if settings["unknown"]:
            lines.append(f"{settings['unknown']} of them have no answer and were taken for quiet")
        width = max(len(name) for name in ("parameter", *self.names))
        lines.append(f"{'parameter':{width}}  {'median':>11}  {'squeals at':>11}  {'in sd':>7}  importance")
        design = self.inputs.get("design")
        for i in np.argsort(-self.importance):
            numbers = f"{self.median[i]:11.5g}  {self.point[i]:11.5g}  {self.normal_point[i]:+7.3f}"
            unit = unit_of(design, self.names[i])
            lines.append(f"{self.names[i]:{width}}  {numbers}  {100.0 * self.importance[i]:6.1f} %  {unit}".rstrip())
        return "\n".join(lines)


@public(design=None)
def form(
    design: DesignOrRecipe | None,
    scatter: Scattered,
    quantity: QuantityLike,
    *,
    samples: int = 4000,
    seed: int = 0,
    level: float = 0.95,
    iterations: int = 100,
) -> DesignPoint:
    """Most probable squealing point, and the probability of squeal by FORM and by importance sampling about it.

    Parameters
    ----------
    design, scatter, quantity, seed, level : as for `squeal_probability`, level [-]; a smooth quantity, such as the
        margin, serves better than the growth rate, whose kink the search stumbles over
    samples : of the importance sampling
    iterations : of the search

    Accuracy: FORM is exact for a boundary that is straight in z. Squeal where neither the search nor a third of the
    samples, spread widely, came across it is seen by neither method.
    Without a point the outcome is "no_design_point", with what the search reached.

    >>> from squealbox.studies import Normal, Quantity, Scatter, form
    >>> far = Quantity(lambda at: at["a"] + at["b"], "sum", limit=6.0)
    >>> found = form(None, Scatter({"a": Normal(0.0, 1.0), "b": Normal(0.0, 1.0)}), far)
    >>> round(float(found.beta), 6)  # 6/sqrt(2)
    4.242641
    """
    scatter = as_scatter(scatter)
    asked = as_quantity(quantity)
    if samples < 2 or not 0.0 < level < 1.0:
        raise ParameterError("form", "samples, level", (samples, level), "at least 2 samples and a level in (0, 1)")
    state = LimitState(design, scatter, asked)
    size = state.dimension
    origin = float(state(np.zeros(size))[0])
    z, failure = _search(state, iterations, seed, np.zeros(size))
    outcome = failure or _verdict(state, z)
    pilot = wide_sample(state, z if outcome.ok else None, int(samples) // 3, seed)
    for start in pilot.starts(z if outcome.ok else None):
        other, broken = _search(state, iterations, seed, start)
        told = broken or _verdict(state, other)
        if told.ok and not (outcome.ok and np.linalg.norm(other) >= np.linalg.norm(z) * (1.0 - 1e-6)):
            z, outcome = other, told
    length = float(np.linalg.norm(z))
    sign = 1.0 if origin > 0.0 else -1.0
    settings = {"quantity": asked.about, "names": list(scatter.names), "samples": int(samples), "seed": seed}
    settings |= {"level": level, "iterations": iterations}
    unit = z / length if length > 0.0 else np.zeros(size)
    distance = np.linspace(0.0, 1.5 * max(length, 1.0), ALONG)
    beta = sign * length
    sampled = (np.nan,) * 3
    if outcome.ok:
        mean, variation = pilot.probability(state, z, int(samples) - int(samples) // 3, seed)
        sampled = (mean, *lognormal_interval(mean, variation, level))
    values = state.values(distance[:, None] * unit)
    return DesignPoint(
        probability=_phi(-beta) if outcome.ok else np.nan,
        beta=beta if outcome.ok else np.nan,
        sampled=sampled[0],
        low=sampled[1],
        high=sampled[2],
        point=_row(scatter, z),
        median=_row(scatter, np.zeros(size)),
        normal_point=z,
        importance=unit**2,
        distance=distance,
        values=values,
        inputs={"design": input_of(design), "scatter": scatter},
        settings={**settings, "evaluations": state.evaluations, "unknown": state.unknown},
        outcome=outcome,
    )


def _search(state: LimitState, iterations: int, seed: int, start: np.ndarray) -> tuple[Any, Outcome | None]:
    """z*, and the outcome when the search broke down."""
    with extra("studies"):
        import openturns as ot

    with seeded(seed):
        search = ot.AbdoRackwitz()
        search.setStartingPoint(start)
        search.setMaximumIterationNumber(int(iterations))
        search.setMaximumCallsNumber(100 * int(iterations) * (state.dimension + 1))
        for name in ("AbsoluteError", "RelativeError", "ResidualError", "ConstraintError"):
            getattr(search, f"setMaximum{name}")(1e-7)
        search.setCheckStatus(False)
        algorithm = ot.FORM(search, state.event())
        try:
            algorithm.run()
        except (RuntimeError, TypeError, ValueError) as error:
            if state.failure is not None:
                raise state.failure from None
            message = f"the search broke down: {' '.join(str(error).split())[:120]}"
            return np.zeros(state.dimension), Outcome("no_design_point", message)
        return np.array(algorithm.getResult().getStandardSpaceDesignPoint()), None


def _verdict(state: LimitState, z: np.ndarray) -> Outcome:
    """Is z on the boundary of squeal, and nearest to 0 along its own direction?"""
    length = float(np.linalg.norm(z))
    direction = z / length if length > 0.0 else np.eye(state.dimension)[0]
    before, here, beyond = (float(g) for g in state(z + np.array([[-1.0], [0.0], [1.0]]) * direction))
    scale = max(abs(beyond - before), 1e-300)
    if abs(here) <= CLOSE * scale and before != beyond:
        return Outcome()
    message = f"the search ended {length:.3g} standard deviations out with the limit missed by {here:.3g}"
    return Outcome("no_design_point", message, normal_point=[float(x) for x in z], missed_by=here)


def lognormal_interval(value: float, variation: float, level: float) -> tuple[float, float]:
    """Ends of the interval of a positive estimate with this coefficient of variation, taken for lognormal."""
    from scipy.special import ndtri

    if not np.isfinite(variation):
        return np.nan, np.nan
    half = float(ndtri(0.5 + 0.5 * level)) * np.sqrt(np.log1p(variation**2))
    return value * float(np.exp(-half)), min(value * float(np.exp(half)), 1.0)


def _row(scatter: Scatter, z: np.ndarray) -> Any:
    return np.array([float(value) for value in scatter.from_normal(z).values()])


def _phi(x: float) -> float:
    from scipy.special import ndtr

    return float(ndtr(x))
