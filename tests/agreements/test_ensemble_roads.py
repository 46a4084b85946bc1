"""Lanes and the scalar march solve the same equation: one answer, whatever the place of a trajectory."""

import platform
import re

import numpy as np
import pytest

from squealbox import (
    Contact,
    Coulomb,
    DrumBrake,
    LinearSlope,
    Ramp,
    Stribeck,
    System,
    own_law,
    schedules,
    simulate,
    simulate_ensemble,
)
from squealbox.friction import Table
from squealbox.transient.lanes import kernel

OBSERVE = ("amplitude", "peak", "frequency", "energy", "sticking")


def drum(reading="consistent", static=0.3):
    """The drum of the paper."""
    return DrumBrake(friction=LinearSlope(static, -0.05), reading=reading)


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
    """A rejected step, the first aim, now and then a better one: not the bisection that an unknown slope invites."""
    many = simulate_ensemble(drum(), {"friction.static": [0.43, 0.44]}, 0.02, observe=OBSERVE, rtol=1e-9)
    assert np.all(many.events > 100)
    assert np.sum(many.tried - many.steps) < 2 * np.sum(many.events)


def test_short_reversals_between_the_ends_of_a_step_are_found():
    """Pressure centres where a contact stops for a hundredth of a step: none of these pairs of events is missed."""
    places = np.array([(0, 18), (1, 34), (5, 19), (7, 3), (18, 39), (43, 42), (55, 48)])
    theta1 = np.deg2rad(np.linspace(95.0, 175.0, 64))[places[:, 1]]
    theta2 = np.deg2rad(np.linspace(10.0, 50.0, 64))[places[:, 0]]
    many = simulate_ensemble(drum(static=0.44), {"theta1": theta1, "theta2": theta2}, 0.05, observe=OBSERVE)
    shortest = []
    for k in range(len(places)):
        one = simulate(drum(static=0.44).replace({"theta1": theta1[k], "theta2": theta2[k]}), 0.05, rtol=1e-11)
        shortest.append(np.min(np.diff(one.event_time)))
        assert many.events[k] == len(one.event_time)
        assert distance(many.q[k], one.q[-1], np.max(np.abs(one.q))) < 1e-5  # a missed pair costs ten times that
    assert np.min(shortest) < 1e-6 < 1e-2 * 2.0 * np.pi / np.sqrt(np.max(np.linalg.eigvals(_stiffness())))


def _stiffness():
    """M^-1 K of the drum, whose highest frequency bounds a step to a sixth of its period."""
    system = drum().system()
    return np.real(np.linalg.inv(system.M) @ system.K)


def test_another_friction_is_not_the_same_answer():
    many = simulate_ensemble(drum(), {"friction.static": [0.37, 0.38]}, 0.02, observe=OBSERVE, rtol=1e-9)
    assert distance(many.q[0], many.q[1], np.max(np.abs(many.q))) > 1e-3


@pytest.mark.parametrize("contact", ["raw", "tanh"])
def test_schemes_without_events_agree_with_single_runs(contact):
    frictions = np.array([0.1, 0.25])
    options = {"contact": contact, "rtol": 1e-6, "width": 0.02, "method": "bogacki-shampine"}
    many = simulate_ensemble(drum(), {"friction.static": frictions}, 0.01, observe=(), **options)
    for k, friction in enumerate(frictions):
        one = simulate(drum(static=friction), 0.01, **options)
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
    brake = drum(static=0.3).replace({"sliding_speed": Ramp(start=0.2, slope=-40.0)})
    many = simulate_ensemble(brake, {"friction.static": [0.2, 0.3]}, 0.01, observe=(), rtol=1e-9)
    for k, friction in enumerate((0.2, 0.3)):
        one = simulate(brake.replace({"friction.static": friction}), 0.01, rtol=1e-9)
        assert one.outcome == many.ended[k]
        assert distance(many.q[k], one.q[-1], np.max(np.abs(one.q))) < 1e-5


def test_samples_lie_on_the_single_run():
    instants = np.linspace(0.0, 0.01, 41)
    many = simulate_ensemble(drum(), {"friction.static": [0.3, 0.44]}, 0.01, observe=(), times=instants, rtol=1e-9)
    for k, friction in enumerate((0.3, 0.44)):
        one = simulate(drum(static=friction), 0.01, times=instants, rtol=1e-9)
        assert distance(many.sample_q[k], one.q, np.max(np.abs(one.q))) < 1e-5  # quintic between steps
        assert distance(many.sample_qd[k], one.qd, np.max(np.abs(one.qd))) < 1e-4


SPEEDS, MEASURED = np.linspace(0.0, 1.0, 9), 0.3 - 0.1 * np.linspace(0.0, 1.0, 9) ** 2
LAWS = {
    "measured points": Table(SPEEDS, MEASURED),
    "own text": own_law(
        "def mu(v, p):\n    return p[0] - np.float64(0.02) * v**3 + 0.01 * v**2\n", numbers=(0.3,), static=0.3
    ),
}


@pytest.mark.parametrize("law", LAWS)
def test_laws_of_many_numbers_and_of_plain_text_agree_with_single_runs(law):
    many = simulate_ensemble(DrumBrake(friction=LAWS[law]), {"theta1": [0.6, 0.65]}, 2e-3, observe=(), rtol=1e-9)
    one = simulate(DrumBrake(friction=LAWS[law], theta1=0.65), 2e-3, rtol=1e-9)
    assert many.events[1] == len(one.event_time)
    assert distance(many.q[1], one.q[-1], np.max(np.abs(one.q))) < 1e-6
    assert distance(many.q[0], one.q[-1], np.max(np.abs(one.q))) > 1e-3


def test_a_schedule_of_measured_points_agrees_with_single_runs():
    load = schedules.Table([0.0, 1e-3, 2e-3], [500.0, 900.0, 700.0])
    brakes = [drum(static=mu).system() for mu in (0.2, 0.25)]
    systems = [s.replace({"contacts": tuple(c.replace({"N0": load}) for c in s.contacts)}) for s in brakes]
    many = simulate_ensemble(systems, None, 2e-3, observe=(), rtol=1e-9)
    one = simulate(systems[1], 2e-3, rtol=1e-9)
    assert distance(many.q[1], one.q[-1], np.max(np.abs(one.q))) < 1e-6
    assert distance(many.q[0], one.q[-1], np.max(np.abs(one.q))) > 1e-3


@pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="reads the assembly of this family")
def test_the_step_is_packed(tmp_path, monkeypatch):
    """Arithmetic of the step in the assembly of a kernel: whole registers and nothing else."""
    monkeypatch.setenv("SQUEALBOX_CACHE", str(tmp_path))
    made, of_shape = [], kernel.lane_kernel.__wrapped__

    def fresh(shape):
        made.append(of_shape(shape))
        return made[0]

    monkeypatch.setattr(kernel, "lane_kernel", fresh)
    raw = {"contact": "raw", "method": "bogacki-shampine", "rtol": 1e-3, "observe": ()}
    simulate_ensemble(drum(), {"friction.static": [0.1, 0.2]}, 1e-4, **raw)
    text = made[0].assembly()
    step = re.search(r"^\w*traced_trial:\n(.*?)\n\.Lfunc_end", text, re.MULTILINE | re.DOTALL).group(1)
    packed, scalar = (re.findall(rf"\tv?(?:add|sub|mul|div|fn?m\w+){kind}\t", step) for kind in ("pd", "sd"))
    assert len(packed) > 100 > len(scalar) == 0  # 150 in registers of 512 bits, some 300 in those of 256
    put_by = re.findall(r"\tvmov([au])p[ds]\t(?=[^\n]*[yz]mm)[^\n]*\(%rsp\)", step)
    assert set(put_by) == {"a"}  # aligned: no register is put by across two lines of the cache


def test_a_kernel_is_another_file_when_what_writes_it_changes():
    """The modules a kernel imports write instructions that its text does not show; their digest is in the text."""
    imported = re.findall(r"^from squealbox\.transient\.lanes\.(\w+) import", kernel.HEAD + kernel.SERIES, re.MULTILINE)
    assert {f"{name}.py" for name in imported} == set(kernel.WRITERS)
    assert kernel.digest(kernel.WRITERS) != kernel.digest(kernel.WRITERS[:1])
