"""Where a model leaves its range the result says so: cycle, branch, diagram, ensemble, and the figures of all four."""

import numpy as np
import pytest

from squealbox import (
    Contact,
    Coulomb,
    LinearSlope,
    MassOnBelt,
    System,
    friction,
    plots,
    simulate,
    simulate_ensemble,
)
from squealbox.cautions import along
from squealbox.limit_cycles import bifurcation_diagram, branch, shooting

NEGATIVE = "friction is negative"


def family(c):
    """A block whose friction is falling without a floor; the less damping, the farther it swings and the lower mu."""
    law = LinearSlope(0.4, -0.4)
    belt = Contact([0.0], [1.0], [1.0], 1.0, 0.8, law, "belt")
    return System([[1.0]], [[c]], [[1.0]], 0.0, (belt,), names=("x",))


def words(figure):
    shown = [figure.get_supxlabel() or "", figure.get_suptitle() or ""]
    return " ".join(shown).replace("\n", " ")


def test_a_cycle_and_a_branch_over_negative_friction():
    cycle = shooting(family(0.2))
    assert cycle.outcome == "completed"
    assert NEGATIVE in cycle.caution
    found = branch(family, "c", (0.15, 0.25), cycle, value=0.2, points=4)
    assert NEGATIVE in found.caution
    assert "at c = " in found.caution
    assert NEGATIVE in found.summary()
    assert "Caution: at c" in words(plots.plot(found, estimates=False))


def test_a_diagram_says_it_too():
    values = np.array([0.15, 0.2])
    found = bifurcation_diagram(family, "c", values, sweeps=("rest",))
    assert NEGATIVE in found.caution
    assert "Caution: at c" in words(plots.plot(found))


def test_none_where_the_model_keeps_its_range():
    """The same figures of a block under Coulomb's friction say nothing."""
    block = MassOnBelt(m=1.0, c=0.0, k=1.0, load=1.0, sliding_speed=0.1, friction=Coulomb(0.4, 0.25))
    cycle = shooting(block)
    assert cycle.caution == ""
    assert "Caution" not in words(plots.plot(cycle))
    found = branch(block, "sliding_speed", (0.09, 0.11), cycle, value=0.1, points=3)
    assert found.caution == ""


def test_a_rotation_beyond_small_angles():
    wheel = System([[1.0]], [[0.0]], [[1.0]], 0.0, (), names=("a",), angles=("a",))
    said = along(wheel, [[0.5], [-0.6]], [[0.0], [0.0]])
    assert said == ("a turns by 34.4 deg: the equation is linear in rotations and holds for small ones",)
    assert along(wheel, [[0.1]], [[0.0]]) == ()


def test_a_bilateral_contact_that_pulls_along_a_cycle_by_harmonic_balance():
    contact = Contact([2.0, 0.0], [0.0, 1.0], [0.0, 1.0], 1.0, 1.0, Coulomb(0.4))
    system = System(np.eye(2), np.zeros((2, 2)), np.eye(2), 0.0, (contact,))
    said = along(system, [[-1.0, 0.0], [1.0, 0.0]], np.zeros((2, 2)))
    assert len(said) == 1
    assert "contact 1: N falls to -1 N" in said[0]


@pytest.mark.parametrize("method", ["taylor", "dormand-prince"])
def test_an_ensemble_says_it_with_how_many(method):
    """Least mu from |v| at most 0.8 + the swing of a single run; none of the run that is damped."""
    found = simulate_ensemble([family(0.1), family(0.2), family(2.0)], duration=20.0, method=method)
    assert found.caution.startswith("belt in 2 of 3 trajectories: friction is negative at ")
    assert NEGATIVE in simulate(family(0.1), 20.0).caution
    assert simulate_ensemble([family(2.0)], duration=20.0, method=method).caution == ""


def test_an_ensemble_beyond_the_data_of_its_law():
    law = friction.Table([0.0, 0.1, 0.2], [0.4, 0.3, 0.2])
    found = simulate_ensemble(MassOnBelt(friction=law), {"sliding_speed": [0.1, 0.3]}, duration=2.0)
    assert found.caution.startswith("belt in 1 of 2 trajectories: it slides at")
    assert found.caution.endswith("beyond the law's data, which end at 0.2 m/s")
