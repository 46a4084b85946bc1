"""A branch's motions by one prepared step: the same as `simulate`'s of each system, and its systems are made anew where
their numbers are no sums of the parameter."""

import numpy as np
import pytest

from small_systems import block_on_belt, two_blocks_on_belt
from squealbox import Coulomb, DrumBrake, LinearSlope, Stribeck, branch, shooting, simulate
from squealbox.family import Family
from squealbox.limit_cycles.branches import branch as branches
from squealbox.limit_cycles.branches.phases import begun
from squealbox.limit_cycles.branches.shooting_path import ShootingPath
from squealbox.limit_cycles.cycles.cycle import extremes
from squealbox.limit_cycles.cycles.field import Field
from squealbox.limit_cycles.cycles.variation import flight

DRUM = DrumBrake(friction=LinearSlope(0.3, -0.05), reading="consistent")
STICKS = DRUM.replace({"reading": "eq3", "friction.static": 0.45})
SLOW, FAST = ([3e-5, 1e-5], [0.3, -0.3]), ([1e-5, 1e-5], [0.3, 0.3])
CASES = {
    "friction": (DRUM, "friction.static", (0.25, 0.33), 0.3, SLOW, True),
    "sticking": (STICKS, "sliding_speed", (0.4, 0.6), STICKS.sliding_speed, FAST, True),
    "angle": (DRUM, "theta1", (DRUM.theta1 - 0.1, DRUM.theta1 + 0.1), DRUM.theta1, SLOW, False),
    "function": (lambda v: two_blocks_on_belt(speed=v), "speed", (0.08, 0.12), 0.1, ([0.1, 0.2], [0.05, 0.02]), True),
}


def path_of(name):
    design, parameter, bounds, value, start, _ = CASES[name]
    family = Family.within("branch", design, parameter, bounds)
    path = ShootingPath(family.system, 1e-11, bounds[1] - bounds[0], bounds, at_once=family.recipe is None)
    return path, begun(path, shooting(family.system(value), start), value), bounds


@pytest.mark.parametrize("name", CASES)
def test_they_are_those_of_the_systems(name):
    """At a value where no system was made: end, rate, derivative and extremes, against the equation in NumPy."""
    path, x, (low, high) = path_of(name)
    p = low + 0.37 * (high - low)
    assert (path.motions.line is not None) == CASES[name][-1]
    start, flown = path.fly(x, p)
    n, period = len(start) // 2, float(x[-1])
    system = path.make(p)
    run = simulate(system, period, (start[:n], start[n:]), np.linspace(0.0, period, 20_001), rtol=1e-13)
    field = Field(system)
    exact = flight(field, start, period)
    size = np.max(np.abs(exact.x * field.scale))
    assert np.max(np.abs((flown.x - exact.x) * field.scale)) < 1e-10 * size
    np.testing.assert_allclose(flown.rate * field.scale, exact.rate * field.scale, rtol=0.0,
                               atol=1e-9 * np.max(np.abs(exact.rate * field.scale)))  # fmt: skip
    ratio = field.scale[:, None] / field.scale
    assert np.max(np.abs((flown.phi - exact.phi) * ratio)) < 1e-9 * np.max(np.abs(exact.phi * ratio))
    np.testing.assert_array_equal(flown.motion.event_mode, run.event_mode)
    seen = path.describe(x, p)
    for found, right in zip((seen["lowest"], seen["highest"]), extremes(run.t, run.q, run.qd), strict=True):
        assert np.max(np.abs(found - right)) < 1e-8 * np.max(np.ptp(run.q, axis=0))


def test_numbers_that_are_no_sums_are_noticed(monkeypatch):
    """A speed that leaves its line only between the values tried: followed as a sum at first, then anew, as it is."""

    def belt(v):
        bump = 0.01 * max(0.0, 1.0 - abs(v - 0.24) / 0.01)
        return block_on_belt(Stribeck(0.4, 0.25, 0.3), v + bump, damping=0.05)

    walks = []

    def counted(*given):
        walks.append(usual(*given))
        return walks[-1]

    usual = branches.walked
    monkeypatch.setattr(branches, "walked", counted)
    found = branch(belt, "v", (0.2, 0.3), value=0.22, method="shooting", points=12, largest_step=0.1)
    assert len(walks) == 2
    beside = np.abs(found.value - 0.24) < 0.01
    assert np.any(beside)
    assert np.any(~beside)
    for v, period in zip(found.value, found.period, strict=True):
        assert float(shooting(belt(float(v))).period) == pytest.approx(period, rel=1e-8)


def test_a_system_of_another_structure_is_followed_too():
    """Without damping at one value and with it at the others, whose step has more numbers."""
    found = branch(lambda c: block_on_belt(Coulomb(0.4, 0.25), 0.1, damping=c), "c", (0.0, 0.02), value=0.0,
                   method="shooting", points=4)  # fmt: skip
    assert len(found.value) == 4
    for c, period in zip(found.value, found.period, strict=True):
        cycle = shooting(block_on_belt(Coulomb(0.4, 0.25), 0.1, damping=float(c)))
        assert float(cycle.period) == pytest.approx(period, rel=1e-9)
