"""Vectors and matrices from entries that may be numbers or arrays with leading axes."""

from typing import Any

import numpy as np

from squealbox.schedules import Schedule, as_schedule


def vector(*entries: Any) -> Any:
    """The entries as an array (..., n)."""
    return np.stack(np.broadcast_arrays(*entries), axis=-1)


def matrix(*rows: tuple[Any, ...]) -> Any:
    """The rows of entries as an array (..., n, m)."""
    flat = np.broadcast_arrays(*(entry for row in rows for entry in row))
    width = len(rows[0])
    return np.stack([np.stack(flat[i : i + width], axis=-1) for i in range(0, len(flat), width)], axis=-2)


def diagonal(*entries: Any) -> Any:
    """A diagonal matrix (..., n, n)."""
    return vector(*entries)[..., None] * np.eye(len(entries))


def outer(a: Any, b: Any) -> Any:
    """``a b'`` of arrays (..., n)."""
    return a[..., :, None] * b[..., None, :]


def column(value: Any) -> Any:
    """`value` with an axis behind its own, to multiply a vector."""
    return np.asarray(value, dtype=float)[..., None]


def block(value: Any) -> Any:
    """`value` with two axes behind its own, to multiply a matrix."""
    return np.asarray(value, dtype=float)[..., None, None]


def times(load: Any, direction: Any) -> Any:
    """A load, number or schedule, along a direction (..., n)."""
    return as_schedule(load) * direction if isinstance(load, Schedule) else column(load) * direction
