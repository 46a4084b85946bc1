"""The sections [[countermeasures]] and [[loops]] of a design file: what is put around the brake, from inside out.

[[countermeasures]]
kind = "tuned_mass"
on = "y"
mass = "50 g"
frequency = "1906 Hz"
damping = 0.013

[[loops]]
kind = "active_force"
on = "y"
mass = "100 g"
time_constant = "50 us"
outer = { kind = "pid", proportional = "2 kN/m" }
"""

import dataclasses
from collections.abc import Callable, Iterator, Mapping
from typing import Any

from squealbox.countermeasures import COUNTERMEASURES, Controlled, Countermeasure
from squealbox.design import Design
from squealbox.files.document import Document
from squealbox.files.lines import Key
from squealbox.files.numbers import WRONG, read_number, shown, wrong
from squealbox.files.sheets import is_required, read_field
from squealbox.loops import LOOPS, Loop
from squealbox.parameters import DataSheet, Parameter, ParameterError, known_names
from squealbox.system import InvalidSystem

SECTIONS = ("countermeasures", "loops")
Kinds = Mapping[str, type[DataSheet]]


def wrapped(document: Document, brake: Design, tables: Mapping[str, Any]) -> Design | None:
    """The brake with the countermeasures and loops of its file; None when something is wrong, which is noted."""
    design: Design = brake
    for i, table in enumerate(_tables(document, tables, "countermeasures")):
        made = _sheet(document, table, ("countermeasures", i), COUNTERMEASURES, {"brake": design})
        if made is None or not _works(document, made, ("countermeasures", i)):
            return None
        design = made
    loops = [_sheet(document, t, ("loops", i), LOOPS, {}) for i, t in enumerate(_tables(document, tables, "loops"))]
    if any(loop is None for loop in loops) or any(name in document.faulty for name in SECTIONS):
        return None
    if not loops:
        return design
    try:
        controlled = Controlled(design, tuple(loops))
    except ParameterError as error:
        document.problem(("loops",), str(error))
        return None
    return controlled if _works(document, controlled, ("loops",)) else None


def wrapped_text(
    design: Countermeasure, text_of: Callable[[Design], str], value_text: Callable[[Any, str, str], str],
    refused: type[ValueError],
) -> str:  # fmt: skip
    """The file of a brake within its countermeasures: that of the brake, then a table for each, from inside out."""
    lines = [text_of(design.innermost).rstrip("\n")]
    for layer in reversed(design.layers):
        if isinstance(layer, Controlled):
            if layer is not design:
                raise refused("loops stand inside another countermeasure: a file holds them outermost, Controlled(...)")
            for loop in layer.loops:
                lines += ["", "[[loops]]", *_lines(loop, LOOPS, value_text, refused)]
        else:
            lines += ["", "[[countermeasures]]", *_lines(layer, COUNTERMEASURES, value_text, refused)]
    return "\n".join(lines) + "\n"


def schemas(field: Callable[[type[DataSheet], str], dict[str, Any]]) -> dict[str, Any]:
    """The JSON schema of both sections; `field` is that of one field of a sheet."""
    return {name: {"type": "array", "items": {"oneOf": [
        _schema(word, sheet, field) for word, sheet in kinds.items()
    ]}} for name, kinds in (("countermeasures", COUNTERMEASURES), ("loops", LOOPS))}  # fmt: skip


def _tables(document: Document, tables: Mapping[str, Any], name: str) -> list[Any]:
    given = tables.get(name, [])
    if not isinstance(given, list) or not all(isinstance(item, Mapping) for item in given):
        wrong(document, (name,), given, f"tables, each under a line [[{name}]]")
        return []
    return given


def _sheet(document: Document, table: Mapping[str, Any], key: Key, kinds: Kinds, given: Mapping[str, Any]) -> Any:
    """The sheet that a table with the key `kind` describes; None when something was wrong."""
    kind = table.get("kind")
    if not isinstance(kind, str) or kind not in kinds:
        said = "is missing" if kind is None else f"{shown(kind)} is unknown"
        document.problem(
            (*key, "kind") if kind is not None else key,
            f"the kind {said}, expected {known_names(str(kind or ''), list(kinds))}",
        )
        return None
    sheet, before = kinds[kind], len(document.problems)
    values = dict(given)
    fields = [field for field in dataclasses.fields(sheet) if field.name not in given]  # type: ignore[arg-type]
    names = [field.name for field in fields]
    for name, value in table.items():
        if name == "kind":
            continue
        if name not in names:
            document.problem((*key, name), f"unknown key, {known_names(name[:60], names)}")
            continue
        values[name] = _value(document, sheet, name, value, (*key, name))
    for field in fields:
        if is_required(field) and field.name not in values:
            about = sheet.parameters().get(field.name)
            what = f" ({about.meaning}), expected a number in {about.range}" if about else ""
            document.problem(key, f"the key '{field.name}' is missing{what}")
    if len(document.problems) > before:
        return None
    try:
        return sheet(**values)
    except ParameterError as error:
        document.problem(
            (*key, error.name) if error.name in names else key, f"{shown(error.value)}: {error.expectation}"
        )
        return None


def _value(document: Document, sheet: type[DataSheet], name: str, value: Any, key: Key) -> Any:
    if name == "outer":
        if not isinstance(value, Mapping):
            return wrong(document, key, value, "a table such as { kind = 'pid', proportional = '2 kN/m' }")
        return _sheet(document, value, key, LOOPS, {})
    if name in ("position", "velocity") and sheet is LOOPS["state_feedback"]:
        unit = "N/m" if name == "position" else "N s/m"
        if not isinstance(value, list):
            return wrong(document, key, value, f"a list of gains in {unit}, one for each degree of freedom")
        found = [read_number(document, item, Parameter(unit), (*key, i)) for i, item in enumerate(value)]
        return WRONG if any(each is WRONG for each in found) else tuple(found)
    return read_field(document, sheet, name, value, key)


def _works(document: Document, design: Design, key: Key) -> bool:
    try:
        design.system()
    except (InvalidSystem, ParameterError) as error:
        name = error.name if isinstance(error, ParameterError) else ""
        document.problem((*key, name) if name in design.field_names() else key, str(error))
        return False
    return True


def _lines(
    sheet: DataSheet, kinds: Kinds, text: Callable[[Any, str, str], str], refused: type[ValueError]
) -> Iterator[str]:
    yield f"kind = {_kind(sheet, kinds, refused)}"
    for name, value in _said(sheet):
        yield f"{name} = {_text(sheet, name, value, text, refused)}"


def _text(
    sheet: DataSheet, name: str, value: Any, text: Callable[[Any, str, str], str], refused: type[ValueError]
) -> str:
    if isinstance(value, Loop):
        inner = [f"kind = {_kind(value, LOOPS, refused)}"]
        inner += [f"{key} = {_text(value, key, item, text, refused)}" for key, item in _said(value)]
        return f"{{ {', '.join(inner)} }}"
    about = sheet.parameters().get(name)
    return text(value, about.unit if about else "", name)


def _said(sheet: DataSheet) -> Iterator[tuple[str, Any]]:
    for field in dataclasses.fields(sheet):  # type: ignore[arg-type]
        value = getattr(sheet, field.name)
        if field.name != "brake" and not (value is None or value == field.default or value == ()):
            yield field.name, value


def _kind(sheet: DataSheet, kinds: Kinds, refused: type[ValueError]) -> str:
    found = next((word for word, kind in kinds.items() if kind is type(sheet)), None)
    if found is None:
        raise refused(f"{type(sheet).__name__} is not one of the kinds a file knows: {', '.join(kinds)}")
    return f'"{found}"'


def _schema(
    word: str, sheet: type[DataSheet], field: Callable[[type[DataSheet], str], dict[str, Any]]
) -> dict[str, Any]:
    properties: dict[str, Any] = {"kind": {"const": word}}
    required = ["kind"]
    for each in dataclasses.fields(sheet):  # type: ignore[arg-type]
        if each.name == "brake":
            continue
        if each.name == "outer":
            properties[each.name] = {"type": "object"}
        elif each.name in ("position", "velocity") and sheet is LOOPS["state_feedback"]:
            properties[each.name] = {"type": "array", "items": {"type": ["number", "string"]}}
        else:
            properties[each.name] = field(sheet, each.name)
        if is_required(each):
            required.append(each.name)
    about = (sheet.__doc__ or "").strip().partition("\n")[0]
    return {
        "type": "object",
        "description": about,
        "properties": properties,
        "required": required,
        "additionalProperties": False,
    }
