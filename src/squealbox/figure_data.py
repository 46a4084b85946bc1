"""Figures as data: axes with units, layers, words, the same for the workbench, a report and Python.

The layers of a `FigureData` hold arrays; `packed` names each once, so that one that stands in several figures travels
once. A browser draws, reads out, zooms and saves them with `workbench/static/figures.js`; `paper` draws the same data
with Matplotlib.

>>> axis = FigureAxis("time", "s", (0.0, 1.0))
>>> figure = FigureData("time", axis, FigureAxis("x", "mm", (0.0, 1.0)), [line(np.zeros(9), np.ones(9), name="x")])
>>> packed([figure])[0][0]["layers"][0]["x"]
'@a0'
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.words import number, quantity_label

Layer = dict[str, Any]
FEW = 3  # numbers up to which an array travels in the header
SIZE = (600.0, 400.0)  # px of the page a figure has, where no page says
NAMED = 4  # curves up to which a legend helps


@dataclass(frozen=True)
class FigureAxis:
    """An axis: what it shows, the unit it is read in, its ends in that unit, and where it is over a parameter, which.

    `factor` is one of the unit in SI; `quantity` names what may be measured too ("frequency", "growth rate").
    """

    label: str
    unit: str
    domain: tuple[float, float]
    parameter: str = ""
    factor: float = 1.0
    quantity: str = ""

    def value(self, x: float | None, digits: int = 5) -> str:
        """An SI value as it is read on this axis, with its unit."""
        return "not known" if x is None else f"{number(x / self.factor, digits)} {self.unit}".strip()

    def data(self) -> dict[str, Any]:
        """For the page."""
        about = {"name": self.label, "unit": self.unit, "domain": list(self.domain), "factor": self.factor}
        marked = {"parameter": self.parameter, "quantity": self.quantity}
        return about | {name: text for name, text in marked.items() if text}


@dataclass(frozen=True)
class FigureData:
    """A figure: axes, layers from behind to the front, where the legend stands, and a picture of values beneath."""

    name: str
    x: FigureAxis
    y: FigureAxis
    layers: Sequence[Layer]
    legend: str = "top right"
    heat: Mapping[str, Any] | None = None


@dataclass(frozen=True)
class Bars:
    """Named bars to both sides of zero; `parts` of each are (look, value), `legend` tells the looks."""

    name: str
    label: str
    bars: Sequence[Mapping[str, Any]]
    legend: Sequence[tuple[str, str]] = ()


def line(x: ArrayLike, y: ArrayLike, look: str = "s0", name: str = "", column: str = "") -> Layer:
    """A line through points, broken where a number is not finite; `column` names it in files where no legend does."""
    return _layer("line", look, name, column, x=x, y=y)


def points(x: ArrayLike, y: ArrayLike, look: str = "here", r: float = 4.5, name: str = "", column: str = "") -> Layer:
    """Points of `r` pixels."""
    return _layer("points", look, name, column, x=x, y=y, r=r)


def hull(x: ArrayLike, low: ArrayLike, high: ArrayLike) -> Layer:
    """The area between two lines: what a line too dense to draw looks like."""
    return _layer("hull", "s0", x=x, low=low, high=high)


def across(y: float, look: str = "axis-line", name: str = "") -> Layer:
    """A line at one height."""
    return _layer("across", look, name, y=y)


def upright(x: float, look: str = "present") -> Layer:
    """A line at one place."""
    return _layer("upright", look, x=x)


def band(low: float, high: float, look: str = "unstable", name: str = "") -> Layer:
    """A stretch of the horizontal axis."""
    return {**_layer("band", look, name), "from": low, "to": high}


def text(x: float, y: float, words: str) -> Layer:
    """Words above a place."""
    return _layer("text", "label", x=x, y=y, words=words)


def path(rings: Sequence[Any], column: str = "") -> Layer:
    """Curves, each an array (points, 2)."""
    return _layer("path", "boundary", column=column, rings=[np.round(ring, 9).tolist() for ring in rings])


def heat(values: ArrayLike, scale: str, name: str, unit: str, **about: Any) -> dict[str, Any]:
    """A picture (rows from below, columns): `scale` is ``diverging``, ``sequential``, ``decades`` or ``mechanism``.

    Of `about`, ``words`` says what colours mean, ``names`` are those of codes, ``smooth`` blurs, and ``beside`` are
    numbers in ``besideUnit`` that are read out with the values.
    """
    return {"values": values, "scale": scale, "name": name, "unit": unit, **about}


def _layer(kind: str, look: str, name: str = "", column: str = "", **about: Any) -> Layer:
    words = {"name": name, "column": column}
    return {"kind": kind, "cls": look, **about, **{key: said for key, said in words.items() if said}}


def span(*arrays: Any, zero: bool = False, room: float = 0.06) -> tuple[float, float]:
    """The ends of an axis that holds all these numbers, a little wider; `zero` keeps zero inside.

    >>> span([0.0, 1.0], room=0.1)
    (-0.1, 1.1)
    """
    numbers = np.concatenate([np.ravel(np.asarray(each, dtype=float)) for each in arrays] or [np.zeros(0)])
    numbers = numbers[np.isfinite(numbers)]
    if zero:
        numbers = np.append(numbers, 0.0)
    if not numbers.size:
        return 0.0, 1.0
    low, high = float(np.min(numbers)), float(np.max(numbers))
    with np.errstate(over="ignore"):
        more = room * (high - low) or 0.1 * abs(high) or 1.0
    return low - more, high + more


def packed(figures: Iterable[FigureData | Bars]) -> tuple[list[dict[str, Any]], dict[str, Any]]:
    """The figures as plain data, in which ``"@name"`` stands for an array, and the arrays by name."""
    arrays: dict[str, Any] = {}
    known: dict[int, tuple[str, Any]] = {}

    def take(value: Any) -> Any:
        if not isinstance(value, (list, tuple, np.ndarray)):
            return value
        array = np.asarray(value, dtype=float)
        if array.ndim == 1 and array.size <= FEW:
            return array.tolist()
        if id(value) not in known:
            known[id(value)] = (f"a{len(arrays)}", value)  # kept, so that no other takes its place in memory
            arrays[known[id(value)][0]] = array
        return "@" + known[id(value)][0]

    return [_figure(figure, take) for figure in figures], arrays


def unpacked(data: Mapping[str, Any], arrays: Mapping[str, Any], name: str) -> dict[str, Any]:
    """The figure of that name in an answer, its arrays in place: what the page does, for clients in Python."""
    figure = next(each for each in data["figures"] if each["name"] == name)

    def read(value: Any) -> Any:
        return arrays[value[1:]] if isinstance(value, str) and value.startswith("@") else value

    heat = {key: read(value) for key, value in (figure.get("heat") or {}).items()}
    layers = [{key: read(value) for key, value in layer.items()} for layer in figure["layers"]]
    return {**figure, "layers": layers, "heat": heat}


def whole(figure: FigureData | Bars) -> dict[str, Any]:
    """A figure with its arrays and labels in place, as a page sends one to be drawn for paper."""
    (plain,), arrays = packed([figure])
    if isinstance(figure, Bars):
        return {**plain, "size": SIZE}
    found, ends = unpacked({"figures": [plain]}, arrays, figure.name), (figure.x.domain, figure.y.domain)
    axes = {way: {**found[way], "label": quantity_label(found[way]["name"], found[way]["unit"])} for way in ("x", "y")}
    if heat := found["heat"]:
        heat |= {"span": ends, "name": quantity_label(heat["name"], heat["unit"])}
    return {**found, **axes, "size": SIZE}


def _figure(figure: FigureData | Bars, take: Callable[[Any], Any]) -> dict[str, Any]:
    if isinstance(figure, Bars):
        bars = [{**bar, "parts": [list(part) for part in bar["parts"]]} for bar in figure.bars]
        return {
            "name": figure.name,
            "label": figure.label,
            "bars": bars,
            "legend": [list(each) for each in figure.legend],
        }
    about: dict[str, Any] = {"name": figure.name, "x": figure.x.data(), "y": figure.y.data(), "legend": figure.legend}
    if figure.heat is not None:
        rows, columns = np.shape(figure.heat["values"])
        taken = {name: take(value) if name in ("values", "beside") else value for name, value in figure.heat.items()}
        about["heat"] = {**taken, "rows": rows, "columns": columns}
    wrapped = ("x", "y", "low", "high")
    about["layers"] = [
        {key: take(value) if key in wrapped else value for key, value in layer.items()} for layer in figure.layers
    ]
    return about


def modes_named(count: int, i: int) -> dict[str, str]:
    """Look and names of one of several modes: named in a legend while there are few."""
    name = f"mode {i + 1}"
    return {"look": f"s{i % 7}", "column": name, "name": name if count <= NAMED else ""}
