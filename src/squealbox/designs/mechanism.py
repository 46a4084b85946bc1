"""A brake of one's own as a mechanism: bodies, springs and contacts with positions and angles, assembled into matrices.

Bodies are rigid and move in a plane. A point (px, py) of a body at (x, y) with the degrees of freedom (u, w, turn)
moves by

    (u - turn (py - y),  w + turn (px - x))

so its displacement along an angle a is a row r.q. With r the row of one body minus that of the other, a spring adds
K += k r r' and C += c r r'. A contact presses `body` on `to` along the angle of its normal: with r_n that row and r_t
the one along the tangent, the normal turned clockwise by 90 degrees,

    N = N0 + k r_n.q,   v = V - r_t.q',   K += k r_n r_n',   friction mu sgn(v) N acts along r_t

V is the speed of `to` relative to `body` along the tangent. The rows hold for small motions.
"""

import re
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from squealbox.design import Design
from squealbox.friction import Coulomb
from squealbox.law import FrictionLaw
from squealbox.parameters import DataSheet, ParameterError, above_zero, choice, known_names, parameter
from squealbox.system import Contact, System

GROUND = "ground"
MOST_BODIES = 300


class Body(DataSheet):
    """A rigid body of a `OwnMechanism`; it turns when it has an inertia."""

    name: str
    mass: float = parameter("kg", 0.0, low_open=True, meaning="mass")
    inertia: float = above_zero("kg m^2", default=None, meaning="inertia; left out, it does not turn")
    x: float = parameter("m", default=0.0, meaning="position of its centre of mass")
    y: float = parameter("m", default=0.0, meaning="position of its centre of mass")
    moves: str = choice("plane", "x", "y", default="plane", meaning="the directions it may move in")


class Spring(DataSheet):
    """A spring with a dashpot beside it, along an angle, from a body to another or to the ground."""

    body: str
    to: str = GROUND
    angle: float = parameter("rad", default=0.0, meaning="direction of the spring from the x axis")
    stiffness: float = parameter("N/m", 0.0, default=0.0, meaning="stiffness")
    damping: float = parameter("N s/m", 0.0, default=0.0, meaning="damping")
    x: float = parameter("m", default=None, optional=True, meaning="where it holds; left out, the body's centre")
    y: float = parameter("m", default=None, optional=True, meaning="where it holds; left out, the body's centre")


class Touch(DataSheet):
    """A frictional contact of a body with another or with the ground; what is left out is that of the mechanism."""

    body: str
    to: str = GROUND
    angle: float = parameter("rad", default=np.pi / 2, meaning="direction of the normal, from body towards the other")
    stiffness: float = parameter("N/m", 0.0, default=0.0, meaning="contact stiffness")
    damping: float = parameter("N s/m", 0.0, default=0.0, meaning="damping along the normal")
    x: float = parameter("m", default=None, optional=True, meaning="where they touch; left out, the body's centre")
    y: float = parameter("m", default=None, optional=True, meaning="where they touch; left out, the body's centre")
    name: str = ""
    friction: FrictionLaw | None = None
    sliding_speed: Any = parameter("m/s", default=None, optional=True, schedule=True, meaning="sliding speed at rest")
    normal_force: Any = parameter("N", default=None, optional=True, schedule=True, meaning="normal force at rest")
    unilateral: bool = False


class OwnMechanism(Design):
    """A brake from bodies, springs and contacts with positions and angles; q is measured from the loaded state.

    Degrees of freedom are named after the bodies: pad_x, pad_y, pad_turn.

    >>> pad = Body("pad", 1.0)
    >>> springs = (Spring("pad", angle=0.0, stiffness=2.0), Spring("pad", angle=np.pi / 4, stiffness=1.0))
    >>> brake = OwnMechanism(bodies=(pad,), springs=springs, contacts=(Touch("pad", stiffness=1.0),))
    >>> brake.system().names
    ('pad_x', 'pad_y')
    """

    title: ClassVar[str] = "A brake given as a mechanism"
    source: ClassVar[str] = "a design file"

    bodies: tuple[Body, ...]
    springs: tuple[Spring, ...] = ()
    contacts: tuple[Touch, ...] = ()
    friction: FrictionLaw = Coulomb(0.3)
    sliding_speed: Any = parameter("m/s", default=1.0, schedule=True, meaning="sliding speed of the contacts at rest")
    normal_force: Any = parameter("N", default=0.0, schedule=True, meaning="normal force of the contacts at q = 0")

    def __post_init__(self) -> None:
        super().__post_init__()
        for field in ("bodies", "springs", "contacts"):
            object.__setattr__(self, field, tuple(getattr(self, field)))
        names = [body.name for body in self.bodies]
        if not 1 <= len(names) <= MOST_BODIES:
            raise ParameterError("OwnMechanism", "bodies", len(names), f"1 to {MOST_BODIES} bodies")
        for i, name in enumerate(names):
            if not re.fullmatch("[A-Za-z][A-Za-z0-9_]{0,29}", name) or names.count(name) > 1 or name == GROUND:
                expected = f"different names of letters, digits and _, not {GROUND}"
                raise ParameterError("OwnMechanism", f"bodies[{i}].name", name, expected)
        for field in ("springs", "contacts"):
            for i, part in enumerate(getattr(self, field)):
                for end, known in (("body", names), ("to", [*names, GROUND])):
                    if getattr(part, end) not in known:
                        given = getattr(part, end)
                        raise ParameterError("OwnMechanism", f"{field}[{i}].{end}", given, known_names(given, known))
                if part.body == part.to:
                    raise ParameterError("OwnMechanism", f"{field}[{i}].to", part.to, "another body than its own")

    def system(self) -> System:
        """The equation of motion; leading axes of every parameter are kept."""
        places = self.places()
        size = len(places)
        damping, stiffness = np.zeros((size, size)), np.zeros((size, size))
        for spring in self.springs:
            row = self.row(spring, spring.angle)
            stiffness = stiffness + _times(spring.stiffness, row, row)
            damping = damping + _times(spring.damping, row, row)
        contacts = []
        for i, touch in enumerate(self.contacts):
            normal, along = self.row(touch, touch.angle), self.row(touch, touch.angle - np.pi / 2)
            stiffness = stiffness + _times(touch.stiffness, normal, normal)
            damping = damping + _times(touch.damping, normal, normal)
            contacts.append(
                Contact(
                    n=np.asarray(touch.stiffness)[..., None] * normal,
                    d=along,
                    t=along,
                    N0=self.normal_force if touch.normal_force is None else touch.normal_force,
                    V=self.sliding_speed if touch.sliding_speed is None else touch.sliding_speed,
                    law=touch.friction or self.friction,
                    name=touch.name or f"{touch.body} on {touch.to} {i + 1}",
                    unilateral=touch.unilateral,
                    normal=normal,
                )
            )
        names = tuple(f"{name}_{motion}" for name, motion in places)
        return System(self._mass(), damping, stiffness, np.zeros(size), tuple(contacts), names)

    def places(self) -> list[tuple[str, str]]:
        """Body and motion (x, y or turn) of each degree of freedom."""
        found = []
        for body in self.bodies:
            found += [(body.name, axis) for axis in ("x", "y") if body.moves in ("plane", axis)]
            found += [(body.name, "turn")] if body.inertia is not None else []
        return found

    def row(self, part: Spring | Touch, angle: float) -> Any:
        """The row r with r.q the displacement of `part.body` relative to `part.to` along an angle, at the part."""
        bodies = {body.name: body for body in self.bodies}
        own = bodies[part.body]
        px = own.x if part.x is None else part.x
        py = own.y if part.y is None else part.y
        row: list[Any] = []
        for name, motion in self.places():
            sign = 1.0 if name == part.body else -1.0 if name == part.to else 0.0
            body = bodies[name]
            arm = (px - body.x) * np.sin(angle) - (py - body.y) * np.cos(angle)
            row.append(sign * {"x": np.cos(angle), "y": np.sin(angle), "turn": arm}[motion])
        return np.stack(np.broadcast_arrays(*row), axis=-1)

    def _mass(self) -> Any:
        bodies = {body.name: body for body in self.bodies}
        masses = [bodies[n].inertia if motion == "turn" else bodies[n].mass for n, motion in self.places()]
        return np.stack(np.broadcast_arrays(*masses), axis=-1)[..., None] * np.eye(len(masses))


def _times(factor: ArrayLike, left: np.ndarray, right: np.ndarray) -> Any:
    """factor left right', (..., n, n)."""
    return np.asarray(factor)[..., None, None] * left[..., :, None] * right[..., None, :]
