"""Wobbling disc: a rigid disc that tilts about two fixed axes, between two guided, massless, sprung pins.

The disc has thickness h, inertia J about a diameter and Jp about its axis, and spins at W. q1 and q2 are its tilts
about y and x. The pins stand on the x axis at radius r, guided along z, with stiffness k, damping d and preload N0
each. A pin's force along z is that of its spring; the contact carries N along the tilted normal (q1, -q2, 1) and mu N
along the sliding direction, so guided pins give N = (N0 - k r q1)(1 - mu q2) above and (N0 + k r q1)(1 + mu q2)
below. The moments about the centre, linear in q and q', are, with w = -r q1 the height of the surface between the
pins,

    J q1'' + [dt + 2 d r^2 + mu N0 h^2/(2 r W)] q1' - Jp W q2' + [kt + 2 k r^2 + N0 h] q1 - mu N0 h^2/(2 r) q2 = 0
    J q2'' + mu h d r q1' + Jp W q1' + dt q2' + mu h k r q1 + [kt + (1 + mu^2) N0 h] q2 = 0

The term mu h k r q1 and the change of friction with sliding speed are the two contacts of the system,

    n = -+ (k r, 0),   d = t = +- (0, h/2),   V = r W;

what else depends on mu is taken at mu(r W), so its coefficients are constant.
"""

from typing import ClassVar

import numpy as np

from squealbox.design import Design
from squealbox.designs.rows import block, matrix, vector
from squealbox.friction import Coulomb
from squealbox.law import FrictionLaw
from squealbox.parameters import parameter
from squealbox.shapes import STILL, Shapes
from squealbox.system import Contact, System

OWN = "chosen here, of the size of a car's brake"


class WobblingDisc(Design):
    """A rigid disc with two tilts between two sprung pins, with gyroscopic and circulatory terms.

    >>> WobblingDisc().system().names
    ('q1', 'q2')
    """

    title: ClassVar[str] = "Wobbling disc between pins, two degrees of freedom (2007)"
    source: ClassVar[str] = (
        "form of von Wagner, Hochlenert and Hagedorn 2007, Journal of Sound and Vibration 302, 527-539; "
        "equations derived here, numbers chosen here"
    )

    J: float = parameter("kg m^2", 0.0, low_open=True, default=0.16, meaning="inertia about a diameter", source=OWN)
    Jp: float = parameter("kg m^2", 0.0, default=0.32, meaning="inertia about the axis", source=OWN)
    kt: float = parameter("N m", 0.0, low_open=True, default=1.88e7, meaning="stiffness against tilting", source=OWN)
    dt: float = parameter("N m s", 0.0, default=0.1, meaning="damping of tilting", source=OWN)
    k: float = parameter("N/m", 0.0, default=6e6, meaning="stiffness of each pin", source=OWN)
    d: float = parameter("N s/m", 0.0, default=5.0, meaning="damping of each pin", source=OWN)
    r: float = parameter("m", 0.0, low_open=True, default=0.13, meaning="radius of the pins", source=OWN)
    h: float = parameter("m", 0.0, default=0.02, meaning="thickness of the disc", source=OWN)
    load: float = parameter("N", 0.0, default=3000.0, meaning="preload of each pin, N0", source=OWN)
    spin: float = parameter(
        "rad/s", 0.0, low_open=True, default=5 * np.pi, meaning="angular speed of the disc, W", source=OWN
    )
    friction: FrictionLaw = Coulomb(0.6)

    def system(self) -> System:
        """The equation of motion; leading axes of the parameters are kept."""
        speed = self.r * self.spin
        mu, slope = self.friction.mu(speed), self.friction.slope_at(speed)
        across = 0.5 * mu * self.load * self.h**2 / self.r
        gyroscopic = self.Jp * self.spin
        damping = matrix(
            (self.dt + 2.0 * self.d * self.r**2 + across / self.spin, -gyroscopic),
            (mu * self.h * self.d * self.r + gyroscopic, self.dt),
        )
        stiffness = matrix(
            (self.kt + 2.0 * self.k * self.r**2 + self.load * self.h, -across),
            # tilting changes the sliding speed at the two surfaces, and with it a friction that depends on speed
            (0.5 * self.h**2 * self.load * slope * self.spin, self.kt + (1.0 + mu**2) * self.load * self.h),
        )
        contacts = tuple(
            Contact(
                n=vector(-side * self.k * self.r, 0.0),
                d=vector(0.0, side * 0.5 * self.h),
                t=vector(0.0, side * 0.5 * self.h),
                N0=self.load,
                V=speed,
                law=self.friction,
                name=name,
            )
            for side, name in ((1.0, "upper pin"), (-1.0, "lower pin"))
        )
        inertia, names = block(self.J) * np.eye(2), ("q1", "q2")
        return System(inertia, damping, stiffness, np.zeros(2), contacts, names=names, angles=names)

    def draw(self, shapes: Shapes) -> None:
        """A section through the axis and the pins, the thickness to the scale of the pins' radius."""
        tilt = -0.1  # q1 > 0 turns the right side down
        half = max(0.5 * self.h / self.r, 0.02)
        disc, pin = {0: -float(self.r)}, {0: (0.0, -float(self.r))}
        turn = np.array([[np.cos(tilt), -np.sin(tilt)], [np.sin(tilt), np.cos(tilt)]])
        corners = turn @ np.array([[-1.25, 1.25, 1.25, -1.25], [-half, -half, half, half]])
        shapes.polygon(list(corners.T), moves=disc)
        shapes.line((0.0, -1.15), (0.0, 0.9), width=0.6, dashes=(6, 2, 1, 2))
        shapes.line((-1.4, 0.0), (1.4, 0.0), width=0.5, dashes=(4, 2))
        shapes.arc((0.0, 0.0), 1.38, tilt, 0.0, "$q_1$")
        for side in (1.0, -1.0):
            touch = np.tan(tilt) + side * half / np.cos(tilt)
            end = (1.0, touch + side * 0.2)
            shapes.line((1.0, touch), end, role="body", width=3.0, moves=(pin,))
            text, of = ("k, d", "k d") if side > 0.0 else ("", "")
            shapes.spring(end, (1.0, touch + side * 0.8), text, of, -1.0, (pin, STILL))
            shapes.wall((1.0, touch + side * 0.8), -side * np.pi / 2)
            tail, tip, name = ((x, touch + side * y) for x, y in ((0.75, 0.65), (0.75, 0.12), (0.6, 0.5)))
            shapes.load(tail, tip, "$N_0$", "load", name, pin)
            shapes.contact((1.0, touch), (0.0, -side), pin)
        shapes.velocity((-0.3, 0.72), (0.3, 0.72), "$\\Omega$", "spin", (-0.6, 0.72))
        shapes.line((0.0, -1.1), (1.0, -1.1), width=0.5)
        shapes.text((0.4, -1.2), f"r = {1e3 * self.r:.0f} mm", "r", size=7.0)
        shapes.text((-0.75, -0.2), f"h = {1e3 * self.h:.0f} mm, $k_t$, $d_t$", "h kt dt", size=7.0)
