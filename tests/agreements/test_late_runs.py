"""Late and sampled loops in time: the delay itself by SciPy, other pieces, and laws that remember across samples."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from squealbox import PID, Controlled, Coulomb, DrumBrake, LinearSlope, MassOnBelt, System, simulate
from squealbox.control import run_loops
from squealbox.friction import Dahl, ElastoPlastic, LuGre
from squealbox.transient import pieces


def by_steps(c, gains, delay, limit, count):
    """q and q' of a block after so many delays, by the method of steps; the force is cut and 0 at first."""
    before, state = None, [1.0, 0.0]
    for k in range(count):

        def field(t, x, before=before):
            late = [0.0, 0.0] if before is None else before(t - delay)
            force = -np.clip(gains[0] * late[0] + gains[1] * late[1], -limit, limit)
            return [x[1], force - c * x[1] - x[0]]

        span = k * delay, (k + 1) * delay
        run = solve_ivp(field, span, state, "DOP853", rtol=1e-12, atol=1e-13, dense_output=True, max_step=2e-2)
        before, state = run.sol, run.y[:, -1]
    return state


@pytest.mark.parametrize(
    ("c", "gains", "delay"), [(-0.1, (0.0, 0.3), 1.0), (0.1, (0.2, 0.5), 0.3), (0.05, (0.0, 0.4), 6.0)]
)
def test_a_late_run_is_the_motion_under_the_delay_itself(c, gains, delay):
    loop = PID(on="q1", proportional=gains[0], derivative=gains[1], delay=delay)
    run = simulate(System([[1.0]], [[c]], [[1.0]], loops=(loop,)), 10 * delay, ([1.0], [0.0]))
    assert [run.q[-1, 0], run.qd[-1, 0]] == pytest.approx(by_steps(c, gains, delay, np.inf, 10), abs=1e-11)


def test_a_cut_late_command_too():
    loop = PID(on="q1", derivative=0.4, delay=0.7, limit=0.25)
    run = simulate(System([[1.0]], [[0.05]], [[1.0]], loops=(loop,)), 14.0, ([1.0], [0.0]))
    # SciPy steps over the corners of the command
    assert [run.q[-1, 0], run.qd[-1, 0]] == pytest.approx(by_steps(0.05, (0.0, 0.4), 0.7, 0.25, 20), abs=2e-8)


@pytest.mark.parametrize("limit", [None, 0.05])
@pytest.mark.parametrize("delay", [0.3, 2.0])
def test_a_late_run_with_stick_and_slip_does_not_depend_on_its_pieces(delay, limit, monkeypatch):
    belt = MassOnBelt(c=0.02, load=1.0, friction=Coulomb(0.5, 0.3))
    brake = Controlled(belt, PID(on="x", proportional=0.1, derivative=0.3, delay=delay, limit=limit))
    first = simulate(brake, 40.0, times=9)
    monkeypatch.setattr(pieces, "ARC", 0.2)
    closer = simulate(brake, 40.0, times=9)
    assert closer.settings["pieces"] > 1.1 * first.settings["pieces"]
    assert len(first.event_time) == len(closer.event_time) > 1
    assert np.max(np.abs(first.q - closer.q)) < 1e-12
    assert first.energy.relative_residual < 1e-10


@pytest.mark.parametrize(
    "law", [LuGre(0.4, 0.3, 0.2, 1e4), Dahl(0.4, 1e4), ElastoPlastic(0.4, 0.3, 0.2, 1e4)], ids=repr
)
@pytest.mark.parametrize("clock", [{"sampling": 100.0}, {"delay": 0.02}, {"sampling": 40.0, "delay": 0.03}], ids=str)
def test_what_a_law_remembers_goes_on_from_piece_to_piece(law, clock):
    belt = MassOnBelt(c=0.1, k=100.0, load=10.0, sliding_speed=0.1, friction=law)
    alone = simulate(belt, 0.6, times=7)
    beside = simulate(Controlled(belt, PID(on="x", derivative=0.0, **clock)), 0.6, times=7)
    assert beside.settings["pieces"] > 10
    assert np.max(np.abs(beside.q - alone.q)) < 1e-9 * np.max(np.abs(alone.q))


def test_sampled_and_late_loops_together_on_a_brake_that_sticks(monkeypatch):
    loops = (
        PID(on="y", derivative=2e3, sampling=5e4, computing=1.0, limit=80.0),
        PID(on="x", derivative=2e3, delay=2e-5),
    )
    brake = Controlled(DrumBrake(load1=4e3, load2=4e3, friction=LinearSlope(0.45, -0.01)), loops)
    run = simulate(brake, 1e-3, times=5)
    monkeypatch.setattr(pieces, "ARC", 0.1)
    closer = simulate(brake, 1e-3, times=5)
    assert run.outcome == closer.outcome == "completed"
    assert len(run.event_time) > 4
    assert np.max(np.abs(run.q - closer.q)) < 1e-9 * np.max(np.abs(run.q))


def test_a_sampled_run_by_another_method_and_a_named_one():
    brake = Controlled(DrumBrake(), [PID(on=name, derivative=800.0, sampling=50e3, computing=1.0) for name in "xy"])
    runs = [simulate(brake, 1e-3, times=5, method=method) for method in (None, "taylor", "dormand-prince-8")]
    for other in runs[1:]:
        assert np.max(np.abs(other.q - runs[0].q)) < 1e-7 * np.max(np.abs(runs[0].q))
    assert runs[1].settings["tableau"] == "taylor"
    assert runs[2].settings["tableau"] == "dormand-prince-8"


def test_the_work_of_an_actuator_that_lags_is_what_it_gives_the_block():
    loop = PID(on="q1", derivative=0.3, bandwidth=2.0, sampling=4.0)
    run = run_loops(System([[1.0]], [[0.1]], [[1.0]], loops=(loop,)), 12.0, ([1.0], [0.0]))
    motion = simulate(System([[1.0]], [[0.1]], [[1.0]], loops=(loop,)), 12.0, ([1.0], [0.0]), np.linspace(0, 12, 20001))
    q, qd = motion.q[:, 0], motion.qd[:, 0]
    energy = 0.5 * (qd**2 + q**2)
    spent = np.trapezoid(0.1 * qd**2, motion.t)
    assert run.work[-1] == pytest.approx(energy[-1] - energy[0] + spent, abs=1e-8)


def test_a_loop_at_its_limit_has_a_name():
    loop = PID(on="q1", derivative=0.3, sampling=20.0, limit=0.05)
    run = run_loops(System([[1.0]], [[-0.1]], [[1.0]], loops=(loop,)), 40.0, ([2.0], [0.0]))
    assert run.outcome == "saturated"
    assert "at its limit of 0.05 N" in run.outcome.message
    quiet = run_loops(System([[1.0]], [[-0.1]], [[1.0]], loops=(loop,)), 40.0, ([0.05], [0.0]))
    assert quiet.outcome == "completed"
