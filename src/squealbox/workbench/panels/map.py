"""Stability over two parameters; the page draws the boundary where the growth rate passes zero."""

import numpy as np

from squealbox.designs import Design
from squealbox.stability import StabilityMap, stability_map
from squealbox.workbench.frames import finite
from squealbox.workbench.panels.panel import Answer, OptionError, Options, Work, axis_of

POINTS = 101
FEWER = 51  # along each axis, for designs of more than two degrees of freedom
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
    points = int(options.number("points", FEWER if few else POINTS, 11, 401))
    values = [np.linspace(*span, points) for span in spans]
    parts = []
    for i, block in enumerate(np.array_split(values[0], BLOCKS if few or show == "mechanism" else 1)):
        work.progress(i / BLOCKS, "computing the map")
        parts.append(
            stability_map(design, {across: block, up: values[1]}, mechanism=show == "mechanism", engine="compiled")
        )
    growth, frequency, why, unstable = (
        np.concatenate([getattr(part, name) for part in parts])
        for name in ("growth_rate", "frequency", "mechanism", "unstable")
    )
    exists = np.isfinite(growth)
    read = [axis_of(design, parameter) for parameter in (across, up)]
    data = {
        "x": read[0],
        "y": read[1],
        "xspan": [end / read[0]["factor"] for end in spans[0]],
        "yspan": [end / read[1]["factor"] for end in spans[1]],
        "show": show,
        "unstable": float(np.mean(unstable[exists])) if np.any(exists) else None,
        "missing": int(np.sum(~exists)),
        "largest": finite(np.nanmax(growth)) if np.any(exists) else None,
        "mechanisms": list(StabilityMap.mechanism_names),
    }
    arrays = {"growth": growth.T}
    if show == "frequency":
        arrays["frequency"] = frequency.T
    if show == "mechanism":
        arrays["mechanism"] = why.T
    return Answer(data, arrays)
