"""A number on a data sheet: its unit, the range it may take, and what it means.

Laws, schedules and designs are frozen data sheets. Each field made with :func:`parameter` is checked when the sheet is
made, and the same declaration feeds the file reader, the tables of the documentation and the sliders of a page.
A field may hold an array with leading axes, so one sheet can stand for a whole map.
"""

import dataclasses
import importlib
import math
import re
from collections.abc import Iterator, Mapping
from types import FunctionType
from typing import Any, ClassVar, Self, dataclass_transform

import numpy as np

from squealbox.declarations import (  # what stands here is known by this room's name, too
    UNSAID,
    Choice,
    Matrix,
    Missing,
    Parameter,
    ParameterError,
    Vector,
    above_zero,
    choice,
    field_type,
    finish,
    free,
    known_names,
    parameter,
    screenful,
    shown,
    with_cautions,
)  # fmt: skip
from squealbox.registers import load_kind

__all__ = [
    "Choice", "DataSheet", "Matrix", "Missing", "Parameter", "ParameterError", "Vector", "above_zero", "choice",
    "field_type", "free", "from_plain", "known_names", "load_kind", "members", "parameter", "screenful", "shown",
    "to_plain", "with_cautions",
]  # fmt: skip
DRAWN_BY = "squealbox.plots"  # by name, when asked: a sheet may know that it can be drawn, but not by whom
MOST_ENTRIES = 16  # of an array that is printed in full
_SHEETS: dict[str, type["DataSheet"]] = {}


@dataclass_transform(
    frozen_default=True, eq_default=False, field_specifiers=(parameter, above_zero, choice, free, dataclasses.field)
)
class DataSheet:
    """Base of every frozen noun with parameters: laws, schedules and designs.

    Subclasses are written as classes with annotated fields; they become frozen dataclasses by being subclasses.
    `aliases` maps a short name to the fields it sets together, e.g. ``{"load": ("load1", "load2")}``.
    """

    aliases: ClassVar[Mapping[str, tuple[str, ...]]] = {}
    shared: ClassVar[Mapping[str, tuple[str, str]]] = {}
    """A name for a field of all sheets in another field, such as ``{"sliding_speed": ("contacts", "V")}``."""
    formerly: ClassVar[Mapping[str, str]] = {}
    """The field of today behind a name that files of former versions hold."""
    told: ClassVar[Mapping[str, tuple[str, str]]] = {}
    """Unit and meaning of fields that are no declared parameters, for `summary`."""
    counted_from: ClassVar[int] = 1
    """The number of the first of several in a field."""

    def __new__(cls, *_: Any, **given: Any) -> Self:
        """A sheet not yet filled; a name it does not have is refused with the nearest one."""
        names = cls.field_names()
        for name in given:
            if name in cls.aliases:
                parts = ", ".join(cls.aliases[name])
                raise ParameterError(cls.__name__, name, given[name], f"{parts}; replace({name}=...) sets them at once")
            if name not in names:
                raise ParameterError(cls.__name__, name, given[name], known_names(name, names))
        return super().__new__(cls)

    def __init_subclass__(cls, **keywords: Any) -> None:
        super().__init_subclass__(**keywords)
        if "__repr__" not in cls.__dict__:
            cls.__repr__ = DataSheet.__repr__  # type: ignore[method-assign]  # a dataclass would print every array
        dataclasses.dataclass(frozen=True, eq=False)(cls)
        finish(cls)
        _SHEETS[cls.kind()] = cls

    def __post_init__(self) -> None:
        for name, about in self.parameters().items():
            object.__setattr__(self, name, _checked(self, name, about))
        for name, words in self.choices().items():
            value = getattr(self, name)
            if value not in words.options:
                raise ParameterError(type(self).__name__, name, value, known_names(str(value), list(words.options)))

    def __repr__(self) -> str:
        fields = ", ".join(f"{name}={_brief(getattr(self, name))}" for name in self.field_names())
        return screenful(f"{type(self).__name__}({fields})")

    def summary(self) -> str:
        """At most a screenful: each field with its value, unit and meaning, the sheets it holds indented.

        >>> from squealbox import Coulomb
        >>> print(Coulomb(0.3).summary())
        Coulomb
          static         0.3                          static limit; kinetic when that is left out
          kinetic        None                         coefficient while sliding
        """
        return screenful("\n".join([type(self).__name__, *_told(self)]))

    def _repr_html_(self) -> str:
        """What a notebook shows: a drawing where there is one, and the fields with value, unit, range and meaning."""
        return str(importlib.import_module(DRAWN_BY).card(self))

    def __eq__(self, other: object) -> bool:
        if type(self) is not type(other):
            return NotImplemented
        return all(_same(a, b) for a, b in zip(_values(self), _values(other), strict=True))

    def __hash__(self) -> int:
        kept: int | None = self.__dict__.get("_hash")
        if kept is None:
            kept = hash((type(self), *(_hashable(value) for value in _values(self))))
            object.__setattr__(self, "_hash", kept)
        return kept

    def replace(self, changes: Mapping[str, Any] | None = None, **keywords: Any) -> Self:
        """A copy with other values; dotted names reach into nested sheets: ``{"friction.static": 0.4}``.

        Of several sheets in one field each has its own name, or its number: ``springs.1.stiffness``, ``bodies.a.mass``.
        Raises `ParameterError` for a name the sheet does not have (with the nearest one) or a value out of range.
        """
        flat: dict[str, Any] = {}
        nested: dict[str, dict[str, Any]] = {}
        for path, value in {**(changes or {}), **keywords}.items():
            for full in self._paths(path):
                name, _, rest = full.partition(".")
                self._check_known(path, str(path).partition(".")[0], name, value)
                if rest:
                    nested.setdefault(name, {})[rest] = value
                else:
                    flat[name] = self._whole(name, value)
        for name, inner in nested.items():
            part = flat.get(name, getattr(self, name))
            if not (isinstance(part, DataSheet) or members(part)):
                raise ParameterError(type(self).__name__, name, part, f"a data sheet, to set {sorted(inner)} in it")
            flat[name] = part.replace(inner) if isinstance(part, DataSheet) else self._with_members(name, part, inner)
        return dataclasses.replace(self, **flat)  # type: ignore[type-var]

    def _whole(self, name: str, value: Any) -> Any:
        """The value for a field; numbers do not stand for a whole law, whose own numbers have names."""
        held = getattr(self, name)
        if hasattr(held, "mu") and np.asarray(value).dtype.kind in "iuf":
            inner = ", ".join(f"{name}.{each}" for each in held.parameters())
            raise ParameterError(type(self).__name__, name, value, f"a friction law, or a number of it, {inner}")
        return value

    def value_of(self, path: str) -> Any:
        """The value behind a dotted name; an alias gives the value of its first field."""
        name, _, rest = self._paths(path)[0].partition(".")
        self._check_known(path, str(path).partition(".")[0], name, UNSAID)
        value = getattr(self, name)
        if rest and members(value):
            key, _, rest = rest.partition(".")
            value = value[self._place(name, value, key)]
        if rest and not isinstance(value, DataSheet):
            raise ParameterError(type(self).__name__, path, UNSAID, f"a name without a part: {name} has no parameters")
        return value.value_of(rest) if rest else value

    def usual(self, path: str) -> Any:
        """The value that the class gives to what is behind a dotted name; the present one where that is no number."""
        name, _, rest = self._paths(path)[0].partition(".")
        value, usual = getattr(self, name, None), getattr(type(self), name, None)
        if rest and isinstance(value, DataSheet):
            return value.usual(rest)
        return usual if isinstance(usual, (int, float)) else self.value_of(path)

    def unit_of(self, path: str) -> str:
        """Unit of a dotted parameter or of an alias; empty for a pure number and for what has none."""
        names = (path, *self._paths(path))
        unit = next((about.unit for name, about, _ in self.leaves() if name in names), "") or self._declared(names[1])
        return "" if unit == "-" else unit

    def _declared(self, path: str) -> str:
        """The unit of a field that is no leaf, such as what all members share; empty where nothing declares it."""
        name, _, rest = path.partition(".")
        value = getattr(self, name, None)
        if rest and members(value):
            key, _, rest = rest.partition(".")
            value = value[self._place(name, value, key)]  # type: ignore[index]
        if rest:
            return value.unit_of(rest) if isinstance(value, DataSheet) else ""
        return self.parameters()[name].unit if name in self.parameters() else self.told.get(name, ("",))[0]

    def _paths(self, path: str) -> tuple[str, ...]:
        """The fields that a dotted name stands for: its own, or those of an alias or of what all members share."""
        head, dot, rest = str(path).partition(".")
        if head in self.shared:
            several, field = self.shared[head]
            return tuple(f"{several}.{i + 1}.{field}{dot}{rest}" for i in range(len(getattr(self, several)))) or (path,)
        return tuple(f"{name}{dot}{rest}" for name in self.aliases.get(head, (head,)))

    def _with_members(self, name: str, sheets: Any, changes: Mapping[str, Any]) -> tuple[Any, ...]:
        """The sheets of one field with changes by ``number.parameter`` or ``name.parameter``."""
        each: dict[int, dict[str, Any]] = {}
        for path, value in changes.items():
            key, _, rest = path.partition(".")
            each.setdefault(self._place(name, sheets, key), {})[rest] = value
        return tuple(sheet.replace(each[i]) if i in each else sheet for i, sheet in enumerate(sheets))

    def _place(self, name: str, sheets: Any, key: str) -> int:
        known, first = members(sheets), sheets[0].counted_from
        if key.isdigit() and first <= int(key) < first + len(known):
            return int(key) - first
        if key not in known:
            raise ParameterError(type(self).__name__, f"{name}.{key}", UNSAID, known_names(key, list(known)))
        return known.index(key)

    def _check_known(self, path: str, head: str, name: str, value: object) -> None:
        if name not in self.field_names():
            raise ParameterError(type(self).__name__, path, value, known_names(head, self._known()))

    def _known(self) -> list[str]:
        return [*self.field_names(), *self.aliases, *self.shared]

    @staticmethod
    def spelled(given: Mapping[str, Any]) -> Mapping[str, Any]:
        """What a file or the command line says of the fields, where these have further spellings."""
        return given

    @classmethod
    def kind(cls) -> str:
        """The name a file knows this class by, its place in the package: ``friction.LinearSlope``."""
        return f"{cls.__module__.removeprefix('squealbox.')}.{cls.__name__}"

    @classmethod
    def field_names(cls) -> list[str]:
        """The names of the fields, in order."""
        return [field.name for field in dataclasses.fields(cls)]  # type: ignore[arg-type]

    @classmethod
    def parameters(cls) -> dict[str, Parameter]:
        """Name to :class:`Parameter` for each declared field of this sheet, in order."""
        fields = dataclasses.fields(cls)  # type: ignore[arg-type]
        return {field.name: field.metadata["parameter"] for field in fields if "parameter" in field.metadata}

    @classmethod
    def choices(cls) -> dict[str, Choice]:
        """Name to :class:`Choice` for each field that holds one of several words."""
        fields = dataclasses.fields(cls)  # type: ignore[arg-type]
        return {field.name: field.metadata["choice"] for field in fields if "choice" in field.metadata}

    def leaves(self, prefix: str = "") -> Iterator[tuple[str, Parameter, Any]]:
        """Every declared parameter with its dotted name and value, nested sheets included.

        Of several sheets in one field what is at its default is left out: nobody asked for the gap of a soft contact.
        """
        about = self.parameters()
        for name in self.field_names():
            value = getattr(self, name)
            if isinstance(value, DataSheet):
                yield from value.leaves(f"{prefix}{name}.")
            elif name in about:
                yield prefix + name, about[name], value
            for key, sheet in zip(members(value), value if members(value) else (), strict=True):
                usual = {field.name: field.default for field in dataclasses.fields(sheet)}
                inner = sheet.leaves(f"{prefix}{name}.{key}.")
                yield from (leaf for leaf in inner if not _same(leaf[2], usual.get(leaf[0].rpartition(".")[2])))


def members(value: object) -> list[str]:
    """What each of several sheets in a field is called: its name where no other has it, else its number."""
    if not (isinstance(value, tuple) and value and all(isinstance(each, DataSheet) for each in value)):
        return []
    names = [str(getattr(each, "name", "")) for each in value]
    plain = [bool(re.fullmatch(r"[^\W\d][^.=]*", name)) and names.count(name) == 1 for name in names]
    numbers = range(value[0].counted_from, value[0].counted_from + len(value))
    return [name if good else str(i) for i, name, good in zip(numbers, names, plain, strict=True)]


def to_plain(value: Any) -> Any:
    """`value` as lists, numbers, strings and dictionaries; a data sheet becomes a dictionary with its ``kind``.

    A function of the user's cannot be kept: its name stands for it.
    """
    if isinstance(value, DataSheet):
        return {"kind": value.kind(), **{name: to_plain(getattr(value, name)) for name in value.field_names()}}
    if isinstance(value, Mapping):
        return {str(key): to_plain(item) for key, item in value.items()}
    if isinstance(value, (tuple, list)):
        return [to_plain(item) for item in value]
    if isinstance(value, (np.ndarray, np.generic)):
        return value.tolist()
    if isinstance(value, FunctionType):
        return f"function {value.__qualname__}, not kept"
    return None if getattr(value, "left_out_of_files", False) else value


def from_plain(value: Any) -> Any:
    """The inverse of :func:`to_plain`. Only classes of this package are made; an unknown kind is a `ParameterError`."""
    if isinstance(value, Mapping):
        items = {key: from_plain(item) for key, item in value.items() if key != "kind"}
        if "kind" not in value:
            return items
        return _sheet_class(value["kind"])(**items)
    return [from_plain(item) for item in value] if isinstance(value, list) else value


def _sheet_class(kind: object) -> type[DataSheet]:
    name = kind if isinstance(kind, str) else ""
    found = _SHEETS.get(name) or load_kind(name)
    if found not in _SHEETS.values():  # which may have another place today
        raise ParameterError("file", "kind", kind, known_names(name, sorted(_SHEETS)))
    return found


def _checked(sheet: DataSheet, name: str, about: Parameter) -> Any:
    value = getattr(sheet, name)
    owner = type(sheet).__name__
    if type(value) is float and about.low < value < about.high and not about.ends:  # most of them, without an array
        return value
    if (isinstance(value, DataSheet) and about.schedule) or (value is None and about.optional):
        return value
    try:
        number = np.asarray(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise ParameterError(owner, name, value, about.expected) from error
    if isinstance(value, (bool, np.bool_, str)) or value is None or not about.allows(number):
        raise ParameterError(owner, name, value, about.expected)
    if number.ndim == 0:
        return float(number)
    number = number.copy()
    number.flags.writeable = False
    return number


def _values(sheet: DataSheet) -> list[Any]:
    return [getattr(sheet, name) for name in sheet.field_names()]


def _same(a: Any, b: Any) -> bool:
    if hasattr(a, "tocoo") or hasattr(b, "tocoo"):  # sparse matrices
        return a is b or (type(a) is type(b) and a.shape == b.shape and (a != b).nnz == 0)
    if isinstance(a, np.ndarray) or isinstance(b, np.ndarray):
        return np.array_equal(a, b)
    if isinstance(a, (tuple, list, dict)) and isinstance(b, type(a)):
        ours, theirs = (each.items() if isinstance(each, dict) else each for each in (a, b))
        return len(a) == len(b) and all(map(_same, ours, theirs))
    return bool(a == b)


def _hashable(value: Any) -> Any:
    if hasattr(value, "tocoo"):
        entries = value.tocoo()
        return value.shape, float(np.sum(entries.data)), float(np.sum(entries.data * (entries.coords[0] + 1.0)))
    if isinstance(value, (tuple, list, dict)):
        return tuple(_hashable(item) for item in (value.items() if isinstance(value, dict) else value))
    return (value.shape, value.tobytes()) if isinstance(value, np.ndarray) else value


def _told(sheet: DataSheet, indent: str = "  ", usual: Mapping[str, Any] | None = None) -> Iterator[str]:
    """The lines of a summary, short lists of sheets before long ones; of what is in a list, no value of `usual`."""
    declared, several, room = sheet.parameters(), [], max(14, *map(len, sheet.field_names()))
    for name in sheet.field_names():
        value, about = getattr(sheet, name), declared.get(name)
        unit, meaning = (about.unit, about.meaning) if about else sheet.told.get(name, ("", ""))
        if members(value):
            several.append([line for key, each in zip(members(value), value, strict=True) for line in [
                f"{indent}{name}.{key}: {type(each).__name__}",
                *_told(each, indent + "  ", {field.name: field.default for field in dataclasses.fields(each)}),
            ]])  # fmt: skip
        elif isinstance(value, DataSheet):
            yield f"{indent}{name}: {type(value).__name__}"
            yield from _told(value, indent + "  ")
        elif not ((value is None and about is None) or (isinstance(value, (str, tuple)) and not value)) and not (
            usual and name in usual and _same(value, usual[name])
        ):
            unit = "" if unit in ("", "-") or value is None else f" {unit}"
            unit += f" = {math.degrees(value):.6g} deg" if unit == " rad" and isinstance(value, float) else ""
            yield f"{indent}{name:<{room}s} {_compact(value) + unit:<28s} {meaning}".rstrip()
    for lines in sorted(several, key=len):
        yield from lines


def _compact(value: object) -> str:
    """A value in a line: a small array as it stands, a larger one by its shape."""
    if isinstance(value, np.ndarray) and value.size <= MOST_ENTRIES:
        text = np.array2string(value, precision=6, separator=", ", max_line_width=1000).replace("\n", "")
        return text if len(text) <= 60 else f"<{' x '.join(map(str, value.shape))} numbers>"
    return f"{value:.8g}" if isinstance(value, float) else _brief(value)


def _brief(value: object) -> str:
    """As `repr`, but what is long is told by its size: a print of a system of a thousand contacts is a line."""
    if isinstance(value, np.ndarray) and value.size > MOST_ENTRIES:
        return f"<{' x '.join(map(str, value.shape))} numbers>"
    if isinstance(value, tuple) and len(value) > (1 if members(value) else MOST_ENTRIES // 2):
        return f"<{len(value)} of {type(value[0]).__name__}>"
    return str(value.tolist()) if isinstance(value, np.ndarray) else repr(value)
