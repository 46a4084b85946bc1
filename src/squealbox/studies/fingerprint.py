"""What makes two studies the same: design, space, analysis, what is kept, seed and versions; and what changed."""

import dataclasses
import hashlib
import inspect
import re
from collections.abc import Callable, Iterator, Mapping
from typing import Any

import numpy as np

from squealbox.parameters import DataSheet, to_plain
from squealbox.result import provenance
from squealbox.studies.analysis import Task, plain_function
from squealbox.studies.refinement import Refined
from squealbox.studies.space import Space

MOST = 6  # differences said in full
_ADDRESS = re.compile(r" at 0x[0-9a-f]+")


def record(task: Task, space: Space) -> dict[str, Any]:
    """Everything the answers depend on, as plain data."""
    return {
        "design": plain(task.design),
        "space": described(space),
        "analysis": plain(task.analysis),
        "keep": list(task.keep),
        "units": dict(task.units),
        "seed": task.seed,
        "versions": provenance(),
    }


def described(space: Space) -> dict[str, Any]:
    """Names, lengths and ends of the axes, and a digest of all their values."""
    if isinstance(space, Refined):
        about = {"of": space.of, "level": space.level, "rounds": space.rounds}
        return {**described(space.base), "refined": about}
    axes = {}
    for axis in space.axes:
        for name, values in axis.values.items():
            words = values.dtype.kind == "U"
            ends = [str(v) for v in values[:8]] if words else [float(np.min(values)), float(np.max(values))]
            axes[name] = {"dimension": axis.dim, "points": len(values), "values" if words else "range": ends}
            axes[name]["digest"] = digest(values.astype(np.str_ if words else float).tobytes())
    return axes


def digest(data: bytes) -> str:
    """A short name of these bytes that no other bytes have."""
    return hashlib.sha256(data).hexdigest()[:32]


def plain(value: object) -> Any:
    """`value` as plain data; a function becomes its name, its settings and a digest of its source."""
    if isinstance(value, DataSheet):
        return to_plain(value)
    if callable(value) and not isinstance(value, type):
        return _function(value)
    if dataclasses.is_dataclass(value) and not isinstance(value, type):
        return {f.name: plain(getattr(value, f.name)) for f in dataclasses.fields(value)}
    if isinstance(value, np.ndarray):
        return value.tolist() if value.size <= 100 else f"{value.shape} {digest(value.tobytes())}"
    if isinstance(value, Mapping):
        return {str(key): plain(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [plain(item) for item in value]
    value = to_plain(value)
    return value if isinstance(value, (str, int, float, bool, type(None), list)) else _ADDRESS.sub("", repr(value))


def changes(old: Mapping[str, Any], new: Mapping[str, Any]) -> list[str]:
    """What differs, a phrase each: ``design.friction.slope was -0.05 and is -0.1``."""
    before, after = dict(_flat(old)), dict(_flat(new))
    found = [
        f"{name} was {_shown(before, name)} and is {_shown(after, name)}"
        for name in sorted(before.keys() | after.keys())
        if before.get(name, _ABSENT) != after.get(name, _ABSENT)
    ]
    return found if len(found) <= MOST else [*found[:MOST], f"and {len(found) - MOST} more"]


_ABSENT = object()


def _function(value: Any) -> dict[str, Any]:
    function = plain_function(value)
    settings: dict[str, Any] = {}
    if function is not value:
        settings = {**{f"argument {i}": plain(item) for i, item in enumerate(value.args)}, **plain(value.keywords)}
    name = getattr(function, "__qualname__", type(function).__name__)
    about = {"name": f"{getattr(function, '__module__', '')}.{name}", "source": _source(function)}
    return {**about, "settings": settings} if settings else about


def _source(function: Callable[..., Any], deep: bool = True) -> str:
    """A digest of the text of a function, of its defaults and of what it has closed over; not of what that calls."""
    try:
        text = inspect.getsource(function if inspect.isroutine(function) else type(function))
    except (OSError, TypeError):  # typed at a prompt: its code stands for its text
        code = getattr(function, "__code__", None)
        text = repr((code.co_code, [c for c in code.co_consts if not inspect.iscode(c)], code.co_names)) if code else ""
    if not deep:
        return digest(text.encode())
    more = [getattr(function, "__defaults__", None), getattr(function, "__kwdefaults__", None)]
    more += list(inspect.getclosurevars(function).nonlocals.items()) if inspect.isfunction(function) else []
    more += [] if inspect.isroutine(function) else list(getattr(function, "__dict__", {}).items())
    parts = [_source(item, deep=False) if inspect.isroutine(item) else item for pair in more for item in pair or ()]
    return digest(f"{text}{plain(parts)}".encode())


def _flat(value: object, prefix: str = "") -> Iterator[tuple[str, Any]]:
    if isinstance(value, Mapping):
        for name, item in value.items():
            yield from _flat(item, f"{prefix}.{name}" if prefix else str(name))
    else:
        yield prefix, value


def _shown(values: Mapping[str, Any], name: str) -> str:
    text = repr(values[name]) if name in values else "absent"
    return text if len(text) <= 60 else f"{text[:57]}..."
