"""What no reading can meet: each bound recomputed, each lemma against random systems, each with what escapes it."""

import numpy as np
import pytest

from squealbox.papers.drum_brake_2011 import steady, theorem_figures, theorems
from squealbox.papers.drum_brake_2011.cases import RECONSTRUCTED, RESOLUTION, Case


def frequencies(damping, stiffness):
    """The two angular frequencies and decay rates of x'' + C x' + K x = 0, the lower frequency first."""
    zero, one = np.zeros((2, 2)), np.eye(2)
    values = np.linalg.eigvals(np.block([[zero, one], [-stiffness, -damping]]))
    values = values[values.imag > 0.0]
    return values[np.argsort(values.imag)]


def test_the_bounds_of_the_trace_argument() -> None:
    """The digits of the search that found them, in 1e8 rad^2/s^2."""
    found = {name: (1e-8 * band.low, 1e-8 * band.high) for name, band in theorems.trace_bounds().items()}
    assert found["mu-3 and N-2"] == pytest.approx((3.15, 3.54), abs=0.005)
    assert found["table and mu-3"] == pytest.approx((3.13, 3.78), abs=0.005)
    assert found["table and mu-5"] == pytest.approx((3.39, 3.56), abs=0.005)
    assert found["mu-6"] == pytest.approx((2.91, 3.03), abs=0.005)


@pytest.mark.parametrize("other", ["mu-3 and N-2", "table and mu-3", "table and mu-5"])
def test_mu_6_is_apart_from_each(other: str) -> None:
    bounds = theorems.trace_bounds()
    assert bounds["mu-6"].apart_from(bounds[other])


def test_the_sum_of_squares_is_linear_in_mu_for_any_friction_matrix() -> None:
    draw = np.random.default_rng(1)
    stiffness = np.array([[1.72e8, 4.7e7], [4.7e7, 1.65e8]])
    for _ in range(20):
        friction = draw.normal(0.0, 5e7, (2, 2))
        sums = [np.trace(stiffness - mu * friction) for mu in (0.1, 0.3, 0.5)]
        known = {mu: theorems.Band(value, value) for mu, value in zip((0.1, 0.3), sums, strict=False)}
        assert theorems.trace_line(known, 0.5).low == pytest.approx(sums[2], rel=1e-12)


def test_a_law_quadratic_in_mu_escapes() -> None:
    """Negative twin: with mu squared one stiffness has the frequencies of mu-3, N-2 and mu-6 together."""
    wanted = {mu: np.array(theorems.FREQUENCIES[mu]) ** 2 for mu in (0.10, 0.30, 0.50)}
    mus = np.array(list(wanted))
    fit = [np.polyfit(mus, [wanted[mu][i] for mu in wanted], 2) for i in (0, 1)]
    for mu in wanted:
        stiffness = np.diag([np.polyval(each, mu) for each in fit])
        found = frequencies(np.diag([218.0, 212.0]), stiffness).imag
        assert found == pytest.approx(theorems.FREQUENCIES[mu], abs=1.0)  # damping takes 0.5 rad/s


def test_which_mode_decays_more_is_told_by_the_difference_of_damping() -> None:
    """The lemma, over random damping and coupling with modes apart, and its twin with the diagonal exchanged."""
    draw = np.random.default_rng(2)
    a, d = theorems.stiffness_diagonal()
    assert a > d
    for _ in range(200):
        b, c = draw.uniform(-5e7, 5e7, 2)
        if 0.25 * (a - d) ** 2 + b * c < 1e12:
            continue  # nearly merged or flutter
        damping = np.diag(draw.uniform(-100.0, 500.0, 2))
        difference = damping[1, 1] - damping[0, 0]
        if abs(difference) < 5.0:
            continue
        for first, second in ((a, d), (d, a)):
            lower, upper = -frequencies(damping, np.array([[first, b], [c, second]])).real
            assert np.sign(upper - lower) == theorems.which_mode_decays_more(difference, first, second)


def test_mu_5_and_n_2_exclude_each_other() -> None:
    assert theorems.growing_mode_at_onset() == "upper"
    positive = np.linspace(0.0, 1000.0, 101)
    assert np.all(theorems.damping_difference(positive, 15e3) >= 84.0)  # N-2 needs a negative one


def test_a_brake_with_its_dampers_exchanged_escapes() -> None:
    """Negative twin: with c1 = 212 and c2 = 218 N s/m a difference of 2 at 1 kN is negative at 15 kN."""
    assert theorems.damping_difference(2.0, 15e3, c1=212.0, c2=218.0) < 0.0


def test_decay_at_1_kn_keeps_nine_tenths() -> None:
    """V-1 and N-1: the bound, and that speed shifts the decay by less than 1 1/s in the reading that meets N-1."""
    assert theorems.least_decay(107.0, 0.0, 1e3) == pytest.approx(0.9 * 107.0)
    case = Case("published_matrices", alpha=0.065)
    rate = steady.growth(case.design(speed=np.linspace(0.05, 0.2, 16)))
    assert np.ptp(rate) < 1.0
    assert np.max(rate) < -0.9 * 107.0


def test_close_to_the_onset_decay_does_know_the_speed() -> None:
    """Negative twin: at mu just under the onset the same change of speed decides."""
    case = Case(RECONSTRUCTED)
    near = steady.onset_in_friction(case.replace(speed=0.2)).value - 1e-4
    rate = steady.growth(case.design(mu=near, speed=np.array([0.05, 0.2])))
    assert rate[0] > 0.0 > rate[1]


def test_the_frequencies_lead_to_another_onset() -> None:
    assert theorems.onset_from_frequencies() == pytest.approx(0.440, abs=5e-4)
    assert theorems.least_miss() == pytest.approx(63.7, abs=0.1)
    assert theorems.least_miss() < RESOLUTION  # so the window does not exclude them together


def test_frequencies_that_fit_give_the_onset_back() -> None:
    """Negative twin: values of one parabola that vanishes at 0.40 give 0.40."""
    values = [(0.40 - mu) * 2e16 * (1.0 + mu) for mu in (0.0, 0.10, 0.30)]
    assert theorems.onset_from_frequencies(*values) == pytest.approx(0.40, abs=1e-9)


@pytest.mark.parametrize("name", theorem_figures.ALL)
def test_each_theorem_has_one_figure_with_one_panel(name: str) -> None:
    figure = theorem_figures.ALL[name]()
    (panel,) = figure.axes
    assert panel.get_title()
