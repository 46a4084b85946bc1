"""What `squealbox.` offers: every name importable, told once, in the order of the story."""

import ast
import dataclasses
from typing import Any, get_type_hints

import pytest

import squealbox
from house.rooms import PACKAGE, load, public_module_names
from squealbox.result import Array, Result
from squealbox.stability import ComplexModes

STUB = ast.parse((PACKAGE / "__init__.pyi").read_text())

# The story, by the room a name comes from: laws, schedules, system, designs, then what is asked of them, then pictures.
STORY = [
    "friction", "schedules", "system", "contacts", "designs", "files", "fit", "fe", "stability", "transient",
    "continuation", "limit_cycles", "studies", "quantities", "countermeasures", "loops", "control", "remedies",
    "signals", "calibration", "plots", "writing", "result", "parameters",
]  # fmt: skip


def told() -> list[str]:
    """The names of `__all__` in the stub, in its order."""
    for node in STUB.body:
        if isinstance(node, ast.Assign) and isinstance(node.value, ast.List):
            return [ast.literal_eval(item) for item in node.value.elts]
    raise AssertionError("the stub has no __all__")


def rooms() -> dict[str, str]:
    """Each name with the room the stub imports it from; a room that is public as a whole is its own."""
    imports = [node for node in STUB.body if isinstance(node, ast.ImportFrom)]
    return {alias.name: (node.module or alias.name).split(".")[0] for node in imports for alias in node.names}


def out_of_order(names, room_of) -> list[str]:
    """The names that stand before one of an earlier chapter."""
    chapters = [STORY.index(room_of[name]) for name in names]
    return [name for name, here, then in zip(names, chapters, chapters[1:], strict=False) if then < here]


@pytest.mark.parametrize("name", told())
def test_name_is_importable(name):
    assert getattr(squealbox, name) is not None


def test_each_name_is_told_once_and_imported():
    assert len(told()) == len(set(told()))
    assert set(told()) == set(rooms()) == set(squealbox.__all__)


def test_the_names_follow_the_story():
    assert out_of_order(told(), rooms()) == []


def test_a_name_out_of_order_is_found():
    assert out_of_order(["System", "Coulomb"], {"System": "system", "Coulomb": "friction"}) == ["System"]


def test_an_unknown_name_is_an_attribute_error():
    with pytest.raises(AttributeError, match="no_such_name"):
        squealbox.no_such_name  # noqa: B018


def test_arrays_of_results_are_arrays_to_a_type_checker():
    """A user's checker knows `modes.growth_rate` for an array: no declared array is Any."""
    for name in public_module_names():
        if name.split(".")[1:2] not in (["cli"], ["workbench"], ["report"], ["papers"]):
            load(name)
    kinds = [kind for kind in Result.kinds.values() if kind.__module__.startswith("squealbox.")]
    untyped = [
        f"{kind.__name__}.{field.name}"
        for kind in kinds
        for field in dataclasses.fields(kind)
        if field.metadata.get("dims") and field.type is Any
    ]
    assert len(kinds) > 25
    assert untyped == []
    assert get_type_hints(ComplexModes.growth_rate.fget)["return"] == Array
