"""Which parameters matter at all? Morris's elementary effects, for many parameters and few evaluations.

Each of r trajectories changes one parameter after another by a large step; the effect of parameter i is the change of
the answer by its step. mu* = mean |effect| ranks the parameters, mu = mean effect tells its direction, and sigma tells
curvature and interaction. r (d + 1) evaluations, through SALib.
Sources: M. D. Morris 1991, Technometrics 33, 161-174; F. Campolongo et al. 2007, Environ. Modell. Softw. 22, 1509-1518.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.arguments import public
from squealbox.extras import extra
from squealbox.family import DesignOrRecipe
from squealbox.parameters import ParameterError
from squealbox.result import OF_QUANTITY, Array, Outcome, Result, quantity
from squealbox.scatter import Scattered, as_scatter
from squealbox.studies.quantity import QuantityLike, as_quantity, evaluate, input_of
from squealbox.studies.uncertainty.sobol import finite_outcome, need_independent

COVERED = 0.99  # central share of each distribution that the trajectories span
LEVELS = 4


@dataclass(frozen=True, kw_only=True, eq=False)
class MorrisEffects(Result):
    """Elementary effects, as :func:`morris_effects` returns them, in the unit of the quantity.

    An effect is the change of the quantity per range of the parameter, the central 99 % of its distribution.
    """

    strength: Array = quantity("parameter", OF_QUANTITY, "mu*, mean of |effect|")
    strength_error: Array = quantity("parameter", OF_QUANTITY, "half width of its bootstrap interval")
    direction: Array = quantity("parameter", OF_QUANTITY, "mu, mean of the effect")
    spread: Array = quantity("parameter", OF_QUANTITY, "sigma, standard deviation of the effect")

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters, in order."""
        return tuple(self.settings["names"])

    def summary(self) -> str:
        """A table, the strongest parameter first."""
        about = self.settings["quantity"]
        if not self.outcome.ok:
            return f"Morris effects: {self.outcome.told}"
        width = max(len(name) for name in ("parameter", *self.names))
        unit = f" [{about['unit'] or '-'}]"
        lines = [
            f"effects on {about['name']}{unit} over 99 % of each range; {self.settings['evaluations']} evaluations"
        ]
        lines.append(f"{'parameter':{width}}  {'mu*':>10}  {'+-':>9}  {'mu':>10}  {'sigma':>10}")
        for i in np.argsort(-self.strength):
            numbers = f"{self.strength[i]:10.4g}  {self.strength_error[i]:9.2g}  {self.direction[i]:+10.4g}"
            lines.append(f"{self.names[i]:{width}}  {numbers}  {self.spread[i]:10.4g}")
        return "\n".join(lines)


@public(design=None)
def morris_effects(
    design: DesignOrRecipe | None,
    scatter: Scattered,
    quantity: QuantityLike,
    *,
    trajectories: int = 50,
    seed: int = 0,
    level: float = 0.95,
) -> MorrisEffects:
    """Elementary effects of the independent parameters of `scatter` on `quantity`.

    Parameters
    ----------
    design, scatter, quantity, seed, level : as for `squeal_probability`, level [-]
    trajectories : r; the quantity is evaluated r (d + 1) times

    Accuracy: a ranking, not shares: `sobol_indices` gives those. Raises `ParameterError` for correlated parameters;
    an unknown value gives the outcome "unknown_values".

    >>> import numpy as np
    >>> from squealbox.studies import Scatter, Uniform, morris_effects
    >>> scatter = Scatter({"a": Uniform(0.0, 1.0), "b": Uniform(0.0, 1.0)})
    >>> found = morris_effects(None, scatter, lambda at: 3.0 * at["a"] - at["b"])
    >>> np.round(found.direction, 6).tolist()  # 99 % of each range
    [2.97, -0.99]
    """
    with extra("studies"):
        from SALib.analyze import morris as analysis
        from SALib.sample import morris as sampling

    scatter = as_scatter(scatter)
    asked = as_quantity(quantity)
    need_independent(scatter, "morris_effects")
    if isinstance(trajectories, bool) or int(trajectories) != trajectories or trajectories < 2:
        raise ParameterError("morris_effects", "trajectories", trajectories, "a whole number of at least 2")
    size = len(scatter.names)
    edge = 0.5 * (1.0 - COVERED)
    problem = {"num_vars": size, "names": list(scatter.names), "bounds": [[0.0, 1.0]] * size}
    unit = sampling.sample(problem, int(trajectories), num_levels=LEVELS, seed=seed)
    values = evaluate(design, asked, scatter.from_uniform(edge + COVERED * unit))
    settings = {"quantity": asked.about, "names": list(scatter.names), "trajectories": int(trajectories)}
    settings |= {"seed": seed, "level": level, "covered": COVERED, "levels": LEVELS, "evaluations": values.size}
    missing = np.full(size, np.nan)
    found: dict[str, Any] = {"mu_star": missing, "mu_star_conf": missing, "mu": missing, "sigma": missing}
    outcome = Outcome() if np.all(np.isfinite(values)) else finite_outcome(values)
    if outcome.ok:
        found = analysis.analyze(problem, unit, values, conf_level=level, num_levels=LEVELS, seed=seed)
    return MorrisEffects(
        strength=np.asarray(found["mu_star"], dtype=float),
        strength_error=np.asarray(found["mu_star_conf"], dtype=float),
        direction=np.asarray(found["mu"], dtype=float),
        spread=np.asarray(found["sigma"], dtype=float),
        inputs={"design": input_of(design), "scatter": scatter},
        settings=settings,
        outcome=outcome,
    )
