"""The surface of a finite-element brake, sent once: where its nodes, faces and contacts are."""

import numpy as np

from squealbox.designs import Design
from squealbox.fe.reduced_brake import ReducedBrake
from squealbox.workbench.panels.panel import Answer, OptionError, Options, Work


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Places (k, 3) [m] about their middle, faces (f, 4) and their part, and the node (c,) next to each contact.

    `size` [m] is half the diagonal of their box.
    """
    surface = design.surface if isinstance(design, ReducedBrake) else None
    if surface is None:
        raise OptionError("this brake has no surface that is known here")
    low, high = surface.places.min(axis=0), surface.places.max(axis=0)
    data = {"names": list(surface.names), "step": surface.step, "size": 0.5 * float(np.linalg.norm(high - low))}
    nearest = [int(np.argmin(np.sum((surface.places - at) ** 2, axis=1))) for at in surface.touching]
    arrays = {"faces": surface.faces, "parts": surface.parts, "touching": np.array(nearest, dtype=int)}
    return Answer(data, {"places": surface.places - 0.5 * (low + high), **arrays})
