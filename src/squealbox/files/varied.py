"""What of a design can be varied, and the key `vary` of a section: ``{ "friction.static" = [0, 1] }``.

Bounds or values are a list, an axis is a table of range and points; each stands for the table a section had before.
"""

from collections.abc import Mapping
from typing import Annotated, Any, get_origin

import numpy as np

from squealbox.countermeasures.base import Countermeasure, short_name
from squealbox.designs import Design
from squealbox.files.document import Document
from squealbox.files.lines import Key
from squealbox.files.numbers import wrong
from squealbox.parameters import Choice, Parameter, ParameterError, field_type, known_names

VARY = "vary"
EXAMPLE = "{ 'friction.static' = [0, 1] }"


def quantity_of(design: Design, name: str) -> Parameter:
    """Unit and range of the scalar parameter `name` of `design`; `ParameterError` names those there are."""
    known, short = scalar_parameters(design), short_name(design, name)
    if short not in known:
        raise ParameterError("design", "parameter", name, known_names(name[:60], list(known)))
    return known[short]


def scalar_parameters(design: Design) -> dict[str, Parameter]:
    """The parameters of a design that a study can vary, nested ones with dots, aliases included.

    Those of a brake within countermeasures and loops keep their names.
    """
    arrays = {name for name in design.parameters() if get_origin(field_type(type(design), name)) is Annotated}
    leaves = ((name, about) for name, about, value in design.leaves() if np.ndim(value) == 0)
    known = {name: about for name, about in leaves if name not in arrays}
    brake = design.innermost if isinstance(design, Countermeasure) else design
    own = brake.parameters()
    for alias, names in brake.aliases.items():
        if all(name in own for name in names):
            known.setdefault(alias, own[names[0]])
    return known


def words_of(design: Design) -> dict[str, Choice]:
    """The fields of a design that hold one of several words, those of a brake within countermeasures included."""
    held = words_of(design.brake) if isinstance(design, Countermeasure) else {}
    return {**held, **design.choices()}


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
    names = set() if design is None else set(scalar_parameters(design))
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
