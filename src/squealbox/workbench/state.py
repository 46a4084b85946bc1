"""From what the page sends to a design. Nothing is kept between two questions: each carries the whole state.

    {"brake": "drum_brake", "laws": {"friction": "stribeck"}, "values": {"friction.static": 0.4, "reading": "eq3"}}

`brake` is a design of the house; `base` instead names a text that was opened before on the same connection. `laws` are
friction laws chosen instead of the design's own, `values` what was changed. What is wrong is told for each field.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.design import Design
from squealbox.designs import DESIGNS
from squealbox.friction import LAW_NAMES, Coulomb
from squealbox.law import FrictionLaw
from squealbox.parameters import DataSheet, ParameterError, known_names
from squealbox.registers import name_of
from squealbox.schedules import Schedule, value_at
from squealbox.system import InvalidSystem

MOST_VALUES = 500
LONGEST_NAME = 100


@dataclass(frozen=True)
class Wrong:
    """One thing that is wrong with a state: the field it belongs to, empty for the whole, and a sentence."""

    field: str
    message: str


class StateError(ValueError):
    """A state that is no design; `wrong` says why, field by field."""

    def __init__(self, *wrong: Wrong) -> None:
        self.wrong = wrong
        super().__init__("; ".join(f"{each.field}: {each.message}" if each.field else each.message for each in wrong))


class UnknownBase(StateError):
    """The text the state builds on was not opened on this connection, as after a restart of the server."""


def design_of(state: Any, bases: Mapping[str, Design]) -> Design:
    """The design a state describes; `bases` are those opened from texts.

    Raises `StateError` with all that is wrong, `UnknownBase` where the page has to send its text again.
    """
    if not isinstance(state, Mapping):
        raise StateError(Wrong("", "the state is no object"))
    design = _start(state, bases)
    laws, values = state.get("laws") or {}, state.get("values") or {}
    if not isinstance(laws, Mapping) or not isinstance(values, Mapping) or len(laws) + len(values) > MOST_VALUES:
        raise StateError(Wrong("", f"laws and values: expected two objects of at most {MOST_VALUES} entries"))
    wrong: list[Wrong] = []
    for field, name in laws.items():
        design = _with_law(design, field, name, wrong)
    design = _with_values(design, values, wrong)
    if wrong:
        raise StateError(*wrong)
    try:
        with np.errstate(all="ignore"):  # an overflow is reported by the system as a value that is not finite
            design.system()
    except (InvalidSystem, ParameterError) as error:
        raise StateError(_about(error)) from error
    return design


CHOOSABLE = tuple(name for name, law in LAW_NAMES.items() if law.like(Coulomb(0.4, 0.25), 1.0) is not None)


def speed_of(design: Design) -> float:
    """The sliding speed [m/s] friction is looked at: the largest of the contacts at the start."""
    speeds = [float(np.max(np.abs(value_at(contact.V, 0.0)))) for contact in design.system().contacts]
    return max(speeds, default=1.0)


def _start(state: Mapping[str, Any], bases: Mapping[str, Design]) -> Design:
    base, brake = state.get("base"), state.get("brake")
    if base:
        if not isinstance(base, str) or base not in bases:
            raise UnknownBase(Wrong("base", "this file is not open here"))
        return bases[base]
    if not isinstance(brake, str) or brake not in DESIGNS:
        raise StateError(Wrong("brake", f"expected {known_names(str(brake)[:LONGEST_NAME], list(DESIGNS))}"))
    return DESIGNS[brake]()


def _with_law(design: Design, field: str, name: Any, wrong: list[Wrong]) -> Design:
    path = str(field)[:LONGEST_NAME]
    try:
        law = design.value_of(path)
    except ParameterError as error:
        wrong.append(Wrong(path, error.expectation))
        return design
    if not isinstance(law, FrictionLaw):
        wrong.append(Wrong(path, "this is no friction law"))
    elif name == name_of(type(law)):
        return design
    elif name not in CHOOSABLE:
        wrong.append(Wrong(path, f"expected {known_names(str(name)[:LONGEST_NAME], list(CHOOSABLE))}"))
    else:
        return design.replace({path: LAW_NAMES[name].like(law, speed_of(design))})
    return design


def _with_values(design: Design, values: Mapping[str, Any], wrong: list[Wrong]) -> Design:
    """The design with the values that make sense; together where they do, one by one to say which do not."""
    checked: dict[str, Any] = {}
    for path, value in values.items():
        try:
            _check_path(design, path)
            checked[path] = _plain(design, path, value)
        except ParameterError as error:
            wrong.append(Wrong(str(path)[:LONGEST_NAME], error.expectation))
    try:
        return design.replace(checked)
    except ParameterError as together:
        before = len(wrong)
        for path, value in checked.items():
            try:
                design.replace({path: value})
            except ParameterError as error:
                wrong.append(Wrong(path, error.expectation))
        if len(wrong) == before:  # each is right alone: only together they are not
            wrong.append(_about(together, list(checked)))
    return design


def _check_path(design: Design, path: Any) -> None:
    if not isinstance(path, str) or len(path) > LONGEST_NAME:
        raise ParameterError("state", "values", str(path)[:LONGEST_NAME], "the name of a parameter")
    design.value_of(path)


def _plain(design: Design, path: str, value: Any) -> Any:
    """A number, a word or None; nothing else can stand in a field of the page."""
    now = design.value_of(path)
    if isinstance(now, (DataSheet, tuple)) or (np.ndim(now) > 0 and not isinstance(now, str)):
        what = "a value that the page cannot change" if not isinstance(now, Schedule) else "a schedule, left as it is"
        raise ParameterError("state", path, value, what)
    if value is None or isinstance(value, str):
        return value
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise ParameterError("state", path, str(value)[:LONGEST_NAME], "a number")
    try:
        return float(value)
    except OverflowError as error:
        raise ParameterError("state", path, str(value)[:20], "a finite number") from error


def _about(error: ParameterError | InvalidSystem, paths: list[str] | None = None) -> Wrong:
    """The field an error of the design is about, where it names one."""
    if not isinstance(error, ParameterError):
        return Wrong("", str(error))
    named = [path for path in paths or [] if path == error.name or path.endswith(f".{error.name}")]
    return Wrong(named[0] if named else error.name, error.expectation)
