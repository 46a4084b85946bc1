"""Two roads, one answer: loops in time against their poles and multipliers."""

import numpy as np
import pytest

from squealbox import (
    PID,
    ActiveForce,
    Controlled,
    Coulomb,
    DrumBrake,
    LinearSlope,
    MassOnBelt,
    ParameterError,
    System,
    closed_loop,
    complex_modes,
    critical_value,
    simulate,
    stability_map,
)
from squealbox.control import run_loops
from squealbox.control.sampled import held


def block(c, loop):
    return System([[1.0]], [[c]], [[1.0]], loops=(loop,))


@pytest.mark.parametrize("amplitude", [1e-9, 1.0])
def test_a_sampled_run_without_sliding_has_one_tolerance(amplitude):
    """That of the whole motion: what the samples push with neither sets it nor turns it negative."""
    mass = System([[0.01]], [[0.5]], [[4e4]],
                  loops=(PID(on="q1", proportional=2e3, derivative=3.0, sampling=3e3, computing=0.4),))  # fmt: skip
    matrix, _ = held(closed_loop(mass).plant)
    state = np.zeros(len(matrix))
    state[0] = amplitude
    run = simulate(mass, 0.02, ([amplitude], [0.0]))
    assert run.settings["atol"] == pytest.approx([1e-13 * amplitude, 1e-13 * amplitude * 2e3])
    assert run.q[-1, 0] == pytest.approx((np.linalg.matrix_power(matrix, 60) @ state)[0], abs=1e-9 * amplitude)


@pytest.mark.parametrize("computing", [1.0, 0.4])
def test_a_sampled_run_is_its_discrete_matrix(computing):
    brake = block(-0.1, PID(on="q1", derivative=0.5, sampling=2.0, computing=computing))
    matrix, _ = held(closed_loop(brake).plant)
    state = np.zeros(len(matrix))
    state[0] = 1.0
    run = run_loops(brake, 10.0, ([1.0], [0.0]))
    for k in range(1, 21):
        state = matrix @ state
        at = int(np.argmin(np.abs(run.t - 0.5 * k)))
        assert [run.q[at, 0], run.qd[at, 0]] == pytest.approx(state[:2], abs=1e-8)
    assert run.residual < 1e-7


def test_the_sampled_limit_is_found_by_runs():
    most = 1.0 / np.tan(0.25)
    for factor, grows in ((1.0 - 1e-3, False), (1.0 + 1e-3, True)):
        run = run_loops(block(0.0, PID(on="q1", derivative=factor * most, sampling=2.0)), 60.0, ([1.0], [0.0]))
        size = np.hypot(run.q[:, 0], run.qd[:, 0])
        assert (size[-20:].max() > size[40:60].max()) == grows


@pytest.mark.parametrize("factor", [0.99, 1.01])
def test_growth_under_a_delay_is_that_of_the_pole(factor):
    brake = block(-0.1, PID(on="q1", derivative=0.3, delay=factor * 1.069124121))
    pole = closed_loop(brake).poles[0]
    run = run_loops(brake, 80.0, ([1.0], [0.0]))
    # what is left is e^{pole t}: x(t + T) - 2 Re(e^{pole T}) x + |e^{pole T}|^2 x(t - T) = 0
    x, z = run.q[30:-1, 0], np.exp(pole * factor * 1.069124121)
    defect = x[2:] - 2.0 * z.real * x[1:-1] + abs(z) ** 2 * x[:-2]
    assert np.max(np.abs(defect)) < 1e-5 * np.max(np.abs(x))


def test_a_late_loop_with_a_contact_and_a_limit_keeps_its_audit():
    brake = Controlled(
        MassOnBelt(c=0.05, friction=Coulomb(0.4, 0.25)),
        PID(on="x", derivative=0.4, delay=0.3, limit=0.05, sampling=5.0),
    )
    run = run_loops(brake, 20.0, ([0.6], [0.0]))
    assert run.outcome == "completed"
    assert np.max(np.abs(run.force)) <= 0.05
    assert 0.0 < run.saturated[0] < 1.0
    assert run.work[-1] < 0.0
    assert run.residual < 1e-6


REMEMBERING = [
    PID(on="q1", proportional=0.1, integral=0.2, derivative=0.3, sampling=4.0, computing=0.3),
    PID(on="q1", derivative=0.3, bandwidth=0.4, sampling=4.0),
    ActiveForce(0.3, 0.2, PID(on="q1", proportional=0.3), sampling=8.0, bandwidth=0.5),
]


@pytest.mark.parametrize("loop", REMEMBERING, ids=lambda loop: f"{type(loop).__name__}{loop.bandwidth}")
def test_a_sampled_loop_that_remembers_is_its_discrete_matrix(loop):
    """The controller integrates between samples, its command is held, and the actuator follows."""
    brake = block(0.1, loop)
    matrix, step = held(closed_loop(brake).plant)
    state = [np.eye(len(matrix))[0]]
    for _ in range(24):
        state.append(matrix @ state[-1])
    motion = simulate(brake, 24 * step, ([1.0], [0.0]), times=25, rtol=1e-12)
    exact = np.array(state)
    assert np.max(np.abs(motion.q[:, 0] - exact[:, 0])) < 1e-11
    assert np.max(np.abs(motion.qd[:, 0] - exact[:, 1])) < 1e-11
    assert motion.energy.relative_residual < 1e-11
    other = np.linalg.matrix_power(held(closed_loop(block(0.1, loop.replace(computing=1.0))).plant)[0], 24)[0, 0]
    assert abs(other - exact[-1, 0]) > 1e-3


@pytest.mark.parametrize(
    "loop", [PID(on="x", derivative=1e-13, sampling=7.3), PID(on="x", derivative=1e-13, delay=0.2)]
)
def test_pieces_of_a_motion_are_the_whole(loop):
    """A loop that does next to nothing leaves stick-slip as it is: its events, its rows, its energy."""
    brake = MassOnBelt(c=0.05, friction=Coulomb(0.4, 0.25))
    free = simulate(brake, 20.0, ([0.6], [0.0]), times=101, rtol=1e-12)
    cut = simulate(Controlled(brake, loop), 20.0, ([0.6], [0.0]), times=101, rtol=1e-12)
    assert cut.settings["pieces"] > 90
    assert np.array_equal(cut.t, free.t)
    assert np.max(np.abs(cut.q - free.q)) < 1e-11
    assert np.array_equal(cut.event_mode, free.event_mode)
    assert cut.event_time == pytest.approx(free.event_time, abs=1e-10)
    assert cut.energy.relative_residual < 1e-11


def test_the_work_of_an_actuator_is_what_the_brake_loses():
    """A block without damper under a late, lagging force: all it loses went into the actuator."""
    brake = block(0.0, PID(on="q1", derivative=0.3, bandwidth=2.0, delay=0.2))
    run = run_loops(brake, 10.0, ([1.0], [0.0]))
    stored = 0.5 * (run.q[:, 0] ** 2 + run.qd[:, 0] ** 2)
    assert np.max(np.abs(stored - stored[0] - run.work)) < 1e-6
    assert run.work[-1] < -0.3


def test_a_delay_as_rows_has_the_poles_of_the_delay():
    """`complex_modes` of a late loop, its delay written as rows, against `closed_loop`, which solves for each pole."""
    drum = DrumBrake(friction=LinearSlope(0.36, -0.05))
    for loop in (
        PID(on="y", derivative=2000.0, integral=3e8, delay=1e-6),
        ActiveForce(0.1, 5e-5, PID(on="y", proportional=1e5), bandwidth=2e4, delay=3e-4),
    ):
        brake = Controlled(drum, [PID(on="x", derivative=2000.0, delay=loop.delay), loop])
        poles, modes = closed_loop(brake).poles, complex_modes(brake)
        for pole in poles[poles.real > -0.5 / loop.delay]:
            assert np.nanmin(np.abs(modes.eigenvalues - pole)) < 1e-8 * abs(pole)
        assert modes.largest_growth_rate == pytest.approx(poles[0].real, rel=1e-7)


def test_critical_values_and_maps_take_a_delay():
    drum = DrumBrake(friction=LinearSlope(0.36, -0.05))

    def brake(delay):
        return Controlled(drum, [PID(on=name, derivative=2000.0, delay=delay) for name in "xy"])

    one = critical_value(brake(1e-5), "loops.0.delay", (1e-6, 2e-4)).value
    there = Controlled(drum, [PID(on="x", derivative=2000.0, delay=one), PID(on="y", derivative=2000.0, delay=1e-5)])
    assert closed_loop(there).growth_rate == pytest.approx(0.0, abs=1e-4)
    table = stability_map(brake(1e-5), {"loops.0.delay": np.linspace(0.0, 2e-4, 4), "friction.static": [0.3, 0.5]})
    for i, delay in enumerate(np.linspace(0.0, 2e-4, 4)):
        changed = brake(1e-5).replace({"loops.0.delay": delay, "friction.static": 0.5})
        assert table.growth_rate[i, 1] == pytest.approx(closed_loop(changed).growth_rate, rel=1e-5)


def test_what_cannot_be_run_is_said():
    with pytest.raises(ParameterError, match="simulate.. runs the others"):
        run_loops(block(0.0, PID(on="q1", derivative=1.0)), 1.0)
    late = block(0.0, PID(on="q1", derivative=1.0, delay=0.1))
    with pytest.raises(ParameterError, match="simulate.contact = 'raw': expected exact or smoothed contact"):
        simulate(late, 1.0, contact="raw")
    with pytest.raises(ParameterError, match="1 values each"):
        simulate(late, 1.0, ([1.0, 2.0], [0.0]))
    beside = PID(on="q1", integral=1.0, limit=0.1)
    with pytest.raises(ParameterError, match="beside sampled or late loops only velocity feedback"):
        simulate(System([[1.0]], [[0.0]], [[1.0]], loops=(*late.loops, beside)), 1.0)
    with pytest.raises(ParameterError, match="closed_loop.. gives the poles of longer"):
        complex_modes(block(0.0, PID(on="q1", derivative=1.0, delay=100.0)))
