"""Parameters that scatter together: a distribution for each, correlation by a Gaussian copula, and samples of them.

    z ~ N(0, R),   u_i = Phi(z_i),   x_i = F_i^-1(u_i)

R is the correlation of the normal scores z, F_i the distribution of parameter i. For normal distributions R is the
ordinary correlation of x; for others Spearman's rank correlation of x is (6/pi) asin(R/2) whatever the distributions.
A Gaussian copula has no tail dependence: extremes of two parameters come together less often than R may suggest.
Source: R. B. Nelsen, An Introduction to Copulas, 2nd ed. 2006, sections 2.3 and 5.1.
"""

from collections.abc import Mapping
from typing import Any, Literal, get_args

import numpy as np
from numpy.typing import ArrayLike

from squealbox.distributions import Distribution, as_distribution
from squealbox.parameters import DataSheet, ParameterError, known_names

Sampling = Literal["random", "latin_hypercube", "sobol"]
SAMPLINGS: tuple[Sampling, ...] = get_args(Sampling)
BITS = 30  # of scipy's Sobol' points: they are multiples of 2^-30
SMALLEST = 2.0**-54  # keeps a uniform number off 0 and 1, where a normal one is infinite


class Scatter(DataSheet):
    """Which parameters of a design scatter, how, and together with which others.

    Parameters
    ----------
    distributions : dotted name to distribution, such as ``{"friction.static": Normal(0.35, 0.03)}``; frozen
        distributions of `scipy.stats` are welcome
    correlation : of the normal scores (see above): pairs of names to numbers in (-1, 1), such as
        ``{("k1", "k2"): 0.5}``, or the whole matrix R, shape (d, d); left out, parameters are independent

    Raises `ParameterError` for an unknown name or a matrix that is no correlation matrix.

    >>> from squealbox.studies import Normal, Scatter, Uniform
    >>> scatter = Scatter({"friction.static": Normal(0.35, 0.03), "load": Uniform(800.0, 1200.0)})
    >>> sample = scatter.sample(256, seed=1)
    >>> sorted(sample), sample["load"].shape
    (['friction.static', 'load'], (256,))
    """

    distributions: Mapping[str, Distribution]
    correlation: Any = None

    def __post_init__(self) -> None:
        given: Any = self.distributions
        if not isinstance(given, Mapping) or not given:
            raise ParameterError("Scatter", "distributions", given, "names with a distribution each, at least one")
        found = {str(name): as_distribution(each, str(name)) for name, each in given.items()}
        object.__setattr__(self, "distributions", found)
        object.__setattr__(self, "correlation", _matrix(self.correlation, list(found)))

    def __hash__(self) -> int:
        return hash((*self.distributions.items(), self.correlation.tobytes()))

    @property
    def names(self) -> tuple[str, ...]:
        """The parameters that scatter, in order."""
        return tuple(self.distributions)

    @property
    def independent(self) -> bool:
        """True when no parameter is correlated with another."""
        return bool(np.array_equal(self.correlation, np.eye(len(self.distributions))))

    @property
    def rank_correlation(self) -> Any:
        """Spearman's rank correlation of the parameters, shape (d, d)."""
        return 6.0 / np.pi * np.arcsin(0.5 * self.correlation)

    def box(self, share: float = 0.99) -> dict[str, tuple[float, float]]:
        """An interval for each parameter: all that can occur where that is finite, else the central `share` of it."""
        edge = 0.5 * (1.0 - share)
        found = {}
        for name, each in self.distributions.items():
            inner = float(each.ppf(edge)), float(each.ppf(1.0 - edge))
            found[name] = each.support if np.all(np.isfinite(each.support)) else inner
        return found

    def from_uniform(self, u: np.ndarray) -> dict[str, Any]:
        """Parameters from independent uniform numbers `u` in (0, 1), shape (..., d): name to shape (...)."""
        from scipy.special import ndtri

        u = np.clip(np.asarray(u, dtype=float), SMALLEST, 1.0 - SMALLEST)
        if self.independent:
            return {name: each.ppf(u[..., i]) for i, (name, each) in enumerate(self.distributions.items())}
        return self.from_normal(ndtri(u))

    def from_normal(self, z: np.ndarray) -> dict[str, Any]:
        """Parameters from independent standard normal numbers `z`, shape (..., d): name to shape (...).

        With R = L L', the scores are L z. The upper tail is taken from the survival function, so that it is as exact
        as the lower one.
        """
        from scipy.special import ndtr

        scores = np.asarray(z, dtype=float) @ np.linalg.cholesky(self.correlation).T
        out = {}
        for i, (name, each) in enumerate(self.distributions.items()):
            frozen, score = each.frozen(), scores[..., i]
            tail = ndtr(-np.abs(score))
            out[name] = np.where(score > 0.0, frozen.isf(tail), frozen.ppf(tail))
        return out

    def to_normal(self, values: Mapping[str, Any]) -> Any:
        """The inverse of `from_normal`: independent standard normal numbers, shape (..., d)."""
        from scipy.special import ndtri

        scores = []
        for name, each in self.distributions.items():
            frozen, x = each.frozen(), np.asarray(values[name], dtype=float)
            below, above = frozen.cdf(x), frozen.sf(x)
            scores.append(np.where(below < above, ndtri(below), -ndtri(above)))
        stacked = np.stack(np.broadcast_arrays(*scores), axis=-1)
        if self.independent:
            return stacked
        return np.linalg.solve(np.linalg.cholesky(self.correlation), stacked[..., None])[..., 0]

    def sample(self, count: int, method: Sampling = "sobol", seed: int = 0) -> dict[str, Any]:
        """`count` samples of every parameter: name to shape (count,).

        method : "random" (independent points), "latin_hypercube" (every parameter stratified) or "sobol" (scrambled
            Sobol' points; a power of two is best, other counts take the first points of the next power)
        seed : the same seed gives the same samples

        With correlation the points are stratified before they are correlated, in z; only the first parameter keeps its
        strata exactly.
        """
        return self.from_uniform(unit_points(count, len(self.distributions), method, np.random.default_rng(seed)))


Scattered = Scatter | Mapping[str, Any]  # with its correlations, or name to distribution


def as_scatter(given: Scattered) -> Scatter:
    """``{"friction.static": Normal(0.4, 0.02)}`` as the independent scatter it stands for; a `Scatter` as it is."""
    return Scatter(given) if isinstance(given, Mapping) else given


def unit_points(count: int, dimensions: int, method: Sampling, rng: np.random.Generator) -> Any:
    """`count` points of the open unit cube, shape (count, dimensions); `rng` is a NumPy generator."""
    from scipy.stats import qmc

    if method not in SAMPLINGS:
        raise ParameterError("sample", "method", method, known_names(str(method), list(SAMPLINGS)))
    if isinstance(count, bool) or int(count) != count or count < 1:
        raise ParameterError("sample", "count", count, "a whole number of at least 1")
    if method == "random":
        return rng.random((count, dimensions))
    if method == "latin_hypercube":
        return qmc.LatinHypercube(dimensions, rng=rng).random(count)
    power = max(int(count) - 1, 0).bit_length()
    points = qmc.Sobol(dimensions, bits=BITS, rng=rng).random_base2(power)[:count]
    return points + 0.5 ** (BITS + 1)  # the middle of each cell, never 0


def _matrix(given: Mapping[tuple[str, str], float] | ArrayLike | None, names: list[str]) -> Any:
    """The correlation matrix from pairs or from itself, read-only."""
    size = len(names)
    matrix = np.eye(size)
    if isinstance(given, Mapping):
        for pair, value in given.items():
            i, j = _pair(pair, names)
            matrix[i, j] = matrix[j, i] = _coefficient(pair, value)
    elif given is not None:
        try:
            matrix = np.array(given, dtype=float)
        except (TypeError, ValueError) as error:
            raise ParameterError("Scatter", "correlation", given, "numbers") from error
        if matrix.shape != (size, size):
            expected = f"shape ({size}, {size}), a row for each of {', '.join(names)}"
            raise ParameterError("Scatter", "correlation", f"shape {matrix.shape}", expected)
    regular = np.all(np.isfinite(matrix)) and np.allclose(matrix, matrix.T, atol=1e-12)
    if not regular or not np.allclose(np.diag(matrix), 1.0, atol=1e-12):
        raise ParameterError("Scatter", "correlation", matrix.tolist(), "a symmetric matrix with ones on its diagonal")
    least = float(np.linalg.eigvalsh(matrix)[0])
    if least < 1e-10:
        expected = "a positive definite matrix: these correlations contradict each other or tie parameters completely"
        raise ParameterError("Scatter", "correlation", f"least eigenvalue {least:.3g}", expected)
    matrix.flags.writeable = False
    return matrix


def _pair(pair: object, names: list[str]) -> tuple[int, int]:
    if not isinstance(pair, tuple) or len(pair) != 2:
        raise ParameterError("Scatter", "correlation", pair, "pairs of names such as ('k1', 'k2')")
    for name in pair:
        if name not in names:
            raise ParameterError("Scatter", "correlation", name, known_names(str(name), names))
    if pair[0] == pair[1]:
        raise ParameterError("Scatter", "correlation", pair, "two different parameters")
    return names.index(pair[0]), names.index(pair[1])


def _coefficient(pair: tuple[str, str], value: float | np.ndarray) -> float:
    number = float(value) if isinstance(value, (int, float, np.number)) and not isinstance(value, bool) else np.nan
    if not -1.0 < number < 1.0:
        raise ParameterError("Scatter", f"correlation of {pair[0]} and {pair[1]}", value, "a number in (-1, 1)")
    return number
