"""Stick and slip: R3 and R4 to the digits given, and stops, releases and braking belts in closed form.

Event times of pieces that are polynomials in time are exact up to round-off; the others carry the run's tolerance of
1e-13, added up over a few hundred steps.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

from small_systems import METHODS, block_on_belt, extremes, two_blocks_on_belt
from squealbox import Constant, Contact, Coulomb, Hyperbolic, Ramp, Sinusoid, System, simulate
from squealbox.schedules import Table

DIGITS = 1e-9  # nine digits after the point are given
TIGHT = {"bogacki-shampine": 1e-10, "dormand-prince": 1e-13, "tsitouras": 1e-13, "dormand-prince-8": 1e-13}


def phases(motion):
    """Last slip, last stick after it and their sum, and the displacement at which sticking began."""
    sticks = motion.event_time[motion.event_mode == 0]
    slips = motion.event_time[motion.event_mode != 0]
    start, released = sticks[-2], slips[(slips > sticks[-2])][0]
    at = motion.q[np.searchsorted(motion.t, start), 0]
    return sticks[-1] - released, released - start, sticks[-1] - start, at


def leine(delta=3.0):
    return block_on_belt(Hyperbolic(1.0, delta), 0.2)


@pytest.mark.parametrize("method", METHODS)
def test_r3(method):
    motion = simulate(leine(), 40.0, method=method, rtol=TIGHT[method])
    slip, stick, period, at = phases(motion)
    tolerance = DIGITS if method != "bogacki-shampine" else 1e-8  # order 3 cannot reach nine digits in reasonable time
    assert slip == pytest.approx(4.295999525, abs=tolerance)
    assert stick == pytest.approx(7.705031769, abs=tolerance)
    assert period == pytest.approx(12.001031295, abs=tolerance)
    assert at == pytest.approx(-0.541006354, abs=tolerance)


def test_r3_largest_displacement():
    motion = simulate(leine(), 40.0, rtol=1e-13, times=40001)
    assert extremes(motion)[1][-2:] == pytest.approx(1.133944676, abs=DIGITS)
    assert np.max(np.abs(motion.sliding_velocity[motion.mode == 0])) < 1e-14  # a sticking block moves with the belt


def test_r3_of_another_decay_is_told_apart():
    assert abs(phases(simulate(leine(3.0 + 1e-6), 40.0, rtol=1e-13))[2] - 12.001031295) > 1e-7


@pytest.mark.parametrize(
    ("eps", "period", "largest", "period_digits"),
    [
        (1e2, 9.70968, 0.910237, 5e-6),
        (1e3, 11.298151, 1.067080, 5e-7),
        (1e4, 11.807994, 1.115871, 5e-7),
        (1e5, 11.951880, 1.129381, 5e-7),
    ],
)
def test_r3_smoothed(eps, period, largest, period_digits):
    start = ([1.1], [0.2])  # nearly at release, so the first whole slip is on the cycle already
    motion = simulate(leine(), 27.0, start, method="dormand-prince", contact="smooth", width=1.0 / eps, rtol=1e-9)
    assert motion.outcome == "completed"
    instants, heights = extremes(motion)
    # the digits given, plus the tolerance of the run carried over a cycle
    assert instants[2] - instants[1] == pytest.approx(period, abs=period_digits + 1e-7)
    assert heights[2] == pytest.approx(largest, abs=5e-7 + 1e-8)
    assert "sticking became creep" in motion.caution
    assert abs(instants[2] - instants[1] - 12.001031295) > 0.01  # a smoothed cycle is not the exact one


@pytest.mark.parametrize("method", METHODS)
def test_r4(method):
    drop, speed = 0.15, 0.1
    motion = simulate(block_on_belt(Coulomb(0.4, 0.25), speed), 30.0, method=method, rtol=TIGHT[method])
    slip, stick, period, _ = phases(motion)
    assert stick == pytest.approx(2.0 * drop / speed, abs=DIGITS)
    assert slip == pytest.approx(2.0 * (np.pi - np.arctan(drop / speed)), abs=DIGITS)
    assert (slip, period) == (pytest.approx(4.317597861, abs=DIGITS), pytest.approx(7.317597861, abs=DIGITS))
    assert motion.energy.relative_residual < 1e-9


def test_r4_amplitude():
    motion = simulate(block_on_belt(Coulomb(0.4, 0.25), 0.1), 30.0, times=60001, rtol=1e-13)
    assert extremes(motion)[1][-1] - 0.25 == pytest.approx(0.180277564, abs=DIGITS)  # about mu_k N/k


def test_r4_with_static_equal_to_kinetic_does_not_stick():
    motion = simulate(block_on_belt(Coulomb(0.25), 0.1), 30.0, ([0.3], [0.0]), rtol=1e-12)
    assert motion.event_time.size == 0
    assert np.ptp(motion.q[:, 0]) == pytest.approx(0.1, rel=1e-3)  # as wide as it began


@pytest.mark.parametrize("method", METHODS)
def test_sliding_block_comes_to_rest(method):
    # m v' = -mu N: stops after v0 m/(mu N) at v0^2 m/(2 mu N) and then holds any load below static N
    motion = simulate(
        block_on_belt(Coulomb(0.4, 0.25), 0.0, mass=2.0, stiffness=0.0), 20.0, ([0.0], [1.5]), method=method
    )
    assert motion.event_time == pytest.approx([12.0], rel=1e-12)  # issue 3: events to 1e-12 relative
    assert motion.event_mode.tolist() == [0]
    assert motion.q[-1, 0] == pytest.approx(9.0, rel=1e-12)
    assert motion.qd[-1, 0] == 0.0
    assert motion.work_friction[-1, 0] == pytest.approx(-0.5 * 2.0 * 1.5**2, rel=1e-12)


@pytest.mark.parametrize(("load", "end"), [(0.399, 0), (0.401, 1)])
def test_static_friction_holds_up_to_its_limit(load, end):
    motion = simulate(block_on_belt(Coulomb(0.4, 0.25), 0.0, stiffness=0.0, load=load), 2.0, times=5)
    if end == 0:
        assert np.all(motion.q == 0.0)
        assert motion.friction_force == pytest.approx(-load)
        assert np.all(motion.mode == 0)
    else:
        assert motion.q[:, 0] == pytest.approx(0.5 * (load - 0.25) * motion.t**2)
        assert np.all(motion.mode == -1)


def test_coulomb_damped_swing():
    # every half period pi/w the amplitude falls by 2 mu N/k, until the spring is weaker than static friction
    motion = simulate(block_on_belt(Coulomb(0.1), 0.0, stiffness=4.0), 12.0, ([0.31], [0.0]), rtol=1e-12)
    turning = [-0.26, 0.21, -0.16, 0.11, -0.06, 0.01]
    assert motion.event_time == pytest.approx(0.5 * np.pi * np.arange(1, 7), abs=1e-10)
    assert motion.event_mode.tolist() == [-1, 1, -1, 1, -1, 0]
    at = np.searchsorted(motion.t, motion.event_time)
    assert motion.q[at, 0] == pytest.approx(turning, abs=1e-10)
    assert motion.friction_force[-1, 0] == pytest.approx(4.0 * 0.01, abs=1e-10)  # the spring's pull is held


def test_block_stays_on_a_belt_that_brakes_gently():
    belt = Ramp(start=1.0, slope=-0.1)
    motion = simulate(block_on_belt(Coulomb(0.3), belt, stiffness=0.0), 14.0, ([0.0], [1.0]), times=29)
    t = np.minimum(motion.t, 10.0)
    assert motion.q[:, 0] == pytest.approx(t - 0.05 * t**2, abs=1e-12)
    assert np.all(motion.mode == 0)
    assert motion.friction_force[motion.t < 10.0, 0] == pytest.approx(-0.1)
    assert motion.friction_force[motion.t > 10.0, 0] == pytest.approx(0.0, abs=1e-14)


def test_block_slides_on_a_belt_that_brakes_hard():
    # the belt stands still at 2 s; the block, slowed by mu N only, at 1/0.3 s
    belt = Ramp(start=1.0, slope=-0.5)
    motion = simulate(block_on_belt(Coulomb(0.3), belt, stiffness=0.0), 5.0, ([0.0], [1.0]))
    assert motion.event_time == pytest.approx([1.0 / 0.3], rel=1e-12)
    assert motion.q[-1, 0] == pytest.approx(1.0 / 0.6, rel=1e-12)
    assert 2.0 in motion.t  # the step ends on the kink
    assert np.all(motion.mode[motion.t < 1.0 / 0.3 - 1e-9] == -1)


def test_shaken_belt_carries_the_block():
    # A w = 0.628 < mu N = 0.7: it sticks, q = (A/w)(1 - cos w t)
    w = 2.0 * np.pi * 0.5
    motion = simulate(block_on_belt(Coulomb(0.7), Sinusoid(0.0, 0.2, 0.5), stiffness=0.0), 6.0, times=61, rtol=1e-12)
    assert np.all(motion.mode == 0)
    assert motion.q[:, 0] == pytest.approx(0.2 / w * (1.0 - np.cos(w * motion.t)), abs=1e-11)
    assert motion.friction_force[:, 0] == pytest.approx(0.2 * w * np.cos(w * motion.t), abs=1e-11)


def test_shaken_belt_slips_under_the_block():
    # A w = 0.628 > mu N = 0.3: the block gains 0.3 t until the belt has that speed again
    w = 2.0 * np.pi * 0.5
    motion = simulate(block_on_belt(Coulomb(0.3), Sinusoid(0.0, 0.2, 0.5), stiffness=0.0), 1.0, rtol=1e-13)
    caught = brentq(lambda t: 0.3 * t - 0.2 * np.sin(w * t), 0.2, 0.9, xtol=1e-15)
    assert motion.event_time[0] == pytest.approx(caught, rel=1e-11)
    assert motion.mode[1, 0] == 1


def test_force_that_ebbs_away_lets_go():
    # N = 2 - 2t under the load 0.3: released at mu_s N = 0.3, then q'' = 0.3 - mu_k N
    system = block_on_belt(Coulomb(0.4, 0.25), 0.0, stiffness=0.0, load=0.3, normal=Table([0.0, 1.0], [2.0, 0.0]))
    motion = simulate(system, 1.0, times=41, rtol=1e-12)
    assert motion.event_time == pytest.approx([0.625], rel=1e-12)
    after = np.maximum(motion.t - 0.625, 0.0)
    assert motion.q[:, 0] == pytest.approx(0.05625 * after**2 + after**3 / 12.0, abs=1e-12)
    other = simulate(system.replace({"load": [0.3001]}), 1.0)
    assert abs(other.event_time[0] - 0.625) > 1e-4


def test_pulsating_force_lets_go():
    normal = Sinusoid(1.0, 0.5, 0.25)
    motion = simulate(block_on_belt(Coulomb(0.4, 0.2), 0.0, stiffness=0.0, load=0.3, normal=normal), 3.5, rtol=1e-12)
    assert motion.event_time[0] == pytest.approx(2.0 + np.arcsin(0.5) / (0.5 * np.pi), rel=1e-12)


def test_constant_schedules_are_numbers():
    plain = simulate(block_on_belt(Coulomb(0.4, 0.25), 0.1), 9.0, times=7)
    dressed = simulate(block_on_belt(Coulomb(0.4, 0.25), Constant(0.1), normal=Constant(1.0)), 9.0, times=7)
    assert np.array_equal(plain.q, dressed.q)


@pytest.mark.parametrize("law", [Coulomb(0.4, 0.25), Coulomb(0.4)], ids=["static above kinetic", "equal"])
def test_parallel_contacts_act_as_one(law):
    """Two contacts in one place with loads N and 2 N are one contact with 3 N: neither knows how the other shares.

    The split of a sticking force between them is open, so the matrix of the sticking contacts is singular.
    """
    both = System([[1.0]], [[0.0]], [[1.0]], 0.0, tuple(Contact([0.0], [1.0], [1.0], n, 0.1, law) for n in (1.0, 2.0)))
    motion = simulate(both, 20.0, times=101)
    one = simulate(block_on_belt(law, 0.1, normal=3.0), 20.0, times=101)
    assert motion.outcome.ok
    assert np.any(motion.mode[:, 0] == 0)
    # 1e-9 is the relative tolerance of each step; the regularised split adds less
    np.testing.assert_allclose(motion.q, one.q, atol=1e-8)
    sticking = motion.mode[:, 0] == 0
    np.testing.assert_allclose(2.0 * motion.friction_force[sticking, 0], motion.friction_force[sticking, 1], rtol=1e-6)


def test_contacts_on_different_bodies_do_not_share():
    """The negative twin: two blocks are not one block under both loads."""
    pair = simulate(two_blocks_on_belt(), 20.0, times=101)
    one = simulate(block_on_belt(Coulomb(0.4, 0.25), 0.1, normal=2.3), 20.0, times=101)
    assert np.max(np.abs(pair.q[:, 0] - one.q[:, 0])) > 1e-2
