"""Brakes on paper, each a data sheet with a `system()`."""

from squealbox.design import Design
from squealbox.designs.damping_paradox import DampingParadox
from squealbox.designs.drum_brake import DrumBrake, published_matrices
from squealbox.designs.drum_brake_readings import ASSUMED_SLOPE as ASSUMED_SLOPE
from squealbox.designs.drum_brake_readings import READINGS as READINGS
from squealbox.designs.drum_brake_readings import TABLE_SPEED as TABLE_SPEED
from squealbox.designs.drum_brake_shoes import DrumBrakeShoes
from squealbox.designs.mass_on_belt import BlockChain, MassOnBelt
from squealbox.designs.mechanism import Body, OwnMechanism, Spring, Touch
from squealbox.designs.mode_coupling import InclinedSprings, ModeCoupling
from squealbox.designs.own_brake import OwnBrake, OwnContact, Part
from squealbox.designs.pad_on_disc import PadOnDisc
from squealbox.designs.sprag_slip import SpragSlip
from squealbox.designs.wobbling_disc import WobblingDisc
from squealbox.registers import kinds_in, name_of
from squealbox.shapes import DrawnShape, Shapes, drawing_of

_FIRST = (  # in the order of the story; a design in a further file of this folder stands behind them
    DrumBrake, DrumBrakeShoes, MassOnBelt, BlockChain, ModeCoupling, InclinedSprings, DampingParadox, PadOnDisc,
    WobblingDisc, SpragSlip,
)  # fmt: skip
_OWN = (OwnBrake, OwnMechanism)  # which a user fills
DESIGNS: dict[str, type[Design]] = {
    name_of(kind): kind for kind in kinds_in(__name__, Design, _FIRST, having="title") if kind not in (Design, *_OWN)
}
globals().update({kind.__name__: kind for kind in DESIGNS.values()})

__all__ = [
    "DESIGNS",
    "Body",
    "Design",
    "DrawnShape",
    "OwnBrake",
    "OwnContact",
    "OwnMechanism",
    "Part",
    "Shapes",
    "Spring",
    "Touch",
    "drawing_of",
    "published_matrices",
]  # fmt: skip
__all__ += [kind.__name__ for kind in DESIGNS.values()]
