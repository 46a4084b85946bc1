"""Results as figures as data: modes over a parameter, stability over two, a motion and its spectrum.

The values are those that are drawn on paper; nothing is computed here.
"""

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.figure_data import (
    FigureAxis,
    FigureData,
    across,
    band,
    heat,
    line,
    modes_named,
    path,
    points,
    span,
    upright,
)
from squealbox.words import scaled

MOST = 6000  # points of a line that are worth their bytes


def modes_over_parameter(
    axis: FigureAxis,
    x: ArrayLike,
    modes: Any,
    unstable: Sequence[tuple[float, float]],
    present: float | None = None,
    here: tuple[Any, Any] | None = None,
) -> list[FigureData]:
    """Frequencies and growth rates over an axis, and both in their plane.

    Parameters
    ----------
    x : (k,) values along the axis, in its unit
    modes : (k, m) [1/s] eigenvalues of m modes, one of each conjugate pair; NaN where a mode is not known
    unstable : stretches of the axis on which one grows, in its unit
    present : the value of the design itself, in the unit of the axis
    here : frequencies [Hz] and growth rates [1/s] of the design itself, each (j,), drawn as points
    """
    f, g = here or (np.zeros(0), np.zeros(0))
    factor, hertz = scaled("Hz", modes.imag / (2.0 * np.pi))
    frequency = list(np.abs(modes.imag).T / (2.0 * np.pi * factor))
    growth, count, f = list(modes.real.T), modes.shape[1], f / factor
    bands = [band(*ends) for ends in unstable]
    at = [] if present is None or here is None else [(np.full(len(f), present), y) for y in (f, g)]
    reach = span(*growth, g, zero=True)
    upward = FigureAxis("frequency", hertz, span(*frequency, f), factor=factor, quantity="frequency")
    rate = FigureAxis("growth rate", "1/s", reach, quantity="growth rate")
    begins = np.array([[g[0], f[0]] for g, f in zip(growth, frequency, strict=True) if np.isfinite(g[0] + f[0])])
    names = [modes_named(count, i) for i in range(count)]
    plain = [{**each, "name": ""} for each in names]
    dots = [points(x0, y, column="present design") for x0, y in at]
    return [
        FigureData("frequency", axis, upward, [
            *bands, *(line(x, y, **names[i]) for i, y in enumerate(frequency)), *dots[:1],
        ], "bottom right"),
        FigureData("growth", axis, rate, [
            *bands, across(0.0), *(line(x, y, **plain[i]) for i, y in enumerate(growth)), *dots[1:],
        ]),
        FigureData("plane", rate, upward, [
            band(0.0, reach[1]), upright(0.0, "axis-line"),
            *(line(a, b, **plain[i]) for i, (a, b) in enumerate(zip(growth, frequency, strict=True))),
            points(g, f, column="present design"),
            *([points(begins[:, 0], begins[:, 1], "begin", 3.0, column="first value")] if len(begins) else []),
        ]),
    ]  # fmt: skip


def map_over_two(
    x: FigureAxis,
    y: FigureAxis,
    growth: ArrayLike,
    frequency: ArrayLike,
    curves: Sequence[Any],
    here: tuple[float, float],
) -> FigureData:
    """Growth rate [1/s] over two axes, (ny, nx), read out with its frequency [Hz]; the boundary and the design.

    `here` is the place of the design, in the units of both axes.
    """
    beside = {"beside": frequency, "besideUnit": "Hz"}
    picture = heat(growth, "diverging", "growth rate", "1/s", words="orange squeals, blue is quiet", **beside)
    place = points([here[0]], [here[1]], "here big", 6.0, column="this design")
    return FigureData("map", x, y, [path(curves, "boundary"), place], heat=picture)


def motion_and_spectrum(
    t: Any,
    columns: Mapping[str, Any],
    spectra: Mapping[str, tuple[Any, Any]],
    upto: float,
    unit: str = "m",
) -> list[FigureData]:
    """Displacements [unit] over time t (k,) [s]; their spectra (frequency [Hz], amplitude) up to `upto` [Hz]."""
    stride = max(1, int(np.ceil(len(t) / MOST)))
    second, clock = scaled("s", t)
    factor, read = scaled(unit, *columns.values())
    hertz, pitch = scaled("Hz", np.array([upto]))
    size, told = scaled(unit, *(amplitude for _, amplitude in spectra.values()))
    looks = {name: f"s{i % 7} unbroken" for i, name in enumerate(columns)}
    moves = [line(t[::stride] / second, x[::stride] / factor, looks[name], name) for name, x in columns.items()]
    lines = [line(f[f <= upto] / hertz, a[f <= upto] / size, looks[name], name) for name, (f, a) in spectra.items()]
    time = FigureAxis("time", clock, (float(t[0] / second), float(t[-1] / second)))
    over = FigureAxis("frequency", pitch, (0.0, upto / hertz), factor=hertz, quantity="frequency")
    away = FigureAxis("displacement", read, span(*(each["y"] for each in moves)))
    high = FigureAxis("amplitude", told, span(*(each["y"] for each in lines), zero=True))
    return [FigureData("motion", time, away, moves), FigureData("spectrum", over, high, lines)]
