"""Every public thing says what it is, and what docs/house.md promises of it: units, shapes, sources."""

import collections
import inspect
import re
import types
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from numpy.typing import ArrayLike

from house.rooms import load, module_names
from squealbox.units import unit

MODULES = module_names()


def undocumented(module) -> list[str]:
    """Public functions, classes and methods defined in `module` that have no docstring, nor inherit one."""
    missing = [] if module.__doc__ else [module.__name__]
    for name, thing in vars(module).items():
        if name.startswith("_") or getattr(thing, "__module__", None) != module.__name__:
            continue
        if inspect.isfunction(thing) or inspect.isclass(thing):
            missing += [] if _text(thing) else [f"{module.__name__}.{name}"]
        if inspect.isclass(thing):
            missing += [f"{module.__name__}.{name}.{method}" for method in _silent_methods(thing)]
    return missing


def _text(thing) -> str:
    text = (inspect.getdoc(thing) or "").strip()
    # A dataclass without a docstring is given its signature for one: that says nothing.
    return "" if inspect.isclass(thing) and text.startswith(f"{thing.__name__}(") else text


def _silent_methods(cls) -> list[str]:
    kinds = (types.FunctionType, classmethod, property)
    public = {name: value for name, value in vars(cls).items() if not name.startswith("_") and isinstance(value, kinds)}
    # On the class, getdoc follows the bases, so an override inherits the text of what it overrides.
    return [name for name in public if not inspect.getdoc(getattr(cls, name))]


@pytest.mark.parametrize("name", MODULES)
def test_public_names_have_docstrings(name):
    assert undocumented(load(name)) == []


def test_a_silent_function_class_and_method_are_found():
    source = (
        "'''Says.'''\nfrom dataclasses import dataclass\ndef f(): pass\n"
        "@dataclass\nclass C:\n    a: int = 0\n    def m(self): pass\n    @property\n    def p(self): pass\n"
    )
    silent = types.ModuleType("silent")
    exec(source, silent.__dict__)
    silent.__doc__ = "Says."
    assert undocumented(silent) == ["silent.f", "silent.C", "silent.C.m", "silent.C.p"]


# What the docstrings of public functions and classes owe: a unit for every number, a shape for every array, a source
# for every formula. The numbers of data sheets and the arrays of results have theirs where they are declared.

FACES = ["squealbox"] + [f"squealbox.{room}" for room in (
    "calibration", "control", "countermeasures", "designs", "fe", "files", "friction", "limit_cycles", "loops", "plots",
    "quantities", "schedules", "signals", "stability", "studies", "transient",
)]  # fmt: skip
ONE = (float, float | None, tuple[float, float], tuple[float, float] | None)
NUMBERS = (*ONE, Sequence[float], Sequence[float] | None, float | Sequence[float] | None)
ARRAYS = (Any, np.ndarray, np.ndarray | None, float | np.ndarray, ArrayLike, ArrayLike | None)
IN_WORDS = re.compile(r"\bSI\b|\bunits? of\b|\bown unit\b|\bin Hz\b|\bdB\b")
SHAPE = re.compile(
    r"\bshapes? |\(\.\.\.|\((?:\d+|[a-z_]+),(?: (?:\d+|2 ?n|[a-z_]+),?)*\)|\bscalars?\b|for each\b"
    r"|[Aa]rray in, array out"
)
FORMULA = re.compile(r"^ {4,}[^\n]* = |^[A-Za-z_|']+(?:\(.*?\))? = ", re.M)
SOURCE = re.compile(r"\bSource|\bEq\.|\b(?:1[89]|20)\d\d\b|\b[Dd]erived\b|\bby definition\b")
NO_ARRAYS = {"design", "design_or_system", "analysis", "band"}  # typed Any, and no arrays
NO_ARRAY_BACK = {"folded", "near_sliding", "parameter", "panels"}  # return a system, a field, a figure, typed Any


def has_unit(text: str) -> bool:
    """Whether a text names a unit: [Hz], [m, m/s], [-], or in words."""
    for told in re.findall(r"\[([^\[\]]+)\]", text):
        parts = [part.strip() for part in re.split(r",| or | and ", told)]
        try:
            if all(part == "-" or unit(part) for part in parts):
                return True
        except (ValueError, KeyError):
            continue
    return bool(IN_WORDS.search(text))


def told_of(text: str) -> dict[str, str]:
    """What a docstring says of each parameter: its entry, and what stands behind its name in backticks."""
    section = re.search(r"^Parameters\n-+\n(.*?)(?=\n\n(?! )|\Z)", text, re.M | re.S)
    entry = r"^(\*{0,2}\w+(?:, \*{0,2}\w+)*) ?:(.*(?:\n +.*)*)"
    found: dict[str, str] = collections.defaultdict(str)
    for names, told in re.findall(entry, section[1] if section else "", re.M):
        for name in names.split(", "):
            found[name.lstrip("*")] += told
    for name, told in re.findall(r"`(\w+)`([^`]{0,80})", text):
        found[name] += told
    return found


def owed(thing) -> tuple[bool, list[str]]:
    """Whether a docstring owes a unit, a shape or a source, and which it lacks."""
    text, owes, lacks = inspect.getdoc(thing) or "", False, []
    around = f" {inspect.getmodule(thing).__doc__ or ''} {getattr(thing, 'source', '')}"
    if inspect.isfunction(thing):
        told, signature = told_of(text), inspect.signature(thing)
        for name, about in signature.parameters.items():
            array = (
                about.annotation in ARRAYS and name not in NO_ARRAYS and re.search(r"\barrays?\b|\bmatri", told[name])
            )
            owes |= about.annotation in NUMBERS or bool(array)
            lacks += [f"{name} has no unit"] * (about.annotation in NUMBERS and not has_unit(told[name]))
            lacks += [f"{name} has no shape"] * (bool(array) and not SHAPE.search(told[name]))
        back = signature.return_annotation
        arrays = back is Any or ("tuple" in str(back) and "Any" in str(back)) or "ndarray" in str(back)
        if arrays and thing.__name__ not in NO_ARRAY_BACK:
            owes = True
            lacks += [] if SHAPE.search(text + around) else ["what it returns has no shape"]
    if FORMULA.search(text.partition(">>>")[0].partition("Parameters\n---")[0]):
        owes = True
        lacks += [] if SOURCE.search(text + around) else ["its formula has no source"]
    return owes, lacks


def public_things() -> dict[str, object]:
    """Functions and classes of the front door and of the faces of rooms, each once."""
    seen: dict[object, str] = {}
    for face in FACES:
        module = load(face)
        for name in getattr(module, "__all__", None) or [name for name in vars(module) if not name.startswith("_")]:
            thing = getattr(module, name)
            thing = inspect.unwrap(thing) if callable(thing) else thing
            if (inspect.isfunction(thing) or inspect.isclass(thing)) and thing.__module__.startswith("squealbox"):
                seen.setdefault(thing, f"{thing.__module__.split('.')[1]}: {name}")
    return {name: thing for thing, name in seen.items()}


def test_docstrings_keep_their_promise():
    judged = {name: owed(thing) for name, thing in public_things().items()}
    owing = {name for name, (owes, _) in judged.items() if owes}
    lacking = {name: lacks for name, (_, lacks) in judged.items() if lacks}
    assert len(owing) > 140
    said = "; ".join(f"{name}: {', '.join(lacks)}" for name, lacks in sorted(lacking.items()))
    assert not lacking, f"a unit for every number, a shape for every array, a source for every formula; missing: {said}"


def test_a_silent_number_array_and_formula_are_found():
    def plain(width: float, mass: float, low: float) -> Any:
        """A force that nobody knows.

        F = 3 width

        `mass` [kg] is known, and `low` in its own unit.
        """

    assert owed(plain) == (True, ["width has no unit", "what it returns has no shape", "its formula has no source"])
    assert not has_unit("in [0, 1)")
    assert not has_unit("a list [of words]")
    assert has_unit("speed [m, m/s]")
