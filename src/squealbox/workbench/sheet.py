"""What the page has to know of a design: each field with unit, range, meaning and source, and where its slider runs."""

import math
from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from squealbox.design import Design
from squealbox.friction import LAW_NAMES
from squealbox.law import FrictionLaw
from squealbox.parameters import DataSheet, Parameter, field_type
from squealbox.registers import name_of
from squealbox.schedules import Schedule
from squealbox.words import read_in
from squealbox.workbench.frames import finite
from squealbox.workbench.state import CHOOSABLE

STEPS = 500  # of a slider


def sheet(design: Design) -> dict[str, Any]:
    """The fields of a design in order, the parameters a study can vary, and its aliases."""
    known, brake = design.scalars(), design.innermost
    title, layers = brake.title or type(brake).__name__, [type(layer).title.lower() for layer in design.layers]
    return {
        "title": f"{title}, with {', '.join(layers)}" if layers else title,
        "source": brake.source,
        "about": _first_lines(design),
        "fields": list(_fields(design, "")),
        "varied": list(known),
        "aliases": {alias: list(names) for alias, names in brake.aliases.items() if alias in known},
    }


def slider(value: float, about: Parameter, whole: bool = False) -> tuple[float, float]:
    """Where the slider of a parameter runs [SI]: its range where that is short, else 0 to about 2.5 times its value.

    >>> slider(0.3, Parameter("-", 0.0, 10.0))
    (0.0, 1.0)
    """
    if about.unit == "-" and not whole and about.high == 10.0:  # coefficients of friction
        return 0.0, max(1.0, _round_up(1.2 * value))
    if math.isfinite(about.low) and math.isfinite(about.high) and about.unit == "rad":
        return about.low, about.high
    top = _round_up(2.5 * abs(value)) if value else 1.0
    low = about.low if about.low >= 0.0 else -top
    low = max(low, about.low)
    if about.low_open and low == about.low:
        low += 0.02 * (top - low)
    if whole:
        low, top = max(about.low, 1.0), max(8.0, top)
    return low, min(top, about.high)


def _fields(owner: DataSheet, prefix: str) -> Iterator[dict[str, Any]]:
    parameters, words = owner.parameters(), owner.choices()
    if isinstance(owner, Design) and owner.layers:
        own = owner.field_names()
        for field in _fields(owner.layers[0].brake, ""):
            yield {**field, "path": f"brake.{field['path']}"} if field["path"] in own else field
    for name in owner.field_names():
        value, path = getattr(owner, name), prefix + name
        if isinstance(value, FrictionLaw):
            yield _law(value, path)
            yield from _fields(value, f"{path}.")
        elif name in words:
            about = words[name]
            yield {"path": path, "kind": "choice", "value": value, "options": about.options, "meaning": about.meaning}
        elif name in parameters:
            yield _parameter(owner, name, value, path, parameters[name])
    reduced_for = getattr(owner, "values", {})  # of a reduced brake, whose room takes long to load
    for name, quantity, value in owner.leaves() if reduced_for else ():
        if name in reduced_for:
            yield _number(name, quantity, value, value, whole=False)


def _parameter(owner: DataSheet, name: str, value: Any, path: str, about: Parameter) -> dict[str, Any]:
    field = {"path": path, "meaning": about.meaning, "source": about.source, "range": about.range}
    if isinstance(value, Schedule) or np.ndim(value) > 0:
        return {**field, "kind": "fixed", "value": f"{value!r}" if isinstance(value, Schedule) else _size(value)}
    return field | _number(path, about, value, owner.usual(name), field_type(type(owner), name) is int)


def _number(path: str, about: Parameter, value: Any, usual: Any, whole: bool) -> dict[str, Any]:
    unit, factor = read_in(about, usual)
    low, high = slider(float(value) if value is not None else 0.0, about, whole)
    if about.low > 0.0 and math.isfinite(about.high) and not about.unit:
        low, high = about.low, about.high  # of what a finite-element brake was reduced for
    return {
        "path": path,
        "meaning": about.meaning,
        "source": about.source,
        "kind": "number",
        "range": replace(about, unit=unit, low=about.low / factor, high=about.high / factor).range,
        "value": value,
        "unit": unit,
        "factor": factor,
        "low": finite(about.low),
        "high": finite(about.high),
        "lowOpen": about.low_open,
        "highOpen": about.high_open,
        "optional": about.optional,
        "whole": whole,
        "slider": [low, high],
        "step": 1.0 if whole else (high - low) / STEPS,
    }


def _law(law: FrictionLaw, path: str) -> dict[str, Any]:
    name = name_of(type(law))
    options = [name, *(other for other in CHOOSABLE if other != name)] if name not in CHOOSABLE else list(CHOOSABLE)
    titles = {each: _first_sentence(LAW_NAMES[each]) if each in LAW_NAMES else "own" for each in options}
    meaning = _first_sentence(type(law))
    return {"path": path, "kind": "law", "value": name, "options": options, "titles": titles, "meaning": meaning}


def _round_up(value: float) -> float:
    """The next of 1, 2, 2.5, 5, 10 times a power of ten."""
    if value <= 0.0:
        return 1.0
    power = 10.0 ** math.floor(math.log10(value))
    return next(step * power for step in (1.0, 2.0, 2.5, 5.0, 10.0) if step * power >= value * (1.0 - 1e-12))


def _size(value: Any) -> str:
    return " x ".join(str(n) for n in np.shape(value)) + " numbers"


def _first_sentence(kind: type) -> str:
    return (kind.__doc__ or "").strip().partition("\n")[0]


def _first_lines(design: Design) -> str:
    return " ".join((type(design).__doc__ or "").partition(">>>")[0].split())
