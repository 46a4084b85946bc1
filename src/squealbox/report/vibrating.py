"""A brake vibrating in its worst mode: its drawing, or in 3-D to be turned, and as a picture for paper."""

import numpy as np

from squealbox import plots
from squealbox.design import Design
from squealbox.fe import MeshedBrake, ReducedBrake, with_surface
from squealbox.plots import contact_pressure, has_drawing, largest_motion, mode_on_surface, outline
from squealbox.report.blocks import Drawing, Vibrating
from squealbox.report.examination import Examination
from squealbox.report.pictures import picture
from squealbox.shapes import Surface, drawing_of
from squealbox.stability import ComplexModes, contact_groups
from squealbox.system import equilibrium
from squealbox.words import quantity

MOST_FACES = 2500
REACH = 0.14  # of the height of a drawing: the largest movement
ALT = "The brake vibrating in its worst mode"


def vibrating(design: Design, modes: ComplexModes) -> Vibrating | None:
    """The brake in its worst mode; None where it has no drawing that moves and no surface that is known."""
    if isinstance(design, ReducedBrake):
        return _solid(design, modes)
    if not has_drawing(design):
        return None
    drawn, worst, size = drawing_of(design), modes.most_unstable, design.system().size
    moved = np.tensordot(worst.shape[:size], drawn.moved(size), axes=1)
    whole, data = np.sum(np.abs(moved) ** 2, axis=1), drawn.data()
    largest = np.sqrt(0.5 * np.max(whole + np.abs(np.sum(moved**2, axis=1))))  # half the longest axis of the ellipses
    if not largest > 0.0:
        return None
    moved *= REACH * (data["box"][3] - data["box"][2]) / largest
    mode = f"The mode that grows first, {quantity(worst.frequency, 'Hz')}, slowed down."
    caption = f"{mode} Its size is free; growth is left out."
    still = picture(plots.brake_drawing(design), caption, ALT)
    return Vibrating(still, data, {"points": drawn.points, "re": moved.real, "im": moved.imag})


def _solid(small: ReducedBrake, modes: ComplexModes) -> Vibrating | None:
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
    drawing = picture(mode_on_surface(surface, moved), caption, ALT)
    normal = tuple(float(force) for force in np.nan_to_num(modes.normal_force))
    return Vibrating(drawing, {"names": list(surface.names), "size": surface.size}, arrays, normal)


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
