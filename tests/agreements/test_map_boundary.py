"""The boundary read off a map against two other roads: roots along a line, and the curve traced by continuation."""

import numpy as np
import pytest

from squealbox import DrumBrake, LinearSlope, ModeCoupling, complex_modes, critical_value
from squealbox.designs import DESIGNS
from squealbox.stability import map_boundary, stability_boundary, stability_map

BOUNDS = {"friction.static": (0.0, 1.0), "load": (0.0, 2500.0)}


def drum():
    return DrumBrake(friction=LinearSlope(0.30, -0.05))


def mapped(design, bounds, points):
    axes = {name: np.linspace(*ends, points) for name, ends in bounds.items()}
    return stability_map(design, axes, mechanism=False, engine="compiled")


def distances(points, curves):
    """Least distance of each point to any piece of the curves."""
    least = np.full(len(points), np.inf)
    for curve in curves:
        a, way = curve[:-1], np.diff(curve, axis=0)
        length = np.maximum(np.sum(way**2, axis=1), 1e-300)
        for i, point in enumerate(points):
            share = np.clip(np.sum((point - a) * way, axis=1) / length, 0.0, 1.0)
            least[i] = min(least[i], np.min(np.linalg.norm(a + share[:, None] * way - point, axis=1)))
    return least


def in_shares(curves, bounds):
    low, high = np.array(list(bounds.values())).T
    return [(curve - low) / (high - low) for curve in curves]


def test_each_crossing_of_a_grid_line_is_the_critical_value_there():
    edge = map_boundary(mapped(drum(), BOUNDS, 41))
    rows = np.isclose(edge.y % 62.5, 0.0, atol=1e-9) & (edge.y > 0.0)
    assert np.sum(rows) == 40, "each line of constant load is crossed once"
    for x, y in zip(edge.x[rows][::5], edge.y[rows][::5], strict=True):
        value = critical_value(drum().replace(load=y), "friction.static", (0.0, 1.0)).value
        assert x == pytest.approx(float(value), abs=1e-10)  # both are good to 1e-12 of the range


def test_it_nears_the_traced_boundary_with_the_square_of_the_cell():
    """Between exact points both are chords: the distance is a height of arcs, and falls by four with half the cell."""
    traced = in_shares(stability_boundary(drum(), BOUNDS).curves, BOUNDS)[0]
    far = []
    for points in (26, 51, 101):
        drawn = in_shares(map_boundary(mapped(drum(), BOUNDS, points)).curves, BOUNDS)
        far.append(float(np.max(distances(traced[1:-1], drawn))))
    assert far[2] < 1e-3 / 4  # of the axes: a quarter of a pixel of the page
    assert far[0] > far[1] > far[2]
    assert far[0] / far[2] > 8.0  # 16 where every chord were replaced by two


def test_what_a_straight_line_between_grid_points_gives_is_far_worse():
    """The negative twin: the crossing interpolated in the growth rate, as a picture of the grid would have it."""
    found = mapped(drum(), BOUNDS, 41)
    edge, growth = map_boundary(found), found.growth_rate
    row = 16  # load of 1000 N
    i = int(np.argmax(growth[:, row] > 0.0))
    share = growth[i - 1, row] / (growth[i - 1, row] - growth[i, row])
    straight = (i - 1 + share) / 40.0
    exact = float(edge.x[np.isclose(edge.y, 1000.0, atol=1e-9)][0])
    critical = float(critical_value(drum(), "friction.static", (0.0, 1.0)).value)
    assert exact == pytest.approx(critical, abs=1e-10)
    assert abs(straight - critical) > 1e-3


@pytest.mark.parametrize("name", sorted(DESIGNS))
def test_points_of_every_design_lie_between_stable_and_unstable(name):
    """A step of a millionth of the axis to either side along the grid line changes stability."""
    design = DESIGNS[name]()
    speed = "sliding_speed" if "sliding_speed" in design.field_names() else "spin"
    bounds = {"friction.static": (0.05, 0.9), speed: (0.05, 2.0)}
    edge = map_boundary(mapped(design, bounds, 21))
    low, width = np.array([[a, b - a] for a, b in bounds.values()]).T
    node = 20.0 * (np.column_stack([edge.x, edge.y]) - low) / width
    axis = np.argmax(np.abs(node - np.round(node)), axis=1)  # the one along which the edge runs
    shift = 1e-6 * width * np.eye(2)[axis]
    stable = []
    for side in (-1.0, 1.0):
        x, y = np.column_stack([edge.x, edge.y]).T + side * shift.T
        at = design.replace({"friction.static": x, speed: y})
        stable.append(complex_modes(at).stable)
    assert np.all(stable[0] != stable[1])
    assert (edge.outcome == "no_boundary") == (len(edge.x) == 0)


def test_the_unstable_side_is_on_the_left():
    edge = map_boundary(mapped(drum(), BOUNDS, 41))
    points = edge.curves[0]
    middle, way = 0.5 * (points[1:] + points[:-1]), np.diff(points, axis=0)
    scale = np.array([1.0, 2500.0])
    left = np.column_stack([-way[:, 1] / scale[1], way[:, 0] / scale[0]])
    left *= 2e-3 / np.linalg.norm(left, axis=1)[:, None]
    x, y = (middle + left * scale).T
    inside = (y > 0.0) & (y < 2500.0)
    assert np.all(~complex_modes(drum().replace({"friction.static": x[inside], "load": y[inside]})).stable)


def test_an_island_is_closed_and_a_plane_without_boundary_says_so():
    bounds = {"theta1": (0.2, 3.0), "theta2": (0.2, 3.0)}
    found = mapped(DrumBrake(friction=LinearSlope(0.45, -0.05)), bounds, 61)
    edge = map_boundary(found)
    traced = stability_boundary(DrumBrake(friction=LinearSlope(0.45, -0.05)), bounds)
    assert len(edge.curves) == len(traced.curves)
    assert [edge.closed(i) for i in range(len(edge.curves))].count(True) == [
        traced.closed(i) for i in range(len(traced.curves))
    ].count(True)
    nothing = map_boundary(mapped(drum(), {"friction.static": (0.0, 0.1), "load": (100.0, 200.0)}, 5))
    assert nothing.outcome == "no_boundary"
    assert nothing.curves == []


def test_a_map_of_another_shape_is_refused():
    one = stability_map(drum(), {"load": [1.0, 2.0]}, mechanism=False)
    with pytest.raises(ValueError, match="expected two"):
        map_boundary(one)
    of_function = stability_map(
        lambda a, b: ModeCoupling().replace({"friction.static": a}), {"a": [0.1, 0.9], "b": [0, 1]}
    )
    with pytest.raises(ValueError, match="function"):
        map_boundary(of_function)
