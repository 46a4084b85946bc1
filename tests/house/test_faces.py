"""Walls between rooms: a room is used by the names of its face, and a face says for whom each name is.

The face of a room is its ``__init__.pyi``, or its ``__init__.py`` where the room finds its names by loading its folder.
Public are the names in `__all__`; a name that is imported ``as`` itself behind them is for neighbours alone.
"""

import ast
from collections.abc import Iterable
from pathlib import Path

import pytest

from house.rooms import PACKAGE, load
from squealbox.parameters import from_plain, to_plain

ROOMS = sorted(path.parent.name for path in PACKAGE.glob("*/__init__.py"))
DOORS = {"squealbox", "cli"}  # the front door offers names to users, the command line to nobody
MODULES_TOO = {  # names on a face that are modules of the room
    ("files", "own_law"),  # the module stays for what former versions import
    ("friction", "curves"),  # the module itself
}


def face(room: str) -> Path:
    """The file that lists what a room offers."""
    stub = PACKAGE / room / "__init__.pyi"
    return stub if stub.exists() else stub.with_suffix(".py")


def offered(room: str) -> dict[str, bool]:
    """The names a face imports, and whether each is for neighbours alone."""
    imports = [node for node in ast.parse(face(room).read_text()).body if isinstance(node, ast.ImportFrom)]
    return {each.name: each.asname is not None for node in imports for each in node.names}


def modules(room: str) -> set[str]:
    """The modules and folders of modules of a room."""
    return {path.stem for path in (PACKAGE / room).glob("*.py")} | {
        p.parent.name for p in (PACKAGE / room).glob("*/*.py")
    }


def imported(place: str, text: str) -> Iterable[tuple[int, str, str]]:
    """Line, module and name of each import of this package in a file; the name is "" where a module is imported."""
    package = ["squealbox", *Path(place).parts[:-1]]
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.Import):
            yield from ((node.lineno, each.name, "") for each in node.names)
        elif isinstance(node, ast.ImportFrom):
            above = package[: len(package) + 1 - node.level] if node.level else []
            module = ".".join([*above, *filter(None, [node.module])])
            yield from ((node.lineno, module, each.name) for each in node.names)


def around(place: str, text: str) -> list[str]:
    """The imports of a file that go round the face of another room, a sentence each."""
    said = []
    for line, module, name in imported(place, text):
        top, room, *inside = [*module.split("."), ""]
        if top != "squealbox" or room not in ROOMS or room == Path(place).parts[0]:
            continue
        if inside[:-1] or name in modules(room):
            what = name or inside[0]
            do = f"import it from squealbox.{room}"
            if name in modules(room) and not inside[:-1]:
                do = "import what is needed from it by name"
            elif what not in offered(room):
                do = f"list it there first, below __all__ if it is no user's name, and {do}"
            wall = face(room).relative_to(PACKAGE)
            said.append(f"{place}, line {line}: {what} is taken round the face of {room}, {wall}; {do}")
    return said


def test_no_import_goes_round_a_face():
    files = [str(path.relative_to(PACKAGE)) for path in sorted(PACKAGE.rglob("*.py"))]
    said = [each for place in files for each in around(place, (PACKAGE / place).read_text())]
    assert not said, "; ".join(said)


def test_an_import_round_a_face_is_seen():
    reduced, inner = "from squealbox.fe.reduced_brake import ReducedBrake", "from squealbox.fe.grids import Inner"
    begin = "stability/a.py, line 1: "
    assert around("stability/a.py", reduced) == [
        f"{begin}ReducedBrake is taken round the face of fe, fe/__init__.pyi; import it from squealbox.fe"
    ]
    assert around("stability/a.py", inner)[0].endswith(
        "list it there first, below __all__ if it is no user's name, and import it from squealbox.fe"
    )
    assert around("quantities.py", "def f():\n    from squealbox.fe import grids")[0].startswith(
        "quantities.py, line 2: "
    )
    assert (
        len(around("stability/a.py", "import squealbox.fe.grids\nfrom ..fe.grids import Inner\nfrom ..fe import grids"))
        == 3
    )
    assert around("fe/a.py", f"{reduced}\n{inner}") == []
    assert (
        around("stability/a.py", "from squealbox.fe import ReducedBrake\nfrom squealbox import fe\nimport numpy") == []
    )


@pytest.mark.parametrize("room", ROOMS)
def test_a_face_tells_for_whom_each_name_is(room):
    public = set(load(f"squealbox.{room}").__all__) if room not in DOORS else set()
    names = offered(room)
    if face(room).suffix == ".pyi":
        lost = sorted(name for name, beside in names.items() if beside == (name in public))
        assert not lost, (
            f"{face(room).relative_to(PACKAGE)}: {', '.join(lost)}: a user's name stands in __all__, "
            "a name for neighbours alone is imported `as` itself"
        )
    assert all(getattr(load(f"squealbox.{room}"), name) is not None for name in names)


@pytest.mark.parametrize("room", ROOMS)
def test_no_name_on_a_face_is_that_of_a_module(room):
    """Loading the module would put it in the place of the name."""
    both = sorted(name for name in offered(room) if name in modules(room) and (room, name) not in MODULES_TOO)
    assert not both, f"{', '.join(both)} is a name on the face of {room} and a module in it: rename the module"


def used_of_rooms(place: str, text: str) -> set[tuple[str, str]]:
    """The names a file takes of other rooms: by import, or as attributes of a room that is imported whole."""
    found = [(module.removeprefix("squealbox."), name) for _, module, name in imported(place, text)]
    tree = ast.parse(text)
    imports = [node for node in ast.walk(tree) if isinstance(node, ast.ImportFrom) and node.module == "squealbox"]
    whole = {each.asname or each.name: each.name for node in imports for each in node.names}
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in whole:
            found.append((whole[node.value.id], node.attr))
    return {(room, name) for room, name in found if room != Path(place).parts[0]}


def test_nothing_is_for_neighbours_that_no_neighbour_uses():
    used = set().union(*(used_of_rooms(str(p.relative_to(PACKAGE)), p.read_text()) for p in PACKAGE.rglob("*.py")))
    beside = [(room, name) for room in ROOMS for name, alone in offered(room).items() if alone]
    assert len(beside) > 20
    idle = [f"{name} off the face of {room}" for room, name in beside if (room, name) not in used]
    assert not idle, f"take {', '.join(idle)}: no other room uses it"


def test_what_a_file_takes_of_other_rooms_is_seen():
    text = "from squealbox import fe as solid\nfrom squealbox.plots import drawn\nx = solid.Pencil"
    assert used_of_rooms("cli/a.py", text) >= {("fe", "Pencil"), ("plots", "drawn")}
    assert ("fe", "Pencil") not in used_of_rooms("fe/a.py", text)


def test_a_file_is_read_whose_class_is_in_a_module_of_another_name_today():
    from squealbox.friction import LinearSlope, averaged

    law = averaged(LinearSlope(0.4, -0.1), 0.1)
    plain = to_plain(law)
    assert from_plain({**plain, "kind": "friction.averaged.Averaged"}) == law
