"""The derivative of a period's end by a parameter, across stick, slip and reversal, against differences of runs."""

import numpy as np
import pytest

from small_systems import two_blocks_on_belt
from squealbox import DrumBrake, LinearSlope, shooting
from squealbox.family import Family
from squealbox.limit_cycles.branches.phases import begun
from squealbox.limit_cycles.branches.shooting_path import ShootingPath
from squealbox.limit_cycles.cycles.variation import quick_flight

CONSISTENT = DrumBrake(friction=LinearSlope(0.3, -0.05), reading="consistent")
EQ3 = CONSISTENT.replace({"reading": "eq3", "friction.static": 0.45})
SLOW, FAST = ([3e-5, 1e-5], [0.3, -0.3]), ([1e-5, 1e-5], [0.3, 0.3])

CASES = {
    "friction": (CONSISTENT, "friction.static", 0.3, 0.13, SLOW),
    "load": (CONSISTENT, "load", 1000.0, 3000.0, SLOW),
    "speed": (CONSISTENT, "sliding_speed", 0.2, 1.0, SLOW),
    "angle": (CONSISTENT, "theta1", CONSISTENT.theta1, 1.0, SLOW),
    "sticking": (EQ3, "friction.static", 0.45, 0.4, FAST),
    "release": (lambda v: two_blocks_on_belt(speed=v), "speed", 0.1, 0.1, ([0.1, 0.2], [0.05, 0.02])),
}


def path_of(name):
    design, parameter, value, span, start = CASES[name]
    make = Family(design, [parameter]).system
    path = ShootingPath(make, 1e-12, span)
    cycle = shooting(make(value), start)
    assert cycle.outcome.ok
    return path, begun(path, cycle, value), value, cycle


@pytest.mark.parametrize("name", CASES)
def test_it_is_what_differences_say(name):
    """Runs to 1e-12, so central differences over 1e-6 of the span are good to some 1e-7 of the largest entry."""
    path, x, p, cycle = path_of(name)
    _, by_p = path.jacobian(x, p)
    step = 1e-6 * path.span
    assert path.sequence(x, p + step) == path.sequence(x, p - step)
    expected = (path.residual(x, p + step) - path.residual(x, p - step)) / (2.0 * step)
    assert np.max(np.abs(by_p - expected)) < 1e-6 * np.max(np.abs(expected))
    if name in ("sticking", "release"):
        assert np.max(cycle.sticking_time) > 0.0
    assert len(cycle.event_time) > 0


def test_without_the_events_own_shift_it_would_be_wrong():
    """The negative twin: the belt's speed moves v = 0, and fields that differ in all but that miss it."""
    path, x, p, _ = path_of("speed")
    low, high, distance = path.beside(p)
    right = quick_flight(path.field(p), path.start(x), float(x[-1]), 1e-12, beside=(low, high, distance)).by_p
    low.V = high.V = path.field(p).V
    wrong = quick_flight(path.field(p), path.start(x), float(x[-1]), 1e-12, beside=(low, high, distance)).by_p
    assert np.max(np.abs(wrong - right)) > 1e-2 * np.max(np.abs(right))


def test_where_the_range_ends_one_side_serves():
    """At a slope of 0, where a linear law may rise no further, the derivative is taken from below."""
    design = CONSISTENT.replace({"friction.slope": 0.0})
    path = ShootingPath(Family(design, ["sliding_speed"]).system, 1e-12, 1.0)
    low, high, distance = path.beside(0.0)
    assert distance in (pytest.approx(1e-5), pytest.approx(2e-5))
    assert low.V is not high.V
