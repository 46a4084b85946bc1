"""Cures and loops: ranked bars of what silences a brake, the detuning map of an absorber, poles of a closed loop."""

from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.control import ClosedLoop, LoopRun
from squealbox.countermeasures import BestAbsorber, Countermeasure
from squealbox.plots.brakes import brake_drawing
from squealbox.plots.dispatch import drawn_by
from squealbox.plots.style import COLUMN, drawing, figure_of, line, quantity_label, scaled
from squealbox.remedies import Remedies
from squealbox.system import as_system

if TYPE_CHECKING:
    from matplotlib.figure import Figure

MOST_BARS = 24


@drawn_by.register(Countermeasure)
def countermeasure_drawing(design: Countermeasure, *, axes: Any = None) -> "Figure":
    """The drawing of the brake that a countermeasure holds, with what is done to it written above."""
    layers: list[str] = []
    held: Any = design
    while isinstance(held, Countermeasure):
        layers.append(type(held).title.lower())
        held = held.brake
    figure = brake_drawing(held, axes=axes)
    panel = figure.axes[0] if axes is None else axes
    panel.set_title(" on ".join([*layers, "the brake"]), fontsize=8)
    return figure


@drawn_by.register(Remedies)
def remedies_figure(found: Remedies, *, title: str = "", axes: Any = None) -> "Figure":
    """The share of the lot that squeals with each cure, ranked, beside that without; hollow where no dose is enough."""
    count = min(len(found), MOST_BARS)
    with drawing(axes, width=1.8 * COLUMN, height=0.6 + 0.19 * count) as panel:
        places = np.arange(count)
        for place in places:
            look = {"facecolor": "#0072B2"} if found.reached[place] else {"facecolor": "white", "edgecolor": "#0072B2"}
            panel.barh(place, max(float(found.probability[place]), 1e-3), height=0.7, **look)
        panel.axvline(found.before, color="#D55E00", linewidth=1.0, label="without")
        panel.set_yticks(places, [str(name) for name in found.name[:count]], fontsize=6)
        panel.invert_yaxis()
        panel.set_xlim(0.0, 1.0)
        panel.set_xlabel("share of the lot that squeals")
        panel.set_title(title)
        panel.legend(loc="lower right", fontsize=6)
        return figure_of(panel)


@drawn_by.register(BestAbsorber)
def detuning_map(found: BestAbsorber, *, title: str = "", axes: Any = None) -> "Figure":
    """What was aimed for over tuning and damping of the absorber, with its best point and, of growth, the edge."""
    names = {"decay": ("growth rate", "1/s"), "margin": ("critical value", ""), "probability": ("P(squeal)", "")}
    with drawing(axes, width=1.5 * COLUMN, height=2.8) as panel:
        filled = panel.contourf(found.frequencies, 100.0 * found.dampings, found.growth_map.T, 15, cmap="viridis")
        panel.figure.colorbar(filled, ax=panel, label=quantity_label(*names[found.aim]))
        if found.aim == "decay" and np.min(found.growth_map) < 0.0 < np.max(found.growth_map):
            panel.contour(found.frequencies, 100.0 * found.dampings, found.growth_map.T, [0.0], colors="white")
        panel.plot(float(found.frequency), 100.0 * float(found.damping), "o", color="#D55E00", markersize=4)
        panel.set_yscale("log")
        panel.set(xlabel=quantity_label("tuning", "Hz"), ylabel=quantity_label("damping ratio", "%"), title=title)
        return figure_of(panel)


@drawn_by.register(ClosedLoop)
def poles_figure(found: ClosedLoop, *, title: str = "", axes: Any = None) -> "Figure":
    """Poles with the loops closed (dots) and without their forces (crosses), over growth rate and frequency."""
    with drawing(axes, width=1.4 * COLUMN, height=2.8) as panel:
        for values, mark, label in ((found.open_loop, "x", "open"), (found.poles, "o", "closed")):
            upper = values[values.imag >= 0.0]
            panel.plot(upper.real, upper.imag / (2.0 * np.pi), mark, markersize=4, label=label)
        panel.axvline(0.0, color="black", linewidth=0.6)
        panel.set(xlabel=quantity_label("growth rate", "1/s"), ylabel=quantity_label("frequency", "Hz"), title=title)
        panel.legend(loc="best", fontsize=6)
        return figure_of(panel)


@drawn_by.register(LoopRun)
def loop_run(found: LoopRun, *, title: str = "", axes: Any = None) -> "Figure":
    """Displacement of each freedom, and below the force of each loop, held until the next instant."""
    names = as_system(found.inputs["system"]).names
    second, clock = scaled("s", found.t)
    size, read = scaled("m", found.q)
    strength, unit = scaled("N", found.force)
    with drawing(axes, rows=2, width=1.5 * COLUMN, height=3.4, sharex=True) as (above, below):
        for i, name in enumerate(names):
            above.plot(found.t / second, found.q[:, i] / size, label=name, **line(i))
        for i in range(found.force.shape[1]):
            below.step(found.t / second, found.force[:, i] / strength, where="post", label=f"loop {i + 1}", **line(i))
        above.set(ylabel=quantity_label("displacement", read), title=title)
        below.set(xlabel=quantity_label("time", clock), ylabel=quantity_label("force", unit))
        below.set_xlim(found.t[0] / second, found.t[-1] / second)
        for panel in (above, below):
            panel.legend(loc="best", fontsize=6)
        return figure_of(above)
