"""Brakes on paper. Depends on: system, friction, schedules, parameters."""

from squealbox.designs.base import Design
from squealbox.designs.drum_brake import DrumBrake, published_matrices

DESIGNS: dict[str, type[Design]] = {"drum_brake": DrumBrake}

__all__ = ["DESIGNS", "Design", "DrumBrake", "published_matrices"]
