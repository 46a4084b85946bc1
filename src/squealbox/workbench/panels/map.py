"""Stability over two parameters; the page draws the boundary where the growth rate passes zero."""

import numpy as np

from squealbox.designs import Design
from squealbox.stability import StabilityMap, stability_map
from squealbox.workbench.frames import finite
from squealbox.workbench.panels.panel import Answer, OptionError, Options, Work, axis_of

POINTS = 101


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Largest growth rate [1/s] on a grid, row by row from below; with ``show = "mechanism"`` also the mechanism."""
    across = options.parameter("x", design, "friction.static")
    up = options.parameter("y", design, "load", "load1", "sliding_speed", "theta1")
    if across == up:
        raise OptionError(f"x and y are both {across}: choose two different parameters")
    show = options.word("show", ("growth", "frequency", "mechanism"))
    spans = [options.span(name, design, parameter) for name, parameter in (("xspan", across), ("yspan", up))]
    points = int(options.number("points", POINTS, 11, 401))
    values = [np.linspace(*span, points) for span in spans]
    grid = stability_map(design, dict(zip((across, up), values, strict=True)), mechanism=show == "mechanism")
    axes = [axis_of(design, parameter) for parameter in (across, up)]
    data = {
        "x": axes[0],
        "y": axes[1],
        "xspan": [end / axes[0]["factor"] for end in spans[0]],
        "yspan": [end / axes[1]["factor"] for end in spans[1]],
        "show": show,
        "unstable": float(np.mean(grid.unstable[grid.exists])) if np.any(grid.exists) else None,
        "missing": int(np.sum(~grid.exists)),
        "largest": finite(np.nanmax(grid.growth_rate)) if np.any(grid.exists) else None,
        "mechanisms": list(StabilityMap.mechanism_names),
    }
    arrays = {"growth": grid.growth_rate.T}
    if show == "frequency":
        arrays["frequency"] = grid.frequency.T
    if show == "mechanism":
        arrays["mechanism"] = grid.mechanism.T
    return Answer(data, arrays)
