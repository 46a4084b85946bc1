"""A figure given as data as PDF, SVG or PNG, drawn with Matplotlib for paper, or its numbers as a table.

What comes from a page is not trusted: sizes are bounded, and what is no figure is a `NoFigure` with one sentence.
"""

import json
import threading
from collections.abc import Callable, Iterator
from itertools import zip_longest
from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.figure_data import Bars, FigureData, whole

if TYPE_CHECKING:
    from matplotlib.axes import Axes

LARGEST = 4_000_000  # bytes of a figure
DOTS, PNG_DOTS = 96.0, 300.0  # px of the page, and of a PNG, to an inch
KINDS = {"pdf": "application/pdf", "svg": "image/svg+xml", "png": "image/png", "csv": "text/csv"}
KINDS["tsv"] = "text/tab-separated-values"
BETWEEN = {"csv": ",", "tsv": "\t"}
SERIES = ("#0072b2", "#d55e00", "#009e73", "#b45a8d", "#3a96cf", "#b87f00", "#14181d")
DASHES = ("-", (0, (7, 2)), (0, (2, 2)), (0, (9, 3, 2, 3)), (0, (4, 2)), (0, (12, 3)), (0, (3, 3)))
MECHANISMS = ("#deebf7", "#d55e00", "#009e73", "#783c96", "#e69f00")
BANDS = {"unstable": "#f7e2d3", "operating": "#dfeee8", "together": "#ecd9ac"}
BARS = {"b0": "#d55e00", "b1": "#b87f00", "b2": "#0072b2"}
DECADES = 3.0
LEAST = (240.0, 180.0)  # px: smaller, words and axes have no room
_ONE = threading.Lock()  # Matplotlib's text is not made for several threads


class NoFigure(ValueError):
    """What was sent is no figure; the message is one sentence."""


def drawn_on_paper(figure: bytes | FigureData | Bars, kind: str = "pdf") -> bytes:
    """The file, one of KINDS, of a figure, or of what `figure_data.whole` makes of it as JSON.

    >>> from squealbox.figure_data import FigureAxis, line
    >>> axes = FigureAxis("time", "s", (0.0, 1.0)), FigureAxis("x", "mm", (0.0, 2.0))
    >>> print(drawn_on_paper(FigureData("motion", *axes, [line([0.0, 1.0], [0.5, 2.0], name="pad")]), "csv").decode())
    "pad: time [s]","pad: x [mm]"
    0,0.5
    1,2
    <BLANKLINE>
    """
    try:
        spec = json.loads(figure) if isinstance(figure, bytes) else whole(figure)
        if not isinstance(spec, dict):
            raise NoFigure("expected a figure")
        if kind in BETWEEN:
            return _table(spec, BETWEEN[kind]).encode()
        with _ONE:
            return _drawn(spec, kind)
    except NoFigure:
        raise
    except (ValueError, TypeError, LookupError, AttributeError, RecursionError, ArithmeticError) as error:
        raise NoFigure(f"this is no figure that can be drawn: {type(error).__name__}") from error


drawn = drawn_on_paper  # its name in former versions


def _table(spec: dict[str, Any], between: str) -> str:
    """The numbers drawn, a column each, with names and units in the first line."""
    found = list(_columns(spec))
    rows = [[name for name, _ in found], *zip_longest(*(values for _, values in found))]
    return "".join(between.join(map(_cell, row)) + "\n" for row in rows)


def _cell(value: Any) -> str:
    """A number with eight digits, a word in quotes, nothing where nothing is known."""
    if isinstance(value, str):
        return '"' + value.replace('"', '""') + '"'
    return f"{value:.8g}" if value is not None and np.isfinite(value) else ""


def _columns(spec: dict[str, Any]) -> Iterator[tuple[str, Any]]:
    """Each column with its name: of a picture, then of each layer."""
    if "bars" in spec:
        heads = (("name", "name"), (str(spec["label"]), "sum"))
        yield from ((head, [bar[key] for bar in spec["bars"]]) for head, key in heads)
        return
    x, y = (str(spec[way]["label"]) for way in ("x", "y"))
    if spec.get("heat"):
        values, ends = _grid(spec["heat"]), spec["heat"]["span"]
        along, up = np.meshgrid(*(np.linspace(a, b, n) for (a, b), n in zip(ends, values.shape[::-1], strict=True)))
        yield from ((x, along.ravel()), (y, up.ravel()), (str(spec["heat"]["name"]), values.ravel()))
    for i, layer in enumerate(spec["layers"], 1):
        name, kind = layer.get("name") or layer.get("column") or f"line {i}", layer["kind"]
        if layer.get("cls") == "measured":
            yield "measured", [layer.get("x", layer.get("y"))]
        if kind in ("line", "points"):
            yield from ((f"{name}: {label}", _numbers(layer[way])) for way, label in (("x", x), ("y", y)))
        if kind == "path":
            rings = [each for ring in layer["rings"] for each in (*ring, (np.nan, np.nan))]
            yield from ((f"{name}: {label}", [at[way] for at in rings]) for way, label in enumerate((x, y)))
        if kind == "hull":
            named = ((x, "x"), (f"least {y}", "low"), (f"largest {y}", "high"))
            yield from ((label, _numbers(layer[way])) for label, way in named)


def _grid(heat: dict[str, Any]) -> Any:
    """The values of a picture (rows from below, columns)."""
    return _numbers(np.ravel(heat["values"])).reshape(int(heat["rows"]), int(heat["columns"]))


def _drawn(spec: dict[str, Any], kind: str) -> bytes:
    from matplotlib.figure import Figure

    from squealbox import plots
    from squealbox.plots.style import styled

    width, height = (
        min(max(float(size), least), 4000.0) / DOTS for size, least in zip(spec["size"], LEAST, strict=True)
    )
    with styled(), np.errstate(all="ignore"):
        figure = Figure(figsize=(width, height), layout="constrained")
        panel = figure.add_subplot()
        if "bars" in spec:
            _bars(panel, spec)
        else:
            _axes(panel, spec)
        return plots.drawn(figure, kind, PNG_DOTS)


def _axes(panel: "Axes", spec: dict[str, Any]) -> None:
    for way in ("x", "y"):
        low, high = (float(end) for end in spec[way]["domain"])
        if not (np.isfinite([low, high]).all() and low != high):
            raise NoFigure("an axis needs two different ends")
        getattr(panel, f"set_{way}lim")(low, high)
        getattr(panel, f"set_{way}label")(str(spec[way]["label"])[:200])
    if spec.get("heat"):
        _picture(panel, spec["heat"])
    named: dict[str, Any] = {}
    for layer in spec["layers"]:
        drawn = DRAW[layer["kind"]](panel, layer)
        if layer.get("name") and drawn is not None:
            named.setdefault(str(layer["name"])[:100], drawn)
    if named:
        place = {"top": "upper", "bottom": "lower"}
        vertical, _, side = str(spec.get("legend", "top right")).partition(" ")
        corner: Any = f"{place.get(vertical, 'upper')} {side or 'right'}"
        panel.legend(list(named.values()), list(named), loc=corner)


def _numbers(values: Any) -> Any:
    return np.array([np.nan if value is None else value for value in values], dtype=float)


def _look(layer: dict[str, Any]) -> dict[str, Any]:
    look = str(layer.get("cls", "s0"))
    if look[:1] == "s" and look[1:2].isdigit():
        i = int(look[1]) % len(SERIES)
        thin = "thin" in look
        return {
            "color": SERIES[0 if thin else i],
            "linestyle": "-" if thin or "unbroken" in look else DASHES[i],
            "linewidth": 0.6 if thin else 0.9 if "unbroken" in look else 1.4,
        }
    width = {"boundary": 1.4, "tangent": 1.8}.get(look, 0.8)
    colour = {"tangent": SERIES[1], "axis-line": "#535c66", "measured": "#b3261e"}.get(look, "#14181d")
    return {"color": colour, "linestyle": {"present": "--", "measured": ":"}.get(look, "-"), "linewidth": width}


def _line(panel: "Axes", layer: dict[str, Any]) -> Any:
    return panel.plot(_numbers(layer["x"]), _numbers(layer["y"]), **_look(layer))[0]


def _points(panel: "Axes", layer: dict[str, Any]) -> Any:
    hollow = layer.get("cls") == "begin"
    size = min(float(layer.get("r", 4.5)), 20.0)
    about: dict[str, Any] = {
        "markersize": 1.3 * size,
        "color": "#14181d",
        "markerfacecolor": "white" if hollow else "#14181d",
    }
    return panel.plot(_numbers(layer["x"]), _numbers(layer["y"]), "o", **about)[0]


def _hull(panel: "Axes", layer: dict[str, Any]) -> Any:
    low, high = _numbers(layer["low"]), _numbers(layer["high"])
    return panel.fill_between(_numbers(layer["x"]), low, high, color=SERIES[0], alpha=0.75, linewidth=0.4)


def _path(panel: "Axes", layer: dict[str, Any]) -> Any:
    for ring in layer["rings"]:
        panel.plot(*np.asarray(ring, dtype=float).T, **_look(layer))


def _band(panel: "Axes", layer: dict[str, Any]) -> Any:
    colour = BANDS.get(str(layer.get("cls")), "#eeeeee")
    return panel.axvspan(float(layer["from"]), float(layer["to"]), color=colour, zorder=0, linewidth=0)


def _text(panel: "Axes", layer: dict[str, Any]) -> Any:
    about: dict[str, Any] = {
        "xytext": (0, 4),
        "textcoords": "offset points",
        "ha": "center",
        "fontsize": 8,
        "annotation_clip": True,
    }
    panel.annotate(str(layer["words"])[:200].replace("$", r"\$"), (float(layer["x"]), float(layer["y"])), **about)


DRAW: dict[str, Callable[[Any, dict[str, Any]], Any]] = {
    "line": _line,
    "points": _points,
    "hull": _hull,
    "path": _path,
    "band": _band,
    "text": _text,
    "across": lambda panel, layer: panel.axhline(float(layer["y"]), **_look(layer)),
    "upright": lambda panel, layer: panel.axvline(float(layer["x"]), **_look(layer)),
}


def _picture(panel: "Axes", heat: dict[str, Any]) -> None:
    """The picture with its colours told: the scales of the page's `colours.js`."""
    from matplotlib.colors import LinearSegmentedColormap, ListedColormap, LogNorm, Normalize, PowerNorm, TwoSlopeNorm

    values = _grid(heat)
    (left, right), (bottom, top) = heat["span"]
    across, up = (right - left) / (values.shape[1] - 1), (top - bottom) / (values.shape[0] - 1)
    extent = (left - across / 2, right + across / 2, bottom - up / 2, top + up / 2)
    pale = LinearSegmentedColormap.from_list("pale", ["#fafbfd", "#003c78"])
    high, low = float(np.nanmax(values)), float(np.nanmin(values))
    norm: Normalize = Normalize(low, high)
    colours: Any = pale
    if heat["scale"] == "mechanism":
        colours, norm = ListedColormap(MECHANISMS), Normalize(-0.5, len(MECHANISMS) - 0.5)
    elif heat["scale"] == "decades" and high > 0.0:
        norm = LogNorm(high * 10.0**-DECADES, high, clip=True)
    elif heat["scale"] == "diverging" and low < 0.0 < high:
        colours = LinearSegmentedColormap.from_list("growth", ["#286eaf", "#fcfcfc", "#c85000"])
        norm = TwoSlopeNorm(0.0, low, high)
    elif heat["scale"] == "diverging":
        colours = LinearSegmentedColormap.from_list(
            "growth", ["#fcfcfc", "#c85000"] if high > 0.0 else ["#286eaf", "#fcfcfc"]
        )
        norm = PowerNorm(1.0, low, high)
    smooth = "bilinear" if heat.get("smooth") else "nearest"
    about: dict[str, Any] = {"origin": "lower", "aspect": "auto", "extent": extent, "interpolation": smooth}
    shown = panel.imshow(values, cmap=colours, norm=norm, **about)
    bar = panel.figure.colorbar(shown, ax=panel, label=str(heat.get("name", ""))[:100])
    if heat["scale"] == "mechanism":
        names = [str(name)[:40] for name in heat["names"]][: len(MECHANISMS)]
        bar.set_ticks(range(len(names)), labels=names)


def _bars(panel: "Axes", spec: dict[str, Any]) -> None:
    names = [str(bar["name"])[:100] for bar in spec["bars"]]
    for i, bar in enumerate(spec["bars"]):
        ends = [0.0, 0.0]
        for look, value in bar["parts"]:
            size, side = float(value or 0.0), int((value or 0.0) < 0.0)
            panel.barh(i, size, left=ends[side], color=BARS.get(str(look), "#7a8a99"), height=0.65)
            ends[side] += size
    panel.set_yticks(range(len(names)), labels=names)
    panel.invert_yaxis()
    panel.axvline(0.0, color="#535c66", linewidth=0.8)
    panel.set_xlabel(str(spec.get("label", ""))[:200])
    for look, name in spec.get("legend") or ():
        panel.barh(0, 0.0, color=BARS.get(str(look), "#7a8a99"), label=str(name)[:60])
    if spec.get("legend"):
        panel.legend()
