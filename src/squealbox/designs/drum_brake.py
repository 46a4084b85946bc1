"""Drum brake with two shoes and two degrees of freedom, after the Journal of Vibroengineering paper 632 of 2011.

The drum is a mass on springs k1 (x) and k2 (y); shoe i touches it through contact stiffness k3 or k4 at its centre of
pressure theta_i. With s = sin theta_i and c = cos theta_i the spring line is e = (s, c), the sliding direction
tau = (c, -s), and

    M = diag(m, m)   C = diag(c1, c2)   K = diag(k1, k2) + k3 e1 e1' + k4 e2 e2'
    f = (N1 s1 - N2 s2, -N1 c1 + N2 c2)

The paper contradicts itself about friction, so its reading is a choice, made by `reading=`: which rows (n, d, t, V, N0)
the contacts have. `docs/papers/drum_brake_2011` says what each reading does to the paper's claims.
"""

from collections.abc import Callable
from typing import Any, ClassVar

import numpy as np

from squealbox.designs.base import Design
from squealbox.designs.rows import matrix, vector
from squealbox.friction import FrictionLaw, LinearSlope
from squealbox.parameters import ParameterError, choice, parameter
from squealbox.schedules import as_schedule
from squealbox.system import Contact, System

TABLE = "nomenclature of the 2011 paper"
THETA1, THETA2 = np.deg2rad(35.0), np.deg2rad(115.0)
DEFAULT_SLOPE = -0.05  # alpha is not in the paper; 0.05 s/m is an assumption, see docs/papers/drum_brake_2011


class DrumBrake(Design):
    """The drum brake of the 2011 paper; its table gives the defaults.

    `reading` is one of `eq1_printed` (Eq. 1 as printed), `eq3` (the linear form the paper analyses), `eq3_signed` (the
    same with the sign of each sliding component), `componentwise` (whole spring compression, sign by component) and
    `consistent` (one contact a shoe, sliding along its tangent), the default.

    The default friction is LinearSlope(0.30, -0.05): the slope is not given in the paper and is an assumption here.
    Loads and sliding speed may be schedules.

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
    sliding_speed: Any = parameter("m/s", default=0.2, schedule=True, meaning="speed of the belts, V_B", source=TABLE)
    friction: FrictionLaw = LinearSlope(0.30, DEFAULT_SLOPE)
    reading: str = choice(
        "eq1_printed",
        "eq3",
        "eq3_signed",
        "componentwise",
        "consistent",
        default="consistent",
        meaning="how the paper's friction is read",
    )

    def system(self) -> System:
        """The equation of motion in the chosen reading; leading axes of the parameters are kept."""
        s1, c1, s2, c2 = self._angles()
        zero = np.zeros(np.broadcast_shapes(*(np.shape(x) for x in (self.m, self.k1, self.k3, self.k4, s1, s2))))
        mass = matrix((self.m + zero, zero), (zero, self.m + zero))
        damping = matrix((self.c1 + zero, zero), (zero, self.c2 + zero))
        cross = self.k3 * s1 * c1 + self.k4 * s2 * c2 + zero
        k11 = self.k1 + self.k3 * s1**2 + self.k4 * s2**2 + zero
        k22 = self.k2 + self.k3 * c1**2 + self.k4 * c2**2 + zero
        stiffness = matrix((k11, cross), (cross, k22))
        return System(mass, damping, stiffness, self._load(), READINGS[self.reading](self), names=("x", "y"))

    def _angles(self) -> tuple[Any, Any, Any, Any]:
        return np.sin(self.theta1), np.cos(self.theta1), np.sin(self.theta2), np.cos(self.theta2)

    def _load(self) -> Any:
        s1, c1, s2, c2 = self._angles()
        first, second = vector(s1, -c1), vector(-s2, c2)
        if isinstance(self.load1, (float, np.ndarray)) and isinstance(self.load2, (float, np.ndarray)):
            return np.asarray(self.load1)[..., None] * first + np.asarray(self.load2)[..., None] * second
        return as_schedule(self.load1) * first + as_schedule(self.load2) * second


def _componentwise(brake: DrumBrake, rows: list[tuple[str, Any, Any, Any, Any]]) -> tuple[Contact, ...]:
    """Contacts acting and sensing along x or y, from rows of (name, n_x, n_y, axis, sliding speed)."""
    axes = {"x": np.array([1.0, 0.0]), "y": np.array([0.0, 1.0])}
    return tuple(
        Contact(vector(nx, ny), axes[axis], axes[axis], 0.0, speed, brake.friction, name=name)
        for name, nx, ny, axis, speed in rows
    )


def _eq1_printed(brake: DrumBrake) -> tuple[Contact, ...]:
    s1, c1, s2, c2 = brake._angles()
    k3, k4, speed = brake.k3, brake.k4, brake.sliding_speed
    return _componentwise(brake, [
        ("shoe 1 x", k3 * s1**2, 0.0, "x", speed * c1),
        ("shoe 2 x", -k4 * s2**2, 0.0, "x", speed * c2),
        ("shoe 1 y", 0.0, -k3 * c1**2, "y", speed * s1),
        ("shoe 2 y", 0.0, k4 * c2**2, "y", speed * s2),
    ])  # fmt: skip


def _eq3_rows(brake: DrumBrake, speed1: Any, speed2: Any) -> tuple[Contact, ...]:
    s1, c1, s2, c2 = brake._angles()
    k3, k4, speed = brake.k3, brake.k4, brake.sliding_speed
    return _componentwise(brake, [
        ("shoe 1 x", 0.0, k3 * c1**2, "x", speed1),
        ("shoe 2 x", 0.0, -k4 * c2**2, "x", speed2),
        ("shoe 1 y", -k3 * s1**2, 0.0, "y", speed * s1),
        ("shoe 2 y", k4 * s2**2, 0.0, "y", speed * s2),
    ])  # fmt: skip


def _eq3(brake: DrumBrake) -> tuple[Contact, ...]:
    _, c1, _, c2 = brake._angles()
    return _eq3_rows(brake, brake.sliding_speed * np.abs(c1), brake.sliding_speed * np.abs(c2))


def _eq3_signed(brake: DrumBrake) -> tuple[Contact, ...]:
    _, c1, _, c2 = brake._angles()
    return _eq3_rows(brake, brake.sliding_speed * c1, brake.sliding_speed * c2)


def _whole_compression(brake: DrumBrake) -> tuple[Contact, ...]:
    s1, c1, s2, c2 = brake._angles()
    k3, k4, speed = brake.k3, brake.k4, brake.sliding_speed
    return _componentwise(brake, [
        ("shoe 1 x", k3 * c1 * s1, k3 * c1 * c1, "x", speed * c1),
        ("shoe 2 x", -k4 * c2 * s2, -k4 * c2 * c2, "x", speed * c2),
        ("shoe 1 y", -k3 * s1 * s1, -k3 * s1 * c1, "y", speed * s1),
        ("shoe 2 y", k4 * s2 * s2, k4 * s2 * c2, "y", speed * s2),
    ])  # fmt: skip


def _consistent(brake: DrumBrake) -> tuple[Contact, ...]:
    s1, c1, s2, c2 = brake._angles()
    rows = (("shoe 1", brake.k3, s1, c1, brake.load1), ("shoe 2", brake.k4, s2, c2, brake.load2))
    return tuple(
        Contact(
            n=vector(k * s, k * c),
            d=vector(c, -s),
            t=vector(c, -s),
            N0=load,
            V=brake.sliding_speed,
            law=brake.friction,
            name=name,
            normal=vector(s, c),
        )
        for name, k, s, c, load in rows
    )


READINGS: dict[str, Callable[[DrumBrake], tuple[Contact, ...]]] = {
    "eq1_printed": _eq1_printed,
    "eq3": _eq3,
    "eq3_signed": _eq3_signed,
    "componentwise": _whole_compression,
    "consistent": _consistent,
}


def published_matrices(brake: DrumBrake) -> System:
    """The matrices of Eq. (3) exactly as printed, with the upper signs, as a system without contacts.

    N is put into the damping by hand here, c11 = c1 - alpha N (cos^2 theta1 + cos^2 theta2) and
    c22 = c2 - alpha N (sin^2 theta1 - sin^2 theta2), where the contact rows take it from the static compression of the
    springs. With alpha = 0 the stiffness equals reading `eq3`. Needs a `LinearSlope`; N is load1, V_B a number.
    """
    if not isinstance(brake.friction, LinearSlope):
        raise ParameterError("DrumBrake", "friction", brake.friction, "a LinearSlope: Eq. (3) is printed for that law")
    s1, c1, s2, c2 = brake._angles()
    k3, k4, mu, alpha = brake.k3, brake.k4, brake.friction.static, -np.asarray(brake.friction.slope)
    lost = alpha * brake.sliding_speed
    k12 = k3 * (lost * c1**3 - mu * c1**2 + s1 * c1) + k4 * (-lost * c2**3 + mu * c2**2 + s2 * c2)
    k21 = k3 * (-lost * s1**3 + mu * s1**2 + s1 * c1) + k4 * (lost * s2**3 - mu * s2**2 + s2 * c2)
    k11, k22 = brake.k1 + k3 * s1**2 + k4 * s2**2, brake.k2 + k3 * c1**2 + k4 * c2**2
    c11 = brake.c1 - alpha * brake.load1 * (c1**2 + c2**2)
    c22 = brake.c2 - alpha * brake.load1 * (s1**2 - s2**2)
    mass = matrix((brake.m, 0.0), (0.0, brake.m))
    return System(mass, matrix((c11, 0.0), (0.0, c22)), matrix((k11, k12), (k21, k22)), brake._load(), names=("x", "y"))
