"""A map over two parameters: where steady sliding, or a run, is unstable."""

from collections.abc import Iterable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.plots.style import drawing, figure_of
from squealbox.words import quantity_label, scaled

HATCH = "\\\\\\\\"  # against the slope that bands of coalescence usually have
PALE = "#f6e6da"
EDGE: dict[str, Any] = {"colors": ["#000000"], "linewidths": 1.2, "zorder": 3}

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@dataclass(frozen=True)
class PlaneLabels:
    """What the axes of a plane of two parameters and the bar beside it are called, with their units."""

    x_name: str = "x"
    x_unit: str = ""
    y_name: str = "y"
    y_unit: str = ""
    value_name: str = "growth rate"
    value_unit: str = "1/s"

    def of_axes(self) -> dict[str, str]:
        """For the axes of Matplotlib."""
        return {"xlabel": quantity_label(self.x_name, self.x_unit), "ylabel": quantity_label(self.y_name, self.y_unit)}


def stability_map(
    x: Any,
    y: Any,
    growth: ArrayLike,
    *,
    curves: Iterable[Any] | None = None,
    title: str = "",
    axes: Any = None,
    **labels: str,
) -> "Figure":
    """Unstable region over two parameters: shaded by growth rate, hatched, and bounded by a line.

    Parameters
    ----------
    x, y : (nx,), (ny,), increasing, in the units named; convert angles to degrees first
    growth : (ny, nx), unstable where > 0; NaN, drawn as crosses, where nothing is known. Booleans (True = unstable) are
        drawn without shades
    labels : x_name, x_unit, y_name, y_unit of the axes, value_name, value_unit of the bar
    curves : the boundary as traced, each curve (k, 2) in the units of the axes; without it the line is the grid's own
    """
    about = PlaneLabels(**labels)
    x, y, grid = _checked("growth", x, y, growth)
    boolean = grid.dtype == bool
    level = np.where(grid, 1.0, -1.0) if boolean else grid.astype(float)
    unknown = ~np.isfinite(level)
    top = float(np.nanmax(level, initial=-np.inf))
    with drawing(axes, width=4.0, height=3.4) as panel:
        if top > 0.0:
            _shade(
                panel, x, y, np.ma.masked_invalid(level), top, None if boolean else (about.value_name, about.value_unit)
            )
            if curves is None:
                panel.contour(x, y, np.ma.masked_invalid(level), levels=[0.0], **EDGE)
        if np.any(unknown):
            panel.contourf(x, y, unknown.astype(float), levels=[0.5, 1.5], colors=["#dddddd"], hatches=["xxx"])
        for points in curves or ():
            panel.plot(points[:, 0], points[:, 1], color=EDGE["colors"][0], linewidth=EDGE["linewidths"], zorder=3)
        _legend(panel, level > 0.0, unknown)
        panel.set(**about.of_axes(), title=title)
        panel.set(xlim=(x[0], x[-1]), ylim=(y[0], y[-1]))  # a map that is stable all over draws nothing else
        panel.set_facecolor("white")
        panel.tick_params(color="#000000")
        return figure_of(panel)


def _checked(name: str, x: ArrayLike, y: ArrayLike, grid: ArrayLike) -> tuple[Any, Any, Any]:
    """Axes and grid as arrays; `ValueError` unless the grid has one row for each y."""
    x, y, grid = np.asarray(x, dtype=float), np.asarray(y, dtype=float), np.asarray(grid)
    if grid.shape != (np.size(y), np.size(x)):
        raise ValueError(f"{name} of shape {grid.shape}: expected ({np.size(y)}, {np.size(x)}), one row for each y")
    return x, y, grid


def _legend(panel: "Axes", unstable: np.ndarray, unknown: np.ndarray) -> None:
    """What white, hatched and crossed areas mean, in the corner that hides least of them."""
    from matplotlib.patches import Patch

    edge: dict[str, Any] = {"edgecolor": "#000000", "linewidth": 0.5}
    handles = [Patch(facecolor="white", label="stable", **edge)]
    handles += [Patch(facecolor=PALE, hatch=HATCH, label="unstable", **edge)] * bool(np.any(unstable))
    handles += [Patch(facecolor="#dddddd", hatch="xxx", label="not known", **edge)] * bool(np.any(unknown))
    taken = unstable | unknown
    rows, columns = max(taken.shape[0] // 4, 1), max(taken.shape[1] // 3, 1)
    corners = {
        "upper right": taken[-rows:, -columns:],
        "lower left": taken[:rows, :columns],
        "upper left": taken[-rows:, :columns],
        "lower right": taken[:rows, -columns:],
    }
    free: Any = min(corners, key=lambda place: float(np.mean(corners[place])))
    panel.legend(handles=handles, loc=free, handlelength=2.0)


def _shade(
    panel: "Axes", x: np.ndarray, y: np.ndarray, level: np.ndarray, top: float, bar: tuple[str, str] | None
) -> None:
    from matplotlib.ticker import MaxNLocator

    rounded = np.asarray(MaxNLocator(7).tick_values(0.0, top))
    steps = rounded[rounded >= 0.0] if bar else np.array([0.0, 2.0])
    palette = {"cmap": "Oranges"} if bar else {"colors": [PALE]}
    shade = panel.contourf(x, y, level, levels=steps, extend="neither", zorder=1, **palette)
    panel.contourf(x, y, level, levels=[0.0, 1e300], colors="none", hatches=[HATCH], zorder=2)
    if bar:
        figure_of(panel).colorbar(shade, ax=panel, pad=0.02).set_label(quantity_label(*bar))


def amplitude_map(
    x: Any,
    y: Any,
    amplitude: ArrayLike,
    *,
    unit: str = "m",
    name: str = "amplitude",
    title: str = "",
    axes: Any = None,
    **labels: str,
) -> "Figure":
    """What transients end in, over two parameters: colour by the square root, from zero to all but a hundredth.

    So the sizes of squeal differ in colour, and what has nearly decayed still differs from what has.

    Parameters
    ----------
    x, y : (nx,), (ny,), increasing, in the units named
    amplitude : (ny, nx), one row for each y; NaN where a run did not end is drawn grey
    unit, name : of what is drawn, by default an amplitude in m
    labels : x_name, x_unit, y_name, y_unit of the axes
    """
    about = PlaneLabels(**labels)
    x, y, grid = _checked("amplitude", x, y, np.asarray(amplitude, dtype=float))
    from matplotlib.colors import PowerNorm

    known = grid[np.isfinite(grid)]
    factor, read = scaled(unit, known)
    top = float(np.quantile(known, 0.99)) / factor if np.any(known > 0.0) else 1.0
    with drawing(axes, width=4.4, height=3.4) as panel:
        panel.set_facecolor("#bbbbbb")
        shown = np.ma.masked_invalid(grid / factor)
        mesh = panel.pcolormesh(x, y, shown, norm=PowerNorm(0.5, 0.0, top), cmap="magma_r", rasterized=True)
        panel.figure.colorbar(mesh, ax=panel, label=quantity_label(name, read), extend="max")
        panel.set(**about.of_axes(), title=title)
        return figure_of(panel)
