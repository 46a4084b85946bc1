"""What tens of thousands of transients show, beside the eigenvalues: maps, and the maxima over friction."""

from typing import TYPE_CHECKING

import numpy as np

from squealbox import plots
from squealbox.papers.drum_brake_2011.by_eigenvalues import ZONE
from squealbox.papers.drum_brake_2011.cases import Case
from squealbox.papers.drum_brake_2011.ensembles import MEANS, Maxima, SquealMap
from squealbox.papers.drum_brake_2011.figures import Margins
from squealbox.plots import drawing, figure_of
from squealbox.words import quantity_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

COLOURS = ("#ffffff", "#E69F00", "#0072B2", "#d0d0d0", "#009E73", "#000000")  # of MEANS, different in grey as well
MU = ("friction coefficient", "-", 1.0)
ANGLES = ((r"$\theta_1$", "deg", np.pi / 180.0), (r"$\theta_2$", "deg", np.pi / 180.0))
LOAD = ("load", "kN", 1e3)
SPEED = ("sliding speed", "m/s", 1.0)
Axis = tuple[str, str, float]
MARGINS = Margins(left=0.55, right=0.1, bottom=0.72, across=0.34, down=0.7)  # below: the legend


def pressure(found: SquealMap) -> "Figure":
    """Both centres of pressure: growth by eigenvalues on the left, what transients do on the right."""
    from matplotlib.patches import Rectangle

    figure, (left, right) = plots.panels(1, 2, width=9.0, height=4.0, sharey=True)
    MARGINS.set(figure, 1, 2, 9.0, 4.0)
    _eigenvalues(left, found, *ANGLES)
    _transients(right, found, *ANGLES)
    for panel in (left, right):
        (first, last), (low, high) = ZONE
        box = Rectangle((first, low), last - first, high - low, fill=False, edgecolor="#CC79A7", linewidth=1.4)
        panel.add_patch(box)
    _legend(figure, [found])
    return figure


def planes(load: SquealMap, speed: SquealMap) -> "Figure":
    """Friction with load above, with sliding speed below; eigenvalues left, transients right."""
    figure, rows = plots.panels(2, 2, width=9.0, height=7.4, sharey="row")
    MARGINS.set(figure, 2, 2, 9.0, 7.4)
    for (left, right), found, axis in zip(rows, (load, speed), (LOAD, SPEED), strict=True):
        _eigenvalues(left, found, MU, axis)
        _transients(right, found, MU, axis)
    _legend(figure, [load, speed])
    return figure


def maxima(case: Case, found: Maxima, onset: float) -> "Figure":
    """The last eight maxima of x, less steady sliding, over friction; from rest and from beside steady sliding."""
    with drawing(Margins(bottom=0.4).panel(6.4, 3.4)) as panel:
        panel.axhline(0.0, color="#808080", linewidth=0.8)
        for values, mark, colour, size, name in (
            (found.from_rest, "o", "#D55E00", 3.0, "from rest"),
            (found.from_sliding, ".", "#000000", 1.6, "from beside steady sliding"),
        ):
            mu = np.broadcast_to(found.mu[:, None], values.shape)
            face = "none" if mark == "o" else colour
            away = values - found.sliding[:, None]
            panel.plot(
                mu.ravel(), 1e6 * away.ravel(), mark, color=colour, markersize=size, markerfacecolor=face,
                markeredgewidth=0.4, label=name,
            )  # fmt: skip
        if np.isfinite(onset) and found.mu[0] < onset < found.mu[-1]:
            panel.axvline(onset, color="#0072B2", linestyle=(0, (4, 2)), linewidth=0.9, label="onset by eigenvalues")
        panel.set(xlim=(found.mu[0], found.mu[-1]), xlabel=quantity_label(MU[0], MU[1]))
        away = 1e6 * np.concatenate([v - found.sliding[:, None] for v in (found.from_rest, found.from_sliding)])
        panel.set_yscale("symlog", linthresh=1.0)
        panel.set_ylim(min(-0.3, 1.3 * np.nanmin(away)), max(1.0, 2.0 * np.nanmax(away)))
        panel.set_ylabel(quantity_label("maxima of x, less steady sliding", "µm"))
        panel.set_title(f"{case.reading}, after 0.5 s")
        panel.legend(loc="best")
        return figure_of(panel)


def _eigenvalues(panel: "Axes", found: SquealMap, x: Axis, y: Axis) -> None:
    plots.stability_map(
        found.x / x[2], found.y / y[2], found.growth.T, x_name=x[0], x_unit=x[1], y_name=y[0], y_unit=y[1],
        title="by eigenvalues", axes=panel,
    )  # fmt: skip


def _transients(panel: "Axes", found: SquealMap, x: Axis, y: Axis) -> None:
    """The kinds as colours, and the boundary by eigenvalues as a line on them."""
    from matplotlib.colors import ListedColormap

    first, second = found.x / x[2], found.y / y[2]
    with drawing(panel):
        half = [0.5 * (axis[-1] - axis[0]) / max(axis.size - 1, 1) for axis in (first, second)]
        panel.imshow(
            found.kind.T, cmap=ListedColormap(COLOURS), vmin=-0.5, vmax=len(COLOURS) - 0.5, origin="lower",
            aspect="auto", interpolation="nearest",
            extent=(first[0] - half[0], first[-1] + half[0], second[0] - half[1], second[-1] + half[1]),
        )  # fmt: skip
        known = np.nan_to_num(found.growth, nan=-1.0)
        if np.any(known > 0.0) and np.any(known < 0.0):
            panel.contour(first, second, known.T, levels=[0.0], colors=["#000000"], linewidths=0.9)
        panel.set(xlim=(first[0], first[-1]), ylim=(second[0], second[-1]), title="by transients of 0.05 s")
        panel.set(xlabel=quantity_label(x[0], x[1]), ylabel=quantity_label(y[0], y[1]))


def _legend(figure: "Figure", maps: list[SquealMap]) -> None:
    """The kinds that occur, below the panels."""
    from matplotlib.patches import Patch

    with drawing(figure.axes[0]):
        handles = [
            Patch(facecolor=colour, edgecolor="#000000", linewidth=0.5, label=name)
            for kind, (name, colour) in enumerate(zip(MEANS, COLOURS, strict=True))
            if any(np.any(found.kind == kind) for found in maps)
        ]
        figure.legend(handles=handles, loc="lower center", ncols=len(handles), handlelength=1.6)
