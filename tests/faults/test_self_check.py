"""No run says `completed` over a wrong number: engines made blind on purpose are found out by their own check."""

from dataclasses import replace

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
    Sinusoid,
    System,
    simulate,
    simulate_ensemble,
)
from squealbox.transient import packing
from squealbox.transient.lanes import single
from squealbox.transient.self_check import checked


@pytest.fixture
def blind(monkeypatch):
    """Steps and searches that do not see what moves by itself."""

    def forget():
        packing._packed.cache_clear()
        single.KEPT.clear()
        single.NUMBERS.clear()

    monkeypatch.setattr(packing, "schedule_frequency", lambda system: np.zeros(()))
    forget()
    yield
    forget()


def shaken(swing=2.0, rate=20.0):
    """A block on a belt whose speed swings twenty times as fast as the block: 318 events in 50 s."""
    belt = Sinusoid(0.5, swing, rate / (2.0 * np.pi), 0.5 * np.pi)
    return System([[1.0]], [[0.0]], [[1.0]], 0.0, (Contact([0.0], [1.0], [1.0], 1.0, belt, Coulomb(0.4)),))


def test_events_passed_over_are_found_out(blind):
    motion = simulate(shaken(4.0, 18.0), 50.0)
    assert motion.outcome == "missed_event"
    assert "half the search interval" in motion.outcome.message
    assert len(motion.event_time) < 100


def test_the_same_with_open_eyes():
    motion = simulate(shaken(), 50.0)
    assert (motion.outcome, len(motion.event_time)) == ("completed", 318)


def test_an_audit_that_does_not_close_is_no_completed_run():
    """A row of output in which friction is said to have done half its work."""
    motion = simulate(DrumBrake(friction=LinearSlope(0.3, -0.05)), 0.01, times=2)
    size, m = motion.system.size, len(motion.system.contacts)
    rows = np.zeros((2, 6 + 2 * size + 5 * m))
    rows[:, 0], rows[:, 1 : 1 + size], rows[:, 1 + size : 1 + 2 * size] = motion.t, motion.q, motion.qd
    rows[:, 1 + 2 * size : 1 + 2 * size + m] = motion.work_friction
    at = 1 + 2 * size + m
    rows[:, at], rows[:, at + 1], rows[:, at + 2] = motion.work_load, motion.work_circulation, motion.work_dissipated
    assert checked(motion, *rows, size) is motion
    rows[:, 1 + 2 * size : 1 + 2 * size + m] *= 0.5
    false = checked(replace(motion, work_friction=0.5 * motion.work_friction), *rows, size)
    assert false.outcome == "energy_unbalanced"
    assert false.outcome.evidence["residual"] > 0.01


@pytest.mark.parametrize("first", [0.0, 0.004])
def test_the_audit_begins_where_the_record_does(first):
    drum = DrumBrake(friction=LinearSlope(0.3, -0.05))
    motion = simulate(drum, 0.01, times=np.linspace(first, 0.01, 5))
    assert motion.outcome == "completed"
    assert motion.energy.relative_residual < 1e-8


def test_one_in_a_thousand_is_run_again(blind):
    starts = np.linspace(0.0, 0.1, 1000)[:, None], np.zeros((1000, 1))
    many = simulate_ensemble(shaken(0.52, 60.0), duration=15.0, start=starts, method="dormand-prince-8", rtol=1e-2)
    assert many.ended[500] == "not_confirmed"
    assert np.sum(many.ended == "not_confirmed") == 1


def test_and_confirmed_with_open_eyes():
    starts = np.linspace(0.0, 0.1, 1000)[:, None], np.zeros((1000, 1))
    assert simulate_ensemble(shaken(), duration=15.0, start=starts).outcome == "completed"


@pytest.mark.parametrize("times", [None, [20.0], [5.0, 10.0]])
@pytest.mark.parametrize("contact", ["exact", "tanh"])
def test_a_wrong_motion_is_found_out_whatever_instants_are_kept(times, contact):
    """A free oscillation far below the absolute tolerance asked for: 20 rad later it is off by half its swing."""
    free, start = System([[1.0]], [[0.0]], [[1.0]]), ([1e-9], [0.0])
    motion = simulate(free, 20.0, start, times, "bogacki-shampine", contact, atol=1e-9)
    assert motion.outcome == "energy_unbalanced"
    assert simulate(free, 20.0, start, times, "bogacki-shampine", contact).outcome == "completed"


@pytest.mark.parametrize("times", [[0.0, 0.003], [0.003], [0.0, 0.006]])
@pytest.mark.parametrize("method", [None, Method("dormand-prince"), Method("taylor", most_steps=40)])
def test_a_motion_goes_on_from_where_it_ended_whatever_instants_were_kept(times, method):
    drum = DrumBrake(friction=LinearSlope(0.45, -0.05))
    first = simulate(drum, 0.006, times=times, method=method)
    reached = first.outcome.evidence.get("time", 0.006)
    assert (reached < 0.006) == (first.outcome != "completed")
    rest = simulate(drum, 0.01 - reached, start=first, times=[0.01 - reached])
    assert rest.q[-1] == pytest.approx(simulate(drum, 0.01, times=[0.01]).q[-1], rel=1e-4)


def test_time_stepping_goes_on_from_where_it_ended_as_well():
    block, start = System([[1.0]], [[0.1]], [[1.0]]), ([1.0], [0.0])
    first = simulate(block, 2.0, start, [0.0, 0.5], contact="time-stepping", step=1e-3)
    whole = simulate(block, 4.0, start, [4.0], contact="time-stepping", step=1e-3)
    rest = simulate(block, 2.0, first, [2.0], contact="time-stepping", step=1e-3)
    assert rest.q[-1] == pytest.approx(whole.q[-1], abs=1e-9)


def test_no_instant_at_all_is_one_sentence():
    for function in (simulate, simulate_ensemble):
        with pytest.raises(ParameterError, match="one or more increasing instants"):
            function(MassOnBelt(), duration=1.0, times=[])
