"""V(t), N0(t) and f(t) quicker than the system: every event is found, whatever the frequency, in every road.

Right values: closed forms, roots of equations in one unknown, and integrators of others at rtol 1e-12.
"""

import numpy as np
import pytest
from scipy.optimize import brentq

from slow_reference import slow
from small_systems import METHODS, block_on_belt
from squealbox import (
    Contact,
    Coulomb,
    DrumBrake,
    LinearSlope,
    MassOnBelt,
    Ramp,
    Sinusoid,
    Stribeck,
    System,
    schedules,
    simulate,
    simulate_ensemble,
)
from squealbox.parameters import ParameterError
from squealbox.schedules import Constant, Schedule
from squealbox.system import InvalidSystem

BOX = block_on_belt(Coulomb(0.4), 1.0, normal=Sinusoid(10.0, 9.0, 100.0))
FIRST = 0.4073979497744774  # root of 0.4 (10 + 9 sin(200 pi t)) = t


def dithered(width, angular_frequency):
    """V = 0.5 + w cos(Om t) under the block m = k = N = 1, mu = 0.4."""
    return block_on_belt(Coulomb(0.4), Sinusoid(0.5, width, angular_frequency / (2.0 * np.pi), np.pi / 2.0))


def test_box_pulled_under_a_swinging_weight():
    root = brentq(lambda t: 0.4 * (10.0 + 9.0 * np.sin(200.0 * np.pi * t)) - t, 0.407, 0.4075, xtol=1e-15)
    assert pytest.approx(root, abs=1e-13) == FIRST
    for method in METHODS[1:]:
        motion = simulate(BOX, 3.0, ([0.0], [1.0]), method=method)
        assert motion.outcome == "completed"
        assert motion.event_time[0] == pytest.approx(FIRST, abs=1e-9)
        assert len(motion.event_time) == 519
        assert motion.q[-1, 0] == pytest.approx(2.99788422, abs=1e-7)


@pytest.mark.parametrize(
    ("method", "rtol", "error"),
    [("dormand-prince-8", 1e-10, 1e-7), ("taylor", 1e-10, 1e-7), ("dormand-prince", 1e-6, 1e-5),
     ("bogacki-shampine", 1e-6, 1e-4)],
)  # fmt: skip
def test_box_in_an_ensemble(method, rtol, error):
    found = simulate_ensemble(BOX, duration=3.0, start=([0.0], [1.0]), method=method, rtol=rtol)
    assert found.ended == "completed"
    assert found.events == 519
    assert found.q[0] == pytest.approx(2.99788422, abs=error)


@pytest.mark.parametrize("method", ["dormand-prince-8", "dormand-prince", "bogacki-shampine"])
def test_a_belt_that_is_jerked_away_under_a_block_at_rest_on_it(method):
    """m = k = N = 1, mu 0.4, carried at 0.2 m/s until V turns at 1 s to fall by 1/s: q(1) = 0.2, let go at once."""
    belt = schedules.Table([0.0, 1.0, 3.0], [0.2, 0.2, -1.8])
    start = ([0.0], [0.2])
    motion = simulate(block_on_belt(Coulomb(0.4), belt), 2.0, start, method=method, rtol=1e-9)
    found = simulate_ensemble(block_on_belt(Coulomb(0.4), belt), duration=2.0, start=start, method=method, rtol=1e-9)
    assert motion.outcome == found.ended == "completed"
    assert motion.event_time[0] == 1.0
    assert found.events == len(motion.event_time)
    # q'' = -q - 0.4 from q = 0.2, q' = 0.2 on, until the belt is overtaken
    t = motion.t[(motion.t >= 1.0) & (motion.t <= 1.0 + 1e-2)] - 1.0
    closed = 0.6 * np.cos(t) + 0.2 * np.sin(t) - 0.4
    assert motion.q[(motion.t >= 1.0) & (motion.t <= 1.0 + 1e-2), 0] == pytest.approx(closed, abs=1e-8)
    assert found.q[0] == pytest.approx(motion.q[-1, 0], abs=1e-6)


@pytest.mark.parametrize("method", [None, "dormand-prince-8", "dormand-prince", "bogacki-shampine"])
def test_a_belt_that_stops_lets_go_what_it_carried_for_a_moment(method):
    """V = 0.3 (1 - t) stops at 1 s with q = 1/2: the force held jumps from 0.2 to 0.5 N, above 0.4 N, N = 1 + 10 s.

    Then q = 0.4 + 4 s + 0.1 cos(s) - 4 sin(s) until q' = 0 again, after 0.05 s: a step may well end behind it.
    """
    system = block_on_belt(Coulomb(0.4), Ramp(0.3, -0.3), normal=Ramp(1.0, 10.0, stop=5.0, begin=1.0))
    start = ([0.35], [0.3])
    motion = simulate(system, 3.0, start, method=method, rtol=1e-10)
    found = simulate_ensemble(system, duration=3.0, start=start, method=method, rtol=1e-10)
    again = brentq(lambda s: 4.0 - 0.1 * np.sin(s) - 4.0 * np.cos(s), 0.01, 0.1)
    assert motion.event_time == pytest.approx([1.0, 1.0 + again], abs=1e-8)
    assert motion.event_mode.tolist() == [1, 0]
    end = 0.4 + 4.0 * again + 0.1 * np.cos(again) - 4.0 * np.sin(again)
    assert motion.q[-1, 0] == pytest.approx(end, abs=1e-9)
    assert found.events == 2
    assert found.q[0] == pytest.approx(end, abs=1e-8)


def test_ramps_differ_in_an_ensemble():
    brake = MassOnBelt(sliding_speed=Ramp(1.0, -0.2, 0.1), friction=Stribeck(0.4, 0.2, 0.3))
    varied = {"slope": [-0.1, -0.4], "start": [0.5, 2.0], "begin": [0.0, 1.0], "stop": [0.0, 0.3]}
    for name, values in varied.items():
        found = simulate_ensemble(brake, {f"sliding_speed.{name}": values}, duration=8.0, rtol=1e-10)
        alone = [simulate(brake.replace({f"sliding_speed.{name}": value}), 8.0, rtol=1e-12) for value in values]
        assert found.events.tolist() == [len(each.event_time) for each in alone]
        assert found.q[:, 0] == pytest.approx([each.q[-1, 0] for each in alone], abs=1e-7)


def test_box_by_time_stepping_at_its_usual_step():
    motion = simulate(BOX, 3.0, ([0.0], [1.0]), contact="time-stepping")
    assert motion.event_time[0] == pytest.approx(FIRST, abs=1e-3)
    assert len(motion.event_time) == 519


@pytest.mark.parametrize(
    ("width", "angular_frequency", "events", "end"), [(2.0, 20.0, 318, 0.06148694), (2.0, 100.0, 1592, 0.06215440)]
)
def test_dither_counts_every_reversal(width, angular_frequency, events, end):
    """From rest; counts and ends of the slow integrator of these tests."""
    system = dithered(width, angular_frequency)
    motion = simulate(system, 50.0)
    assert (motion.outcome, len(motion.event_time)) == ("completed", events)
    assert motion.q[-1, 0] == pytest.approx(end, abs=1e-6)
    for method in ("dormand-prince-8", "taylor"):
        found = simulate_ensemble(system, duration=50.0, method=method, rtol=1e-10)
        assert (found.ended, found.events) == ("completed", events)
        assert found.q[0] == pytest.approx(end, abs=1e-6)


def test_no_reversal_where_none_is_possible():
    """Far below V the belt never turns under the block once it slides: the count of a slow integrator."""
    system = dithered(0.3, 20.0)
    truth = slow(system, 8.0)
    for found in (simulate(system, 8.0), simulate(system, 8.0, method="tsitouras")):
        assert len(found.event_time) == len(truth.events)
        assert found.q[-1] == pytest.approx(truth.q, abs=1e-8)


def test_stick_slip_of_another_program():
    """PathSim's example, a block on a belt that goes to and fro."""
    system = block_on_belt(
        Coulomb(1.5), Sinusoid(0.0, 3.0, 0.02), mass=20.0, damping=10.0, stiffness=70.0, normal=196.2
    )
    expected = [4.6006993, 24.9729133, 31.7186633, 50.0444106, 56.7238211, 75.0440537, 81.7238612]
    motion = simulate(system, 100.0)
    assert motion.event_time == pytest.approx(expected, abs=1e-6)
    assert motion.q[-1, 0] == pytest.approx(-4.21494135, abs=1e-7)


@pytest.mark.parametrize("share", [0.5, 0.7, 0.9])
def test_block_on_a_shaken_table(share):
    """It slips from th1 to th2: cos th1 = r, sin th2 - sin th1 = r (th2 - th1); half a period later again."""
    leaves = -np.arccos(share)
    back = brentq(lambda x: np.sin(x) - np.sin(leaves) - share * (x - leaves), leaves + 0.1, leaves + 3.0 * np.pi)
    motion = simulate(block_on_belt(Coulomb(share), Sinusoid(0.0, 1.0, 0.5 / np.pi), stiffness=0.0), 40.0)
    assert motion.outcome == "completed"
    stick, slip = motion.event_time[motion.event_mode == 0][-1], motion.event_time[motion.event_mode != 0]
    if back < leaves + np.pi:  # otherwise it never sticks again
        slip = slip[slip < stick][-1]
        assert stick - slip == pytest.approx(back - leaves, abs=1e-8)


def test_plain_parameters_never_end_early():
    rng = np.random.default_rng(1)
    for _ in range(60):
        speed = Sinusoid(rng.choice([0.0, 0.2, 0.5]), rng.uniform(0.1, 3.0), 10.0 ** rng.uniform(-2.0, 1.0))
        law, damping = Coulomb(rng.choice([0.1, 0.3, 0.7])), rng.choice([0.0, 0.1])
        assert simulate(block_on_belt(law, speed, damping=damping), 100.0).outcome == "completed"


@pytest.mark.parametrize("frequency", [2e4, 5e4])
def test_dithered_drum(frequency):
    """Two methods of different order agree on every event."""
    brake = DrumBrake(friction=LinearSlope(0.44, -0.05), sliding_speed=Sinusoid(0.2, 0.21, frequency, np.pi / 2.0))
    one, other = (simulate(brake, 0.004, method=m, rtol=1e-10) for m in ("dormand-prince-8", "tsitouras"))
    assert one.outcome == other.outcome == "completed"
    assert len(one.event_time) == len(other.event_time)
    assert one.q[-1] == pytest.approx(other.q[-1], rel=1e-7)


def test_ramp_from_zero_runs_and_one_that_leads_away_is_refused():
    assert float(Ramp(0.0, 40.0).value(2.0)) == 80.0
    pulled = block_on_belt(
        Coulomb(0.3, 0.2), 0.0, mass=10.0, stiffness=4000.0, normal=98.1, load=Ramp(0.0, 40.0) * [1.0]
    )
    assert simulate(pulled, 3.0).event_time[0] == pytest.approx(0.73575, abs=1e-9)
    assert float(Ramp(1.0, 1.0, stop=None).value(2.0)) == 3.0
    with pytest.raises(ParameterError, match="towards stop"):
        Ramp(1.0, 1.0)
    with pytest.raises(ParameterError, match="towards stop"):
        Ramp(-1.0, -1.0, stop=2.0)


def test_a_block_without_a_spring_takes_long_steps():
    """Friction 1e-7 N on 1 kg: the belt's 1 m/s is reached after 1e7 s, in a few steps."""
    motion = simulate(block_on_belt(Coulomb(1e-7), 1.0, stiffness=0.0), 3e7)
    assert (motion.outcome, len(motion.event_time)) == ("completed", 1)
    assert motion.event_time[0] == pytest.approx(1e7, rel=1e-9)
    assert motion.steps < 200
    found = simulate_ensemble(block_on_belt(Coulomb(1e-7), 1.0, stiffness=0.0), duration=3e7)
    assert (found.ended, found.events) == ("completed", 1)


def test_samples_are_as_accurate_as_the_end():
    system = System([[1.0]], [[0.0]], [[1.0]], 0.0)
    times = np.linspace(0.0, 20.0, 301)
    for method in ("dormand-prince-8", "taylor"):
        found = simulate_ensemble(system, duration=20.0, start=([1.0], [0.0]), times=times, method=method, rtol=1e-11)
        error = np.abs(found.sample_q[..., 0] - np.cos(times))
        assert np.max(error) < 4.0 * np.abs(found.q[0] - np.cos(20.0)) + 1e-11
    stuck = block_on_belt(Coulomb(0.4, 0.25), 0.1)
    found = simulate_ensemble(stuck, duration=20.0, times=times, method="dormand-prince-8", rtol=1e-11)
    reference = simulate(stuck, 20.0, times=times, rtol=1e-13)
    assert found.sample_q == pytest.approx(reference.q, abs=1e-9)


class Own(Schedule):
    """A schedule no compiler knows."""

    def value(self, time):
        return 0.1 + 0.0 * np.asarray(time)

    def coefficients(self):
        return ()


def test_what_cannot_be_compiled_is_told_in_a_sentence():
    for system in (block_on_belt(Coulomb(0.4), Own()), block_on_belt(Coulomb(0.4), 0.1, load=Own() * [1.0])):
        for run in (simulate, lambda s, d: simulate_ensemble(s, duration=d)):
            with pytest.raises(InvalidSystem, match="expected one that can be compiled"):
                run(system, 1.0)
    with pytest.raises(ParameterError, match=r"Own\.rate_formula.*expected a function of \(t, p\), or a method rate"):
        Own().rate(0.0)
    with pytest.raises(InvalidSystem, match="load = .*: expected numbers .* or a schedule"):
        System([[1.0]], [[0.0]], [[1.0]], lambda t: t)
    assert Constant(1.0).angular_frequency() == 0.0
    with pytest.raises(InvalidSystem, match="V: .*; what varies in time is a schedule"):
        Contact(n=[0.0], d=[1.0], t=[1.0], N0=1.0, V=np.sin, law=Coulomb(0.3))
