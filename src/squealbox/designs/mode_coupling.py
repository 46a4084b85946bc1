"""Mode coupling: a mass that moves along and towards a belt, in matrix form and with springs at angles.

x is along the belt, y towards it; the contact is a spring k3 whose force drives friction. With q measured from the
loaded state without friction,

    m x'' + c1 x' + k11 x + k12 y = mu sgn(v) N        N = N0 + k3 y
    m y'' + c2 y' + k12 x + k22 y = 0                   v = V - x'

where k22 holds k3 already. Linearised, the stiffness is [[k11, k12 - mu k3], [k12, k22]]. Without damping its two
eigenvalues meet (flutter begins) at mu k3 = k12 + (k11 - k22)^2/(4 k12). With k11 = k22 and damping c1, c2 the Hopf
point is, by Routh and Hurwitz, mu k3 = k12 + c1 c2 k11/(m k12) when both are positive.

With springs k1, k2 at angles a1, a2 from the belt, K = k1 e1 e1' + k2 e2 e2' + k3 y y', e = (cos a, sin a).
"""

from typing import Any, ClassVar

import numpy as np

from squealbox.design import Design
from squealbox.designs.rows import block, column, diagonal, matrix, outer, vector
from squealbox.friction import Coulomb
from squealbox.law import FrictionLaw
from squealbox.parameters import parameter
from squealbox.shapes import DOWN, RIGHT, STILL, Moves, Shapes
from squealbox.system import Contact, System

HOFFMANN = "normalised form of Hoffmann et al. 2002"
OWN = "chosen here"
# The two springs at right angles that make [[2, 1], [1, 1]], the stiffness of the normalised form without the contact:
# its eigenvalues (3 +- sqrt 5)/2 and the direction of its first eigenvector.
STIFF, SOFT = (3.0 + np.sqrt(5.0)) / 2.0, (3.0 - np.sqrt(5.0)) / 2.0
INCLINED = float(np.arctan((np.sqrt(5.0) - 1.0) / 2.0))
X, Y = np.array([1.0, 0.0]), np.array([0.0, 1.0])


class ModeCoupling(Design):
    """The two-degree-of-freedom model of mode coupling by its stiffness matrix, with or without damping.

    >>> ModeCoupling(friction=Coulomb(0.5)).system().size
    2
    """

    title: ClassVar[str] = "Mode coupling, two degrees of freedom (2002, 2003)"
    source: ClassVar[str] = (
        "Hoffmann, Fischer, Allgaier and Gaul 2002, Mech. Res. Comm. 29, 197-205; "
        "with damping Hoffmann and Gaul 2003, Z. Angew. Math. Mech. 83, 524-534"
    )

    m: float = parameter("kg", 0.0, low_open=True, default=1.0, meaning="mass", source=HOFFMANN)
    k11: float = parameter("N/m", 0.0, low_open=True, default=2.0, meaning="stiffness along the belt", source=HOFFMANN)
    k12: float = parameter("N/m", default=1.0, meaning="coupling stiffness", source=HOFFMANN)
    k22: float = parameter(
        "N/m", 0.0, low_open=True, default=2.0, meaning="stiffness towards the belt, k3 included", source=HOFFMANN
    )
    k3: float = parameter("N/m", 0.0, default=1.0, meaning="contact stiffness", source=HOFFMANN)
    c1: float = parameter("N s/m", 0.0, default=0.0, meaning="damping along the belt", source=HOFFMANN)
    c2: float = parameter("N s/m", 0.0, default=0.0, meaning="damping towards the belt", source=HOFFMANN)
    load: Any = parameter("N", 0.0, default=1.0, schedule=True, meaning="normal force without friction", source=OWN)
    sliding_speed: Any = parameter("m/s", default=1.0, schedule=True, meaning="speed of the belt", source=OWN)
    friction: FrictionLaw = Coulomb(0.5)

    def system(self) -> System:
        """The equation of motion; leading axes of the parameters are kept."""
        stiffness = matrix((self.k11, self.k12), (self.k12, self.k22))
        return _on_belt(self, stiffness, diagonal(self.c1, self.c2))

    def draw(self, shapes: Shapes) -> None:
        """The principal springs of the stiffness without the contact, at their angles."""
        _, vectors = np.linalg.eigh([[self.k11, self.k12], [self.k12, self.k22 - self.k3]])
        angles = [float(np.arctan2(-v[1], v[0])) for v in vectors.T]  # y is downwards in the picture
        _draw_on_belt(shapes, (angles[0], "soft", ""), (angles[1], "stiff", ""))


class InclinedSprings(Design):
    """Mode coupling in its geometric form: a mass on a belt, held by two springs at angles.

    The defaults are the springs at right angles that make the matrices of the normalised `ModeCoupling`.

    >>> np.round(InclinedSprings().system().K, 12).tolist()
    [[2.0, 1.0], [1.0, 2.0]]
    """

    title: ClassVar[str] = "Mode coupling with springs at angles"
    source: ClassVar[str] = "geometry of Hoffmann et al. 2002, Mech. Res. Comm. 29, 197-205; numbers chosen here"

    m: float = parameter("kg", 0.0, low_open=True, default=1.0, meaning="mass", source=HOFFMANN)
    k1: float = parameter("N/m", 0.0, low_open=True, default=STIFF, meaning="stiffness of spring 1", source=OWN)
    k2: float = parameter("N/m", 0.0, low_open=True, default=SOFT, meaning="stiffness of spring 2", source=OWN)
    k3: float = parameter("N/m", 0.0, default=1.0, meaning="contact stiffness", source=HOFFMANN)
    angle1: float = parameter(
        "rad", -np.pi, np.pi, default=INCLINED, meaning="angle of spring 1 from the belt", source=OWN
    )
    angle2: float = parameter(
        "rad", -np.pi, np.pi, default=INCLINED + np.pi / 2, meaning="angle of spring 2 from the belt", source=OWN
    )
    c1: float = parameter("N s/m", 0.0, default=0.0, meaning="dashpot along spring 1", source=OWN)
    c2: float = parameter("N s/m", 0.0, default=0.0, meaning="dashpot along spring 2", source=OWN)
    load: Any = parameter("N", 0.0, default=1.0, schedule=True, meaning="normal force without friction", source=OWN)
    sliding_speed: Any = parameter("m/s", default=1.0, schedule=True, meaning="speed of the belt", source=OWN)
    friction: FrictionLaw = Coulomb(0.5)

    def system(self) -> System:
        """The equation of motion; leading axes of the parameters are kept."""
        lines = [vector(np.cos(angle), np.sin(angle)) for angle in (self.angle1, self.angle2)]
        first, second = (outer(line, line) for line in lines)
        stiffness = block(self.k1) * first + block(self.k2) * second + block(self.k3) * outer(Y, Y)
        return _on_belt(self, stiffness, block(self.c1) * first + block(self.c2) * second)

    def draw(self, shapes: Shapes) -> None:
        """The springs at their angles."""
        _draw_on_belt(shapes, (-self.angle1, "$k_1$", "k1"), (-self.angle2, "$k_2$", "k2"))


def _on_belt(brake: "ModeCoupling | InclinedSprings", stiffness: np.ndarray, damping: np.ndarray) -> System:
    contact = Contact(column(brake.k3) * Y, X, X, brake.load, brake.sliding_speed, brake.friction, "belt", False, Y)
    return System(block(brake.m) * np.eye(2), damping, stiffness, np.zeros(2), (contact,), names=("x", "y"))


def _draw_on_belt(shapes: Shapes, *springs: tuple[float, str, str]) -> None:
    """A mass above a belt with its contact spring, and springs (angle to the belt [rad], text, parameters)."""
    mass: Moves = {0: RIGHT, 1: DOWN}
    centre = np.array([0.0, 0.85])
    shapes.belt(-1.7, 1.7)
    for angle, text, of in springs:
        way = angle if np.sin(angle) >= -1e-9 else angle + np.pi  # a spring has no sense: drawn away from the belt
        out = np.array([np.cos(way), np.sin(way)])
        shapes.spring(centre + 0.3 * out, centre + 1.5 * out, text, of, moves=(mass, STILL))
        shapes.wall(centre + 1.5 * out, way + np.pi)
    shapes.circle((0.0, 0.85), 0.3, moves=mass)
    shapes.text((0.0, 0.85), "m", "m", "body", moves=mass)
    shapes.spring((0.0, 0.55), (0.0, 0.04), "$k_3$", "k3", -1.0, (mass, STILL))
    shapes.load((0.0, 1.75), (0.0, 1.18), "N", "load", (-0.14, 1.65), mass)
    shapes.axis((1.55, 0.35), (2.0, 0.35), "x", (2.1, 0.35))
    shapes.axis((1.55, 0.35), (1.55, 0.07), "y", (1.42, 0.15))
    shapes.contact((0.0, 0.04), DOWN)
