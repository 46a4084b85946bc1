"""Special points of branches and curves of them: each against a road that knows no continuation."""

import numpy as np
import pytest

from small_systems import two_blocks_on_belt
from squealbox import (
    Contact,
    DrumBrake,
    LinearSlope,
    ParameterError,
    Stribeck,
    System,
    branch,
    critical_value,
    hopf_point,
    simulate,
)
from squealbox.limit_cycles import hopf_curve, point_curve, stick_slip_limit

LAW = Stribeck(0.4, 0.25, 0.3)
DOWN = {"direction": -1, "method": "shooting"}
SPEEDS = (0.05, 1.0)


def block(speed, damping=0.2):
    belt = Contact(n=[0.0], d=[1.0], t=[1.0], N0=1.0, V=speed, law=LAW)
    return System([[1.0]], [[damping]], [[1.0]], 0.0, (belt,))


@pytest.fixture(scope="module")
def end():
    """Where the slip cycle of the block touches v = 0, as its branch locates it."""
    return branch(block, "speed", SPEEDS, hopf_point(block, "speed", SPEEDS)).points[-1]


def test_end_of_stick_slip_is_located(end):
    """`stick_slip_limit` is one orbit integrated at 1e-13; the branch is harmonic balance, whose series leaves 1e-9."""
    exact = stick_slip_limit(LAW, (0.2, 0.5), 1.0, 0.2)
    assert end.kind == "grazing"
    assert float(end.value) == pytest.approx(exact, abs=2e-9)
    assert abs(float(end.test)) < 1e-12
    assert float(end.uncertainty) < 1e-10
    other = stick_slip_limit(LAW, (0.2, 0.5), 1.0, 0.21)
    assert abs(float(end.value) - other) > 1e-3  # the check sees a wrong damping


def test_located_cycle_touches_zero(end):
    """The cycle that the point carries: its least sliding speed is zero, to the spacing of its samples squared."""
    least = np.min(float(end.value) - end.qd[:, 0])
    assert -1e-9 < least < 1e-3 * float(end.value)


def test_no_end_in_bounds_is_nan():
    assert np.isnan(stick_slip_limit(LAW, (0.4, 0.5), 1.0, 0.2))
    with pytest.raises(ParameterError, match="0 < low < high"):
        stick_slip_limit(LAW, (0.5, 0.4), 1.0, 0.2)


def test_hopf_curve_is_the_stability_boundary():
    """On each point of the curve the eigenvalue onset, solved for by itself, is the same to 1e-8."""
    brake = DrumBrake(friction=LinearSlope(0.3, -0.05))
    curve = hopf_curve(brake, {"friction.static": (0.1, 0.6), "load": (500.0, 2000.0)})
    assert curve.outcome.ok
    assert np.min(curve.y) == pytest.approx(500.0, abs=1e-6)
    assert np.max(curve.y) == pytest.approx(2000.0, abs=1e-6)
    onsets = [critical_value(brake.replace({"load": load}), "friction.static", (0.1, 0.6)).value for load in curve.y]
    np.testing.assert_allclose(curve.x, onsets, rtol=0.0, atol=1e-8)
    assert np.ptp(curve.x) > 0.01  # a constant would not pass


def test_curve_of_grazing_is_the_exact_end_for_each_damping(end):
    curve = point_curve(block, {"speed": SPEEDS, "damping": (0.15, 0.25)}, end, 0.2, points=3)
    exact = [stick_slip_limit(LAW, (0.2, 0.6), 1.0, float(damping)) for damping in curve.y]
    np.testing.assert_allclose(curve.x, exact, rtol=0.0, atol=5e-9)
    assert np.ptp(curve.x) > 1e-3


def test_what_point_curve_refuses(end):
    with pytest.raises(ParameterError, match="two parameters"):
        point_curve(block, {"speed": SPEEDS}, end, 0.2)


def blocks(speed):
    return two_blocks_on_belt(speed=speed)


def test_from_a_period_doubling_onto_the_doubled_branch():
    """Two turns of the old cycle become one; the parameter moves with the square of the distance (a pitchfork)."""
    single = branch(blocks, "speed", (0.045, 0.06), value=0.0493, points=6, **DOWN)
    (point,) = single.points
    assert point.kind == "period_doubling"
    assert np.min(np.abs(point.multipliers + 1.0)) < 1e-9
    np.testing.assert_array_equal(single.stable, single.value > float(point.value))  # the single cycle hands over
    double = branch(
        blocks, "speed", (0.045, 0.06), point, points=5, largest_step=5e-3, **DOWN
    )  # the law is for small ones
    assert np.all(double.stable)
    np.testing.assert_allclose(double.period, 2.0 * float(point.period), rtol=1e-4)  # T itself moves with the parameter
    rise, moved = double.amplitude[:, 0] - point.amplitude[0], float(point.value) - double.value
    assert np.polyfit(np.log(rise), np.log(moved), 1)[0] == pytest.approx(2.0, abs=0.1)
    with pytest.raises(ParameterError, match="shooting"):
        branch(blocks, "speed", (0.045, 0.06), point, method="harmonic_balance")


def test_a_doubled_branch_doubles_again():
    """Two turns become four; a long run beside it, which knows no branch, settles on the very same cycle."""
    double = branch(blocks, "speed", (0.0474, 0.048), value=0.04782, points=4, **DOWN)
    (point,) = double.points
    assert point.kind == "period_doubling"
    assert np.min(np.abs(point.multipliers + 1.0)) < 1e-8
    np.testing.assert_array_equal(double.stable, double.value > float(point.value))
    four = branch(blocks, "speed", (0.04778, 0.048), point, points=15, **DOWN)
    assert four.outcome.ok  # the bound
    assert np.all(four.stable)
    assert np.all(four.value < float(point.value))
    np.testing.assert_allclose(four.period, 2.0 * float(point.period), rtol=2e-3)
    last, period = blocks(float(four.value[-1])), float(four.period[-1])
    turns, begin = 150, np.split(1.001 * four.start[-1], 2)  # each takes a sixth of the distance away
    times = np.array([turns - 1.0, turns - 0.5, turns]) * period
    run = simulate(last, turns * period, begin, times, rtol=1e-12)
    before, half, now = np.hstack([run.q, run.qd])
    assert np.max(np.abs(now - before)) < 1e-8
    assert np.max(np.abs(now - half)) > 1e-4  # after two turns it is elsewhere
    lowest = simulate(last, period, (run.q[-1], run.qd[-1]), 4001).q.min(axis=0)
    np.testing.assert_allclose(lowest, four.lowest[-1], atol=1e-4)  # extremes of the walk: few samples
