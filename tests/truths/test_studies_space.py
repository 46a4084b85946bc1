"""The points of a space are those one would write down by hand, and the slices of an array those of NumPy."""

import itertools

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from squealbox.parameters import ParameterError
from squealbox.studies import Scatter, Uniform, grid, latin_hypercube, sampled, sobol_sequence, zipped
from squealbox.studies.layout import open_ranges, slabs


def test_a_grid_is_the_product_with_the_last_axis_fastest():
    axes = {"a": [1.0, 2.0], "b": ["x", "y", "z"], "c": [5.0, 6.0]}
    space = grid(axes)
    rows = list(zip(*space.points(0, len(space)).values(), strict=True))
    assert rows == list(itertools.product(*axes.values()))
    assert (space.shape, space.dims, space.names) == ((2, 3, 2), ("a", "b", "c"), ("a", "b", "c"))
    part = space.points(5, 9)
    assert list(zip(*part.values(), strict=True)) == rows[5:9]


def test_lists_side_by_side_and_their_product_with_a_grid():
    space = zipped({"load": [1.0, 2.0], "speed": [3.0, 4.0]}) * grid({"mu": [0.1, 0.2, 0.3]})
    assert space.shape == (2, 3)
    points = space.points(0, 6)
    assert points["load"].tolist() == [1.0] * 3 + [2.0] * 3
    assert points["speed"].tolist() == [3.0] * 3 + [4.0] * 3
    assert points["mu"].tolist() == [0.1, 0.2, 0.3] * 2
    assert space.coordinates()["speed"][0] == "point"


def test_a_latin_hypercube_hits_every_slice_once():
    count = 50
    space = latin_hypercube({"a": (2.0, 4.0), "b": (1e1, 1e5, "log")}, count, seed=3)
    points = space.points(0, count)
    slices = np.floor((points["a"] - 2.0) / 2.0 * count).astype(int)
    decades = np.floor(np.log10(points["b"] / 1e1) / 4.0 * count).astype(int)
    assert sorted(slices) == sorted(decades) == list(range(count))
    again = latin_hypercube({"a": (2.0, 4.0), "b": (1e1, 1e5, "log")}, count, seed=3).points(0, count)
    other = latin_hypercube({"a": (2.0, 4.0), "b": (1e1, 1e5, "log")}, count, seed=4).points(0, count)
    assert np.array_equal(points["a"], again["a"])
    assert not np.array_equal(points["a"], other["a"])


def test_a_sobol_sequence_fills_every_square_of_a_binary_grid():
    points = sobol_sequence({"a": (0.0, 1.0), "b": (0.0, 1.0)}, 64).points(0, 64)
    squares = {(int(8 * a), int(8 * b)) for a, b in zip(points["a"], points["b"], strict=True)}
    assert len(squares) == 64  # a (0, 6, 2) net: one point in each of 8 x 8
    rng = np.random.default_rng(0)
    chance = {(int(8 * a), int(8 * b)) for a, b in rng.random((64, 2))}
    assert len(chance) < 64


def test_a_joint_distribution_is_asked_for_its_sample():
    class Twins:
        def sample(self, count, method, seed):
            assert (method, seed) == ("sobol", 5)
            return {"load1": np.arange(count), "load2": np.arange(count)}

    points = sampled(Twins(), 8, method="sobol", seed=5).points(0, 8)
    assert np.array_equal(points["load1"], points["load2"])


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: grid({}), "at least one parameter"),
        (lambda: grid({"a": []}), "one or more finite numbers"),
        (lambda: grid({"a": [1.0, np.nan]}), "finite numbers"),
        (lambda: grid({"a": [[1.0]]}), "finite numbers"),
        (lambda: zipped({"a": [1.0], "b": [1.0, 2.0]}), "equal length"),
        (lambda: grid({"a": [1.0]}) * grid({"a": [2.0]}), "each parameter once"),
        (lambda: zipped({"a": [1.0]}) * zipped({"b": [2.0]}), "each dimension once"),
        (lambda: latin_hypercube({"a": (1.0, 0.0)}, 4), "low < high"),
        (lambda: latin_hypercube({"a": (0.0, 1.0, "log")}, 4), "positive"),
        (lambda: latin_hypercube({"a": (0.0, 1.0)}, 0), "at least 1"),
        (lambda: sampled(Scatter({"a": Uniform(0.0, 1.0)}), 4, method="magic"), "latin_hypercube"),
    ],
)
def test_a_space_that_makes_no_sense_is_refused(make, words):
    with pytest.raises(ParameterError, match=words):
        make()


@given(st.lists(st.integers(1, 5), min_size=1, max_size=4), st.data())
def test_slabs_put_a_range_of_points_where_numpy_has_them(shape, data):
    total = int(np.prod(shape))
    start = data.draw(st.integers(0, total - 1))
    stop = data.draw(st.integers(start + 1, total))
    whole, values = np.full(shape, -1), np.arange(start, stop)
    for index, part, lengths in slabs(start, stop, tuple(shape)):
        whole[index] = values[part].reshape(lengths)
    expected = np.full(total, -1)
    expected[start:stop] = values
    assert np.array_equal(whole.ravel(), expected)


@given(st.sets(st.integers(0, 29)))
def test_open_ranges_are_what_no_block_holds(held):
    ranges = open_ranges([(i, i + 1) for i in held], 30)
    assert {i for start, stop in ranges for i in range(start, stop)} == set(range(30)) - held
    assert all(start < stop for start, stop in ranges)
