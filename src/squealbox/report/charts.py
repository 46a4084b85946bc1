"""Figures that a reader can point at and zoom into, as Plotly figures: data and layout as plain dictionaries.

The values are those of the drawing beside them; nothing is computed here.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np

from squealbox.plots.modes import unstable_stretches, upper_branches
from squealbox.plots.style import LINES
from squealbox.words import quantity_label, scaled

Figure = dict[str, Any]
DASHES = ("solid", "dash", "dot", "dashdot", "longdash")
SHADE = {"fillcolor": "#f6e6da", "line": {"width": 0}, "layer": "below"}
AXIS = {"ticks": "inside", "showline": True, "mirror": True, "linecolor": "#000000", "zeroline": False}
MOST = 6000  # points of a line that are worth their bytes


def modes_over_parameter(values: Any, modes: Any, name: str, unit: str, present: float) -> Figure:
    """Frequencies above, growth rates below, unstable stretches shaded, the present value as a line."""
    tracks = upper_branches(modes)
    factor, read = scaled("Hz", np.imag(tracks) / (2.0 * np.pi))
    data = []
    for i in range(tracks.shape[1]):
        line = {"color": LINES[i % len(LINES)][0], "dash": DASHES[i % len(DASHES)]}
        label = f"mode {i + 1}"
        hertz = np.imag(tracks[:, i]) / (2.0 * np.pi) / factor
        data.append(_line(values, hertz, label, line, yaxis="y"))
        data.append(_line(values, np.real(tracks[:, i]), label, line, yaxis="y2", showlegend=False))
    worst = np.fmax.reduce(np.real(modes.eigenvalues), axis=-1)
    shapes = [
        {"type": "rect", "x0": left, "x1": right, "yref": "paper", "y0": 0, "y1": 1, **SHADE}
        for left, right in unstable_stretches(values, worst)
    ]
    shapes.append(_upright(present))
    layout = _layout(quantity_label(name, unit), "")
    layout["xaxis"] |= {"anchor": "y2", "range": [values[0], values[-1]]}
    layout["yaxis"] = {**AXIS, "title": {"text": quantity_label("frequency", read)}, "domain": [0.48, 1.0]}
    layout["yaxis2"] = {**AXIS, "title": {"text": quantity_label("growth rate", "1/s")}, "domain": [0.0, 0.42]}
    layout["yaxis2"] |= {"zeroline": True}
    return {"data": data, "layout": {**layout, "shapes": shapes}}


def map_over_two(
    x: Any, y: Any, growth: Any, frequency: Any, names: Sequence[str], curves: Sequence[Any], here: tuple[float, float]
) -> Figure:
    """Growth rate over two parameters, white at zero, with the traced boundary and the design as a cross."""
    top = float(np.nanmax(np.abs(growth))) or 1.0
    scale = [[0.0, "#2166ac"], [0.5, "#ffffff"], [1.0, "#d6604d"]]
    heat = {
        "type": "heatmap", "x": x, "y": y, "z": growth, "customdata": frequency, "zmin": -top, "zmax": top,
        "colorscale": scale, "colorbar": {"title": {"text": "growth rate [1/s]", "side": "right"}},
        "hovertemplate": f"{names[0]} %{{x:.5g}}<br>{names[1]} %{{y:.5g}}<br>growth rate %{{z:.4g}} 1/s<br>"
        "%{customdata:.5g} Hz<extra></extra>",
    }  # fmt: skip
    data: list[Figure] = [heat]
    for i, points in enumerate(curves):
        line = {"color": "#000000", "width": 2}
        data.append(_line(points[:, 0], points[:, 1], "boundary of stability", line, showlegend=i == 0))
    data.append({
        "type": "scatter", "x": [here[0]], "y": [here[1]], "mode": "markers", "name": "this design",
        "marker": {"symbol": "x", "size": 11, "color": "#000000"},
    })  # fmt: skip
    layout = _layout(names[0], names[1])
    layout["xaxis"]["range"], layout["yaxis"]["range"] = [x[0], x[-1]], [y[0], y[-1]]
    layout["legend"] |= {"orientation": "h", "y": 1.12}
    return {"data": data, "layout": layout}


def motion_and_spectrum(
    t: Any, columns: dict[str, Any], spectra: dict[str, tuple[Any, Any]], upto: float, unit: str = "m"
) -> Figure:  # fmt: skip
    """Displacements over time, to be zoomed into, and below them their amplitude spectra up to a frequency [Hz]."""
    stride = max(1, int(np.ceil(len(t) / MOST)))
    second, clock = scaled("s", t)
    factor, read = scaled(unit, *columns.values())
    hertz, pitch = scaled("Hz", np.array([upto]))
    line_factor, line_read = scaled(unit, *(amplitude for _, amplitude in spectra.values()))
    data = []
    for i, (name, x) in enumerate(columns.items()):
        line = {"color": LINES[i % len(LINES)][0], "width": 1}
        data.append(_line(t[::stride] / second, x[::stride] / factor, name, line))
        if name in spectra:
            frequency, amplitude = spectra[name]
            low = frequency <= upto
            line = {"color": LINES[i % len(LINES)][0], "width": 1.5}
            across, up = frequency[low] / hertz, amplitude[low] / line_factor
            data.append(_line(across, up, name, line, xaxis="x2", yaxis="y2", showlegend=False))
    layout = _layout(quantity_label("time", clock), quantity_label("displacement", read))
    layout["yaxis"]["domain"] = [0.6, 1.0]
    layout["yaxis2"] = {
        **AXIS,
        "domain": [0.0, 0.38],
        "anchor": "x2",
        "title": {"text": quantity_label("amplitude", line_read)},
    }
    layout["xaxis"]["anchor"] = "y"
    layout["xaxis2"] = {**AXIS, "anchor": "y2", "title": {"text": quantity_label("frequency", pitch), "standoff": 8}}
    return {"data": data, "layout": layout}


def _line(x: Any, y: Any, name: str, line: Figure, **more: Any) -> Figure:
    return {"type": "scatter", "mode": "lines", "x": np.asarray(x), "y": np.asarray(y), "name": name, "line": line,
            **more}  # fmt: skip


def _upright(at: float) -> Figure:
    line = {"color": "#000000", "width": 1, "dash": "dot"}
    return {"type": "line", "x0": at, "x1": at, "yref": "paper", "y0": 0, "y1": 1, "line": line}


def _layout(x_title: str, y_title: str) -> Figure:
    return {
        "margin": {"l": 75, "r": 20, "t": 20, "b": 65},
        "font": {"family": "system-ui, sans-serif", "size": 13, "color": "#1c1d1f"},
        "paper_bgcolor": "#ffffff",
        "plot_bgcolor": "#ffffff",
        "hovermode": "closest",
        "xaxis": {**AXIS, "title": {"text": x_title, "standoff": 8}},
        "yaxis": {**AXIS, "title": {"text": y_title}},
        "legend": {"bgcolor": "rgba(255,255,255,0.8)"},
    }
