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

from squealbox.calibration import QUANTITIES, Measured
from squealbox.calibration.measured import UNITS
from squealbox.designs import Design
from squealbox.files.analyses import read_ends, read_spans
from squealbox.files.document import Document
from squealbox.files.lines import Key
from squealbox.files.numbers import WRONG, only, read_choice, read_number, wrong
from squealbox.files.varied import flattened, known
from squealbox.parameters import Parameter, ParameterError
from squealbox.signals.events import LEAST_LEVEL

LOSSES = ("squares", "robust")
FREQUENCY = Parameter("Hz", 0.0, low_open=True)
KEYS = ("quantity", "value", "sd", "mode", "at", "parameter", "range", "speed", "duration")


@dataclass(frozen=True)
class Calibrated:
    """[calibrate]: what is fitted, to what, and how bad numbers are treated."""

    parameters: dict[str, tuple[float, float]]
    measured: tuple[Measured, ...]
    loss: str = "squares"


@dataclass(frozen=True)
class Recorded:
    """[recording]: the file beside the design, what its numbers are worth, and what counts as squeal.

    Without a band squeal is looked for where it is usual, and as far down as half the frequency that is expected.
    """

    file: str
    unit: str = ""
    full_scale: float | None = None
    rate: float | None = None
    channel: int = 0
    band: tuple[float, float] | None = None
    least_level: float = LEAST_LEVEL


def read_recorded(document: Document, table: Mapping[str, Any], key: Key, design: Design | None) -> Recorded | None:
    """The section [recording]."""
    before = len(document.problems)
    words = ("file", "unit", "full_scale", "rate", "channel", "band", "least_level")
    only(document, table, key, words)
    for name in ("file", "unit"):
        if not isinstance(table.get(name, "x" if name == "unit" else None), str):
            wrong(document, (*key, name), table.get(name), "a word in quotes")
    unit = table.get("unit", "") if isinstance(table.get("unit", ""), str) else ""
    numbers: dict[str, Any] = {}
    about = {
        "full_scale": Parameter("Pa" if unit == "Pa" else "-", 0.0, low_open=True),
        "rate": FREQUENCY,
        "least_level": Parameter("-"),
    }
    for name, each in about.items():
        if name in table:
            numbers[name] = read_number(document, table[name], each, (*key, name))
    channel = table.get("channel", 0)
    if not isinstance(channel, int) or isinstance(channel, bool) or channel < 0:
        wrong(document, (*key, "channel"), channel, "a whole number from 0 on")
    if "band" in table:
        numbers["band"] = read_ends(document, table["band"], FREQUENCY, (*key, "band"))
    if len(document.problems) > before:
        return None
    return Recorded(str(table["file"]), unit, channel=channel, **numbers)


def read_calibrated(document: Document, table: Mapping[str, Any], key: Key, design: Design | None) -> Calibrated | None:
    """The section [calibrate]."""
    before = len(document.problems)
    only(document, table, key, ("parameters", "measured", "loss"))
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
    loss = read_choice(document, table.get("loss", "squares"), {word: word for word in LOSSES}, (*key, "loss"))
    if len(document.problems) > before:
        return None
    return Calibrated(bounds, tuple(each for each in measured if each is not None), loss)


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


def measurement_schemas() -> dict[str, Any]:
    """The JSON schemas of the two sections."""
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
    calibrate = {
        "type": "object", "description": "[calibrate]: parameters fitted to measured numbers",
        "properties": {
            "parameters": {**table, "additionalProperties": {"anyOf": [ends, table]}},
            "measured": {"type": "array", "items": row, "minItems": 1}, "loss": {"enum": list(LOSSES)},
        },
        "required": ["parameters", "measured"], "additionalProperties": False,
    }  # fmt: skip
    recording = {
        "type": "object", "description": "[recording]: a recording beside the design file",
        "properties": {
            "file": {"type": "string"}, "unit": {"type": "string"}, "full_scale": number, "rate": number, "band": ends,
            "channel": {"type": "integer", "minimum": 0}, "least_level": number,
        },
        "required": ["file"], "additionalProperties": False,
    }  # fmt: skip
    return {"calibrate": calibrate, "recording": recording}
