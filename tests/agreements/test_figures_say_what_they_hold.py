"""Figures of ensembles, branches, probabilities: the freedom that is asked for, the width, every axis readable."""

import numpy as np
import pytest

from squealbox import DrumBrake, LinearSlope, Scatter, quantities, simulate_ensemble, squeal_probability
from squealbox.limit_cycles import branch, hopf_point
from squealbox.plots import amplitude_map, plot
from squealbox.studies import Normal

FRICTION = "friction.static"


def drum(static):
    return DrumBrake(friction=LinearSlope(static, -0.05))


@pytest.fixture(scope="module")
def many():
    values = {FRICTION: np.linspace(0.3, 0.5, 5)}
    return simulate_ensemble(drum(0.45), values, duration=0.03, observe=("amplitude", "poincare", "frequency"))


@pytest.mark.parametrize(("name", "unit"), [("amplitude", 1e-6), ("poincare", 1e-6), ("frequency", 1e3)])
def test_an_ensemble_is_drawn_for_the_freedom_asked_for(many, name, unit):
    for place, dof in enumerate(("x", "y")):
        panel = plot(many, observer=name, dof=dof).axes[0]
        expected = many[name][:, place].reshape(5, -1).max(axis=1) / unit
        np.testing.assert_allclose(panel.lines[0].get_ydata(), expected)
        assert f" {dof} [" in panel.get_ylabel()
    with pytest.raises(ValueError, match="expected one of x, y"):
        plot(many, dof="z")


def test_a_branch_keeps_the_width_that_was_asked_for():
    brake = drum(0.3)
    born = hopf_point(brake, FRICTION, (0.1, 0.6))
    walk = branch(brake, FRICTION, (0.1, 0.6), born, method="shooting", points=150)
    figure = plot(walk, hopf=born, runs=([0.3, 0.4], [1e-5, 2e-5]), width=3.4)
    assert len(figure.legends) == 1, "a long legend stands outside the panel"
    assert figure.get_size_inches()[0] == 3.4


def test_panels_below_each_other_have_ticks_and_labels():
    scatter = Scatter({FRICTION: Normal(0.3, 0.03), "k3": Normal(1.9e8, 1e6)})
    found = squeal_probability(drum(0.3), scatter, quantities.growth_rate(), samples=256, seed=1)
    for width, labelled in ((3.4, 2), (None, 1)):
        panels = plot(found, width=width).axes[1:]
        assert sum("share of squeal" in panel.get_ylabel() for panel in panels) == labelled
        assert sum(panel.yaxis.get_tick_params()["labelleft"] for panel in panels) == labelled


def test_sizes_of_squeal_differ_in_colour_beside_what_has_decayed():
    """10 and 40 um stand half the colours apart; a thousandth of the larger is still no zero."""
    panel = amplitude_map([0.0, 1.0], [0.0, 1.0], [[1e-5, 4e-5], [4e-8, 0.0]]).axes[0]
    mesh = panel.collections[0]
    shades = mesh.norm(mesh.get_array()).ravel()
    assert shades[1] - shades[0] == pytest.approx(0.5, abs=0.02)
    assert shades[2] == pytest.approx(np.sqrt(1e-3), rel=0.05)
    assert shades[3] == 0.0
