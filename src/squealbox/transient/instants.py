"""The instants at which a motion is wanted."""

from typing import Any

import numpy as np

from squealbox.arguments import whole
from squealbox.parameters import ParameterError

DIGITS = 15  # that a number has for certain


def instants_of(function: str, times: Any, start_time: float, duration: float, *, one: bool = False) -> Any:
    """The instants asked of a public function, shape (k,): None, a whole number of equal ones, or increasing ones.

    A float is `one` instant where that is allowed.
    """
    if times is None:
        return None
    end = start_time + duration
    if np.ndim(times) == 0 and not (one and isinstance(times, float)):
        if expected := whole(2)(times):
            raise ParameterError(function, "times", times, f"{expected}, or an array of instants")
        return equal_instants(start_time, end, int(times))
    instants = np.atleast_1d(np.asarray(times, dtype=float))
    inside = np.all((instants >= start_time) & (instants <= end + 1e-12 * abs(end)))
    if instants.ndim != 1 or not instants.size or not inside or np.any(np.diff(instants) < 0.0):
        expected = f"one or more increasing instants within [{start_time:g}, {end:g}] s"
        raise ParameterError(function, "times", times, expected)
    return np.minimum(instants, end)


def equal_instants(begin: float, end: float, count: int) -> Any:
    """`count` equidistant instants from begin to end, to the digits a decimal has: 0.03, not 0.030000000000000002.

    So ``dataset.sel(time=0.03)`` finds them.

    >>> 0.03 in equal_instants(0.0, 0.1, 1001)
    True
    """
    instants = np.linspace(begin, end, count)
    largest = max(abs(begin), abs(end))
    decimals = DIGITS - int(np.ceil(np.log10(largest))) if largest > 0.0 else 0
    if 0 < decimals <= 22:
        instants[1:-1] = np.round(instants[1:-1], decimals)
    return instants
