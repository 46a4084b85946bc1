"""Which parameter makes the answer scatter? Sobol' indices: shares of the variance.

    S_i  = Var(E[y | x_i]) / Var(y)              first order: what would go if x_i were known
    ST_i = E[Var(y | all but x_i)] / Var(y)      total: what x_i has a part in, interactions included

Estimators of Saltelli et al. 2010 through `scipy.stats.sobol_indices`, on scrambled Sobol' points.
Sources: I. M. Sobol' 2001, Math. Comput. Simulat. 55, 271-280;
A. Saltelli et al. 2010, Comput. Phys. Commun. 181, 259-270.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.arguments import public
from squealbox.family import DesignOrRecipe
from squealbox.parameters import ParameterError
from squealbox.result import Array, Outcome, Result, quantity
from squealbox.scatter import Scatter, Scattered, as_scatter, unit_points
from squealbox.studies.quantity import QuantityLike, as_quantity, evaluate, input_of
from squealbox.studies.uncertainty.replicates import ratio_interval


@dataclass(frozen=True, kw_only=True, eq=False)
class SobolIndices(Result):
    """Shares of the variance with their confidence intervals, as :func:`sobol_indices` returns them.

    An estimate may fall slightly below 0 or above 1; its interval says by how much that matters.
    """

    first: Array = quantity("parameter", "1", "first-order index")
    first_low: Array = quantity("parameter", "1", "lower end of its interval")
    first_high: Array = quantity("parameter", "1", "upper end of its interval")
    total: Array = quantity("parameter", "1", "total index")
    total_low: Array = quantity("parameter", "1", "lower end of its interval")
    total_high: Array = quantity("parameter", "1", "upper end of its interval")
    average: Any = quantity("", "", "mean of the quantity")
    deviation: Any = quantity("", "", "standard deviation of the quantity")

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters, in order."""
        return tuple(self.settings["names"])

    def summary(self) -> str:
        """A table, the strongest parameter first."""
        about, settings = self.settings["quantity"], self.settings
        if not self.outcome.ok:
            return f"Sobol' indices: {self.outcome.told}"
        unit = f" {about['unit']}" if about["unit"] else ""
        width = max(len(name) for name in ("parameter", *self.names))
        level = f"{100.0 * settings['level']:g} % interval"
        lines = [
            f"{about['name']}: mean {float(self.average):.5g}, deviation {float(self.deviation):.3g}{unit}; "
            f"{settings['evaluations']} evaluations",
            f"{'parameter':{width}}  first order  {level:18}  total   {level}",
        ]
        for i in np.argsort(-self.total):
            first = f"{self.first[i]:11.3f}  {_span(self.first_low[i], self.first_high[i]):18}"
            total = f"{self.total[i]:6.3f}  {_span(self.total_low[i], self.total_high[i])}"
            lines.append(f"{self.names[i]:{width}}  {first}  {total}")
        return "\n".join(lines)


@public(design=None)
def sobol_indices(
    design: DesignOrRecipe | None,
    scatter: Scattered,
    quantity: QuantityLike,
    *,
    samples: int = 4096,
    seed: int = 0,
    level: float = 0.95,
    replicates: int = 8,
) -> SobolIndices:
    """First-order and total Sobol' indices of `quantity` over the independent parameters of `scatter`.

    Parameters
    ----------
    design, scatter, quantity, seed, level : as for `squeal_probability`, level [-]
    samples : n, base points in all; the quantity is evaluated n (d + 2) times. It is split over the replicates and
        rounded up so that each has a power of two
    replicates : independent randomisations, whose spread makes the intervals

    Accuracy: the intervals. For a quantity with an unknown value somewhere, the outcome is "unknown_values": a variance
    over a part of the points would be of something else. Raises `ParameterError` for correlated parameters, for which
    these shares are not defined.

    >>> import numpy as np
    >>> from squealbox.studies import Normal, Scatter, sobol_indices
    >>> scatter = Scatter({"a": Normal(0.0, 3.0), "b": Normal(0.0, 1.0)})
    >>> found = sobol_indices(None, scatter, lambda at: at["a"] + at["b"])  # variances 9 and 1
    >>> np.round(found.first, 2).tolist()
    [0.9, 0.1]
    """
    scatter = as_scatter(scatter)
    asked = as_quantity(quantity)
    need_independent(scatter, "sobol_indices")
    if not 0.0 < level < 1.0:
        raise ParameterError("sobol_indices", "level", level, "a number in (0, 1)")
    if samples < replicates or replicates < 2:
        expected = "at least 2, and at least as many samples"
        raise ParameterError("sobol_indices", "replicates", replicates, expected)
    size = len(scatter.names)
    each = 1 << max(-(-int(samples) // int(replicates)) - 1, 1).bit_length()
    rngs = np.random.default_rng(seed).spawn(int(replicates))
    unit = np.stack([_saltelli(each, size, rng) for rng in rngs])
    flat = unit.reshape(-1, size)
    values = evaluate(design, asked, scatter.from_uniform(flat)).reshape(len(rngs), size + 2, each)
    settings = {"quantity": asked.about, "names": list(scatter.names), "samples": each * len(rngs), "seed": seed}
    settings |= {"level": level, "replicates": len(rngs), "evaluations": values.size}
    outcome = finite_outcome(values) if not np.all(np.isfinite(values)) else _varies(values)
    arrays: dict[str, Any] = {}
    shares = _shares(values) if outcome.ok else (np.full((len(rngs), size), np.nan),) * 2
    wholes = np.var(values[:, :2], axis=(1, 2)) if outcome.ok else np.full(len(rngs), np.nan)
    for name, parts in zip(("first", "total"), shares, strict=True):
        ends = ratio_interval(parts, wholes, level)
        arrays |= {name: ends[0], f"{name}_low": ends[1], f"{name}_high": ends[2]}
    base = values[:, :2] if outcome.ok else np.full(2, np.nan)
    return SobolIndices(
        **arrays,
        average=np.mean(base),
        deviation=np.std(base),
        inputs={"design": input_of(design), "scatter": scatter},
        settings=settings,
        outcome=outcome,
    )


def need_independent(scatter: Scatter, owner: str) -> None:
    """Raise `ParameterError` when parameters are correlated: their shares of the variance are not defined."""
    if not scatter.independent:
        expected = "independent parameters: with correlation the variance does not split into shares"
        raise ParameterError(owner, "scatter", "correlated", expected)


def finite_outcome(values: np.ndarray) -> Outcome:
    """The outcome for values of which some are NaN or infinite, with the counts as evidence."""
    unknown, infinite = int(np.count_nonzero(np.isnan(values))), int(np.count_nonzero(np.isinf(values)))
    message = (
        f"{unknown} of {values.size} values are unknown and {infinite} infinite: narrow the scatter or the question"
    )
    return Outcome("unknown_values", message, unknown=unknown, infinite=infinite, points=int(values.size))


def _varies(values: np.ndarray) -> Outcome:
    if np.ptp(values) == 0.0:
        return Outcome("no_variance", f"the quantity is {values.flat[0]:g} at every point", value=float(values.flat[0]))
    return Outcome()


def _shares(values: np.ndarray) -> tuple[Any, Any]:
    """First-order and total part of the variance that each replicate finds, shape (replicates, parameters) each."""
    from scipy import stats

    rows = []
    for v in values:
        mixed = v[2:, None] if len(v) > 3 else np.repeat(v[2:, None], 2, axis=0)  # SciPy expects two parameters
        found = stats.sobol_indices(func={"f_A": v[:1], "f_B": v[1:2], "f_AB": mixed}, n=v.shape[-1])
        both = np.stack([found.first_order.reshape(-1), found.total_order.reshape(-1)])
        rows.append(np.var(v[:2]) * both[:, : len(v) - 2])
    stacked = np.stack(rows)
    return stacked[:, 0], stacked[:, 1]


def _saltelli(count: int, size: int, rng: np.random.Generator) -> Any:
    """The points A, B and A with column i from B, shape (size + 2, count, size)."""
    both = unit_points(count, 2 * size, "sobol", rng)
    a, b = both[:, :size], both[:, size:]
    mixed = np.repeat(a[None], size, axis=0)
    for i in range(size):
        mixed[i, :, i] = b[:, i]
    return np.concatenate([a[None], b[None], mixed])


def _span(low: float, high: float) -> str:
    return f"{low:.3f} to {high:.3f}"
