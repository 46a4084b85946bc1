"""Destabilisation by damping: a mass between two sliding contacts at right angles.

Contact 1 has its normal along x and drags the mass along -y, contact 2 has its normal along y and drags it along x:

    N1 = N0 + k1 x,   N2 = N0 + k2 y
    m x'' + c1 x' + k1 x =  mu sgn(v2) N2,   v2 = V - x'
    m y'' + c2 y' + k2 y = -mu sgn(v1) N1,   v1 = V + y'

with q measured from the loaded state without friction, c_i = eta_i sqrt(k_i m) and w_i^2 = k_i/m. Linearised,

    K/m = [[w1^2, -mu w2^2], [mu w1^2, w2^2]],   C/m = diag(eta1 w1, eta2 w2)

Undamped, the frequencies meet at mu = |w1^2 - w2^2|/(2 w1 w2). Damped, the Hopf point is exactly (a_i = eta_i w_i)

    w_H^2 = (a1 w2^2 + a2 w1^2)/(a1 + a2),   mu_H^2 = [a1 a2 w_H^2 + (w1^2 - w_H^2)(w_H^2 - w2^2)]/(w1 w2)^2

which falls far below the undamped value when a1 and a2 differ: damping of one side alone destabilises.
"""

from typing import Any, ClassVar

import numpy as np

from squealbox.design import Design
from squealbox.designs.mode_coupling import X, Y
from squealbox.designs.rows import block, column, diagonal
from squealbox.friction import Coulomb
from squealbox.law import FrictionLaw
from squealbox.parameters import parameter
from squealbox.shapes import DOWN, RIGHT, STILL, UP, Moves, Shapes
from squealbox.system import Contact, System

SINOU = "form of Sinou and Jezequel 2007"
OWN = "chosen here"


class DampingParadox(Design):
    """A mass between two sliding contacts at right angles, in which unequal damping destabilises.

    >>> DampingParadox(eta1=0.02, eta2=0.002).system().size
    2
    """

    title: ClassVar[str] = "Destabilisation by damping, two contacts at right angles"
    source: ClassVar[str] = (
        "form of Hulten's model in Sinou and Jezequel 2007, European Journal of Mechanics A/Solids 26, 106-122"
    )

    m: float = parameter("kg", 0.0, low_open=True, default=1.0, meaning="mass", source=SINOU)
    k1: float = parameter(
        "N/m", 0.0, low_open=True, default=(200.0 * np.pi) ** 2, meaning="stiffness in x, of contact 1", source=SINOU
    )
    k2: float = parameter(
        "N/m", 0.0, low_open=True, default=(150.0 * np.pi) ** 2, meaning="stiffness in y, of contact 2", source=SINOU
    )
    eta1: float = parameter("-", 0.0, default=0.02, meaning="relative damping in x, c1/sqrt(k1 m)", source=SINOU)
    eta2: float = parameter("-", 0.0, default=0.02, meaning="relative damping in y, c2/sqrt(k2 m)", source=SINOU)
    load: Any = parameter("N", 0.0, default=10.0, schedule=True, meaning="normal force of each contact", source=OWN)
    sliding_speed: Any = parameter("m/s", default=1.0, schedule=True, meaning="speed of the contacts", source=OWN)
    friction: FrictionLaw = Coulomb(0.2)

    def system(self) -> System:
        """The equation of motion; leading axes of the parameters are kept."""
        damping = [eta * np.sqrt(k * self.m) for eta, k in ((self.eta1, self.k1), (self.eta2, self.k2))]
        rows = (("contact 1", self.k1, X, -Y), ("contact 2", self.k2, Y, X))
        contacts = tuple(
            Contact(column(k) * normal, along, along, self.load, self.sliding_speed, self.friction, name, False, normal)
            for name, k, normal, along in rows
        )
        stiffness = diagonal(self.k1, self.k2)
        return System(block(self.m) * np.eye(2), diagonal(*damping), stiffness, np.zeros(2), contacts, ("x", "y"))

    def draw(self, shapes: Shapes) -> None:
        """A mass with a spring and dashpot to each of two sliding walls at right angles."""
        mass: Moves = {0: RIGHT, 1: DOWN}
        shapes.box((-0.35, -0.35), 0.7, 0.7, "m", "m", mass)
        shapes.spring((0.35, 0.0), (1.15, 0.0), "$k_1, c_1$", "k1", moves=(mass, STILL))
        shapes.spring((0.0, -0.35), (0.0, -1.15), "$k_2, c_2$", "k2", moves=(mass, STILL))
        shapes.line((1.15, -0.6), (1.15, 0.6), role="motion", width=2.0)
        shapes.line((-0.6, -1.15), (0.6, -1.15), role="motion", width=2.0)
        shapes.velocity((1.3, -0.4), (1.3, 0.4), "V", "sliding_speed", (1.45, 0.0))
        shapes.velocity((-0.4, -1.3), (0.4, -1.3), "V", "sliding_speed", (0.0, -1.48))
        shapes.load((-1.0, 0.0), (-0.38, 0.0), "N", "load", (-1.1, 0.0), mass)
        shapes.load((0.0, 1.0), (0.0, 0.38), "N", "load", (0.0, 1.12), mass)
        shapes.axis((0.5, 0.75), (0.95, 0.75), "x", (1.05, 0.75))
        shapes.axis((0.5, 0.75), (0.5, 0.42), "y", (0.62, 0.52))
        shapes.contact((1.15, 0.0), (-1.0, 0.0))
        shapes.contact((0.0, -1.15), UP)
