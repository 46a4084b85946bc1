"""The brake that moves: its drawing or surface, what each degree of freedom does to it, the mode that grows first."""

from typing import Any

import numpy as np

from squealbox.design import Design
from squealbox.fe import ReducedBrake
from squealbox.plots import largest_motion
from squealbox.shapes import drawing_of
from squealbox.system import equilibrium
from squealbox.workbench.panels.declared import Panel
from squealbox.workbench.panels.modes import modes_of, seen
from squealbox.workbench.panels.panel import Answer, Options, Work

PANEL = Panel("The brake, slowed down", questions=("why", "happens"), single=True)

SEEN = 0.05  # of the freedom that moves most: what moves less has no phase to tell


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Shapes, their motion for each freedom, forces of steady sliding, and a mode as real and imaginary part.

    Of a finite-element brake with a surface the mode is that of its nodes, (k, 3), the largest of them 1; the surface
    itself is the answer of the panel `mesh`.
    """
    system = design.system()
    surface = design.surface if isinstance(design, ReducedBrake) else None
    modes, state = modes_of(design), equilibrium(system)
    data: dict[str, Any] = {"names": list(system.names), "units": list(system.units)}
    data |= {"contactNames": list(system.contact_names), "normal": np.nan_to_num(state.normal_force).tolist()}
    arrays: dict[str, Any] = {}
    if surface is None:
        drawn = drawing_of(design)
        data |= drawn.data()
        moves = {"moves": drawn.moved(system.size), "contactMoves": drawn.contacts_moved(system.size)}
        arrays |= {"points": drawn.points, **moves}
    if not bool(modes.exists):
        return Answer({**data, "modes": [], "message": modes.outcome.message}, arrays)
    order, chosen = seen(design, options)
    mode = modes.mode(order[chosen])
    shape = mode.shape[: system.size]
    told = [(float(modes.frequency[i]), float(modes.growth_rate[i]), float(modes.damping_ratio[i])) for i in order]
    data |= {"modes": told, "mode": chosen}
    if surface is not None:
        moved = surface.moved(shape)
        data |= {"mesh": True, "words": largest_motion(surface, moved)}
        return Answer(data, {"re": moved.real, "im": moved.imag, "shares": surface.shares(moved)})
    press = [contact.n @ shape for contact in system.contacts]
    data |= {"words": f"{_phases(shape, system.names)}. Its size is free; growth is left out."}
    arrays |= {"re": shape.real, "im": shape.imag, "pressRe": np.real(press), "pressIm": np.imag(press)}
    return Answer(data, arrays)


def _phases(shape: Any, names: Any) -> str:
    """The phase of each freedom that moves much, against the one that moves most."""
    sizes = np.abs(shape)
    most = int(np.argmax(sizes))
    told = []
    for i in np.flatnonzero(sizes > SEEN * sizes[most]):
        if i != most:
            degrees = int(np.rint(np.rad2deg(np.angle(shape[i] / shape[most]))))
            way = "behind" if degrees < 0 else "before"
            told.append(f"{names[i]} {sizes[i] / sizes[most]:.2g} of {names[most]} and {abs(degrees)}° {way}")
    return ", ".join(told[:3]) or f"only {names[most]} moves"
