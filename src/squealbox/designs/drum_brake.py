"""Drum brake with two shoes and two degrees of freedom, after the Journal of Vibroengineering paper 632 of 2011.

The drum is a mass on springs k1 (x) and k2 (y); shoe i touches it through contact stiffness k3 or k4 at its centre of
pressure theta_i. With s = sin theta_i and c = cos theta_i the spring line is e = (s, c), the sliding direction
tau = (c, -s), and

    M = diag(m, m)   C = diag(c1, c2)   K = diag(k1, k2) + k3 e1 e1' + k4 e2 e2'
    f = (N1 s1 - N2 s2, -N1 c1 + N2 c2)

The paper contradicts itself about friction, so its reading is a choice, made by `reading=`: which rows (n, d, t, V, N0)
the contacts have, and along which lines the loads act (f above is that of the printed readings); all of them stand in
`squealbox.designs.drum_brake_readings`. `docs/papers/drum_brake_2011` says what each does to the paper's claims.
"""

from typing import Any, ClassVar

import numpy as np

from squealbox.design import Design
from squealbox.designs.drum_brake_readings import ASSUMED_SLOPE, READINGS, TABLE_SPEED, Reading
from squealbox.designs.rows import matrix, vector
from squealbox.friction import LinearSlope
from squealbox.law import FrictionLaw
from squealbox.parameters import ParameterError, choice, parameter
from squealbox.schedules import as_schedule
from squealbox.shapes import RIGHT, STILL, UP, Moves, Shapes
from squealbox.system import System

TABLE = "nomenclature of the 2011 paper"
THETA1, THETA2 = np.deg2rad(35.0), np.deg2rad(115.0)


class Usual(float):
    """The value of the paper's table, in whose place a reading may have its own where nothing is given."""


USUAL_SPEED = Usual(TABLE_SPEED)
USUAL_FRICTION = LinearSlope(0.30, ASSUMED_SLOPE)


class DrumBrake(Design):
    """The drum brake of the 2011 paper; its table gives the defaults.

    `reading` is one of `eq1_printed` (Eq. 1 as printed), `eq3` (the linear form the paper analyses), `eq3_signed` (the
    same with the sign of each sliding component), `componentwise` (whole spring compression, sign by component) and
    `consistent` (one contact a shoe, sliding along its tangent), the default; or one of two that are not printed but
    inferred from the paper's numbers: `reconstructed`, which meets most of them, and `reconstructed_simple`, with fewer
    free choices. Suggestive, not proof: about one search in seven meets as many of the eigenvalue claims with scrambled
    numbers.

    Friction left out is LinearSlope(0.30, -0.05): the slope is not given in the paper and is an assumption here. With
    an inferred reading, friction and sliding speed left out are those it was found with: slope -0.0653 s/m at 1.48 m/s
    (`reconstructed`), -0.1 s/m at 1 m/s (`reconstructed_simple`). Given values are kept as given, and `replace` changes
    only what it names. Loads and sliding speed may be schedules.

    >>> DrumBrake(friction=LinearSlope(0.45, -0.05)).system().size
    2
    """

    title: ClassVar[str] = "Drum brake, two shoes, two degrees of freedom (2011)"
    source: ClassVar[str] = "Journal of Vibroengineering 13(2), paper 632, June 2011"
    aliases: ClassVar[dict[str, tuple[str, ...]]] = {"load": ("load1", "load2")}

    m: float = parameter("kg", 0.0, low_open=True, default=1.0, meaning="mass of the drum", source=TABLE)
    c1: float = parameter("N s/m", 0.0, default=218.0, meaning="damping in x", source=TABLE)
    c2: float = parameter("N s/m", 0.0, default=212.0, meaning="damping in y", source=TABLE)
    k1: float = parameter("N/m", 0.0, low_open=True, default=19e6, meaning="stiffness of the drum in x", source=TABLE)
    k2: float = parameter("N/m", 0.0, low_open=True, default=18e6, meaning="stiffness of the drum in y", source=TABLE)
    k3: float = parameter("N/m", 0.0, default=19e7, meaning="contact stiffness of shoe 1", source=TABLE)
    k4: float = parameter("N/m", 0.0, default=11e7, meaning="contact stiffness of shoe 2", source=TABLE)
    load1: Any = parameter("N", 0.0, default=1000.0, schedule=True, meaning="normal load on shoe 1", source=TABLE)
    load2: Any = parameter("N", 0.0, default=1000.0, schedule=True, meaning="normal load on shoe 2", source=TABLE)
    theta1: float = parameter("rad", -np.pi, np.pi, default=THETA1, meaning="centre of pressure, shoe 1", source=TABLE)
    theta2: float = parameter("rad", -np.pi, np.pi, default=THETA2, meaning="centre of pressure, shoe 2", source=TABLE)
    sliding_speed: Any = parameter(
        "m/s", default=USUAL_SPEED, schedule=True, meaning="speed of the belts, V_B", source=TABLE
    )
    friction: FrictionLaw = USUAL_FRICTION
    reading: str = choice(
        "eq1_printed",
        "eq3",
        "eq3_signed",
        "componentwise",
        "consistent",
        "reconstructed",
        "reconstructed_simple",
        default="consistent",
        meaning="how the paper's friction is read",
    )

    def __post_init__(self) -> None:
        own = (
            READINGS.get(self.reading) if isinstance(self.reading, str) else None
        )  # what is no reading is refused below
        if own is not None:
            if isinstance(self.sliding_speed, Usual):
                object.__setattr__(self, "sliding_speed", own.sliding_speed)
            if self.friction is USUAL_FRICTION:
                object.__setattr__(self, "friction", LinearSlope(USUAL_FRICTION.static, own.slope))
        super().__post_init__()
        if own is not None and own.inferred:
            object.__setattr__(self, "source", f"{type(self).source}; {self._inferred(own)}")

    def _inferred(self, own: Reading) -> str:
        """What to know of a reading that is not printed, and of one that is not run as it was found."""
        said = (
            f"its reading {self.reading} is inferred from its numbers, not printed, and scrambled numbers are met as "
            "well by one search in seven"
        )
        slope, speed = getattr(self.friction, "slope", None), self.sliding_speed
        if all(isinstance(x, float) for x in (slope, speed)) and (slope, speed) == (own.slope, own.sliding_speed):
            return said
        return f"{said}; it was found with a slope of {own.slope:g} s/m at {own.sliding_speed:g} m/s"

    def system(self) -> System:
        """The equation of motion in the chosen reading; leading axes of the parameters are kept."""
        s1, c1, s2, c2 = self.directions
        zero = np.zeros(np.broadcast_shapes(*(np.shape(x) for x in (self.m, self.k1, self.k3, self.k4, s1, s2))))
        mass = matrix((self.m + zero, zero), (zero, self.m + zero))
        damping = matrix((self.c1 + zero, zero), (zero, self.c2 + zero))
        cross = self.k3 * s1 * c1 + self.k4 * s2 * c2 + zero
        k11 = self.k1 + self.k3 * s1**2 + self.k4 * s2**2 + zero
        k22 = self.k2 + self.k3 * c1**2 + self.k4 * c2**2 + zero
        stiffness = matrix((k11, cross), (cross, k22))
        return System(mass, damping, stiffness, self._load(), READINGS[self.reading].contacts(self), names=("x", "y"))

    def draw(self, shapes: Shapes) -> None:
        """The drum as a mass, its two shoes at their angles from the y axis."""
        drum: Moves = {0: RIGHT, 1: UP}
        shapes.circle((0.0, 0.0), 0.8, moves=drum)
        shapes.text((-0.28, -0.28), "m", "m", "body", moves=drum)
        shoes = ((1, self.theta1, "$N_1$", "$k_3$", "k3", 0.3), (2, self.theta2, "$N_2$", "$k_4$", "k4", 0.52))
        for shoe, theta, load, spring, of, radius in shoes:
            out, across = np.array([np.sin(theta), np.cos(theta)]), np.array([np.cos(theta), -np.sin(theta)])
            shapes.line((0.0, 0.0), 0.8 * out, width=0.5, dashes=(4, 2), moves=(drum,))
            shapes.spring(0.82 * out, 1.5 * out, spring, of, moves=(drum, STILL))
            shapes.line(*(1.5 * out + s * across for s in (-0.3, 0.3)), role="part", width=4.0)
            shapes.load(2.05 * out, 1.56 * out, load, f"load{shoe}", 2.2 * out)
            name = f"{np.rad2deg(theta):.0f}°"
            shapes.arc((0.0, 0.0), radius, np.pi / 2, np.pi / 2 - theta, name, f"theta{shoe}", drum)
            shapes.contact(0.8 * out, -out, drum)
        shapes.line((0.0, 0.0), (0.0, 1.15), width=0.5, moves=(drum, STILL))
        shapes.text((-0.08, 1.1), "y", size=7.0)
        shapes.spring((-0.8, 0.0), (-1.5, 0.0), "$k_1$", "k1", moves=(drum, STILL))
        shapes.wall((-1.5, 0.0), 0.0)
        shapes.spring((0.0, -0.8), (0.0, -1.5), "$k_2$", "k2", moves=(drum, STILL))
        shapes.wall((0.0, -1.5), np.pi / 2)
        shapes.turning(0.95, np.deg2rad(250.0), np.deg2rad(195.0), "$V_B$", "sliding_speed")

    @property
    def directions(self) -> tuple[Any, Any, Any, Any]:
        """Sine and cosine of theta1, then of theta2."""
        return np.sin(self.theta1), np.cos(self.theta1), np.sin(self.theta2), np.cos(self.theta2)

    def _load(self) -> Any:
        s1, c1, s2, c2 = self.directions
        x1, y1, x2, y2 = READINGS[self.reading].load
        first, second = vector(x1 * s1, y1 * c1), vector(x2 * s2, y2 * c2)
        if isinstance(self.load1, (float, np.ndarray)) and isinstance(self.load2, (float, np.ndarray)):
            return np.asarray(self.load1)[..., None] * first + np.asarray(self.load2)[..., None] * second
        return as_schedule(self.load1) * first + as_schedule(self.load2) * second


def published_matrices(brake: DrumBrake) -> System:
    """The matrices of Eq. (3) exactly as printed, with the upper signs, as a system without contacts.

    N is put into the damping by hand here, c11 = c1 - alpha N (cos^2 theta1 + cos^2 theta2) and
    c22 = c2 - alpha N (sin^2 theta1 - sin^2 theta2), where the contact rows take it from the static compression of the
    springs. With alpha = 0 the stiffness equals reading `eq3`. Needs a `LinearSlope`; N is load1, V_B a number.
    """
    if not isinstance(brake.friction, LinearSlope):
        raise ParameterError("DrumBrake", "friction", brake.friction, "a LinearSlope: Eq. (3) is printed for that law")
    s1, c1, s2, c2 = brake.directions
    k3, k4, mu, alpha = brake.k3, brake.k4, brake.friction.static, -np.asarray(brake.friction.slope)
    lost = alpha * brake.sliding_speed
    k12 = k3 * (lost * c1**3 - mu * c1**2 + s1 * c1) + k4 * (-lost * c2**3 + mu * c2**2 + s2 * c2)
    k21 = k3 * (-lost * s1**3 + mu * s1**2 + s1 * c1) + k4 * (lost * s2**3 - mu * s2**2 + s2 * c2)
    k11, k22 = brake.k1 + k3 * s1**2 + k4 * s2**2, brake.k2 + k3 * c1**2 + k4 * c2**2
    c11 = brake.c1 - alpha * brake.load1 * (c1**2 + c2**2)
    c22 = brake.c2 - alpha * brake.load1 * (s1**2 - s2**2)
    mass = matrix((brake.m, 0.0), (0.0, brake.m))
    return System(mass, matrix((c11, 0.0), (0.0, c22)), matrix((k11, k12), (k21, k22)), brake._load(), names=("x", "y"))
