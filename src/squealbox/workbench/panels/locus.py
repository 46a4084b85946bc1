"""Eigenvalues of steady sliding over one parameter, each mode on a line of its own, and at the present design."""

from typing import Any

import numpy as np

from squealbox.designs import Design
from squealbox.stability import complex_modes, tracked_modes
from squealbox.workbench.panels.panel import Answer, Options, Work, axis_of, try_value

POINTS = 97  # values along the axis; about 15 ms for two degrees of freedom
FEWER = 61  # for designs of more degrees of freedom


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Frequency [Hz] and growth rate [1/s] of each mode along the axis, and the modes of the design itself."""
    parameter = options.parameter("parameter", design, "friction.static")
    low, high = options.span("span", design, parameter)
    here = complex_modes(design)
    half = here.eigenvalues.shape[-1] // 2
    values = np.linspace(low, high, POINTS if half <= 2 else FEWER)
    tracks = tracked_modes(design, parameter, values)
    upper = _one_of_each_pair(tracks.eigenvalues)
    axis = axis_of(design, parameter)
    data = {
        "axis": axis,
        "value": try_value(design, parameter),
        "outcome": str(here.outcome),
        "message": here.outcome.message,
        "stable": bool(here.stable),
    }
    arrays = {
        "value": values / axis["factor"],
        "frequency": np.abs(upper.imag).T / (2.0 * np.pi),
        "growth": upper.real.T,
        "hereFrequency": here.frequency[:half],
        "hereGrowth": here.growth_rate[:half],
    }
    return Answer(data, arrays)


def _one_of_each_pair(eigenvalues: Any) -> Any:
    """The tracks that start with Im >= 0: half of them, one of each conjugate pair."""
    known = np.isfinite(eigenvalues[:, 0].real)
    if not np.any(known):
        return eigenvalues[:, : eigenvalues.shape[1] // 2]
    first = eigenvalues[int(np.argmax(known))]
    order = np.argsort(-np.sign(np.round(first.imag, 9)), kind="stable")[: eigenvalues.shape[1] // 2]
    return eigenvalues[:, np.sort(order)]
