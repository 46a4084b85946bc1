"""Isolated branches from long runs against shooting from a known start, and both ways as one branch."""

from dataclasses import replace

import numpy as np
import pytest

from squealbox import DrumBrake, LinearSlope, ParameterError, branch, hopf_point, shooting
from squealbox.limit_cycles import isolated_branches, joined, settled_cycles
from squealbox.limit_cycles.branches.isolated import lies_on

DRUM = DrumBrake(friction=LinearSlope(0.34, -0.05), reading="consistent")
LARGE, SMALL = ([3e-5, 1e-5], [0.3, -0.3]), None  # a start far from sliding, and the growing mode


@pytest.fixture(scope="module")
def found():
    return settled_cycles(DRUM, 12)


def test_runs_find_the_coexisting_cycles(found):
    """A start by hand finds each of the two; the draw finds both, once each, the larger first."""
    assert len(found) == 2
    for cycle, start in zip(found, (LARGE, SMALL), strict=True):
        known = shooting(DRUM, start)
        assert float(cycle.period) == pytest.approx(float(known.period), rel=1e-9)
        np.testing.assert_allclose(cycle.amplitude, known.amplitude, rtol=1e-7)
        assert cycle.stable
    assert found[0].amplitude[1] > 1.2 * found[1].amplitude[1]


def test_no_cycle_is_an_empty_answer():
    assert settled_cycles(DRUM.replace({"friction.static": 0.05}), 4) == ()
    with pytest.raises(ParameterError, match="shape"):
        settled_cycles(DRUM, np.zeros((3, 3)))


def test_a_branch_no_hopf_point_leads_to():
    """Sliding is stable in the whole range; what is known already is not followed again."""
    bounds, walk = (0.25, 0.31), {"values": [0.28], "starts": 4, "points": 40}
    assert not hopf_point(DRUM, "friction.static", bounds).outcome.ok
    (one,) = isolated_branches(DRUM, "friction.static", bounds, **walk)
    assert (np.min(one.value), np.max(one.value)) == pytest.approx(bounds)
    assert one.outcome.ok
    assert np.all(np.diff(one.value) > 0.0)
    for i in (0, -1):
        known = shooting(DRUM.replace({"friction.static": float(one.value[i])}), LARGE)
        assert one.period[i] == pytest.approx(float(known.period), rel=1e-8)
    assert isolated_branches(DRUM, "friction.static", bounds, known=(one,), **walk) == ()


def test_both_ways_keep_their_special_points():
    walk = {"start": found_at(0.33), "value": 0.33, "method": "shooting", "points": 20}
    ways = [branch(DRUM, "friction.static", (0.05, 0.6), direction=way, **walk) for way in (-1, 1)]
    one = joined(*ways)
    assert len(one.value) == len(ways[0].value) + len(ways[1].value) - 1
    for value, i in zip(one.special_value, one.special_point, strict=True):
        low, high = sorted(one.value[i : i + 2])
        assert low - 1e-3 <= value <= high + 1e-3  # a fold lies beyond both
    assert len(one.special_value) == sum(len(way.special_value) for way in ways) > 0


def found_at(static):
    return shooting(DRUM.replace({"friction.static": static}), LARGE)


def test_a_branch_that_ended_early_lies_on_the_one_that_goes_on():
    brake = DrumBrake(friction=LinearSlope(0.3, -0.05))
    onset = hopf_point(brake, "friction.static", (0.1, 0.6))
    short, long = (branch(brake, "friction.static", (0.1, 0.6), onset, points=count) for count in (6, 24))
    assert lies_on(short, long)
    assert not lies_on(long, short)
    assert not lies_on(short, replace(long, period=1.1 * long.period))
