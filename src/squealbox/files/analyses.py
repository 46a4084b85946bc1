"""What a design file may ask of its design: the sections [modes], [onset], [branch], [map] and [simulate].

Each section is a data sheet that stands beside its analysis.
"""

from collections.abc import Mapping
from typing import Any

from squealbox.design import Design
from squealbox.family import ParameterAxis, ParameterPlane
from squealbox.files.document import Document
from squealbox.files.lines import Key
from squealbox.files.numbers import WRONG, only, read_number, wrong
from squealbox.files.sheets import read_sheet
from squealbox.files.varied import VARY, axes_of, flattened, known
from squealbox.parameters import Parameter
from squealbox.stability import ModeSettings
from squealbox.transient import MotionSettings


def read_modes(document: Document, table: Mapping[str, Any], key: Key, design: Design | None) -> ModeSettings | None:
    """The section [modes]."""
    return read_sheet(document, ModeSettings, table, key)


def read_simulate(
    document: Document, table: Mapping[str, Any], key: Key, design: Design | None
) -> MotionSettings | None:
    """The section [simulate]; the start must have as many numbers as the design has degrees of freedom."""
    section = read_sheet(document, MotionSettings, table, key)
    if section is None or design is None:
        return section
    size = design.system().size
    for name in ("q", "qd"):
        value = getattr(section, name)
        if value is not None and value.shape != (size,):
            document.problem((*key, name), f"{value.size} numbers: expected {size}, one for each degree of freedom")
    return section


def read_onset(document: Document, table: Mapping[str, Any], key: Key, design: Design | None) -> ParameterAxis | None:
    """The section [onset] or [branch]: ``vary = { "friction.static" = [0, 1] }``, or a parameter and its range."""
    if VARY in table:
        only(document, table, key, (VARY, "points"))
        axes = axes_of(document, table, key, design, plain="range", count=1)
        return next((read_axis(document, *axis, design) for axis in axes), None)
    return read_axis(document, table, key, design)


def read_map(document: Document, table: Mapping[str, Any], key: Key, design: Design | None) -> ParameterPlane | None:
    """The section [map]: two parameters that `vary`, or tables ``x`` and ``y`` of parameter, range and points."""
    if VARY in table:
        only(document, table, key, (VARY, "points"))
        plane = [
            read_axis(document, *axis, design) for axis in axes_of(document, table, key, design, plain="range", count=2)
        ]
        return None if not plane or plane[0] is None or plane[1] is None else ParameterPlane(plane[0], plane[1])
    axes: dict[str, ParameterAxis | None] = {}
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
    return None if x is None or y is None else ParameterPlane(x, y)


def read_axis(document: Document, table: Mapping[str, Any], key: Key, design: Design | None) -> ParameterAxis | None:
    """A parameter of the design and a range in its unit."""
    if "range" not in table:
        document.problem(key, "the key 'range' is missing, expected two values such as [0, 1]")
    given = {name: value for name, value in table.items() if name != "range"}
    name = table.get("parameter")
    about = known(document, name, (*key, "parameter"), design) if isinstance(name, str) else None
    ends = read_ends(document, table.get("range"), about, (*key, "range"))
    low, high = ends or (0.0, 1.0)
    axis = read_sheet(document, ParameterAxis, {**given, "low": low, "high": high}, key)
    return axis if ends else None


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


def read_spans(
    document: Document, table: Mapping[str, Any], key: Key, design: Design | None
) -> dict[str, tuple[float, float]]:
    """Two numbers for each parameter of a table."""
    found = {name: read_ends(document, value, known(document, name, place, design), place)
             for name, value, place in flattened(table, key, design)}  # fmt: skip
    return {name: ends for name, ends in found.items() if ends is not None}
