"""A number of a design by name, as the sections [scatter] and [optimise] ask for it: its keys and their units."""

from collections.abc import Mapping
from typing import Any

from squealbox import quantities
from squealbox.design import Design
from squealbox.files.analyses import read_ends
from squealbox.files.document import Document
from squealbox.files.lines import Key
from squealbox.files.numbers import WRONG, read_choice, read_number, wrong
from squealbox.files.varied import flattened, known
from squealbox.parameters import Parameter, known_names
from squealbox.studies import Quantity

# Each quantity with the keys it needs and those it may have beside them.
KEYS: dict[str, tuple[tuple[str, ...], tuple[str, ...]]] = {
    "growth_rate": ((), ("limit",)),
    "damping_ratio": ((), ("limit",)),
    "critical_value": (("parameter", "range"), ("limit",)),
    "margin": (("parameter", "range"), ()),
    "amplitude": (("limit",), ("duration",)),
    "parameter": (("parameter",), ("name",)),
    "weighted_sum": (("weights",), ("name", "unit")),
}
OWN = ("parameter", "range", "limit", "duration", "weights", "name", "unit")
DURATION = Parameter("s", 0.0, low_open=True)


def read_quantity(
    document: Document, table: Mapping[str, Any], key: Key, design: Design | None, *, word: str = "quantity"
) -> tuple[Quantity | None, dict[str, Any]]:
    """The quantity a table names, None when something was wrong; and what the table holds beside it.

    `word` is the key under which the file names it.
    """
    rest = {name: value for name, value in table.items() if name not in ("quantity", *OWN)}
    if "quantity" not in table:
        document.problem(key, f"the key '{word}' is missing, expected {known_names('', list(KEYS))}")
        return None, rest
    name = read_choice(document, table["quantity"], {each: each for each in KEYS}, (*key, word))
    if name is WRONG:
        return None, rest
    before = len(document.problems)
    needed, allowed = KEYS[name]
    for each in needed:
        if each not in table:
            document.problem(key, f"the key '{each}' is missing, which {name} needs")
    for each in OWN:
        if each in table and each not in (*needed, *allowed):
            document.problem((*key, each), f"{name} does not have it, {known_names(each, [*needed, *allowed])}")
    if len(document.problems) > before or design is None:
        return None, rest
    made = _made(document, name, table, key, design)
    return (made if len(document.problems) == before else None), rest


def _made(document: Document, name: str, table: Mapping[str, Any], key: Key, design: Design) -> Quantity | None:
    if name in ("growth_rate", "damping_ratio"):
        about = Parameter("1/s" if name == "growth_rate" else "-")
        limit = read_number(document, table.get("limit", 0.0), about, (*key, "limit"))
        return None if limit is WRONG else getattr(quantities, name)(limit=limit)
    if name == "amplitude":
        limit = read_number(document, table["limit"], Parameter("m", 0.0, low_open=True), (*key, "limit"))
        duration = read_number(document, table.get("duration", 0.05), DURATION, (*key, "duration"))
        return None if limit is WRONG or duration is WRONG else quantities.amplitude(duration, limit=limit)
    if name == "weighted_sum":
        return _sum(document, table, key, design)
    found = table["parameter"]
    declared = known(document, found, (*key, "parameter"), design)
    if declared is None:
        return None
    unit = "" if declared.unit == "-" else declared.unit
    if name == "parameter":
        return quantities.weighted_sum({found: 1.0}, name=str(table.get("name", found)), unit=unit)
    ends = read_ends(document, table["range"], declared, (*key, "range"))
    if ends is None:
        return None
    if name == "margin":
        return quantities.margin(found, ends, unit=unit)
    usual = design.value_of(found)
    if "limit" not in table and not isinstance(usual, float):
        document.problem(key, "the key 'limit' is missing: the design does not have one value of it")
        return None
    limit = read_number(document, table.get("limit", usual), declared, (*key, "limit"))
    return None if limit is WRONG else quantities.critical_value(found, ends, limit=limit, unit=unit)


def _sum(document: Document, table: Mapping[str, Any], key: Key, design: Design) -> Quantity | None:
    given = table["weights"]
    if not isinstance(given, Mapping) or not given:
        wrong(document, (*key, "weights"), given, "a table of parameters with a number each, such as { m = 1 }")
        return None
    weights: dict[str, float] = {}
    for name, value, place in flattened(given, (*key, "weights"), design):
        number = read_number(document, value, Parameter("-"), place)
        if known(document, name, place, design) is not None and number is not WRONG:
            weights[name] = number
    words = {each: table.get(each, usual) for each, usual in (("name", "weighted sum"), ("unit", ""))}
    for each, text in words.items():
        if not isinstance(text, str):
            wrong(document, (*key, each), text, "a word in quotes")
    return quantities.weighted_sum(weights, **words) if len(weights) else None
