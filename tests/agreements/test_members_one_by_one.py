"""Ensembles of what lanes do not carry together: each member is a motion of `simulate`, seen as lanes see it."""

import numpy as np
import pytest

from squealbox import (
    PID,
    Contact,
    Controlled,
    Coulomb,
    Hyperbolic,
    LinearSlope,
    MassOnBelt,
    System,
    simulate,
    simulate_ensemble,
)
from squealbox.system import InvalidSystem

BELT = MassOnBelt(c=0.05, friction=Coulomb(0.4, 0.25))
START = ([0.6], [0.0])
SEEN = ("amplitude", "peak", "frequency", "growth_rate", "settled", "energy", "sticking", "reversed", "poincare")


def test_observers_see_what_lanes_see():
    """A loop that does next to nothing is run member by member: its nine observers against those of the lanes."""
    over, times = {"friction.static": [0.4, 0.5]}, np.linspace(0.0, 12.0, 5)
    lanes = simulate_ensemble(BELT, over, 12.0, observe=SEEN, start=START, times=times)
    brake = Controlled(BELT, PID(on="x", derivative=1e-13, sampling=2.3))
    done = []
    found = simulate_ensemble(
        brake, over, 12.0, observe=SEEN, start=START, times=times, progress=lambda *given: done.append(given[:2])
    )
    assert found.settings["one_by_one"]
    assert not lanes.settings["one_by_one"]
    assert done == [(1, 2), (2, 2)]
    for name in SEEN:
        assert found[name] == pytest.approx(lanes[name], abs=1e-7, nan_ok=True), name
    assert found["sticking"] == pytest.approx(lanes["sticking"], abs=1e-12)
    assert np.array_equal(found.events, lanes.events)
    assert np.max(np.abs(found.sample_q - lanes.sample_q)) < 1e-11
    twin = simulate_ensemble(brake.replace({"loops.0.derivative": 0.1}), over, 12.0, observe=SEEN, start=START)
    assert np.max(np.abs(twin["amplitude"] - lanes["amplitude"])) > 1e-3


@pytest.mark.parametrize(("name", "loop", "values"), [
    ("loops.0.delay", PID(on="x", derivative=0.2, delay=0.1), [0.0, 0.15]),
    ("loops.0.sampling", PID(on="x", derivative=0.2, sampling=2.0), [2.0, 3.0]),
    ("loops.0.limit", PID(on="x", proportional=0.3, limit=0.1), [0.01, 0.1]),
])  # fmt: skip
def test_each_member_is_its_own_motion(name, loop, values):
    brake = Controlled(BELT, loop)
    many = simulate_ensemble(brake, {name: values}, 4.0, start=START)
    for i, value in enumerate(values):
        one = simulate(brake.replace({name: value}), 4.0, START)
        assert many.ended[i] == one.outcome
        assert many.q[i] == pytest.approx(one.q[-1], abs=1e-7)
    assert abs(many.q[0, 0] - many.q[1, 0]) > 1e-4


def test_axes_of_a_system_and_designs_of_other_laws():
    gains = np.array([0.1, 0.3])
    system = System([[1.0]], [[0.0]], [[1.0]], loops=(PID(on="q1", derivative=gains, sampling=2.0),))
    many = simulate_ensemble(system, None, 4.0, start=([[1.0], [0.5]], [[0.0], [0.0]]))
    for i, (gain, begin) in enumerate(zip(gains, (1.0, 0.5), strict=True)):
        alone = system.replace(loops=(PID(on="q1", derivative=float(gain), sampling=2.0),))
        assert many.q[i] == pytest.approx(simulate(alone, 4.0, ([begin], [0.0])).q[-1], abs=1e-9)
    laws = (LinearSlope(0.4, -0.05), Hyperbolic(0.4, 1.0))
    mixed = simulate_ensemble([BELT.replace(friction=law) for law in laws], None, 4.0, start=START)
    for i, law in enumerate(laws):
        assert mixed.q[i] == pytest.approx(simulate(BELT.replace(friction=law), 4.0, START).q[-1], abs=1e-7)


def test_members_of_other_sizes_are_no_ensemble():
    two = System(np.eye(2), np.zeros((2, 2)), np.eye(2))
    with pytest.raises(InvalidSystem, match="other degrees of freedom"):
        simulate_ensemble([two, System([[1.0]], [[0.0]], [[1.0]])], None, 1.0)


def test_a_brake_too_large_for_a_kernel_runs_member_by_member():
    """60 coordinates and 100 contacts: the text of a kernel would spell out 20,000 products and compile for minutes."""
    random, rate = np.random.default_rng(1), 2.0 * np.pi * np.linspace(500.0, 8000.0, 60)
    n, t = random.standard_normal((100, 60)), 0.3 * random.standard_normal((100, 60))
    contacts = [
        Contact(n=1e4 * a, d=b, t=b, N0=50.0, V=2.0, law=Coulomb(0.4), unilateral=True, normal=a)
        for a, b in zip(n, t, strict=True)
    ]
    brake = System(np.eye(60), np.diag(0.006 * rate), np.diag(rate**2) + 1e4 * n.T @ n, 0.0, contacts)
    found = simulate_ensemble(brake, {"friction.static": [0.3, 0.4]}, 2e-5)
    assert found.settings["one_by_one"]
    alone = simulate(brake.replace({"friction.static": 0.3}), 2e-5)
    assert np.max(np.abs(found.q[0] - alone.q[-1])) < 1e-9 * np.max(np.abs(alone.q[-1]))
