"""A guided tour of the drum-brake paper of 2011: steps that set the design, and the verdicts on the paper's claims.

The verdicts are computed for the reading of the equations and the friction slope of the design that is shown, as
`squealbox paper drum-brake-2011` computes them for its readings.
"""

import tomllib
from importlib import resources
from typing import Any

import numpy as np

from squealbox.design import Design
from squealbox.designs import DrumBrake
from squealbox.friction import LinearSlope
from squealbox.papers import ALPHA, INFERRED, Case, Record, count, paper, verdicts
from squealbox.workbench.panels.declared import Panel
from squealbox.workbench.panels.panel import Answer, OptionError, Options, Work

PANEL = Panel("Tour: the drum-brake paper of 2011", questions=("tells",), slow=True, apart=True)

_READY: dict[Case, list[Record]] = {}  # of this server: some seconds each, and the same for everybody


def steps() -> dict[str, Any]:
    """The values of the paper's table, and the steps of the tour in order."""
    return tomllib.loads(resources.files(__package__).joinpath("tour.toml").read_text(encoding="utf-8"))


def answer(design: Design, options: Options, work: Work) -> Answer:
    """The verdict on each claim for the reading and slope of this design."""
    if not isinstance(design, DrumBrake) or not isinstance(design.friction, LinearSlope):
        raise OptionError("the claims are about the drum brake with a linear slope of friction: start the tour")
    slope = float(np.asarray(design.friction.slope))
    case = Case(design.reading, alpha=-slope)
    if case not in _READY:
        _READY[case] = verdicts(case, work.progress)
    found = _READY[case]
    claims = [
        {"id": each["id"], "statement": each["statement"], "published": each["published"], "verdict": each["verdict"],
         "computed": each["computed"].replace("_", " ")} for each in found
    ]  # fmt: skip
    return Answer({
        "reading": design.reading,
        "alpha": -slope,
        "assumed": abs(-slope - ALPHA) < 1e-12,
        "inferred": design.reading in INFERRED,
        "claims": claims,
        "count": count(found),
        "title": paper()["title"],
        "source": paper()["source"],
        **steps(),
    })  # fmt: skip
