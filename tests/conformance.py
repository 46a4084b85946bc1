"""The contracts: what every law, schedule, design, method and result must satisfy, stated once and run for all.

A new one joins by being there (CONTRIBUTING.md); `tests/house/test_nothing_is_forgotten.py` says what it lacks.
"""

import dataclasses
import importlib
import inspect
import pkgutil
from types import SimpleNamespace

import numpy as np
import pytest

import squealbox
from law_examples import LAWS
from squealbox import friction, schedules, simulate
from squealbox.compiled.machine import Translated
from squealbox.designs import DESIGNS
from squealbox.files import read_design, write_design
from squealbox.fit import fit_friction
from squealbox.parameters import ParameterError, from_plain, to_plain
from squealbox.plots import brake_drawing
from squealbox.result import Outcome, Result
from squealbox.stability import complex_modes, critical_value
from squealbox.system import System, equilibrium, linearise
from squealbox.transient import _engine
from squealbox.transient.methods import TABLEAUX, Method, tableau
from squealbox.transient.verdicts import verdict

SCHEDULES = [
    schedules.Constant(0.7),
    schedules.Ramp(0.7, -0.3),
    schedules.Ramp(0.7, -0.3, None, 0.5),
    schedules.Sinusoid(0.2, 0.7, 0.4, 0.3),
    schedules.Table([0.2, 1.0, 1.9], [0.1, 0.8, -0.2]),
    schedules.Polynomial([0.3, -0.5, 0.2, 0.1], 1.1, 0.4),
]
SUM = schedules.Ramp(0.7, -0.3) * 2.0 + schedules.Sinusoid(0.2, 0.7, 0.4)
SHEETS = [*LAWS, *SCHEDULES, *(design() for design in DESIGNS.values())]
SPEEDS = np.array([0.0, 0.013, 0.08, 0.22, 0.37, 0.61, 0.93, 1.7])
INSTANTS = np.array([0.013, 0.31, 0.77, 1.23, 1.61, 2.05, 3.4])


def named(sheet):
    return type(sheet).__name__


@pytest.fixture(scope="module")
def compiled():
    """The generated file's laws and schedules, each behind an entry: without one it has no code to be called."""
    names = ("law_mu", "law_slope", "schedule_value", "schedule_rate")
    doors = [f"@entry\ndef ask_{name}(kind, x, p):\n    return {name}(kind, x, p)\n" for name in names]
    module = Translated("\n\n".join([_engine.laws_and_schedules(), *doors]))
    return SimpleNamespace(**{name: getattr(module, f"ask_{name}") for name in names})


def test_every_schedule_has_an_example():
    assert {type(schedule) for schedule in SCHEDULES} == set(schedules.SCHEDULES)


# every data sheet: law, schedule, design


@pytest.mark.parametrize("sheet", SHEETS, ids=named)
def test_sheet_is_frozen_and_equals_its_copy(sheet):
    assert sheet == sheet.replace()
    assert hash(sheet) == hash(sheet.replace())
    with pytest.raises(dataclasses.FrozenInstanceError):
        setattr(sheet, sheet.field_names()[0], 0.0)


@pytest.mark.parametrize("sheet", SHEETS, ids=named)
def test_sheet_survives_plain_data(sheet):
    assert from_plain(to_plain(sheet)) == sheet


@pytest.mark.parametrize("sheet", SHEETS, ids=named)
def test_sheet_says_what_each_number_is(sheet):
    assert inspect.getdoc(type(sheet))
    for name, about in sheet.parameters().items():
        assert about.meaning, name
        assert about.unit is not None


@pytest.mark.parametrize("sheet", SHEETS, ids=named)
def test_sheet_refuses_what_is_no_number_or_out_of_range(sheet):
    for name, about in sheet.parameters().items():
        bad = [np.nan, np.inf, "fast", True, [np.nan, 1.0]]
        bad += [about.low - 1.0] if np.isfinite(about.low) else []
        bad += [about.high + 1.0] if np.isfinite(about.high) else []
        for value in bad:
            with pytest.raises(ParameterError) as caught:
                sheet.replace({name: value})
            assert (caught.value.owner, caught.value.name) == (named(sheet), name)


@pytest.mark.parametrize("sheet", SHEETS, ids=named)
def test_sheet_refuses_an_unknown_name(sheet):
    with pytest.raises(ParameterError, match="one of"):
        sheet.replace({"nonsense": 1.0})


# laws


@pytest.mark.parametrize("law", LAWS, ids=named)
def test_law_is_even_and_takes_any_shape(law):
    values = law.mu(SPEEDS)
    assert values.shape == SPEEDS.shape
    assert np.array_equal(law.mu(-SPEEDS), values)
    assert np.array_equal(law.mu(SPEEDS.reshape(2, 4)), values.reshape(2, 4))
    assert [float(law.mu(v)) for v in SPEEDS] == values.tolist()
    assert np.shape(law.mu(0.3)) == ()
    assert np.shape(law.slope_at(0.3)) == ()


@pytest.mark.parametrize("law", LAWS, ids=named)
def test_static_limit_is_at_least_the_friction_of_slow_sliding(law):
    assert law.static_limit == law.coefficients()[0]
    assert law.static_limit >= law.mu(0.0) - 1e-15
    assert isinstance(law, friction.Coulomb) or law.static_limit == pytest.approx(float(law.mu(0.0)), rel=1e-15)


@pytest.mark.parametrize("law", LAWS, ids=named)
def test_slope_is_the_derivative(law):
    step = 1e-6  # central difference: error of order step^2, and round-off/step = 1e-10
    speeds = SPEEDS[1:]
    difference = (law.mu(speeds + step) - law.mu(speeds - step)) / (2.0 * step)
    assert np.max(np.abs(law.slope_at(speeds) - difference)) < 1e-8


@pytest.mark.parametrize("law", LAWS, ids=named)
def test_law_is_the_same_compiled(law, compiled):
    kind, coefficients = friction.LAWS.index(type(law)), np.array(law.coefficients(), dtype=float)
    for v in SPEEDS:
        assert compiled.law_mu(kind, v, coefficients) == pytest.approx(float(law.mu(v)), rel=1e-14)
        assert compiled.law_slope(kind, v, coefficients) == pytest.approx(float(law.slope_at(v)), rel=1e-13, abs=1e-15)


@pytest.mark.parametrize("law", [law for law in LAWS if law.has_memory], ids=named)
def test_law_with_memory_slides_steadily_on_its_curve(law):
    """creep = 0 and |grip| = mu at the steady deflection; its derivatives there are those of the formulas."""
    p, one = law.coefficients(), type(law)
    for v in (*SPEEDS[1:], *-SPEEDS[1:]):
        z = float(law.steady_deflection(v))
        assert abs(one.creep_formula(v, z, p)) < 1e-12 * abs(v)
        assert one.grip_formula(v, z, 0.0, p) == pytest.approx(np.sign(v) * float(law.mu(v)), rel=1e-12)
        by_z, by_v = (float(x) for x in law.relaxation(v))
        h, k = 1e-5 * abs(z), 1e-6 * abs(v)
        slope = (one.creep_formula(v, z + h, p) - one.creep_formula(v, z - h, p)) / (2.0 * h)
        turn = (one.creep_formula(v + k, z, p) - one.creep_formula(v - k, z, p)) / (2.0 * k)
        assert by_z == pytest.approx(slope, rel=1e-4, abs=1e-4 * law.stiffness * abs(v))
        assert by_v == pytest.approx(turn, rel=1e-4, abs=1e-4)
    assert law.direct_slope(0.3) == pytest.approx(law.grip[1] * float(law.relaxation(0.3)[1]) + law.grip[2])


# schedules


@pytest.mark.parametrize("schedule", [*SCHEDULES, SUM], ids=named)
def test_rate_is_the_derivative_between_the_breaks(schedule):
    step = 1e-6
    assert all(np.min(np.abs(INSTANTS - b)) > step for b in schedule.breaks())
    difference = (schedule.value(INSTANTS + step) - schedule.value(INSTANTS - step)) / (2.0 * step)
    assert np.max(np.abs(schedule.rate(INSTANTS) - difference)) < 1e-8


@pytest.mark.parametrize("schedule", [*SCHEDULES, SUM], ids=named)
def test_breaks_are_where_the_rate_jumps(schedule):
    fine = np.linspace(0.005, 4.0, 400)
    jumps = np.abs(np.diff(schedule.rate(fine))) > 0.05
    found = fine[:-1][jumps]
    breaks = [b for b in schedule.breaks() if fine[0] < b < fine[-1]]
    assert list(schedule.breaks()) == sorted(schedule.breaks())
    assert len(found) == len(breaks)
    assert np.all(np.abs(found - breaks) <= fine[1] - fine[0] + 1e-12)


@pytest.mark.parametrize("schedule", SCHEDULES, ids=named)
def test_schedule_takes_any_shape_and_adds(schedule):
    assert schedule.value(INSTANTS[:6].reshape(2, 3)).shape == (2, 3)
    twice = schedule + schedule * 2.0
    assert np.allclose(twice.value(INSTANTS), 3.0 * schedule.value(INSTANTS), rtol=1e-14)
    assert np.allclose((-schedule).rate(INSTANTS), -schedule.rate(INSTANTS), rtol=1e-14)


@pytest.mark.parametrize("schedule", SCHEDULES, ids=named)
def test_schedule_is_the_same_compiled(schedule, compiled):
    kind = schedules.SCHEDULES.index(type(schedule))
    coefficients = np.array(schedule.coefficients(), dtype=float)
    for t in INSTANTS:
        assert compiled.schedule_value(kind, t, coefficients) == pytest.approx(float(schedule.value(t)), abs=1e-14)
        assert compiled.schedule_rate(kind, t, coefficients) == pytest.approx(float(schedule.rate(t)), abs=1e-14)


# designs


@pytest.fixture(params=sorted(DESIGNS), scope="module")
def design(request):
    return DESIGNS[request.param]()


def test_design_makes_a_system_that_slides(design):
    system = design.system()
    assert isinstance(system, System)
    assert system.shape == ()
    state = equilibrium(system)
    assert bool(state.exists), state.outcome.message
    residual = system.K @ state.q - system.load
    for i, contact in enumerate(system.contacts):
        residual = residual - contact.d * state.friction[i] * np.sign(state.sliding_speed[i]) * state.normal_force[i]
    forces = np.max(np.abs(system.K @ state.q)) + np.max(np.abs(state.friction * state.normal_force))
    assert np.max(np.abs(residual)) < 1e-9 * forces
    assert np.all(np.isfinite(linearise(system).K))


def test_design_names_its_source(design):
    assert type(design).title
    assert type(design).source


def test_design_takes_arrays(design):
    # one number of the sheet as an array gives the map of systems that the single designs give one by one
    name, _, value = next(leaf for leaf in design.leaves() if isinstance(leaf[2], float) and leaf[2] > 0.0)
    many = design.replace({name: np.array([value, 1.01 * value])}).system()
    assert many.shape == (2,)
    one = design.replace({name: 1.01 * value}).system()
    for field in ("M", "C", "K"):
        assert np.allclose(np.broadcast_to(getattr(many, field), (2, *one.M.shape))[1], getattr(one, field), rtol=1e-14)


def test_design_survives_its_file(design, tmp_path):
    assert read_design(write_design(design, tmp_path / "brake.toml")) == design


@pytest.mark.parametrize("law", LAWS, ids=named)
def test_design_takes_any_law(design, law, tmp_path):
    brake = design.replace(friction=law)
    modes = complex_modes(brake)
    assert modes.outcome == "completed"
    bristles = modes.right.shape[-2] - design.system().size  # rows without mass: one eigenvalue of each is at infinity
    assert np.sum(~np.isfinite(modes.eigenvalues)) == bristles
    assert bristles in (0, len(design.system().contacts) * law.has_memory)
    assert read_design(write_design(brake, tmp_path / "brake.toml")) == brake
    with pytest.raises(ParameterError, match="friction law"):
        design.replace(friction=0.4)


def test_design_is_drawn(design):
    figure = brake_drawing(design)
    assert figure.axes[0].has_data() or figure.axes[0].patches


def test_result_of_a_design_keeps_it(design, tmp_path):
    modes = complex_modes(design)
    back = Result.load(modes.save(tmp_path / "modes.nc"))
    np.testing.assert_array_equal(back.eigenvalues, modes.eigenvalues)
    assert to_plain(back.inputs) == to_plain(modes.inputs)


def test_design_moves(design):
    modes = complex_modes(design)
    period = 2.0 * np.pi / np.max(np.abs(modes.eigenvalues))
    motion = simulate(design, 5.0 * period)
    assert motion.outcome == "completed"
    assert motion.energy.relative_residual < 1e-6


# methods


@pytest.mark.parametrize("name", list(TABLEAUX))
def test_method_is_named_and_sized_as_it_says(name):
    method = tableau(name)
    assert method.name == name
    assert method.title
    assert method.source
    assert method.a.shape == (len(method.a), len(method.a))
    assert len(method.p) == len(method.a) == len(method.c)
    assert len(method.e) == method.stages + 1
    assert method.error_order < method.order
    assert Method(name).tableau == name


@pytest.mark.parametrize("name", list(TABLEAUX))
@pytest.mark.parametrize("contact", ["exact", "raw", "smooth"])
def test_method_reaches_the_end_in_every_scheme(name, contact, drum):
    motion = simulate(drum, 1e-3, method=name, contact=contact, width=0.02)
    assert motion.outcome == "completed"
    assert motion.t[0] == 0.0
    assert motion.t[-1] == 1e-3
    assert motion.settings["tableau"] == name
    assert motion.evaluations >= motion.steps * tableau(name).stages


# results


def result_kinds():
    for module in pkgutil.walk_packages(squealbox.__path__, "squealbox."):
        if module.name.split(".")[1] in ("stability", "transient", "signals", "result", "continuation", "fit"):
            importlib.import_module(module.name)
    kinds, found = [Result], []
    while kinds:
        children = kinds.pop().__subclasses__()
        kinds += children
        found += [kind for kind in children if kind.__module__.startswith("squealbox.")]
    return sorted(found, key=lambda kind: kind.__name__)


@pytest.mark.parametrize("kind", result_kinds(), ids=lambda kind: kind.__name__)
def test_result_declares_its_arrays(kind):
    assert inspect.getdoc(kind)
    assert dataclasses.is_dataclass(kind)
    assert kind.__dataclass_params__.frozen
    fields = dataclasses.fields(kind)
    assert {"inputs", "settings", "outcome", "provenance"} <= {field.name for field in fields}
    for field in fields:
        if "dims" in field.metadata:
            assert isinstance(field.metadata["unit"], str)  # empty where it is that of whatever parameter was varied
            assert field.metadata["meaning"], f"{field.name} says not what it is"


MAKERS = {
    "Trajectory": lambda drum: simulate(drum, 1e-3),
    "Verdict": lambda drum: verdict(simulate(drum, 5e-3, times=501)),
    "ComplexModes": complex_modes,
    "FrictionFit": lambda drum: fit_friction(SPEEDS, 0.3 + 0.1 * np.exp(-SPEEDS)),
    "CriticalValue": lambda drum: critical_value(drum, "friction.static", (0.1, 0.6)),
}


@pytest.mark.parametrize("name", list(MAKERS))
def test_result_survives_its_file(name, drum, tmp_path):
    result = MAKERS[name](drum)
    assert type(result).__name__ == name
    back = Result.load(result.save(tmp_path / "result.nc"))
    assert type(back) is type(result)
    for field in dataclasses.fields(result):
        if "dims" in field.metadata:
            np.testing.assert_array_equal(getattr(back, field.name), getattr(result, field.name))
    assert isinstance(back.outcome, Outcome)
    assert back.outcome == result.outcome
    assert dict(back.provenance) == dict(result.provenance)
    assert {"squealbox", "numpy", "scipy", "python"} <= set(result.provenance)
    assert not [path for path in tmp_path.iterdir() if path.name != "result.nc"], "nothing half-written is left behind"
