"""Brakes on paper, each a data sheet with a `system()`. Depends on: system, friction, schedules, parameters."""

from squealbox.designs.base import Design
from squealbox.designs.damping_paradox import DampingParadox
from squealbox.designs.drum_brake import DrumBrake, published_matrices
from squealbox.designs.drum_brake_shoes import DrumBrakeShoes
from squealbox.designs.mass_on_belt import BlockChain, MassOnBelt
from squealbox.designs.mode_coupling import InclinedSprings, ModeCoupling
from squealbox.designs.pad_on_disc import PadOnDisc
from squealbox.designs.sprag_slip import SpragSlip
from squealbox.designs.wobbling_disc import WobblingDisc

DESIGNS: dict[str, type[Design]] = {
    "drum_brake": DrumBrake,
    "drum_brake_shoes": DrumBrakeShoes,
    "mass_on_belt": MassOnBelt,
    "block_chain": BlockChain,
    "mode_coupling": ModeCoupling,
    "inclined_springs": InclinedSprings,
    "damping_paradox": DampingParadox,
    "pad_on_disc": PadOnDisc,
    "wobbling_disc": WobblingDisc,
    "sprag_slip": SpragSlip,
}

__all__ = [
    "DESIGNS",
    "BlockChain",
    "DampingParadox",
    "Design",
    "DrumBrake",
    "DrumBrakeShoes",
    "InclinedSprings",
    "MassOnBelt",
    "ModeCoupling",
    "PadOnDisc",
    "SpragSlip",
    "WobblingDisc",
    "published_matrices",
]
