"""The surface of a finite-element brake, sent once: where its nodes, faces and contacts are."""

from squealbox.designs import Design
from squealbox.fe.reduced_brake import ReducedBrake
from squealbox.workbench.panels.panel import Answer, OptionError, Options, Work


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Places (k, 3) and contacts (c, 3) [m], faces (f, 4) and their part; the names of the parts."""
    surface = design.surface if isinstance(design, ReducedBrake) else None
    if surface is None:
        raise OptionError("this brake has no surface that is known here")
    arrays = {"places": surface.places, "faces": surface.faces, "parts": surface.parts, "touching": surface.touching}
    return Answer({"names": list(surface.names), "step": surface.step}, arrays)
