"""Stability over two parameters, with the boundary exact on every line of the grid."""

from dataclasses import replace
from typing import Any

import numpy as np

from squealbox.designs import Design
from squealbox.fe.reduced_brake import ReducedBrake
from squealbox.stability import Boundary, StabilityMap, map_boundary, stability_map
from squealbox.workbench.frames import finite
from squealbox.workbench.panels.panel import Answer, OptionError, Options, Work, axis_of

POINTS = 101
FEWER = 51  # along each axis, for designs of more than two degrees of freedom
FEWEST = 11  # the same of reduced brakes, with a spectrum of its own for each point
CLOSE = 1e-5  # of a cell, a hundredth of that of the axis: numbers travel with seven digits
BLOCKS = 8  # parts of a map between which it can be stopped


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Largest growth rate [1/s] on a grid, row by row from below; with ``show = "mechanism"`` also the mechanism."""
    across = options.parameter("x", design, "friction.static")
    up = options.parameter("y", design, "load", "load1", "sliding_speed", "theta1")
    if across == up:
        raise OptionError(f"x and y are both {across}: choose two different parameters")
    show = options.word("show", ("growth", "frequency", "mechanism"))
    spans = [options.span(name, design, parameter) for name, parameter in (("xspan", across), ("yspan", up))]
    few = design.system().size > 2
    usual = FEWEST if isinstance(design, ReducedBrake) else FEWER if few else POINTS
    points = int(options.number("points", usual, FEWEST, 401))
    values = [np.linspace(*span, points) for span in spans]
    parts, text = [], "computing the map"
    for i, block in enumerate(np.array_split(values[0], BLOCKS if few or show == "mechanism" else 1)):
        work.progress(i / BLOCKS, text)
        parts.append(
            stability_map(design, {across: block, up: values[1]}, mechanism=show == "mechanism", engine="compiled")
        )
    found = _joined(parts, {across: values[0], up: values[1]})
    work.progress(0.95, "locating the boundary")
    edge = map_boundary(found, close=CLOSE)
    growth, exists = found.growth_rate, np.isfinite(found.growth_rate)
    read = [axis_of(design, parameter) for parameter in (across, up)]
    data = {
        "x": read[0],
        "y": read[1],
        "xspan": [end / read[0]["factor"] for end in spans[0]],
        "yspan": [end / read[1]["factor"] for end in spans[1]],
        "show": show,
        "unstable": float(np.mean(found.unstable[exists])) if np.any(exists) else None,
        "missing": int(np.sum(~exists)),
        "largest": finite(np.nanmax(growth)) if np.any(exists) else None,
        "mechanisms": list(StabilityMap.mechanism_names),
    }
    arrays = {"growth": growth.T, "edge": _scaled(edge, read), "curve": edge.curve}
    if show == "frequency":
        arrays["frequency"] = found.frequency.T
    if show == "mechanism":
        arrays["mechanism"] = found.mechanism.T
    return Answer(data, arrays)


def _joined(parts: list[StabilityMap], axes: dict[str, Any]) -> StabilityMap:
    """The blocks of a map, one after the other along its first axis."""
    names = ("growth_rate", "frequency", "circulation", "slope", "unstable_modes", "mechanism")
    arrays: dict[str, Any] = {name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
    return replace(parts[0], axes=axes, **arrays)


def _scaled(edge: Boundary, read: list[dict[str, Any]]) -> Any:
    """Points of the boundary (points, 2) in the units of the axes."""
    return np.column_stack([edge.x / read[0]["factor"], edge.y / read[1]["factor"]])
