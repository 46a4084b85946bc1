"""Ensembles: senseless input gets one sentence, a lane that fails leaves the others alone, and Ctrl-C keeps results."""

import json
import os
import signal
import subprocess
import sys
import time

import numpy as np
import pytest

from squealbox import Coulomb, DrumBrake, Method, ParameterError, Result, own_law, simulate_ensemble
from squealbox.system import InvalidSystem
from squealbox.transient import Observer
from squealbox.transient.lanes.batch import first_of, stacked

FRICTIONS = np.linspace(0.1, 0.44, 40)
SHORT = 2e-3


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"parameters": {"friction.statik": [0.1, 0.2]}}, "statik"),
        ({"parameters": {"theta9": [0.1]}}, "theta9"),
        ({"parameters": {"friction.static": [0.1, np.nan]}}, "static"),
        ({"parameters": {"friction.static": [0.1, 0.2], "theta1": [0.1, 0.2, 0.3]}}, "broadcast"),
        ({"observe": ("amplitude", "loudness")}, "loudness"),
        ({"observe": ("peak", "peak")}, "different names"),
        ({"start": ([np.nan, 0.0], [0.0, 0.0])}, "finite displacements"),
        ({"start": (np.full((2, 2), np.inf), np.zeros(2))}, "finite displacements"),
        ({"start": (np.zeros(3), np.zeros(3))}, "of shape"),
        ({"times": [0.0, 1.0]}, "within"),
        ({"threads": 0}, "threads"),
        ({"duration": -1.0}, "duration"),
        ({"contact": "sticky"}, "contact"),
        ({"method": "euler"}, "euler"),
    ],
)
def test_senseless_input_gets_one_sentence(change, said):
    given = {"parameters": {"friction.static": [0.1, 0.2]}, "duration": SHORT} | change
    with pytest.raises(ParameterError) as caught:
        simulate_ensemble(DrumBrake(), **given)
    assert said in str(caught.value)


def test_of_several_systems_none_is_varied():
    with pytest.raises(ParameterError, match="one design or system"):
        simulate_ensemble([DrumBrake().system()], {"friction.static": [0.1]}, SHORT)


def test_a_lane_at_its_limit_leaves_the_others_untouched():
    whole = simulate_ensemble(DrumBrake(), {"friction.static": FRICTIONS}, SHORT)
    most = int(np.median(whole.tried))
    cut = simulate_ensemble(DrumBrake(), {"friction.static": FRICTIONS}, SHORT, Method("taylor", most_steps=most))
    reached = whole.tried <= most
    assert 0 < np.sum(reached) < len(FRICTIONS)
    assert np.all(cut.ended[reached] == "completed")
    assert np.all(cut.ended[~reached] == "step_limit")
    assert np.array_equal(cut.q[reached], whole.q[reached])
    assert np.array_equal(cut["amplitude"][reached], whole["amplitude"][reached])
    assert np.all(cut.time[cut.ended == "step_limit"] < SHORT)
    assert cut.outcome == "some_failed"
    assert cut.outcome.evidence["ended"]["step_limit"] == np.sum(cut.ended == "step_limit")


def test_an_ensemble_survives_its_file(tmp_path):
    parameters = {"friction.static": [0.1, 0.2, 0.3], "theta1": [0.5, 0.6]}
    kept = simulate_ensemble(DrumBrake(), parameters, SHORT, grid=True)
    loaded = Result.load(kept.save(tmp_path / "ensemble.nc"))
    assert type(loaded) is type(kept)
    assert loaded.shape == (3, 2)
    assert (loaded.outcome, loaded.settings, loaded.inputs) == (kept.outcome, kept.settings, kept.inputs)
    for name in ("ended", "time", "q", "qd", "steps", "tried", "events", "sample_time", "sample_q"):
        assert np.array_equal(getattr(loaded, name), getattr(kept, name))
    assert np.array_equal(loaded["amplitude"], kept["amplitude"])
    assert np.array_equal(loaded.parameters["theta1"], kept.parameters["theta1"])
    assert loaded.ended[0, 0] == "completed"
    with pytest.raises(KeyError, match="was not observed"):
        loaded["loudness"]


def test_laws_of_a_sequence_may_differ_in_numbers_only():
    own = [own_law("def mu(v, p): return p[1] + 0.0 * v", numbers=(x,), static=0.4) for x in (0.2, 0.3)]
    assert stacked([DrumBrake(friction=Coulomb(x, 0.2)) for x in (0.3, 0.4)]).contacts[0].law.static.tolist() == [
        0.3,
        0.4,
    ]
    with pytest.raises(InvalidSystem, match="may differ in numbers"):
        stacked([DrumBrake(friction=law) for law in own])
    angles = DrumBrake(friction=own[0], theta1=np.array([0.5, 0.6])).system()
    assert first_of(angles).contacts[0].law.coefficients() == own[0].coefficients()


def path_update(memory, p, before, after):
    """Length of the way, by the trapezium of |q'|, and the count of steps at which |q'| exceeds p[1]."""
    h = after.t - before.t
    fast = np.where(abs(after.qd) > p[1], 1.0, 0.0)
    return (memory[0] + 0.5 * h * (abs(before.qd) + abs(after.qd)), memory[1] + fast)


def shares(memory):
    """Way, and fast steps."""
    return memory


def test_an_observer_of_ones_own_sees_every_step():
    brake = {"friction.static": FRICTIONS[:3]}
    instants = np.linspace(0.0, SHORT, 20_001)
    own = (Observer("path", path_update, (0.0, 0.0), "dof", shares, settings=(0.0,)),)
    seen = simulate_ensemble(DrumBrake(), brake, SHORT, "dormand-prince-8", own, times=instants, rtol=1e-7)
    assert seen["path"].shape == (3, 2, 2)
    way = np.sum(np.abs(np.diff(seen.sample_q, axis=1)), axis=1)
    assert seen["path"][..., 0] == pytest.approx(way, rel=0.05)  # a trapezium over steps of up to a sixth of a period
    assert np.all(seen["path"][..., 1] == seen.steps[:, None])


def test_an_observer_whose_text_cannot_be_read_is_refused():
    with pytest.raises(InvalidSystem, match="whose source can be read"):
        simulate_ensemble(DrumBrake(), {"friction.static": [0.1]}, SHORT, observe=Observer("own", abs, (0.0,)))


@pytest.mark.parametrize(
    ("body", "said"),
    [
        ("if v > 1.0:\n        return p[0]\n    return p[1]", "numpy.where"),
        ("return p[0] - 0.01 * v**0.5", "power of 0.5"),
        ("return p[0] - 0.01 * np.sinh(v)", "numpy.sinh"),
    ],
)
def test_a_law_that_lanes_cannot_run_is_refused_in_one_sentence(body, said):
    law = own_law(f"def mu(v, p):\n    {body}\n", numbers=(0.2,), static=0.3)
    with pytest.raises(InvalidSystem, match=said):
        simulate_ensemble(DrumBrake(friction=law), {"theta1": [0.6, 0.61]}, SHORT)


@pytest.mark.parametrize("change", [{"of": "brake"}, {"last": 0.0}])
def test_an_observer_of_nothing_is_refused(change):
    with pytest.raises(ParameterError):
        Observer("own", path_update, (0.0,), **change)


CHILD = """
import json, signal, sys, time
import numpy as np
from squealbox import DrumBrake, simulate_ensemble

frictions = np.linspace(0.1, 0.44, 2000)
simulate_ensemble(DrumBrake(), {"friction.static": frictions[:2]}, 1e-3)  # the kernel is there
print("ready", flush=True)
found = simulate_ensemble(DrumBrake(), {"friction.static": frictions}, 50.0)
told = {"outcome": found.outcome, "at": time.time(), "not_run": int(np.sum(found.ended == "not_run"))}
print(json.dumps(told), flush=True)
"""


@pytest.mark.skipif(os.name != "posix", reason="sends SIGINT")
def test_ctrl_c_returns_what_is_done_at_once():
    child = subprocess.Popen([sys.executable, "-c", CHILD], stdout=subprocess.PIPE, text=True)
    try:
        assert child.stdout.readline().strip() == "ready"
        time.sleep(1.0)
        sent = time.time()
        child.send_signal(signal.SIGINT)
        told = json.loads(child.communicate(timeout=20)[0])
    finally:
        child.kill()
    assert told["outcome"] == "interrupted"
    assert told["not_run"] > 0
    assert told["at"] - sent < 10.0  # hours, were it not stopped
