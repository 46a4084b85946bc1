"""What a value of translated code is: a number, an array, a record of a structured dtype, or a tuple of such."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import Any

import numpy as np

LANES = 16  # of a packed number: two registers of AVX-512, of which one hides the latency of the other
FLOAT, WHOLE, TRUTH = "f", "i", "b"  # kinds of numbers, each wider than the next
PACKED, MASK = "v", "m"  # numbers and truths side by side, see `packed`
TEXTS = {FLOAT: "double", WHOLE: "i64", TRUTH: "i1", PACKED: f"<{LANES} x double>", MASK: f"<{LANES} x i1>"}


class Untranslatable(ValueError):
    """Code outside the plain subset: what, and where."""


@dataclass(frozen=True, slots=True)
class Number:
    """A number in a register."""

    kind: str
    text: str


@dataclass(frozen=True, slots=True)
class Array:
    """Numbers in memory, row by row; a length is a whole number or the text of one."""

    element: str
    pointer: str
    shape: tuple[Any, ...]


@dataclass(frozen=True, slots=True)
class Record:
    """One element of a structured array in memory."""

    dtype: np.dtype[Any]
    pointer: str


@dataclass(frozen=True, slots=True)
class Named:
    """A named tuple of values."""

    fields: tuple[str, ...]
    values: tuple[Any, ...]


@dataclass(frozen=True, slots=True)
class OfAnotherText:
    """A number, or a function that returns one or nothing, of another text: joined to this one when both are loaded."""

    name: str
    kind: str | None

    def __call__(self, *_: Any) -> Any:
        raise TypeError(f"{self.name} is of compiled code alone")


Value = Any  # one of the above, a tuple of them, or a Python number known beforehand


def kind_of(value: Value) -> Any:
    """The kind of a value, hashable: what a function is translated for."""
    if isinstance(value, Number):
        return value.kind
    if isinstance(value, bool | np.bool_):
        return TRUTH
    if isinstance(value, int | np.integer):
        return WHOLE
    if isinstance(value, float):
        return FLOAT
    if isinstance(value, Array):
        return "array", value.element, tuple(n if isinstance(n, int) else None for n in value.shape)
    if isinstance(value, Record):
        return "record", value.dtype
    if isinstance(value, Named):
        return "named", value.fields, tuple(kind_of(each) for each in value.values)
    if isinstance(value, tuple):
        return "tuple", tuple(kind_of(each) for each in value)
    raise Untranslatable(f"{value!r}: expected a number, an array, a record or a tuple of them")


def registers(kind: Any) -> list[str]:
    """LLVM's types of the registers in which a value of that kind is handed over."""
    if isinstance(kind, str):
        return [TEXTS[kind]]
    if kind[0] == "array":
        return ["ptr", *("i64" for n in kind[2] if n is None)]
    if kind[0] == "record":
        return ["ptr"]
    return [text for each in kind[-1] for text in registers(each)]


def taken(kind: Any, names: Iterator[str]) -> Value:
    """A value of that kind from registers of these names."""
    if isinstance(kind, str):
        return Number(kind, next(names))
    if kind[0] == "array":
        pointer = next(names)
        return Array(kind[1], pointer, tuple(next(names) if n is None else n for n in kind[2]))
    if kind[0] == "record":
        return Record(kind[1], next(names))
    parts = tuple(taken(each, names) for each in kind[-1])
    return Named(kind[1], parts) if kind[0] == "named" else parts


def handed(value: Value) -> list[str]:
    """The registers of a value, in the order of `registers`; literals are numbers by then."""
    if isinstance(value, Number):
        return [value.text]
    if isinstance(value, Array):
        return [value.pointer, *(n for n in value.shape if not isinstance(n, int))]
    if isinstance(value, Record):
        return [value.pointer]
    values = value.values if isinstance(value, Named) else value
    return [text for each in values for text in handed(each)]


def wider(a: Any, b: Any) -> Any:
    """The kind that holds values of both; `Untranslatable` where there is none."""
    if a == b:
        return a
    if isinstance(a, str) and isinstance(b, str) and not {a, b} & {PACKED, MASK}:
        return FLOAT if FLOAT in (a, b) else WHOLE
    if a is not None and b is not None and a[0] == b[0] == "tuple" and len(a[1]) == len(b[1]):
        return "tuple", tuple(wider(x, y) for x, y in zip(a[1], b[1], strict=True))
    raise Untranslatable(f"a value that is {said(a)} here and {said(b)} there")


def said(kind: Any) -> str:
    """A kind in words."""
    words = {FLOAT: "a number", WHOLE: "a whole number", TRUTH: "a truth value", None: "nothing"}
    words |= {PACKED: "packed numbers", MASK: "a mask"}
    return words[kind] if kind is None or isinstance(kind, str) else f"a {kind[0]}"
