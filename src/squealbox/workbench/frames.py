"""What goes over the wire: one JSON text up, one binary frame down, a header in JSON followed by float32 arrays.

    length of the header (uint32, little endian) | header, padded to a multiple of 4 | arrays, one after the other

The header names each array with its shape, so the page reads the numbers where they lie, without parsing them.
"""

import json
import math
import struct
from collections.abc import Mapping
from typing import Any

import numpy as np


def frame(header: Mapping[str, Any], arrays: Mapping[str, Any] | None = None) -> bytes:
    """One binary frame; arrays of any shape become float32 in C order.

    >>> len(frame({"id": 1}, {"x": [0.0, 1.0]})) % 4
    0
    """
    with np.errstate(over="ignore"):  # beyond the range of float32 is infinity, which no figure draws
        blocks = {name: np.ascontiguousarray(array, dtype="<f4") for name, array in (arrays or {}).items()}
    named = [[name, list(block.shape)] for name, block in blocks.items()]
    text = json.dumps(
        {**_known(header), "arrays": named}, allow_nan=False, default=_number, separators=(",", ":")
    ).encode()
    text += b" " * (-len(text) % 4)
    return b"".join([struct.pack("<I", len(text)), text, *(block.tobytes() for block in blocks.values())])


def unframed(data: bytes) -> tuple[dict[str, Any], dict[str, Any]]:
    """The header and the arrays of a frame: what the page does, for tests and for clients in Python."""
    (length,) = struct.unpack_from("<I", data)
    header = json.loads(data[4 : 4 + length])
    arrays, at = {}, 4 + length
    for name, shape in header.pop("arrays"):
        size = int(np.prod(shape))
        arrays[name] = np.frombuffer(data, "<f4", size, at).reshape(shape)
        at += 4 * size
    return header, arrays


def _known(value: Any) -> Any:
    """Plain data without NaN and infinity, which JSON does not know: they become null, as in `finite`."""
    if isinstance(value, Mapping):
        return {name: _known(item) for name, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_known(item) for item in value]
    return None if isinstance(value, float) and not math.isfinite(value) else value


def _number(value: Any) -> Any:
    """A number of NumPy as JSON knows it."""
    if isinstance(value, np.generic):
        return _known(value.item())
    raise TypeError(f"a header cannot hold a {type(value).__name__}")


def finite(value: Any) -> float | None:
    """A number for a header: JSON has no NaN, so what is not finite is None."""
    number = float(value)
    return number if np.isfinite(number) else None
