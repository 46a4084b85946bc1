"""The Taylor steps of lanes and the scalar march solve the same equation: one answer, and every event of it."""

import numpy as np
import pytest

from squealbox import (
    Contact,
    Coulomb,
    DrumBrake,
    LinearSlope,
    MassOnBelt,
    Method,
    ParameterError,
    Ramp,
    Sinusoid,
    Stribeck,
    System,
    schedules,
    simulate,
    simulate_ensemble,
)
from squealbox.files.own_law import own_law
from squealbox.friction import Table

OBSERVE = ("amplitude", "peak", "frequency", "energy", "sticking")
INSTANTS = np.linspace(0.0, 0.02, 41)


def drum(static=0.3, **others):
    """The drum in reading `consistent`."""
    return DrumBrake(friction=LinearSlope(static, -0.05), **others)


def distance(one, other):
    """Largest difference in parts of the largest number of the other."""
    return np.max(np.abs(one - other)) / np.max(np.abs(other))


def many_drums(varied, duration=0.02, rtol=1e-9, **options):
    """One kernel serves all tests of the drum."""
    method = Method("taylor", rtol=rtol)
    return simulate_ensemble(drum(0.44), varied, duration, method, OBSERVE, times=INSTANTS, **options)


def test_events_observers_and_samples_agree_with_single_runs():
    frictions = np.array([0.1, 0.2, 0.37, 0.44])
    many = many_drums({"friction.static": frictions})
    for k, friction in enumerate(frictions):
        one, fine = (simulate(drum(friction), 0.02, times=t, rtol=1e-10) for t in (INSTANTS, 20_001))
        assert many.ended[k] == "completed"
        assert many.events[k] == len(one.event_time)
        assert distance(many.sample_q[k], one.q) < 1e-8  # rtol 1e-9 over up to 190 reversals
        assert distance(many.sample_qd[k], one.qd) < 1e-8
        assert np.array_equal(many.sample_q[k, -1], many.q[k])
        assert distance(many["peak"][k], np.max(np.abs(fine.q), axis=0)) < 1e-4  # the quintic between parts of a step
        assert many["energy"][k] == pytest.approx(one.work_friction[-1], rel=1e-7)
        held = np.mean(fine.mode == 0, axis=0)
        assert many["sticking"][k] == pytest.approx(held, abs=5e-3)  # 20,001 instants see 190 intervals to half of one
    assert np.max(many.events) > 100
    assert distance(many.q[2], many.q[3]) > 1e-3


def test_no_step_is_tried_in_vain():
    """One trial for a step or an event; a few more where two events or a graze lie in one part of a step."""
    many = many_drums({"friction.static": [0.43, 0.44]})
    assert np.all(many.events > 100)
    assert np.all(many.tried - many.steps < 0.05 * many.tried)


def test_short_reversals_between_the_ends_of_a_step_are_found():
    """Pressure centres where a contact stops for a hundredth of a step: none of these pairs of events is missed."""
    places = np.array([(0, 18), (1, 34), (5, 19), (7, 3), (18, 39), (43, 42), (55, 48)])
    theta1 = np.deg2rad(np.linspace(95.0, 175.0, 64))[places[:, 1]]
    theta2 = np.deg2rad(np.linspace(10.0, 50.0, 64))[places[:, 0]]
    many = many_drums({"theta1": theta1, "theta2": theta2}, 0.05, rtol=1e-7)
    for k in range(len(places)):
        one = simulate(drum(0.44, theta1=theta1[k], theta2=theta2[k]), 0.05, rtol=1e-11)
        assert many.events[k] == len(one.event_time)
        assert np.max(np.abs(many.q[k] - one.q[-1])) < 1e-5 * np.max(np.abs(one.q))


def test_a_trajectory_does_not_know_its_neighbours():
    """Bit for bit, though a group in which nothing sticks takes another way than one in which something does."""
    frictions = np.linspace(0.1, 0.45, 70)
    base = many_drums({"friction.static": frictions}, threads=1)
    back = many_drums({"friction.static": frictions[::-1]}, threads=2)
    few = many_drums({"friction.static": frictions[[5, 50, 66]]}, threads=1)
    stuck = np.max(base["sticking"], axis=-1) > 0.0
    assert 0 < np.sum(stuck) < len(frictions)
    for name in ("q", "qd", "time", "steps", "tried", "events", "sample_q"):
        assert np.array_equal(getattr(base, name), getattr(back, name)[::-1])
        assert np.array_equal(getattr(base, name)[[5, 50, 66]], getattr(few, name))
    for name in OBSERVE:
        assert np.array_equal(base[name], back[name][::-1], equal_nan=True)


def shaken():
    """A mass that lifts off, lands, slides and sticks under a swinging load."""
    law, row = Stribeck(0.3, 0.2, 0.2), [1.0, 0.0]
    contact = Contact([0.0, -100.0], row, row, 0.0, 0.3, law, unilateral=True, normal=[0.0, 1.0])
    swing = Sinusoid(-1.5, 0.3, 0.7) * [0.0, 1.0]
    return System(np.eye(2), 0.02 * np.eye(2), [[40.0, 0.0], [0.0, 100.0]], swing, (contact,))


def test_lift_off_and_a_swinging_load_agree_with_single_runs():
    heights = np.array([[0.0, 0.05], [0.0, 0.08]])
    many = simulate_ensemble(shaken(), None, 4.0, "taylor", (), start=(heights, np.zeros(2)), rtol=1e-10)
    for k, height in enumerate(heights):
        one = simulate(shaken(), 4.0, start=(height, np.zeros(2)), rtol=1e-10)
        assert {0, 1, 2} <= set(one.event_mode)
        assert many.events[k] == len(one.event_time) > 10
        assert distance(many.q[k], one.q[-1]) < 1e-8


FLOOR = 0.3


def chain(speed):
    """Two blocks on a belt, joined by springs: stick and slip, alone and together, and a law with a floor."""
    law, eye = LinearSlope(0.6, -1.0, FLOOR), np.eye(2)
    contacts = tuple(Contact(np.zeros(2), row, row, 10.0, speed, law) for row in eye)
    return System(eye, 0.05 * eye, [[30.0, -10.0], [-10.0, 22.0]], 0.0, contacts)


def test_stick_slip_past_the_kink_of_a_law_agrees_with_single_runs():
    """Slipping contacts pass the kink within what would be one step."""
    speeds = np.array([0.2, 0.5, 0.9])
    many = simulate_ensemble([chain(v) for v in speeds], None, 20.0, "taylor", (), rtol=1e-9)
    for k, speed in enumerate(speeds):
        one = simulate(chain(speed), 20.0, times=20_001, rtol=1e-11)
        above = 0.6 - np.abs(one.sliding_velocity) < FLOOR
        assert 0.1 < np.mean(above) < 0.9
        assert many.events[k] == len(one.event_time) > 5
        assert distance(many.q[k], one.q[-1]) < 1e-7  # a kink taken unawares costs 1e-5


def test_what_has_no_series_is_refused_in_one_sentence():
    varied = {"friction.static": [0.1, 0.2]}
    with pytest.raises(ParameterError, match="jump of sgn"):
        simulate_ensemble(drum(), varied, 1e-3, "taylor", contact="raw")
    with pytest.raises(ParameterError, match="jump of sgn"):
        simulate(drum(), 1e-3, method="taylor", contact="raw")


SPEEDS = np.linspace(0.0, 4.0, 9)  # the drum's sliding speed of 1.5 m/s is one of them
MEASURED = Table(SPEEDS, 0.3 + 0.15 * np.exp(-SPEEDS / 0.5))
BRAKING = {
    "at a knot": 1.5,
    "from a knot": Ramp(1.5, -24.0, None),
    "measured": schedules.Table([0.0, 0.01, 0.02, 0.05], [1.5, 1.2, 0.7, 0.3]),
}


@pytest.mark.parametrize("speed", BRAKING.values(), ids=BRAKING)
def test_measured_points_end_a_step_of_the_series(speed):
    """A knot passed unawares costs 1e-6: `dormand-prince-8` at its tightest tells."""
    design = drum(reading="consistent").replace({"friction": MEASURED, "sliding_speed": speed})
    one = simulate(design, 0.05, times=51)
    close = simulate(design, 0.05, times=51, method=Method("dormand-prince-8", rtol=1e-13))
    assert one.settings["tableau"] == "taylor"
    assert len(one.event_time) == len(close.event_time)
    assert isinstance(speed, float) or len(one.event_time) > 50
    assert distance(one.q, close.q) < 5e-9
    assert distance(one.friction_force, close.friction_force) < 1e-7
    many = simulate_ensemble(design, {"theta1": [0.6, design.theta1]}, 0.05, None, ())
    assert many.settings["tableau"] == "taylor"
    assert distance(many.q[1], close.q[-1]) < 5e-9


def test_a_measured_speed_of_many_points_is_no_burden():
    """2,000 instants, some of a law of 40 speeds between them: half a minute by a formula that sums over intervals."""
    rng = np.random.default_rng(3)
    instants, speeds = np.linspace(0.0, 0.02, 2000), np.linspace(0.0, 4.0, 40)
    speed = schedules.Table(instants, 1.5 - 20.0 * instants + 0.01 * rng.standard_normal(2000))
    law = Table(speeds, 0.3 + 0.15 * np.exp(-2.0 * speeds) + 0.002 * rng.standard_normal(40))
    design = drum(reading="consistent").replace({"friction": law, "sliding_speed": speed})
    one, close = (simulate(design, 0.02, times=21, method=m) for m in (None, Method("dormand-prince-8", rtol=1e-12)))
    assert one.settings["tableau"] == "taylor"
    assert one.steps < 4000  # the other takes one for each instant too
    assert distance(one.q, close.q) < 1e-8
    for time in (0.0, 1e-3, instants[7], 0.5 * (instants[7] + instants[8]), 0.03):
        assert speed.value(time) == pytest.approx(schedules.table(time, speed.coefficients()), rel=1e-12)
        assert speed.rate(time) == pytest.approx(schedules.table_rate(time, speed.coefficients()), rel=1e-9)


@pytest.mark.parametrize("contact", ["arctan", "tanh"])
@pytest.mark.parametrize("width", [1e-3, 0.05])
def test_a_smoothed_sign_has_a_series(contact, width):
    """The same motion as by `dormand-prince-8` at its tightest, in one run and in lanes, and the same reversals."""
    ways = {"contact": contact, "width": width}
    one = simulate(drum(0.44), 0.01, times=21, **ways)
    close = simulate(drum(0.44), 0.01, times=21, method=Method("dormand-prince-8", rtol=1e-13), **ways)
    assert one.settings["tableau"] == "taylor"
    assert distance(one.q, close.q) < 1e-8
    assert distance(one.friction_force, close.friction_force) < 1e-6
    assert np.array_equal(one.mode, close.mode)
    assert np.max(np.abs(one.energy.residual)) < 1e-8 * np.max(np.abs(one.work_friction))
    assert one.caution.split(";")[0] == close.caution.split(";")[0]  # how often sliding reversed
    many = simulate_ensemble(drum(), {"friction.static": [0.3, 0.44]}, 0.01, None, (), **ways)
    assert many.settings["tableau"] == "taylor"
    assert distance(many.q[1], close.q[-1]) < 1e-8


@pytest.mark.parametrize("law", [Coulomb(0.0), Stribeck(0.0, 0.0, 0.1), LinearSlope(0.0, 0.0), LinearSlope(0.0, 0.1)])
def test_methods_agree_on_what_is_an_event(law):
    """Without friction nothing happens at a reversal; friction that rises from zero turns there."""
    block = System([[1.0]], [[0.0]], [[1.0]], 0.0, (Contact([0.0], [1.0], [1.0], 1.0, 0.1, law),))
    start = ([1.0], [0.0])
    counts = [len(simulate(block, 20.0, start, method=name).event_time) for name in ("taylor", "dormand-prince-8")]
    counts += [int(simulate_ensemble(block, duration=20.0, start=start, method=name).events)
               for name in ("taylor", "dormand-prince-8")]  # fmt: skip
    assert counts == [6 if law.static_limit > 0.0 else 0] * 4


def test_one_of_a_batch_without_friction():
    batch = simulate_ensemble(MassOnBelt(), {"friction.static": [0.0, 0.1, 0.3]}, 20.0, start=([1.0], [0.0]))
    alone = [simulate(MassOnBelt().replace({"friction.static": mu}), 20.0, ([1.0], [0.0])) for mu in (0.0, 0.1, 0.3)]
    assert batch.events.tolist() == [len(motion.event_time) for motion in alone]
    assert batch.events[0] == 0


def test_a_run_that_went_on_by_another_method_says_so():
    """Of v sqrt(v) the second derivative at zero speed is infinite: the series ends where sliding begins to stop."""
    bent = own_law("def mu(v, p): return 0.4 - 0.02 * v * np.sqrt(v)")
    motion = simulate(MassOnBelt(friction=bent), 5.0)
    assert motion.outcome == "completed"
    assert "instead of taylor, which ended as step_underflow" in motion.summary().replace("\n   ", "")
    named = simulate(MassOnBelt(friction=bent), 5.0, method="dormand-prince-8")
    assert named.caution == ""
    assert motion.q[-1, 0] == named.q[-1, 0]
    rooted = own_law("def mu(v, p): return 0.4 - 0.02 * np.sqrt(v)")  # known before the run
    assert simulate(MassOnBelt(friction=rooted), 5.0).settings["tableau"] == "dormand-prince-8"
    assert simulate(MassOnBelt(friction=rooted), 5.0, method="taylor").outcome == "step_underflow"


def test_the_audit_of_a_free_motion_closes():
    free = System([[1.0]], [[0.0]], [[1.0]], 0.0, ())
    for name in ("taylor", "dormand-prince-8"):
        assert simulate(free, 20.0, ([3.0], [0.0]), method=name).energy.relative_residual < 1e-9


def test_the_audit_of_a_damped_motion_is_as_exact_as_the_motion():
    """Works are integrals of products, whose series falls off later than that of the motion."""
    damped = System([[1.0]], [[0.02]], [[1.0]], 0.0, ())
    for rtol in (1e-6, 1e-8, 1e-10, 1e-12):
        motion = simulate(damped, 300.0, ([1.0], [0.0]), method="taylor", rtol=rtol)
        assert motion.energy.relative_residual < 30.0 * rtol


def test_a_smoothed_measured_law_has_a_series():
    """A law of points under tanh, which is compared with its series at speeds inside the step."""
    design, ways = drum(reading="consistent").replace({"friction": MEASURED}), {"contact": "tanh", "width": 0.02}
    one = simulate(design, 0.01, times=21, **ways)
    close = simulate(design, 0.01, times=21, method=Method("dormand-prince-8", rtol=1e-13), **ways)
    assert one.settings["tableau"] == "taylor"
    assert distance(one.q, close.q) < 1e-8


def test_a_contact_that_lifts_off_under_a_smoothed_sign():
    """A block that hops on a belt: where it is open it is pulled by nothing, and what that is worth is counted."""
    spring = Contact([2.0, 0.0], [0.3, 1.0], [0.0, 1.0], 0.5, 0.6, Coulomb(0.3), unilateral=True, normal=[-2.0, 0.0])
    block = System(np.eye(2), 0.02 * np.eye(2), [[4.0, 0.5], [0.5, 3.0]], [0.1, 0.0], (spring,))
    ways = {"contact": "tanh", "width": 0.05, "times": 101}
    one = simulate(block, 20.0, ([0.8, 0.0], [0.0, 0.0]), **ways)
    close = simulate(block, 20.0, ([0.8, 0.0], [0.0, 0.0]), method=Method("dormand-prince-8", rtol=1e-12), **ways)
    assert one.settings["tableau"] == "taylor"
    assert 0.05 < np.mean(one.mode == 2) < 0.95
    assert np.array_equal(one.mode, close.mode)
    assert distance(one.q, close.q) < 1e-7
    assert np.max(np.abs(one.energy.residual)) < 1e-7


@pytest.mark.parametrize("speed", [1.5, 1.7])
def test_a_law_of_two_points_is_left_and_entered_again(speed):
    """At rest the speed lies on the last point or beyond it: reversals lead back between both."""
    design = drum(reading="consistent").replace({"friction": Table([0.0, 1.5], [0.45, 0.1]), "sliding_speed": speed})
    one, close = (simulate(design, 0.01, times=21, method=m) for m in (None, Method("dormand-prince-8", rtol=1e-12)))
    assert one.settings["tableau"] == "taylor"
    assert len(one.event_time) == len(close.event_time)
    assert distance(one.q, close.q) < 1e-8
    many = simulate_ensemble(design, {"theta1": [0.6, design.theta1]}, 0.01, None, ())
    assert distance(many.q[1], close.q[-1]) < 1e-8


def test_sliding_that_stays_on_a_measured_point():
    """Round-off alone moves the speed across the point: two million steps if each such crossing ended one."""
    design = drum(reading="consistent").replace({"friction": MEASURED, "sliding_speed": 1.5})
    one = simulate(design, 0.02, start="sliding")
    assert one.settings["tableau"] == "taylor"
    assert one.outcome == "completed"
    assert one.steps < 2000
    assert distance(one.q[-1], one.q[0]) < 1e-9


def test_sliding_stays_on_a_kink_of_a_law():
    """The floor begins just at the sliding speed: round-off is no passage of it, where 2,000,000 steps were taken."""
    brake = DrumBrake(theta1=1.92, theta2=0.17, friction=LinearSlope(0.45, -0.5, floor=0.35), sliding_speed=0.2)
    assert simulate(brake, 0.01, start="sliding").steps < 500
    one, close = (simulate(brake, 0.01, times=21, method=m) for m in (None, Method("dormand-prince-8", rtol=1e-12)))
    assert distance(one.q, close.q) < 1e-8
