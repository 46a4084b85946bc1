"""Runs that cannot go on end with a name and a sentence, senseless input gets one sentence, and results survive."""

import importlib
import warnings

import numpy as np
import pytest

from small_systems import METHODS, block_on_belt, drum, two_blocks_on_belt
from squealbox import (
    Constant,
    Contact,
    Coulomb,
    DrumBrake,
    LinearSlope,
    MassOnBelt,
    Method,
    ParameterError,
    System,
    simulate,
)
from squealbox.compiled.machine import Translated
from squealbox.result import Outcome, Result, ResultFileError
from squealbox.system import InvalidSystem
from squealbox.transient import Trajectory, _engine, packing
from squealbox.transient.lanes import single

module = importlib.import_module("squealbox.transient.legs")


def assert_reached(motion):
    """What was reached is there, finite, and told."""
    assert motion.outcome.message.endswith("s")
    assert f"{motion.outcome.evidence['time']:.9g} s of" in motion.outcome.message
    assert motion.outcome.evidence["q"] == motion.q[-1].tolist()
    assert motion.outcome.evidence["accepted"] == motion.steps
    for name in ("t", "q", "qd", "friction_force"):
        assert np.all(np.isfinite(getattr(motion, name)))


@pytest.mark.parametrize("contact", ["exact", "raw"])
def test_step_limit(contact):
    motion = simulate(drum(0.3), 0.05, method=Method("dormand-prince", rtol=1e-8, most_steps=40), contact=contact)
    assert motion.outcome == "step_limit"
    assert motion.steps + motion.rejected == 40
    assert_reached(motion)


@pytest.mark.parametrize("method", METHODS)
def test_plain_sgn_with_preload_does_not_finish(method):
    # issue 3: with preload and real sticking plain sgn cannot finish; it must say so, and soon
    chosen = Method(method, rtol=1e-6, most_steps=20_000)
    motion = simulate(drum(0.44, preload=1000.0), 0.05, method=chosen, contact="raw")
    # where a higher order reverses now and then only, the run may reach its limit before that shows
    expected = {"chattering"} if method == "bogacki-shampine" else {"chattering", "step_limit"}
    assert motion.outcome in expected
    assert "sticks" in motion.outcome.message or motion.outcome == "step_limit"
    assert "compare with" in motion.caution
    assert_reached(motion)
    assert simulate(drum(0.44, preload=1000.0), 0.005).outcome == "completed"  # which exact contact does not mind


def runaway(contact):
    """Friction that falls without a floor, and a spring that pushes: nothing holds the block."""
    system = block_on_belt(LinearSlope(0.4, -5.0), 0.5, stiffness=-50.0, normal=10.0)
    return simulate(system, 1e3, ([0.1], [0.0]), method="dormand-prince", contact=contact)


@pytest.mark.parametrize("contact", ["exact", "raw"])
def test_motion_that_runs_away_is_not_finite(contact):
    motion = runaway(contact)
    assert motion.outcome == "not_finite"
    assert motion.t[-1] < 1e3
    assert_reached(motion)


def test_strongly_negative_damping_is_not_finite():
    motion = simulate(System([[1.0]], [[-80.0]], [[1.0]], 1.0), 100.0)
    assert motion.outcome == "not_finite"
    assert_reached(motion)


def test_a_stable_run_has_nothing_to_say():
    motion = simulate(MassOnBelt(c=1.0, friction=Coulomb(0.3)), 0.002)  # no contact of it is pulled, as the drum's is
    assert (motion.outcome, motion.outcome.message, motion.caution) == ("completed", "", "")


@pytest.mark.parametrize("method", ["taylor", "dormand-prince-8"])
def test_interrupted(monkeypatch, method):
    # Ctrl-C between two calls of the compiled march: the run ends with what it has
    calls = []

    def impatient(march):
        def run(*given):
            calls.append(1)
            if len(calls) == 4:
                raise KeyboardInterrupt
            return march(*given)

        return run

    kernel, advance = _engine.kernel, single.Single.advance
    monkeypatch.setattr(_engine, "kernel", lambda *given, **options: impatient(kernel(*given, **options)))
    monkeypatch.setattr(single.Single, "advance", impatient(advance))
    monkeypatch.setattr(module, "BUDGET", (20, 20))
    monkeypatch.setattr(single, "FIRST", 20)
    monkeypatch.setattr(single, "MOST", 20)
    motion = simulate(drum(0.3), 0.05, method=method)
    assert motion.outcome == "interrupted"
    assert motion.steps > 0
    assert motion.outcome.evidence["time"] == motion.t[-1]
    assert f"{motion.t[-1]:g}" in motion.outcome.message


ONE = System([[1.0]], [[0.0]], [[1.0]])


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ({"duration": 0.0}, ("duration", "(0, inf)")),
        ({"duration": -1.0}, ("duration", "(0, inf)")),
        ({"duration": np.nan}, ("duration", "finite")),
        ({"duration": np.inf}, ("duration", "finite")),
        ({"start_time": np.nan}, ("start_time", "finite")),
        ({"start": ([np.nan], [0.0])}, ("start", "finite")),
        ({"start": ([0.0], [np.inf])}, ("start", "finite")),
        ({"start": ([0.0, 1.0], [0.0])}, ("start", "1 values each")),
        ({"start": [0.0]}, ("start", "1 values each")),
        ({"start": "resting"}, ("start", '"rest" or "sliding"')),
        ({"start": 3.0}, ("start", '"rest" or "sliding"')),
        ({"times": [0.0, 2.0]}, ("times", "[0, 1] s")),
        ({"times": [-0.1, 0.5]}, ("times", "[0, 1] s")),
        ({"times": [0.5, 0.2]}, ("times", "increasing")),
        ({"times": [0.5, np.nan]}, ("times", "increasing")),
        ({"times": [[0.1, 0.2]]}, ("times", "increasing")),
        ({"times": 1}, ("times", "at least 2")),
        ({"times": 2.5}, ("times", "whole number")),
        ({"method": "runge-kutta"}, ("tableau", "bogacki-shampine")),
        ({"method": "dormand_prince"}, ("did you mean 'dormand-prince'",)),
        ({"contact": "rough"}, ("contact", "exact", "time-stepping")),
        ({"contact": "exakt"}, ("did you mean 'exact'",)),
        ({"width": 0.0}, ("width", "(0, inf)")),
        ({"rtol": 0.0}, ("rtol", "[1e-15, 1)")),
        ({"rtol": np.nan}, ("rtol",)),
        ({"atol": -1.0}, ("atol", "(0, inf)")),
        ({"atol": [1e-9, np.nan]}, ("atol",)),
        ({"atol": [1e-9, 1e-9, 1e-9]}, ("atol", "(3,)", "2 values")),
    ],
)
def test_bad_arguments_get_one_sentence(arguments, words):
    with pytest.raises((ParameterError, InvalidSystem)) as caught:
        simulate(ONE, **{"duration": 1.0, **arguments})
    text = str(caught.value)
    assert "\n" not in text
    for word in words:
        assert word in text


@pytest.mark.parametrize(
    "keywords",
    [
        {"first_step": 0.0},
        {"first_step": np.nan},
        {"largest_step": np.inf},
        {"most_steps": 0},
        {"rtol": 1.0},
        {"atol": 0.0},
    ],
)
def test_bad_methods_name_the_field(keywords):
    with pytest.raises(ParameterError, match=next(iter(keywords))):
        Method(**keywords)


def test_singular_mass_without_a_spring():
    with pytest.raises(InvalidSystem, match="M is singular"):
        simulate(System([[1.0, 0.0], [0.0, 0.0]], np.zeros((2, 2)), np.diag([1.0, 0.0])), 1.0)
    with pytest.raises(InvalidSystem, match="M is singular"):
        simulate(System([[1.0, 1.0], [1.0, 1.0]], np.zeros((2, 2)), np.zeros((2, 2))), 1.0)


def test_a_map_of_systems_is_not_one_system():
    with pytest.raises(InvalidSystem, match=r"leading axes \(3,\)"):
        simulate(DrumBrake(load1=[1.0, 2.0, 3.0]), 1e-3)


def test_no_sliding_to_start_from():
    with pytest.raises(InvalidSystem, match="no steady sliding"):
        simulate(block_on_belt(Coulomb(0.4), 0.0), 1.0, "sliding")


def test_vector_load_inside_a_schedule():
    system = System(np.eye(2), np.zeros((2, 2)), np.eye(2), Constant([1.0, 0.0]))
    with pytest.raises(InvalidSystem, match="schedule times a vector"):
        simulate(system, 1.0)


def test_something_that_is_no_system():
    with pytest.raises((AttributeError, TypeError, ValueError)):
        simulate(3.0, 1.0)


def test_two_equal_contacts_are_told_apart_from_none():
    # a system that nothing excites stays where it is, with contacts or without
    contact = Contact([0.0], [1.0], [1.0], 1.0, 0.0, Coulomb(0.4))
    assert np.all(simulate(ONE.replace({"contacts": (contact,)}), 1.0).q == 0.0)


TWICE = "@entry\ndef twice(x):\n    return 2.0 * x\n"


def test_cache_folder_that_cannot_be_written_warns_and_works(monkeypatch, tmp_path):
    blocked = tmp_path / "a file"
    blocked.write_text("not a folder")
    monkeypatch.setenv("SQUEALBOX_CACHE", str(blocked / "kernels"))
    with pytest.warns(RuntimeWarning, match="is not writable"):
        assert Translated(TWICE).twice(1.5) == 3.0


def test_cache_folder_is_chosen_by_the_environment(monkeypatch, tmp_path):
    monkeypatch.setenv("SQUEALBOX_CACHE", str(tmp_path / "here"))
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        assert Translated(TWICE).twice(1.5) == 3.0
    (file,) = (tmp_path / "here").glob("*.code")
    content = file.read_bytes()
    for spoilt in (b"", b"spoilt", content[:-1], content[:100] + b"?" + content[101:]):
        file.write_bytes(spoilt)  # a damaged file is written anew
        assert Translated(TWICE).twice(2.0) == 4.0
        assert file.read_bytes() == content


def test_record_keeps_its_size_for_small_systems():
    # few layouts mean few compilations: one and two masses, one and two contacts share one
    method = Method()
    one = packing.pack(block_on_belt(Coulomb(0.4), 0.1), method, 1, 1e-3, True)
    two = packing.pack(two_blocks_on_belt(), method, 1, 1e-3, True)
    assert one.dtype is two.dtype
    assert packing.pack(drum(0.3, "eq3"), method, 1, 1e-3, True).dtype is not two.dtype


@pytest.fixture(scope="module")
def motion():
    return simulate(two_blocks_on_belt(), 6.0, ([0.3, -0.1], [0.1, 0.0]), times=31)


@pytest.mark.parametrize("name", ["motion.csv", "motion.xlsx", "motion.MAT"])
def test_a_result_is_not_saved_under_the_name_of_another_kind_of_file(motion, tmp_path, name):
    with pytest.raises(ResultFileError, match=r"ends in \.nc; to_dataframe\(\)"):
        motion.save(tmp_path / name)
    assert not list(tmp_path.iterdir())


def test_save_and_load(motion, tmp_path):
    path = motion.save(tmp_path / "motion.nc")
    back = Trajectory.load(path)
    for name in ("t", "q", "qd", "normal_force", "friction_force", "mode", "event_time", "event_contact", "event_mode"):
        assert np.array_equal(getattr(back, name), getattr(motion, name)), name
    assert (back.steps, back.rejected, back.evaluations) == (motion.steps, motion.rejected, motion.evaluations)
    assert back.system == motion.system
    assert back.settings == motion.settings
    assert back.outcome == motion.outcome
    assert back.energy.relative_residual == motion.energy.relative_residual
    kept = back.settings
    again = simulate(back.system, kept["duration"], kept["start"], times=31, rtol=kept["rtol"])
    assert np.array_equal(again.q, motion.q), "what is saved is enough to repeat the run"


def test_failed_run_survives_the_file(tmp_path):
    failed = simulate(drum(0.3), 0.05, method=Method(most_steps=10))
    back = Result.load(failed.save(tmp_path / "failed.nc"))
    assert isinstance(back.outcome, Outcome)
    assert (back.outcome, back.outcome.message) == ("step_limit", failed.outcome.message)
    assert back.outcome.evidence["time"] == failed.outcome.evidence["time"]


def test_damaged_file_is_named(motion, tmp_path):
    path = motion.save(tmp_path / "motion.nc")
    path.write_bytes(path.read_bytes()[:500])
    with pytest.raises(ResultFileError, match=r"motion\.nc"):
        Trajectory.load(path)


def test_a_file_from_before_its_module_moved(motion):
    """A class is known by its place in the package; the one of that name in the same room takes its place."""
    data = motion.to_dataset()
    data.attrs["kind"] = "transient.elsewhere.Trajectory"
    assert Result.from_dataset(data).system == motion.system
    for wrong in ("stability.elsewhere.Trajectory", "transient.elsewhere.Nothing", "nowhere.Trajectory"):
        data.attrs["kind"] = wrong
        with pytest.raises(ResultFileError, match=wrong):
            Result.from_dataset(data)


def test_labels_of_the_dataset(motion):
    data = motion.to_dataset()
    assert data["q"].dims == ("time", "dof")
    assert data["friction_force"].dims == ("time", "contact")
    assert data["event_time"].dims == ("event",)
    assert data["work_friction"].attrs["units"] == "J"
    assert data["qd"].attrs["units"] == "m/s"
    assert data.attrs["kind"].endswith("Trajectory")
    assert all(data[name].attrs["long_name"] for name in data.data_vars)


def test_a_generated_text_is_kept_for_what_it_was_made_for(tmp_path, monkeypatch):
    monkeypatch.setenv("SQUEALBOX_CACHE", str(tmp_path))
    written = []

    def write(text):
        return lambda: written.append(text) or text

    assert _engine.kept_text("one", write("a\nb\n")) == "a\nb\n"
    assert _engine.kept_text("one", write("never written")) == "a\nb\n"
    assert _engine.kept_text("two", write("c")) == "c"
    (path, *_) = tmp_path.glob("*.text")
    path.write_bytes(path.read_bytes()[:-1])  # a damaged file is written anew
    assert {_engine.kept_text("one", write("a\nb\n")), _engine.kept_text("two", write("c"))} == {"a\nb\n", "c"}
    assert len(written) == 3
