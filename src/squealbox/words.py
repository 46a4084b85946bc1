"""Numbers and units as a reader writes them: the same in figures, reports, cards and on the page."""

from collections.abc import Iterable
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from squealbox.parameters import Parameter

MINUS = "\N{MINUS SIGN}"
AUDIBLE = (20.0, 20e3)  # Hz that people hear

PREFIXES: dict[str, tuple[tuple[float, str], ...]] = {
    "m": ((1.0, "m"), (1e-3, "mm"), (1e-6, "µm"), (1e-9, "nm")),
    "s": ((1.0, "s"), (1e-3, "ms"), (1e-6, "µs")),
    "Hz": ((1e6, "MHz"), (1e3, "kHz"), (1.0, "Hz")),
    "rad/s": ((1e3, "10³ rad/s"), (1.0, "rad/s"), (1e-3, "mrad/s"), (1e-6, "µrad/s")),
    "N": ((1e6, "MN"), (1e3, "kN"), (1.0, "N"), (1e-3, "mN")),
    "Pa": ((1e9, "GPa"), (1e6, "MPa"), (1e3, "kPa"), (1.0, "Pa")),
    "J": ((1e3, "kJ"), (1.0, "J"), (1e-3, "mJ"), (1e-6, "µJ"), (1e-9, "nJ")),
    "m/s": ((1.0, "m/s"), (1e-3, "mm/s"), (1e-6, "µm/s")),
    "rad": ((np.pi / 180.0, "°"), (1e-3, "mrad"), (1e-6, "µrad"), (1e-9, "nrad")),
}

# Units in which a parameter is read and written, what one of them is in SI, and the sizes of the design's own value
# for which they are used; everything else is in SI.
READ_IN: dict[str, tuple[tuple[str, float, float, float], ...]] = {
    "rad": (("deg", np.pi / 180.0, 0.0, np.inf),),
    "N/m": (("kN/mm", 1e6, 1e5, np.inf),),
    "N": (("kN", 1e3, 1e4, np.inf),),
    "m": (("mm", 1e-3, 1e-12, 0.3), ("m", 1.0, 0.3, np.inf)),
    "s": (("µs", 1e-6, 1e-12, 1e-4), ("ms", 1e-3, 1e-4, 0.5)),
}


def number(value: float, digits: int = 4) -> str:
    """A number as a reader writes it: plain up to 99999, a true minus, no trailing zeros."""
    value = float(value)
    plain = value == 0.0 or 1e-4 <= abs(value) < 1e5
    text = (
        f"{value:.{max(digits - 1 - int(np.floor(np.log10(abs(value) or 1.0))), 0)}f}"
        if plain
        else f"{value:.{digits}g}"
    )
    text = text.rstrip("0").rstrip(".") if "." in text and "e" not in text else text
    return text.replace("-", MINUS)


def scaled(unit: str, *arrays: Any, to: str | None = None) -> tuple[float, str]:
    """What to divide SI values by, and the unit then read, so that the largest is one or more: (1e-3, "mm").

    `to` asks for one unit of the list; a unit without a list stays as it is. Raises `ValueError` for an unknown one.
    """
    choices = PREFIXES.get(unit, ((1.0, unit),))
    if unit == "Hz":
        choices = (*choices, (0.5 / np.pi, "rad/s"), (500.0 / np.pi, "10³ rad/s"))
    if to is not None:
        for factor, name in choices:
            if name == to:
                return factor, name
        known = ", ".join(name for _, name in choices)
        raise ValueError(f"unit = {to!r}: expected one of {known}, for a value in {unit}")
    largest = max((float(np.nanmax(np.abs(a), initial=0.0)) for a in map(np.asarray, arrays)), default=0.0)
    choices = PREFIXES.get(unit, ((1.0, unit),))
    if largest == 0.0 or not np.isfinite(largest):
        return next((choice for choice in choices if choice[0] == 1.0), choices[0])
    return next(((factor, name) for factor, name in choices if largest >= 0.999 * factor), choices[-1])


def read_in(about: "Parameter", usual: Any) -> tuple[str, float]:
    """The unit a parameter is read in and what one of it is in SI, chosen by the design's usual value, not the present.

    >>> from squealbox.parameters import Parameter
    >>> read_in(Parameter("N/m"), 190e6)
    ('kN/mm', 1000000.0)
    """
    size = abs(float(usual)) if isinstance(usual, (int, float)) else 0.0
    for unit, factor, least, most in READ_IN.get(about.unit, ()):
        if least <= size < most:
            return unit, factor
    return "" if about.unit == "-" else about.unit, 1.0


def quantity(value: Any, unit: str, digits: int = 4) -> str:
    """A number in the unit that suits it.

    >>> quantity(12.3e-6, "m")
    '12.3 µm'
    """
    return " ".join(read(value, unit, digits)).rstrip()


def read(value: Any, unit: str, digits: int = 4) -> tuple[str, str]:
    """The two words of a `quantity`: the number, and the unit it is read in."""
    if not np.isfinite(float(value)):
        return "not known", ""
    factor, written = scaled(unit, value)
    return number(float(value) / factor, digits), plain_unit(written)


def growing(rate: Any, frequency: Any) -> str:
    """How a mode grows, or decays: ``+12.5 1/s at 2080.85 Hz``."""
    return f"{float(rate):+.6g} 1/s at {float(frequency):.6g} Hz"


def level_told(level: Any, weighted: Any) -> str:
    """How loud, to the decibel that an estimate is worth: ``74 dB, 72 dB(A)``."""
    return f"{float(level):.0f} dB, {float(weighted):.0f} dB(A)"


def sizes_told(names: Iterable[str], sizes: Iterable[Any], units: Iterable[str], digits: int = 6) -> str:
    """What each freedom does, with units that suit: ``x 2.31 µm, y 4 mm``; of (least, largest) both.

    >>> sizes_told(("x", "y"), (2.31e-6, (1e-3, 4e-3)), ("m", "m"))
    'x 2.31 µm, y 1 to 4 mm'
    """
    told = []
    for name, size, unit in zip(names, sizes, units, strict=True):
        ends, (factor, written) = np.ravel(size), scaled(unit, size)
        told.append(f"{name} {' to '.join(number(end / factor, digits) for end in ends)} {written}".strip())
    return ", ".join(told)


def plain_unit(unit: str) -> str:
    """A unit as it is written behind a number: nothing for a pure number."""
    return "" if unit in ("-", "1") else unit


def quantity_label(name: str, unit: str) -> str:
    """``displacement [mm]``; a pure number is marked ``[-]``."""
    return f"{name} [{plain_unit(unit) or '-'}]"


def as_read(values: Any, unit: str) -> tuple[Any, str]:
    """Values of a parameter and their unit as people read them: angles in degrees, all else in SI."""
    return (np.rad2deg(values), "deg") if unit == "rad" else (values, plain_unit(unit))


def unit_at(system: Any, dof: int | str, *, moves: bool = False) -> str:
    """The unit of a degree of freedom of a system, m or rad; of its velocity where it `moves`."""
    names, units = getattr(system, "names", ()), getattr(system, "units", ())
    place = list(names).index(dof) if isinstance(dof, str) and dof in names else dof
    unit = units[place] if isinstance(place, (int, np.integer)) and place < len(units) else "m"
    return f"{unit}/s" if moves else unit


def array_told(values: Any, unit: str) -> str:
    """An array in a line: a number with its unit, or shape, range and unit; of words, how many of which."""
    array, behind = np.asarray(values), f" {plain_unit(unit)}".rstrip()
    if array.ndim == 0:
        return f"{array.item():.6g}{behind}" if array.dtype.kind in "fc" else f"{array.item()}{behind}"
    if array.dtype.kind in "OUSb" or array.size == 0:
        names, counts = np.unique(array.astype(str), return_counts=True)
        listed = ", ".join(f"{count} {name}" for name, count in list(zip(names, counts, strict=True))[:4])
        return f"{array.shape} {listed}{', ...' if len(names) > 4 else ''}" if array.size else f"{array.shape} empty"
    numbers = np.abs(array) if array.dtype.kind == "c" else array
    known = numbers[np.isfinite(numbers)]
    span = f"{known.min():.4g} to {known.max():.4g}{behind}" if known.size else "nothing finite"
    unknown = f", {numbers.size - known.size} not finite" if 0 < known.size < numbers.size else ""
    return f"{array.shape} {'magnitudes ' if array.dtype.kind == 'c' else ''}{span}{unknown}"
