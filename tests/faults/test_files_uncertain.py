"""The sections [scatter] and [optimise]: what they read, and what each mistake is told with line and key."""

import numpy as np
import pytest

from squealbox.files import DesignFileError, json_schema, read_file
from squealbox.studies import Lognormal, Normal, ScipyDistribution, Uniform

BRAKE = 'brake = "damping_paradox"\n'
SCATTER = (
    BRAKE
    + '[scatter]\nquantity = "margin"\nparameter = "friction.static"\nrange = [0, "90 %"]\nstudy = "sobol"\nseed = 7\n'
    + "[scatter.parameters]\n"
)
K1 = 'k1 = { distribution = "normal", mean = "400 N/mm", sd = "10 N/mm" }\n'
TIED = SCATTER.replace("seed = 7", 'seed = 7\ncorrelation = [["k1", "k2", 0.3]]')
OPTIMISE = BRAKE + '[optimise]\ngenerations = 5\n[optimise.variables]\neta1 = [0, "5 %"]\n'
GOAL = '[[optimise.goals]]\nmaximise = "damping_ratio"\n'


def read(tmp_path, text):
    path = tmp_path / "brake.toml"
    path.write_text(text)
    return read_file(path)


def problems(tmp_path, text):
    with pytest.raises(DesignFileError) as caught:
        read(tmp_path, text)
    return [(each.line, each.key, each.message) for each in caught.value.problems]


def test_scatter_is_read_with_units_and_dotted_names_with_and_without_quotes(tmp_path):
    more = 'friction.static = { distribution = "uniform", low = 0.1, high = "30 %" }\n'
    more += '"eta1" = { distribution = "lognormal", mean = "2 %", sd = 0.005 }\n'
    more += 'eta2 = { distribution = "scipy", name = "weibull_min", shapes = [3], scale = "2 %" }\n'
    tied = SCATTER.replace("seed = 7", 'seed = 7\ncorrelation = [["k1", "eta1", 0.3]]')
    found = read(tmp_path, tied + K1 + more).scatter
    assert found.scatter.distributions == {
        "k1": Normal(4e5, 1e4),
        "friction.static": Uniform(0.1, 0.3),
        "eta1": Lognormal(0.02, 0.005),
        "eta2": ScipyDistribution("weibull_min", [3.0], 0.0, 0.02),
    }
    assert found.scatter.correlation[0, 2] == 0.3
    assert (found.studies, found.sampled.seed, found.sampled.samples) == (("sobol",), 7, 4096)
    assert found.quantity.name == "margin of friction.static"


def test_optimise_is_read(tmp_path):
    text = (
        OPTIMISE
        + GOAL
        + '[[optimise.goals]]\nminimise = "weighted_sum"\nweights = { eta1 = 100, friction.static = 2 }\n'
    )
    text += 'name = "cost"\n[[optimise.constraints]]\nquantity = "parameter"\nparameter = "m"\nhigh = "1200 g"\n'
    found = read(tmp_path, text).optimise
    assert found.variables == {"eta1": (0.0, 0.05)}
    assert [(goal.name, goal.sense) for goal in found.goals] == [("damping ratio", "maximise"), ("cost", "minimise")]
    assert float(found.goals[1].quantity(read(tmp_path, text).design)) == pytest.approx(100 * 0.02 + 2 * 0.2)
    (kept,) = found.constraints
    assert (kept.high, kept.low, kept.quantity.unit) == (1.2, -np.inf, "kg")


FAULTS = {
    "unknown parameter": (SCATTER + K1.replace("k1", "k9"), 9, "scatter.parameters.k9", "unknown parameter 'k9'"),
    "unit of another kind": (SCATTER + K1.replace("10 N/mm", "10 kg"), 9, "scatter.parameters.k1.sd", "a mass"),
    "unknown distribution": (SCATTER + K1.replace("normal", "norml"), 9, "k1.distribution", "did you mean 'normal'"),
    "no distribution": (SCATTER + "k1 = 3\n", 9, "scatter.parameters.k1", "distribution ="),
    "missing number": (SCATTER + 'k1 = { distribution = "normal", mean = 1 }\n', 9, "k1", "'sd' is missing"),
    "out of range": (
        SCATTER + 'k1 = { distribution = "uniform", low = -1, high = 1 }\n', 9, "parameters.k1", "in (0, inf) N/m",
    ),
    "nothing scatters": (SCATTER, 8, "scatter.parameters", "[scatter.parameters]"),
    "unknown quantity": (SCATTER.replace('"margin"', '"mergin"') + K1, 3, "scatter.quantity", "did you mean 'margin'"),
    "missing range": (SCATTER.replace('range = [0, "90 %"]', "") + K1, 2, "scatter", "'range' is missing"),
    "range upside down": (SCATTER.replace("[0,", "[2,") + K1, 5, "scatter.range", "the lower value first"),
    "unknown study": (SCATTER.replace('"sobol"', '"sobel"') + K1, 6, "scatter.study", "did you mean 'sobol'"),
    "unknown key": (SCATTER.replace("seed", "sead") + K1, 7, "scatter.sead", "did you mean 'seed'"),
    "key of another quantity": (SCATTER.replace("seed = 7", "duration = 1") + K1, 7, "duration", "does not have"),
    "correlation of a stranger": (TIED + K1, 8, "scatter.correlation", "one of k1"),
    "correlation of one": (TIED.replace("k2", "k1") + K1, 8, "scatter.correlation", "two different parameters"),
    "no number": (TIED.replace("0.3", "'much'") + K1, 8, "correlation[0]", "two parameters and their correlation"),
    "no goals": (OPTIMISE, 2, "optimise", "'goals' is missing"),
    "no variables": (BRAKE + "[optimise]\n" + GOAL, 2, "optimise.variables", "[optimise.variables]"),
    "variable upside down": (OPTIMISE.replace("[0,", "[1,") + GOAL, 5, "variables.eta1", "the lower value first"),
    "two senses": (OPTIMISE + GOAL + 'minimise = "margin"\n', 6, "goals[0]", "one of the keys"),
    "unknown over": (OPTIMISE + GOAL + 'over = "worst"\n', 8, "goals[0].over", "quantile"),
    "share of all": (OPTIMISE + GOAL + "share = 1\n", 8, "goals[0].share", "in (0, 1)"),
    "unknown goal key": (OPTIMISE + GOAL + "shore = 0.5\n", 8, "goals[0].shore", "did you mean 'share'"),
    "limits of nothing": (
        OPTIMISE + GOAL + '[[optimise.constraints]]\nquantity = "growth_rate"\n', 8, "constraints[0]", "at least one",
    ),
    "weights of nothing": (
        OPTIMISE + '[[optimise.goals]]\nminimise = "weighted_sum"\nweights = { eta3 = 1 }\n',
        8, "weights.eta3", "did you",
    ),
    "amplitude without limit": (
        OPTIMISE + '[[optimise.goals]]\nminimise = "amplitude"\n', 6, "goals[0]", "'limit' is missing",
    ),
}  # fmt: skip


@pytest.mark.parametrize("name", FAULTS)
def test_each_mistake_has_its_line_key_and_sentence(tmp_path, name):
    text, line, key, words = FAULTS[name]
    found = problems(tmp_path, text)
    assert any(at == line and each.endswith(key) and words in message for at, each, message in found), found
    assert len(found) == 1


def test_several_mistakes_are_told_at_once(tmp_path):
    text = SCATTER.replace("seed", "sead") + K1.replace("k1", "k9") + K1.replace("10 N/mm", "10 kg")
    assert len(problems(tmp_path, text)) == 3


@pytest.mark.parametrize("text", [SCATTER + K1, OPTIMISE + GOAL])
def test_the_schema_takes_what_is_read_and_refuses_an_unknown_key(text):
    import tomllib

    jsonschema = pytest.importorskip("jsonschema")
    schema = jsonschema.Draft7Validator(json_schema())
    tables = tomllib.loads(text)
    assert schema.is_valid(tables)
    tables["scatter" if "scatter" in tables else "optimise"]["nonsense"] = 1
    assert not schema.is_valid(tables)
