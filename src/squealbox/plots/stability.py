"""Figures of stability results: root locus, tracked modes, map of mechanisms, boundary, energy, sensitivity, growth.

Parameters are drawn in the units of the design; `scales` gives a factor and a unit for an axis that reads better in
another, such as ``{"theta1": (180 / pi, "°")}``.
"""

from collections.abc import Mapping
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.plots.dispatch import drawn_by
from squealbox.plots.modes import coalescence
from squealbox.plots.style import LINES, drawing, figure_of, line, note
from squealbox.stability import (
    Boundary,
    ComplexModes,
    LocalSensitivity,
    MeshDoubt,
    ModeEnergy,
    Sensitivity,
    StabilityMap,
    TrackedModes,
    TransientGrowth,
    map_boundary,
)
from squealbox.words import number, quantity_label, scaled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Scales = Mapping[str, tuple[float, str]] | None
NEUTRAL = 1e-3  # of the largest growth rate: how far below zero a stable point of an undamped brake is drawn
# Shade and hatch of each mechanism: they differ in grey as well as in colour.
AREAS = {
    "flutter": ("#f0b27a", "////"),
    "negative_slope": ("#a9cce3", "...."),
    "divergence": ("#bbbbbb", "xxxx"),
    "mixed": ("#f7e6a1", "\\\\\\\\"),
}


def root_locus(tracked: TrackedModes, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """Eigenvalues with Im >= 0 in the complex plane as the parameter grows; a square marks the start, a dot the end."""
    values = np.where(tracked.eigenvalues.imag >= 0.0, tracked.eigenvalues, np.nan)
    with drawing(axes, height=3.0) as panel:
        for i in np.nonzero(np.any(np.isfinite(values), axis=0))[0]:
            track = values[:, i]
            place = len(panel.get_lines()) // 3
            panel.plot(track.real, track.imag / (2.0 * np.pi), **line(place))
            known = track[np.isfinite(track)]
            colour = LINES[place % len(LINES)][0]
            panel.plot(known[0].real, known[0].imag / (2.0 * np.pi), "s", color=colour, markerfacecolor="white")
            panel.plot(known[-1].real, known[-1].imag / (2.0 * np.pi), "o", color=colour)
        panel.axvline(0.0, color="#000000", linewidth=0.5)
        low, high = tracked.value[0], tracked.value[-1]
        note(panel, f"□ {tracked.parameter} = {number(low)}\n● {tracked.parameter} = {number(high)}", "upper left")
        panel.margins(x=0.1, y=0.25)
        panel.set(xlabel=quantity_label("growth rate", "1/s"), ylabel=quantity_label("frequency", "Hz"), title=title)
        return figure_of(panel)


@drawn_by.register(ComplexModes)
def eigenvalues(modes: ComplexModes, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """The spectrum in the complex plane, Im >= 0: dots where a mode decays, squares where it grows, with their numbers.

    With leading axes the spectra of all entries stand in one figure, without numbers.
    """
    known = np.asarray(modes.exists)
    half = modes.eigenvalues.shape[-1] // 2
    growth, hertz = modes.growth_rate[known][:, :half], modes.frequency[known][:, :half]
    factor, read = scaled("Hz", hertz)
    with drawing(axes, height=2.8) as panel:
        for grows, marker, colour, name in ((False, "o", "#0072B2", "decays"), (True, "s", "#D55E00", "grows")):
            chosen = (growth > 0.0) == grows
            if np.any(chosen):
                panel.plot(growth[chosen], hertz[chosen] / factor, marker, color=colour, label=name)
        if modes.eigenvalues.ndim == 1:
            for i, at in enumerate(zip(growth[0], hertz[0] / factor, strict=True)):
                panel.annotate(str(i + 1), at, xytext=(5.0, 3.0), textcoords="offset points", fontsize=7.0)
        panel.axvline(0.0, color="#000000", linewidth=0.5)
        panel.margins(x=0.15, y=0.25)
        panel.set(xlabel=quantity_label("growth rate", "1/s"), ylabel=quantity_label("frequency", read), title=title)
        panel.legend(loc="best")
        return figure_of(panel)


@drawn_by.register(TrackedModes)
def tracked_modes(tracked: TrackedModes, **keywords: Any) -> "Figure":
    """Frequency and growth rate of every tracked mode against the parameter."""
    keywords.setdefault("name", tracked.parameter)
    return coalescence(tracked.value, tracked, **keywords)


@drawn_by.register(StabilityMap)
def mechanism_map(
    found: StabilityMap,
    *,
    boundary: Boundary | None = None,
    scales: Scales = None,
    title: str = "",
    axes: "Axes | None" = None,
) -> "Figure":
    """Stable and unstable regions over two parameters, shaded and hatched by mechanism, up to the boundary.

    Without `boundary` it is the map's own (:func:`stability.map_boundary`), of a map that does not keep what it was
    computed for where the growth rate between its points is zero.

    A map of more or fewer than two parameters raises `ValueError`.
    """
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    if len(found.axes) != 2:
        raise ValueError(f"a map over {list(found.axes)}: expected two parameters")
    (x_name, x), (y_name, y) = ((name, np.asarray(values)) for name, values in found.axes.items())
    (x_factor, x_unit), (y_factor, y_unit) = (_scale(found, name, scales) for name in (x_name, y_name))
    if boundary is None and found.inputs.get("system") is not None and min(x.size, y.size) > 1:
        boundary = map_boundary(found)
    boundary = boundary if boundary is not None and boundary.outcome.ok and len(boundary.x) else None
    handles: list[Any] = [Patch(facecolor="white", edgecolor="#000000", linewidth=0.5, label="stable")]
    x, y = x_factor * x, y_factor * y
    with drawing(axes, width=4.0, height=3.4) as panel:
        unstable = _unstable(panel, found, x, y, boundary, (x_factor, y_factor))
        nearest = _nearest_unstable(found)
        for name, (colour, hatch) in AREAS.items():
            inside = (nearest == found.mechanism_names.index(name)).T
            if unstable is None or not np.any(inside):
                continue
            area = panel.contourf(x, y, inside.astype(float), levels=[0.5, 1.5], colors=[colour], hatches=[hatch])
            area.set_clip_path(unstable, panel.transData)
            label = name.replace("_", " ")
            handles.append(Patch(facecolor=colour, hatch=hatch, edgecolor="#000000", linewidth=0.5, label=label))
        if not np.all(found.exists):
            panel.contourf(x, y, (~found.exists).T.astype(float), levels=[0.5, 1.5], colors=["#eeeeee"])
            handles.append(Patch(facecolor="#eeeeee", label="no steady sliding"))
        if boundary is not None:
            _curves(panel, boundary, x_factor, y_factor)
        elif unstable is not None and np.any(_signed(found) < 0.0):
            panel.contour(x, y, np.ma.masked_invalid(_signed(found).T), levels=[0.0], colors=["#000000"],
                          linewidths=1.0)  # fmt: skip
        if unstable is not None:
            handles.append(Line2D([], [], color="#000000", linewidth=1.0, label="boundary"))
        panel.legend(handles=handles, loc="best", handlelength=2.0)
        panel.set(xlabel=quantity_label(x_name, x_unit), ylabel=quantity_label(y_name, y_unit), title=title)
        # a map that is stable all over draws nothing else, and would keep the axes of an empty figure
        panel.set(xlim=x[[0, -1]], ylim=y[[0, -1]])
        return figure_of(panel)


def _signed(found: StabilityMap) -> Any:
    """Growth rates, below zero at every stable point: those of an undamped brake are round-off there."""
    stable = found.exists & ~np.isin(found.mechanism, [found.mechanism_names.index(name) for name in AREAS])
    largest = float(np.nanmax(np.abs(found.growth_rate), initial=0.0)) or 1.0
    return np.where(stable, np.minimum(found.growth_rate, -NEUTRAL * largest), found.growth_rate)


def _nearest_unstable(found: StabilityMap) -> Any:
    """The mechanism of each point, of a stable one that of the nearest unstable: areas reach the boundary."""
    from scipy.ndimage import distance_transform_edt

    known = np.isin(found.mechanism, [found.mechanism_names.index(name) for name in AREAS])
    if not np.any(known):
        return found.mechanism
    nearest = distance_transform_edt(~known, return_distances=False, return_indices=True)
    return found.mechanism[tuple(nearest)]


def _unstable(
    panel: "Axes", found: StabilityMap, x: np.ndarray, y: np.ndarray, boundary: Boundary | None, factors: ArrayLike
) -> Any:
    """The outline of the unstable area: to the traced boundary, else to zero between the points; None without one."""
    from matplotlib.tri import Triangulation

    growth = _signed(found).T
    if not np.nanmax(growth, initial=-1.0) > 0.0:
        return None
    levels = [0.0, 2.0 * float(np.nanmax(growth))]
    if boundary is None:
        area: Any = panel.contourf(x, y, np.ma.masked_invalid(growth), levels=levels)
    else:
        ends = np.array([[x[0], x[-1]], [y[0], y[-1]]])
        size = np.array([len(x), len(y)]) / np.ptp(ends, axis=1)  # cells in a unit
        traced = [_dense(np.array(factors) * points, size) for points in boundary.curves]
        nodes = np.stack(np.meshgrid(x, y), axis=-1).reshape(-1, 2)
        at = np.concatenate([nodes, *traced])
        value = np.append(growth.ravel(), np.zeros(len(at) - len(nodes)))
        triangles = Triangulation(size[0] * at[:, 0], size[1] * at[:, 1]).get_masked_triangles()
        known = triangles[np.all(np.isfinite(value)[triangles], axis=1)]
        area = panel.tricontourf(Triangulation(at[:, 0], at[:, 1], known), np.nan_to_num(value), levels=levels)
    outline = area.get_paths()[0]
    area.remove()
    return outline


def _dense(points: np.ndarray, size: np.ndarray) -> Any:
    """A curve (k, 2) with a point in every tenth of a cell, so that triangles do not reach across it."""
    steps = np.maximum(np.ceil(10.0 * np.max(np.abs(np.diff(points, axis=0)) * size, axis=1)), 1.0)
    place = np.append(0.0, np.cumsum(steps))
    every = np.arange(place[-1] + 1.0)
    return np.column_stack([np.interp(every, place, points[:, k]) for k in range(2)])


@drawn_by.register(Boundary)
def boundary_curves(
    boundary: Boundary, *, scales: Scales = None, title: str = "", axes: "Axes | None" = None
) -> "Figure":
    """The traced boundary alone: the curves and their points."""
    x_name, y_name = boundary.parameters
    (x_factor, x_unit), (y_factor, y_unit) = (_scale(boundary, name, scales) for name in (x_name, y_name))
    with drawing(axes, width=4.0, height=3.4) as panel:
        _curves(panel, boundary, x_factor, y_factor, marker=".")
        panel.set(xlabel=quantity_label(x_name, x_unit), ylabel=quantity_label(y_name, y_unit), title=title)
        return figure_of(panel)


@drawn_by.register(ModeEnergy)
def mode_energy(energy: ModeEnergy, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """What each contact and damper adds to the growth rate of a mode, as bars; their sum is the growth rate."""
    rows = list(energy.shares)
    if energy.balanced:
        rows.append(("sum", energy.power))
        return _bars(rows, "mean power at 1 m", "W", title, axes)
    rows.append(("sum = growth rate", energy.growth_rate))
    return _bars(rows, "contribution to the growth rate", "1/s", title, axes)


@drawn_by.register(Sensitivity)
def sensitivity(found: Sensitivity, *, most: int = 10, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """Change of the growth rate for one per cent more of each parameter, the strongest first."""
    rows = [(name, 0.01 * value) for name, value in found.ranked()[:most]]
    return _bars(rows, "change of growth rate for +1 %", "1/s", title, axes)


@drawn_by.register(LocalSensitivity)
def local_sensitivity(
    found: LocalSensitivity, *, most: int = 10, title: str = "", axes: "Axes | None" = None
) -> "Figure":
    """What a gram at each node does to the growth rate, where the nodes are; without nodes, on each freedom as bars."""
    label = "change of growth rate for +1 g"
    known = np.all(np.isfinite(found.place), axis=1)
    if not np.any(known):
        strongest = np.argsort(-np.abs(found.mass.real), kind="stable")[:most]
        names = found.to_dataset()["dof"].values
        return _bars([(str(names[i]), 1e-3 * float(found.mass[i].real)) for i in strongest], label, "1/s", title, axes)
    change, places = 1e-3 * found.node_mass[known].real, found.place[known]
    first, second = np.sort(np.argsort(-np.ptp(places, axis=0), kind="stable")[:2])
    order = np.argsort(np.abs(change), kind="stable")  # what matters lies on top
    top = float(np.max(np.abs(change)))
    with drawing(axes, width=4.5, height=3.6) as panel:
        x, y = places[order, first], places[order, second]
        look = {"vmin": -top, "vmax": top, "cmap": "PuOr_r", "edgecolors": "#888888"}
        dots = panel.scatter(1e3 * x, 1e3 * y, c=change[order], s=14.0, linewidths=0.2, **look)
        figure_of(panel).colorbar(dots, ax=panel, pad=0.02).set_label(quantity_label(label, "1/s"))
        panel.set(xlabel=quantity_label("xyz"[first], "mm"), ylabel=quantity_label("xyz"[second], "mm"), title=title)
        panel.set_aspect("equal")
        return figure_of(panel)


@drawn_by.register(MeshDoubt)
def mesh_doubt(found: MeshDoubt, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """Growth rate over frequency on both meshes; a line joins what is one mode."""
    with drawing(axes, width=4.5, height=3.0) as panel:
        for at in zip(
            *(1e-3 * x for x in (found.frequency, found.other_frequency)),
            *(found.growth_rate, found.other_growth_rate),
            strict=True,
        ):
            panel.plot(at[:2], at[2:], color="#888888", linewidth=0.8, zorder=1)
        looks = ({"color": "#0072B2"}, {"markerfacecolor": "none", "color": "#D55E00"})
        pairs = ((found.frequency, found.growth_rate), (found.other_frequency, found.other_growth_rate))
        for (f, growth), look, size in zip(pairs, looks, (found.element_size, found.other_size), strict=True):
            label = f"elements of {1e3 * float(size):g} mm"
            panel.plot(1e-3 * f, growth, "o", markersize=4.0, label=label, **look)
        panel.axhline(0.0, color="#000000", linewidth=0.5)
        panel.set(xlabel=quantity_label("frequency", "kHz"), ylabel=quantity_label("growth rate", "1/s"), title=title)
        panel.legend(loc="best")
        return figure_of(panel)


@drawn_by.register(TransientGrowth)
def transient_growth(found: TransientGrowth, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """Largest amplification possible at each instant, with the decay the eigenvalues promise."""
    with drawing(axes) as panel:
        panel.plot(1e3 * found.instants, found.envelope, **line(0), label="largest possible")
        promised = np.exp(float(found.spectral_abscissa) * found.instants)
        panel.plot(1e3 * found.instants, promised, **line(1), label="by eigenvalues alone")
        panel.plot(
            1e3 * float(found.time), float(found.amplification), **{**line(0), "marker": "o", "linestyle": "none"}
        )
        panel.set(xlabel=quantity_label("time", "ms"), ylabel=quantity_label("amplification", ""), title=title)
        lasting = found.instants[found.envelope >= 0.05 * float(found.amplification)]
        panel.set_xlim(0.0, 1e3 * float(lasting[-1]))
        panel.set_ylim(bottom=0.0)
        panel.legend(loc="best")
        return figure_of(panel)


def _bars(rows: list[tuple[str, float]], name: str, unit: str, title: str, axes: "Axes | None") -> "Figure":
    with drawing(axes, width=4.5, height=0.4 + 0.24 * len(rows) + 0.3) as panel:
        values = np.array([value for _, value in rows])
        colours = ["#D55E00" if value > 0.0 else "#0072B2" for value in values]
        bars = panel.barh(np.arange(len(rows)), values, color=colours, edgecolor="#000000", linewidth=0.4, height=0.7)
        panel.bar_label(bars, labels=[number(value, 3) for value in values], padding=2, fontsize=6.5)
        panel.axvline(0.0, color="#000000", linewidth=0.5)
        panel.set_yticks(np.arange(len(rows)), [label for label, _ in rows])
        panel.invert_yaxis()
        panel.margins(x=0.18)
        panel.set(xlabel=quantity_label(name, unit), title=title)
        return figure_of(panel)


def _curves(panel: "Axes", boundary: Boundary, x_factor: float, y_factor: float, **look: Any) -> None:
    for points in boundary.curves:
        panel.plot(x_factor * points[:, 0], y_factor * points[:, 1], color="#000000", linewidth=1.2, **look)


def _scale(found: StabilityMap | Boundary, name: str, scales: Scales) -> tuple[float, str]:
    return (scales or {}).get(name, (1.0, found.unit_of(name)))
