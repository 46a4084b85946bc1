"""A drawing as plain strokes: what `brake_drawing` puts on a panel of Matplotlib, for a page that draws it itself.

`Strokes` stands in for the panel and takes the few calls the drawings make, so the geometry is written down once.
"""

import re
from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from squealbox.designs import Design
from squealbox.plots.brakes import BELT, LOAD, drawing_of

SAID = {  # what a drawing calls by another name than the design does
    "N": ("load",), "F": ("load",), "N0": ("load",), "N1": ("load1",), "N2": ("load2",), "V": ("sliding_speed",),
    "VB": ("sliding_speed",), "Omega": ("spin",),
}  # fmt: skip
ROLES = {BELT: "motion", LOAD: "load", "#7a8a99": "part"}  # what a colour stands for; the page has its own colours


def brake_strokes(design: Design) -> dict[str, Any]:
    """The strokes of the brake and their box (left, right, bottom, top); no strokes where no drawing is known.

    >>> from squealbox import MassOnBelt
    >>> sorted({stroke["kind"] for stroke in brake_strokes(MassOnBelt())["strokes"]})
    ['arrow', 'circle', 'line', 'polygon', 'text']
    """
    draw, panel = drawing_of(type(design)), Strokes()
    if draw is not None:
        draw(panel, design)
    points = np.array(panel.points) if panel.points else np.zeros((1, 2))
    low, high = points.min(axis=0), points.max(axis=0)
    return {"strokes": panel.strokes, "box": [float(x) for x in (low[0], high[0], low[1], high[1])]}


def written_places(design: Design, strokes: Sequence[Mapping[str, Any]], points: Any) -> dict[str, tuple[float, float]]:
    """Where in a drawing the parameters of a design are written: name to place, where a text says `k_1`, `N_2`, 35°.

    `strokes` have a count each and `points` (k, 2) are theirs one after the other, as `moving_strokes` gives them.
    """
    leaves = {name: (about.unit, value) for name, about, value in design.leaves()}
    degrees = {f"{np.rad2deg(value):.0f}°": name for name, (unit, value) in leaves.items()
               if unit == "rad" and isinstance(value, float)}  # fmt: skip
    found: dict[str, tuple[float, float]] = {}
    first = 0
    for stroke in strokes:
        for word in re.split(r"[\s,$]+", str(stroke.get("text", ""))):
            plain = re.sub(r"[_\\]", "", word)
            names = (plain, degrees.get(plain, ""), *SAID.get(plain, ()))
            for name in names:
                if name in leaves:
                    found.setdefault(name, (float(points[first][0]), float(points[first][1])))
        first += int(stroke["count"])
    return found


class Strokes:
    """A panel that keeps what is drawn on it: lines, arrows, circles, polygons and texts, with their roles."""

    def __init__(self) -> None:
        self.strokes: list[dict[str, Any]] = []
        self.points: list[tuple[float, float]] = []

    def plot(self, x: Any, y: Any, mark: str = "", **look: Any) -> None:
        """A line, or a dot where `mark` is "o"; a line that only widens the limits counts for the box."""
        places = list(zip(np.atleast_1d(x).astype(float), np.atleast_1d(y).astype(float), strict=True))
        self._reach(*places)
        if look.get("linestyle") == "none":
            return
        if mark == "o":
            self._keep("circle", look, at=_pair(places[0]), radius=0.03, filled=True)
        else:
            dashed = not isinstance(look.get("linestyle", "solid"), str)
            width = float(look.get("linewidth", 1.0))
            self._keep("line", look, points=[_pair(place) for place in places], width=width, dashed=dashed)

    def text(self, x: float, y: float, text: str, **look: Any) -> None:
        """A text; `$k_1$` is a symbol with a subscript."""
        self._reach((x, y))
        self._keep("text", look, at=_pair((x, y)), text=text, anchor=look.get("ha", "center"))

    def annotate(self, text: str, xy: Any, xytext: Any, arrowprops: Mapping[str, Any]) -> None:
        """An arrow from `xytext` to `xy`."""
        self._reach(xy, xytext)
        self._keep("arrow", arrowprops, start=_pair(xytext), end=_pair(xy))

    def add_patch(self, patch: Any) -> None:
        """A circle, rectangle, polygon or part of a ring of Matplotlib."""
        look = {"color": _hex(patch.get_edgecolor()), "fill": _hex(patch.get_facecolor())}
        if hasattr(patch, "get_center") and hasattr(patch, "get_radius"):
            (x, y), radius = patch.get_center(), float(patch.get_radius())
            self._reach((x - radius, y - radius), (x + radius, y + radius))
            self._keep("circle", look, at=_pair((x, y)), radius=radius)
            return
        path = patch.get_path().transformed(patch.get_patch_transform())
        outline = [place for polygon in path.to_polygons() for place in polygon]
        self._reach(*outline)
        self._keep("polygon", look, points=[_pair(place) for place in outline])

    def _keep(self, kind: str, look: Mapping[str, Any], **what: Any) -> None:
        what |= {"fill": look["fill"]} if "fill" in look else {}
        self.strokes.append({"kind": kind, "role": ROLES.get(str(look.get("color", "")), "body"), **what})

    def _reach(self, *places: Any) -> None:
        self.points += [(float(x), float(y)) for x, y in places]


def _pair(place: Any) -> list[float]:
    return [round(float(place[0]), 4), round(float(place[1]), 4)]


def _hex(colour: Any) -> str:
    red, green, blue = (round(255 * float(part)) for part in colour[:3])
    return f"#{red:02x}{green:02x}{blue:02x}"
