"""Pad on disc: two oscillators in the plane of sliding, with friction between them.

    m1 x1'' + c1 x1' + k1 x1 =  mu(|v|) sgn(v) N       pad
    m2 x2'' + c2 x2' + k2 x2 = -mu(|v|) sgn(v) N       disc,    v = V - (x1' - x2')

So the contact senses and acts along t = d = e_pad - e_disc. Linearised, C_eff = diag(c1, c2) + N mu'(V) [[1, -1],
[-1, 1]]: a falling friction curve (mu' < 0) takes damping out. With equal pad and disc the two modes are their sum,
with damping c, and their difference, with damping c + 2 N mu', so sliding is stable exactly while -N mu'(V) < c/2.
"""

from typing import Any, ClassVar

import numpy as np

from squealbox.designs.base import Design
from squealbox.designs.rows import diagonal
from squealbox.friction import FrictionLaw, LinearSlope
from squealbox.parameters import parameter
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
