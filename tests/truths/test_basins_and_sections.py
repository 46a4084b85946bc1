"""Shares with their interval, the edge of a basin, Poincare sections and Lyapunov exponents with a known answer."""

import numpy as np
import pytest

from small_systems import block_on_belt, drum
from squealbox import Coulomb, Cubic, Stribeck, branch, hopf_point, shooting, simulate
from squealbox.limit_cycles import basin, dangerous_push, lyapunov_exponents, maxima
from squealbox.limit_cycles.basins import wilson


def test_wilson_interval():
    """Centre and half width of Wilson 1927 for 0 of n: (0, z^2/(n + z^2))."""
    share, (low, high) = wilson(0, 50)
    assert (share, low) == (0.0, pytest.approx(0.0, abs=1e-15))
    assert high == pytest.approx(1.959963984540054**2 / (50 + 1.959963984540054**2), rel=1e-12)
    assert np.isnan(wilson(0, 0)[0])


def test_edge_of_the_basin_is_the_unstable_cycle():
    """Above the Hopf speed a push in x' up to the unstable slip cycle dies away, one beyond it sticks and stays."""

    def make(speed):
        return block_on_belt(Stribeck(0.4, 0.25, 0.3), speed, damping=0.2)

    speed = 0.30
    cycles = branch(make, "V", (0.05, speed), hopf_point(make, "V", (0.05, 1.0)), harmonics=12)
    assert cycles.value[-1] == pytest.approx(speed)
    unstable = cycles.unknowns[-1]
    assert not cycles.stable[-1]
    push = dangerous_push(make(speed), [0.0, 1.0], (0.05, 0.29), duration=2500.0, steps=12)
    # the orbit through (x0, x') with x at its steady value: its largest velocity, near amplitude times omega
    assert push == pytest.approx(cycles.amplitude[-1, 0] * unstable[-1], rel=0.03)
    assert np.isnan(dangerous_push(make(0.33), [0.0, 1.0], (0.05, 0.29), duration=1500.0))


def test_all_starts_die_away_in_stable_sliding_and_none_in_squeal():
    quiet = basin(block_on_belt(Coulomb(0.3), 0.2, damping=0.5), [0.2, 0.2], 16)
    loud = basin(block_on_belt(Cubic(0.4, 0.25, 0.5), 0.2, damping=0.01), [0.2, 0.2], 16)
    assert (float(quiet.share), float(loud.share)) == (0.0, 1.0)
    assert quiet.outcome.ok
    picture = basin(block_on_belt(Coulomb(0.3), 0.2, damping=0.5), [0.2, 0.2], 9, plane=(0, 1))
    assert picture.start.shape == (9, 2)


def test_maxima_of_a_free_swing():
    motion = simulate(block_on_belt(Coulomb(0.0), 10.0), 20.0, ([0.0], [1.0]), rtol=1e-12, times=2001)
    instants, heights = maxima(motion)
    np.testing.assert_allclose(instants, np.pi / 2.0 + 2.0 * np.pi * np.arange(len(instants)), atol=1e-6)
    np.testing.assert_allclose(heights, 1.0, atol=1e-9)


def test_exponents_of_a_cycle_are_those_of_its_multipliers():
    """On a cycle of period T they are log|multiplier|/T, up to what the start frame leaves, of order 1/time."""
    cycle = shooting(drum(0.5))
    period = float(cycle.period)
    found = lyapunov_exponents(drum(0.5), cycle.start, period, 60)
    with np.errstate(divide="ignore"):
        expected = np.sort(np.log(np.abs(cycle.multipliers)) / period)[::-1]
    assert abs(found[0]) * 60 * period < 5.0
    assert found[1] == pytest.approx(expected[1], rel=0.1)
    assert found[-1] == -np.inf  # sticking forgets a direction
    assert found[1] < -100.0
