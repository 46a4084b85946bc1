"""What is run: a reading of the paper with the choices the paper leaves open, and the parameters of its studies."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from squealbox.designs import DrumBrake, published_matrices
from squealbox.designs.drum_brake import READINGS
from squealbox.friction import LinearSlope
from squealbox.schedules import Ramp
from squealbox.system import System

PRINTED = "published_matrices"
DEFAULT_READING = "consistent"
ALL_READINGS = (*READINGS, PRINTED)

ALPHA = 0.05  # s/m, an assumption: the paper takes it from another paper and does not print it
SPEED = 0.2  # m/s, the paper's table
LOAD = 1000.0  # N, the paper's table
FRICTION = 0.30  # the paper's table

BRAKING = Ramp(start=0.2, slope=-4.0)  # m/s: 4 m/s^2 is the deceleration that stops 0.2 m/s in 0.05 s
DURATION = 0.05  # s
RESOLUTION = 2.0 * np.pi / DURATION  # rad/s: what a window of 0.05 s tells apart
MAP_ANGLES = (20.0, 160.0)  # deg, the range of the centre-of-pressure map


@dataclass(frozen=True)
class PrintedBrake:
    """The printed matrices of Eq. (3) in the place of a design: parameters can be replaced, and it makes a system."""

    brake: DrumBrake

    def replace(self, changes: Mapping[str, Any]) -> Self:
        """A copy with other values of the brake's parameters."""
        return dataclasses.replace(self, brake=self.brake.replace(changes))

    def system(self) -> System:
        """The linear system of the printed matrices."""
        return published_matrices(self.brake)


@dataclass(frozen=True)
class Case:
    """One reading with one choice of what the paper leaves open: alpha [s/m], sliding speed [m/s], floor of mu [-]."""

    reading: str
    alpha: float = ALPHA
    speed: float = SPEED
    floor: float | None = None

    @property
    def has_contacts(self) -> bool:
        """False for the printed matrices, which are linear: they have eigenvalues but no limit cycle."""
        return self.reading != PRINTED

    def replace(self, **changes: Any) -> Self:
        """The same with other choices."""
        return dataclasses.replace(self, **changes)

    def design(self, mu: Any = FRICTION, load: Any = LOAD, speed: Any = None, **changes: Any) -> Any:
        """The brake of this case; `mu`, `load` [N] and angles [rad] may be arrays, `speed` [m/s] a schedule."""
        brake = DrumBrake(
            reading=self.reading if self.has_contacts else "eq3",
            friction=LinearSlope(mu, -self.alpha, self.floor),
            load1=load,
            load2=load,
            sliding_speed=self.speed if speed is None else speed,
            **changes,
        )
        return brake if self.has_contacts else PrintedBrake(brake)
