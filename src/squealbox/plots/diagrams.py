"""Figures over parameters by ensembles: brute-force bifurcation diagrams over branches, and regions of coexistence."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.limit_cycles import BifurcationDiagram, Branch, Coexistence
from squealbox.plots.dispatch import plot
from squealbox.plots.facts import unit_of
from squealbox.plots.style import drawing, figure_of, quantity_label, scaled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# Mark, colour and words of each sweep; open marks, so that what lies beneath is seen.
SWEPT = {
    "up": ("^", "#0072B2", "swept up"),
    "down": ("v", "#D55E00", "swept down"),
    "rest": ("o", "#000000", "each from rest"),
}


@plot.register(BifurcationDiagram)
def bifurcation_diagram(
    diagram: BifurcationDiagram,
    *,
    branches: Branch | Sequence[Branch] = (),
    dof: int = 0,
    show: str = "amplitude",
    name: str | None = None,
    scale: float = 1.0,
    title: str = "",
    axes: Any = None,
) -> "Figure":
    """What sweeps settle to over a parameter, drawn over branches of cycles (stable solid, unstable dashed).

    Parameters
    ----------
    diagram, branches : both over the same parameter
    dof : index of the degree of freedom
    show : "amplitude" (half peak to peak) or "maxima" (the last eight, beside steady sliding: several marks at one
        value are a cycle of several maxima, or a motion that does not repeat itself)
    name : of the parameter, with its unit; scale : what it is divided by
    axes : draw here instead of in a new figure
    """
    if show not in ("amplitude", "maxima"):
        raise ValueError(f'show = {show!r}: expected "amplitude" or "maxima"')
    several = [branches] if isinstance(branches, Branch) else list(branches)
    beside = diagram.sliding[:, dof]
    marks = diagram.amplitude[..., dof, None] if show == "amplitude" else diagram.maxima[:, :, dof] - beside[:, None]
    factor, unit = scaled("m", np.where(np.isfinite(marks), marks, 0.0))
    with drawing(axes, width=5.0, height=3.0) as panel:
        for one in several:
            _branch(panel, one, _height(one, diagram, dof, show) / factor, scale)
        for i, sweep in enumerate(diagram.sweeps):
            mark, colour, words = SWEPT[sweep]
            at, up = np.broadcast_arrays(diagram.value[:, None] / scale, marks[i] / factor)
            size = 3.2 if show == "amplitude" else 2.2
            panel.plot(at.ravel(), up.ravel(), mark, color=colour, markersize=size, markerfacecolor="none",
                       markeredgewidth=0.6, label=words)  # fmt: skip
        unit_x = _unit(diagram, diagram.parameter)
        words = "amplitude" if show == "amplitude" else "maxima beside steady sliding"
        panel.set(xlabel=name or quantity_label(diagram.parameter, unit_x), ylabel=quantity_label(words, unit))
        panel.set_title(title)
        panel.set_xlim(*(diagram.value[[0, -1]] / scale) if len(diagram.value) > 1 else (None, None))
        panel.margins(y=0.08)
        panel.legend(loc="best")
        return figure_of(panel)


def _unit(result: Any, parameter: str) -> str:
    """The unit of a parameter, or of what it stands for: load is load1 and load2."""
    aliases = getattr(result.inputs.get("system"), "aliases", {})
    return unit_of(result, next(iter(aliases.get(parameter, ())), parameter))


def _height(one: Branch, diagram: BifurcationDiagram, dof: int, show: str) -> Any:
    if show == "amplitude":
        return one.amplitude[:, dof]
    return one.highest[:, dof] - np.interp(one.value, diagram.value, diagram.sliding[:, dof])


def _branch(panel: Any, one: Branch, height: Any, scale: float) -> None:
    stable = one.stable
    for wanted, dash in ((True, "-"), (False, "--")):
        here = stable == wanted
        joined = here | np.r_[here[1:], False] if len(here) else here
        words = f"{'stable' if wanted else 'unstable'} cycles, followed"
        told = words in panel.get_legend_handles_labels()[1]
        if np.any(here):
            panel.plot(np.where(joined, one.value, np.nan) / scale, np.where(joined, height, np.nan), dash,
                       color="#888888", linewidth=1.6, label=None if told else words, zorder=1)  # fmt: skip


@plot.register(Coexistence)
def coexistence_region(
    region: Coexistence,
    *,
    ends: Any = None,
    names: Sequence[str] | None = None,
    scales: Sequence[float] = (1.0, 1.0),
    title: str = "",
    axes: Any = None,
) -> "Figure":
    """Where sliding is stable and yet vibrations live: between the curve of their end and the Hopf curve.

    Shades and dots are runs, one a point of the grid: the share of far starts that end in a vibration. Lines are the
    edges: solid where sliding loses its stability, dashed where the vibration followed down ends.

    Parameters
    ----------
    region : of :func:`coexistence`
    ends : (rows,) the lower edge by exact cycles, from :func:`cycle_ends`, drawn as circles
    names, scales : of the axes, with units, and what their values are divided by
    axes : draw here instead of in a new figure
    """
    x, y = region.x / scales[0], region.y / scales[1]
    share = np.where(region.stable, 100.0 * region.vibrates, np.nan).T
    labels = names or [quantity_label(p, _unit(region, p)) for p in region.parameters]
    with drawing(axes, width=4.6, height=3.3) as panel:
        panel.set_facecolor("#dddddd")
        mesh = panel.pcolormesh(x, y, share, cmap="Oranges", vmin=0.0, vmax=100.0, shading="nearest", zorder=1)
        figure_of(panel).colorbar(mesh, ax=panel, label="share of far starts that vibrate [%]")
        low, high = np.clip(region.end, region.x[0], None), np.clip(region.onset, None, region.x[-1])
        within = np.isfinite(low) & np.isfinite(high)
        panel.fill_betweenx(y, low / scales[0], high / scales[0], where=within, facecolor="none", hatch="///",
                            edgecolor="#999999", linewidth=0.0, zorder=2)  # fmt: skip
        panel.plot(low / scales[0], y, "--", color="#000000", label="vibration ends", zorder=3)
        if region.hopf is not None and len(region.hopf.x):
            panel.plot(region.hopf.x / scales[0], region.hopf.y / scales[1], color="#000000",
                       label="sliding loses stability (Hopf)", zorder=3)  # fmt: skip
        if ends is not None:
            panel.plot(np.asarray(ends) / scales[0], y, "o", color="#0072B2", markerfacecolor="white",
                       label="last stable cycle, exact", zorder=4)  # fmt: skip
        panel.set(xlabel=labels[0], ylabel=labels[1], title=title, xlim=_span(x), ylim=_span(y))
        panel.legend(loc="upper center", bbox_to_anchor=(0.5, -0.2), ncols=2, handlelength=2.0, fontsize=6.5,
                     title="hatched: both states are stable; grey: sliding is not", title_fontsize=6.5)  # fmt: skip
        return figure_of(panel)


def _span(values: Any) -> tuple[float, float]:
    half = 0.5 * (values[1] - values[0]) if len(values) > 1 else 0.5
    return float(values[0] - half), float(values[-1] + half)
