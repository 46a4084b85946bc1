"""The brake as its design draws it, for the page to draw."""

import numpy as np

from squealbox.design import Design
from squealbox.fe import ReducedBrake
from squealbox.shapes import drawing_of
from squealbox.workbench.panels.declared import Panel
from squealbox.workbench.panels.panel import Answer, Options, Work

PANEL = Panel("The brake", light=True)


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Shapes with their points and the box they fill; for a brake of one's own a box for each degree of freedom.

    Of a finite-element brake there are none: its surface is the answer of the panel `mesh`.
    """
    if isinstance(design, ReducedBrake):  # its coordinates are no places
        return Answer({"shapes": [], "box": [0.0, 1.0, 0.0, 1.0]}, {"points": np.zeros((0, 2))})
    found = drawing_of(design)
    return Answer(found.data(), {"points": found.points})
