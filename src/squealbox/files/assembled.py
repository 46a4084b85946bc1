"""`brake = "assembled"`: a finite-element brake from the files that another code exported.

    brake = "assembled"
    angular_speed = "5 rad/s"
    friction = { law = "coulomb", static = 0.45 }
    beta = "2e-8 s"

    [structure]
    units = "mm t s"                                     asked, because no exported file says it
    mass = "brake_MASS1.mtx"
    stiffness = "brake_STIF1.mtx"                        or "model.op4#KXX", a matrix of several in a file
    nodes = "nodes.csv"                                  node, x, y, z; needed where discs turn

    [[interfaces]]
    name = "pad 1"
    pairs = "pad1.csv"                                   slave, master, nx, ny, nz, area
    stiffness = "1e12 N/m^3"
    pressure = "1 MPa"
    sliding = { axis = [0, 0, 1], point = [0, 0, 0] }    or a direction, [1, 0, 0], with sliding_speed

Only files in the folder of the design, or below it, are opened.
"""

from collections.abc import Mapping
from typing import Any

from squealbox.design import Design
from squealbox.fe import AssembledBrake, CoordinateSystem, Interface, Rotation, StructureFiles
from squealbox.files.arrays import ArrayFileError, path_beside
from squealbox.files.document import Document
from squealbox.files.lines import Key
from squealbox.files.numbers import WRONG, read_number, wrong
from squealbox.files.sheets import make, read_field
from squealbox.parameters import DataSheet, Parameter, known_names
from squealbox.system import InvalidSystem

ASSEMBLED = "assembled"
DIRECTION, PLACE = Parameter("-"), Parameter("m")


def read_assembled(document: Document, tables: Mapping[str, Any], beside: tuple[str, ...]) -> Design | None:
    """The brake; None where something is wrong, which the document then holds."""
    before = len(document.problems)
    known = {*AssembledBrake.field_names()}
    values: dict[str, Any] = {}
    for name, value in tables.items():
        if name not in known:
            document.problem((name,), f"unknown key, {known_names(name[:60], [*known, *beside])}")
        elif name == "structure":
            values[name] = _structure(document, value)
        elif name == "interfaces":
            values[name] = _several(document, value, (name,), _interface)
        elif name == "systems":
            values[name] = _several(document, value, (name,), _coordinates)
        else:
            values[name] = read_field(document, AssembledBrake, name, value, (name,))
    if "structure" not in values:
        document.problem((), "the section [structure] is missing, expected mass, stiffness and units")
    if len(document.problems) > before:
        return None
    brake = make(document, AssembledBrake, values, ())
    if brake is None:
        return None
    try:
        brake.system()
    except (InvalidSystem, ValueError) as error:
        document.problem(("structure",), str(error))
        return None
    return brake


def _structure(document: Document, table: Any) -> Any:
    key: Key = ("structure",)
    if not isinstance(table, Mapping):
        return wrong(document, key, table, "a section [structure]")
    values: dict[str, Any] = {}
    names = StructureFiles.field_names()
    for name, value in table.items():
        if name not in names:
            document.problem((*key, name), f"unknown key, {known_names(name[:60], names)}")
        elif name == "units":
            values[name] = value if isinstance(value, str) else wrong(document, (*key, name), value, "units in quotes")
        else:
            values[name] = _file(document, value, (*key, name))
    for name in ("mass", "stiffness", "units"):
        if name not in values:
            document.problem(key, f"the key '{name}' is missing")
    return make(document, StructureFiles, values, key) if {"mass", "stiffness", "units"} <= set(values) else WRONG


def _file(document: Document, value: Any, key: Key) -> Any:
    if not isinstance(value, str) or not value:
        return wrong(document, key, value, "the name of a file in quotes")
    name, mark, inside = value.partition("#")
    try:
        return f"{path_beside(document.path, name)}{mark}{inside}"
    except ArrayFileError as error:
        document.problem(key, str(error))
        return WRONG


def _several(document: Document, value: Any, key: Key, read: Any) -> Any:
    if not isinstance(value, list) or not all(isinstance(item, Mapping) for item in value):
        return wrong(document, key, value, f"tables, each under a line [[{key[-1]}]]")
    read_items = [read(document, item, (*key, i)) for i, item in enumerate(value)]
    return WRONG if any(item is None or item is WRONG for item in read_items) else tuple(read_items)


def _interface(document: Document, table: Mapping[str, Any], key: Key) -> Any:
    values: dict[str, Any] = {}
    if "pairs" not in table:
        document.problem(key, "the key 'pairs' is missing, expected a CSV of contact pairs")
        return WRONG
    for name, value in table.items():
        here = (*key, name)
        if name not in Interface.field_names():
            document.problem(here, f"unknown key, {known_names(name[:60], Interface.field_names())}")
        elif name == "pairs":
            values[name] = _file(document, value, here)
        elif name == "sliding":
            values[name] = _sliding(document, value, here)
        else:
            values[name] = read_field(document, Interface, name, value, here)
    return _made(document, Interface, values, key)


def _sliding(document: Document, value: Any, key: Key) -> Any:
    if isinstance(value, Mapping):
        if not set(value) <= {"axis", "point"} or "axis" not in value:
            return wrong(document, key, value, "{ axis = [0, 0, 1], point = [0, 0, 0] }")
        parts = {
            name: _three(document, item, (*key, name), DIRECTION if name == "axis" else PLACE)
            for name, item in value.items()
        }
        return _made(document, Rotation, parts, key)
    return _three(document, value, key, DIRECTION)


def _coordinates(document: Document, table: Mapping[str, Any], key: Key) -> Any:
    values: dict[str, Any] = {}
    for name, value in table.items():
        here = (*key, name)
        if name not in CoordinateSystem.field_names():
            document.problem(here, f"unknown key, {known_names(name[:60], CoordinateSystem.field_names())}")
        elif name == "nodes":
            whole = isinstance(value, list) and all(isinstance(node, int) and node > 0 for node in value)
            values[name] = tuple(value) if whole else wrong(document, here, value, "a list of node numbers")
        elif name == "shape":
            values[name] = read_field(document, CoordinateSystem, name, value, here)
        else:
            values[name] = _three(document, value, here, PLACE if name == "origin" else DIRECTION)
    return _made(document, CoordinateSystem, values, key)


def _three(document: Document, value: Any, key: Key, about: Parameter) -> Any:
    if not isinstance(value, list) or len(value) != 3:
        return wrong(document, key, value, "three numbers, such as [0, 0, 1]")
    numbers = [read_number(document, item, about, (*key, i)) for i, item in enumerate(value)]
    return WRONG if any(number is WRONG for number in numbers) else tuple(numbers)


def _made(document: Document, sheet: type[DataSheet], values: dict[str, Any], key: Key) -> Any:
    if any(value is WRONG for value in values.values()):
        return WRONG
    return make(document, sheet, values, key)
