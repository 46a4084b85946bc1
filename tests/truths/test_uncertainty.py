"""Probabilities, shares of variance and ranges against closed forms.

The undamped mode-coupling model flutters from  mu_c = [k12 + (k11 - k22)^2/(4 k12)]/k3  on (its page derives it). With
k11 and k22 independent normal numbers of equal mean and deviations s1, s2, and D = k11 - k22 ~ N(0, s1^2 + s2^2),

    E[D^2 | k11] = (k11 - m)^2 + s2^2    so    V1 = 2 s1^4,  V2 = 2 s2^4,  Var D^2 = 2 (s1^2 + s2^2)^2.

With 1/k3 independent, y = g h (g the bracket, h = 1/k3) has Var y = E[g^2] E[h^2] - (E g E h)^2, V_k3 = (E g)^2 Var h,
V_i = (E h)^2 Var E[g | k_i], and totals ST_k3 = E[g^2] Var h / Var y, ST_i = E[h^2] (Var g - Var E[g | k_j]) / Var y.

For k11 = k22 the onset is linear: squeal if mu k3 > k12. With normal mu and k12 and k3 = 1 the margin k12 - mu is
normal, so P(squeal) = Phi(-m/s) exactly, with s^2 = s_mu^2 + s_k^2 - 2 rho s_mu s_k.
"""

import numpy as np
import pytest
from scipy.stats import norm

from squealbox import quantities
from squealbox.designs import DampingParadox, DrumBrake, ModeCoupling
from squealbox.friction import Coulomb
from squealbox.parameters import ParameterError
from squealbox.plots import plot
from squealbox.result import Result
from squealbox.stability import complex_modes, critical_value, first_crossings
from squealbox.studies import (
    Lognormal,
    Normal,
    Quantity,
    Scatter,
    Uniform,
    evaluate,
    interval_bounds,
    morris_effects,
    sobol_indices,
    squeal_probability,
)
from squealbox.studies.uncertainty.replicates import binomial_interval, student_interval
from squealbox.transient import simulate_ensemble

CIRCLE = Uniform(-np.pi, np.pi)
ISHIGAMI = Scatter(dict.fromkeys(("x1", "x2", "x3"), CIRCLE))


def ishigami(at):
    return np.sin(at["x1"]) + 7.0 * np.sin(at["x2"]) ** 2 + 0.1 * at["x3"] ** 4 * np.sin(at["x1"])


def ishigami_truth():
    """First and total indices for a = 7, b = 0.1 (Ishigami and Homma 1990): by integrating sines and powers."""
    first = np.array([0.5 * (1.0 + 0.1 * np.pi**4 / 5.0) ** 2, 49.0 / 8.0, 0.0])
    together = 8.0 * 0.01 * np.pi**8 / 225.0
    variance = np.sum(first) + together
    return first / variance, (first + np.array([together, 0.0, together])) / variance


def coupling_truth(s1, s2, k12, k3):
    """Mean, first and total indices of the undamped onset for k11, k22, k3 as derived above."""
    g, var_g = k12 + (s1**2 + s2**2) / (4.0 * k12), 2.0 * (s1**2 + s2**2) ** 2 / (16.0 * k12**2)
    v1, v2 = (2.0 * s**4 / (16.0 * k12**2) for s in (s1, s2))
    mean_h = np.exp(-k3.log_mean + 0.5 * k3.log_sd**2)  # 1/k3 is lognormal too
    var_h = mean_h**2 * np.expm1(k3.log_sd**2)
    g2, h2 = g**2 + var_g, mean_h**2 + var_h
    total = g2 * h2 - (g * mean_h) ** 2
    first = np.array([mean_h**2 * v1, mean_h**2 * v2, g**2 * var_h]) / total
    return g * mean_h, first, np.array([h2 * (var_g - v2), h2 * (var_g - v1), g2 * var_h]) / total


def within(found, truth, name, factor=1.5):
    """True where the interval, `factor` times as wide, holds the truth: 95 % intervals miss now and then."""
    low, high = getattr(found, f"{name}_low"), getattr(found, f"{name}_high")
    return np.all(np.abs(getattr(found, name) - truth) <= 0.5 * factor * (high - low) + 1e-4)


def test_indices_of_ishigami():
    found = sobol_indices(None, ISHIGAMI, ishigami, samples=1 << 14, seed=2)
    first, total = ishigami_truth()
    assert np.allclose(found.first, first, atol=0.01)  # two to three times the sampling error at this size
    assert np.allclose(found.total, total, atol=0.01)
    assert within(found, first, "first")
    assert within(found, total, "total")
    assert not within(found, total, "first")
    assert float(found.average) == pytest.approx(3.5, abs=0.01)
    assert found.settings["evaluations"] == (1 << 14) * 5


S1, S2, K12, K3 = 0.5, 0.3, 0.4, Lognormal(1.0, 0.1)
ONSET = Scatter({"k11": Normal(2.0, S1), "k22": Normal(2.0, S2), "k3": K3})


def onset(at):
    return (K12 + (at["k11"] - at["k22"]) ** 2 / (4.0 * K12)) / at["k3"]


def test_indices_of_the_undamped_onset():
    """The onset by eigenvalues; its fourth moments are large, so 1024 points give the shares to some 0.1 and say so."""
    mean, first, total = coupling_truth(S1, S2, K12, K3)
    ask = quantities.critical_value("friction.static", (0.0, 10.0), limit=0.4, points=33)
    points = ONSET.sample(64)
    assert np.allclose(evaluate(ModeCoupling(k12=K12), ask, points), onset(points), rtol=1e-10)
    found = sobol_indices(ModeCoupling(k12=K12), ONSET, ask, samples=1 << 10, seed=1)
    assert float(found.average) == pytest.approx(mean, rel=0.02)
    assert within(found, first, "first")
    assert within(found, total, "total")
    assert np.max(np.abs(found.first - total)) > 0.1  # the interaction of k11 and k22 is no small thing


def test_intervals_of_shares_hold_the_truth():
    """60 seeds, 6 intervals at 95 % each: 18 misses of 360 expected, +- 4.1 if they were independent."""
    _, first, total = coupling_truth(S1, S2, K12, K3)
    missed = halved = 0
    for seed in range(60):
        found = sobol_indices(None, ONSET, onset, samples=1 << 12, seed=seed)
        for name, truth in (("first", first), ("total", total)):
            error = np.abs(getattr(found, name) - truth)
            half = getattr(found, f"{name}_high") - getattr(found, name)
            missed, halved = missed + int(np.sum(error > half)), halved + int(np.sum(error > 0.5 * half))
    assert missed <= 18 + 3 * 4.1
    assert halved > 18 + 3 * 4.1  # intervals half as wide would not do


@pytest.mark.parametrize("rho", [0.0, 0.3])
@pytest.mark.parametrize("method", ["random", "latin_hypercube", "sobol"])
def test_probability_of_a_linear_gaussian_onset(method, rho):
    """By the growth rate itself: eigenvalues on one side, Gauss's integral on the other."""
    scatter = Scatter({"friction.static": Normal(0.5, 0.05), "k12": Normal(0.6, 0.04)}, np.array([[1, rho], [rho, 1]]))
    exact = norm.cdf(-0.1 / np.sqrt(0.05**2 + 0.04**2 - 2.0 * rho * 0.05 * 0.04))
    growth = quantities.growth_rate()
    found = squeal_probability(ModeCoupling(), scatter, growth, samples=1 << 14, method=method, seed=4)
    assert found.interval == ("clopper-pearson" if method == "random" else "replicates")
    assert float(found.low) < exact < float(found.high)
    assert float(found.probability) == pytest.approx(exact, abs=4.0 * np.sqrt(exact / (1 << 14)))
    other = norm.cdf(-0.1 / np.sqrt(0.05**2 + 0.04**2 + 2.0 * 0.3 * 0.05 * 0.04))  # the sign of rho mistaken
    assert not float(found.low) < other < float(found.high)


@pytest.mark.parametrize("method", ["random", "sobol"])
def test_intervals_hold_the_truth_as_often_as_they_say(method):
    """Of 300 intervals at 90 %, a binomial count of misses: 30 +- 5.2; exact intervals may miss less, not more."""
    scatter = Scatter({"a": Normal(0.0, 1.0), "b": Normal(0.0, 1.0)})
    ask = Quantity(lambda at: at["a"] + at["b"], "sum", limit=1.0)
    exact = norm.sf(1.0 / np.sqrt(2.0))
    runs = [squeal_probability(None, scatter, ask, samples=512, method=method, seed=i, level=0.9) for i in range(300)]
    missed = sum(not float(run.low) <= exact <= float(run.high) for run in runs)
    assert missed <= 30 + 3 * 5.2
    width = np.mean([float(run.high - run.low) for run in runs])
    narrow = sum(abs(float(run.probability) - exact) > 0.25 * width for run in runs)
    assert narrow > 30 + 3 * 5.2  # intervals half as wide would miss too often


def test_no_squeal_among_n_points_bounds_the_probability():
    """Clopper and Pearson with no hit: high = 1 - (alpha/2)^(1/n), whatever the points."""
    found = squeal_probability(None, Scatter({"x": Uniform(0.0, 1.0)}), Quantity(lambda at: at["x"], "x", limit=2.0))
    assert float(found.low) == 0.0
    assert found.interval == "clopper-pearson"
    assert float(found.high) == pytest.approx(1.0 - 0.025 ** (1.0 / 4096.0), rel=1e-9)


def test_unknown_points_widen_the_interval_on_both_sides():
    ask = Quantity(lambda at: np.where(at["x"] > 0.9, np.nan, at["x"]), "x", limit=0.5)
    found = squeal_probability(None, Scatter({"x": Uniform(0.0, 1.0)}), ask)
    assert found.unknown == pytest.approx(410, abs=3)
    assert float(found.low) <= 0.4 < 0.5 <= float(found.high)
    assert "no answer" in found.summary()
    low, high = binomial_interval(10, 5, 100, 0.95)
    assert low == binomial_interval(10, 0, 100, 0.95)[0]
    assert high == binomial_interval(15, 0, 100, 0.95)[1]


def test_points_the_design_refuses_are_unknown_and_not_an_error():
    scatter = Scatter({"m": Normal(1.0, 0.5)})  # 2.3 % of the masses are negative
    found = squeal_probability(ModeCoupling(), scatter, quantities.growth_rate(), samples=1024)
    assert found.unknown == np.count_nonzero(found.points[:, 0] <= 0.0) > 0
    with pytest.raises(ParameterError, match=r"ModeCoupling\.m"):
        squeal_probability(ModeCoupling(), Scatter({"m": Normal(-9.0, 0.5)}), quantities.growth_rate())


def test_effects_of_a_linear_and_of_a_curved_quantity():
    """Linear: mu* = |slope| range, sigma = 0. For x1 x2 the effect of x1 is x2 times the step: sigma is not 0."""
    square = Scatter({"a": Uniform(0.0, 1.0), "b": Uniform(0.0, 2.0), "c": Uniform(0.0, 1.0)})
    found = morris_effects(None, square, lambda at: 3.0 * at["a"] - at["b"], seed=0)
    assert np.allclose(found.direction, [3.0 * 0.99, -2.0 * 0.99, 0.0], atol=1e-12)
    assert np.allclose(found.strength, np.abs(found.direction), atol=1e-12)
    assert np.allclose(found.spread, 0.0, atol=1e-12)
    curved = morris_effects(None, square, lambda at: at["a"] * at["b"], seed=0)
    assert np.all(curved.spread[:2] > 0.3 * curved.strength[:2])
    assert np.array_equal(curved.strength, morris_effects(None, square, lambda at: at["a"] * at["b"]).strength)
    other = morris_effects(None, square, lambda at: at["a"] * at["b"], seed=1)
    assert not np.array_equal(curved.strength, other.strength)


def test_range_over_a_box():
    """The onset [k12 + (k11 - k22)^2/(4 k12)]/k3 is least inside the box, at k11 = k22, and largest in a corner."""
    design = ModeCoupling(k12=0.4)
    ask = Quantity(lambda at: onset({"k11": at.k11, "k22": at.k22, "k3": at.k3}), "onset", limit=0.4, squeals="below")
    found = interval_bounds(design, {"k11": (1.5, 2.8), "k3": (0.8, 1.25)}, ask, runs=2)
    assert "2 searches agree to" in found.summary()
    by_eigenvalues = quantities.critical_value("friction.static", (0.0, 10.0), limit=0.4)
    ends = design.replace(dict(zip(("k11", "k3"), np.transpose([found.low_at, found.high_at]), strict=True)))
    assert by_eigenvalues(ends) == pytest.approx([float(found.low), float(found.high)], rel=1e-9)
    assert float(found.low) == pytest.approx(0.4 / 1.25, rel=1e-6)
    assert float(found.high) == pytest.approx((0.4 + 0.8**2 / 1.6) / 0.8, rel=1e-9)
    assert found.low_at == pytest.approx([2.0, 1.25], abs=1e-2)
    assert found.high_at.tolist() == [2.8, 0.8]
    assert found.agreement < 1e-6
    assert not found.always_quiet
    corners_only = (0.4 + 0.5**2 / 1.6) / 1.25
    assert float(found.low) < corners_only - 0.05


def test_first_crossings_are_those_found_one_by_one():
    rng = np.random.default_rng(0)
    design = DampingParadox(eta1=rng.uniform(0.001, 0.05, 12), eta2=rng.uniform(0.001, 0.05, 12))
    found = first_crossings(design, "friction.static", (0.0, 1.0))
    for i, value in enumerate(found):
        one = DampingParadox(eta1=design.eta1[i], eta2=design.eta2[i])
        assert value == pytest.approx(float(critical_value(one, "friction.static", (0.0, 1.0)).value), rel=1e-11)
    k12 = np.array([0.3, 0.9, 1.5])
    assert first_crossings(ModeCoupling(k12=k12), "friction.static", (0.5, 1.2)).tolist() == pytest.approx(
        [-np.inf, 0.9, np.inf]
    )


def test_a_hundred_thousand_points_are_one_batched_call():
    calls = []

    def count(design):
        calls.append(np.shape(design.k12))
        return design.k12

    points = {"k12": np.linspace(0.1, 1.0, 100_000)}
    assert np.array_equal(evaluate(ModeCoupling(), Quantity(count, "k12"), points), points["k12"])
    assert calls == [(100_000,)]
    one_by_one = Quantity(lambda design: design.k12, "k12", batched=False)
    assert np.array_equal(evaluate(ModeCoupling(), one_by_one, {"k12": points["k12"][:50]}), points["k12"][:50])
    with pytest.raises(ValueError, match=r"expected \(50,\)"):
        evaluate(ModeCoupling(), Quantity(lambda design: 1.0, "one"), {"k12": points["k12"][:50]})


def test_quantities_are_what_the_analyses_say():
    """Each beside the analysis it stands for, asked of a batch and of one brake."""
    design = DampingParadox(eta1=np.array([0.005, 0.02, 0.04]), friction=Coulomb(0.3))
    modes = complex_modes(design)
    assert quantities.growth_rate()(design) == pytest.approx(modes.largest_growth_rate, rel=1e-9)
    assert quantities.damping_ratio()(design) == pytest.approx(np.min(modes.damping_ratio, axis=-1), rel=1e-9)
    assert quantities.damping_ratio().excess(-0.01) > 0.0  # a negative damping ratio squeals
    brake = DrumBrake(load1=np.array([500.0, 1000.0]))
    many = simulate_ensemble(brake, None, 2e-3)
    assert np.array_equal(quantities.amplitude(2e-3, limit=1e-6)(brake), np.max(many["amplitude"], axis=-1))
    assert quantities.parameter_value("load1", unit="N")(brake).tolist() == [500.0, 1000.0]
    assert quantities.weighted_sum({"m": 2.0})(brake).shape == (2,)


def test_correlated_parameters_have_no_shares():
    tied = Scatter({"a": Normal(0.0, 1.0), "b": Normal(0.0, 1.0)}, {("a", "b"): 0.5})
    for study in (sobol_indices, morris_effects):
        with pytest.raises(ParameterError, match="independent"):
            study(None, tied, lambda at: at["a"])


def test_failures_are_outcomes_with_evidence():
    scatter = Scatter({"k12": Uniform(0.5, 1.5)})
    narrow = quantities.critical_value("friction.static", (0.0, 1.0), limit=0.4)  # stable there for k12 > 1
    for found in (
        sobol_indices(ModeCoupling(), scatter, narrow, samples=64),
        morris_effects(ModeCoupling(), scatter, narrow),
    ):
        assert found.outcome == "unknown_values"
        assert found.outcome.evidence["infinite"] > 0
        assert "infinite" in found.summary()
    flat = sobol_indices(None, scatter, lambda at: 0.0 * at["k12"])
    assert flat.outcome == "no_variance"
    nothing = squeal_probability(None, scatter, lambda at: np.nan * at["k12"])
    assert nothing.outcome == "no_answer"
    assert np.isnan(nothing.probability)
    assert (float(nothing.low), float(nothing.high)) == (0.0, 1.0)


def test_results_are_saved_read_back_and_drawn(tmp_path):
    scatter = Scatter({"friction.static": Normal(0.5, 0.05), "k12": Normal(0.6, 0.04)})
    ask = quantities.margin("friction.static", (0.0, 5.0), points=13)
    runs = (squeal_probability, {}), (sobol_indices, {"samples": 256}), (morris_effects, {"trajectories": 10})
    for i, (study, settings) in enumerate(runs):
        found = study(ModeCoupling(), scatter, ask, **settings)
        again = Result.load(found.save(tmp_path / f"{i}.nc"))
        assert again.summary() == found.summary()
        assert again.inputs["scatter"] == scatter
        assert len(plot(again).get_axes()) >= 1
    box = interval_bounds(ModeCoupling(), {"k12": (0.5, 0.7)}, quantities.growth_rate(), runs=1)
    assert "one search, which no other confirms" in box.summary()
    assert Result.load(box.save(tmp_path / "box.nc")).summary() == box.summary()


def test_student_interval_against_the_textbook():
    mean, low, high = student_interval([1.0, 2.0, 3.0, 4.0, 5.0], 0.95)
    assert mean == 3.0
    assert high - mean == pytest.approx(2.776445105 * np.sqrt(2.5 / 5.0), rel=1e-9)  # t of 4 degrees of freedom
    assert mean - low == pytest.approx(high - mean)
