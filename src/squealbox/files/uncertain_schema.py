"""The JSON schema of the sections [scatter] and [optimise]."""

from collections.abc import Callable
from typing import Any

from squealbox.distributions import DISTRIBUTIONS
from squealbox.files.asked import KEYS
from squealbox.files.uncertain import OVERS, SENSES, STUDIES
from squealbox.parameters import DataSheet
from squealbox.studies import SampleSettings, SearchSettings

Schema = dict[str, Any]
NUMBER: Schema = {"type": ["number", "string"]}
ENDS: Schema = {"type": "array", "items": NUMBER, "minItems": 2, "maxItems": 2, "description": "low and high"}
TABLE: Schema = {"type": "object"}  # names to values, or tables of them where a dotted name has no quotes


def scatter_schema(sheet: Callable[[type[DataSheet]], Schema]) -> Schema:
    """[scatter]; `sheet` makes the schema of a data sheet."""
    distribution = {
        "type": "object",
        "oneOf": [_with_kind(sheet(kind), "distribution", name) for name, kind in DISTRIBUTIONS.items()],
    }
    pair = {"type": "array", "items": [{"type": "string"}, {"type": "string"}, {"type": "number"}], "minItems": 3}
    study = {"enum": list(STUDIES)}
    own = {
        "parameters": {**TABLE, "additionalProperties": {"anyOf": [distribution, TABLE]}},
        "correlation": {
            "type": "array",
            "items": pair,
            "description": "such as [['k1', 'k2', 0.5]], of the normal scores of two parameters (Gaussian copula)",
        },
        "study": {"anyOf": [study, {"type": "array", "items": study}], "description": "what is asked"},
    }
    properties = {**_asked("quantity"), **sheet(SampleSettings)["properties"], **own}
    return {
        **_closed(properties, "quantity", "parameters"),
        "description": "[scatter]: which parameters scatter, and of which number",
    }


def optimise_schema(sheet: Callable[[type[DataSheet]], Schema]) -> Schema:
    """[optimise]; `sheet` makes the schema of a data sheet."""
    over = {"over": {"enum": list(OVERS)}, "share": NUMBER}
    goals = [_closed({**_asked(sense), **over}, sense) for sense in SENSES]
    limits = {"low": NUMBER, "high": NUMBER}
    own = {
        "variables": {**TABLE, "additionalProperties": {"anyOf": [ENDS, TABLE]}},
        "goals": {"type": "array", "items": {"oneOf": goals}, "minItems": 1},
        "constraints": {"type": "array", "items": _closed({**_asked("quantity"), **over, **limits}, "quantity")},
    }
    return {
        **_closed({**sheet(SearchSettings)["properties"], **own}, "variables", "goals"),
        "description": "[optimise]: what may be changed and what is wanted",
    }


def _asked(word: str) -> Schema:
    text = {"type": "string"}
    return {
        word: {"enum": list(KEYS), "description": "a number of the design"},
        "parameter": {**text, "description": "dotted name, such as friction.static"},
        "range": ENDS,
        "limit": {**NUMBER, "description": "where squeal begins"},
        "duration": {**NUMBER, "description": "of the transients"},
        "weights": {**TABLE, "description": "parameters with a number each"},
        "name": text,
        "unit": text,
    }


def _with_kind(schema: Schema, word: str, name: str) -> Schema:
    properties = {word: {"const": name}, **schema["properties"]}
    return {**schema, "properties": properties, "required": [word, *schema.get("required", [])]}


def _closed(properties: Schema, *required: str) -> Schema:
    return {"type": "object", "properties": properties, "required": list(required), "additionalProperties": False}
