"""Neimark-Sacker points and curves in closed form; fold curves point by point against branches in one parameter.

Two blocks on belts of their own, seen in turned coordinates so that the matrices couple them. Block A swings on a cubic
law, block B slides steadily. B's part of the Floquet multipliers is exp(lambda T) with lambda its eigenvalues, so the
cycle meets its Neimark-Sacker bifurcation exactly where B has its Hopf point, c_B = -N_B mu'(V_B), with the phase
omega_B T of the pair. With a negative stiffness of B the pair is real, exp(+-kappa T) there: a neutral saddle.
"""

import numpy as np
import pytest

from small_systems import block_on_belt
from squealbox import Contact, Cubic, LinearSlope, Stribeck, System, branch, shooting
from squealbox.limit_cycles import point_curve

SLOPE = -0.2
STIFFNESS = 7.3  # of block B; sqrt(7.3) is no simple ratio of the frequency of A
DAMPINGS = (0.1, 0.4)


def pair(damping, normal=1.0, stiffness=STIFFNESS):
    """Blocks A and B; `damping` and `normal` are those of B."""
    turn = np.array([[np.cos(0.6), -np.sin(0.6)], [np.sin(0.6), np.cos(0.6)]])
    laws = Cubic(0.4, 0.25, 0.5), LinearSlope(0.5, SLOPE)
    belts = tuple(Contact(np.zeros(2), row, row, N0=force, V=speed, law=law)
                  for row, force, speed, law in zip(turn, (1.0, normal), (0.48, 0.7), laws, strict=True))  # fmt: skip
    C, K = (turn.T @ np.diag(x) @ turn for x in ([0.01, damping], [1.0, stiffness]))
    return System(np.eye(2), C, K, np.zeros(2), belts)


def cycle_of(damping, **others):
    """A's cycle with B in steady sliding; A alone is found first, in its own coordinate."""
    alone = shooting(block_on_belt(Cubic(0.4, 0.25, 0.5), 0.48, damping=0.01), ([0.5], [0.1]))
    turn = np.array([[np.cos(0.6), -np.sin(0.6)], [np.sin(0.6), np.cos(0.6)]])
    stiffness = others.get("stiffness", STIFFNESS)
    sliding = (0.5 + SLOPE * 0.7) * others.get("normal", 1.0) / stiffness
    q = turn.T @ [alone.q[0, 0], sliding]
    return q, turn.T @ [alone.qd[0, 0], 0.0], float(alone.period)


@pytest.fixture(scope="module")
def walked():
    return {method: branch(pair, "damping", DAMPINGS, cycle_of(0.25), value=0.25, method=method, harmonics=12,
                           direction=-1, points=40) for method in ("harmonic_balance", "shooting")}  # fmt: skip


@pytest.mark.parametrize("method", ["harmonic_balance", "shooting"])
def test_neimark_sacker_is_the_hopf_point_of_the_sliding_block(walked, method):
    (point,) = walked[method].points
    assert point.kind == "neimark_sacker"
    # a multiplier of the walk is good to 1e-8, and dc = 2 d|m|/T
    assert float(point.value) == pytest.approx(-SLOPE, abs=1e-8)
    phase = np.sqrt(STIFFNESS) * float(point.period)
    turned = np.exp(1j * phase)
    assert np.min(np.abs(point.multipliers - turned)) < 1e-6
    np.testing.assert_array_equal(walked[method].stable, walked[method].value > -SLOPE)


def test_a_neutral_saddle_is_none():
    """The same product of multipliers passes 1 there, but by a real pair: nothing changes."""
    saddle = branch(lambda c: pair(c, stiffness=-0.05), "damping", DAMPINGS, cycle_of(0.25, stiffness=-0.05),
                    value=0.25, direction=-1, harmonics=12, points=40)  # fmt: skip
    assert np.min(saddle.value) < -SLOPE
    products = [np.prod([m for m in row[1:] if abs(m) > 1.0]) * np.min(np.abs(row[1:])) for row in saddle.multipliers]
    assert min(np.abs(products)) < 1.0 < max(np.abs(products))
    assert len(saddle.points) == 0


@pytest.mark.parametrize("method", ["harmonic_balance", "shooting"])
def test_neimark_sacker_curve(walked, method):
    """c_B = -N_B mu' over the normal force."""
    (point,) = walked[method].points
    curve = point_curve(pair, {"damping": DAMPINGS, "normal": (0.8, 1.4)}, point, 1.0)
    assert curve.outcome.ok
    assert np.min(curve.y) == pytest.approx(0.8)
    assert np.max(curve.y) == pytest.approx(1.4)
    np.testing.assert_allclose(curve.x, -SLOPE * curve.y, rtol=0.0, atol=1e-7)
    assert np.ptp(curve.x) > 0.1  # a constant would not pass


def belt(speed, damping):
    return block_on_belt(Stribeck(0.4, 0.25, 0.3), speed, damping=damping)


def fold_of(damping):
    """Fold of the smoothed stick-slip cycle, from a branch in the speed alone."""
    walk = {"contact": "tanh", "width": 0.05, "harmonics": 9, "value": 0.25, "points": 100}
    found = branch(lambda v: belt(v, damping), "speed", (0.1, 0.6), **walk)
    return next(point for point in found.points if point.kind == "fold")


def test_fold_curve_is_the_fold_of_each_branch():
    fold = fold_of(0.2)
    curve = point_curve(belt, {"speed": (0.1, 0.6), "damping": (0.19, 0.21)}, fold, 0.2)
    assert curve.outcome.ok
    assert np.ptp(curve.x) > 0.01
    for i in (0, -1):
        alone = fold_of(float(curve.y[i]))
        assert float(curve.x[i]) == pytest.approx(float(alone.value), abs=1e-8)
        assert float(curve.x[i]) != pytest.approx(float(fold.value), abs=1e-3)  # nor is it the fold of the start
