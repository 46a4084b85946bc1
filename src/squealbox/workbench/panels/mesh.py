"""The surface of a finite-element brake, sent once: where its nodes, faces and contacts are."""

from squealbox.design import Design
from squealbox.fe import ReducedBrake
from squealbox.workbench.panels.declared import Panel
from squealbox.workbench.panels.panel import Answer, OptionError, Options, Work

PANEL = Panel("Its surface", light=True)


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Places (k, 3) [m] about their middle, faces (f, 4) and their part, and the node (c,) next to each contact.

    `size` [m] is half the diagonal of their box.
    """
    surface = design.surface if isinstance(design, ReducedBrake) else None
    if surface is None:
        raise OptionError("this brake has no surface that is known here")
    data = {"names": list(surface.names), "step": surface.step, "size": surface.size}
    arrays = {"faces": surface.faces, "parts": surface.parts, "touching": surface.next_to_contacts()}
    return Answer(data, {"places": surface.places - surface.middle, **arrays})
