"""Eigenvalues of steady sliding over one parameter, each mode on a line of its own, and at the present design."""

from typing import Any

import numpy as np

from squealbox.designs import Design
from squealbox.fe.reduced_brake import ReducedBrake
from squealbox.words import scaled
from squealbox.workbench.figures import Axis, Figure, across, band, line, modes_named, points, span, upright
from squealbox.workbench.panels.declared import FRICTION, Panel, Place, over
from squealbox.workbench.panels.modes import modes_of, ranked, tracks_of
from squealbox.workbench.panels.panel import Answer, Options, Work, try_value

PANEL = Panel(
    "Modes over a parameter", questions=("why",), columns=2, choices=(over("over", "parameter", FRICTION),),
    layout="three",
    figures=(Place("frequency", "Frequency", 216), Place("growth", "Growth rate (above zero: squeal)", 216),
             Place("plane", "Eigenvalue plane", 216)),
)  # fmt: skip

POINTS = 97  # values along the axis; about 15 ms for two degrees of freedom
NONE = 1e-7  # growth rates up to this, or this share of themselves, are round-off
TURN = 2.0 * np.pi
FEWER = 61  # for designs of more degrees of freedom
LARGE, FEWEST = 40, 21  # and of many


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Frequency [Hz] and growth rate [1/s] of each mode along the axis, and the modes of the design itself."""
    parameter = options.parameter("parameter", design, "friction.static")
    low, high = options.span("span", design, parameter)
    here = modes_of(design)
    half = here.eigenvalues.shape[-1] // 2
    values = np.linspace(low, high, POINTS if half <= 2 else FEWER if half <= LARGE else FEWEST)
    tracks = tracks_of(design, parameter, (low, high), len(values))
    shown: Any = slice(half)
    if isinstance(design, ReducedBrake):  # its tracks are those of the band, the conjugates last
        shown, upper = ranked(design) if bool(here.exists) else [], np.split(tracks.eigenvalues, 2, axis=1)[0]
    else:
        upper = _one_of_each_pair(tracks.eigenvalues)
    axis = options.axis(design, parameter, (low, high))
    unstable = _unstable(values / axis.factor, upper.real)
    value = try_value(design, parameter)
    data = {
        "value": value,
        "outcome": str(here.outcome),
        "words": "" if here.outcome.ok else f"{here.outcome.message}.",
        "unstable": unstable,
        "marks": {"value": value},
    }
    present = None if value is None else value / axis.factor
    modes = (here.frequency[shown], here.growth_rate[shown])
    return Answer(data, figures=_figures(axis, values / axis.factor, upper, present, modes, unstable))


def _figures(axis: Axis, x: Any, upper: Any, present: float | None, here: Any, unstable: Any) -> list[Figure]:
    """Frequencies and growth rates over the axis, and both in their plane; the modes of the design itself as points."""
    factor, hertz = scaled("Hz", upper.imag / TURN)
    frequency = list(np.abs(upper.imag).T / (TURN * factor))
    growth, count = list(upper.real.T), upper.shape[1]
    f, g = here[0] / factor, here[1]
    bands = [band(*ends) for ends in unstable]
    at = [] if present is None else [(np.full(len(f), present), y) for y in (f, g)]
    high = span(*frequency, f)
    reach = span(*growth, g, zero=True)
    upward = Axis("frequency", hertz, high, factor=factor, quantity="frequency")
    rate = Axis("growth rate", "1/s", reach, quantity="growth rate")
    begins = np.array([[g[0], f[0]] for g, f in zip(growth, frequency, strict=True) if np.isfinite(g[0] + f[0])])
    names = [modes_named(count, i) for i in range(count)]
    plain = [{**each, "name": ""} for each in names]
    dots = [points(x0, y, column="present design") for x0, y in at]
    return [
        Figure("frequency", axis, upward, [
            *bands, *(line(x, y, **names[i]) for i, y in enumerate(frequency)), *dots[:1],
        ], "bottom right"),
        Figure("growth", axis, rate, [
            *bands, across(0.0), *(line(x, y, **plain[i]) for i, y in enumerate(growth)), *dots[1:],
        ]),
        Figure("plane", rate, upward, [
            band(0.0, reach[1]), upright(0.0, "axis-line"),
            *(line(a, b, **plain[i]) for i, (a, b) in enumerate(zip(growth, frequency, strict=True))),
            points(g, f, column="present design"),
            *([points(begins[:, 0], begins[:, 1], "begin", 3.0, column="first value")] if len(begins) else []),
        ]),
    ]  # fmt: skip


def _unstable(values: Any, growth: Any) -> list[list[float]]:
    """Stretches of the axis on which a mode grows, their ends where the largest growth rate passes zero."""
    known = np.any(np.isfinite(growth), axis=1)
    largest = np.nanmax(np.where(known[:, None], growth, 0.0), axis=1)
    grows = known & (largest > NONE * np.maximum(1.0, np.abs(largest)))
    edges = []
    for i in np.nonzero(np.diff(np.r_[False, grows, False].astype(int)))[0]:
        if i in (0, len(values)):
            edges.append(float(values[min(i, len(values) - 1)]))
            continue
        a, b = largest[i - 1], largest[i]
        share = np.clip(a / (a - b), 0.0, 1.0) if known[i - 1] and known[i] and a != b else 0.5
        edges.append(float(values[i - 1] + share * (values[i] - values[i - 1])))
    return [list(pair) for pair in zip(edges[::2], edges[1::2], strict=True)]


def _one_of_each_pair(eigenvalues: Any) -> Any:
    """The tracks that start with Im >= 0: half of them, one of each conjugate pair."""
    known = np.isfinite(eigenvalues[:, 0].real)
    if not np.any(known):
        return eigenvalues[:, : eigenvalues.shape[1] // 2]
    first = eigenvalues[int(np.argmax(known))]
    order = np.argsort(-np.sign(np.round(first.imag, 9)), kind="stable")[: eigenvalues.shape[1] // 2]
    return eigenvalues[:, np.sort(order)]
