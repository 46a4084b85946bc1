"""A degree of freedom may be a rotation: figures, tables and words give each its own unit and never compare the two."""

import numpy as np
import pytest

from squealbox import Contact, Coulomb, System, WobblingDisc, plots, simulate, simulate_ensemble, verdict
from squealbox.matrices import liveliest
from squealbox.plots.key_numbers import facts
from squealbox.signals import SignalError


def turning(**more):
    """A block that slides, and a small wheel beside it that turns a hundred times as far in rad."""
    contacts = (
        Contact([0.0, 0.0], [1.0, 0.0], [1.0, 0.0], 1.0, 0.2, Coulomb(0.4, 0.25)),
        Contact([0.0, 0.0], [0.0, 1.0], [0.0, 1.0], 50.0, 20.0, Coulomb(0.4, 0.25)),
    )
    return System(np.eye(2), 0.01 * np.eye(2), np.diag([1.0, 2.0]), 0.0, contacts, **more)


@pytest.mark.parametrize("about", [{"names": ("x", "wheel_turn")}, {"names": ("x", "a"), "angles": ("a",)}])
def test_figures_and_words_have_the_unit_of_the_freedom(about):
    system = turning(**about)
    assert system.units == ("m", "rad")
    motion = simulate(system, 20.0, times=400)
    first, second = (plots.time_history(motion, dof=i).axes[0].get_ylabel() for i in (0, 1))
    assert first == "displacement [m]" or "mm" in first
    assert "°" in second or "rad" in second
    assert "rad/s" in plots.phase_plane(motion, dof=1).axes[0].get_ylabel()
    with pytest.raises(SignalError, match="do not share an axis"):
        plots.time_history(motion, dof=[0, 1])
    units = [unit for name, _, unit in facts(motion) if name.startswith("half peak")]
    assert units[0] in ("m", "mm")
    assert units[1] in ("°", "mrad")


def test_what_moves_most_is_not_sought_among_radians():
    assert liveliest([1e-3, 5.0], ("m", "rad")) == 0
    assert liveliest([0.0, 5.0], ("m", "rad")) == 1
    assert liveliest([1e-3, 5.0], ("m", "m")) == 1
    system = turning(names=("x", "wheel_turn"))
    many = simulate_ensemble(system, None, 10.0, start=(np.zeros((3, 2)), np.zeros((3, 2))), observe=("amplitude",))
    figure = plots.plot(many)
    assert figure.axes[0].get_ylabel().startswith("amplitude x [")


def test_a_verdict_is_that_of_the_freedom_in_metres():
    mass, stiffness = np.diag([1.0, 1e-4]), np.diag([100.0, 1e-2])
    motion = simulate(System(mass, 0.0 * mass, stiffness, 0.0, (), names=("x", "a"), angles=("a",)), 20.0,
                      ([1e-3, 0.1], [0.0, 0.0]))  # fmt: skip
    assert "half peak to peak of x 1 mm" in verdict(motion).text
    assert "half peak to peak of a 5.73 °" in verdict(motion, dof="a").text
    assert verdict(motion, dof=1).text == verdict(motion, dof="a").text


def test_a_disc_that_wobbles_turns():
    assert WobblingDisc().system().units == ("rad", "rad")
