"""What a design file may ask of its design: the sections [modes], [onset], [branch], [map] and [simulate].

Each section is a data sheet, declared with units and ranges like any other, so the file reader, the JSON schema and the
command line know it from here.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from squealbox.designs import Design
from squealbox.files.arrays import Vector
from squealbox.files.document import Document
from squealbox.files.lines import Key
from squealbox.files.numbers import WRONG, read_number, wrong
from squealbox.files.sheets import read_sheet
from squealbox.files.varied import VARY, axes_of, quantity_of
from squealbox.parameters import DataSheet, Parameter, ParameterError, choice, known_names, parameter
from squealbox.start import in_words
from squealbox.transient.legs import SCHEMES
from squealbox.transient.methods import TABLEAUX, TAYLOR
from squealbox.transient.simulate import TIME_STEPPING


class Modes(DataSheet):
    """[modes]: complex eigenvalues of steady sliding."""

    time: float = parameter("s", default=0.0, meaning="instant at which schedules are taken")
    band: Vector = parameter("Hz", 0.0, default=None, optional=True, meaning="of a finite-element brake: from, to")
    certify: bool = False  # count the growing modes of a finite-element brake by the winding number too


class Simulate(DataSheet):
    """[simulate]: a transient."""

    duration: float | None = parameter(
        "s", 0.0, low_open=True, default=None, optional=True,
        meaning="how long the motion is followed; left out, 200 periods of the worst mode",
    )  # fmt: skip
    start: str = choice(
        "rest", "sliding", "mode", default="rest",
        meaning="where it starts: at zero, in steady sliding, or beside it in a mode; mode 2 says in which",
    )  # fmt: skip
    mode: int | None = parameter("-", 1, default=None, optional=True, meaning="left out, the mode that grows fastest")
    amplitude: float | None = parameter(
        "m", 0.0, low_open=True, default=None, optional=True,
        meaning="of the mode; left out, the sliding speed of a contact swings by a hundredth",
    )  # fmt: skip
    q: Vector = parameter("m", default=None, optional=True, meaning="displacement added at the start; left out, none")
    qd: Vector = parameter("m/s", default=None, optional=True, meaning="velocity at the start; left out, zero")
    method: str = choice(
        "usual", TAYLOR, *TABLEAUX, default="usual",
        meaning="usual: the Taylor series where the equation has one, else dormand-prince-8; or a method by name",
    )  # fmt: skip
    rtol: float | None = parameter("-", 1e-14, 0.1, default=None, optional=True, meaning="left out, the method's own")
    contact: str = choice(
        *SCHEMES, TIME_STEPPING, default="exact",
        meaning="events (exact), plain sgn (raw), a smoothed sgn, or fixed steps, which know sliding in a plane",
    )  # fmt: skip
    width: float = parameter("m/s", 0.0, low_open=True, default=1e-3, meaning="speed over which sgn is smoothed")
    begin: float = parameter("s", default=0.0, meaning="instant at which the schedules begin")
    points: int = parameter("-", 2, 1_000_000, default=5001, meaning="number of instants kept")

    @property
    def begins(self) -> Any:
        """Where it starts, as `simulate` takes it; without what q and qd add."""
        number = None if self.mode is None else int(self.mode)
        return {"mode": number, "amplitude": self.amplitude} if self.start == "mode" else self.start


def start_keys(start: Any) -> Any:
    """``"mode 2"`` and ``{ mode = 2, amplitude = "1 um" }`` as the keys start, mode and amplitude of [simulate]."""
    if isinstance(start, Mapping):
        return {"start": "mode", **start}
    asked = in_words(start)
    if asked is None:
        return {"start": start}
    return {"start": "mode"} if asked["mode"] is None else {"start": "mode", "mode": asked["mode"]}


class Varied(DataSheet):
    """One parameter and the values it takes; `low` and `high` are in the parameter's own SI unit."""

    aliases: ClassVar[dict[str, tuple[str, ...]]] = {"parameter": ("name",)}

    name: str
    low: float = parameter("")
    high: float = parameter("")
    points: int = parameter("-", 2, 20_001, default=201, meaning="number of values")

    @property
    def values(self) -> np.ndarray:
        """The values, equally spaced, shape (points,)."""
        return np.linspace(self.low, self.high, int(self.points))


@dataclass(frozen=True)
class Map:
    """[map]: stability over two parameters."""

    x: Varied
    y: Varied


def read_modes(document: Document, table: Mapping[str, Any], key: Key, design: Design | None) -> Modes | None:
    """The section [modes]."""
    return read_sheet(document, Modes, table, key)


def read_simulate(document: Document, table: Mapping[str, Any], key: Key, design: Design | None) -> Simulate | None:
    """The section [simulate]; the start must have as many numbers as the design has degrees of freedom."""
    section = read_sheet(document, Simulate, {**table, **start_keys(table.get("start", "rest"))}, key)
    if section is None or design is None:
        return section
    size = design.system().size
    for name in ("q", "qd"):
        value = getattr(section, name)
        if value is not None and value.shape != (size,):
            document.problem((*key, name), f"{value.size} numbers: expected {size}, one for each degree of freedom")
    return section


def read_onset(document: Document, table: Mapping[str, Any], key: Key, design: Design | None) -> Varied | None:
    """The section [onset] or [branch]: ``vary = { "friction.static" = [0, 1] }``, or a parameter and its range."""
    if VARY in table:
        only(document, table, key, (VARY, "points"))
        axes = axes_of(document, table, key, design, plain="range", count=1)
        return next((read_axis(document, *axis, design) for axis in axes), None)
    return read_axis(document, table, key, design)


def read_map(document: Document, table: Mapping[str, Any], key: Key, design: Design | None) -> Map | None:
    """The section [map]: two parameters that `vary`, or tables ``x`` and ``y`` of parameter, range and points."""
    if VARY in table:
        only(document, table, key, (VARY, "points"))
        plane = [
            read_axis(document, *axis, design) for axis in axes_of(document, table, key, design, plain="range", count=2)
        ]
        return None if not plane or plane[0] is None or plane[1] is None else Map(plane[0], plane[1])
    axes: dict[str, Varied | None] = {}
    only(document, table, key, ("x", "y"))
    for name in ("x", "y"):
        value = table.get(name)
        if not isinstance(value, Mapping):
            example = "a table such as { parameter = 'friction.static', range = [0, 1], points = 201 }"
            wrong(document, (*key, name), value, example) if name in table else document.problem(
                key, f"the key '{name}' is missing, expected {example}"
            )
        else:
            axes[name] = read_axis(document, value, (*key, name), design)
    x, y = axes.get("x"), axes.get("y")
    return None if x is None or y is None else Map(x, y)


def only(document: Document, table: Mapping[str, Any], key: Key, known: tuple[str, ...]) -> None:
    """A problem of the document for each key that is none of those known."""
    for name in table:
        if name not in known:
            document.problem((*key, name), f"unknown key, {known_names(name[:60], list(known))}")


def read_axis(document: Document, table: Mapping[str, Any], key: Key, design: Design | None) -> Varied | None:
    """A parameter of the design and a range in its unit."""
    if "range" not in table:
        document.problem(key, "the key 'range' is missing, expected two values such as [0, 1]")
    given = {name: value for name, value in table.items() if name != "range"}
    ends = read_ends(document, table.get("range"), _about(document, table, key, design), (*key, "range"))
    low, high = ends or (0.0, 1.0)
    axis = read_sheet(document, Varied, {**given, "low": low, "high": high}, key)
    return axis if ends else None


def _about(document: Document, table: Mapping[str, Any], key: Key, design: Design | None) -> Parameter | None:
    name = table.get("parameter")
    if design is None or not isinstance(name, str):
        return None
    first = name.partition(".")[0]
    if first in document.faulty and first in [*design.field_names(), *design.aliases]:
        return None  # what it names has been reported itself
    try:
        return quantity_of(design, name)
    except ParameterError as error:
        document.problem((*key, "parameter"), f"unknown parameter {name[:60]!r}, {error.expectation}")
        return None


def read_ends(document: Document, value: Any, about: Parameter | None, key: Key) -> tuple[float, float] | None:
    """Two numbers in the unit and range of `about`, the lower first; None when there are none or one is wrong."""
    if value is None or about is None:
        return None
    if not isinstance(value, list) or len(value) != 2:
        wrong(document, key, value, "two values such as [0, 1]")
        return None
    low, high = (read_number(document, end, about, (*key, i)) for i, end in enumerate(value))
    if low is WRONG or high is WRONG:
        return None
    if not low < high:
        wrong(document, key, value, "the lower value first and the higher one second")
        return None
    return low, high
