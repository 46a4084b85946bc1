"""What a design may vary is said in one spelling to every analysis: {name: bounds, values or a distribution}.

Each analysis stands here once, with the mapping, with the spelling it had before, and with what it computes.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from squealbox import (
    DrumBrake,
    LinearSlope,
    ParameterError,
    branch,
    complex_modes,
    critical_value,
    critical_values,
    hopf_point,
    silence,
    simulate_ensemble,
    stability_boundary,
    stability_map,
    sweep,
    tracked_modes,
)
from squealbox.family import ParameterAxis
from squealbox.files.document import DesignFileError
from squealbox.files.reading import read_text
from squealbox.files.study import read_study
from squealbox.limit_cycles import (
    averaged_curve,
    bifurcation_diagram,
    coexistence,
    estimate_curves,
    hopf_curve,
    isolated_branches,
)
from squealbox.quantities import growth_rate, margin
from squealbox.stability import damping_split, exceptional_points, first_crossings, track
from squealbox.studies import (
    Goal,
    Normal,
    Scatter,
    Uniform,
    form,
    interval_bounds,
    morris_effects,
    optimise,
    polynomial_chaos,
    sobol_indices,
    squeal_probability,
    subset_simulation,
)

BRAKE = DrumBrake(friction=LinearSlope(static=0.3, slope=-0.05))
MU, LOAD = "friction.static", "load"
ENDS, LOADS, MUS = (0.1, 0.6), (900.0, 1100.0), np.linspace(0.2, 0.4, 3)
LOT, FORCE = Normal(0.33, 0.01), Uniform(900.0, 1100.0)
GROWTH = growth_rate()


def recipe(mu: float, *more: float) -> Any:
    return BRAKE.replace({MU: mu} | ({LOAD: more[0]} if more else {}))


@dataclass
class Case:
    """`call(design, {name: ...})`, `before(design)` the older spelling, `answer` what both must agree in."""

    call: Any
    before: Any
    answer: Any
    given: dict[str, Any]
    wants: str = "two finite numbers (low, high) with low < high"

    @property
    def bad(self) -> dict[str, list[Any]]:
        """Values that mean nothing here."""
        if "low < high" in self.wants:
            return {MU: [ENDS[::-1], (0.1, np.nan), LOT, "0.1", (0.1, 0.2, 0.3), None]}
        if "distribution" in self.wants:
            return {MU: [ENDS, 0.3, "0.3"]}
        return {MU: [[], [np.nan], [[0.1, 0.2], [0.3]], None]}


def bounds(call, before, answer, **more) -> Case:
    return Case(call, before, answer, {MU: ENDS}, **more)


def plane(call, answer, **more) -> Case:
    """Two bounds, which were given by name before."""
    return Case(call, None, answer, {MU: ENDS, LOAD: LOADS}, **more)


def values(call, before, answer, **more) -> Case:
    return Case(call, before, answer, {MU: MUS}, wants="finite number", **more)


def scattered(call, answer) -> Case:
    given = {MU: LOT, LOAD: FORCE}
    return Case(call, lambda design: call(design, Scatter(given)), answer, given, wants="a distribution")


def ends_of(found):
    return [found.value[0], found.value[-1], found.period[-1]]


ONSET = hopf_point(BRAKE, MU, ENDS)
WALK = branch(BRAKE, MU, ENDS, ONSET, points=10)
CASES = {
    "critical_value": bounds(critical_value, lambda d: critical_value(d, MU, ENDS), lambda f: f.value),
    "critical_values": bounds(critical_values, lambda d: critical_values(d, MU, ENDS), lambda f: f.value),
    "first_crossings": bounds(first_crossings, lambda d: first_crossings(d, MU, ENDS), lambda f: f),
    "hopf_point": bounds(hopf_point, lambda d: hopf_point(d, MU, ENDS), lambda f: f.lyapunov),
    "branch": bounds(
        lambda d, v: branch(d, v, ONSET, points=10), lambda d: branch(d, MU, ENDS, ONSET, points=10), ends_of
    ),
    "isolated_branches": bounds(
        lambda d, v: isolated_branches(d, v, values=[0.3], starts=1, settle=0.02, points=2),
        lambda d: isolated_branches(d, MU, ENDS, values=[0.3], starts=1, settle=0.02, points=2),
        lambda f: [each.value[0] for each in f],
    ),
    "estimate_curves": bounds(
        lambda d, v: estimate_curves(d, v, [WALK]),
        lambda d: estimate_curves(d, MU, ENDS, [WALK]),
        lambda f: [each.value[0] for each in f],
    ),
    "damping_split": bounds(
        lambda d, v: damping_split(d, ("c1", "c2"), 400.0, v, splits=3),
        lambda d: damping_split(d, ("c1", "c2"), 400.0, MU, ENDS, splits=3),
        lambda f: f.critical,
    ),
    "margin": bounds(lambda d, v: margin(v)(d), lambda d: margin(MU, ENDS)(d), lambda f: f),
    "interval_bounds": bounds(lambda d, v: interval_bounds(d, v, GROWTH, runs=1), None, lambda f: f.low),
    "optimise": bounds(lambda d, v: optimise(d, v, Goal(GROWTH), method="local"), None, lambda f: f.values),
    "stability_boundary": plane(lambda d, v: stability_boundary(d, v, cells=4), lambda f: f.x),
    "exceptional_points": plane(lambda d, v: exceptional_points(d, v, points=5), lambda f: f.x),
    "hopf_curve": plane(lambda d, v: hopf_curve(d, v, points=3), lambda f: f.x),
    "coexistence": plane(lambda d, v: coexistence(d, v, columns=2, rows=2, starts=1), lambda f: f.onset),
    "tracked_modes": values(tracked_modes, lambda d: tracked_modes(d, MU, MUS), lambda f: f.eigenvalues),
    "track": values(
        lambda d, v: list(track(d, v)), lambda d: list(track(d, MU, MUS)), lambda f: [each.eigenvalues for each in f]
    ),
    "averaged_curve": values(averaged_curve, lambda d: averaged_curve(d, MU, MUS), lambda f: f[0]),
    "bifurcation_diagram": values(
        lambda d, v: bifurcation_diagram(d, v, sweeps=("rest",), duration=5e-3),
        lambda d: bifurcation_diagram(d, MU, MUS, sweeps=("rest",), duration=5e-3),
        lambda f: f.highest,
    ),
    "stability_map": values(stability_map, None, lambda f: f.growth_rate),
    "simulate_ensemble": values(lambda d, v: simulate_ensemble(d, v, duration=1e-3), None, lambda f: f["amplitude"]),
    "sweep": values(lambda d, v: sweep(d, v, complex_modes), None, lambda f: f["largest_growth_rate"].values),
    "squeal_probability": scattered(lambda d, v: squeal_probability(d, v, GROWTH, samples=64), lambda f: f.probability),
    "form": scattered(lambda d, v: form(d, v, GROWTH, samples=16), lambda f: f.normal_point),
    "subset_simulation": scattered(lambda d, v: subset_simulation(d, v, GROWTH, samples=100), lambda f: f.probability),
    "sobol_indices": scattered(lambda d, v: sobol_indices(d, v, GROWTH, samples=64), lambda f: f.first),
    "morris_effects": scattered(lambda d, v: morris_effects(d, v, GROWTH, trajectories=5), lambda f: f.strength),
    "polynomial_chaos": scattered(lambda d, v: polynomial_chaos(d, v, GROWTH, samples=64), lambda f: f.coefficients),
    "silence": scattered(lambda d, v: silence(d, v, samples=16, push=0.0, candidates=()), lambda f: f.before),
}
# what asks its design for more than other values of these parameters; and a boundary, which takes half a minute so
WITHOUT_A_FUNCTION = (
    "damping_split", "margin", "first_crossings", "coexistence", "simulate_ensemble", "silence", "optimise",
    "stability_boundary",
)  # fmt: skip


@pytest.mark.parametrize("name", [name for name, case in CASES.items() if case.before is not None])
def test_the_spelling_before_says_the_same(name):
    case = CASES[name]
    assert np.array_equal(case.answer(case.call(BRAKE, case.given)), case.answer(case.before(BRAKE)), equal_nan=True)


@pytest.mark.parametrize("name", [name for name in CASES if name not in WITHOUT_A_FUNCTION])
def test_a_function_of_the_values_does_as_well_as_a_design(name):
    case = CASES[name]
    ways = [np.asarray(case.answer(case.call(design, case.given))) for design in (BRAKE, recipe)]
    size = np.max(np.abs(np.nan_to_num(ways[0])), initial=0.0)
    assert np.allclose(*ways, rtol=1e-6, atol=1e-9 * size, equal_nan=True)


@pytest.mark.parametrize("name", CASES)
def test_a_value_that_means_nothing_here_is_one_sentence(name):
    """It names the parameter, what was given and what is expected."""
    case = CASES[name]
    for given in case.bad[MU]:
        with pytest.raises(ParameterError) as caught:
            case.call(BRAKE, {**case.given, MU: given})
        text = str(caught.value)
        assert f".{MU} = " in text
        assert f"expected {case.wants}" in text or case.wants in text
        assert "\n" not in text


@pytest.mark.parametrize("name", [name for name, case in CASES.items() if case.wants == "finite number"])
def test_a_distribution_is_no_list_of_values(name):
    with pytest.raises(ParameterError, match=r"friction.static = Normal\(.*expected values"):
        CASES[name].call(BRAKE, {**CASES[name].given, MU: LOT})


@pytest.mark.parametrize("name", CASES)
def test_a_name_the_design_does_not_have_is_one_sentence(name):
    case = CASES[name]
    given = {"friction.statik" if each == MU else each: value for each, value in case.given.items()}
    with pytest.raises(ParameterError, match="did you mean 'static'"):
        case.call(BRAKE, given)
    with pytest.raises(ParameterError, match="DrumBrake.1|nothing beside"):  # a number is no name
        case.call(BRAKE, {1 if each == MU else each: value for each, value in case.given.items()})


@pytest.mark.parametrize("name", ["critical_value", "branch", "tracked_modes", "bifurcation_diagram"])
def test_one_parameter_is_not_two_and_not_said_twice(name):
    case, more = CASES[name], {LOAD: LOADS}
    with pytest.raises(ParameterError, match=rf"{name}.parameters = .*expected one parameter"):
        case.call(BRAKE, {**case.given, **more})
    with pytest.raises(ParameterError, match="nothing beside"):
        critical_value(BRAKE, case.given, ENDS)


def test_an_axis_has_ends_and_values():
    axis = ParameterAxis(MU, 0.1, 0.6, points=3)
    assert critical_value(BRAKE, {MU: axis}).value == critical_value(BRAKE, {MU: ENDS}).value
    assert np.array_equal(tracked_modes(BRAKE, {MU: axis}).value, [0.1, 0.35, 0.6])


FILE = 'brake = "drum_brake"\nfriction = { law = "linear_slope", static = 0.3, slope = -0.05 }\n'
SAID = {  # section: by `vary`, as it was said before, and what else stands there
    "onset": (
        'vary = { "friction.static" = [0, "80 %"] }',
        'parameter = "friction.static"\nrange = [0, "80 %"]',
        "",
    ),
    "branch": (
        "vary = { friction.static = { range = [0.1, 0.6], points = 50 } }",
        'parameter = "friction.static"\nrange = [0.1, 0.6]\npoints = 50',
        "",
    ),
    "map": (
        'vary = { "friction.static" = [0, 1], load = { range = ["100 N", "2 kN"], points = 31 } }',
        'x = { parameter = "friction.static", range = [0, 1] }\n'
        'y = { parameter = "load", range = ["100 N", "2 kN"], points = 31 }',
        "",
    ),
    "scatter": (
        'vary = { k1 = { distribution = "normal", mean = "19 kN/mm", sd = "1 kN/mm" } }',
        'parameters = { k1 = { distribution = "normal", mean = "19 kN/mm", sd = "1 kN/mm" } }',
        'quantity = "growth_rate"',
    ),
    "optimise": (
        'vary = { k1 = ["10 kN/mm", "20 kN/mm"] }',
        'variables = { k1 = ["10 kN/mm", "20 kN/mm"] }',
        'goals = [{ minimise = "growth_rate" }]',
    ),
}


@pytest.mark.parametrize("section", SAID)
def test_a_file_says_it_as_well(section):
    *ways, more = SAID[section]
    read = [getattr(read_text(f"{FILE}[{section}]\n{way}\n{more}\n"), section) for way in ways]
    read = [each.variables if section == "optimise" else getattr(each, "scatter", each) for each in read]
    assert read[0] == read[1]


def test_a_study_says_it_as_well(tmp_path):
    ways = [
        'vary = { "friction.static" = [0.1, 0.2, 0.4], load = { range = [500, 1000], points = 3 } }',
        '[[study.axis]]\nparameter = "friction.static"\nvalues = [0.1, 0.2, 0.4]\n'
        '[[study.axis]]\nparameter = "load"\nrange = [500, 1000]\npoints = 3',
    ]
    found = []
    for i, way in enumerate(ways):
        path = tmp_path / f"study{i}.toml"
        path.write_text(f'{FILE}[study]\nanalysis = "modes"\n{way}\n')
        found.append(read_study(path).space)
    assert found[0].names == found[1].names == (MU, LOAD)
    assert all(np.array_equal(a, b) for a, b in zip(*(each.points(0, 9).values() for each in found), strict=True))


@pytest.mark.parametrize(
    ("section", "says"),
    [
        ("[onset]\nvary = { 'friction.statik' = [0, 1] }", "did you mean 'friction.static'"),
        ("[onset]\nvary = { load = [2, 1] }", "4: onset.vary.load.range: [2, 1]: expected the lower value first"),
        ("[onset]\nvary = { load = [1, 2], theta1 = [1, 2] }", "expected a table of 1 parameter such as"),
        ("[map]\nvary = { load = [1, 2] }", "expected a table of 2 parameters such as"),
        ("[branch]\nvary = [0, 1]", "expected a table of 1 parameter such as"),
        ("[onset]\nvary = { load = [1, 2] }\nrange = [1, 2]", "unknown key"),
    ],
)
def test_what_a_file_cannot_mean_is_one_sentence(section, says):
    with pytest.raises(DesignFileError) as caught:
        read_text(FILE + section)
    assert says in str(caught.value)
    assert "\n" not in str(caught.value)
