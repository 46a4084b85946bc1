"""Shares with their interval, the edge of a basin, Poincare sections and Lyapunov exponents with a known answer."""

import numpy as np
import pytest

from small_systems import block_on_belt, drum
from squealbox import Coulomb, Stribeck, branch, harmonic_balance, hopf_point, shooting, simulate
from squealbox.limit_cycles import basin, dangerous_push, lyapunov_exponents, maxima, push_along
from squealbox.limit_cycles.basins import interval
from squealbox.system import equilibrium


def test_interval_of_a_share():
    """Wilson 1927 for 0 of n: (0, z^2/(n + z^2))."""
    share, (low, high) = interval(0, 50)
    assert (share, low) == (0.0, pytest.approx(0.0, abs=1e-15))
    assert high == pytest.approx(1.959963984540054**2 / (50 + 1.959963984540054**2), rel=1e-12)
    assert np.isnan(interval(0, 0)[0])


def subcritical(speed):
    """A block above the Hopf speed: an unstable cycle of slip between steady sliding and stick-slip."""
    return block_on_belt(Stribeck(0.4, 0.25, 0.3), speed, damping=0.2)


@pytest.fixture(scope="module")
def edge():
    """The unstable cycle at a belt speed of 0.3, by harmonic balance, and the states along it."""
    born = hopf_point(subcritical, "V", (0.05, 1.0))
    cycles = branch(subcritical, "V", (0.05, 0.30), born, harmonics=12)
    assert cycles.value[-1] == pytest.approx(0.30)
    assert not cycles.stable[-1]
    return harmonic_balance(subcritical(0.30), (cycles.lowest[-1], [0.0], float(cycles.period[-1])), harmonics=12)


def test_edge_of_the_basin_is_the_unstable_cycle(edge):
    """A push in x' dies away up to the unstable cycle's velocity at the steady position, one beyond it sticks."""
    rest = equilibrium(subcritical(0.30)).q[0]
    ahead = edge.qd[:, 0] > 0.0
    velocity = np.interp(rest, edge.q[ahead, 0], edge.qd[ahead, 0])
    push = push_along(subcritical(0.30), [0.0, 1.0], (0.05, 0.29))
    assert push == pytest.approx(velocity, rel=1e-3)  # 1e-4 of the bounds is 2e-5, and samples of the cycle lie apart
    assert np.isnan(push_along(subcritical(0.33), [0.0, 1.0], (0.05, 0.29)))


def test_smallest_push_is_where_the_unstable_cycle_has_least_energy(edge):
    """In the plane every push beyond the cycle vibrates, so the smallest lies on it: min (x' ^2 + (x - x0)^2)/2."""
    rest = equilibrium(subcritical(0.30)).q[0]
    least = np.min(0.5 * (edge.qd[:, 0] ** 2 + (edge.q[:, 0] - rest) ** 2))
    found = dangerous_push(subcritical(0.30), directions=32, rounds=6, drawn=200)
    assert found.energy == pytest.approx(least, rel=4e-3)  # twice the 2e-3 of a length that SECTIONS resolve
    assert found.harmless < found.energy
    assert int(found.dangerous) == 0
    assert found.to.kind == "cycle"
    assert dangerous_push(subcritical(0.33), directions=8).outcome == "no_danger"


def test_attractors_are_told_apart():
    """At 0.3 steady sliding and stick-slip coexist; the share is the area inside the unstable cycle over the box."""
    both = basin(subcritical(0.30), 1.2, 1024)
    assert both.kind.tolist() == ["steady sliding", "cycle"]
    assert both.attractors[1].cycle.stable
    assert float(np.sum(both.shares)) == pytest.approx(1.0)
    assert both.intervals[0, 0] < both.shares[0] < both.intervals[0, 1]
    assert np.array_equal(both.vibrates, both.attractor == 1)


def test_all_starts_die_away_in_stable_sliding_and_none_in_squeal():
    quiet = basin(block_on_belt(Stribeck(0.3, 0.3, 0.3), 0.2, damping=0.5), [0.2, 0.2], 16)
    loud = basin(block_on_belt(Stribeck(0.4, 0.25, 0.3), 0.1, damping=0.2), [0.2, 0.2], 16)
    assert (float(quiet.share), float(loud.share)) == (0.0, 1.0)
    assert quiet.outcome.ok
    picture = basin(block_on_belt(Stribeck(0.3, 0.3, 0.3), 0.2, damping=0.5), [0.2, 0.2], 9, plane=("q1", "q1'"))
    assert picture.start.shape == (9, 2)
    assert picture.plane == ("q1", "q1'")


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
