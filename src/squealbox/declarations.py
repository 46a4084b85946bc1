"""What is declared of the fields of data sheets: unit, range, meaning and source, and the error for a value beyond."""

import dataclasses
import difflib
import functools
import math
import textwrap
import types
import typing
from collections.abc import Callable, Iterable
from typing import Annotated, Any

import numpy as np


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
    ends: bool = False

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
        return f"two numbers in {self.range}, the lower first" if self.ends else f"a finite number in {self.range}"

    def accepts(self, value: np.ndarray) -> bool:
        """True when every entry of `value` is finite and inside the range."""
        return bool(np.all(np.isfinite(value) & self.contains(value)))

    def allows(self, value: np.ndarray) -> bool:
        """True when a field may hold `value`: every entry is accepted, and of two ends the lower comes first."""
        return self.accepts(value) and (not self.ends or (value.shape == (2,) and bool(value[0] < value[1])))

    def contains(self, value: float | np.ndarray) -> Any:
        """Where a number, or each of an array, is inside the range."""
        above = value > self.low if self.low_open else value >= self.low
        return above & (value < self.high if self.high_open else value <= self.high)


UNSAID = object()
"""Stands for the value in an error about a name that was asked for, for which none was given."""


class ParameterError(ValueError):
    """A parameter is unknown, not a finite number, or outside its range.

    The attributes carry the evidence: `owner` (class name), `name`, `value`, and `expected` (the range with its unit).
    """

    def __init__(self, owner: str, name: str, value: object, expected: str) -> None:
        self.owner, self.name, self.value, self.expected = owner, name, value, expected
        self.named = bool(owner)  # else an argument of the function that was asked, which says its own name
        unsaid = value is UNSAID or (expected.startswith("did you mean") and np.ndim(value) > 0)  # type: ignore[arg-type]
        given = "" if unsaid else f" = {shown(value)}"
        super().__init__(f"{owner}.{name}{given}: {self.expectation}")

    def of(self, owner: str) -> "ParameterError":
        """The same about an argument of the function of that name, which may be asked by another in turn."""
        found = ParameterError(owner, self.name, self.value, self.expected)
        found.named = False
        return found

    @property
    def expectation(self) -> str:
        """What was expected, as the end of a sentence; what looks like degrees is told in radians."""
        if self.expected.startswith("did you mean"):
            return self.expected
        angle = self.value if self.expected.endswith(" rad") and isinstance(self.value, (int, float)) else math.inf
        degrees = f"; {angle:g} deg are {math.radians(angle):.5g} rad" if 3.0 < abs(angle) <= 360.0 else ""
        return f"expected {self.expected}{degrees}"


class Missing(ParameterError, TypeError):
    """Something that must be given was not; a `TypeError`, too, as Python has it."""

    def __init__(self, owner: str, name: str, expected: str) -> None:
        super().__init__(owner, name, None, expected)
        self.args = (f"{owner}.{name} is missing{f': expected {expected}' if expected else ''}",)


def complete(made: Callable[..., Any]) -> Any:
    """The maker of a sheet that says what is missing with its unit, range and meaning."""

    @functools.wraps(made)
    def init(self: Any, *args: Any, **given: Any) -> None:
        try:
            made(self, *args, **given)
        except TypeError:
            fields = dataclasses.fields(self)
            must = [each for each in fields if each.default is each.default_factory is dataclasses.MISSING]
            names = [each.name for each in fields[: len(args)]]
            for each in must:
                if each.name not in given and each.name not in names:
                    about = each.metadata.get("parameter")
                    said = f"{about.expected} ({about.meaning})" if about else self.told.get(each.name, ("", ""))[1]
                    raise Missing(type(self).__name__, each.name, said) from None
            raise

    return init


def finish(sheet: Any) -> None:
    """What a new class of sheets has of its fields: the meanings `free` was told, and a maker that says what lacks."""
    said = {each.name: ("", each.metadata["said"]) for each in dataclasses.fields(sheet) if "said" in each.metadata}
    sheet.told = {**sheet.told, **said}
    if "__init__" in sheet.__dict__:
        sheet.__init__ = complete(sheet.__init__)


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
    """Declare a field of a data sheet: unit, range, default, meaning, source; may it be None, or a schedule?

    `low` [SI]: least value; `high` [SI]: largest value.
    """
    about = Parameter(unit, low, high, low_open, high_open, meaning, source, optional, schedule)
    if default_factory is not dataclasses.MISSING:
        return dataclasses.field(default_factory=default_factory, metadata={"parameter": about})
    return dataclasses.field(default=default, metadata={"parameter": about})


def above_zero(unit: str, *, default: None, meaning: str, ends: bool = False, source: str = "") -> Any:
    """Declare a field that holds a number above zero, or two with the lower first (`ends`), or None."""
    about = Parameter(unit, 0.0, low_open=True, meaning=meaning, source=source, optional=True, ends=ends)
    return dataclasses.field(default=default, metadata={"parameter": about})


def free(*, default: Any, meaning: str) -> Any:
    """Declare a field that holds any word, or yes or no."""
    return dataclasses.field(default=default, metadata={"said": meaning})


@dataclasses.dataclass(frozen=True)
class Choice:
    """What is known of a field that holds one of several words."""

    options: tuple[str, ...]
    meaning: str = ""


def choice(*options: str, default: Any = dataclasses.MISSING, meaning: str = "") -> Any:
    """Declare a field that holds one of the words `options`."""
    return dataclasses.field(default=default, metadata={"choice": Choice(options, meaning)})


Vector = Annotated[Any, 1]  # the type of a field that holds an array, which a file may hold beside itself
Matrix = Annotated[Any, 2]


@functools.cache
def _hints(sheet: type) -> dict[str, Any]:
    """Kept: reading them evaluates text, and every slider's move asks."""
    return typing.get_type_hints(sheet, include_extras=True)


def field_type(sheet: type, name: str) -> Any:
    """The type a field of a data sheet is annotated with, without a None that stands beside it."""
    declared = _hints(sheet)[name]
    if isinstance(declared, types.UnionType):
        parts = [part for part in typing.get_args(declared) if part is not types.NoneType]
        return parts[0] if len(parts) == 1 else Any
    return declared


def known_names(given: str, names: list[str]) -> str:
    """A phrase for an error: the nearest known name, and all of them."""
    near = difflib.get_close_matches(given, names, n=1)
    hint = f"did you mean {near[0]!r}? " if near else ""
    return f"{hint}one of {', '.join(names)}"


def screenful(text: str, lines: int = 30, width: int = 120) -> str:
    """What a terminal shows of a text: long lines go on below, and at most so many of them.

    >>> screenful("one two three", lines=2, width=9).splitlines()
    ['one two', '    three']
    """
    told = [part for line in text.splitlines() for part in _within(line, width)]
    more = [f"  ... and {len(told) + 1 - lines} more lines"] * (len(told) > lines)
    return "\n".join([*told[: lines - len(more)], *more])


def _within(line: str, width: int) -> list[str]:
    return textwrap.wrap(line, width, subsequent_indent="    ", break_on_hyphens=False) if len(line) > width else [line]


def with_cautions(lines: Iterable[str], *cautions: str) -> str:
    """The lines of a summary, then a line for each thing to know before it is used."""
    return "\n".join([*lines, *(f"Caution: {caution}" for caution in cautions if caution)])


def shown(value: object) -> str:
    """A value as an error says it: in 60 letters, a class or a whole table by its name."""
    if isinstance(value, type):
        return f"the class {value.__name__}"
    text = repr(value) if not isinstance(value, (float, int)) else f"{value:g}"
    if hasattr(value, "field_names"):
        text = " ".join(text.split())
    if "\n" in text and not isinstance(value, np.ndarray):
        return f"a {type(value).__name__}"  # a whole table, or a sheet of arrays
    return text if len(text) <= 60 else text[:57] + "..."
