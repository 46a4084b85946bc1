"""The brake as a list of strokes, from the same geometry as its figure (`plots.brake_drawing`): the page draws them."""

from squealbox.designs import Design
from squealbox.plots.strokes import brake_strokes
from squealbox.workbench.panels.panel import Answer, Options, Work


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Strokes with their coordinates, and the box they fill; none for a brake of one's own."""
    return Answer(brake_strokes(design))
