"""The family of equations the search goes through: what Eq. (3) leaves open, every combination of it.

    row i:  F_i = front_i mu(|v_i|) sgn(v_i) (n_i.q + share_i N),   v_i = belt_i V |u_i| - (x' or y')

for shoe 1 and 2 along x, then along y, with u = cos theta along x and sin theta along y, and n_i.q = k u_i^2 y along
x, k u_i^2 x along y. Open are the four signs in front, the four signs of the belts, the loads (four signs of (N1 s1,
N1 c1, N2 s2, N2 c2)), which share of N enters friction, alpha, and alpha V. Both inferred readings are members.

Friction enters the stiffness by front x belt and alpha V alone. The static deflection is proportional to N, so the
damping is the table's minus N times something; the modes follow from both in closed form, with the damping taken to the
first order. What is found so is judged again by the program's own eigenvalues and transients.
"""

from dataclasses import dataclass
from itertools import product
from typing import Any, ClassVar

import numpy as np

from squealbox.design import Design
from squealbox.designs import DrumBrake
from squealbox.friction import LinearSlope
from squealbox.parameters import parameter
from squealbox.system import Contact, System

SIGNS = tuple(product((1.0, -1.0), repeat=4))  # sixteen
PRINTED_LOAD, PRINTED_BELTS = (1.0, -1.0, -1.0, 1.0), (1.0, -1.0, 1.0, 1.0)  # cos theta2 is negative
# Shares of N in friction, in the signs of `front`: none; the four that give Eq. (3)'s c11 = c1 +- and c22 = c2 +- ...;
# and all shoes pressed or all pulled by N itself, without the square of a cosine.
DAMPING = tuple((x, y) for x in (-1.0, 1.0) for y in (-1.0, 1.0))
SHARES = (
    "none",
    *(f"Eq. (3): {'+' if x > 0 else '-'} in x, {'+' if y > 0 else '-'} in y" for x, y in DAMPING),
    "+N",
    "-N",
)


@dataclass(frozen=True)
class TriedValues:
    """The values of alpha [s/m] and of alpha V [-] that are tried."""

    alpha: tuple[float, ...]
    product: tuple[float, ...]

    @property
    def size(self) -> int:
        """Variants for one choice of front and belts."""
        return len(SIGNS) * len(SHARES) * len(self.alpha) * len(self.product)


def _steps(low: float, high: float, step: float) -> tuple[float, ...]:
    return tuple(round(low + step * i, 6) for i in range(round((high - low) / step) + 1))


COARSE = TriedValues(_steps(0.05, 0.15, 0.025), _steps(0.0, 0.15, 0.005))
USUAL = TriedValues(_steps(0.03, 0.15, 0.0075), _steps(0.0, 0.15, 0.0025))


class Variant(Design):
    """One member of the family; `front`, `belts` and `loads` count in `SIGNS`, `share` in `SHARES`.

    >>> Variant(front=0.0).system().size
    2
    """

    title: ClassVar[str] = "A member of the family of equations searched for the 2011 paper"
    source: ClassVar[str] = "Eq. (1) and (3) of the paper, with what they leave open"

    front: float = parameter("-", 0.0, 15.0, default=5.0, meaning="signs in front of the friction forces")
    belts: float = parameter("-", 0.0, 15.0, default=4.0, meaning="signs of the belts' speeds")
    loads: float = parameter("-", 0.0, 15.0, default=12.0, meaning="signs of the loads")
    share: float = parameter("-", 0.0, 6.0, default=0.0, meaning="share of N in friction")
    alpha: float = parameter("s/m", 0.0, default=0.1, meaning="loss of friction per speed")
    sliding_speed: Any = parameter("m/s", default=1.0, schedule=True, meaning="speed of the belts, V_B")
    friction: LinearSlope = LinearSlope(0.3, 0.0)
    load: Any = parameter("N", 0.0, default=1000.0, meaning="normal load on both shoes")
    theta1: float = parameter("rad", default=float(DrumBrake.theta1), meaning="centre of pressure, shoe 1")
    theta2: float = parameter("rad", default=float(DrumBrake.theta2), meaning="centre of pressure, shoe 2")

    def system(self) -> System:
        """The equation of motion; leading axes of mu, load, speed and angles are kept."""
        brake = DrumBrake(reading="eq1_printed", theta1=self.theta1, theta2=self.theta2)
        bare = brake.system()
        s1, c1, s2, c2 = brake.directions
        front, belts, loads = (SIGNS[int(each)] for each in (self.front, self.belts, self.loads))
        law = LinearSlope(self.friction.static, self.friction.slope - self.alpha, self.friction.floor)
        components = (c1, c2, s1, s2)
        weights = tuple(each**2 for each in components)
        preloads = share_of_load(int(self.share), front, weights)
        zero = 0.0 * (c1 + c2)
        contacts = []
        for i, (name, k, axis) in enumerate(
            (("shoe 1 x", brake.k3, 0), ("shoe 2 x", brake.k4, 0), ("shoe 1 y", brake.k3, 1), ("shoe 2 y", brake.k4, 1))
        ):
            along = np.eye(2)[axis]
            n = front[i] * np.asarray(k * weights[i] + zero)[..., None] * np.eye(2)[1 - axis]
            speed = self.sliding_speed * (belts[i] * PRINTED_BELTS[i] * components[i])
            preload = np.asarray(self.load) * (front[i] * preloads[i])
            contacts.append(Contact(n, along, along, preload, speed, law, name=name))
        x = loads[0] * s1 + loads[2] * s2
        y = loads[1] * c1 + loads[3] * c2
        force = np.asarray(self.load)[..., None] * np.stack(np.broadcast_arrays(x, y), axis=-1)
        return System(bare.M, bare.C, bare.K, force, tuple(contacts), names=("x", "y"))


def share_of_load(share: int, front: tuple[float, ...], weights: tuple[Any, ...]) -> tuple[Any, ...]:
    """N0 of the four rows per newton of load, before the sign in front.

    For Eq. (3) the damping front_1 N0_1 + front_2 N0_2 is -+(cos^2 + cos^2), and along y -+(sin^2 - sin^2).
    """
    if share == 0:
        return (0.0,) * 4
    if share > len(DAMPING):
        return ((1.0, -1.0)[share - len(DAMPING) - 1],) * 4
    x, y = DAMPING[share - 1]
    signs = (-x, -x, -y, y)
    return tuple(sign * f * w for sign, f, w in zip(signs, front, weights, strict=True))
