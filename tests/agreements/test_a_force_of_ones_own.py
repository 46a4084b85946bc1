"""A force quadratic in a velocity, added in one place as a law mu(v) = b v^2 under N = 1 N, is seen by every analysis.

x'' - a x' + b |x'| x' + x = 0 swings up to a cycle. To first order in a and b its energy balance over one period,

    a A^2 pi = b A^3 8/3        A = 3 pi a / (8 b),

and about sliding at V the force b V^2 pulls the mass to x0 = b V^2 and damps it by 2 b V.
"""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from squealbox import (
    Contact,
    System,
    complex_modes,
    equilibrium,
    harmonic_balance,
    linearise,
    shooting,
    simulate,
    simulate_ensemble,
)
from squealbox.files.own_law import own_law

A, B, START = 0.05, 0.3, ([0.4], [0.1])
DRAG = own_law("def mu(v, p): return 0.3 * v * v")
AMPLITUDE = 3.0 * np.pi * A / (8.0 * B)


def swinging(speed=0.0, damping=-A):
    """The equation above, on a belt of that speed."""
    return System([[1.0]], [[damping]], [[1.0]], 0.0, (Contact([0.0], [1.0], [1.0], 1.0, speed, DRAG),))


def written_down(t, y, speed, damping):
    """Its right-hand side in so many words."""
    v = speed - y[1]
    return [y[1], -damping * y[1] - y[0] + B * v * abs(v)]


def test_steady_sliding_and_modes():
    belt = swinging(2.0, 0.1)
    assert equilibrium(belt).q[0] == pytest.approx(B * 4.0, rel=1e-12)
    assert linearise(belt).C[0, 0] == pytest.approx(0.1 + 2.0 * B * 2.0, rel=1e-6)
    assert complex_modes(belt).growth_rate[0] == pytest.approx(-0.5 * (0.1 + 4.0 * B), rel=1e-6)


@pytest.mark.parametrize("ways", [{}, {"method": "dormand-prince-8"}, {"method": "tsitouras", "rtol": 1e-11}])
@pytest.mark.parametrize("speed", [0.0, 0.3])
def test_motion_ensemble_and_its_audit(speed, ways):
    truth = solve_ivp(written_down, (0.0, 20.0), [0.4, 0.1], "DOP853", args=(speed, -A), rtol=1e-12, atol=1e-13)
    motion = simulate(swinging(speed), 20.0, START, times=41, **ways)
    assert motion.q[-1, 0] == pytest.approx(truth.y[0, -1], abs=1e-8)
    assert np.max(np.abs(motion.energy.residual)) < 1e-8
    starts = ([[0.4], [0.2]], [[0.1], [0.0]])
    many = simulate_ensemble(swinging(speed), None, 20.0, ways.get("method"), (), start=starts)
    assert many.q[0, 0] == pytest.approx(truth.y[0, -1], abs=1e-7)


def test_cycle_by_shooting_and_its_multiplier():
    cycle = shooting(swinging(), start=simulate(swinging(), 300.0, START))
    assert cycle.stable
    assert np.ptp(cycle.q[:, 0]) / 2.0 == pytest.approx(AMPLITUDE, rel=2e-3)
    # of the amplitude: A' = a A/2 - (4/(3 pi)) b A^2, whose slope at the cycle is -a/2
    assert np.min(np.abs(cycle.multipliers)) == pytest.approx(np.exp(-0.5 * A * 2.0 * np.pi), rel=2e-3)
    series = harmonic_balance(swinging(), ([AMPLITUDE], [0.0], 2.0 * np.pi), harmonics=15, contact="smooth", width=1e-3)
    assert series.period == pytest.approx(cycle.period, rel=1e-4)
