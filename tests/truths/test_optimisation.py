"""Optima against closed forms.

The damping paradox (R2): with a_i = eta_i w_i, a1 = p s and a2 = (1 - p) s, D = w1^2 - w2^2, its Hopf point

    (mu w1 w2)^2 = a1 a2 w_H^2 + (w1^2 - w_H^2)(w_H^2 - w2^2),   w_H^2 = p w2^2 + (1 - p) w1^2 = w1^2 - p D

is p (1 - p)(A - B p) with A = s^2 w1^2 + D^2 and B = s^2 D. Its derivative 3 B p^2 - 2 (A + B) p + A vanishes at the
best split p = [A + B - sqrt((A + B)^2 - 3 A B)]/(3 B).

ZDT1 (Zitzler, Deb and Thiele 2000): f1 = x1, f2 = g (1 - sqrt(f1/g)), g = 1 + 9 mean(x2...), front f2 = 1 - sqrt(f1).
"""

import numpy as np
import pytest
from scipy.stats import norm

from squealbox import quantities
from squealbox.designs import DampingParadox
from squealbox.parameters import ParameterError
from squealbox.plots import plot
from squealbox.result import Result
from squealbox.studies import Constraint, Goal, Normal, Quantity, Scatter, Uniform, optimise

W1, W2 = 200.0 * np.pi, 150.0 * np.pi
ETAS = {"eta1": (0.001, 0.06), "eta2": (0.001, 0.06)}
MARGIN = quantities.margin("friction.static", (0.0, 1.0))
DAMPING = quantities.weighted_sum({"eta1": W1, "eta2": W2}, name="damping", unit="1/s")


def best_split(s):
    """p and mu of the best split of the damping s [1/s]."""
    d = W1**2 - W2**2
    a, b = s**2 * W1**2 + d**2, s**2 * d
    p = (a + b - np.sqrt((a + b) ** 2 - 3.0 * a * b)) / (3.0 * b)
    return p, np.sqrt(p * (1.0 - p) * (a - b * p)) / (W1 * W2)


@pytest.mark.parametrize("method", ["global", "local"])
def test_best_split_of_damping(method):
    s = 400.0
    wide = dict.fromkeys(ETAS, (0.001, 0.8))
    p, mu = best_split(s)
    found = optimise(
        DampingParadox(), wide, Goal(MARGIN, "maximise"), [Constraint(DAMPING, high=s)], method=method, generations=40
    )
    assert found.outcome.ok
    assert float(found.goals[0, 0]) == pytest.approx(mu - 0.2, rel=1e-8)
    # the goal is flat at its top: an error of 1e-8 in it is one of 1e-4 in the place
    assert found.changes["eta1"] * W1 / s == pytest.approx(p, abs=1e-3)
    assert abs(p - 0.5) > 0.03  # equal damping is not the best
    assert found.binding() == ["damping at its upper limit 400"]
    assert float(found.goals_before[0]) == pytest.approx(float(MARGIN(DampingParadox())), rel=1e-12)
    assert float(MARGIN(found.design)) == pytest.approx(float(found.goals[0, 0]), rel=1e-12)


def test_a_bound_that_holds_the_optimum_back_is_named():
    found = optimise(DampingParadox(), {"eta1": (0.001, 0.01)}, Goal(MARGIN, "maximise"), generations=8)
    assert found.binding() == ["eta1 at its upper bound 0.01"]
    free = optimise(DampingParadox(), {"eta1": (0.001, 0.06)}, Goal(MARGIN, "maximise"), generations=8)
    assert free.binding() == []
    assert "inside" in free.summary()


def zdt1():
    def g(at):
        return 1.0 + 9.0 * sum(at[f"x{i}"] for i in range(1, 6)) / 5.0

    goals = [Goal(lambda at: at["x0"]), Goal(lambda at: g(at) * (1.0 - np.sqrt(at["x0"] / g(at))))]
    return {f"x{i}": (0.0, 1.0) for i in range(6)}, goals


def test_front_of_zdt1():
    box, goals = zdt1()
    found = optimise(None, box, goals, population=60, generations=200)
    f1, f2 = found.goals.T
    assert np.max(np.abs(f2 - (1.0 - np.sqrt(f1)))) < 0.02
    assert np.min(f1) < 0.02
    assert np.max(f1) > 0.98
    assert np.max(np.diff(np.sort(f1))) < 0.1  # spread over the whole front
    early = optimise(None, box, goals, population=60, generations=10)
    assert np.max(np.abs(early.goals[:, 1] - (1.0 - np.sqrt(early.goals[:, 0])))) > 0.02


def test_a_front_keeps_its_constraints_and_its_order():
    goals = [Goal(DAMPING), Goal(MARGIN, "maximise")]
    found = optimise(DampingParadox(), ETAS, goals, [Constraint(MARGIN, low=0.09)], population=24, generations=25)
    cost, margin = found.goals.T
    assert np.all(margin >= 0.09 - 1e-6)
    assert np.all(np.diff(cost) > 0.0)
    assert np.all(np.diff(margin) > 0.0)  # more damping buys more margin, or the design would not be on the front
    for s, reached in zip(cost, margin, strict=True):
        assert reached <= best_split(s)[1] - 0.2 + 1e-9  # nothing betters the closed form
    assert 0 <= found.best < len(cost)
    assert len(plot(found).get_axes()) == 2


def test_robust_goals_over_scatter():
    """x + N(0, 1): the 95 % quantile of (x + z) is x + 1.645, P(x + z > 3) = Phi(x - 3), the mean x."""
    scatter = Scatter({"x": Normal(7.0, 1.0)})  # its mean moves with x
    level = Quantity(lambda at: at["x"], "x", limit=3.0)
    wanted = {"quantile": 1.0 - norm.ppf(0.95), "probability": 3.0 + norm.ppf(0.1), "mean": 1.0}
    for over, place in wanted.items():
        limit = {"quantile": 1.0, "probability": 0.1, "mean": 1.0}[over]
        keep = Constraint(level, high=limit, over=over)
        found = optimise(
            None, {"x": (-5.0, 5.0)}, Goal(level, "maximise"), [keep], scatter=scatter, samples=2048, generations=60
        )
        assert found.changes["x"] == pytest.approx(place, abs=5e-3), over
    plain = optimise(None, {"x": (-5.0, 5.0)}, Goal(level, "maximise"), [Constraint(level, high=1.0)])
    assert plain.changes["x"] == pytest.approx(1.0, abs=1e-6)


def test_the_robust_optimum_is_another_than_the_nominal_one():
    """f = max(x, -9 x): the nominal best is 0; with scatter +-1 the worst is least where x + 1 = 9 (1 - x), x = 0.8."""
    steep = Quantity(lambda at: np.maximum(at["x"], -9.0 * at["x"]), "f")
    scatter = Scatter({"x": Uniform(-1.0, 1.0)})
    robust = optimise(
        None,
        {"x": (-3.0, 3.0)},
        Goal(steep, over="quantile", share=0.9999),
        scatter=scatter,
        samples=512,
        generations=60,
    )
    assert robust.changes["x"] == pytest.approx(0.8, abs=0.01)
    nominal = optimise(None, {"x": (-3.0, 3.0)}, Goal(steep), scatter=scatter)
    assert nominal.changes["x"] == pytest.approx(0.0, abs=1e-4)


def test_no_feasible_design_is_an_outcome():
    quiet = Goal(quantities.growth_rate())
    found = optimise(DampingParadox(), ETAS, quiet, [Constraint(DAMPING, high=0.5)], generations=3)
    assert found.outcome == "infeasible"
    assert found.outcome.evidence["missed_by"] > 0.0
    front = optimise(DampingParadox(), ETAS, [Goal(DAMPING), quiet], [Constraint(DAMPING, high=0.5)], generations=2)
    assert front.outcome == "infeasible"


def test_seeds_reproduce_and_results_are_read_back(tmp_path):
    runs = [optimise(DampingParadox(), ETAS, Goal(MARGIN, "maximise"), generations=5, seed=3) for _ in range(2)]
    assert np.array_equal(runs[0].values, runs[1].values)
    again = Result.load(runs[0].save(tmp_path / "optimum.nc"))
    assert again.summary() == runs[0].summary()
    assert again.design == runs[0].design


NONSENSE = [
    (lambda: optimise(None, {}, Goal(lambda at: 1.0)), "at least one"),
    (lambda: optimise(None, {"x": (1.0, 0.0)}, Goal(lambda at: 1.0)), "low < high"),
    (lambda: optimise(None, {"x": (0.0, 1.0)}, []), "at least one Goal"),
    (lambda: optimise(None, {"x": (0.0, 1.0)}, Goal(lambda at: 1.0, over="mean")), "a Scatter"),
    (lambda: optimise(None, {"x": (0.0, 1.0)}, Goal(lambda at: 1.0), method="guess"), "global"),
    (lambda: Goal(3.0), "a function of a design"),
    (lambda: Goal(lambda at: 1.0, "smallest"), "minimise"),
    (lambda: Constraint(lambda at: 1.0), "at least one of them finite"),
    (lambda: optimise(DampingParadox(), {"eta3": (0.0, 1.0)}, Goal(MARGIN)), "did you mean 'eta2'|eta1"),
]


@pytest.mark.parametrize(("make", "text"), NONSENSE, ids=[text for _, text in NONSENSE])
def test_nonsense_is_one_clear_sentence(make, text):
    with pytest.raises(ParameterError, match=text):
        make()
