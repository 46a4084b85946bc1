"""Pad on disc: two oscillators in the plane of sliding, with friction between them.

    m1 x1'' + c1 x1' + k1 x1 =  mu(|v|) sgn(v) N       pad
    m2 x2'' + c2 x2' + k2 x2 = -mu(|v|) sgn(v) N       disc,    v = V - (x1' - x2')

So the contact senses and acts along t = d = e_pad - e_disc. Linearised, C_eff = diag(c1, c2) + N mu'(V) [[1, -1],
[-1, 1]]: a falling friction curve (mu' < 0) takes damping out. With equal pad and disc the two modes are their sum,
with damping c, and their difference, with damping c + 2 N mu', so sliding is stable exactly while -N mu'(V) < c/2.
"""

from typing import Any, ClassVar

import numpy as np

from squealbox.design import Design
from squealbox.designs.rows import diagonal
from squealbox.friction import LinearSlope
from squealbox.law import FrictionLaw
from squealbox.parameters import parameter
from squealbox.shapes import DOWN, RIGHT, STILL, Shapes
from squealbox.system import Contact, System

OWN = "chosen here"


class PadOnDisc(Design):
    """A pad and a disc as two oscillators with friction between them, unstable where friction falls with speed.

    >>> PadOnDisc().system().names
    ('pad', 'disc')
    """

    title: ClassVar[str] = "Pad on disc, two degrees of freedom (2002)"
    source: ClassVar[str] = (
        "form of Shin, Brennan, Oh and Harris 2002, Journal of Sound and Vibration 254, 837-848; numbers chosen here"
    )

    m1: float = parameter("kg", 0.0, low_open=True, default=1.0, meaning="mass of the pad", source=OWN)
    m2: float = parameter("kg", 0.0, low_open=True, default=1.0, meaning="mass of the disc", source=OWN)
    c1: float = parameter("N s/m", 0.0, default=10.0, meaning="damping of the pad", source=OWN)
    c2: float = parameter("N s/m", 0.0, default=10.0, meaning="damping of the disc", source=OWN)
    k1: float = parameter("N/m", 0.0, low_open=True, default=1e6, meaning="stiffness of the pad", source=OWN)
    k2: float = parameter("N/m", 0.0, low_open=True, default=2e6, meaning="stiffness of the disc", source=OWN)
    load: Any = parameter("N", 0.0, default=1000.0, schedule=True, meaning="normal force", source=OWN)
    sliding_speed: Any = parameter("m/s", default=1.0, schedule=True, meaning="speed of the disc", source=OWN)
    friction: FrictionLaw = LinearSlope(0.6, -0.02, 0.0)

    def system(self) -> System:
        """The equation of motion; leading axes of the parameters are kept."""
        slip = np.array([1.0, -1.0])
        contact = Contact(np.zeros(2), slip, slip, self.load, self.sliding_speed, self.friction, name="pad")
        mass, damping = diagonal(self.m1, self.m2), diagonal(self.c1, self.c2)
        return System(mass, damping, diagonal(self.k1, self.k2), np.zeros(2), (contact,), names=("pad", "disc"))

    def draw(self, shapes: Shapes) -> None:
        """Pad on disc, a spring and a dashpot from each to a wall."""
        pad, disc = {0: RIGHT}, {1: RIGHT}
        shapes.box((-1.2, -0.45), 2.4, 0.42, "disc $m_2$", "m2", disc)
        shapes.box((-0.5, 0.0), 1.0, 0.42, "pad $m_1$", "m1", pad)
        shapes.spring((-1.6, 0.3), (-0.5, 0.3), "$k_1$", "k1", moves=(STILL, pad))
        shapes.dashpot((-1.6, 0.1), (-0.5, 0.1), moves=(STILL, pad))
        shapes.text((-1.28, -0.02), "$c_1$", "c1", size=7.0)
        shapes.wall((-1.6, 0.2), 0.0, 0.5)
        shapes.spring((-2.2, -0.15), (-1.2, -0.15), moves=(STILL, disc))
        shapes.text((-1.85, 0.05), "$k_2$", "k2")
        shapes.dashpot((-2.2, -0.36), (-1.2, -0.36), "$c_2$", "c2", -1.0, (STILL, disc))
        shapes.wall((-2.2, -0.25), 0.0, 0.5)
        shapes.velocity((-0.4, -0.68), (0.5, -0.68), "V", "sliding_speed", (0.05, -0.84))
        shapes.load((0.0, 1.0), (0.0, 0.45), "N", "load", (0.14, 0.9), pad)
        shapes.contact((0.0, 0.0), DOWN, pad)
