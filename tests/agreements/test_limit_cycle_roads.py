"""Shooting, harmonic balance and a long run are three roads to one cycle."""

import numpy as np
import pytest

from random_systems import squealing_system
from small_systems import block_on_belt, drum, two_blocks_on_belt
from squealbox import Hyperbolic, harmonic_balance, shooting, simulate

SMOOTHED = {
    "belt": (lambda: block_on_belt(Hyperbolic(1.0, 3.0), 0.2), 0.1),
    "consistent": (lambda: drum(0.45), 0.2),
    "eq3": (lambda: drum(0.6, "eq3"), 0.3),
    "three freedoms": (lambda: squealing_system(3), 0.1),
    "two contacts": (lambda: squealing_system(9), 0.1),
}


@pytest.mark.parametrize("case", SMOOTHED)
def test_shooting_is_harmonic_balance(case):
    make, width = SMOOTHED[case]
    shot = shooting(make(), contact="smooth", width=width)
    balanced = harmonic_balance(make(), shot, contact="smooth", width=width, tolerance=1e-6)
    assert shot.outcome.ok
    assert balanced.outcome.ok
    assert balanced.error < 1e-6
    np.testing.assert_allclose(float(balanced.period), float(shot.period), rtol=1e-6)
    np.testing.assert_allclose(balanced.amplitude, shot.amplitude, rtol=2e-6)
    # the Magnus steps of harmonic balance are coarser than the multipliers of shooting
    np.testing.assert_allclose(np.abs(balanced.multipliers), np.abs(shot.multipliers), atol=1e-4)
    coarse = harmonic_balance(make(), shot, contact="smooth", width=width, harmonics=1)
    assert abs(float(coarse.period / shot.period) - 1.0) > 1e-6


@pytest.mark.parametrize("make", [two_blocks_on_belt, lambda: drum(0.45), lambda: drum(0.5, "eq3")])
def test_shooting_is_a_long_run(make):
    cycle = shooting(make())
    assert cycle.stable
    run = simulate(make(), 20.0 * float(cycle.period), cycle.start, rtol=1e-11, times=20 * 64 + 1)
    last = run.q[-65:]
    size = np.max(cycle.amplitude)
    np.testing.assert_allclose(last[0] / size, last[-1] / size, atol=1e-7)  # it repeats after one period, not sooner
    assert np.max(np.abs(last[0] - last[32])) > 0.1 * size


def test_several_shots_are_one():
    one, three = (shooting(two_blocks_on_belt(), shots=k) for k in (1, 3))
    assert float(three.period) == pytest.approx(float(one.period), rel=1e-11)
    np.testing.assert_allclose(np.abs(three.multipliers), np.abs(one.multipliers), atol=1e-8)


def test_a_start_on_another_phase_finds_the_same_cycle():
    cycle = shooting(drum(0.5))
    k = 700
    again = shooting(drum(0.5), (cycle.q[k], cycle.qd[k], float(cycle.period)))
    assert float(again.period) == pytest.approx(float(cycle.period), rel=1e-10)
    np.testing.assert_allclose(np.abs(again.multipliers), np.abs(cycle.multipliers), atol=1e-7)
