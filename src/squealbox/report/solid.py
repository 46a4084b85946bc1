"""A finite-element brake vibrating in its worst mode: in 3-D to be turned, and as a picture for paper."""

import numpy as np

from squealbox.fe.meshed import MeshedBrake
from squealbox.fe.reduced_brake import ReducedBrake
from squealbox.fe.surface import Surface, with_surface
from squealbox.plots.surfaces import contact_pressure, largest_motion, mode_on_surface, outline
from squealbox.report.blocks import Drawing, Solid
from squealbox.report.examination import Examination
from squealbox.report.pictures import picture
from squealbox.stability import ComplexModes
from squealbox.stability.energy import contact_groups
from squealbox.system import equilibrium
from squealbox.words import quantity

MOST_FACES = 2500


def vibrating_solid(small: ReducedBrake, modes: ComplexModes) -> Solid | None:
    """The brake in its worst mode; None where its surface is not known."""
    surface = small.surface if small.full is None else with_surface(small, MOST_FACES).surface
    if not isinstance(surface, Surface):
        return None
    worst = modes.most_unstable
    moved = surface.moved(worst.shape)
    arrays = {
        "places": surface.places - surface.middle,
        "faces": surface.faces.ravel(),
        "parts": surface.parts,
        "touching": surface.next_to_contacts(),
        "re": moved.real,
        "im": moved.imag,
        "shares": surface.shares(moved),
        "outline": outline(surface).ravel(),
    }
    mode = f"The mode that grows first, {quantity(worst.frequency, 'Hz')}, slowed down and enlarged"
    lines = "" if surface.lone else "; lines: at rest"
    caption = f"{mode}{lines}. {largest_motion(surface, moved)}"
    drawing = picture(mode_on_surface(surface, moved), caption, "The brake vibrating in its worst mode")
    normal = tuple(float(force) for force in np.nan_to_num(modes.normal_force))
    return Solid(drawing, {"names": list(surface.names), "size": surface.size}, arrays, normal)


def pressed(found: Examination) -> Drawing | None:
    """The pressure on the linings of a brake that meshes itself, in steady sliding; None of any other."""
    whole, state = found.whole, equilibrium(found.system, found.time)
    if not isinstance(whole, MeshedBrake) or not bool(state.exists):
        return None
    preload = whole.preload(state)
    names = tuple(str(head).removesuffix(" point") for head in contact_groups(found.system.contact_names))
    up = int(np.sum(preload.lifted))
    caption = (
        f"Contact pressure in steady sliding: {up} of {len(preload.side)} points have lifted off (circles). "
        f"Largest {quantity(float(np.max(preload.pressure)), 'Pa', 3)}, "
        f"normal force {quantity(preload.force(0), 'N', 4)} and {quantity(preload.force(1), 'N', 4)}."
    )
    return picture(contact_pressure(preload, names), caption, "Contact pressure on both linings")
