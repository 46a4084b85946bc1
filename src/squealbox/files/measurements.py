"""The sections [calibrate] and [recording] of a design file: what was measured, and what is fitted to it.

[recording]
file = "stop.wav"
unit = "Pa"
full_scale = "20 Pa"
band = ["2 kHz", "16 kHz"]

[calibrate.parameters]
"friction.static" = [0.2, 0.5]
[[calibrate.measured]]
quantity = "growth_rate"
value = "536 1/s"
sd = "20 1/s"
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from squealbox.calibration import QUANTITIES, UNITS, CalibrateSettings, Measured, Recorded
from squealbox.design import Design
from squealbox.files.analyses import read_ends, read_spans
from squealbox.files.document import Document
from squealbox.files.lines import Key
from squealbox.files.numbers import WRONG, only, read_choice, read_number, wrong
from squealbox.files.sheets import read_sheet
from squealbox.files.varied import flattened, known
from squealbox.parameters import Parameter, ParameterError

KEYS = ("quantity", "value", "sd", "mode", "at", "parameter", "range", "speed", "duration")


@dataclass(frozen=True)
class Calibrated:
    """[calibrate]: what is fitted, to what, and how."""

    parameters: dict[str, tuple[float, float]]
    measured: tuple[Measured, ...]
    how: CalibrateSettings


def read_recorded(document: Document, table: Mapping[str, Any], key: Key, design: Design | None) -> Recorded | None:
    """The section [recording]."""
    return read_sheet(document, Recorded, table, key)


def read_calibrated(document: Document, table: Mapping[str, Any], key: Key, design: Design | None) -> Calibrated | None:
    """The section [calibrate]."""
    before = len(document.problems)
    own = ("parameters", "measured")
    rest = {name: value for name, value in table.items() if name not in own}
    how = read_sheet(document, CalibrateSettings, rest, key, beside=own)
    parameters = table.get("parameters")
    bounds: dict[str, tuple[float, float]] = {}
    if not isinstance(parameters, Mapping) or not parameters:
        wrong(
            document, (*key, "parameters"), parameters, "a section with a line such as k3 = ['150 kN/mm', '230 kN/mm']"
        )
    else:
        bounds = read_spans(document, parameters, (*key, "parameters"), design)
    rows = table.get("measured")
    measured = []
    if not isinstance(rows, list) or not rows or not all(isinstance(row, Mapping) for row in rows):
        wrong(document, (*key, "measured"), rows, "tables, each under a line [[calibrate.measured]]")
    else:
        measured = [_measured(document, row, (*key, "measured", i), design) for i, row in enumerate(rows)]
    if how is None or len(document.problems) > before:
        return None
    return Calibrated(bounds, tuple(each for each in measured if each is not None), how)


def _measured(document: Document, row: Mapping[str, Any], key: Key, design: Design | None) -> Measured | None:
    before = len(document.problems)
    only(document, row, key, KEYS)
    name = read_choice(document, row.get("quantity"), {each: each for each in QUANTITIES}, (*key, "quantity"))
    if name is WRONG:
        return None
    varied = (
        known(document, row.get("parameter", "friction.static"), (*key, "parameter"), design)
        if (name == "critical_value")
        else None
    )
    about = Parameter(varied.unit if varied else UNITS.get(name, "-"))
    given: dict[str, Any] = {}
    for word, each in (("value", about), ("sd", Parameter(about.unit, 0.0, low_open=True))):
        if word not in row:
            document.problem(key, f"the key '{word}' is missing")
        else:
            given[word] = read_number(document, row[word], each, (*key, word))
    for word, each in (("speed", Parameter("m/s", 0.0)), ("duration", Parameter("s", 0.0, low_open=True))):
        if word in row:
            given[word] = read_number(document, row[word], each, (*key, word))
    if name == "critical_value":
        given["parameter"] = row.get("parameter", "friction.static")
        if "range" in row and varied is not None:
            given["bounds"] = read_ends(document, row["range"], varied, (*key, "range"))
    at = row.get("at", {})
    if not isinstance(at, Mapping):
        wrong(document, (*key, "at"), at, "a table of conditions, such as { load = '2 kN' }")
    else:
        given["at"] = _conditions(document, at, (*key, "at"), design)
    if "mode" in row:
        given["mode"] = row["mode"]
    if len(document.problems) > before:
        return None
    try:
        return Measured(name, **given)
    except ParameterError as error:
        document.problem((*key, error.name), f"expected {error.expectation}")
        return None


def _conditions(document: Document, table: Mapping[str, Any], key: Key, design: Design | None) -> dict[str, float]:
    found: dict[str, Any] = {}
    for name, value, place in flattened(table, key, design):
        about = known(document, name, place, design)
        if about is not None:
            found[name] = read_number(document, value, about, place)
    return {name: value for name, value in found.items() if value is not WRONG}


def fitted_schemas() -> dict[str, Any]:
    """The JSON schemas of what is fitted and to what, in [calibrate]."""
    number: dict[str, Any] = {"type": ["number", "string"]}
    ends = {"type": "array", "items": number, "minItems": 2, "maxItems": 2, "description": "low and high"}
    table: dict[str, Any] = {"type": "object"}
    row = {
        "type": "object", "required": ["quantity", "value", "sd"], "additionalProperties": False,
        "properties": {
            "quantity": {"enum": list(QUANTITIES)}, "value": number, "sd": number, "speed": number, "duration": number,
            "mode": {"anyOf": [{"enum": ["unstable", "nearest"]}, {"type": "integer", "minimum": 0}]},
            "at": table, "parameter": {"type": "string"}, "range": ends,
        },
    }  # fmt: skip
    parameters = {**table, "additionalProperties": {"anyOf": [ends, table]}}
    return {"parameters": parameters, "measured": {"type": "array", "items": row, "minItems": 1}}
