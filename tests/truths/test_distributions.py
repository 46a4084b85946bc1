"""Distributions against their closed forms, samples against the laws they are drawn from.

Tolerances: a mean of n independent values scatters by sd/sqrt(n); five of those are allowed, so that a fixed seed
passes whatever the generator, and a wrong formula fails. Quasi-random points are held closer than random ones reach.
"""

import dataclasses

import numpy as np
import pytest
from scipy import stats

from squealbox.parameters import ParameterError, from_plain, to_plain
from squealbox.studies import (
    SAMPLINGS,
    Beta,
    Lognormal,
    Normal,
    Scatter,
    ScipyDistribution,
    Triangular,
    TruncatedNormal,
    Uniform,
    as_distribution,
)

# mean and variance in closed form
TRUTHS = [
    (Normal(0.35, 0.03), 0.35, 0.03**2),
    (Uniform(-1.0, 2.0), 0.5, 9.0 / 12.0),
    (Lognormal(2.0, 0.5), 2.0, 0.25),
    (Triangular(0.0, 1.0, 4.0), 5.0 / 3.0, (0.0 + 1.0 + 16.0 - 0.0 - 0.0 - 4.0) / 18.0),
    (Beta(1.0, 3.0, 2.0, 6.0), 1.0 + 2.0 * 0.25, 4.0 * 12.0 / (64.0 * 9.0)),
    # half a normal: mean sqrt(2/pi), variance 1 - 2/pi
    (TruncatedNormal(0.0, 1.0, low=0.0), np.sqrt(2.0 / np.pi), 1.0 - 2.0 / np.pi),
    # least of exponentials: mean and variance of scale 0.2
    (ScipyDistribution("expon", loc=1.0, scale=0.2), 1.2, 0.04),
]
EACH = [pytest.param(*row, id=type(row[0]).__name__) for row in TRUTHS]


@pytest.mark.parametrize(("given", "mean", "variance"), EACH)
def test_mean_and_deviation(given, mean, variance):
    assert given.average == pytest.approx(mean, rel=1e-12)
    assert given.deviation**2 == pytest.approx(variance, rel=1e-10)


@pytest.mark.parametrize(("given", "mean", "variance"), EACH)
@pytest.mark.parametrize("method", SAMPLINGS)
def test_samples_have_the_mean_and_follow_the_distribution(given, mean, variance, method):
    values = Scatter({"x": given}).sample(4096, method, seed=3)["x"]
    allowed = 5.0 * np.sqrt(variance / values.size)
    assert abs(np.mean(values) - mean) < (allowed if method == "random" else 0.1 * allowed)
    # Kolmogorov's statistic: 1.95/sqrt(n) is passed by chance in 1 of 1000; stratified points stay within 1/n
    steps = np.arange(1, values.size + 1) / values.size
    distance = float(np.max(np.abs(steps - given.cdf(np.sort(values)))))
    assert distance < (1.95 / np.sqrt(values.size) if method == "random" else 1.01 / values.size)


def test_a_wrong_distribution_fails_that_check():
    values = Scatter({"x": Normal(0.35, 0.03)}).sample(4096, "random", seed=3)["x"]
    steps = np.arange(1, values.size + 1) / values.size
    distance = float(np.max(np.abs(steps - Normal(0.35, 0.036).cdf(np.sort(values)))))
    assert distance > 1.95 / np.sqrt(values.size)


@pytest.mark.parametrize("method", SAMPLINGS)
def test_seeds_reproduce_and_differ(method):
    scatter = Scatter({"a": Normal(0.0, 1.0), "b": Uniform(0.0, 1.0)}, {("a", "b"): 0.4})
    first, again, other = (scatter.sample(100, method, seed=seed) for seed in (7, 7, 8))
    assert all(np.array_equal(first[name], again[name]) for name in "ab")
    assert not any(np.array_equal(first[name], other[name]) for name in "ab")


@pytest.mark.parametrize("method", SAMPLINGS)
@pytest.mark.parametrize("rho", [-0.8, 0.5])
def test_correlation_is_that_of_the_copula(method, rho):
    """For any marginals Spearman's rho is (6/pi) asin(R/2); for normals R is the ordinary correlation."""
    count = 1 << 14
    scatter = Scatter({"a": Normal(1.0, 2.0), "b": Normal(0.0, 1.0)}, {("a", "b"): rho})
    a, b = scatter.sample(count, method, seed=5).values()
    assert np.corrcoef(a, b)[0, 1] == pytest.approx(rho, abs=5.0 / np.sqrt(count))
    skewed = Scatter({"a": Lognormal(1.0, 0.9), "b": Beta(0.0, 1.0, 0.5, 3.0)}, {("a", "b"): rho})
    a, b = skewed.sample(count, method, seed=5).values()
    ranks = 6.0 / np.pi * np.arcsin(rho / 2.0)
    assert skewed.rank_correlation[0, 1] == pytest.approx(ranks, rel=1e-14)
    assert stats.spearmanr(a, b).statistic == pytest.approx(ranks, abs=5.0 / np.sqrt(count))
    assert abs(np.corrcoef(a, b)[0, 1] - rho) > 0.03  # the ordinary correlation of skewed numbers is another


def test_tails_are_exact_on_both_sides():
    """At 8 standard deviations a probability of 1 - 6e-16 has no digits left; the survival function has."""
    z = np.array([[-8.0], [8.0]])
    values = Scatter({"x": Normal(0.0, 1.0)}).from_normal(z)["x"]
    assert values == pytest.approx([-8.0, 8.0], rel=1e-12)
    assert float(Normal(0.0, 1.0).ppf(stats.norm.cdf(8.0))) != pytest.approx(8.0, rel=1e-5)


def test_a_frozen_distribution_of_scipy_is_taken_as_it_is():
    frozen = stats.weibull_min(1.7, scale=0.4, loc=0.1)
    found = as_distribution(frozen)
    assert found == ScipyDistribution("weibull_min", [1.7], 0.1, 0.4)
    u = np.linspace(0.01, 0.99, 9)
    assert np.array_equal(found.ppf(u), frozen.ppf(u))


def test_a_scatter_survives_plain_data_and_is_hashable():
    scatter = Scatter({"a": Normal(1.0, 2.0), "b": stats.gumbel_r(0.1, 2.0)}, {("a", "b"): 0.3})
    again = from_plain(to_plain(scatter))
    assert again == scatter
    assert hash(again) == hash(scatter)
    assert again != scatter.replace(correlation=np.eye(2))
    with pytest.raises(dataclasses.FrozenInstanceError):
        scatter.correlation = None


NONSENSE = [
    (lambda: Normal(0.0, 0.0), "Normal.sd"),
    (lambda: Normal([0.0, 1.0], 1.0), "Normal.mean"),
    (lambda: Uniform(1.0, 1.0), "Uniform.high"),
    (lambda: Lognormal(-1.0, 1.0), "Lognormal.mean"),
    (lambda: Triangular(0.0, 3.0, 2.0), "Triangular.mode"),
    (lambda: TruncatedNormal(0.0, 1.0, 2.0, 1.0), "TruncatedNormal.high"),
    (lambda: Beta(0.0, 1.0, 0.0, 1.0), "Beta.a"),
    (lambda: ScipyDistribution("gamble_r"), "gumbel_r"),
    (lambda: ScipyDistribution("weibull_min"), "ScipyDistribution.shapes"),
    (lambda: ScipyDistribution("weibull_min", -1.0), "ScipyDistribution.shapes"),
    (lambda: Scatter({}), "at least one"),
    (lambda: Scatter({"a": 3.0}), "scatter.a = 3"),
    (lambda: Scatter({"a": stats.poisson(3.0)}), "continuous"),
    (lambda: Scatter({"a": Normal(0.0, 1.0)}, {("a", "b"): 0.3}), "did you mean|one of a"),
    (lambda: Scatter({"a": Normal(0.0, 1.0)}, {("a", "a"): 0.3}), "two different"),
    (lambda: Scatter({n: Normal(0.0, 1.0) for n in "ab"}, {("a", "b"): 1.0}), r"\(-1, 1\)"),
    (lambda: Scatter({n: Normal(0.0, 1.0) for n in "ab"}, [[1.0, 0.2], [0.3, 1.0]]), "symmetric"),
    (lambda: Scatter({n: Normal(0.0, 1.0) for n in "ab"}, np.eye(3)), r"shape \(2, 2\)"),
    (
        lambda: Scatter({n: Normal(0.0, 1.0) for n in "abc"}, {("a", "b"): 0.9, ("b", "c"): 0.9, ("a", "c"): -0.9}),
        "positive definite",
    ),
    (lambda: Scatter({"a": Normal(0.0, 1.0)}).sample(0), "at least 1"),
    (lambda: Scatter({"a": Normal(0.0, 1.0)}).sample(9, "halton"), "latin_hypercube"),
]


@pytest.mark.parametrize(("make", "text"), NONSENSE, ids=[text for _, text in NONSENSE])
def test_nonsense_is_one_clear_sentence(make, text):
    with pytest.raises(ParameterError, match=text) as caught:
        make()
    assert "\n" not in str(caught.value)
