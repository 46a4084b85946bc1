"""Eigenvalues of steady sliding over one parameter, each mode on a line of its own, and at the present design."""

from typing import Any

import numpy as np

from squealbox.designs import Design
from squealbox.fe.reduced_brake import ReducedBrake
from squealbox.plots.as_data import modes_over_parameter
from squealbox.workbench.panels.modes import modes_of, ranked, tracks_of
from squealbox.workbench.panels.panel import Answer, Options, Work, try_value

POINTS = 97  # values along the axis; about 15 ms for two degrees of freedom
NONE = 1e-7  # growth rates up to this, or this share of themselves, are round-off
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
    return Answer(data, figures=modes_over_parameter(axis, values / axis.factor, upper, unstable, present, modes))


def _unstable(values: Any, growth: Any) -> list[tuple[float, float]]:
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
    return list(zip(edges[::2], edges[1::2], strict=True))


def _one_of_each_pair(eigenvalues: Any) -> Any:
    """The tracks that start with Im >= 0: half of them, one of each conjugate pair."""
    known = np.isfinite(eigenvalues[:, 0].real)
    if not np.any(known):
        return eigenvalues[:, : eigenvalues.shape[1] // 2]
    first = eigenvalues[int(np.argmax(known))]
    order = np.argsort(-np.sign(np.round(first.imag, 9)), kind="stable")[: eigenvalues.shape[1] // 2]
    return eigenvalues[:, np.sort(order)]
