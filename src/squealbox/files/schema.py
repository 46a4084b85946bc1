"""The JSON schema of a design file, for editors that complete keys and mark mistakes while one types."""

import dataclasses
import math
import typing
from collections.abc import Sequence
from typing import Any

from squealbox.calibration import CalibrateSettings, Recorded
from squealbox.family import ParameterAxis
from squealbox.fe import AssembledBrake
from squealbox.files import countermeasures
from squealbox.files.arrays import TRIANGLES
from squealbox.files.assembled import ASSEMBLED
from squealbox.files.measurements import fitted_schemas
from squealbox.files.reading import BRAKES, STUDY
from squealbox.files.reduced import REDUCED, Reduce
from squealbox.files.sheets import OWN, is_required
from squealbox.files.study import OTHERS
from squealbox.files.uncertain_schema import optimise_schema, scatter_schema
from squealbox.files.varied import VARY
from squealbox.friction import LAW_NAMES, OwnLaw
from squealbox.law import FrictionLaw
from squealbox.parameters import DataSheet, Parameter, field_type
from squealbox.schedules import SCHEDULE_NAMES
from squealbox.stability import ModeSettings
from squealbox.studies import RefineSettings, StudySettings
from squealbox.transient import MotionSettings

Schema = dict[str, Any]
VARIES: Schema = {"type": "object", "minProperties": 1, "description": "parameters, and what each may be"}
QUANTITY = r"^ *[+-]?([0-9]+\.?[0-9]*|\.[0-9]+)([eE][+-]?[0-9]+)? *[^0-9]?.*$|^none$"


def json_schema() -> Schema:
    """The schema (draft 7) of a design file, made from the declarations of designs, laws, schedules and sections."""
    definitions = {
        **{f"law.{name}": _sheet(law, first={"law": {"const": name}}) for name, law in LAW_NAMES.items()},
        **{f"schedule.{name}": _sheet(schedule) for name, schedule in SCHEDULE_NAMES.items()},
        "law.own": _own_law(),
        "law": {"type": "object", "required": ["law"], "oneOf": [_ref(f"law.{name}") for name in (*LAW_NAMES, OWN)]},
        "schedule": {"type": "object", "oneOf": [_one_key(name, _ref(f"schedule.{name}")) for name in SCHEDULE_NAMES]},
        "axis": _axis(),
    }
    sections = {
        "modes": _sheet(ModeSettings),
        "simulate": _sheet(MotionSettings, more={"start": _start()}),
        "reduce": _sheet(Reduce, more={"varying": {"type": "object", "description": "parameters and their ranges"}}),
        "onset": _or_vary(_axis(), "parameter", "range"),
        "branch": _or_vary(_axis(), "parameter", "range"),
        "map": _or_vary(
            {
                "type": "object",
                "description": "[map]: stability over two parameters",
                "properties": {"x": _ref("axis"), "y": _ref("axis")},
                "required": ["x", "y"],
                "additionalProperties": False,
            },
            "x",
            "y",
        ),
        STUDY: _study(),
        "scatter": _or_vary(scatter_schema(_sheet), "parameters"),
        "optimise": _or_vary(optimise_schema(_sheet), "variables"),
        **countermeasures.schemas(_field),
        "calibrate": _sheet(CalibrateSettings, first=fitted_schemas()),
        "recording": _sheet(Recorded, more={"channel": {"type": ["integer", "string"], "minimum": 0}}),
    }
    brakes = [_sheet(brake, first={"brake": {"const": name}}, more=sections) for name, brake in BRAKES.items()]
    return {
        "$schema": "http://json-schema.org/draft-07/schema#",
        "title": "squealbox design file",
        "type": "object",
        "properties": {
            "brake": {"enum": [*BRAKES, ASSEMBLED, REDUCED], "description": "which brake the file describes"}
        },
        "required": ["brake"],
        "oneOf": [*brakes, _assembled(sections), _reduced(sections)],
        "definitions": definitions,
    }


def _assembled(sections: Schema) -> Schema:
    """A brake of exported matrices; its tables are checked by their reader."""
    own: Schema = {name: {} for name in AssembledBrake.field_names()}
    scalars = {name: _number(about) for name, about in AssembledBrake.parameters().items()}
    tables: Schema = {"structure": {"type": "object"}, "interfaces": {"type": "array"}, "systems": {"type": "array"}}
    return {
        "type": "object",
        "description": "A finite-element brake from exported matrices",
        "properties": {"brake": {"const": ASSEMBLED}, **own, **scalars, **tables, "friction": _ref("law"), **sections},
        "required": ["brake", "structure"],
        "additionalProperties": False,
    }


def _reduced(sections: Schema) -> Schema:
    """A brake that `squealbox reduce` wrote."""
    file: Schema = {"type": "string", "description": "the .npz file of squealbox reduce, beside this one"}
    values: Schema = {"type": "object", "description": "values of what it was reduced for"}
    own: Schema = {"brake": {"const": REDUCED}, "file": file, "values": values, "friction": _ref("law")}
    return {
        "type": "object",
        "description": "A finite-element brake that was reduced before",
        "properties": {**own, **sections},
        "required": ["brake", "file"],
        "additionalProperties": False,
    }


def _sheet(sheet: type[DataSheet], *, first: Schema | None = None, more: Schema | None = None) -> Schema:
    properties = dict(first or {})
    required = list(first or {})
    for field in dataclasses.fields(sheet):  # type: ignore[arg-type]
        properties[field.name] = _field(sheet, field.name)
        if is_required(field):
            required.append(field.name)
    for alias, names in sheet.aliases.items():
        properties[alias] = {**properties[names[0]], "description": f"sets {' and '.join(names)} together"}
        required = [name for name in required if name not in names]
    for old, name in sheet.formerly.items():
        properties[old] = {**properties[name], "deprecated": True}
    schema: Schema = {
        "type": "object",
        "description": (sheet.__doc__ or "").strip().partition("\n")[0],
        "properties": {**properties, **(more or {})},
        "additionalProperties": False,
    }
    return {**schema, "required": required} if required else schema


def _field(sheet: type[DataSheet], name: str) -> Schema:
    declared, about = field_type(sheet, name), sheet.parameters().get(name)
    if typing.get_origin(declared) is typing.Annotated:
        return _array(about or Parameter("-"), declared.__metadata__[0])
    if about is not None:
        return _several(about) if declared is Any and not about.schedule else _number(about, whole=declared is int)
    words = sheet.choices().get(name)
    if words is not None:
        return {"enum": list(words.options), "description": words.meaning}
    if typing.get_origin(declared) in (tuple, Sequence):
        item = typing.get_args(declared)[0]
        return {"type": "array", "items": {"type": "string"} if item is str else _sheet(item)}
    if isinstance(declared, type) and issubclass(declared, FrictionLaw):
        return _ref("law")
    if isinstance(declared, type) and issubclass(declared, DataSheet):
        return _sheet(declared)
    return {"type": "boolean" if declared is bool else "string"}


def _number(about: Parameter, *, whole: bool = False) -> Schema:
    """A number in SI, or a number with a unit in quotes; the range is checked of the first."""
    schema: Schema = {"type": "integer" if whole else ["number", "string"], "description": _description(about)}
    if not whole:
        schema["pattern"] = QUANTITY
    for limit, is_open, word in ((about.low, about.low_open, "Minimum"), (about.high, about.high_open, "Maximum")):
        if math.isfinite(limit):
            schema[f"exclusive{word}" if is_open else word.lower()] = limit
    if about.schedule:
        return {"description": _description(about), "anyOf": [schema, _ref("schedule")]}
    return schema


def _several(about: Parameter) -> Schema:
    return {"description": _description(about), "anyOf": [_number(about), {"type": "array", "items": _number(about)}]}


def _array(about: Parameter, ndim: int) -> Schema:
    one = _number(about)
    row = {"type": "array", "items": {"anyOf": [one, _ref("schedule")]} if about.schedule else one}
    inline = {"type": "array", "items": row} if ndim == 2 else row
    file = {"type": "string", "description": "a .npy, .mtx or .csv file beside this one"}
    table = {
        "type": "object",
        "properties": {"file": file, "unit": {"type": "string"}, "triangle": {"enum": list(TRIANGLES)}},
        "required": ["file"],
        "additionalProperties": False,
    }
    return {
        "description": _description(about),
        "anyOf": [inline, file, table, *([_ref("schedule")] if about.schedule else [])],
    }


def _own_law() -> Schema:
    properties = {
        "law": {"const": OWN},
        "file": {"type": "string", "description": "a .py file beside this one with mu(v, p); needs --allow-code"},
        "numbers": {"type": "array", "items": _number(Parameter("-")), "description": "p[1], p[2] and so on"},
        "static": _number(OwnLaw.parameters()["static"]),
    }
    return {"type": "object", "properties": properties, "required": ["law", "file"], "additionalProperties": False}


def _axis() -> Schema:
    end = {"type": ["number", "string"], "pattern": QUANTITY}
    return {
        "type": "object",
        "description": "a parameter and the range it is varied over",
        "properties": {
            "parameter": {"type": "string", "description": "dotted name, such as friction.static"},
            "range": {"type": "array", "items": end, "minItems": 2, "maxItems": 2, "description": "low and high"},
            "points": _number(ParameterAxis.parameters()["points"], whole=True),
        },
        "required": ["parameter", "range"],
        "additionalProperties": False,
    }


def _or_vary(section: Schema, *instead: str) -> Schema:
    """A section, or the same with one key `vary` instead of some."""
    properties = {name: value for name, value in section["properties"].items() if name not in instead}
    required = [name for name in section["required"] if name not in instead]
    varied = {**section, "properties": {**properties, VARY: VARIES}, "required": [*required, VARY]}
    return {"anyOf": [section, varied]}


def _start() -> Schema:
    """A word, one of them with the number of a mode, or a table of mode and amplitude."""
    keys = {name: _field(MotionSettings, name) for name in ("mode", "amplitude")}
    table = {"type": "object", "properties": keys, "required": ["mode"], "additionalProperties": False}
    words = _field(MotionSettings, "start")
    return {
        "description": words["description"],
        "anyOf": [words, {"type": "string", "pattern": "^mode [0-9]+$"}, table],
    }


def _study() -> Schema:
    """[study]; its axes come in several forms, which the reader checks."""
    words = {"type": "array", "items": {"type": "string"}, "minItems": 1}
    axes = {"type": "array", "items": {"type": "object"}, "minItems": 1, "description": "the axes of the space"}
    return _sheet(
        StudySettings, more=dict(zip(OTHERS, (axes, VARIES, words, words, _sheet(RefineSettings)), strict=True))
    )


def _one_key(name: str, value: Schema) -> Schema:
    return {"type": "object", "properties": {name: value}, "required": [name], "additionalProperties": False}


def _description(about: Parameter) -> str:
    return "; ".join(part for part in (about.meaning, about.range, about.source) if part)


def _ref(name: str) -> Schema:
    return {"$ref": f"#/definitions/{name}"}
