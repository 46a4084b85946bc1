"""What a section varies, its key `vary`: ``{ "friction.static" = [0, 1] }``.

Bounds or values are a list, an axis is a table of range and points; each stands for the table a section had before.
"""

from collections.abc import Mapping
from typing import Any

from squealbox.design import Design
from squealbox.files.document import Document
from squealbox.files.lines import Key
from squealbox.files.numbers import wrong
from squealbox.parameters import Parameter, ParameterError

VARY = "vary"
EXAMPLE = "{ 'friction.static' = [0, 1] }"


def axes_of(
    document: Document, table: Mapping[str, Any], key: Key, design: Design | None, *, plain: str, count: int = 0
) -> list[tuple[dict[str, Any], Key]]:
    """What a section varies, each as a table of parameter and range (or, as `plain` says, values) with its key.

    `count` of them, 0 for any number; none, and a problem of the document, where that is not what stands there.
    """
    given, names = table[VARY], "" if count == 0 else f" of {count} parameter{'s' * (count > 1)}"
    found = flattened(given, (*key, VARY), design) if isinstance(given, Mapping) else []
    if not found or len(found) != (count or len(found)):
        wrong(document, (*key, VARY), given, f"a table{names} such as {EXAMPLE}")
        return []
    rest = {name: value for name, value in table.items() if name == "points"}
    axes = ({**rest, **(value if isinstance(value, Mapping) else {plain: value})} for _, value, _ in found)
    return [({"parameter": name, **axis}, place) for axis, (name, _, place) in zip(axes, found, strict=True)]


def flattened(table: Mapping[str, Any], key: Key, design: Design | None) -> list[tuple[str, Any, Key]]:
    """(dotted name, value, key) of a table in which ``a.b = ...`` without quotes made a table of tables."""
    names = set() if design is None else set(design.scalars())
    found: list[tuple[str, Any, Key]] = []

    def walk(part: Mapping[str, Any], prefix: str, place: Key) -> None:
        for name, value in part.items():
            further = f"{prefix}{name}."
            if isinstance(value, Mapping) and any(each.startswith(further) for each in names):
                walk(value, further, (*place, name))
            else:
                found.append((prefix + name, value, (*place, name)))

    walk(table, "", key)
    return found


def known(document: Document, name: Any, key: Key, design: Design | None) -> Parameter | None:
    """What the design declares of a parameter; None, and noted, for an unknown name."""
    if not isinstance(name, str):
        wrong(document, key, name, "the name of a parameter, such as 'friction.static'")
        return None
    if design is None:
        return None
    first, parts = name.partition(".")[0], (design, design.innermost)
    if first in document.faulty and any(first in (*each.field_names(), *each.aliases) for each in parts):
        return None  # what it names has been reported itself
    try:
        return design.scalar(name)
    except ParameterError as error:
        document.problem(key, f"unknown parameter {name[:60]!r}, {error.expectation}")
        return None
