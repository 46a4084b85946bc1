"""From a design to a file that people can read, change and read back: every parameter with unit, meaning and range."""

import dataclasses
import json
import os
import textwrap
import typing
from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import numpy as np

from squealbox.arguments import public
from squealbox.countermeasures import Countermeasure
from squealbox.design import Design
from squealbox.files.countermeasures import wrapped_text
from squealbox.files.document import LARGEST
from squealbox.files.reading import BRAKES
from squealbox.files.sheets import unit_in
from squealbox.friction import OwnLaw
from squealbox.labelled import whole
from squealbox.law import FrictionLaw
from squealbox.parameters import Choice, DataSheet, Parameter, field_type
from squealbox.registers import name_of
from squealbox.schedules import SCHEDULE_NAMES, Constant, Schedule, Sum
from squealbox.units import in_si

# Units people prefer to the SI unit of the data sheet; one is used where it is shorter and reads back to the same bits.
FRIENDLY = {
    "rad": ("deg",),
    "N": ("kN",),
    "N/m": ("kN/mm", "N/mm"),
    "m": ("mm", "um"),
    "s": ("ms",),
    "Hz": ("kHz",),
    "kg": ("g",),
}
WIDTH = 110  # characters of a line
COLUMN = 30  # where comments begin


class NotWritable(ValueError):
    """A design that a file cannot hold, such as one that stands for a whole map; the message says which part."""


@public()
def write_design(design: Design, path: str | os.PathLike[str], *, sections: str = "") -> Path:
    """Write `design` as a commented TOML file that :func:`read_design` reads back equal; returns the path.

    `sections` is TOML text put behind it, such as a section [simulate]. The file is written whole or not at all.
    Raises `NotWritable` for what a file cannot hold.
    """
    path = Path(path)
    if not path.parent.is_dir():
        raise NotWritable(f"{path}: there is no folder {path.parent}, expected one that is there")
    with whole(path) as part:
        part.write_text(design_text(design) + sections, encoding="utf-8")
    return path


def design_text(design: Design) -> str:
    """The TOML text of `design`."""
    if isinstance(design, Countermeasure):
        return wrapped_text(design, design_text, _text, NotWritable)
    kind = next((name for name, brake in BRAKES.items() if brake is type(design)), None)
    if kind is None:
        raise NotWritable(f"{type(design).__name__} is not one of the designs a file knows: {', '.join(BRAKES)}")
    head = [f"# {design.title}", f"# Source: {design.source}", f"brake = {_quoted(kind)}"]
    lines = [*head, *_lines(design)]
    for name in design.field_names():
        lines += _tables(name, getattr(design, name))
    text = "\n".join(lines) + "\n"
    if len(text.encode()) > LARGEST:
        raise NotWritable("its matrices are too large for a design file: save each with numpy.save and name the files")
    return text


def cure_text(cured: Design, brake: Design, values: Mapping[str, float] | None = None) -> str:
    """What makes the file of `brake` that of `cured`: its last tables, or other `values` of parameters it has.

    Raises `NotWritable` for what a file cannot hold.
    """
    if values:
        units = {name: brake.unit_of(name) for name in values}
        return "".join(f"{name} = {_text(value, units[name] or '-', name)}\n" for name, value in values.items())
    before = wrapped_text(brake, _nothing, _text, NotWritable) if isinstance(brake, Countermeasure) else "\n"
    if not isinstance(cured, Countermeasure):
        raise NotWritable(f"{type(cured).__name__} holds no other brake: expected a countermeasure")
    return wrapped_text(cured, _nothing, _text, NotWritable)[len(before) :].lstrip("\n")


def _nothing(design: Design) -> str:
    return ""


def _tables(name: str, value: Any) -> Iterator[str]:
    """The fields that get a table of their own: laws, and lists of sheets."""
    if isinstance(value, OwnLaw):
        raise NotWritable(f"{name} is code: keep it in a .py file and name that in the design file")
    if isinstance(value, FrictionLaw):
        yield from ("", f"[{name}]", *_commented(f"law = {_quoted(name_of(type(value)))}", _first_line(value)))
        yield from _lines(value)
    elif _is_list_of_sheets(value):
        for item in value:
            yield from ("", f"[[{name}]]", *_lines(item, inline_laws=True))


def _lines(sheet: DataSheet, *, inline_laws: bool = False) -> Iterator[str]:
    """One commented line for each field that does not get a table of its own."""
    parameters, words = sheet.parameters(), sheet.choices()
    for field in dataclasses.fields(sheet):  # type: ignore[arg-type]
        value, about = getattr(sheet, field.name), parameters.get(field.name)
        if (isinstance(value, FrictionLaw) and not inline_laws) or _is_list_of_sheets(value):
            continue
        if value is None and field.default is None:
            if about:
                yield from _commented(f"# {field.name} =", _comment(about))
        elif about:
            _check_single(sheet, field.name, value)
            unit = unit_in(type(sheet), about, "")
            yield from _commented(f"{field.name} = {_text(value, unit, field.name)}", _comment(about))
        elif field.name in words:
            yield from _commented(f"{field.name} = {_quoted(value)}", _words(words[field.name]))
        elif field.name == "contacts" and value == ():
            yield "contacts = []"  # said, since a brake without any is taken for a forgotten one
        elif value not in ("", (), field.default):
            yield f"{field.name} = {_text(value, '', field.name)}"


def _commented(line: str, comment: str) -> Iterator[str]:
    """The line with its comment behind it, or above it where it would be too long."""
    if comment and len(line) + len(comment) + 4 > WIDTH:
        yield from textwrap.wrap(comment, WIDTH, initial_indent="# ", subsequent_indent="# ")
        yield line
    else:
        yield f"{line.ljust(COLUMN)}  # {comment}" if comment else line


def _comment(about: Parameter) -> str:
    unit = "" if about.schedule or not about.range.startswith("(-inf, inf)") else about.unit.replace("-", "")
    limits = "" if about.range.startswith("(-inf, inf)") else about.range
    return "; ".join(part for part in (about.meaning, limits or unit, about.source) if part)


def _words(about: Choice) -> str:
    return f"{about.meaning}: {', '.join(about.options)}"


def _text(value: Any, unit: str, name: str) -> str:
    """A value as TOML."""
    if value is None:
        return '"none"'
    if isinstance(value, bool):
        return str(value).lower()
    if isinstance(value, int):
        return str(value)
    if isinstance(value, str):
        return _quoted(value)
    if isinstance(value, Sum) and np.ndim(value.value(0.0)) == 1:
        return f"[{', '.join(_text(_row(value, i, name), unit, name) for i in range(len(value.value(0.0))))}]"
    if isinstance(value, Schedule):
        return f"{{ {_schedule_name(value, name)} = {_inline(value, unit)} }}"
    if isinstance(value, OwnLaw):
        raise NotWritable(f"{name} is code: keep it in a .py file and name that in the design file")
    if isinstance(value, FrictionLaw):
        return f"{{ law = {_quoted(name_of(type(value)))}, {_inline(value, '')[2:]}"
    if isinstance(value, (tuple, list, np.ndarray)):
        return f"[{', '.join(_text(item, '' if isinstance(value, np.ndarray) else unit, name) for item in value)}]"
    return _number(float(value), unit)


def _row(value: Sum, index: int, name: str) -> Any:
    """One component of a vector of schedules: a number, or the schedule that stands there alone."""
    terms = [(float(weight[index]), part) for weight, part in value.terms() if weight[index]]
    if all(isinstance(part, Constant) for _, part in terms):
        return sum(weight * float(part.value(0.0)) for weight, part in terms)
    if len(terms) != 1 or terms[0][0] != 1.0:
        raise NotWritable(f"{name}[{index}] is a sum of schedules: a file holds one of {', '.join(SCHEDULE_NAMES)}")
    return terms[0][1]


def _inline(sheet: DataSheet, unit: str) -> str:
    parameters = sheet.parameters()
    parts = []
    for field in dataclasses.fields(sheet):  # type: ignore[arg-type]
        value = getattr(sheet, field.name)
        if not (value is None and field.default is None):
            _check_single(sheet, field.name, value)
            own = unit_in(type(sheet), parameters[field.name], unit)
            parts.append(f"{field.name} = {_text(value, own, field.name)}")
    return f"{{ {', '.join(parts)} }}"


def _check_single(sheet: DataSheet, name: str, value: Any) -> None:
    """Only a field declared as an array may hold one; elsewhere an array is a map of many brakes."""
    declared = field_type(type(sheet), name)
    several = typing.get_origin(declared) is typing.Annotated or (
        declared is Any and not sheet.parameters()[name].schedule
    )
    if np.ndim(value) > 0 and not several:
        raise NotWritable(f"{name} has the shape {np.shape(value)}: a file holds one brake, not a map of them")


def _schedule_name(schedule: Schedule, name: str) -> str:
    if type(schedule) not in SCHEDULE_NAMES.values():
        raise NotWritable(f"{name} is a {type(schedule).__name__}: a file holds {', '.join(SCHEDULE_NAMES)}")
    return name_of(type(schedule))


def _number(value: float, unit: str) -> str:
    """The shortest of the ways to write a number with its unit that read back to the same bits."""
    if unit in ("", "-"):
        return repr(value)
    texts = [f"{_short(value)} {unit}"]
    for other in FRIENDLY.get(unit, ()):
        guess = f"{value / in_si(f'1 {other}', unit):.15g} {other}"
        if in_si(guess, unit) == value:
            texts.append(guess)
    return _quoted(min(texts, key=len))


def _short(value: float) -> str:
    text = repr(value)
    return text[:-2] if text.endswith(".0") else text


def _quoted(text: str) -> str:
    return json.dumps(text).replace("\x7f", "\\u007f")


def _first_line(sheet: DataSheet) -> str:
    return (type(sheet).__doc__ or "").strip().partition("\n")[0]


def _is_list_of_sheets(value: Any) -> bool:
    return isinstance(value, tuple) and bool(value) and all(isinstance(item, DataSheet) for item in value)
