"""Where the house stands, and a walk through its rooms, for the tests beside this file."""

import importlib
import pkgutil
from pathlib import Path

import squealbox

PROJECT = Path(__file__).resolve().parents[2]
PACKAGE = Path(squealbox.__file__).parent


def module_names() -> list[str]:
    """Every module of the package, by its dotted name."""
    walk = pkgutil.walk_packages([str(PACKAGE)], prefix="squealbox.")
    return ["squealbox", *sorted(found.name for found in walk)]


def public_module_names() -> list[str]:
    """The modules without a leading underscore in their path."""
    return [name for name in module_names() if not any(part.startswith("_") for part in name.split("."))]


def load(name: str):
    """The module of that name."""
    return importlib.import_module(name)
