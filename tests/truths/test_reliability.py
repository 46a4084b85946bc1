"""Rare squeal and surrogates against closed forms.

For normal parameters and a linear quantity a'x the limit state is a plane: beta = (limit - a'm)/sqrt(a'S a), and FORM
is exact. For n independent standard normals r^2 = x1^2 + ... is chi-squared, so P(r > R) is known and FORM, which sees
one plane of the sphere, must be wrong.
"""

import numpy as np
import pytest
from scipy.stats import chi2, norm

from squealbox import quantities
from squealbox.designs import DampingParadox, ModeCoupling
from squealbox.parameters import ParameterError
from squealbox.result import Result
from squealbox.studies import (
    Lognormal,
    Normal,
    Quantity,
    Scatter,
    Uniform,
    form,
    polynomial_chaos,
    squeal_probability,
    subset_simulation,
)
from truths.test_uncertainty import ISHIGAMI, ishigami, ishigami_truth

PAIR = Scatter({"a": Normal(0.0, 1.0), "b": Normal(0.0, 1.0)})
MARGIN = quantities.margin("friction.static", (0.0, 3.0), points=13)


def coupling(rho):
    """Squeal of the mode-coupling model if mu > k12: beta = 0.3/s, s^2 = s_mu^2 + s_k^2 - 2 rho s_mu s_k."""
    names = {"friction.static": Normal(0.5, 0.05), "k12": Normal(0.8, 0.04)}
    variance = 0.05**2 + 0.04**2 - 2.0 * rho * 0.05 * 0.04
    return Scatter(names, {("friction.static", "k12"): rho}), 0.3 / np.sqrt(variance)


@pytest.mark.parametrize("rho", [0.0, 0.4])
def test_form_is_exact_for_a_straight_boundary(rho):
    """Through eigenvalues and a root search: the onset is good to 1e-12, the search of the point to 1e-7."""
    scatter, beta = coupling(rho)
    found = form(ModeCoupling(), scatter, MARGIN, samples=300)
    assert float(found.beta) == pytest.approx(beta, rel=1e-6)
    assert float(found.probability) == pytest.approx(norm.sf(beta), rel=1e-4)
    assert found.straight
    assert float(found.low) < norm.sf(beta) < float(found.high)
    assert found.point[0] == pytest.approx(found.point[1], rel=1e-6)  # mu k3 = k12 there
    assert float(found.beta) != pytest.approx(0.3 / 0.09, rel=0.05)  # deviations added instead of variances
    if rho == 0.0:  # the importance of independent parameters is their share of the variance
        assert found.importance == pytest.approx([25.0 / 41.0, 16.0 / 41.0], rel=1e-5)


def test_a_squealing_median_has_a_negative_index():
    found = form(None, PAIR, Quantity(lambda at: at["a"] + at["b"], "sum", limit=-1.0))
    assert float(found.beta) == pytest.approx(-1.0 / np.sqrt(2.0), rel=1e-6)
    assert float(found.probability) == pytest.approx(norm.cdf(1.0 / np.sqrt(2.0)), rel=1e-6)


def test_form_is_wrong_for_a_sphere_and_says_so():
    ball = Quantity(lambda at: np.hypot(at["a"], at["b"] + 1e-3), "radius", limit=4.0)
    found = form(None, PAIR, ball, samples=20_000)
    assert not found.straight
    assert "curved" in found.summary()
    assert chi2.sf(16.0, 2) > 5.0 * float(found.probability)


def test_no_design_point_is_an_outcome():
    found = form(None, PAIR, Quantity(lambda at: np.tanh(at["a"]), "never", limit=2.0), iterations=20)
    assert found.outcome == "no_design_point"
    assert np.isnan(found.probability)
    assert "no_design_point" in found.summary()


def test_subset_simulation_at_one_in_a_million():
    """20 independent runs at P = 1e-6: their mean within the stated variation, their scatter about as stated."""
    limit = float(norm.isf(1e-6)) * np.sqrt(2.0)
    rare = Quantity(lambda at: at["a"] + at["b"], "sum", limit=limit)
    found = subset_simulation(None, PAIR, rare, runs=20)
    assert float(found.probability) == pytest.approx(1e-6, rel=3.0 * float(found.variation))
    assert float(found.low) < 1e-6 < float(found.high)
    assert float(found.variation) < 0.1
    # a sample deviation of 20 scatters by 1/sqrt(38) = 16 %; chains make the stated one up to a third too small
    assert 0.6 < found.spread / np.mean(found.variation_of_runs) < 1.9
    assert found.settings["evaluations"] < 20 * 2000 * 8  # where counting needs 1e8 points for as much
    assert not float(found.low) < 2e-6 < float(found.high)


def test_subset_simulation_of_an_onset_below_and_above_the_median():
    scatter, beta = coupling(0.0)
    found = subset_simulation(ModeCoupling(), scatter, MARGIN, samples=200, runs=2, seed=1)
    assert float(found.low) < norm.sf(beta) < float(found.high)
    usual = subset_simulation(None, PAIR, Quantity(lambda at: at["a"], "a", limit=0.3), seed=1)
    assert float(usual.low) < norm.sf(0.3) < float(usual.high)


def test_subset_simulation_says_why_it_found_nothing():
    flat = subset_simulation(ModeCoupling(), coupling(0.0)[0], quantities.growth_rate(), samples=500, runs=2)
    assert flat.outcome == "flat_quantity"
    assert "margin" in flat.summary()
    never = Quantity(lambda at: np.tanh(at["a"]), "never", limit=2.0)
    assert subset_simulation(None, PAIR, never, samples=500, runs=2, smallest=1e-6).outcome == "too_rare"


def test_studies_leave_the_generator_of_openturns_as_it_was():
    import openturns as ot

    ot.RandomGenerator.SetSeed(11)
    expected = ot.Normal().getSample(3)
    ot.RandomGenerator.SetSeed(11)
    far = Quantity(lambda at: at["a"], "a", limit=2.0)
    runs = [subset_simulation(None, PAIR, far, samples=200, seed=seed) for seed in (5, 5, 6)]
    assert ot.Normal().getSample(3) == expected
    assert np.array_equal(runs[0].of_runs, runs[1].of_runs)
    assert not np.array_equal(runs[0].of_runs, runs[2].of_runs)


def test_surrogate_of_ishigami():
    """Sobol' indices from the coefficients, against the closed form: the error left is 1 - Q2."""
    found = polynomial_chaos(None, ISHIGAMI, ishigami, samples=400, degree=10)
    first, total = ishigami_truth()
    assert float(found.q2) > 0.999
    assert np.allclose(found.first, first, atol=2e-3)
    assert np.allclose(found.total, total, atol=2e-3)
    assert found.average == pytest.approx(3.5, abs=5e-3)
    coarse = polynomial_chaos(None, ISHIGAMI, ishigami, samples=64, degree=3)
    assert float(coarse.q2) < 0.7
    assert "ranking" in coarse.caution


def test_surrogate_is_exact_for_a_polynomial_of_any_germ():
    scatter = Scatter({"n": Normal(1.0, 2.0), "u": Uniform(0.0, 3.0)})
    found = polynomial_chaos(None, scatter, lambda at: at["n"] ** 2 * at["u"] - at["u"] ** 3, samples=128, degree=4)
    at = {"n": np.array([-3.0, 0.5]), "u": np.array([0.1, 2.9])}
    assert found(at) == pytest.approx(at["n"] ** 2 * at["u"] - at["u"] ** 3, abs=1e-9)
    assert found.average == pytest.approx(5.0 * 1.5 - 27.0 / 4.0, abs=1e-9)  # E n^2 = 1 + 4, E u^3 = 27/4
    tied = Scatter({"a": Normal(0.0, 1.0), "b": Lognormal(1.0, 0.2)}, {("a", "b"): 0.5})
    line = polynomial_chaos(None, tied, lambda at: at["a"] + np.log(at["b"]), samples=64, degree=2)
    assert float(line.q2) == pytest.approx(1.0, abs=1e-9)
    with pytest.raises(ParameterError, match="independent"):
        line.total  # noqa: B018


def test_surrogate_warns_at_the_kink_and_serves_where_the_quantity_is_smooth():
    """The same brake by its growth rate and by its margin of friction."""
    design = DampingParadox()
    scatter = Scatter({"friction.static": Normal(0.27, 0.03), "k1": Normal(design.k1, 0.03 * design.k1)})
    kinked = polynomial_chaos(design, scatter, quantities.growth_rate(), samples=128)
    smooth = polynomial_chaos(design, scatter, quantities.margin("friction.static", (0.0, 1.0)), samples=128)
    assert "kinks" in kinked.caution
    assert kinked.misjudged > 0.03
    assert float(smooth.q2) > 0.999
    assert smooth.caution == ""
    assert smooth.misjudged < 0.02
    full = squeal_probability(design, scatter, quantities.growth_rate())
    cheap = squeal_probability(None, scatter, smooth.quantity)
    assert float(cheap.probability) == pytest.approx(float(full.probability), abs=0.005)


def test_results_are_saved_and_read_back(tmp_path):
    far = Quantity(lambda at: at["a"] + at["b"], "sum", limit=4.0)
    runs = (
        form(None, PAIR, far),
        subset_simulation(None, PAIR, far, samples=200),
        polynomial_chaos(None, PAIR, far, samples=64),
    )
    for i, found in enumerate(runs):
        again = Result.load(found.save(tmp_path / f"{i}.nc"))
        assert again.summary() == found.summary()
    assert float(again({"a": 1.0, "b": 2.0})) == pytest.approx(3.0, abs=1e-9)  # read back, it still computes
