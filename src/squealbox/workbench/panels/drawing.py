"""The brake as a list of strokes, from the same geometry as its figure (`plots.brake_drawing`): the page draws them."""

from squealbox.designs import Design
from squealbox.plots.moving import moving_strokes
from squealbox.workbench.panels.panel import Answer, Options, Work


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Strokes with their points and the box they fill; for a brake of one's own a box for each degree of freedom."""
    found = moving_strokes(design)
    return Answer({"strokes": found["strokes"], "box": found["box"]}, {"points": found["points"]})
