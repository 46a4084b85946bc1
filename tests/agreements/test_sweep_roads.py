"""A sweep gives what a loop gives, in memory or through its folder, whatever the size of its blocks."""

import functools

import numpy as np
import pytest
import xarray

from squealbox import DrumBrake, complex_modes, critical_value, simulate, simulate_ensemble, sweep
from squealbox.limit_cycles import shooting
from squealbox.result import Result
from squealbox.studies import StudyError, Sweep, batched, grid, zipped

SPACE = {"friction.static": np.linspace(0.1, 0.5, 4), "reading": ["eq3", "consistent"], "load": [1e3, 2e3, 3e3]}


def same(a, b):
    """Two datasets agree bit for bit, in every variable and coordinate and in their attributes."""
    assert set(a.variables) == set(b.variables)
    assert a.attrs == b.attrs
    for name in a.variables:
        assert a[name].dims == b[name].dims
        assert a[name].attrs == b[name].attrs
        left, right = np.asarray(a[name].values), np.asarray(b[name].values)
        assert (left.dtype == right.dtype) or left.dtype.kind in "OU", name
        np.testing.assert_array_equal(left, right)
    return True


def test_a_batched_analysis_gives_what_a_loop_gives(drum):
    table = sweep(drum, SPACE, complex_modes)
    assert table.outcome.ok
    for i, static in enumerate(SPACE["friction.static"]):
        for j, reading in enumerate(SPACE["reading"]):
            for k, load in enumerate(SPACE["load"]):
                modes = complex_modes(drum.replace({"friction.static": static, "reading": reading, "load": load}))
                found = table.dataset.isel({"friction.static": i, "reading": j, "load": k})
                np.testing.assert_array_equal(found["growth_rate"], modes.growth_rate)
                np.testing.assert_array_equal(found["frequency"], modes.frequency)
                assert found["unstable_modes"] == modes.unstable_modes
    assert table["growth_rate"].attrs == {"units": "1/s", "long_name": "growth rate of each mode"}
    assert table["load"].attrs["units"] == "N"
    wrong = complex_modes(drum.replace(load=1.5e3)).growth_rate
    assert not np.array_equal(table.dataset.isel({"friction.static": 0, "reading": 0, "load": 0})["growth_rate"], wrong)


@pytest.mark.parametrize("chunk", [1, 5, 24, None])
def test_blocks_and_folder_change_nothing(drum, tmp_path, chunk):
    plain = sweep(drum, SPACE, complex_modes, chunk=24)
    stored = sweep(drum, SPACE, complex_modes, out=tmp_path / "study", chunk=chunk)
    assert same(plain.dataset, stored.dataset)
    assert sorted(each.name for each in (tmp_path / "study").iterdir()) == [
        "axes.npz", "blocks", "finished.json", "lock", "run.log", "study.json", "sweep.nc",
    ]  # fmt: skip
    assert not list((tmp_path / "study" / "blocks").iterdir())


def test_equal_studies_give_equal_bytes_and_the_file_describes_itself(drum, tmp_path):
    for name, chunk in (("a", 7), ("b", 3)):
        sweep(drum, SPACE, complex_modes, out=tmp_path / name, chunk=chunk)
    assert (tmp_path / "a" / "sweep.nc").read_bytes() == (tmp_path / "b" / "sweep.nc").read_bytes()
    with xarray.open_dataset(tmp_path / "a" / "sweep.nc", engine="h5netcdf") as raw:
        assert raw["friction.static"].dims == ("friction.static",)
        assert set(raw["outcome"].values.ravel()) == {"completed"}
        assert "sliding_speed" in raw.attrs["inputs"]
    loaded = Result.load(tmp_path / "a" / "sweep.nc")
    assert isinstance(loaded, Sweep)
    assert loaded.inputs["design"] == drum
    again = Result.load(loaded.save(tmp_path / "copy.nc"))
    assert same(loaded.dataset, again.dataset)


def test_every_analysis_can_be_swept(drum):
    critical = sweep(drum, {"load": [1e3, 2e3]}, lambda d: critical_value(d, "friction.static", (0.1, 0.6)))
    expected = critical_value(drum.replace(load=2e3), "friction.static", (0.1, 0.6))
    assert critical["value"].values[1] == expected.value
    assert critical["mechanism"].values[1] == expected.mechanism
    space = {"friction.static": np.linspace(0.1, 0.45, 20)}
    many = sweep(
        drum, space, functools.partial(simulate_ensemble, duration=2e-3, observe=("amplitude", "energy")), chunk=7
    )
    direct = simulate_ensemble(drum, space, duration=2e-3, observe=("amplitude", "energy"))
    np.testing.assert_array_equal(many["amplitude"].values, direct["amplitude"])
    np.testing.assert_array_equal(many["energy"].values, direct["energy"])
    assert many["amplitude"].dims == ("friction.static", "dof")
    assert many["energy"].dims == ("friction.static", "contact")
    assert many["energy"].attrs["units"] == "J"
    motion = sweep(drum, {"load": [1e3, 2e3]}, functools.partial(simulate, duration=1e-3, times=11))
    np.testing.assert_array_equal(motion["q"].values[1], simulate(drum.replace(load=2e3), 1e-3, times=11).q)
    cycles = sweep(drum, {"friction.static": [0.2, 0.45]}, shooting)
    direct = shooting(drum.replace({"friction.static": 0.45}))
    assert cycles["period"].values[1] == direct.period
    assert cycles["amplitude"].attrs["units"] == "m"


def test_keep_chooses_names_and_any_attribute(drum):
    table = sweep(drum, {"load": [1e3, 2e3]}, complex_modes, keep=("largest_growth_rate", "stable", "eigenvalues"))
    assert table.answers == ["largest_growth_rate", "stable", "eigenvalues"]
    assert table["eigenvalues"].dtype == complex
    assert table["stable"].dtype == bool
    with pytest.raises(StudyError, match="did you mean 'frequency'"):
        sweep(drum, {"load": [1e3]}, complex_modes, keep="frequencies")


def test_own_functions_with_units_words_and_rows_of_unequal_length(drum):
    def answer(design):
        return {"n": 3, "word": "x" * int(design.load1), "row": np.arange(design.load1), "flag": design.load1 > 1.0}

    table = sweep(drum, {"load": [1.0, 3.0]}, answer, units={"row": "mm"}, chunk=1)
    assert table["n"].dtype.kind == "i"
    assert table["word"].values.tolist() == ["x", "xxx"]
    np.testing.assert_array_equal(table["row"].values, [[0.0, np.nan, np.nan], [0.0, 1.0, 2.0]])
    assert table["row"].attrs["units"] == "mm"
    assert table["flag"].values.tolist() == [False, True]
    assert sweep(lambda load, slip: load + slip, zipped({"load": [1, 2], "slip": [3, 4]}), float)[
        "value"
    ].values.tolist() == [4.0, 6.0]


def test_random_numbers_belong_to_the_point(drum):
    def draw(design, rng):
        return rng.normal()

    one = sweep(drum, {"load": np.arange(9.0)}, draw, seed=5, chunk=2)["value"].values
    other = sweep(drum, {"load": np.arange(9.0)}, draw, seed=5, chunk=4)["value"].values
    np.testing.assert_array_equal(one, other)
    assert len(set(one)) == 9
    assert not np.array_equal(one, sweep(drum, {"load": np.arange(9.0)}, draw, seed=6)["value"].values)


def test_a_failed_point_is_a_result_and_its_neighbours_are_untouched(drum):
    def answer(design):
        if design.load1 == 2.0:
            raise ZeroDivisionError("no way")
        return {"a": 1, "b": design.load1}

    table = sweep(drum, {"load": [1.0, 2.0, 3.0]}, answer)
    assert table.outcomes.tolist() == ["completed", "failed", "completed"]
    assert table.failures == {1: "ZeroDivisionError: no way"}
    np.testing.assert_array_equal(table["a"].values, [1.0, np.nan, 1.0])
    assert table.outcome == "some_failed"
    assert "no way" in table.outcome.message
    loads = np.linspace(-1e3, 3e3, 41)  # a negative load is refused by the design, in the midst of a batch
    batch = sweep(drum, {"load": loads}, complex_modes, chunk=41)
    assert (batch.outcomes == "failed").tolist() == (loads < 0.0).tolist()
    good = complex_modes(drum.replace(load=loads[loads >= 0.0]))
    np.testing.assert_array_equal(batch["growth_rate"].values[loads >= 0.0], good.growth_rate)


def test_a_batched_function_that_answers_for_one_is_found(drum):
    @batched
    def wrong(design):
        return {"a": 1.0}

    table = sweep(drum, {"load": [1.0, 2.0]}, wrong)
    assert set(table.outcomes) == {"failed"}
    assert "expected (1, ...)" in table.failures[0]


def test_what_cannot_be_asked_is_said_before_anything_is_computed(drum, tmp_path):
    with pytest.raises(ValueError, match="did you mean 'load'"):
        sweep(drum, {"loads": [1.0]}, complex_modes, out=tmp_path / "study")
    with pytest.raises(StudyError, match="expected a function"):
        sweep(drum, {"load": [1.0]}, "modes")
    with pytest.raises(StudyError, match="chunk = 0"):
        sweep(drum, {"load": [1.0]}, complex_modes, chunk=0)
    with pytest.raises(StudyError, match="design is a dict"):
        sweep({"m": 1.0}, {"load": [1.0]}, complex_modes)
    with pytest.raises(StudyError, match="returns a dict for a"):
        sweep(drum, {"load": [1.0]}, lambda d: {"a": {}})
    assert not (tmp_path / "study").exists()


def test_a_product_of_a_grid_and_lists_keeps_both(drum):
    space = grid({"friction.static": [0.2, 0.4]}) * zipped({"load1": [1e3, 2e3, 3e3], "load2": [3e3, 2e3, 1e3]})
    table = sweep(drum, space, complex_modes, keep="largest_growth_rate")
    assert table["largest_growth_rate"].dims == ("friction.static", "point")
    assert table.dataset["load2"].dims == ("point",)
    pair = drum.replace({"friction.static": 0.4, "load1": 1e3, "load2": 3e3})
    assert table["largest_growth_rate"].values[1, 0] == complex_modes(pair).largest_growth_rate


def test_points_that_are_known_are_summed_up(drum):
    text = sweep(DrumBrake(), {"load": [1e3, -1.0]}, complex_modes).summary()
    assert "2 points, load (2): 1 completed, 1 failed" in text
    assert "largest_growth_rate" in text
