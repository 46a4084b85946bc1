"""Sweeps, regions of coexistence and exact cycles of the drum: two roads, one answer."""

import numpy as np
import pytest

from squealbox import DrumBrake, LinearSlope, critical_value, shooting
from squealbox.limit_cycles import bifurcation_diagram, coexistence, cycle_ends
from squealbox.parameters import ParameterError

FRICTION = "friction.static"


def drum(slope=-0.05, **changes):
    return DrumBrake(friction=LinearSlope(0.3, slope)).replace(changes)


def test_sweeps_end_in_the_exact_cycles_and_in_sliding():
    """Down: on the stick-slip cycle that shooting finds; up and from rest: sliding. Negative twin: above the onset none
    of them rests."""
    diagram = bifurcation_diagram(drum(), FRICTION, np.linspace(0.15, 0.36, 8))
    up, down, rest = diagram.kind
    i = 4
    assert diagram.value[i] == pytest.approx(0.27)
    assert (up[i], down[i], rest[i]) == (1, 2, 1)
    assert diagram.coexist[i]
    state = diagram.state[1, i]
    cycle = shooting(drum().replace({FRICTION: float(diagram.value[i])}), (state[:2], state[2:]), settle=0.0)
    assert cycle.stable
    np.testing.assert_allclose(diagram.amplitude[1, i], cycle.amplitude, rtol=1e-3)  # windows alike to 1e-3
    assert np.all(diagram.kind[:, -1] == 2)
    assert np.all(diagram.kind[:, 0] == 1)
    assert np.all(diagram.amplitude[:, 0] == 0.0)


def test_edges_of_the_region_by_runs_and_by_exact_cycles():
    """Lower edge: runs followed down, and the fold of exact cycles solved for. Upper: critical friction, Hopf curve."""
    bounds = {FRICTION: (0.05, 0.4), "load": (1000.0, 2000.0)}
    region = coexistence(drum(), bounds, columns=6, rows=2, starts=4)
    value, kind = cycle_ends(drum(), region)
    assert kind.tolist() == ["fold", "fold"]
    # the edge lies within the resolution above the end; seen twice as late, because what passes a fold lingers
    assert np.all(np.abs(value - region.end) < 2.0 * region.resolution)
    order = np.argsort(region.hopf.y)
    for load, onset in zip(region.y, region.onset, strict=True):
        exact = critical_value(drum(load=load), FRICTION, (0.1, 0.4)).value
        assert onset == pytest.approx(float(exact), rel=1e-9)
        assert np.interp(load, region.hopf.y[order], region.hopf.x[order]) == pytest.approx(
            onset, abs=2e-3
        )  # between points
    assert np.any(region.stable & (region.vibrates > 0.0))
    below = region.x < np.min(region.end) - 0.01
    assert not np.any(region.vibrates[below])


def test_without_slope_only_load_over_speed_counts():
    """With constant friction the equation is linear in load and V together: twice the load is half the speed."""
    flat, friction = drum(slope=0.0), (0.05, 0.4)
    by_load = coexistence(flat, {FRICTION: friction, "load": (1000.0, 2000.0)}, columns=3, rows=2, starts=4)
    by_speed = coexistence(flat, {FRICTION: friction, "sliding_speed": (0.1, 0.2)}, columns=3, rows=2, starts=4)
    np.testing.assert_allclose(by_speed.onset[::-1], by_load.onset, rtol=1e-9)
    assert np.all(np.abs(by_speed.end[::-1] - by_load.end) <= 2.0 * by_load.resolution)
    assert abs(by_load.end[0] - by_load.end[1]) > 100.0 * by_load.resolution[0]  # and load alone does count


def test_what_is_refused():
    with pytest.raises(ParameterError, match="rising"):
        bifurcation_diagram(drum(), FRICTION, [0.2, 0.1])
    with pytest.raises(ParameterError, match="sweeps"):
        bifurcation_diagram(drum(), FRICTION, [0.1, 0.2], sweeps=("sideways",))
    with pytest.raises(ParameterError, match="two parameters"):
        coexistence(drum(), {FRICTION: (0.1, 0.2)})
