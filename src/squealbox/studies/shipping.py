"""A task as bytes for another process of the same user: on this machine, or on a cluster. Never in a file."""

import functools
import importlib.util
import pickle
import sys
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

from squealbox.studies.analysis import StudyError, Task, plain_function


def packed(task: Task) -> bytes:
    """The task; functions typed in a script or notebook travel with their code.

    Raises `StudyError` for what cannot travel, such as an open file an analysis has closed over.
    """
    try:
        import cloudpickle
    except ModuleNotFoundError as error:
        text = "worker processes need the package cloudpickle: pip install 'squealbox[studies]'"
        raise StudyError(text) from error
    try:
        with _with_code(task.design, task.analysis):
            data: bytes = cloudpickle.dumps(task)
            return data
    except (pickle.PicklingError, TypeError, AttributeError) as error:
        raise StudyError(f"the analysis cannot be sent to another process: {error}") from error


@functools.lru_cache(4)
def unpacked(data: bytes) -> Task:
    """The inverse of `packed`; kept, because every piece of a study on a cluster brings its task along."""
    task: Task = pickle.loads(data)
    return task


@contextmanager
def _with_code(*things: Any) -> Iterator[None]:
    """While it lasts, functions of modules that another process could not import travel with their code."""
    import cloudpickle

    modules = []
    for thing in things:
        name = getattr(plain_function(thing), "__module__", None) or "builtins"
        if name in sys.modules and name != "__main__" and not _importable(name):
            modules.append(sys.modules[name])
    for module in modules:
        cloudpickle.register_pickle_by_value(module)
    try:
        yield
    finally:
        for module in modules:
            cloudpickle.unregister_pickle_by_value(module)


def _importable(name: str) -> bool:
    kept = sys.modules.pop(name, None)
    try:
        return importlib.util.find_spec(name) is not None
    except (ImportError, ValueError):
        return False
    finally:
        if kept is not None:
            sys.modules[name] = kept
