"""A surrogate: the quantity as a polynomial of the parameters, from few evaluations. Polynomial chaos expansion.

    y(x) ~ sum_k c_k prod_i P_{a_ki}(g_i)

g_i is the germ of parameter i: for a normal or lognormal one its standard normal number with Hermite polynomials, for
any other 2 F_i(x_i) - 1 with Legendre polynomials, P scaled to unit variance. So the mean is c_0, the variance the sum
of the other c_k^2, and Sobol' indices are parts of that sum. The few terms that matter are chosen by least angle
regression in OpenTURNS. Source: G. Blatman, B. Sudret 2011, J. Comput. Phys. 230, 2345-2367.

How good it is, is told by points it has not seen: Q2 = 1 - sum (y - y_held_out)^2 / sum (y - mean)^2 by
cross-validation in which the terms are chosen anew in each fold. A growth rate has a kink where two modes meet, which
no polynomial follows: use a smooth quantity, such as the margin of friction.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from squealbox.arguments import public
from squealbox.distributions import Lognormal, Normal
from squealbox.extras import extra
from squealbox.family import DesignOrRecipe
from squealbox.parameters import ParameterError
from squealbox.result import OF_QUANTITY, Array, Outcome, Result, quantity
from squealbox.scatter import Scatter, Scattered, as_scatter
from squealbox.studies.quantity import Quantity, QuantityLike, as_quantity, evaluate, input_of
from squealbox.studies.uncertainty.sobol import finite_outcome

FOLDS = 10
GOOD = 0.95  # Q2 below which the surrogate says that it is not to be trusted
MOST_TERMS = 2000
HYPERBOLIC = 0.75  # q-norm of the candidate terms: fewer interactions of high degree
DEGREES = (1, 2, 3, 4, 5, 6, 8, 10)


@dataclass(frozen=True, kw_only=True, eq=False)
class Surrogate(Result):
    """A polynomial in place of the quantity, as :func:`polynomial_chaos` returns it; call it with named values.

    >>> from squealbox.studies import Scatter, Uniform, polynomial_chaos
    >>> square = polynomial_chaos(None, Scatter({"x": Uniform(0.0, 2.0)}), lambda at: at["x"] ** 2, samples=32)
    >>> round(float(square({"x": 1.5})), 9), round(float(square.q2), 9)
    (2.25, 1.0)
    """

    coefficients: Array = quantity("term", "", "c_k")
    degrees: Array = quantity("term parameter", "1", "a_ki, degree of each parameter in each term")
    points: Array = quantity("point parameter", "", "training points, in SI")
    values: Array = quantity("point", OF_QUANTITY, "the quantity there")
    held_out: Array = quantity("point", OF_QUANTITY, "what a surrogate that has not seen the point says there")
    q2: Any = quantity("", "1", "share of the variance explained at points not seen")

    table_over: ClassVar = ("point",)
    headings: ClassVar = {"points": "{}", "held_out": "said of it unseen"}

    def __call__(self, at: Mapping[str, Any]) -> Any:
        """The surrogate at named values (arrays broadcast together), in the unit of the quantity."""
        scatter: Scatter = self.inputs["scatter"]
        columns = np.broadcast_arrays(*(np.asarray(at[name], dtype=float) for name in self.names))
        return terms(germs(scatter, np.stack(columns, axis=-1)), _hermite(scatter), self.degrees) @ self.coefficients

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters, in order."""
        return tuple(self.settings["names"])

    @property
    def quantity(self) -> Quantity:
        """The surrogate as a quantity of named values, for studies with ``design=None``."""
        about = self.settings["quantity"]
        return Quantity(self, f"{about['name']} (surrogate)", about["unit"], about["limit"], about["squeals"])

    @property
    def average(self) -> float:
        """Mean of the surrogate."""
        return float(np.sum(self.coefficients[np.sum(self.degrees, axis=1) == 0]))

    @property
    def deviation(self) -> float:
        """Standard deviation of the surrogate."""
        return float(np.sqrt(np.sum(self.coefficients[np.sum(self.degrees, axis=1) > 0] ** 2)))

    @property
    def first(self) -> Any:
        """First-order Sobol' indices of the surrogate, shape (parameters,)."""
        return self._shares(alone=True)

    @property
    def total(self) -> Any:
        """Total Sobol' indices of the surrogate, shape (parameters,)."""
        return self._shares(alone=False)

    @property
    def misjudged(self) -> float:
        """Share of the training points whose squeal a surrogate that has not seen them gets wrong."""
        excess = self.quantity.excess
        return float(np.mean((excess(self.values) > 0.0) != (excess(self.held_out) > 0.0)))

    @property
    def caution(self) -> str:
        """Why the surrogate is not to be trusted; empty when nothing speaks against it."""
        if not self.outcome.ok:
            return ""
        kink = "" if self.settings["smooth"] else (
            f"the {self.settings['quantity']['name']} has kinks, which no polynomial follows: "
            "a smooth quantity, such as the margin of friction, serves better. "
        )  # fmt: skip
        poor = f"Q2 is {float(self.q2):.3f}, below {GOOD}: do not use it for more than a ranking. "
        return (kink + (poor if float(self.q2) < GOOD else "")).strip()

    def _shares(self, *, alone: bool) -> Any:
        if not self.inputs["scatter"].independent:
            expected = "independent parameters: with correlation the variance does not split into shares"
            raise ParameterError("Surrogate", "scatter", "correlated", expected)
        used = self.degrees > 0
        parts = self.coefficients**2
        several = np.sum(used, axis=1) > 1
        shares = [np.sum(parts[used[:, i] & ~(several & alone)]) for i in range(used.shape[1])]
        return np.array(shares) / self.deviation**2

    def summary(self) -> str:
        """What it is made of and how far it is to be trusted."""
        if not self.outcome.ok:
            return f"surrogate: {self.outcome.told}"
        settings, about = self.settings, self.settings["quantity"]
        unit = f" {about['unit']}" if about["unit"] else ""
        top = int(np.max(np.sum(self.degrees, axis=1)))
        lines = [
            f"{about['name']} as {self.coefficients.size} terms of degree up to {top}, from {self.values.size} points",
            f"Q2 = {float(self.q2):.5f} by {settings['folds']}-fold cross-validation; squeal misjudged at "
            f"{100.0 * self.misjudged:.2g} % of points not seen",
            f"mean {self.average:.5g}, deviation {self.deviation:.3g}{unit}",
        ]
        if self.inputs["scatter"].independent:
            order = np.argsort(-self.total)
            parts = (f"{self.names[i]} {self.first[i]:.3f} / {self.total[i]:.3f}" for i in order)
            lines.append(f"Sobol' indices, first / total: {', '.join(parts)}")
        return self.warned(lines)


@public(design=None)
def polynomial_chaos(
    design: DesignOrRecipe | None,
    scatter: Scattered,
    quantity: QuantityLike,
    *,
    samples: int = 256,
    degree: int | None = None,
    seed: int = 0,
    folds: int = FOLDS,
) -> Surrogate:
    """A polynomial that stands for `quantity` over `scatter`, with its Q2 by cross-validation.

    Parameters
    ----------
    design, scatter, quantity, seed : as for `squeal_probability`; parameters may be correlated
    samples : Sobol' points at which the quantity is evaluated
    degree : highest total degree; None takes the one of 1 to 6, 8 and 10 with the best Q2
    folds : of the cross-validation

    Accuracy: Q2, and `caution`. An unknown or infinite value gives the outcome "unknown_values", a quantity that does
    not vary "no_variance".
    """
    scatter = as_scatter(scatter)
    asked = as_quantity(quantity)
    for name, value, least in (("samples", samples, 10), ("folds", folds, 2)):
        if isinstance(value, bool) or int(value) != value or value < least:
            raise ParameterError("polynomial_chaos", name, value, f"a whole number of at least {least}")
    if degree is not None and not 1 <= degree <= 20:
        raise ParameterError("polynomial_chaos", "degree", degree, "a whole number from 1 to 20")
    points = scatter.sample(samples, "sobol", seed)
    columns = np.stack([points[name] for name in scatter.names], axis=-1)
    values = evaluate(design, asked, points)
    outcome = Outcome() if np.all(np.isfinite(values)) else finite_outcome(values)
    if outcome.ok and np.ptp(values) == 0.0:
        outcome = Outcome("no_variance", f"the quantity is {values[0]:g} at every point", value=float(values[0]))
    size = len(scatter.names)
    best: tuple[Any, ...] = (np.zeros(0), np.zeros((0, size), dtype=int), np.full(values.shape, np.nan), np.nan)
    if outcome.ok:
        tried = [degree] if degree else _degrees(size)
        best = max((_expansion(scatter, columns, values, d, folds, seed) for d in tried), key=lambda found: found[3])
    settings = {"quantity": asked.about, "names": list(scatter.names), "samples": int(samples), "seed": seed}
    settings |= {"degree": degree, "folds": int(folds), "smooth": asked.smooth}
    return Surrogate(
        coefficients=best[0],
        degrees=best[1],
        held_out=best[2],
        q2=best[3],
        points=columns,
        values=values,
        inputs={"design": input_of(design), "scatter": scatter},
        settings=settings,
        outcome=outcome,
    )


def germs(scatter: Scatter, points: np.ndarray) -> Any:
    """The germs of points (..., d): independent standard normal or uniform (-1, 1) numbers, the same shape."""
    from scipy.special import ndtr

    z = scatter.to_normal({name: points[..., i] for i, name in enumerate(scatter.names)})
    return np.where(_hermite(scatter), z, 2.0 * ndtr(z) - 1.0)


def terms(germ: np.ndarray, hermite: np.ndarray, degrees: np.ndarray) -> Any:
    """The polynomials of unit variance at germs (..., d): shape (..., terms)."""
    from math import factorial

    from numpy.polynomial.hermite_e import hermevander
    from numpy.polynomial.legendre import legvander

    top = int(np.max(degrees, initial=0))
    product: Any = 1.0
    for i, is_hermite in enumerate(hermite):
        norms = [1.0 / np.sqrt(factorial(n)) if is_hermite else np.sqrt(2.0 * n + 1.0) for n in range(top + 1)]
        table = (hermevander if is_hermite else legvander)(germ[..., i], top) * np.array(norms)
        table = table.reshape(*germ.shape[:-1], top + 1)  # NumPy makes a vector of a single number
        product = product * table[..., degrees[:, i]]
    return product


def _hermite(scatter: Scatter) -> Any:
    """True for the parameters whose germ is normal: all of them when they are correlated."""
    normal = [isinstance(each, (Normal, Lognormal)) for each in scatter.distributions.values()]
    return np.array(normal) if scatter.independent else np.ones(len(normal), dtype=bool)


def _degrees(size: int) -> list[int]:
    from math import comb

    return [degree for degree in DEGREES if degree == 1 or comb(size + degree, degree) <= MOST_TERMS]


def _expansion(
    scatter: Scatter, columns: np.ndarray, values: np.ndarray, degree: int, folds: int, seed: int
) -> tuple[Any, Any, Any, float]:
    """Coefficients, degrees, held-out predictions and Q2 for one total degree."""
    germ, hermite = germs(scatter, columns), _hermite(scatter)
    order = np.random.default_rng(seed).permutation(values.size)
    held_out = np.empty(values.shape)
    for part in np.array_split(order, folds):
        rest = np.setdiff1d(order, part)
        coefficients, degrees = _fit(germ[rest], values[rest], hermite, degree)
        held_out[part] = terms(germ[part], hermite, degrees) @ coefficients
    q2 = 1.0 - float(np.sum((values - held_out) ** 2) / np.sum((values - np.mean(values)) ** 2))
    return (*_fit(germ, values, hermite, degree), held_out, q2)


def _fit(germ: np.ndarray, values: np.ndarray, hermite: np.ndarray, degree: int) -> tuple[Any, Any]:
    """Coefficients and degrees of the terms that least angle regression chooses."""
    with extra("studies"):
        import openturns as ot

    ot.Log.Show(ot.Log.NONE)
    size = len(hermite)
    marginals = [ot.Normal() if each else ot.Uniform(-1.0, 1.0) for each in hermite]
    families = [ot.StandardDistributionPolynomialFactory(each) for each in marginals]
    numbering = ot.HyperbolicAnisotropicEnumerateFunction(size, HYPERBOLIC)
    basis = ot.OrthogonalProductPolynomialFactory(families, numbering)
    count = numbering.getBasisSizeFromTotalDegree(degree)
    selection = ot.LeastSquaresStrategy(ot.LeastSquaresMetaModelSelectionFactory(ot.LARS(), ot.CorrectedLeaveOneOut()))
    measure = ot.JointDistribution(marginals)
    algorithm = ot.FunctionalChaosAlgorithm(
        ot.Sample(germ), ot.Sample(values[:, None]), measure, ot.FixedStrategy(basis, count), selection
    )
    algorithm.run()
    found = algorithm.getResult()
    chosen = [np.array(numbering(int(i)), dtype=int) for i in found.getIndices()]
    return np.array(found.getCoefficients())[:, 0], np.array(chosen).reshape(-1, size)
