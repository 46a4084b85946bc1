"""What a folder of the package holds: a new law, design, panel or command is one file, and no list names it.

Classes are found by loading the folder's modules. What must be known before a module may be loaded (a panel's title, a
command's line of help) is read from its text, where it is assigned to one name.
"""

import ast
import importlib
import re
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType
from typing import Any, TypeVar

Kind = TypeVar("Kind")
WORDS = {"LuGre": "lugre"}  # what is written as one


def name_of(kind: type) -> str:
    """The name a file knows a class by: ``linear_slope`` for `LinearSlope`."""
    name = kind.__name__
    return WORDS.get(name) or re.sub(r"(?<=[a-z0-9])(?=[A-Z])", "_", name).lower()


def names_in(package: ModuleType) -> list[str]:
    """The modules of a package, by name."""
    return sorted(path.stem for path in Path(package.__path__[0]).glob("*.py") if path.stem != "__init__")


def face(package: str) -> tuple[Callable[[str], Any], Callable[[], list[str]], list[str]]:
    """``__getattr__, __dir__, __all__`` of a package whose names are listed in its ``__init__.pyi``.

    Each name is loaded when it is first used. Public are those in the list's `__all__`; what it imports besides is what
    neighbours may use.
    """
    room = sys.modules[package]
    places: dict[str, str] = {}
    public: list[str] = []
    for node in ast.parse(Path(str(room.__file__)).with_suffix(".pyi").read_text(encoding="utf-8")).body:
        if isinstance(node, ast.ImportFrom):
            module = f"{package}." * node.level + (node.module or "")
            places |= {each.name: module for each in node.names}
        elif isinstance(node, ast.Assign):
            public = ast.literal_eval(node.value)

    def __getattr__(name: str) -> Any:
        if name not in places:
            raise AttributeError(f"{package} has no {name!r}")
        place = places[name]
        whole = place.endswith(".")  # a room of the front door
        found = importlib.import_module(place + name) if whole else getattr(importlib.import_module(place), name)
        setattr(room, name, found)
        return found

    return __getattr__, lambda: list(public), public


def later(package: str, name: str) -> Callable[..., Any]:
    """The function of that name in the module of that name, which is loaded when it is called."""

    def function(*arguments: Any, **options: Any) -> Any:
        return getattr(importlib.import_module(f"{package}.{name}"), name)(*arguments, **options)

    return function


def assigned(folder: Path, word: str) -> dict[str, str]:
    """The text of what each module of a folder assigns to `word` at its left margin, by the module's name."""
    form = re.compile(rf"^{word} = (.+(?:\n[ )}}\]].*)*)", re.MULTILINE)
    texts = {path.stem: form.search(path.read_text(encoding="utf-8")) for path in sorted(folder.glob("*.py"))}
    return {name: found[1] for name, found in texts.items() if found}


def kinds_in(package: str, base: type[Kind], first: tuple[type[Kind], ...], having: str) -> tuple[type[Kind], ...]:
    """The subclasses of `base` with the attribute `having` in the modules of a package, behind those in `first`."""
    modules = [importlib.import_module(f"{package}.{name}") for name in names_in(importlib.import_module(package))]
    found = [kind for module in modules for kind in vars(module).values()
             if isinstance(kind, type) and kind.__module__ == module.__name__]  # fmt: skip
    more = [kind for kind in found if issubclass(kind, base) and hasattr(kind, having) and kind not in first]
    return (*first, *more)


def load_kind(kind: str) -> Any:
    """What a module of this package calls `kind`, loaded; None for the name of no such thing, for the caller to refuse.

    A file names a class by its place in the package. Its module may not have been needed yet, or be called otherwise
    today: then the face of its room knows it. Nothing outside the package is ever loaded.
    """
    if re.fullmatch(r"[a-z_]+(\.[a-z0-9_]+)*\.[A-Za-z0-9]+", kind):
        room, *modules, name = kind.split(".")
        for module in (".".join(("squealbox", room, *modules)), f"squealbox.{room}"):
            try:
                if found := getattr(importlib.import_module(module), name, None):
                    return found
            except ModuleNotFoundError as error:
                if not module.startswith(str(error.name)):
                    raise  # a module of the package that lacks one of its own dependencies
    return None
