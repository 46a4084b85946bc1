"""Two roads, one answer: loops in time against their poles and multipliers."""

import numpy as np
import pytest

from squealbox import PID, Controlled, Coulomb, MassOnBelt, ParameterError, System, closed_loop
from squealbox.control import run_loops


def block(c, loop):
    return System([[1.0]], [[c]], [[1.0]], loops=(loop,))


@pytest.mark.parametrize("computing", [1.0, 0.4])
def test_a_sampled_run_is_its_discrete_matrix(computing):
    from squealbox.control.sampled import held

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


def test_what_cannot_be_run_is_said():
    with pytest.raises(ParameterError, match="without memory"):
        run_loops(block(0.0, PID(on="q1", integral=1.0, sampling=2.0)), 1.0)
    with pytest.raises(ParameterError, match="simulate.. runs the others"):
        run_loops(block(0.0, PID(on="q1", derivative=1.0)), 1.0)
