"""The first loss of stability of many systems at once: `critical_value` for a design whose parameters are arrays."""

from collections.abc import Callable, Iterator
from typing import Any

import numpy as np

from squealbox.family import Bounds, Varied
from squealbox.stability.family import SteadyFamily
from squealbox.stability.scan import first_function
from squealbox.stability.spectra import largest_growth

BLOCK = 1 << 14  # systems computed together


def first_crossings(
    design: Any, parameter: Varied, bounds: Bounds | None = None, *, points: int = 65, time: float = 0.0
) -> Any:
    """The lowest value of `parameter` between `bounds` at which each system loses its stability.

    Parameters
    ----------
    design : a design with ``replace``; its other parameters may be arrays of shape (n,)
    parameter, bounds : {name: (low, high)} in the parameter's own unit; or the name and the bounds one after the other
    points : values looked at, equally spaced, before the crossing is solved for
    time : instant of schedules [s]

    Returns the values, shape (n,) (or () for one system), good to 1e-12 of the range: ``inf`` where sliding is stable
    at every value looked at, ``-inf`` where it is unstable at `low` already, NaN where nothing is known below the first
    unstable value. An unstable window narrower than (high - low)/(points - 1) may be missed; `critical_value` looks for
    such windows, one system at a time. Bad bounds are a `ParameterError`.

    >>> from squealbox.designs import ModeCoupling
    >>> first_crossings(ModeCoupling(k12=[1.0, 0.5]), "friction.static", (0.0, 3.0)).round(9).tolist()
    [1.0, 0.5]
    """
    family = SteadyFamily.within("first_crossings", design, parameter, bounds, time=time)
    if points < 3:
        raise ValueError(f"points = {points}: expected at least 3")
    (low, high), *_ = family.spans
    shape = _shape(family, low)
    rows = shape[0] if shape else 1
    growth = _growth(family, rows, np.linspace(low, high, 3))
    below, value_below = np.full(rows, low), growth(np.full(rows, low))
    above, value_above = np.full(rows, np.nan), np.full(rows, np.nan)
    found = np.where(value_below > 0.0, -np.inf, np.nan)
    open_ = ~(value_below > 0.0)
    for value, here in _along(growth, np.linspace(low, high, points)[1:], rows):
        crossed = open_ & (here > 0.0)
        above[crossed], value_above[crossed] = value, here[crossed]
        open_ &= ~crossed
        quiet = open_ & (here <= 0.0)
        below[quiet], value_below[quiet] = value, here[quiet]
        if not np.any(open_):
            break
    found[open_ & np.isfinite(value_below)] = np.inf
    bracketed = np.isfinite(value_above) & np.isfinite(value_below)
    if np.any(bracketed):
        found[bracketed] = _roots(growth, below, above, np.nonzero(bracketed)[0])
    return found if shape else found[0]


def _shape(family: SteadyFamily, low: float) -> tuple[int, ...]:
    shape: tuple[int, ...] = family.design.replace({family.parameters[0]: low}).system().shape
    if len(shape) > 1:
        raise ValueError(f"the design has leading axes {shape}: expected one axis at most")
    return shape


def _growth(family: SteadyFamily, rows: int, sample: np.ndarray) -> Callable[[Any], Any]:
    """The function that turns positive where stability is lost: of values (..., rows), one for each system.

    It is the largest growth rate by the quickest road, unless modes without damping call for another function.
    """
    smooth = first_function([family.at(np.full(rows, value)) for value in sample])

    def growth(values: np.ndarray) -> Any:
        steady = family.at(values)
        if smooth is not None:
            return smooth(steady)
        return largest_growth(steady)[0]

    return growth


def _along(growth: Callable[[Any], Any], values: np.ndarray, rows: int) -> Iterator[tuple[float, Any]]:
    """Each value with what `growth` gives there, several values in one batched call."""
    together = max(BLOCK // rows, 1)
    for start in range(0, values.size, together):
        some = values[start : start + together]
        yield from zip(some, growth(np.repeat(some[:, None], rows, axis=1)), strict=True)


def _roots(growth: Callable[[Any], Any], below: np.ndarray, above: np.ndarray, places: np.ndarray) -> Any:
    """Chandrupatla's method on all brackets together; systems that are done are computed along."""
    from scipy.optimize import elementwise

    def at(values: np.ndarray, rows: np.ndarray) -> Any:
        every = np.array(below)
        every[rows.astype(int)] = values
        return growth(every)[rows.astype(int)]

    bracket = (below[places], above[places])
    solved = elementwise.find_root(at, bracket, args=(places.astype(float),), tolerances={"xrtol": 1e-13, "fatol": 0.0})
    return solved.x
