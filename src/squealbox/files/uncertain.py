"""The sections [scatter] and [optimise] of a design file: what scatters, what may be changed, and what is asked.

[scatter]
quantity = "margin"
parameter = "friction.static"
range = [0, 1]
[scatter.parameters]
"friction.static" = { distribution = "normal", mean = 0.35, sd = 0.03 }
k1 = { distribution = "uniform", low = "9 kN/mm", high = "11 kN/mm" }
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, get_args

import numpy as np

from squealbox.design import Design
from squealbox.distributions import DISTRIBUTIONS, Distribution
from squealbox.files.analyses import read_spans
from squealbox.files.asked import read_quantity
from squealbox.files.document import Document
from squealbox.files.lines import Key
from squealbox.files.numbers import WRONG, only, read_choice, read_number, wrong
from squealbox.files.sheets import read_sheet
from squealbox.files.study_axis import read_correlation
from squealbox.files.varied import VARY, flattened, known
from squealbox.parameters import Parameter, ParameterError
from squealbox.scatter import Scatter
from squealbox.studies import Constraint, Goal, Over, Quantity, SampleSettings, SearchSettings

STUDIES = ("probability", "sobol", "morris", "form", "subset", "surrogate", "bounds")
SENSES = ("minimise", "maximise")
OVERS: tuple[str, ...] = get_args(Over)
EXAMPLE = "a table such as { distribution = 'normal', mean = 0.35, sd = 0.03 }"


@dataclass(frozen=True)
class Scattered:
    """[scatter]: which parameters scatter, of which number, and which studies are made of it."""

    scatter: Scatter
    quantity: Quantity
    studies: tuple[str, ...]
    sampled: SampleSettings


@dataclass(frozen=True)
class Optimise:
    """[optimise]: what may be changed and what is wanted."""

    variables: dict[str, tuple[float, float]]
    goals: tuple[Goal, ...]
    constraints: tuple[Constraint, ...]
    effort: SearchSettings


def read_scatter(document: Document, table: Mapping[str, Any], key: Key, design: Design | None) -> Scattered | None:
    """The section [scatter]."""
    table = _by_vary(table, "parameters")
    own = {name: table[name] for name in table if name not in ("parameters", "correlation", "study")}
    asked, rest = read_quantity(document, own, key, design)
    sampled = read_sheet(document, SampleSettings, rest, key, beside=("quantity", "parameters", "correlation", "study"))
    studies = _studies(document, table.get("study", ["probability", "sobol"]), (*key, "study"))
    scatter = _scatter(document, table, key, design)
    if asked is None or sampled is None or studies is None or scatter is None:
        return None
    return Scattered(scatter, asked, studies, sampled)


def read_optimise(document: Document, table: Mapping[str, Any], key: Key, design: Design | None) -> Optimise | None:
    """The section [optimise]."""
    before, table = len(document.problems), _by_vary(table, "variables")
    rest = {name: table[name] for name in table if name not in ("variables", "goals", "constraints")}
    effort = read_sheet(document, SearchSettings, rest, key, beside=("variables", "goals", "constraints"))
    variables = _variables(document, table, key, design)
    goals = [_goal(document, item, place, design) for item, place in _tables(document, table, key, "goals")]
    kept = [_constraint(document, item, place, design) for item, place in _tables(document, table, key, "constraints")]
    if "goals" not in table:
        document.problem(key, "the key 'goals' is missing, expected one or more tables under [[optimise.goals]]")
    if len(document.problems) > before or effort is None:
        return None
    return Optimise(variables, tuple(g for g in goals if g), tuple(c for c in kept if c), effort)


def _by_vary(table: Mapping[str, Any], name: str) -> Mapping[str, Any]:
    """The section with what it varies under the name it had before `vary`."""
    return {name if key == VARY and name not in table else key: value for key, value in table.items()}


def read_distribution(document: Document, value: Any, about: Parameter, key: Key) -> Distribution | None:
    """A distribution in the unit and within the range of the parameter `about` it is given for."""
    if not isinstance(value, Mapping) or "distribution" not in value:
        wrong(document, key, value, EXAMPLE)
        return None
    kind = read_choice(document, value["distribution"], DISTRIBUTIONS, (*key, "distribution"))
    if kind is WRONG:
        return None
    rest = {name: item for name, item in value.items() if name != "distribution"}
    found: Distribution | None = read_sheet(document, kind, rest, key, unit=about.unit)
    if found is None:
        return None
    ends = np.array([end for end in found.support if np.isfinite(end)] + [float(found.ppf(0.5))])
    if not about.accepts(ends):
        low, high = found.support
        document.problem(key, f"reaches from {low:g} to {high:g}: expected values in {about.range}")
        return None
    return found


def _studies(document: Document, value: Any, key: Key) -> tuple[str, ...] | None:
    words = value if isinstance(value, list) else [value]
    found = [read_choice(document, word, {each: each for each in STUDIES}, key) for word in words]
    if not words:
        wrong(document, key, value, f"one or more of {', '.join(STUDIES)}")
    return None if WRONG in found or not words else tuple(found)


def _scatter(document: Document, table: Mapping[str, Any], key: Key, design: Design | None) -> Scatter | None:
    given = table.get("parameters")
    if not isinstance(given, Mapping) or not given:
        document.problem((*key, "parameters"), f"expected a section [scatter.parameters] of names, each with {EXAMPLE}")
        return None
    before = len(document.problems)
    found: dict[str, Any] = {}
    for name, value, place in flattened(given, (*key, "parameters"), design):
        about = known(document, name, place, design)
        if about is not None:
            found[name] = read_distribution(document, value, about, place)
    correlation = read_correlation(document, table.get("correlation", []), (*key, "correlation"))
    if len(document.problems) > before or not found:
        return None
    try:
        return Scatter(found, correlation)
    except ParameterError as error:
        document.problem((*key, "correlation"), str(error))
        return None


def _variables(
    document: Document, table: Mapping[str, Any], key: Key, design: Design | None
) -> dict[str, tuple[float, float]]:
    given = table.get("variables")
    if isinstance(given, Mapping) and given:
        return read_spans(document, given, (*key, "variables"), design)
    example = "a section [optimise.variables] of names, each with two values such as [0, 1]"
    document.problem((*key, "variables"), f"expected {example}")
    return {}


def _tables(document: Document, table: Mapping[str, Any], key: Key, name: str) -> Iterator[tuple[Any, Key]]:
    """The tables of an array of tables, each with its key."""
    given = table.get(name, [])
    if not isinstance(given, list) or not all(isinstance(item, Mapping) for item in given):
        wrong(document, (*key, name), given, f"tables, each under a line [[{key[-1]}.{name}]]")
        return
    for i, item in enumerate(given):
        yield item, (*key, name, i)


def _goal(document: Document, table: Mapping[str, Any], key: Key, design: Design | None) -> Goal | None:
    senses = [sense for sense in SENSES if sense in table]
    if len(senses) != 1:
        document.problem(key, "expected one of the keys 'minimise' and 'maximise', with the name of a quantity")
        return None
    renamed = {"quantity" if name == senses[0] else name: value for name, value in table.items()}
    asked, rest = read_quantity(document, renamed, key, design, word=senses[0])
    over = _over(document, rest, key)
    _nothing_left(document, rest, key)
    return None if asked is None or over is None else Goal(asked, senses[0], *over)  # type: ignore[arg-type]


def _constraint(document: Document, table: Mapping[str, Any], key: Key, design: Design | None) -> Constraint | None:
    asked, rest = read_quantity(document, {k: v for k, v in table.items() if k not in ("low", "high")}, key, design)
    over = _over(document, rest, key)
    _nothing_left(document, rest, key, "low", "high")
    if asked is None or over is None:
        return None
    about = Parameter("-", 0.0, 1.0) if over[0] == "probability" else Parameter(asked.unit)
    ends = {k: read_number(document, table[k], about, (*key, k)) for k in ("low", "high") if k in table}
    if WRONG in ends.values():
        return None
    try:
        return Constraint(asked, ends.get("low", -np.inf), ends.get("high", np.inf), *over)  # type: ignore[arg-type]
    except ParameterError as error:
        document.problem(key, f"low and high: {error.expectation}")
        return None


def _over(document: Document, table: dict[str, Any], key: Key) -> tuple[str, float] | None:
    """The keys `over` and `share`, taken out of the table."""
    over = read_choice(document, table.pop("over", "nominal"), {each: each for each in OVERS}, (*key, "over"))
    about = Parameter("-", 0.0, 1.0, low_open=True, high_open=True)
    share = read_number(document, table.pop("share", 0.95), about, (*key, "share"))
    return None if over is WRONG or share is WRONG else (over, share)


def _nothing_left(document: Document, table: Mapping[str, Any], key: Key, *more: str) -> None:
    only(document, table, key, ("parameter", "range", "limit", "duration", "weights", "name", "over", "share", *more))
