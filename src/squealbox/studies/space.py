"""Which points a study visits: grids, lists side by side, samples, and products of them.

A space is a product of axes. An axis is one or more parameters that change together: a grid has one parameter on each
axis, lists side by side and samples have several on one. Points are counted with the last axis fastest, and only the
axes lie in memory, so a grid of a billion points costs what its axes cost.
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Protocol

import numpy as np

from squealbox.family import values_of
from squealbox.parameters import ParameterError
from squealbox.scatter import Sampling, unit_points

POINT = "point"  # the dimension of an axis with several parameters


class JointDistribution(Protocol):
    """Anything with a joint distribution: `squealbox.studies.Scatter`, or the user's own."""

    def sample(self, count: int, method: Any, seed: int) -> Mapping[str, Any]:
        """`count` values of each parameter by its dotted name."""


@dataclass(frozen=True, eq=False)
class Axis:
    """Parameters that change together: dotted names to arrays (length,), along the dimension `dim`."""

    dim: str
    values: Mapping[str, Any]

    def __len__(self) -> int:
        return len(next(iter(self.values.values())))


class Space:
    """A product of axes, made by `grid`, `zipped`, `latin_hypercube`, `sobol_sequence` or `sampled`; `*` multiplies.

    Raises `ParameterError` for an empty axis, values that are neither finite numbers nor words, or a name given twice.

    >>> space = grid({"friction.static": [0.3, 0.4], "load": [1e3, 2e3, 3e3]})
    >>> space.shape, space.names, len(space)
    ((2, 3), ('friction.static', 'load'), 6)
    >>> space.points(1, 3)["load"].tolist()
    [2000.0, 3000.0]
    """

    def __init__(self, axes: Iterable[Axis]) -> None:
        self.axes = tuple(axes)
        if not self.axes:
            raise ParameterError("space", "axes", [], "at least one parameter to vary")
        names, dims = list(self.names), [axis.dim for axis in self.axes]
        for kind, given in (("parameter", names), ("dimension", dims)):
            twice = sorted({name for name in given if given.count(name) > 1})
            if twice:
                raise ParameterError("space", kind, twice[0], f"each {kind} once")

    @property
    def names(self) -> tuple[str, ...]:
        """Dotted names of the parameters, in order."""
        return tuple(name for axis in self.axes for name in axis.values)

    @property
    def dims(self) -> tuple[str, ...]:
        """One dimension for each axis."""
        return tuple(axis.dim for axis in self.axes)

    @property
    def shape(self) -> tuple[int, ...]:
        """Length of each axis."""
        return tuple(len(axis) for axis in self.axes)

    def __len__(self) -> int:
        return int(np.prod(self.shape, dtype=np.int64))

    def __mul__(self, other: "Space") -> "Space":
        return Space([*self.axes, *other.axes])

    def fresh(self) -> "Space":
        """The space as it is before a sweep; only a refined one changes in it."""
        return self

    def grow(self, blocks: Any) -> bool:
        """Add points that follow from the answers so far; False, since this space has all its points."""
        return False

    def points(self, start: int, stop: int) -> dict[str, Any]:
        """Values of each parameter at the points start, ..., stop - 1, arrays (stop - start,)."""
        places = np.unravel_index(np.arange(start, stop), self.shape)
        return {
            name: values[place] for axis, place in zip(self.axes, places, strict=True)
            for name, values in axis.values.items()
        }  # fmt: skip

    def coordinates(self) -> dict[str, tuple[str, Any]]:
        """Name to (dimension, values) for each parameter."""
        return {name: (axis.dim, values) for axis in self.axes for name, values in axis.values.items()}

    def __repr__(self) -> str:
        parts = (" and ".join(axis.values) + f" ({len(axis)})" for axis in self.axes)
        return f"{len(self)} points: {' x '.join(parts)}"


def grid(axes: Mapping[str, Any]) -> Space:
    """Every combination of the values given for each dotted name; numbers, or words such as readings.

    A logarithmic range is ``numpy.geomspace(low, high, points)``.

    >>> grid({"load": np.geomspace(1e2, 1e4, 3), "reading": ["eq3", "consistent"]})
    6 points: load (3) x reading (2)
    """
    return Space(Axis(name, {name: _checked(name, values)}) for name, values in axes.items())


def zipped(lists: Mapping[str, Any], dim: str = POINT) -> Space:
    """Lists of equal length side by side: the k-th point takes the k-th value of each.

    >>> zipped({"load": [1e3, 2e3], "sliding_speed": [0.1, 0.2]})
    2 points: load and sliding_speed (2)
    """
    columns = {name: _checked(name, values) for name, values in lists.items()}
    lengths = {name: len(values) for name, values in columns.items()}
    if len(set(lengths.values())) > 1:
        raise ParameterError("space", "zipped", lengths, "lists of equal length")
    return Space([Axis(dim, columns)] if columns else [])


def latin_hypercube(ranges: Mapping[str, Any], count: int, *, seed: int = 0, dim: str = POINT) -> Space:
    """`count` points that hit each of `count` equal slices of every range once (McKay, Beckman, Conover 1979).

    ranges maps dotted names to (low, high), or to (low, high, "log") for slices equal in the logarithm.
    A seed gives the same sample again.

    >>> latin_hypercube({"friction.static": (0.2, 0.5), "load": (1e2, 1e4, "log")}, 64)
    64 points: friction.static and load (64)
    """
    return _within(ranges, count, "latin_hypercube", seed, dim)


def sobol_sequence(ranges: Mapping[str, Any], count: int, *, seed: int = 0, dim: str = POINT) -> Space:
    """`count` points of the scrambled Sobol' sequence (Owen 1998), more even than chance; best with a power of two.

    Arguments as for `latin_hypercube`. Other counts than a power of two take the first points of the next one.

    >>> sobol_sequence({"friction.static": (0.2, 0.5), "load": (1e3, 2e3)}, 128)
    128 points: friction.static and load (128)
    """
    return _within(ranges, count, "sobol", seed, dim)


def sampled(scatter: JointDistribution, count: int, *, method: str = "sobol", seed: int = 0, dim: str = POINT) -> Space:
    """`count` points of a joint distribution, correlations included; "latin_hypercube", "sobol" or "random".

    `scatter` is a `squealbox.studies.Scatter`, or anything else with ``sample(count, method, seed)`` that returns the
    values by dotted name.

    >>> from squealbox.studies import Normal, Scatter
    >>> sampled(Scatter({"load": Normal(1e3, 50.0)}), 16)
    16 points: load (16)
    """
    return zipped(scatter.sample(count, method, seed), dim)


def as_space(space: Space | Mapping[str, Any]) -> Space:
    """A mapping of dotted names to values as the grid it stands for; a `Space` as it is."""
    if isinstance(space, Mapping):
        return grid(space)
    if not isinstance(space, Space):
        raise ParameterError("sweep", "space", space, "a mapping of dotted names to values, or a Space")
    return space


def _within(ranges: Mapping[str, Any], count: int, method: Sampling, seed: int, dim: str) -> Space:
    ends = {name: _range(name, given) for name, given in ranges.items()}
    unit = unit_points(count, len(ends), method, np.random.default_rng(seed)) if ends else np.zeros((0, 0))
    columns = {}
    for (name, (low, high, log)), column in zip(ends.items(), unit.T, strict=True):
        columns[name] = low * (high / low) ** column if log else low + (high - low) * column
    return zipped(columns, dim)


def _range(name: str, given: Sequence[Any]) -> tuple[float, float, bool]:
    log = len(given) == 3 and given[2] == "log"
    expected = '(low, high) or (low, high, "log"), low < high' + (", both positive" if log else "")
    if len(given) != 2 and not log:
        raise ParameterError("space", name, given, expected)
    low, high = (float(x) for x in given[:2])
    if not (np.isfinite(low) and np.isfinite(high) and low < high) or (log and low <= 0.0):
        raise ParameterError("space", name, given, expected)
    return low, high, log


def _checked(name: str, values: Any) -> Any:
    array = values_of("space", name, values, words=True)
    array.flags.writeable = False
    return array
