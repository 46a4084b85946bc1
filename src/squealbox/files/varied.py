"""What of a design can be varied: its scalar parameters with unit and range, and the fields that hold a word."""

from typing import Annotated, get_origin

import numpy as np

from squealbox.countermeasures.base import Countermeasure, short_name
from squealbox.designs import Design
from squealbox.files.sheets import field_type
from squealbox.parameters import Choice, Parameter, ParameterError, known_names


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
