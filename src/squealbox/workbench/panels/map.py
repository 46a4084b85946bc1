"""Stability over two parameters, with the boundary exact on every line of the grid."""

from dataclasses import replace
from typing import Any

import numpy as np

from squealbox.design import Design
from squealbox.fe import ReducedBrake
from squealbox.figure_data import FigureData, heat, path
from squealbox.stability import StabilityMap, map_boundary, stability_map
from squealbox.words import number
from squealbox.workbench.panels.declared import FRICTION, LOADS, Panel, Place, over, words
from squealbox.workbench.panels.panel import Answer, OptionError, Options, Work

PANEL = Panel(
    "Stability map", questions=("when",), slow=True, along=True, figures=(Place("map", "", 300),),
    choices=(over("x", "x", FRICTION, span="xspan"), over("y", "y", *LOADS, span="yspan"),
             words("show", "show", ("growth", "growth rate"), ("frequency", "frequency"), ("mechanism", "mechanism"))),
)  # fmt: skip

POINTS = 101
FEWER = 51  # along each axis, for designs of more than two degrees of freedom
FEWEST = 11  # the same of reduced brakes, with a spectrum of its own for each point
CLOSE = 1e-5  # of a cell, a hundredth of that of the axis: numbers travel with seven digits
BLOCKS = 8  # parts of a map between which it can be stopped


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Largest growth rate [1/s] on a grid, row by row from below; with ``show = "mechanism"`` also the mechanism."""
    (across, *spans), (up, *more) = (options.over(design, each) for each in PANEL.choices[:2])
    if across == up:
        raise OptionError(f"x and y are both {across}: choose two different parameters")
    show = options.chosen(*PANEL.choices)["show"]
    spans += more
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
    axes = [options.axis(design, each, ends) for each, ends in zip((across, up), spans, strict=True)]
    exists = np.isfinite(found.growth_rate)
    unstable = float(np.mean(found.unstable[exists])) if np.any(exists) else None
    missing = int(np.sum(~exists))
    words = (
        "no steady sliding anywhere"
        if unstable is None
        else f"{number(100.0 * unstable, 3)} % of the plane is unstable"
    )
    data = {
        "words": f"{words}; {missing} points have no steady sliding" if missing else words,
        "marks": {"unstable": unstable},
    }
    rings = [np.column_stack([edge.x[edge.curve == i] / axes[0].factor, edge.y[edge.curve == i] / axes[1].factor])
             for i in np.unique(edge.curve)]  # fmt: skip
    figure = FigureData("map", axes[0], axes[1], [path(rings, "boundary")], heat=_picture(found, show))
    return Answer(data, figures=[figure])


def _picture(found: StabilityMap, show: str) -> dict[str, Any]:
    if show == "mechanism":
        names = [name.replace("_", " ") for name in StabilityMap.mechanism_names]
        return heat(found.mechanism.T, "mechanism", "mechanism", "", names=names)
    if show == "frequency":
        return heat(found.frequency.T, "sequential", "frequency", "Hz")
    return heat(found.growth_rate.T, "diverging", "growth rate", "1/s", words="orange squeals, blue is quiet")


def _joined(parts: list[StabilityMap], axes: dict[str, Any]) -> StabilityMap:
    """The blocks of a map, one after the other along its first axis."""
    names = ("growth_rate", "frequency", "circulation", "slope", "unstable_modes", "mechanism")
    arrays: dict[str, Any] = {name: np.concatenate([getattr(part, name) for part in parts]) for name in names}
    return replace(parts[0], axes=axes, **arrays)
