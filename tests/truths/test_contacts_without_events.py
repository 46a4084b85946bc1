"""Contacts whose motion can have no event: friction that nothing senses, or that acts on nothing."""

import numpy as np
import pytest

from squealbox import Contact, Coulomb, Sinusoid, System, simulate, simulate_ensemble


def coupled(t, d, speed=0.3):
    """Two masses on springs, and friction under a normal force that one of them changes."""
    contact = Contact(n=[0.0, 2e3], d=d, t=t, N0=10.0, V=speed, law=Coulomb(0.3))
    return System(np.eye(2), np.zeros((2, 2)), [[2e4, 3e3], [3e3, 1e4]], 0.0, (contact,))


@pytest.mark.parametrize("speed", [0.3, Sinusoid(0.5, 0.1, 3.0)])
@pytest.mark.parametrize(("t", "d"), [([0.0, 0.0], [1.0, 0.3]), ([1.0, 0.0], [0.0, 0.0]), ([0.0, 0.0], [0.0, 0.0])])
def test_they_slide_on(t, d, speed):
    """Friction under a speed of its own is a force 0.3 N in K and load, as of mode coupling at constant friction."""
    system, start = coupled(t, d, speed), ([0.01, 0.0], [0.0, 0.0])
    motion = simulate(system, 0.2, start)
    other = simulate(system, 0.2, start, method="dormand-prince-8", rtol=1e-11)
    assert motion.outcome == "completed"
    assert motion.q[-1] == pytest.approx(other.q[-1], rel=1e-8)
    many = simulate_ensemble(system, {"friction.static": [0.3, 0.1]}, 0.2, start=start)
    assert many.q[0] == pytest.approx(motion.q[-1], rel=1e-8)


def test_one_that_only_lifts_off():
    """A contact that pushes back by 2 x - 1 where it is closed: no friction, but lift-off."""
    contact = Contact([-2.0], [0.0], [0.0], 1.0, 0.1, Coulomb(0.0), unilateral=True, normal=[1.0])
    system = System([[1.0]], [[0.0]], [[4.0]], 0.0, (contact,))
    motion = simulate(system, 5.0, ([1.0], [0.0]))
    many = simulate_ensemble(system, {"friction.static": [0.0, 0.0]}, 5.0, start=([1.0], [0.0]))
    assert motion.outcome == many.outcome == "completed"
    assert many.q[1] == pytest.approx(motion.q[-1], rel=1e-8)
    assert len(motion.event_time) > 1


def test_instants_before_the_clock_s_zero():
    brake = coupled([1.0, 0.0], [1.0, 0.3])
    times = np.linspace(-3.0, -2.5, 11)
    assert simulate(brake, 0.5, None, times, start_time=-3.0).t == pytest.approx(times)
