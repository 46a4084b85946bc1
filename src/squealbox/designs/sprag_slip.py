"""Sprag-slip: a block held by an inclined strut that digs into the belt.

x is along the belt, y into it. The strut ks runs from the block forwards and away from the belt at the angle a to it,
along e = (cos a, -sin a); the contact is a spring k:

    m q'' + C q' + (ks e e' + k y y') q = (0, L) + (mu sgn(v) N, 0),    N = k y,   v = V - x'

Friction pushes the block against the strut, and the strut pushes it into the belt. Statically mu N = S cos a and
N = L + S sin a, so, whatever the stiffnesses,

    N = L/(1 - mu tan a),     det K_eff = ks k cos^2 a (1 - mu tan a)

The normal force grows without bound and steady sliding ends, by divergence, at mu = cot a: Spurr's condition.
The two coupling terms have the same sign, so there is no flutter.
"""

from typing import Any, ClassVar

import numpy as np

from squealbox.design import Design
from squealbox.designs.mode_coupling import X, Y
from squealbox.designs.rows import block, column, diagonal, outer, times, vector
from squealbox.friction import Coulomb
from squealbox.law import FrictionLaw
from squealbox.parameters import parameter
from squealbox.shapes import DOWN, RIGHT, STILL, Moves, Shapes
from squealbox.system import Contact, System

OWN = "chosen here"


class SpragSlip(Design):
    """A block held by an inclined strut that digs in: locked at a friction coefficient of cot(angle).

    >>> SpragSlip().system().size
    2
    """

    title: ClassVar[str] = "Sprag-slip, inclined strut (1961)"
    source: ClassVar[str] = (
        "idea of Spurr 1961, Proc. Instn Mech. Engrs (Automobile Division) 15, 33-52; elastic form chosen here"
    )

    m: float = parameter("kg", 0.0, low_open=True, default=1.0, meaning="mass of the block", source=OWN)
    c: float = parameter("N s/m", 0.0, default=20.0, meaning="damping of the block, both directions", source=OWN)
    ks: float = parameter("N/m", 0.0, low_open=True, default=4e6, meaning="axial stiffness of the strut", source=OWN)
    k: float = parameter("N/m", 0.0, low_open=True, default=1e7, meaning="contact stiffness", source=OWN)
    angle: float = parameter(
        "rad", 0.0, np.pi / 2, high_open=True, default=np.deg2rad(60.0), meaning="strut from the belt", source=OWN
    )
    load: Any = parameter("N", 0.0, default=100.0, schedule=True, meaning="load on the block, L", source=OWN)
    sliding_speed: Any = parameter("m/s", default=1.0, schedule=True, meaning="speed of the belt", source=OWN)
    friction: FrictionLaw = Coulomb(0.4)

    def system(self) -> System:
        """The equation of motion; leading axes of the parameters are kept."""
        strut = vector(np.cos(self.angle), -np.sin(self.angle))
        stiffness = block(self.ks) * outer(strut, strut) + block(self.k) * outer(Y, Y)
        contact = Contact(column(self.k) * Y, X, X, 0.0, self.sliding_speed, self.friction, "belt", False, Y)
        mass, damping = block(self.m) * np.eye(2), diagonal(self.c, self.c)
        return System(mass, damping, stiffness, times(self.load, Y), (contact,), names=("x", "y"))

    def draw(self, shapes: Shapes) -> None:
        """A block on a belt and its strut, to the angle."""
        block: Moves = {0: RIGHT, 1: DOWN}
        start, out = np.array([0.0, 0.23]), np.array([np.cos(self.angle), np.sin(self.angle)])
        shapes.belt(-1.3, 1.9)
        shapes.box((-0.3, 0.03), 0.6, 0.4, moves=block)
        shapes.text((-0.16, 0.3), "m", "m", "body", moves=block)
        shapes.spring(start, start + 1.6 * out, "$k_s$", "ks", moves=(block, STILL))
        shapes.wall(start + 1.6 * out, self.angle + np.pi)
        shapes.line((0.0, 0.23), (1.1, 0.23), width=0.5, dashes=(4, 2))
        shapes.arc((0.0, 0.23), 0.6, 0.0, self.angle, f"{np.rad2deg(self.angle):.0f}°", "angle")
        shapes.load((-0.18, 1.1), (-0.18, 0.46), "L", "load", (-0.32, 1.0), block)
        shapes.contact((0.0, 0.03), DOWN, block)
