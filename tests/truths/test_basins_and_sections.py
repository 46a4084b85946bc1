"""Shares with their interval, the edge of a basin, Poincare sections and Lyapunov exponents with a known answer."""

import numpy as np
import pytest

from small_systems import block_on_belt, drum, two_masses
from squealbox import Contact, Coulomb, Stribeck, System, branch, harmonic_balance, hopf_point, shooting, simulate
from squealbox.limit_cycles import basin, dangerous_push, lyapunov_exponents, maxima, poincare_section, push_along
from squealbox.limit_cycles.attractors.basins import interval
from squealbox.limit_cycles.attractors.settling import Known
from squealbox.parameters import ParameterError
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


def test_a_section_is_met_where_the_motion_passes_it():
    """x = sin t passes x/2 + x' = 0.3 from above once a period; the error falls with the cube of the output's step."""
    system = block_on_belt(Coulomb(0.0), 10.0)
    exact = np.arccos(0.3 / np.hypot(0.5, 1.0)) + np.arctan(0.5)  # 0.5 sin t + cos t = hypot(0.5, 1) cos(t - atan 0.5)
    errors = []
    for steps in (200, 400):
        motion = simulate(system, 20.0, ([0.0], [1.0]), rtol=1e-12, times=steps + 1)
        instants, states = poincare_section(motion, [0.5, 1.0], 0.3, direction=-1)
        expected = exact + 2.0 * np.pi * np.arange(len(instants))
        errors.append(np.max(np.abs(instants - expected)))
        assert len(instants) == 3
        assert np.max(np.abs(states @ [0.5, 1.0] - 0.3)) < 1e-12
    assert np.log2(errors[0] / errors[1]) > 2.8
    rising, _ = poincare_section(motion, [0.5, 1.0], 0.3, direction=1)
    both, _ = poincare_section(motion, [0.5, 1.0], 0.3, direction=0)
    assert len(both) == len(rising) + 3
    with pytest.raises(ParameterError, match="normal"):
        poincare_section(motion, [1.0, 0.0, 0.0])


def test_exponents_of_a_linear_system_are_its_growth_rates():
    """Up to what the start frame leaves, of order 1/time; their sum is the trace of -M^-1 C (Liouville)."""
    system = two_masses()
    expected = np.sort(np.linalg.eigvals(companion(system)).real)[::-1]
    seen = lyapunov_exponents(system, ([1.0, 0.0], [0.0, 0.0]), 2.0, 200, history=True)
    assert np.max(np.abs(seen[-1] - expected)) < 5.0 / 400.0
    np.testing.assert_allclose(np.sum(seen, axis=1), np.sum(expected), rtol=1e-6)


def companion(system):
    inverse = np.linalg.inv(system.M)
    return np.block([[np.zeros((2, 2)), np.eye(2)], [-inverse @ system.K, -inverse @ system.C]])


def driven_dry_friction():
    """x'' + 0.03 x' + x + (1 + 1.5 x) sgn(x') = 1.9 cos(1.25 t): chaotic, Feeny and Moon 1989. The drive is the second
    degree of freedom, undamped and coupled one way."""
    contact = Contact(n=[1.5, 0.0], d=[1.0, 0.0], t=[1.0, 0.0], N0=1.0, V=0.0, law=Coulomb(1.0))
    return System(np.eye(2), np.diag([0.03, 0.0]), [[1.0, -1.9], [0.0, 1.25**2]], [0.0, 0.0], (contact,))


def test_chaos_with_sticking_by_two_roads():
    """Saltation matrices, and two motions side by side brought back to 1e-7 after each period of the drive.

    The drive has two exponents 0, sticking forgets one direction, and the largest is positive and the same on both
    roads. Both start from one state, but chaos parts what two methods compute: each road has its own 120 periods,
    and their means differ as two samples do: a mean of 120 periods has a standard deviation of 0.008.
    """
    system, period = driven_dry_friction(), 2.0 * np.pi / 1.25
    settled = simulate(system, 40.0 * period, ([0.3, 1.0], [0.0, 0.0]), rtol=1e-11)
    start = (settled.q[-1], settled.qd[-1])
    found = lyapunov_exponents(system, start, period, 120)
    assert found[0] > 0.05
    assert np.max(np.abs(found[1:3])) < 5e-3
    assert found[3] == -np.inf
    x, away, total = np.concatenate(start), np.array([1e-7, 0.0, 0.0, 0.0]), 0.0
    for _ in range(120):
        ends = []
        for state in (x, x + away):
            run = simulate(system, period, (state[:2], state[2:]), rtol=1e-12)
            ends.append(np.concatenate([run.q[-1], run.qd[-1]]))
        x, away = ends[0], ends[1] - ends[0]
        total += np.log(np.linalg.norm(away) / 1e-7)
        away *= 1e-7 / np.linalg.norm(away)
    assert total / (120.0 * period) == pytest.approx(found[0], abs=3.0 * np.sqrt(2.0) * 0.008)


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


def test_starts_that_arrive_at_a_known_cycle_end_on_it(monkeypatch):
    """Each start of the later ones ends where it does when it is run until it repeats itself, and runs for less."""
    quick = basin(subcritical(0.30), 1.2, 400)
    monkeypatch.setattr("squealbox.limit_cycles.attractors.basins.PILOT", 64)
    piloted = basin(subcritical(0.30), 1.2, 400)
    assert np.array_equal(piloted.attractor, quick.attractor)
    assert np.sum(piloted.time) <= np.sum(quick.time)


def test_a_motion_arrives_only_where_it_comes_nearer():
    """Windows of 1 s on a cycle of 0.5 s with a multiplier of 0.7: the distance must fall to (1 + 0.49)/2 at most."""
    cycle = Known(np.array([-1.0]), np.array([1.0]), 0.5, 0.7)

    def window(away):
        return np.array([[-1.0 - 2.0 * away]]), np.array([[1.0 + 2.0 * away]])

    assert cycle.reached(window(0.04), window(0.02), 1.0)[0]
    assert not cycle.reached(window(0.04), window(0.031), 1.0)[0]
    assert not cycle.reached(window(0.2), window(0.06), 1.0)[0]
    assert not cycle.reached(window(0.02), window(0.04), 1.0)[0]
