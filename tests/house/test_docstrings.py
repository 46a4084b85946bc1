"""Every public thing says what it is."""

import inspect
import types

import pytest

from house.rooms import load, module_names

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
