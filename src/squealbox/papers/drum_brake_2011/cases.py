"""What is run: a reading of the paper with the choices the paper leaves open, and the parameters of its studies."""

import dataclasses
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, Self

import numpy as np

from squealbox.designs import ASSUMED_SLOPE, READINGS, TABLE_SPEED, DrumBrake, published_matrices
from squealbox.friction import LinearSlope
from squealbox.schedules import Ramp
from squealbox.system import System

PRINTED = "published_matrices"
DEFAULT_READING = "consistent"
EIGENVALUES_ONLY = "published_matrices is linear: it has eigenvalues, but no motion limited by sgn."
INFERRED = tuple(name for name, reading in READINGS.items() if reading.inferred)
ALL_READINGS = (*(name for name in READINGS if name not in INFERRED), PRINTED, *INFERRED)
RECONSTRUCTED = INFERRED[0]

ALPHA = -ASSUMED_SLOPE  # s/m, an assumption: the paper takes it from another paper and does not print it
SPEED = TABLE_SPEED  # m/s, the paper's table
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


HALF, WHOLE = "half peak to peak", "peak to peak"
AMPLITUDES = {HALF: 1.0, WHOLE: 2.0}  # what an amplitude of the paper may mean, in halves


@dataclass(frozen=True, init=False)
class Case:
    """One reading with one choice of what the paper leaves open: alpha [s/m], sliding speed [m/s], floor of mu [-].

    What is not given is the reading's own: 0.05 s/m and 0.2 m/s for a printed one, what the search found for an
    inferred one. `amplitude` says what the paper's amplitudes are read as, `HALF` or `WHOLE`.
    """

    reading: str
    alpha: float
    speed: float
    floor: float | None
    amplitude: str

    def __init__(
        self,
        reading: str,
        alpha: float | None = None,
        speed: float | None = None,
        floor: float | None = None,
        amplitude: str | None = None,
    ) -> None:
        own = READINGS["eq3" if reading == PRINTED else reading]
        values = {
            "reading": reading,
            "alpha": -own.slope if alpha is None else alpha,
            "speed": own.sliding_speed if speed is None else speed,
            "floor": floor,
            "amplitude": (WHOLE if own.inferred else HALF) if amplitude is None else amplitude,
        }
        for name, value in values.items():
            object.__setattr__(self, name, value)

    @property
    def has_contacts(self) -> bool:
        """False for the printed matrices, which are linear: they have eigenvalues but no limit cycle."""
        return self.reading != PRINTED

    def replace(self, **changes: Any) -> Self:
        """The same with other choices."""
        return dataclasses.replace(self, **changes)

    def design(
        self,
        mu: Any = FRICTION,
        load: Any = LOAD,
        speed: Any = None,
        **changes: Any,
    ) -> Any:
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
