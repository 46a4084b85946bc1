"""A verdict belongs to the motion: few kept instants change nothing, and a block that friction stopped is at rest.

The block: m q'' + k q = -+ mu N loses 2 mu N/k of its swing each half period pi sqrt(m/k) until the spring holds it.
"""

import numpy as np
import pytest

from squealbox import Contact, Coulomb, DrumBrake, LinearSlope, MassOnBelt, System, simulate, verdict
from squealbox.transient import carries, resolved


@pytest.mark.parametrize("points", [301, 777])
def test_kept_instants_do_not_change_the_verdict(points: int) -> None:
    brake = DrumBrake(friction=LinearSlope(0.45, -0.05))
    few, many = simulate(brake, 0.4, times=points), simulate(brake, 0.4)
    assert not carries(few)
    assert carries(many)
    for dof in (0, "y"):
        one, other = verdict(few, dof=dof), verdict(many, dof=dof)
        assert one.kind == other.kind == "settles_on_cycle"
        assert float(one.frequency) == pytest.approx(float(other.frequency), rel=1e-12)
        assert float(one.amplitude) == pytest.approx(float(other.amplitude), rel=1e-12)
    assert float(verdict(few, dof="x").frequency) == pytest.approx(2034.6, abs=0.1)


def test_a_record_that_carries_the_motion_is_left_as_it_is() -> None:
    motion = simulate(MassOnBelt(), 20.0, times=2001)
    assert resolved(motion) is motion


def test_the_freedom_that_moves_most_is_judged_and_named() -> None:
    motion = simulate(DrumBrake(friction=LinearSlope(0.45, -0.05)), 0.05)
    judged = verdict(motion)
    assert "of y " in judged.text
    assert float(judged.amplitude) == float(verdict(motion, dof="y").amplitude)


@pytest.mark.parametrize("swings", [3, 8])
def test_a_block_stopped_by_friction_is_at_rest_and_has_no_frequency(swings: int) -> None:
    k, mu = 100.0, 0.3
    contact = Contact([0.0], [1.0], [1.0], 1.0, 0.0, Coulomb(mu))
    block = System([[1.0]], [[0.0]], [[k]], 0.0, (contact,))
    start = (2.0 * swings - 0.5) * mu / k
    judged = verdict(simulate(block, 12.0, start=([start], [0.0]), times=3001))
    assert judged.kind == "decays"
    assert float(judged.settled_at) == pytest.approx(swings * np.pi / np.sqrt(k), rel=1e-9)
    assert np.isnan(judged.frequency)
    assert "comes to rest" in judged.text
