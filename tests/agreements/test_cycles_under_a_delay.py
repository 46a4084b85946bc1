"""Limit cycles of brakes with late loops: shooting with the delay as rows against SciPy under the delay itself."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp
from scipy.interpolate import CubicSpline

from squealbox import PID, Controlled, MassOnBelt, System, shooting, simulate
from squealbox.friction import Cubic
from squealbox.system import InvalidSystem

BELT = MassOnBelt(c=0.02, sliding_speed=1.12, load=1.0, friction=Cubic(0.5, 0.3, 1.2))  # it slides all along its cycle


def test_a_cycle_under_a_delay_comes_back_under_the_delay_itself():
    free = shooting(BELT, ([0.85], [0.0], 6.294))
    brake = Controlled(BELT, PID(on="x", derivative=0.01, delay=2.0))
    found = shooting(brake, (free.q[0], free.qd[0], float(free.period)))
    assert found.outcome == "completed"
    assert found.caution == ""
    assert found.stable
    period, (start, speed) = float(found.period), (found.q[0, 0], found.qd[0, 0])
    before = CubicSpline(found.t - found.t[0], np.r_[found.qd[:-1, 0], speed], bc_type="periodic")
    law, load = BELT.friction, float(BELT.system().contacts[0].N0)

    def field(t, x):
        return [x[1], load * float(law.mu(1.12 - x[1])) - 0.02 * x[1] - x[0] - 0.01 * float(before((t - 2.0) % period))]

    end = solve_ivp(field, (0.0, period), [start, speed], "DOP853", rtol=1e-11, atol=1e-12).y[:, -1]
    assert end == pytest.approx([start, speed], abs=1e-8)
    assert abs(period - float(free.period)) > 1e-2


def test_corners_of_a_cut_command_are_told_and_forward_runs_agree():
    block = System([[1.0]], [[0.1]], [[1.0]], loops=(PID(on="q1", derivative=-0.3, delay=0.4, limit=0.05),))
    found = shooting(block, ([0.588], [0.0], 6.4156))
    assert found.outcome == "completed"
    assert "corners of it are rounded" in found.caution
    assert len(found.memory) == 15
    run = simulate(block, 60.0, ([0.5881], [0.0]))
    assert np.max(run.q[run.t > 53.0]) == pytest.approx(float(found.highest[0]), abs=1.5e-4)


def test_a_sampled_loop_has_no_period_of_its_own():
    with pytest.raises(InvalidSystem, match="a clock of its own"):
        shooting(Controlled(BELT, PID(on="x", derivative=0.01, sampling=2.0)))
