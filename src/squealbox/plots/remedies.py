"""Cures and loops: ranked bars of what silences a brake, the detuning map of an absorber, poles of a closed loop."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.control import ClosedLoop, DefeatingPush, LoopRun, Placement, StableGains
from squealbox.countermeasures import BestAbsorber, Countermeasure
from squealbox.plots.brakes import brake_drawing
from squealbox.plots.dispatch import drawn_by
from squealbox.plots.style import COLUMN, drawing, figure_of, line
from squealbox.remedies import Remedies
from squealbox.system import as_system
from squealbox.words import quantity_label, scaled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squealbox.plots.style import Panels

MOST_BARS = 24
ALL = 0.995  # share of a lot that is all of it


@drawn_by.register(Countermeasure)
def countermeasure_drawing(design: Countermeasure, *, axes: "Axes | None" = None) -> "Figure":
    """The drawing of the brake that a countermeasure holds, with what is done to it written above."""
    layers = [type(layer).title.lower() for layer in design.layers]
    figure = brake_drawing(design.innermost, axes=axes)
    panel = figure.axes[0] if axes is None else axes
    panel.set_title(" on ".join([*layers, "the brake"]), fontsize=8)
    return figure


@drawn_by.register(Remedies)
def remedies_figure(found: Remedies, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """The share of the lot that squeals with each cure, ranked, beside that without; hollow where no dose is enough.

    Where all of it squeals with any of them, the growth rate tells them apart.
    """
    from matplotlib.patches import Patch

    count = min(len(found), MOST_BARS)
    with drawing(axes, width=1.8 * COLUMN, height=0.6 + 0.19 * count) as panel:
        places, shares = np.arange(count), bool(np.any(found.probability[:count] < ALL))
        values, without = (found.probability, found.before) if shares else (found.growth, found.growth_before)
        friction = f" at {100.0 * found.margin:.3g} % more friction" if found.margin else ""
        looks: dict[bool, dict[str, Any]] = {
            True: {"facecolor": "#0072B2"},
            False: {"facecolor": "white", "edgecolor": "#0072B2"},
        }
        words = {True: f"quiet{friction}", False: f"no dose is quiet{friction}"}
        for place in places:
            panel.barh(place, max(float(values[place]), 1e-3), height=0.7, **looks[bool(found.reached[place])])
        before = panel.axvline(without, color="#D55E00", linewidth=1.0, label="without a cure")
        kinds = [each for each in (True, False) if each in found.reached[:count]]
        panel.set_yticks(places, [str(name) for name in found.name[:count]], fontsize=6)
        panel.invert_yaxis()
        panel.set_xlim(0.0, 1.0 if shares else None)
        left_out = f" (the best {count} of {len(found)} cures)" if count < len(found) else ""
        what = (
            "share of the lot that squeals" if shares else quantity_label("growth rate; all of the lot squeals", "1/s")
        )
        panel.set_xlabel(f"{what}{left_out}")
        panel.set_title(title)
        key = [Patch(label=words[each], **looks[each]) for each in kinds]
        panel.legend(handles=[*key, before], loc="best", fontsize=6)
        return figure_of(panel)


@drawn_by.register(BestAbsorber)
def detuning_map(found: BestAbsorber, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
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
def poles_figure(found: ClosedLoop, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """Poles with the loops closed (dots) and without their forces (crosses), over growth rate and frequency."""
    with drawing(axes, width=1.4 * COLUMN, height=2.8) as panel:
        for values, mark, label in ((found.open_loop, "x", "open"), (found.poles, "o", "closed")):
            upper = values[values.imag >= 0.0]
            panel.plot(upper.real, upper.imag / (2.0 * np.pi), mark, markersize=4, label=label)
        panel.axvline(0.0, color="black", linewidth=0.6)
        panel.set(xlabel=quantity_label("growth rate", "1/s"), ylabel=quantity_label("frequency", "Hz"), title=title)
        panel.legend(loc="best", fontsize=6)
        return figure_of(panel)


def loop_locus(
    found: ClosedLoop,
    gains: ArrayLike | None = None,
    loop: int | None = None,
    *,
    title: str = "",
    axes: "Panels | None" = None,
) -> "Figure":
    """Where the poles go as the gain of one loop, or of all, rises from 0 (crosses) over 1 (circles) to twice that."""
    factors = np.linspace(0.0, 2.0, 401) if gains is None else np.asarray(gains, dtype=float)
    if any(one.late > 0.0 or one.sampling is not None for one in found.plant.loops):
        title = f"{title} without delay and sampling".strip()
    poles = found.root_locus(factors, loop)
    with drawing(axes, width=1.4 * COLUMN, height=2.8) as panel:
        upper = np.where(poles.imag >= 0.0, poles, np.nan)
        panel.plot(upper.real.ravel(), upper.imag.ravel() / (2.0 * np.pi), ".", color="#0072B2", markersize=1.5)
        for gain, mark in ((0.0, "x"), (1.0, "o")):
            at = found.root_locus([gain], loop)[0]
            at = at[at.imag >= 0.0]
            panel.plot(at.real, at.imag / (2.0 * np.pi), mark, color="#D55E00", markersize=4, label=f"gain x {gain:g}")
        panel.axvline(0.0, color="black", linewidth=0.6)
        panel.set(xlabel=quantity_label("growth rate", "1/s"), ylabel=quantity_label("frequency", "Hz"), title=title)
        panel.legend(loc="best", fontsize=6)
        return figure_of(panel)


def nyquist_curve(found: ClosedLoop, loop: int = 0, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """The open loop -L of one loop, the others closed, over positive frequencies, and the critical point -1."""
    fastest = float(np.max(np.abs(found.open_loop)))
    slowest = max(float(np.min(np.abs(found.open_loop))), 1e-4 * fastest)
    w = np.geomspace(1e-2 * slowest, 1e2 * fastest, 2001)
    near = [
        p.imag + width * abs(p.real) for p in found.open_loop if p.imag > 0.0 for width in np.linspace(-20, 20, 401)
    ]
    w = np.sort(np.concatenate([w, [x for x in near if x > 0.0]]))
    rates = [float(one.sampling) for one in found.plant.loops if one.sampling is not None]
    curve = found.nyquist(w[w < np.pi * min(rates, default=np.inf)] / (2.0 * np.pi), loop)
    with drawing(axes, width=COLUMN, height=COLUMN) as panel:
        panel.plot(curve.real, curve.imag, label="0 to the highest frequency", **line(0))
        panel.plot(curve.real, -curve.imag, linewidth=0.6, color="0.6")
        panel.plot([-1.0], [0.0], "+", color="#D55E00", markersize=8, zorder=3, label="-1")
        panel.set(xlabel="real part of -L", ylabel="imaginary part of -L", aspect="equal")
        panel.set_title(title, y=1.12)
        panel.legend(loc="lower center", bbox_to_anchor=(0.5, 1.0), ncols=2, fontsize=6)  # the mark stays in sight
        return figure_of(panel)


@drawn_by.register(Placement)
def placement_figure(found: Placement, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """What feedback between each pair of freedoms does to the mode that grows most: blue damps it, red drives it."""
    values = found.shift[:, :, found.target].real
    size = float(np.max(np.abs(values))) or 1.0
    with drawing(axes, width=1.4 * COLUMN, height=2.6) as panel:
        image = panel.imshow(values, cmap="coolwarm", vmin=-size, vmax=size)
        panel.figure.colorbar(image, ax=panel, label="growth rate per gain [1/kg]")
        places = np.arange(len(found.names))
        panel.set_xticks(places, found.names)
        panel.set_yticks(places, found.names)
        panel.set(xlabel="acts on", ylabel="senses", title=title)
        return figure_of(panel)


@drawn_by.register(DefeatingPush)
def push_figure(found: DefeatingPush, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """The pushes that die down and those that do not, and the edge between them."""
    with drawing(axes, width=1.4 * COLUMN, height=1.2) as panel:
        edge = found.push if found.outcome.ok else 1.0
        panel.barh(0.0, edge, color="#0072B2", label="dies down")
        panel.barh(
            0.0, edge, left=edge, color="#D55E00", label="defeats the loops" if found.outcome.ok else "not known"
        )
        panel.set_yticks([])
        panel.set(xlabel=quantity_label("push", "m/s"), title=title or ("" if found.outcome.ok else str(found.outcome)))
        panel.legend(loc="best", fontsize=6)
        return figure_of(panel)


@drawn_by.register(StableGains)
def gains_figure(found: StableGains, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """Growth rate over the factor on the loops' forces, and the ranges in which they hold the brake."""
    with drawing(axes, width=1.4 * COLUMN, height=2.0) as panel:
        panel.plot(found.factor, found.growth, color="#0072B2")
        for low, high in zip(found.low, found.high, strict=True):
            panel.axvspan(low, min(high, np.max(found.factor)), color="#009E73", alpha=0.2, lw=0.0)
        panel.axhline(0.0, color="0.5", lw=0.6)
        panel.set_xscale("symlog", linthresh=1e-3)
        size = 1.5 * max(abs(found.least_growth), abs(float(found.growth[0]))) if len(found.growth) else 1.0
        panel.set_ylim(-size, size)
        panel.set_xlim(0.0, np.max(found.factor, initial=1.0))
        panel.set(xlabel=quantity_label("factor on the forces", ""), ylabel=quantity_label("growth rate", "1/s"),
                  title=title or ("" if found.outcome.ok else str(found.outcome)))  # fmt: skip
        return figure_of(panel)


@drawn_by.register(LoopRun)
def loop_run(found: LoopRun, *, title: str = "", axes: "Panels | None" = None) -> "Figure":
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
