"""A number on a data sheet: its unit, the range it may take, and what it means.

Laws, schedules and designs are frozen data sheets. Each field made with :func:`parameter` is checked when the sheet is
made, and the same declaration feeds the file reader, the tables of the documentation and the sliders of a page.
A field may hold an array with leading axes, so one sheet can stand for a whole map.
"""

import dataclasses
import difflib
import importlib
import math
import re
from collections.abc import Iterator, Mapping
from types import FunctionType
from typing import Any, ClassVar, Self, dataclass_transform

import numpy as np

MOST_ENTRIES = 16  # of an array that is printed in full


@dataclasses.dataclass(frozen=True)
class Parameter:
    """What is known of one field of a data sheet: unit, range, meaning and source."""

    unit: str
    low: float = -math.inf
    high: float = math.inf
    low_open: bool = False
    high_open: bool = False
    meaning: str = ""
    source: str = ""
    optional: bool = False
    schedule: bool = False

    @property
    def range(self) -> str:
        """The range in interval notation with its unit, such as ``(0, inf) kg``."""
        left = "(" if self.low_open or math.isinf(self.low) else "["
        right = ")" if self.high_open or math.isinf(self.high) else "]"
        unit = "" if self.unit in ("", "-") else f" {self.unit}"
        return f"{left}{self.low:g}, {self.high:g}{right}{unit}"

    @property
    def expected(self) -> str:
        """What a value must be, as the end of a sentence."""
        return f"a finite number in {self.range}"

    def accepts(self, value: np.ndarray) -> bool:
        """True when every entry of `value` is finite and inside the range."""
        above = value > self.low if self.low_open else value >= self.low
        below = value < self.high if self.high_open else value <= self.high
        return bool(np.all(np.isfinite(value) & above & below))


class ParameterError(ValueError):
    """A parameter is unknown, not a finite number, or outside its range.

    The attributes carry the evidence: `owner` (class name), `name`, `value`, and `expected` (the range with its unit).
    """

    def __init__(self, owner: str, name: str, value: object, expected: str) -> None:
        self.owner, self.name, self.value, self.expected = owner, name, value, expected
        given = "" if expected.startswith("did you mean") and np.ndim(value) else f" = {_shown(value)}"  # type: ignore[arg-type]
        super().__init__(f"{owner}.{name}{given}: {self.expectation}")

    @property
    def expectation(self) -> str:
        """What was expected, as the end of a sentence."""
        return self.expected if self.expected.startswith("did you mean") else f"expected {self.expected}"


def parameter(
    unit: str,
    low: float = -math.inf,
    high: float = math.inf,
    *,
    default: Any = dataclasses.MISSING,
    default_factory: Any = dataclasses.MISSING,
    low_open: bool = False,
    high_open: bool = False,
    meaning: str = "",
    source: str = "",
    optional: bool = False,
    schedule: bool = False,
) -> Any:
    """Declare a field of a data sheet: unit, range, default, meaning, source; may it be None, or a schedule?"""
    about = Parameter(unit, low, high, low_open, high_open, meaning, source, optional, schedule)
    if default_factory is not dataclasses.MISSING:
        return dataclasses.field(default_factory=default_factory, metadata={"parameter": about})
    return dataclasses.field(default=default, metadata={"parameter": about})


@dataclasses.dataclass(frozen=True)
class Choice:
    """What is known of a field that holds one of several words."""

    options: tuple[str, ...]
    meaning: str = ""


def choice(*options: str, default: Any = dataclasses.MISSING, meaning: str = "") -> Any:
    """Declare a field that holds one of the words `options`."""
    return dataclasses.field(default=default, metadata={"choice": Choice(options, meaning)})


_SHEETS: dict[str, type["DataSheet"]] = {}


@dataclass_transform(frozen_default=True, eq_default=False, field_specifiers=(parameter, choice, dataclasses.field))
class DataSheet:
    """Base of every frozen noun with parameters: laws, schedules and designs.

    Subclasses are written as classes with annotated fields; they become frozen dataclasses by being subclasses.
    `aliases` maps a short name to the fields it sets together, e.g. ``{"load": ("load1", "load2")}``.
    """

    aliases: ClassVar[Mapping[str, tuple[str, ...]]] = {}

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
        _SHEETS[cls.kind()] = cls

    def __post_init__(self) -> None:
        for field in dataclasses.fields(self):  # type: ignore[arg-type]
            about = field.metadata.get("parameter")
            if about is not None:
                object.__setattr__(self, field.name, _checked(self, field.name, about))
        for name, words in self.choices().items():
            value = getattr(self, name)
            if value not in words.options:
                raise ParameterError(type(self).__name__, name, value, known_names(str(value), list(words.options)))

    def __repr__(self) -> str:
        fields = ", ".join(f"{name}={_brief(getattr(self, name))}" for name in self.field_names())
        return f"{type(self).__name__}({fields})"

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

        Raises `ParameterError` for a name the sheet does not have (with the nearest one) or a value out of range.
        """
        flat: dict[str, Any] = {}
        nested: dict[str, dict[str, Any]] = {}
        for path, value in {**(changes or {}), **keywords}.items():
            head, _, rest = path.partition(".")
            for name in self.aliases.get(head, (head,)):
                self._check_known(path, head, name, value)
                if rest:
                    nested.setdefault(name, {})[rest] = value
                else:
                    flat[name] = value
        for name, inner in nested.items():
            part = flat.get(name, getattr(self, name))
            if not isinstance(part, DataSheet):
                raise ParameterError(type(self).__name__, name, part, f"a data sheet, to set {sorted(inner)} in it")
            flat[name] = part.replace(inner)
        return dataclasses.replace(self, **flat)  # type: ignore[type-var]

    def value_of(self, path: str) -> Any:
        """The value behind a dotted name; an alias gives the value of its first field."""
        head, _, rest = path.partition(".")
        name = self.aliases.get(head, (head,))[0]
        self._check_known(path, head, name, None)
        value = getattr(self, name)
        if rest and not isinstance(value, DataSheet):
            raise ParameterError(type(self).__name__, path, None, f"a name without a part: {name} holds no parameters")
        return value.value_of(rest) if rest else value

    def _check_known(self, path: str, head: str, name: str, value: Any) -> None:
        names = self.field_names()
        if name not in names:
            raise ParameterError(type(self).__name__, path, value, known_names(head, [*names, *self.aliases]))

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
        """Every declared parameter with its dotted name and value, nested sheets included."""
        about = self.parameters()
        for name in self.field_names():
            value = getattr(self, name)
            if isinstance(value, DataSheet):
                yield from value.leaves(f"{prefix}{name}.")
            elif name in about:
                yield prefix + name, about[name], value


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


def load_kind(kind: str) -> None:
    """Load the module of this package that defines `kind`; a name of no such module is left for the caller to refuse.

    A file names a class by its place in the package, and its module may not have been needed yet. Nothing outside the
    package is ever loaded.
    """
    if re.fullmatch(r"[a-z_]+(\.[a-z0-9_]+)*\.[A-Za-z0-9]+", kind):
        module = f"squealbox.{kind.rpartition('.')[0]}"
        try:
            importlib.import_module(module)
        except ModuleNotFoundError as error:
            if not module.startswith(str(error.name)):
                raise  # a module of the package that lacks one of its own dependencies


def _sheet_class(kind: object) -> type[DataSheet]:
    name = kind if isinstance(kind, str) else ""
    if name not in _SHEETS:
        load_kind(name)
    if name not in _SHEETS:
        raise ParameterError("file", "kind", kind, known_names(name, sorted(_SHEETS)))
    return _SHEETS[name]


def known_names(given: str, names: list[str]) -> str:
    """A phrase for an error: the nearest known name, and all of them."""
    near = difflib.get_close_matches(given, names, n=1)
    hint = f"did you mean {near[0]!r}? " if near else ""
    return f"{hint}one of {', '.join(names)}"


def _checked(sheet: DataSheet, name: str, about: Parameter) -> Any:
    value = getattr(sheet, name)
    owner = type(sheet).__name__
    if isinstance(value, DataSheet) and about.schedule:
        return value
    if value is None and about.optional:
        return None
    expected = about.expected
    if isinstance(value, (bool, np.bool_, str)) or value is None:
        raise ParameterError(owner, name, value, expected)
    try:
        number = np.asarray(value, dtype=float)
    except (TypeError, ValueError) as error:
        raise ParameterError(owner, name, value, expected) from error
    if not about.accepts(number):
        raise ParameterError(owner, name, value, expected)
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
    if isinstance(a, tuple) and isinstance(b, tuple):
        return len(a) == len(b) and all(_same(x, y) for x, y in zip(a, b, strict=True))
    return bool(a == b)


def _hashable(value: Any) -> Any:
    if hasattr(value, "tocoo"):
        entries = value.tocoo()
        return value.shape, float(np.sum(entries.data)), float(np.sum(entries.data * (entries.coords[0] + 1.0)))
    if isinstance(value, np.ndarray):
        return value.shape, value.tobytes()
    return tuple(_hashable(item) for item in value) if isinstance(value, tuple) else value


def _brief(value: object) -> str:
    """As `repr`, but what is long is told by its size: a print of a system of a thousand contacts is a line."""
    if isinstance(value, np.ndarray) and value.size > MOST_ENTRIES:
        return f"<{' x '.join(map(str, value.shape))} numbers>"
    if isinstance(value, tuple) and len(value) > MOST_ENTRIES // 2:
        return f"<{len(value)} of {type(value[0]).__name__}>"
    return repr(value)


def _shown(value: object) -> str:
    if isinstance(value, type):
        return f"the class {value.__name__}"
    text = repr(value) if not isinstance(value, (float, int)) else f"{value:g}"
    return text if len(text) <= 60 else text[:57] + "..."
