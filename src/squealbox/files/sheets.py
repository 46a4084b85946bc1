"""From the tables of a file to data sheets: laws, schedules, designs and settings.

Nothing here knows a parameter by name. What a key may hold comes from the sheet's own declarations: a number with the
declared unit and range, a schedule where the declaration allows one, a friction law, a word, a list of names.
"""

import dataclasses
import re
import typing
from collections.abc import Mapping, Sequence
from typing import Any, TypeVar

import numpy as np

from squealbox.files.arrays import ArrayFileError, path_beside, read_array
from squealbox.files.document import Document, read_bytes
from squealbox.files.lines import Key, dotted
from squealbox.files.numbers import LONGEST, WRONG, read_choice, read_number, shown, wrong
from squealbox.friction import LAW_NAMES, OwnLaw, own_law
from squealbox.law import FrictionLaw
from squealbox.parameters import DataSheet, Parameter, ParameterError, field_type, known_names
from squealbox.schedules import SCHEDULE_NAMES, Schedule, Sum, as_schedule

Sheet = TypeVar("Sheet", bound=DataSheet)

OWN = "own"  # the law that is a Python file


def read_sheet(
    document: Document,
    sheet: type[Sheet],
    table: Mapping[str, Any],
    key: Key,
    *,
    unit: str = "",
    beside: tuple[str, ...] = (),
) -> Sheet | None:
    """The data sheet that `table` describes; None when something was wrong, which the document then holds.

    `unit` is that of the quantity a schedule stands for; a sheet with units of its own does not need it. `beside` are
    keys that stand in the same table and are read by someone else.
    """
    before = len(document.problems)
    multiplied = getattr(sheet, "unit_for", None)
    unit = multiplied(table) if multiplied else unit
    values: dict[str, Any] = {}
    for given, value in sheet.spelled(table).items():
        now = sheet.formerly.get(given, given)
        if now != given:
            document.cautions.append(f"{dotted((*key, given))} is called {now} now")
        names = sheet.aliases.get(now, (now,))
        if names[0] not in sheet.field_names():
            known = known_names(given[:LONGEST], [*sheet.field_names(), *sheet.aliases, *beside])
            document.problem((*key, given), f"unknown key, {known}")
            continue
        read = read_field(document, sheet, names[0], value, (*key, given), unit)
        for name in names:
            if name in values:
                document.problem((*key, given), f"sets {name}, which the file sets elsewhere too: give one of the two")
            values[name] = read
    _report_missing(document, sheet, values, key)
    return make(document, sheet, values, key) if len(document.problems) == before else None


def make(document: Document, sheet: type[Sheet], values: Mapping[str, Any], key: Key) -> Sheet | None:
    """The sheet with these values; what the sheet itself finds wrong is reported under the key it names."""
    try:
        return sheet(**values)
    except ParameterError as error:
        document.problem((*key, *_path(error.name)), f"{shown(error.value)}: {error.expectation}")
        return None


def read_field(document: Document, sheet: type[DataSheet], name: str, value: Any, key: Key, unit: str = "") -> Any:
    """The value of one field of `sheet`, or `WRONG`."""
    about = sheet.parameters().get(name)
    declared = field_type(sheet, name)
    if typing.get_origin(declared) is typing.Annotated:
        if about is not None and about.schedule and (_is_schedule(value) or _holds_schedule(value)):
            return _scheduled(document, value, about, key)
        return read_array(document, value, about or Parameter("-"), key, declared.__metadata__[0])
    if declared is int and (not isinstance(value, int) or isinstance(value, bool)):
        return wrong(document, key, value, f"a whole number in {about.range}" if about else "a whole number")
    if about is not None:
        about = dataclasses.replace(about, unit=unit_in(sheet, about, unit))
        return read_parameter(document, value, about, key, several=declared is Any and not about.schedule)
    if isinstance(declared, type) and issubclass(declared, FrictionLaw):
        return read_law(document, value, key)
    if isinstance(declared, type) and issubclass(declared, DataSheet):
        return _table(document, declared, value, key)
    words = sheet.choices().get(name)
    if words is not None:
        return read_choice(document, value, {word: word for word in words.options}, key)
    if declared is str:
        return _word(document, value, key)
    if declared is bool:
        return value if isinstance(value, bool) else wrong(document, key, value, "true or false")
    if declared == tuple[str, ...]:
        return _words(document, value, key)
    if typing.get_origin(declared) in (tuple, Sequence) and issubclass(typing.get_args(declared)[0], DataSheet):
        return _sheets(document, typing.get_args(declared)[0], value, key)
    raise TypeError(f"{sheet.__name__}.{name}: a file cannot hold a {declared}")


def read_parameter(document: Document, value: Any, about: Parameter, key: Key, *, several: bool = False) -> Any:
    """A number in the unit and range of `about`, a schedule or (`several`) a list of numbers where that is allowed."""
    if value == "none" and about.optional:
        return None
    if isinstance(value, Mapping) and about.schedule:
        return _schedule(document, value, about, key)
    if isinstance(value, list) and several:
        numbers = [read_parameter(document, item, about, (*key, i)) for i, item in enumerate(value)]
        return WRONG if any(number is WRONG for number in numbers) else numbers
    return read_number(document, value, about, key)


def read_law(document: Document, value: Any, key: Key) -> Any:
    """A friction law from ``{ law = "linear_slope", static = 0.45, slope = "-0.05 s/m" }``."""
    example = "a table such as { law = 'coulomb', static = 0.4 }"
    if not isinstance(value, Mapping):
        return wrong(document, key, value, example)
    if "law" not in value:
        document.problem(key, f"the key 'law' is missing, expected {known_names('', [*LAW_NAMES, OWN])}")
        return WRONG
    if value["law"] == OWN:
        return read_own_law(document, value, key)
    law = read_choice(document, value["law"], {**LAW_NAMES, OWN: OwnLaw}, (*key, "law"))
    if law is WRONG:
        return WRONG
    rest = {name: item for name, item in value.items() if name != "law"}
    return read_sheet(document, law, rest, key) or WRONG


def read_own_law(document: Document, value: Mapping[str, Any], key: Key) -> Any:
    """A law from ``{ law = "own", file = "law.py", numbers = [0.4, 0.1] }``, where the reader may run code."""
    unknown = [name for name in value if name not in ("law", "file", "numbers", "static")]
    for name in unknown:
        document.problem((*key, name), f"unknown key, {known_names(name[:LONGEST], ['file', 'numbers', 'static'])}")
    file = value.get("file")
    if not isinstance(file, str) or not file.endswith(".py"):
        return wrong(document, (*key, "file"), file, "the name of a .py file beside this one, such as 'law.py'")
    if not document.allow_code:
        document.problem(
            (*key, "file"), f"{shown(file)} is code, which is run only with --allow-code (allow_code=True)"
        )
        return WRONG
    about = OwnLaw.parameters()["static"]
    numbers = read_array(document, value.get("numbers", []) or [0.0], Parameter("-"), (*key, "numbers"), 1)
    static = read_number(document, value["static"], about, (*key, "static")) if "static" in value else None
    if unknown or numbers is WRONG or static is WRONG:
        return WRONG
    try:
        text = read_bytes(path_beside(document.path, file), OwnLaw.LARGEST).decode("utf-8")
        return own_law(text, numbers=numbers if value.get("numbers") else (), static=static)
    except (ArrayFileError, ParameterError) as error:
        document.problem((*key, "file"), str(error))
    except (OSError, ValueError) as error:
        reason = getattr(error, "strerror", None) or error
        document.problem((*key, "file"), f"{shown(file)} cannot be read: {reason}")
    return WRONG


def _schedule(document: Document, value: Mapping[str, Any], about: Parameter, key: Key) -> Any:
    example = "a number or a schedule such as { ramp = { start = 0.2, slope = -4 } }"
    if len(value) != 1 or not isinstance(next(iter(value.values())), Mapping):
        return wrong(document, key, value, f"{example}, one of {', '.join(SCHEDULE_NAMES)}")
    (name, table), *_ = value.items()
    if name not in SCHEDULE_NAMES:
        document.problem((*key, name), f"unknown schedule, {known_names(name[:LONGEST], list(SCHEDULE_NAMES))}")
        return WRONG
    return read_sheet(document, SCHEDULE_NAMES[name], table, (*key, name), unit=about.unit) or WRONG


def _is_schedule(value: Any) -> bool:
    return isinstance(value, Mapping) and len(value) == 1 and isinstance(next(iter(value.values())), Mapping)


def _holds_schedule(value: Any) -> bool:
    return isinstance(value, list) and any(isinstance(item, Mapping) for item in value)


def _scheduled(document: Document, value: Any, about: Parameter, key: Key) -> Any:
    """A list of numbers and schedules as one schedule whose value is the vector of them."""
    if not isinstance(value, list):
        return _schedule(document, value, about, key)
    read = [read_parameter(document, item, about, (*key, i)) for i, item in enumerate(value)]
    if any(item is WRONG for item in read):
        return WRONG
    rows = np.eye(len(read))
    return Sum(tuple((row, as_schedule(item)) for row, item in zip(rows, read, strict=True)))


def unit_in(sheet: type[DataSheet], about: Parameter, unit: str) -> str:
    """The unit a field of `sheet` has in a file.

    In a distribution a declared unit of nothing is that of the parameter that scatters, in a part of matrices that of
    what it multiplies. In a schedule it is that of the
    quantity it stands for, and ``/s`` is that per second.
    """
    from squealbox.distributions import Distribution

    if issubclass(sheet, Distribution) or hasattr(sheet, "unit_for"):
        return about.unit or unit
    if not issubclass(sheet, Schedule):
        return about.unit
    if about.unit == "/s":
        return "1/s" if unit in ("", "-") else f"{unit}^2" if unit.endswith("/s") else f"{unit}/s"
    return about.unit or unit


def is_required(field: dataclasses.Field[Any]) -> bool:
    """True for a field that has no default."""
    return field.default is dataclasses.MISSING and field.default_factory is dataclasses.MISSING


def _report_missing(document: Document, sheet: type[DataSheet], values: Mapping[str, Any], key: Key) -> None:
    parameters = sheet.parameters()
    for field in dataclasses.fields(sheet):  # type: ignore[arg-type]
        if is_required(field) and field.name not in values:
            about = parameters.get(field.name)
            what = f" ({about.meaning}), expected a number in {about.range}" if about else ""
            given = next((alias for alias, names in sheet.aliases.items() if names == (field.name,)), field.name)
            document.problem(key, f"the key '{given}' is missing{what}")


def _path(name: str) -> Key:
    """The key behind a name such as ``contacts[0].n``."""
    return tuple(int(part) if part.isdigit() else part for part in re.findall(r"\w+", name))


def _sheets(document: Document, sheet: type[DataSheet], value: Any, key: Key) -> Any:
    if not isinstance(value, list) or not all(isinstance(item, Mapping) for item in value):
        return wrong(document, key, value, f"tables, each under a line [[{key[-1]}]]")
    read = [read_sheet(document, sheet, item, (*key, i)) for i, item in enumerate(value)]
    return WRONG if any(item is None for item in read) else tuple(read)


def _table(document: Document, sheet: type[DataSheet], value: Any, key: Key) -> Any:
    if not isinstance(value, Mapping):
        return wrong(document, key, value, f"a section [{'.'.join(str(part) for part in key)}]")
    return read_sheet(document, sheet, value, key) or WRONG


def _word(document: Document, value: Any, key: Key) -> Any:
    return value if isinstance(value, str) else wrong(document, key, value, "a word in quotes")


def _words(document: Document, value: Any, key: Key) -> Any:
    if isinstance(value, list) and all(isinstance(item, str) for item in value):
        return tuple(value)
    return wrong(document, key, value, "a list of names in quotes")
