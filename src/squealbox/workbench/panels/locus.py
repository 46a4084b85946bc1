"""Eigenvalues of steady sliding over one parameter, each mode on a line of its own, and at the present design."""

from typing import Any

import numpy as np

from squealbox.design import Design
from squealbox.fe import ReducedBrake
from squealbox.plots import modes_over_parameter, unstable_stretches
from squealbox.workbench.panels.declared import OVER, Panel, Place
from squealbox.workbench.panels.modes import modes_of, ranked, tracks_of
from squealbox.workbench.panels.panel import Answer, Options, Work, try_value

PANEL = Panel(
    "Modes over a parameter", questions=("why",), columns=2, choices=(OVER,),
    layout="three",
    figures=(Place("frequency", "Frequency", 216), Place("growth", "Growth rate (above zero: squeal)", 216),
             Place("plane", "Eigenvalue plane", 216)),
)  # fmt: skip

POINTS = 97  # values along the axis; about 15 ms for two degrees of freedom
FEWER = 61  # for designs of more degrees of freedom
LARGE, FEWEST = 40, 21  # and of many


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Frequency [Hz] and growth rate [1/s] of each mode along the axis, and the modes of the design itself."""
    parameter, (low, high) = options.over(design, OVER)
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
    unstable = unstable_stretches(values / axis.factor, np.fmax.reduce(upper.real, axis=1))
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


def _one_of_each_pair(eigenvalues: Any) -> Any:
    """The tracks that start with Im >= 0: half of them, one of each conjugate pair."""
    known = np.isfinite(eigenvalues[:, 0].real)
    if not np.any(known):
        return eigenvalues[:, : eigenvalues.shape[1] // 2]
    first = eigenvalues[int(np.argmax(known))]
    order = np.argsort(-np.sign(np.round(first.imag, 9)), kind="stable")[: eigenvalues.shape[1] // 2]
    return eigenvalues[:, np.sort(order)]
