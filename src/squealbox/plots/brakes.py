"""A brake as its design draws it, with Matplotlib: bodies, springs, angles, loads and the direction of sliding."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.design import Design
from squealbox.plots.dispatch import drawn_by
from squealbox.plots.style import COLUMN, drawing, figure_of
from squealbox.shapes import DrawnShape, drawing_of

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

INK = {"motion": "#0072B2", "load": "#D55E00", "part": "#7a8a99"}  # of a role; the others are black
FILLED: dict[str, dict[str, Any]] = {  # of a role; the others are white
    "body": {"facecolor": "#dfe8f0"},
    "shoe": {"facecolor": "#c9d3dc", "linewidth": 0.8},
    "lining": {"facecolor": "#e6c9a8", "edgecolor": None, "hatch": "...."},
    "pivot": {"facecolor": "black"},
}
ARROW = {"arrowstyle": "-|>", "shrinkA": 0.0, "shrinkB": 0.0, "mutation_scale": 9.0, "linewidth": 1.4}


@drawn_by.register(Design)
def brake_drawing(design: Design, *, axes: "Axes | None" = None) -> "Figure":
    """The brake as its parameters describe it; angles are to scale, lengths where the design has any.

    Blue is what slides and where it moves, orange are loads. Raises `TypeError` for a design that does not `draw`
    itself, or one that stands for a whole map.
    """
    if not draws(type(design)):
        raise TypeError(f"no drawing is known for {type(design).__name__}: expected a design with a `draw`")
    if not has_drawing(design):
        raise TypeError(f"{type(design).__name__} stands for a map of brakes: expected one")
    with drawing(axes, width=1.3 * COLUMN, height=3.2) as panel:
        for shape in drawing_of(design).shapes:
            DRAW[shape.kind](panel, shape, INK.get(shape.role, "black"))
        panel.set_aspect("equal")
        panel.set_axis_off()
        panel.margins(0.06)
        panel.autoscale_view()
        return figure_of(panel)


def draws(kind: type[Design]) -> bool:
    """True where designs of this kind draw themselves."""
    return kind.draw is not Design.draw


def has_drawing(design: Design) -> bool:
    """True where this design draws itself and is one brake, not a map of them."""
    return draws(type(design)) and not any(np.ndim(x) for _, about, x in design.leaves() if about.unit != "-")


def _line(panel: "Axes", shape: DrawnShape, ink: str) -> None:
    dashes = shape.about["dashes"]
    look = {"linewidth": shape.about["width"], "linestyle": (0, dashes) if dashes else "-"}
    panel.plot(*shape.points.T, color=ink, solid_capstyle="round", **look)


def _polygon(panel: "Axes", shape: DrawnShape, ink: str) -> None:
    from matplotlib.patches import Polygon

    panel.add_patch(Polygon(shape.points, **_filled(shape, ink)))


def _circle(panel: "Axes", shape: DrawnShape, ink: str) -> None:
    from matplotlib.patches import Circle

    panel.add_patch(Circle(shape.points[0], shape.about["radius"], **_filled(shape, ink)))


def _filled(shape: DrawnShape, ink: str) -> dict[str, Any]:
    order = {"zorder": 2.0}  # of lines, so that later shapes lie over earlier ones
    return {"facecolor": "white", "edgecolor": ink, "linewidth": 1.0, **order, **FILLED.get(shape.role, {})}


def _arrow(panel: "Axes", shape: DrawnShape, ink: str) -> None:
    start, end = shape.points
    panel.annotate("", xy=end, xytext=start, arrowprops={**ARROW, "color": ink})
    panel.update_datalim(shape.points)


def _text(panel: Any, shape: DrawnShape, ink: str) -> None:
    look = {"ha": shape.about["anchor"], "va": "center", "fontsize": shape.about["size"]}
    panel.text(*shape.points[0], shape.about["text"], color=ink, **look)


DRAW: dict[str, Callable[[Any, DrawnShape, str], None]] = {
    "line": _line, "polygon": _polygon, "circle": _circle, "arrow": _arrow, "text": _text,
}  # fmt: skip
