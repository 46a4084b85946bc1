"""Figures over parameters by ensembles: brute-force bifurcation diagrams over branches, and regions of coexistence."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.limit_cycles import BifurcationDiagram, Branch, Coexistence
from squealbox.plots.dispatch import drawn_by
from squealbox.plots.style import WIDTH, cautioned, drawing, figure_of, note, panels, styled
from squealbox.words import quantity_label, scaled, unit_at

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squealbox.plots.style import Panels

# Mark, colour and words of each sweep; open marks, so that what lies beneath is seen.
SWEPT = {
    "up": ("^", "#0072B2", "swept up"),
    "down": ("v", "#D55E00", "swept down"),
    "rest": ("o", "#000000", "each from rest"),
    "start": ("x", "#009E73", "from drawn starts"),
}
SHOWN = ("amplitude", "maxima", "section")


@drawn_by.register(BifurcationDiagram)
def bifurcation_diagram(
    diagram: BifurcationDiagram,
    *,
    branches: Branch | Sequence[Branch] = (),
    dof: int = 0,
    show: str = "amplitude",
    name: str | None = None,
    scale: float = 1.0,
    title: str = "",
    axes: "Panels | None" = None,
) -> "Figure":
    """What sweeps settle to over a parameter, drawn over branches of cycles (stable solid, unstable dashed).

    Parameters
    ----------
    diagram, branches : both over the same parameter
    dof : index of the degree of freedom
    show : "amplitude" (half peak to peak), "maxima" (the last eight, beside steady sliding: several marks at one
        value are a cycle of several maxima, or a motion that does not repeat itself) or "section" (what the diagram's
        section reads, a displacement beside steady sliding; branches lie over maxima and minima of `dof` only)
    name : of the parameter, with its unit; scale : what it is divided by
    axes : draw here instead of in a new figure
    scale : [-] what the parameter is divided by
    """
    if show not in SHOWN:
        raise ValueError(f"show = {show!r}: expected one of {', '.join(SHOWN)}")
    several = [branches] if isinstance(branches, Branch) else list(branches)
    marks, unit, words = _marks(diagram, dof, show)
    factor, unit = scaled(unit, np.where(np.isfinite(marks), marks, 0.0))
    told: set[str] = set()
    with drawing(axes, width=5.0, height=3.0) as panel:
        for one in several:
            height = _height(one, diagram, dof, show)
            if height is not None:
                _branch(panel, one, height / factor, scale)
        for i, sweep in enumerate(diagram.sweeps):
            kind = sweep.split()[0]
            mark, colour, text = SWEPT[kind]
            at, up = np.broadcast_arrays(diagram.value[:, None] / scale, marks[i] / factor)
            size, rim = {"amplitude": (3.2, 0.6), "maxima": (2.2, 0.6), "section": (1.8, 0.4)}[show]
            size *= 1.9 if kind == "rest" else 1.0  # a circle goes round the triangles of the sweeps, not over them
            panel.plot(at.ravel(), up.ravel(), mark, color=colour, markersize=size, markerfacecolor="none",
                       markeredgewidth=rim, label=None if kind in told else text)  # fmt: skip
            told.add(kind)
        unit_x = diagram.unit_of(diagram.parameter)
        panel.set(xlabel=name or quantity_label(diagram.parameter, unit_x), ylabel=quantity_label(words, unit))
        panel.set_title(title)
        panel.set_xlim(*(diagram.value[[0, -1]] / scale) if len(diagram.value) > 1 else (None, None))
        panel.margins(y=0.08)
        if show == "amplitude":
            panel.set_ylim(bottom=0.0)
        panel.legend(loc="best")
        cautioned(panel, [diagram.caution, *(one.caution for one in several)], axes is None)
        return figure_of(panel)


def amplitude_and_section(
    diagram: BifurcationDiagram, *, branches: Branch | Sequence[Branch] = (), dof: int = 0, title: str = "", **look: Any
) -> "Figure":
    """Amplitude over the parameter, and beneath it what the section reads, with one legend.

    Parameters are those of :func:`bifurcation_diagram`.
    """
    figure, (above, below) = panels(2, 1, width=WIDTH, height=4.6, sharex=True)
    bifurcation_diagram(diagram, branches=branches, dof=dof, title=title, axes=above, **look)
    bifurcation_diagram(diagram, branches=branches, dof=dof, show="section", axes=below, **look)
    above.set(xlabel="", ylabel=f"{above.get_ylabel().replace(' [', f' of {diagram.dofs[dof]} [')}")
    if diagram.read in diagram.dofs:
        note(below, "counted from steady sliding", "upper left")
    handles, texts = above.get_legend_handles_labels()
    for panel in (above, below):
        panel.get_legend().remove()
    with styled():
        figure.legend(handles, texts, loc="outside lower center", ncols=4)
        given = [branches] if isinstance(branches, Branch) else branches
        cautioned(above, [diagram.caution, *(one.caution for one in given)], True)
    return figure


def _marks(diagram: BifurcationDiagram, dof: int, show: str) -> tuple[Any, str, str]:
    """What is drawn, (sweep, point, mark), with its unit and words."""
    system = diagram.inputs.get("system")
    unit = unit_at(system, diagram.dofs[dof])
    if show == "amplitude":
        return diagram.amplitude[..., dof, None], unit, "amplitude"
    if show == "maxima":
        return diagram.maxima[:, :, dof] - diagram.sliding[:, dof, None], unit, "maxima beside steady sliding"
    if not diagram.section:
        raise ValueError('show = "section": expected a diagram that was made with a section')
    if diagram.read in diagram.dofs:
        beside = diagram.crossings - diagram.sliding[:, diagram.dofs.index(diagram.read), None]
        return beside, unit_at(system, diagram.read), diagram.section
    return diagram.crossings, unit_at(system, diagram.read.rstrip("'"), moves=True), diagram.section


def _height(one: Branch, diagram: BifurcationDiagram, dof: int, show: str) -> Any:
    """What a branch has at the height of the marks; None where it does not say."""
    if show == "amplitude":
        return one.amplitude[:, dof]
    name = one.inputs["system"].names[dof]
    least = show == "section" and diagram.section == f"{name} at its minima"
    if show == "section" and not least and diagram.section != f"{name} at its maxima":
        return None
    return (one.lowest if least else one.highest)[:, dof] - np.interp(one.value, diagram.value, diagram.sliding[:, dof])


def _branch(panel: "Axes", one: Branch, height: np.ndarray, scale: float) -> None:
    stable = one.stable
    for wanted, dash in ((True, "-"), (False, "--")):
        here = stable == wanted
        joined = here | np.r_[here[1:], False] if len(here) else here
        words = f"{'stable' if wanted else 'unstable'} cycles, followed"
        told = words in panel.get_legend_handles_labels()[1]
        if np.any(here):
            panel.plot(np.where(joined, one.value, np.nan) / scale, np.where(joined, height, np.nan), dash,
                       color="#888888", linewidth=1.6, label=None if told else words, zorder=1)  # fmt: skip


@drawn_by.register(Coexistence)
def coexistence_region(
    region: Coexistence,
    *,
    ends: ArrayLike | None = None,
    names: Sequence[str] | None = None,
    scales: Sequence[float] = (1.0, 1.0),
    title: str = "",
    axes: "Axes | None" = None,
) -> "Figure":
    """Where sliding is stable and yet vibrations live: between the curve of their end and the Hopf curve.

    Shades and dots are runs, one a point of the grid: the share of far starts that end in a vibration. Lines are the
    edges: solid where sliding loses its stability, dashed where the vibration followed down ends.

    Parameters
    ----------
    region : of :func:`coexistence`
    ends : (rows,) the lower edge by exact cycles, from :func:`cycle_ends`, drawn as circles
    names, scales : [-] of the axes, with units, and what their values are divided by
    axes : draw here instead of in a new figure
    """
    x, y = region.x / scales[0], region.y / scales[1]
    share = np.where(region.stable, 100.0 * region.vibrates, np.nan).T
    labels = names or [quantity_label(p, region.unit_of(p)) for p in region.parameters]
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


def _span(values: np.ndarray) -> tuple[float, float]:
    half = 0.5 * (values[1] - values[0]) if len(values) > 1 else 0.5
    return float(values[0] - half), float(values[-1] + half)
