"""A refined grid gathers at the boundary: against a circle, and against the onset found by a root."""

import numpy as np
import pytest

from squealbox import complex_modes, critical_value, plot, sweep
from squealbox.parameters import ParameterError
from squealbox.studies import Refined, StudyError

AXES = {"x": np.linspace(-1.0, 1.0, 9), "y": np.linspace(-1.0, 1.0, 9)}


def circle(at):
    x, y = at
    return {"inside": 0.7**2 - x * x - y * y, "row": [1.0, 2.0]}


def pair(x, y):
    return x, y


@pytest.mark.parametrize("rounds", [1, 3, 5])
def test_every_cell_on_a_circle_is_halved_to_the_end_and_no_other(rounds):
    table = sweep(pair, Refined(AXES, of="inside", rounds=rounds), circle)
    x, y, added = (table[name].values for name in ("x", "y", "round"))
    assert len(set(zip(x, y, strict=True))) == len(x)  # no point twice
    size = 0.25 / 2**rounds
    # every place on the circle has a point of the last round within the diagonal of a cell of the round before
    angle = np.linspace(0.0, 2.0 * np.pi, 400)
    last = added == rounds
    away = np.hypot(x[last, None] - 0.7 * np.cos(angle), y[last, None] - 0.7 * np.sin(angle)).min(axis=0)
    assert away.max() < 2.0 * size * np.sqrt(2.0)
    # and points of the last round lie nowhere else: in a cell of twice the size that the circle crosses
    assert np.max(np.abs(np.hypot(x[last], y[last]) - 0.7)) < 2.0 * size * np.sqrt(2.0)
    whole = (8 * 2**rounds + 1) ** 2
    assert len(x) < whole or rounds == 1
    assert len(x) < 81 + 24 * 8 * 2**rounds  # grows with the length of the circle, not with the area


def test_the_onset_of_the_drum_is_enclosed(drum):
    axes = {"friction.static": np.linspace(0.0, 0.6, 7)}
    table = sweep(drum, Refined(axes, of="largest_growth_rate", rounds=10), complex_modes)
    values, growth = table["friction.static"].values, table["largest_growth_rate"].values
    below, above = np.max(values[growth < 0.0]), np.min(values[growth > 0.0])
    assert below < critical_value(drum, "friction.static", (0.0, 0.6)).value < above
    assert above - below == pytest.approx(0.1 / 2**10, rel=1e-9)
    assert values.size < 7 + 2 * 10
    assert plot(table).axes


def test_blocks_workers_and_a_folder_change_nothing(drum, tmp_path):
    axes = {"friction.static": np.linspace(0.2, 0.6, 5), "load": np.linspace(1e3, 1e4, 4)}
    space = Refined(axes, of="largest_growth_rate", rounds=3)
    for name, how in {"a": {}, "b": {"chunk": 3}, "c": {"workers": 2, "chunk": 5}}.items():
        sweep(drum, space, complex_modes, out=tmp_path / name, **how)
    files = {name: (tmp_path / name / "sweep.nc").read_bytes() for name in "abc"}
    assert files["a"] == files["b"] == files["c"]


def test_a_stopped_refinement_goes_on(tmp_path):
    def stop_after(points):
        def stop(pace):
            if pace.done >= points:
                raise KeyboardInterrupt

        return stop

    space = Refined(AXES, of="inside", rounds=2)
    for points in (60, 150):  # in the first round, and in a later one
        found = sweep(pair, space, circle, out=tmp_path / "study", chunk=7, progress=stop_after(points))
        assert found.outcome == "interrupted"
    whole = sweep(pair, space, circle, out=tmp_path / "study", chunk=7)
    assert whole.outcome.ok
    np.testing.assert_array_equal(whole["inside"].values, sweep(pair, space, circle)["inside"].values)


@pytest.mark.parametrize(
    ("make", "words"),
    [
        (lambda: Refined({"x": [1.0, 0.0]}, of="a"), "rising order"),
        (lambda: Refined({"x": [1.0]}, of="a"), "two or more numbers"),
        (lambda: Refined({"x": ["a", "b"]}, of="a"), "two or more numbers"),
        (lambda: Refined({"x": [0.0, 1.0]}, of="a", rounds=0), "whole number"),
    ],
)
def test_a_refinement_that_makes_no_sense_is_refused(make, words):
    with pytest.raises(ParameterError, match=words):
        make()


@pytest.mark.parametrize(("of", "words"), [("nothing", "no point has"), ("row", "one number for each point")])
def test_an_answer_that_cannot_be_followed_is_said(of, words):
    with pytest.raises(StudyError, match=words):
        sweep(pair, Refined(AXES, of=of, rounds=1), circle)
