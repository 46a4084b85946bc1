"""The axes of a study file: [[study.axis]]."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from squealbox.design import Design
from squealbox.distributions import DISTRIBUTIONS
from squealbox.files.analyses import read_ends
from squealbox.files.document import Document
from squealbox.files.lines import Key
from squealbox.files.numbers import WRONG, only, read_choice, read_number, wrong
from squealbox.files.sheets import read_sheet
from squealbox.parameters import Choice, Parameter, ParameterError, known_names
from squealbox.scatter import SAMPLINGS, Scatter
from squealbox.studies import POINT, Axis, Space, grid, latin_hypercube, sampled, sobol_sequence, zipped

EXAMPLE = "parameter = 'friction.static', range = [0.2, 0.5], points = 61"
MOST = 10**8
SPACINGS = {"linear": np.linspace, "log": np.geomspace}


def read_axes(document: Document, given: Any, design: Design | None, seed: int) -> Space | None:
    """The product of all axes; None when something was wrong."""
    if not isinstance(given, list) or not given or not all(isinstance(each, Mapping) for each in given):
        document.problem(("study",), f"the tables [[study.axis]] are missing, expected one or more such as {EXAMPLE}")
        return None
    read = [_axis(document, table, ("study", "axis", i), design, seed + i) for i, table in enumerate(given)]
    axes = [axis for space in read if space is not None for axis in space.axes]
    if len(axes) < len(read) or document.problems:
        return None
    return _named(document, axes)


def _named(document: Document, axes: list[Axis]) -> Space | None:
    """The axes as a space; several of lists or samples get dimensions of their own."""
    several = [axis for axis in axes if axis.dim == POINT]
    if len(several) > 1:
        new = {id(axis): Axis(f"{POINT}_{i + 1}", axis.values) for i, axis in enumerate(several)}
        axes = [new.get(id(axis), axis) for axis in axes]
    try:
        return Space(axes)
    except ParameterError as error:
        document.problem(("study", "axis"), f"{error.value}: {error.expectation}")
        return None


def _axis(document: Document, table: Mapping[str, Any], key: Key, design: Design | None, seed: int) -> Space | None:
    if "sample" in table:
        return _sample(document, table, key, design, seed)
    if "together" in table:
        only(document, table, key, ("together",))
        given = table["together"]
        if not isinstance(given, list) or not given or not all(isinstance(each, Mapping) for each in given):
            wrong(document, (*key, "together"), given, "a list of tables, each with a parameter and its values")
            return None
        columns = [_values(document, each, (*key, "together", i), design) for i, each in enumerate(given)]
        return _made(document, key, zipped, columns)
    return _made(document, key, grid, [_values(document, table, key, design)])


def _made(document: Document, key: Key, make: Any, columns: list[Any]) -> Space | None:
    if any(column is None for column in columns):
        return None
    try:
        space: Space = make(dict(columns))
        return space
    except ParameterError as error:
        document.problem(key, f"{error.value}: {error.expectation}")
        return None


def _values(document: Document, table: Mapping[str, Any], key: Key, design: Design | None) -> tuple[str, Any] | None:
    """A parameter, and its values as a list or by a range."""
    name, about = _parameter(document, table, key, design)
    if about is None:
        return None
    if "values" in table:
        only(document, table, key, ("parameter", "values"))
        values = _list(document, table["values"], about, (*key, "values"))
    else:
        only(document, table, key, ("parameter", "range", "points", "spacing"))
        values = _range(document, table, about, key)
    return None if values is None else (name, values)


def _list(document: Document, given: Any, about: Parameter | Choice, key: Key) -> Any:
    if not isinstance(given, list) or not given:
        wrong(document, key, given, "a list of values")
        return None
    if isinstance(about, Choice):
        options = {word: word for word in about.options}
        read = [read_choice(document, each, options, (*key, i)) for i, each in enumerate(given)]
    else:
        read = [read_number(document, each, about, (*key, i)) for i, each in enumerate(given)]
    return None if any(each is WRONG for each in read) else read


def _range(document: Document, table: Mapping[str, Any], about: Parameter | Choice, key: Key) -> Any:
    if isinstance(about, Choice):
        document.problem(key, f"the key 'values' is missing, expected words out of {', '.join(about.options)}")
        return None
    ends = _ends(document, table, about, key)
    count = table.get("points", 0)
    if not isinstance(count, int) or isinstance(count, bool) or not 2 <= count <= MOST:
        what = "the key 'points' is missing" if "points" not in table else f"points = {count}"
        document.problem((*key, "points"), f"{what}: expected a whole number in [2, {MOST}]")
        return None
    spacing = read_choice(document, table.get("spacing", "linear"), SPACINGS, (*key, "spacing"))
    if ends is None or spacing is WRONG:
        return None
    if spacing is np.geomspace and ends[0] <= 0.0:
        wrong(document, (*key, "range"), table["range"], "values above 0 for a logarithmic spacing")
        return None
    return spacing(*ends, count)


def _ends(document: Document, table: Mapping[str, Any], about: Parameter, key: Key) -> tuple[float, float] | None:
    if "range" not in table:
        said = "the key 'range' or 'values' is missing, expected two values such as [0, 1], or a list of values"
        document.problem(key, said)
        return None
    return read_ends(document, table["range"], about, (*key, "range"))


def _sample(document: Document, table: Mapping[str, Any], key: Key, design: Design | None, seed: int) -> Space | None:
    """A sample of ranges, or of distributions with their correlation."""
    only(document, table, key, ("sample", "points", "of", "correlation"))
    method = read_choice(document, table["sample"], {name: name for name in SAMPLINGS}, (*key, "sample"))
    count, given = table.get("points"), table.get("of")
    if not isinstance(count, int) or isinstance(count, bool) or not 1 <= count <= MOST:
        document.problem((*key, "points"), f"a sample needs points, a whole number in [1, {MOST}]")
        return None
    if not isinstance(given, list) or not given or not all(isinstance(each, Mapping) for each in given):
        document.problem(
            (*key, "of"), "a sample needs 'of', a list of tables with a parameter and a range or distribution"
        )
        return None
    read = [_scattered(document, each, (*key, "of", i), design) for i, each in enumerate(given)]
    if method is WRONG or any(each is None for each in read):
        return None
    spread = dict(each for each in read if each is not None)
    if all(isinstance(each, tuple) for each in spread.values()) and "correlation" not in table:
        ways = {"latin_hypercube": latin_hypercube, "sobol": sobol_sequence}
        if method in ways:
            return ways[method](spread, count, seed=seed)
    pairs = read_correlation(document, table.get("correlation", []), (*key, "correlation"))
    try:
        uniform = DISTRIBUTIONS["uniform"]
        all_of = {name: uniform(*each[:2]) if isinstance(each, tuple) else each for name, each in spread.items()}
        return sampled(Scatter(all_of, pairs), count, method=method, seed=seed)
    except ParameterError as error:
        document.problem(key, f"{error.name} = {error.value}: {error.expectation}")
        return None


def _scattered(document: Document, table: Mapping[str, Any], key: Key, design: Design | None) -> tuple[str, Any] | None:
    name, about = _parameter(document, table, key, design)
    if about is None:
        return None
    if isinstance(about, Choice):
        document.problem(key, f"{name} is a word, which has no distribution: give it an axis with values")
        return None
    if "distribution" not in table:
        only(document, table, key, ("parameter", "range", "spacing"))
        ends = _ends(document, table, about, key)
        spacing = read_choice(document, table.get("spacing", "linear"), SPACINGS, (*key, "spacing"))
        if ends is None or spacing is WRONG:
            return None
        return name, (*ends, "log") if spacing is np.geomspace else ends
    sheet = read_choice(document, table["distribution"], DISTRIBUTIONS, (*key, "distribution"))
    if sheet is WRONG:
        return None
    rest = {word: value for word, value in table.items() if word not in ("parameter", "distribution")}
    read = read_sheet(document, sheet, rest, key, unit=about.unit, beside=("parameter", "distribution"))
    return None if read is None else (name, read)


def read_correlation(document: Document, given: Any, key: Key) -> dict[tuple[str, str], float]:
    """``[["k1", "k2", 0.5]]`` as pairs."""
    expected = "a list such as [['k1', 'k2', 0.5]], two parameters and their correlation"
    if not isinstance(given, list):
        wrong(document, key, given, expected)
        return {}
    pairs = {}
    for i, each in enumerate(given):
        match each:
            case [str(first), str(second), float() | int() as value]:
                pairs[first, second] = float(value)
            case _:
                wrong(document, (*key, i), each, expected)
    return pairs


def _parameter(
    document: Document, table: Mapping[str, Any], key: Key, design: Design | None
) -> tuple[str, Parameter | Choice | None]:
    name = table.get("parameter")
    if not isinstance(name, str):
        document.problem(key, f"the key 'parameter' is missing, expected for example {EXAMPLE}")
        return "", None
    if design is None:
        return name, None
    known: dict[str, Parameter | Choice] = {**design.scalars(), **design.words()}
    if name not in known:
        document.problem((*key, "parameter"), f"unknown parameter {name[:60]!r}, {known_names(name[:60], list(known))}")
        return name, None
    return name, known[name]
