"""A number with its unit, such as ``'35 deg'`` or ``'-0.05 s/m'``, to the SI number the program computes with.

The number is split off first and the unit is taken apart by the short grammar below, so that no string from a file is
ever evaluated::

    quantity = number [unit]          number = 1, -0.5, .5, 1e6
    unit     = factor { (" " | "*" | "·" | "/") factor }
    factor   = name [ ("^" | "**") exponent ] | name superscript; the first may be 1, as in 1/s

A slash divides by the one factor that follows it. The names that brake work uses are in the table `NAMES`; a name that
is not there and has four letters or more is looked up in pint, which is loaded only then. Shorter names are never asked
of pint, because it reads ``c`` as the speed of light, ``a`` as a year and ``MM`` as megamolar.

An angle counts as a dimension where it changes the meaning: rad/s is not Hz.
"""

import functools
import math
import re
from dataclasses import dataclass
from typing import Any

LONGEST = 80  # characters of a quantity; the longest unit a data sheet declares has 8
LARGEST_EXPONENT = 6
MOST_FACTORS = 8
SHORTEST_FOR_PINT = 4  # letters

Dimension = tuple[int, int, int, int]  # powers of mass, length, time, angle


class UnitError(ValueError):
    """A text is not a number with a unit, or its unit measures something else. The message says which."""


@dataclass(frozen=True)
class UnitOfMeasure:
    """What a unit is worth in SI, and its powers of mass, length, time and angle."""

    factor: float
    dimension: Dimension


_NUMBER = re.compile(r"([+-]?(?:[0-9]+(?:\.[0-9]*)?|\.[0-9]+)(?:[eE][+-]?[0-9]+)?)[ \t]*(.*)", re.DOTALL)
_FACTOR = re.compile(r"([A-Za-zµμ°%]+(?:_[A-Za-z]+)*|^1(?= *[/]))(?:(?:\^|\*\*)([+-]?[0-9]+)|([²³]))?")
_OPERATOR = re.compile(r" *([*·/]) *| +")
_ALLOWED = re.compile(r"[A-Za-zµμ°%_0-9 *·/^²³+-]*")

_MASS, _LENGTH, _TIME, _ANGLE = (1, 0, 0, 0), (0, 1, 0, 0), (0, 0, 1, 0), (0, 0, 0, 1)
_FORCE, _RATE, _PRESSURE, _NONE = (1, 1, -2, 0), (0, 0, -1, 0), (1, -1, -2, 0), (0, 0, 0, 0)
_POUND, _INCH, _GRAVITY = 0.45359237, 0.0254, 9.80665

_PREFIXES = {"": 1.0, "n": 1e-9, "u": 1e-6, "µ": 1e-6, "μ": 1e-6, "m": 1e-3, "k": 1e3, "M": 1e6, "G": 1e9}
_PREFIXED = {
    "g": (1e-3, _MASS),
    "m": (1.0, _LENGTH),
    "s": (1.0, _TIME),
    "N": (1.0, _FORCE),
    "Hz": (1.0, _RATE),
    "Pa": (1.0, _PRESSURE),
    "rad": (1.0, _ANGLE),
    "Nm": (1.0, (1, 2, -2, 0)),
    "J": (1.0, (1, 2, -2, 0)),
    "W": (1.0, (1, 2, -3, 0)),
}
_PLAIN = {
    "1": (1.0, _NONE),
    "%": (0.01, _NONE),
    "t": (1e3, _MASS),
    "lb": (_POUND, _MASS),
    "cm": (0.01, _LENGTH),
    "in": (_INCH, _LENGTH),
    "ft": (12.0 * _INCH, _LENGTH),
    "min": (60.0, _TIME),
    "h": (3600.0, _TIME),
    "kgf": (_GRAVITY, _FORCE),
    "lbf": (_POUND * _GRAVITY, _FORCE),
    "bar": (1e5, _PRESSURE),
    "psi": (_POUND * _GRAVITY / _INCH**2, _PRESSURE),
    "mph": (1609.344 / 3600.0, (0, 1, -1, 0)),
    "deg": (math.pi / 180.0, _ANGLE),
    "°": (math.pi / 180.0, _ANGLE),
    "turn": (2.0 * math.pi, _ANGLE),
    "rev": (2.0 * math.pi, _ANGLE),
    "rpm": (2.0 * math.pi / 60.0, (0, 0, -1, 1)),
}
NAMES: dict[str, UnitOfMeasure] = {
    prefix + name: UnitOfMeasure(worth * factor, dimension)
    for name, (factor, dimension) in _PREFIXED.items()
    for prefix, worth in _PREFIXES.items()
} | {name: UnitOfMeasure(factor, dimension) for name, (factor, dimension) in _PLAIN.items()}

_KINDS: dict[Dimension, str] = {
    _NONE: "a plain number",
    _MASS: "a mass",
    _LENGTH: "a length",
    _TIME: "a time",
    _ANGLE: "an angle",
    _FORCE: "a force",
    _RATE: "a frequency",
    _PRESSURE: "a pressure",
    (0, 0, -1, 1): "an angular frequency",
    (0, 1, -1, 0): "a speed",
    (0, 1, -2, 0): "an acceleration",
    (0, -1, 1, 0): "a slope of friction",
    (1, 0, -2, 0): "a stiffness",
    (1, 0, -1, 0): "a damping",
    (1, 1, -3, 0): "a force per time",
    (1, 2, -2, 0): "a moment or an energy",
    (1, 2, 0, 0): "a moment of inertia",
}


def in_si(text: str, expected: str) -> float:
    """The number in `text`, converted to the SI unit `expected` (such as ``N s/m``, or ``-`` for none).

    A number without a unit is taken to be in `expected` already. Raises `UnitError`, one sentence without the key.

    >>> in_si("1 kN", "N"), in_si("190 kN/mm", "N/m")
    (1000.0, 190000000.0)
    """
    number, unit_text = split(text)
    if unit_text in ("", "-"):
        return number
    given, wanted = unit(unit_text), unit(expected)
    if not _alike(given.dimension, wanted.dimension):
        raise UnitError(
            f"{_short(text)} has the unit {unit_text} ({kind(given)}), expected {_wanted(expected, wanted)}"
        )
    value = number * (given.factor / wanted.factor)
    if not math.isfinite(value):
        raise UnitError(f"{_short(text)} is too large to compute with")
    return value


def split(text: str) -> tuple[float, str]:
    """The finite number at the start of `text` and the unit that follows it, not yet understood."""
    if len(text) > LONGEST:
        raise UnitError(f"{_short(text)} has {len(text)} characters, expected a number and a unit, such as '1 kN'")
    match = _NUMBER.fullmatch(text.strip(" \t"))
    if match is None or (match[2] and not match[2][0].isalpha() and match[2][0] not in "%°-1*/"):
        hint = ": write a decimal point, not a comma" if re.match(r"[+-]?[0-9]+,[0-9]", text) else ""
        raise UnitError(f"{_short(text)} is not a number with a unit, such as '1 kN' or '35 deg'{hint}")
    number = float(match[1])
    if math.isinf(number):
        raise UnitError(f"{_short(text)} is too large to compute with")
    if number == 0.0 and re.search("[1-9]", re.split("[eE]", match[1])[0]):
        raise UnitError(f"{_short(text)} is too small to compute with")
    return number, match[2].strip(" \t")


@functools.lru_cache(256)
def unit(text: str) -> UnitOfMeasure:
    """What the unit `text` is worth; `UnitError` when it is not one."""
    if text in ("", "-"):
        return UnitOfMeasure(1.0, _NONE)
    if not _ALLOWED.fullmatch(text):
        odd = next(c for c in text if not _ALLOWED.fullmatch(c))
        raise UnitError(f"{_short(text)} is not a unit: the character {odd!a} has no place in one")
    factor, dimension = 1.0, [0, 0, 0, 0]
    for power, name in _factors(text):
        part = _named(name)
        factor *= part.factor**power
        dimension = [a + power * b for a, b in zip(dimension, part.dimension, strict=True)]
    return UnitOfMeasure(factor, (dimension[0], dimension[1], dimension[2], dimension[3]))


def kind(of: UnitOfMeasure) -> str:
    """What a unit measures, in words: "a force", or its SI units when there is no word for it."""
    if of.dimension in _KINDS:
        return _KINDS[of.dimension]
    parts = zip(("kg", "m", "s", "rad"), of.dimension, strict=True)
    return " ".join(name if power == 1 else f"{name}^{power}" for name, power in parts if power)


def _factors(text: str) -> list[tuple[int, str]]:
    """(power, name) of each factor, a slash making the power negative."""
    factors: list[tuple[int, str]] = []
    sign, at = 1, 0
    while True:
        match = _FACTOR.match(text, at)
        if match is None or len(factors) == MOST_FACTORS:
            raise UnitError(f"{_short(text)} is not a unit such as 'kN', 'N s/m' or 'm/s^2'")
        power = int(match[2] or "²³".find(match[3] or "?") + 2) if match[2] or match[3] else 1
        if abs(power) > LARGEST_EXPONENT:
            raise UnitError(f"{_short(text)} has the exponent {power}, expected at most {LARGEST_EXPONENT}")
        factors.append((sign * power, match[1]))
        if match.end() == len(text):
            return factors
        operator = _OPERATOR.match(text, match.end())
        if operator is None:
            raise UnitError(f"{_short(text)} is not a unit such as 'kN', 'N s/m' or 'm/s^2'")
        sign, at = (-1 if operator[1] == "/" else 1), operator.end()


def _named(name: str) -> UnitOfMeasure:
    if name in NAMES:
        return NAMES[name]
    found = _from_pint(name) if len(name) >= SHORTEST_FOR_PINT else None
    if found is None:
        near = [known for known in NAMES if known.lower() == name.lower()]
        hint = f"did you mean {near[0]!r}?" if near else "expected one such as 'kN', 'mm', 'deg', 'N s/m' or 's/m'"
        raise UnitError(f"unknown unit {_short(name)}, {hint}")
    return found


def _from_pint(name: str) -> UnitOfMeasure | None:
    """A single name looked up in pint; None for what pint does not know or what is not mechanical."""
    pint, registry = _pint()
    try:
        one = registry.Quantity(1.0, registry.Unit(name))
        worth, double = one.to_base_units(), registry.Quantity(2.0, one.units).to_base_units()
    except (pint.errors.PintError, AttributeError, ValueError, TypeError, AssertionError):
        return None  # the caller says so, with the name
    if double.magnitude != 2.0 * worth.magnitude:
        return None  # decibel, degree Celsius: not a factor
    powers = dict(worth.unit_items())
    base = ("kilogram", "meter", "second", "radian")
    if not set(powers) <= set(base) or any(power != int(power) for power in powers.values()):
        return None
    mass, length, time, angle = (int(powers.get(each, 0)) for each in base)
    return UnitOfMeasure(float(worth.magnitude), (mass, length, time, angle))


@functools.cache
def _pint() -> tuple[Any, Any]:
    import pint

    return pint, pint.UnitRegistry(cache_folder=None)


def _alike(given: Dimension, wanted: Dimension) -> bool:
    """Same dimension; the angle counts only where there is no mass or length to tell the two apart."""
    if given[:2] == (0, 0):
        return given == wanted
    return given[:3] == wanted[:3]


def _wanted(expected: str, wanted: UnitOfMeasure) -> str:
    if expected in ("", "-", "1"):
        return "a plain number without a unit"
    return f"{expected} ({kind(wanted)})"


def _short(text: str) -> str:
    shown = ascii(text) if not text.isprintable() else repr(text)
    return shown if len(shown) <= 40 else f"{shown[:30]}...'"
