"""Vectors and matrices from entries that may be numbers or arrays with leading axes."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.schedules import Schedule, as_schedule


def vector(*entries: Any) -> Any:
    """The entries as an array (..., n)."""
    made = np.empty((*np.broadcast(*entries).shape, len(entries)), dtype=np.result_type(*entries))
    for i, entry in enumerate(entries):
        made[..., i] = entry
    return made


def matrix(*rows: tuple[Any, ...]) -> Any:
    """The rows of entries as an array (..., n, m)."""
    flat = vector(*(entry for row in rows for entry in row))
    return flat.reshape(*flat.shape[:-1], len(rows), len(rows[0]))


def diagonal(*entries: Any) -> Any:
    """A diagonal matrix (..., n, n)."""
    return vector(*entries)[..., None] * np.eye(len(entries))


def outer(a: np.ndarray, b: np.ndarray) -> Any:
    """``a b'`` of arrays (..., n)."""
    return a[..., :, None] * b[..., None, :]


def column(value: ArrayLike) -> Any:
    """`value` with an axis behind its own, to multiply a vector."""
    return np.asarray(value, dtype=float)[..., None]


def block(value: ArrayLike) -> Any:
    """`value` with two axes behind its own, to multiply a matrix."""
    return np.asarray(value, dtype=float)[..., None, None]


def times(load: float | np.ndarray | Schedule, direction: np.ndarray) -> Any:
    """A load, number or schedule, along a direction (..., n)."""
    return as_schedule(load) * direction if isinstance(load, Schedule) else column(load) * direction
