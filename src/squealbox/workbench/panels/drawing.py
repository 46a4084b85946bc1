"""The brake as a list of strokes, from the same geometry as its figure (`plots.brake_drawing`): the page draws them."""

import numpy as np

from squealbox.designs import Design
from squealbox.fe.reduced_brake import ReducedBrake
from squealbox.plots.moving import moving_strokes
from squealbox.workbench.panels.declared import Panel
from squealbox.workbench.panels.panel import Answer, Options, Work

PANEL = Panel("The brake", light=True)


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Strokes with their points and the box they fill; for a brake of one's own a box for each degree of freedom.

    Of a finite-element brake there are none: its surface is the answer of the panel `mesh`.
    """
    if isinstance(design, ReducedBrake):  # its coordinates are no places
        return Answer({"strokes": [], "box": [0.0, 1.0, 0.0, 1.0]}, {"points": np.zeros((0, 2))})
    found = moving_strokes(design)
    return Answer({"strokes": found["strokes"], "box": found["box"]}, {"points": found["points"]})
