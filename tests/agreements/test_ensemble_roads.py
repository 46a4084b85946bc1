"""Lanes and the scalar march solve the same equation: one answer, whatever the place of a trajectory."""

import numpy as np
import pytest

from squealbox import Contact, Coulomb, DrumBrake, LinearSlope, Ramp, Stribeck, System, simulate, simulate_ensemble

OBSERVE = ("amplitude", "peak", "frequency", "energy", "sticking")


def drum(reading="consistent", friction=0.3):
    """The drum of the paper."""
    return DrumBrake(friction=LinearSlope(friction, -0.05), reading=reading)


def distance(one, other, scale):
    """Largest difference of two states in parts of `scale`."""
    return np.max(np.abs(one - other)) / scale


@pytest.mark.parametrize("reading", ["consistent", "eq3"])
def test_exact_lanes_agree_with_single_runs(reading):
    frictions = np.array([0.2, 0.37, 0.44])
    many = simulate_ensemble(drum(reading), {"friction.static": frictions}, 0.02, observe=OBSERVE, rtol=1e-9)
    for k, friction in enumerate(frictions):
        one = simulate(drum(reading, friction), 0.02, times=20_001, rtol=1e-9)
        scale = np.max(np.abs(one.q))
        assert many.ended[k] == "completed"
        assert many.events[k] == len(one.event_time)
        assert distance(many.q[k], one.q[-1], scale) < 1e-6  # of rtol 1e-9 over some 190 reversals
        assert distance(many["peak"][k], np.max(np.abs(one.q), axis=0), scale) < 1e-4  # the quintic between steps
        assert many["energy"][k] == pytest.approx(one.work_friction[-1], rel=1e-5)


def test_an_event_takes_few_trials():
    """A rejected step, the first aim, one or two better ones: not the bisection that an unknown slope invites."""
    many = simulate_ensemble(drum(), {"friction.static": [0.43, 0.44]}, 0.02, observe=OBSERVE, rtol=1e-9)
    assert np.all(many.events > 100)
    assert np.sum(many.tried - many.steps) < 6 * np.sum(many.events)


def test_another_friction_is_not_the_same_answer():
    many = simulate_ensemble(drum(), {"friction.static": [0.37, 0.38]}, 0.02, observe=OBSERVE, rtol=1e-9)
    assert distance(many.q[0], many.q[1], np.max(np.abs(many.q))) > 1e-3


@pytest.mark.parametrize("contact", ["raw", "tanh"])
def test_schemes_without_events_agree_with_single_runs(contact):
    frictions = np.array([0.1, 0.25])
    options = {"contact": contact, "rtol": 1e-6, "width": 0.02, "method": "bogacki-shampine"}
    many = simulate_ensemble(drum(), {"friction.static": frictions}, 0.01, observe=(), **options)
    for k, friction in enumerate(frictions):
        one = simulate(drum(friction=friction), 0.01, **options)
        assert distance(many.q[k], one.q[-1], np.max(np.abs(one.q))) < 1e-4  # both controllers keep 1e-6 a step


def test_a_trajectory_does_not_know_its_neighbours():
    """Bit for bit, whatever the number of threads, the order, and how many others run."""
    frictions = np.linspace(0.1, 0.45, 70)
    run = {"duration": 0.01, "observe": OBSERVE}
    base = simulate_ensemble(drum(), {"friction.static": frictions}, threads=1, **run)
    two = simulate_ensemble(drum(), {"friction.static": frictions}, threads=2, **run)
    back = simulate_ensemble(drum(), {"friction.static": frictions[::-1]}, threads=2, **run)
    few = simulate_ensemble(drum(), {"friction.static": frictions[[5, 50, 66]]}, threads=1, **run)
    for name in ("q", "qd", "time", "steps", "events"):
        assert np.array_equal(getattr(base, name), getattr(two, name))
        assert np.array_equal(getattr(base, name), getattr(back, name)[::-1])
        assert np.array_equal(getattr(base, name)[[5, 50, 66]], getattr(few, name))
    for name in OBSERVE:
        assert np.array_equal(base[name], two[name], equal_nan=True)
    assert not np.array_equal(base.q[0], base.q[1])


def chain(speed):
    """Two blocks on a belt, joined by springs, with a strong static limit: stick and slip, alone and together."""
    law, eye = Stribeck(0.6, 0.3, 0.2), np.eye(2)
    contacts = tuple(Contact(np.zeros(2), row, row, 10.0, speed, law) for row in eye)
    return System(eye, 0.05 * eye, [[30.0, -10.0], [-10.0, 22.0]], 0.0, contacts)


def test_stick_slip_of_two_blocks_agrees_with_single_runs():
    speeds = np.array([0.2, 0.5, 0.9])
    many = simulate_ensemble([chain(v) for v in speeds], None, 20.0, observe=("sticking",), rtol=1e-9)
    for k, speed in enumerate(speeds):
        one = simulate(chain(speed), 20.0, rtol=1e-9)
        assert many.events[k] == len(one.event_time) > 5
        assert distance(many.q[k], one.q[-1], np.max(np.abs(one.q))) < 1e-6
        held = np.mean(simulate(chain(speed), 20.0, times=20_001, rtol=1e-9).mode == 0, axis=0)
        assert many["sticking"][k] == pytest.approx(held, abs=1e-3)  # 20,001 instants see each interval to 1e-3 s


def unilateral(load):
    """A mass on a sprung contact that shakes itself off, and slides."""
    contact = Contact([0.0, -100.0], [1.0, 0.0], [1.0, 0.0], 0.0, 0.3, Coulomb(0.3), unilateral=True, normal=[0.0, 1.0])
    return System(np.eye(2), 0.02 * np.eye(2), [[40.0, 0.0], [0.0, 100.0]], [0.0, load], (contact,))


def test_lift_off_and_landing_agree_with_single_runs():
    start = (np.array([0.0, 0.05]), np.zeros(2))
    loads = np.array([-1.0, -2.0])
    many = simulate_ensemble([unilateral(f) for f in loads], None, 4.0, observe=("sticking",), start=start, rtol=1e-9)
    for k, load in enumerate(loads):
        one = simulate(unilateral(load), 4.0, start=start, rtol=1e-9)
        assert 2 in one.event_mode
        assert many.events[k] > 10
        assert distance(many.q[k], one.q[-1], np.max(np.abs(one.q))) < 1e-6
        mode = simulate(unilateral(load), 4.0, start=start, times=20_001, rtol=1e-9).mode
        assert many["sticking"][k] == pytest.approx(
            np.mean(mode == 0, axis=0), abs=1e-3
        )  # in the air it does not stick
        assert np.mean(mode == 2) > 0.05


def test_braking_to_standstill_agrees_with_single_runs():
    """A schedule with a kink: speed falls to zero within the run, and the brake sticks."""
    brake = drum(friction=0.3).replace({"sliding_speed": Ramp(start=0.2, slope=-40.0)})
    many = simulate_ensemble(brake, {"friction.static": [0.2, 0.3]}, 0.01, observe=(), rtol=1e-9)
    for k, friction in enumerate((0.2, 0.3)):
        one = simulate(brake.replace({"friction.static": friction}), 0.01, rtol=1e-9)
        assert one.outcome == many.ended[k]
        assert distance(many.q[k], one.q[-1], np.max(np.abs(one.q))) < 1e-5


def test_samples_lie_on_the_single_run():
    instants = np.linspace(0.0, 0.01, 41)
    many = simulate_ensemble(drum(), {"friction.static": [0.3, 0.44]}, 0.01, observe=(), times=instants, rtol=1e-9)
    for k, friction in enumerate((0.3, 0.44)):
        one = simulate(drum(friction=friction), 0.01, times=instants, rtol=1e-9)
        assert distance(many.sample_q[k], one.q, np.max(np.abs(one.q))) < 1e-5  # quintic between steps
        assert distance(many.sample_qd[k], one.qd, np.max(np.abs(one.qd))) < 1e-4
