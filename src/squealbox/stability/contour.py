"""The boundary of a map that has been computed: each crossing of a line of its grid, located exactly.

The grid says which of its edges the boundary crosses and how the crossings follow each other (marching squares, by
contourpy). Each crossing is then a root of the largest growth rate on its edge, and all of them are solved together by
Chandrupatla's method (SciPy), a dozen evaluations of some hundred points. So the points lie on the boundary as those of
`boundary.stability_boundary` do, in about a tenth of its time on the drum; between them the curve is drawn straight
across a cell.
"""

from typing import Any

import numpy as np

from squealbox.result import Outcome
from squealbox.stability.boundary import Boundary
from squealbox.stability.family import SteadyFamily
from squealbox.stability.in_band import largest_in_band
from squealbox.stability.maps import CHUNK, StabilityMap
from squealbox.stability.spectra import Engine, largest_growth
from squealbox.system import DesignOrSystem

NOTHING = 1e-13  # of the spectrum: the growth rate of an undamped mode, told from zero


def map_boundary(
    found: StabilityMap, *, design: DesignOrSystem | None = None, close: float = 1e-13, engine: Engine = "compiled"
) -> Boundary:
    """Curves on which stability changes, read off a map over two parameters and made exact on the lines of its grid.

    Parameters
    ----------
    found : the map, over two parameters with at least two values each
    design : what it was computed for, where that was a function: a map does not keep functions
    close : [-] share of a cell within which a crossing is located
    engine : as of :func:`stability_map`

    Returns
    -------
    Boundary. The unstable side is on the left of its curves. The outcome is "no_boundary" where all points of the map
    are alike. Raises `ValueError` for a map over another number of parameters, or without its design.

    Accuracy: a point lies within `close` of a cell's side on the boundary, or as near as the round-off of the growth
    rate lets it. What is narrower than a cell and touches no node of the grid is not seen; `stability_boundary` looks
    for it. Two curves that pass the same cell may be joined the other way.

    >>> from squealbox import DrumBrake
    >>> from squealbox.stability import stability_map
    >>> axes = {"friction.static": np.linspace(0.1, 0.6, 11), "load": np.linspace(500.0, 2000.0, 9)}
    >>> edge = map_boundary(stability_map(DrumBrake(), axes, mechanism=False))
    >>> len(edge.curves), bool(np.max(np.abs(edge.growth_rate)) < 1e-6)
    (1, True)
    """
    made = found.inputs["system"] if design is None else design
    if len(found.axes) != 2 or min(np.size(values) for values in found.axes.values()) < 2:
        raise ValueError(f"the map has the axes {list(found.axes)}: expected two, with two or more values each")
    if made is None:
        raise ValueError("the map was computed for a function, which it does not keep: give it as `design`")
    family = SteadyFamily(made, found.axes, time=found.inputs["time"])
    lines = _lines(found)
    nodes = np.concatenate(lines or [np.zeros((0, 2))])
    points, growth, omega = _exact(family, list(found.axes.values()), nodes, close, engine)
    number = np.repeat(np.arange(len(lines)), [len(line) for line in lines])
    known = np.all(np.isfinite(points), axis=-1)
    outcome = (
        Outcome() if np.any(known) else Outcome("no_boundary", "stability does not change between the map's points")
    )
    return Boundary(
        x=points[known, 0],
        y=points[known, 1],
        curve=_renumbered(number, known),
        growth_rate=growth[known],
        frequency=omega[known] / (2.0 * np.pi),
        parameters=family.parameters,
        inputs=family.inputs,
        settings={"grid": [int(np.size(values)) for values in found.axes.values()], "close": close},
        outcome=outcome,
    )


def _lines(found: StabilityMap) -> list[Any]:
    """Curves through crossed edges, in indices of the grid; a crossing lies in the middle third of its edge."""
    from contourpy import contour_generator

    growth, unstable = found.growth_rate.T, np.asarray(found.unstable).T
    known = np.isfinite(growth)
    if not np.any(known):
        return []
    size = np.abs(growth) / max(float(np.max(np.abs(growth[known]))), 1e-300)
    level = np.where(unstable, 1.0, -1.0) * (1.0 + np.where(known, size, 0.0))
    lines: Any = contour_generator(z=np.ma.array(level, mask=~known), name="serial").lines(0.0)
    return [np.asarray(line) for line in lines]


def _exact(
    family: SteadyFamily, axes: list[Any], nodes: np.ndarray, close: float, engine: Engine
) -> tuple[Any, Any, Any]:
    """The points on the boundary for crossings given in indices, with growth rate and angular frequency there."""
    from scipy.optimize import elementwise

    if len(nodes) == 0:
        return np.zeros((0, 2)), np.zeros(0), np.zeros(0)
    low = np.floor(nodes + 1e-6).astype(int)
    crossed = nodes - low > 1e-3  # along which axis the edge runs
    ends = [
        np.stack([np.asarray(axis)[low[:, i] + add * crossed[:, i]] for i, axis in enumerate(axes)]) for add in (0, 1)
    ]
    first, way = ends[0], ends[1] - ends[0]

    def level(share: np.ndarray, i: np.ndarray) -> Any:
        place = first[:, i] + share * way[:, i]
        growth, omega, growing = _growth(family, place.reshape(2, -1), engine)
        least = -NOTHING * np.maximum(np.hypot(growth, omega), 1.0)
        return np.where(growing > 0, growth, np.minimum(growth, least)).reshape(np.shape(share))

    index = np.arange(len(nodes))
    tolerances = {"xatol": close, "xrtol": 0.0, "fatol": 0.0, "frtol": 0.0}
    found = elementwise.find_root(
        level, (np.zeros(len(nodes)), np.ones(len(nodes))), args=(index,), tolerances=tolerances
    )
    share = found.x
    if family.band is not None:  # located roughly: where the mode grows, its frequency is the largest growth rate's
        share = np.where(found.f_bracket[1] > 0.0, found.bracket[1], found.bracket[0])
    points = (first + np.where(found.success, share, np.nan) * way).T
    growth, omega, _ = _growth(family, points.T, engine)
    return points, growth, omega


def _growth(family: SteadyFamily, place: np.ndarray, engine: Engine) -> tuple[Any, Any, Any]:
    """Largest growth rate, angular frequency and growing modes at points (2, k); NaN where a point is unknown."""
    known = np.all(np.isfinite(place), axis=0)
    if family.band is not None:
        return largest_in_band(family, *place)
    parts = [np.full(len(known), np.nan), np.full(len(known), np.nan), np.zeros(len(known), dtype=np.int64)]
    which = np.nonzero(known)[0]
    for start in range(0, len(which), CHUNK):
        part = which[start : start + CHUNK]
        for array, values in zip(parts, largest_growth(family.at(*place[:, part]), engine), strict=True):
            array[part] = values
    return parts[0], parts[1], parts[2]


def _renumbered(number: np.ndarray, known: np.ndarray) -> Any:
    """Numbers of curves without gaps; a curve is cut where a point in its middle is unknown."""
    cut = np.cumsum(~known)
    _, fresh = np.unique(np.stack([number, cut])[:, known], axis=1, return_inverse=True)
    return np.asarray(fresh).ravel()
