"""Rigid contacts: bouncing, sliding, lift-off and landing in closed form, frictional impacts, and Painleve's paradox.

Free flight and sliding under constant forces are polynomials in time, which every method here integrates without error,
so tolerances of 1e-12 are round-off summed over the run.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

from small_systems import METHODS
from squealbox import Contact, Coulomb, DrumBrake, LinearSlope, Ramp, Sinusoid, System, simulate
from squealbox.system import InvalidSystem, equilibrium

GRAVITY = 10.0


def ball(restitution=0.0, friction=0.0, *, belt=0.0, load=None, gap=0.0):
    """A point of 1 kg over a floor at height -gap, free to move along and across; the belt runs along."""
    floor = Contact(
        [0, 0], [1, 0], [1, 0], 0.0, belt, Coulomb(friction), "floor", True, [0, -1], True, gap, restitution
    )
    return System(np.eye(2), np.zeros((2, 2)), np.zeros((2, 2)), [0.0, -GRAVITY] if load is None else load, (floor,))


@pytest.mark.parametrize("method", METHODS)
def test_bouncing_ball(method):
    """Dropped from h0, landing k is at t0 + 2 t0 (e + ... + e^k), t0 = sqrt(2 h0/g), and height k is e^2k h0."""
    e, height = 0.5, 0.8
    motion = simulate(ball(e), 1.19, ([0.0, height], [0.0, 0.0]), method=method)
    first = np.sqrt(2.0 * height / GRAVITY)
    k = np.arange(6)
    landings = first * (1.0 + 2.0 * np.cumsum(np.where(k > 0, e**k, 0.0)))
    assert motion.outcome == "completed"
    assert motion.event_time[:6] == pytest.approx(landings, rel=1e-12)
    tops = landings[:5] + first * e ** (k[:5] + 1)
    heights = simulate(ball(e), 1.19, ([0.0, height], [0.0, 0.0]), times=tops, method=method).q[:, 1]
    assert heights == pytest.approx(height * e ** (2.0 * (k[:5] + 1)), rel=1e-10)
    # all that is lost is lost in the impacts
    assert motion.energy.relative_residual < 1e-12
    before = np.searchsorted(motion.t, 0.5 * (landings[0] + landings[1]))
    assert motion.work_impact[before] == pytest.approx(-GRAVITY * height * (1.0 - e**2), rel=1e-12)


def test_endless_rebounds_end():
    """They add up to t0 (1 + e)/(1 - e), after which the ball lies; the smallest ones, below 1e-6, are left out."""
    motion = simulate(ball(0.5), 3.0, ([0.0, 0.8], [0.0, 0.0]))
    assert motion.outcome == "completed"
    assert motion.event_time[-1] == pytest.approx(1.2, rel=1e-5)
    assert motion.event_time.size == 20  # 0.5^20 < 1e-6 < 0.5^19
    assert motion.q[-1] == pytest.approx([0.0, 0.0], abs=1e-12)
    assert motion.normal_force[-1, 0] == pytest.approx(GRAVITY)
    assert motion.work_impact[-1] == pytest.approx(-8.0, rel=1e-11)


def test_slow_decay_of_rebounds_is_no_zeno():
    motion = simulate(ball(0.9), 9.0, ([0.0, 0.8], [0.0, 0.0]))
    assert motion.outcome == "completed"
    assert motion.event_time[-1] == pytest.approx(0.4 * 1.9 / 0.1, rel=1e-5)


@pytest.mark.parametrize(("restitution", "lost"), [(1.0, 0.0), (0.0, 8.0)])
def test_elastic_and_plastic(restitution, lost):
    motion = simulate(ball(restitution), 1.6, ([0.0, 0.8], [0.0, 0.0]))
    assert motion.work_impact[-1] == pytest.approx(-lost, abs=1e-12)
    assert motion.q[-1, 1] == pytest.approx(0.8 if restitution else 0.0, abs=1e-10)


def test_the_gap_shifts_the_floor():
    motion = simulate(ball(0.0, gap=0.3), 1.0, ([0.0, 0.5], [0.0, 0.0]))
    assert motion.event_time == pytest.approx([0.4], rel=1e-12)
    assert motion.q[-1, 1] == pytest.approx(-0.3)


@pytest.mark.parametrize(("along", "after"), [(2.0, 2.0 - 0.3 * 4.0), (1.0, 0.0)])
def test_frictional_landing(along, after):
    """A plastic landing at 4 m/s has the impulse 4 N s: friction takes 0.3 of it from the motion along, or stops it."""
    motion = simulate(ball(0.0, 0.3), 0.4 + 1e-9, ([0.0, 0.8], [along, 0.0]))
    assert motion.qd[-1] == pytest.approx([after, 0.0], abs=1e-8)
    assert motion.energy.relative_residual < 1e-12
    assert motion.work_friction[-1, 0] == pytest.approx(0.5 * (after**2 - along**2), abs=1e-8)


@pytest.mark.parametrize("method", METHODS)
def test_block_slides_to_rest_under_its_weight(method):
    motion = simulate(ball(0.0, 0.3), 3.0, ([0.0, 0.0], [2.0, 0.0]), method=method)
    assert motion.event_time == pytest.approx([2.0 / 3.0], rel=1e-12)
    assert motion.q[-1, 0] == pytest.approx(2.0 / 3.0, rel=1e-12)
    assert np.all(motion.normal_force == pytest.approx(GRAVITY))
    assert motion.work_friction[-1, 0] == pytest.approx(-2.0, rel=1e-12)


def test_lift_off_and_landing_while_sliding():
    """The load 20 sin(pi t) - 10 lifts the block at t = 1/6; the flight from rest is integrated by hand."""
    lifting = Sinusoid(-GRAVITY, 20.0, 0.5) * [0.0, 1.0]
    motion = simulate(ball(0.0, 0.1, belt=50.0, load=lifting), 3.0, rtol=1e-12)
    start, w = 1.0 / 6.0, np.pi

    def height(t):
        speed = 20.0 / w * np.cos(w * start)
        bend = 20.0 / w**2 * (np.sin(w * start) - np.sin(w * t))
        return bend + speed * (t - start) - 0.5 * GRAVITY * (t - start) ** 2

    landing = brentq(height, 0.8, 2.1)
    assert motion.event_mode[:2].tolist() == [2, 1]
    assert motion.event_time[:2] == pytest.approx([start, landing], rel=1e-9)
    assert motion.event_time[2] == pytest.approx(2.0 + start, rel=1e-9)
    closed = motion.mode[:, 0] != 2
    assert np.all(motion.normal_force[closed] >= -1e-9)
    assert np.min(motion.q[:, 1]) > -1e-12  # no penetration
    assert motion.energy.relative_residual < 1e-8


def test_two_feet_share_a_weight():
    """A bar on two feet, pressed off its middle: N1 + N2 = load, moments balance. Redundant feet are solved for too."""
    feet = tuple(Contact([0, 0], [0, 0], [0, 0], 0.0, 0.0, Coulomb(0.0), "", True, [-1, x], True) for x in (-1.0, 1.0))
    bar = System(np.diag([2.0, 1.0]), np.zeros((2, 2)), np.zeros((2, 2)), [-8.0, 2.0], feet)
    motion = simulate(bar, 1.0, times=3)
    assert motion.normal_force.sum(axis=1) == pytest.approx(8.0)
    assert abs(motion.normal_force[0, 0] - motion.normal_force[0, 1]) == pytest.approx(2.0)
    twice = simulate(ball().replace({"contacts": 2 * ball().contacts}), 1.0, times=3)
    assert twice.normal_force == pytest.approx(GRAVITY / 2.0)


def rod(friction, along):
    """Painleve's rod, linearised at 60 degrees: m = 1, J = 1/3, length 2; the tip moves by x + s theta, y - c theta."""
    c, s = np.cos(np.pi / 3.0), np.sin(np.pi / 3.0)
    tip = Contact(np.zeros(3), [1, 0, s], [1, 0, s], 0.0, 0.0, Coulomb(friction), "tip", True, [0, -1, c], True)
    return System(np.diag([1.0, 1.0, 1.0 / 3.0]), np.zeros((3, 3)), np.zeros((3, 3)), [0, -GRAVITY, 0], (tip,)), along


def test_painleve_has_a_name():
    """w . M^-1 (w - sense mu d) = 1 + 3 c (c - sense mu s) < 0 in one sense for mu > (1 + 3 c^2)/(3 c s) = 1.347."""
    system, along = rod(1.5, -1.0)
    singular = [simulate(system, 1e-3, (np.zeros(3), [v, 0.0, 0.0])).outcome for v in (along, -along)]
    assert singular.count("painleve") == 1
    system, along = rod(1.2, -1.0)
    assert [simulate(system, 1e-3, (np.zeros(3), [v, 0.0, 0.0])).outcome for v in (along, -along)] == ["completed"] * 2


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"restitution": 1.5}, "restitution = 1.5"),
        ({"restitution": -0.1}, "restitution = -0.1"),
        ({"rigid": False}, "only a rigid contact"),
        ({"n": [0.0, 1.0]}, "expected n = 0, N0 = 0"),
        ({"N0": 3.0}, "expected n = 0, N0 = 0"),
        ({"unilateral": False}, "can only press"),
        ({"normal": [0.0, 0.0]}, "needs its direction"),
        ({"gap": np.nan}, "gap = nan"),
    ],
)
def test_a_senseless_rigid_contact_is_refused(changes, words):
    with pytest.raises(InvalidSystem, match=words):
        ball(0.5).contacts[0].replace(changes)


def test_what_needs_a_stiffness_says_so():
    with pytest.raises(InvalidSystem, match="steady sliding needs"):
        equilibrium(ball())
    with pytest.raises(InvalidSystem, match="contact='raw'"):
        simulate(ball(), 1.0, contact="raw")
    with pytest.raises(ValueError, match="a gap >= 0"):
        simulate(ball(), 1.0, ([0.0, -0.1], [0.0, 0.0]))


def test_a_law_of_ones_own_is_named():
    class Mine(Coulomb):
        pass

    system = ball().replace({"contacts": (ball().contacts[0].replace({"law": Mine(0.3)}),)})
    with pytest.raises(InvalidSystem, match="one of Coulomb"):
        simulate(system, 1.0)


@pytest.mark.parametrize("method", [None, "dormand-prince-8"])
@pytest.mark.parametrize("braking", [-10.0, -5.0])
def test_a_pulled_contact_has_a_name(braking, method):
    """Braked to a standstill, a contact in tension beside a sticking one has no consistent mode."""
    belt = Ramp(0.2, braking, 0.0)
    drum = DrumBrake(friction=LinearSlope(0.44, -0.05), reading="componentwise", sliding_speed=belt)
    motion = simulate(drum, 0.05, times=2, method=method)
    assert motion.outcome == "contact_in_tension"
    assert "N < 0" in motion.outcome.message
    assert motion.outcome.evidence["time"] < 0.05
    assert motion.steps + motion.rejected < 5_000
