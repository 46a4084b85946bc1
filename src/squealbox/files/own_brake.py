"""A brake of one's own, given by its matrices: what a design file with ``brake = "own"`` describes."""

import re
from typing import Any, ClassVar

import numpy as np

from squealbox.designs import Design
from squealbox.files.arrays import Matrix, Vector
from squealbox.friction import Coulomb, FrictionLaw
from squealbox.parameters import DataSheet, ParameterError, parameter
from squealbox.schedules import Schedule, value_at
from squealbox.system import Contact, System


class OwnContact(DataSheet):
    """One contact of an `OwnBrake`; friction, sliding speed and normal force left out are those of the brake."""

    n: Vector = parameter("N/m", meaning="normal force per displacement, one number for each degree of freedom")
    d: Vector = parameter("-", meaning="direction in which friction acts on the degrees of freedom")
    t: Vector = parameter("-", default=None, optional=True, meaning="sliding velocity per velocity; left out, t = d")
    name: str = ""
    friction: FrictionLaw | None = None
    sliding_speed: Any = parameter("m/s", default=None, optional=True, schedule=True, meaning="sliding speed at rest")
    normal_force: Any = parameter("N", default=None, optional=True, schedule=True, meaning="normal force at rest")
    unilateral: bool = False
    normal: Vector = parameter(
        "-", default=None, optional=True, meaning="direction of the normal reaction, when unilateral"
    )
    rigid: bool = False
    gap: float = parameter("m", default=0.0, meaning="gap of a rigid contact at q = 0")
    restitution: float = parameter("-", default=0.0, meaning="rebound speed over landing speed of a rigid contact")


class OwnBrake(Design):
    """A brake given by its matrices and contacts, with the friction, speed and normal force that its contacts share.

    The shared parameters are what a study varies: ``brake.replace({"friction.static": mus})`` is a map.

    >>> contact = OwnContact(n=[0.0, 1.0], d=[1.0, 0.0])
    >>> brake = OwnBrake(M=np.eye(2), K=[[2.0, 1.0], [1.0, 2.0]], contacts=(contact,))
    >>> brake.system().size
    2
    """

    title: ClassVar[str] = "A brake given by its matrices"
    source: ClassVar[str] = "a design file"

    M: Matrix = parameter("kg", meaning="mass matrix, symmetric")
    K: Matrix = parameter("N/m", meaning="stiffness matrix")
    C: Matrix = parameter("N s/m", default=None, optional=True, meaning="damping matrix; left out, none")
    load: Vector = parameter(
        "N", default=None, optional=True, schedule=True, meaning="load on each, numbers or schedules; left out, none"
    )
    friction: FrictionLaw = Coulomb(0.3)
    sliding_speed: Any = parameter("m/s", default=1.0, schedule=True, meaning="sliding speed of the contacts at rest")
    normal_force: Any = parameter("N", default=0.0, schedule=True, meaning="normal force of the contacts at q = 0")
    contacts: tuple[OwnContact, ...] = ()
    names: tuple[str, ...] = ()
    angles: tuple[str, ...] = ()  # names of those freedoms that are rotations; a name that ends in _turn is one anyway

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "contacts", tuple(self.contacts))
        object.__setattr__(self, "names", tuple(self.names))
        object.__setattr__(self, "angles", tuple(self.angles))
        size = self._square("M", None)
        for name in ("K", "C"):
            if getattr(self, name) is not None:
                self._square(name, size)
        if np.any(np.abs(self.M - self.M.T) > 1e-8 * np.max(np.abs(self.M))):
            raise ParameterError("OwnBrake", "M", "not symmetric", "a symmetric mass matrix")
        if isinstance(self.load, Schedule) and size == 1 and np.ndim(value_at(self.load, 0.0)) == 0:
            object.__setattr__(self, "load", self.load * np.ones(1))
        if self.load is not None and np.shape(value_at(self.load, 0.0)) != (size,):
            each = "one for each degree of freedom, such as [0, { ramp = { start = 0, slope = 10 } }]"
            raise ParameterError("OwnBrake", "load", self.load, f"{size} forces, {each}")
        if self.names and len(self.names) != size:
            raise ParameterError("OwnBrake", "names", self.names, f"{size} names, one for each degree of freedom")
        for name in self.names:
            if not re.fullmatch("[A-Za-z][A-Za-z0-9_]{0,39}", name) or self.names.count(name) > 1:
                raise ParameterError("OwnBrake", "names", name, "different names of letters, digits and _")
        known = self.names or tuple(f"q{i + 1}" for i in range(size))
        for name in self.angles:
            if name not in known:
                raise ParameterError("OwnBrake", "angles", name, f"names of degrees of freedom: {', '.join(known)}")
        for i, contact in enumerate(self.contacts):
            for name in ("n", "d", "t", "normal"):
                value = getattr(contact, name)
                if value is not None and np.shape(value) != (size,):
                    raise ParameterError("OwnBrake", f"contacts[{i}].{name}", value, f"{size} numbers")
            if contact.unilateral and contact.normal is None:
                raise ParameterError("OwnBrake", f"contacts[{i}].normal", None, "a direction, because it is unilateral")

    def system(self) -> System:
        """The equation of motion; leading axes of the shared parameters are kept."""
        damping = np.zeros_like(self.M) if self.C is None else self.C
        contacts = tuple(self._contact(contact, i) for i, contact in enumerate(self.contacts))
        load = np.zeros(len(self.M)) if self.load is None else self.load
        return System(self.M, damping, self.K, load, contacts, self.names, angles=self.angles)

    def _contact(self, contact: OwnContact, index: int) -> Contact:
        return Contact(
            n=contact.n,
            d=contact.d,
            t=contact.d if contact.t is None else contact.t,
            N0=0.0 if contact.rigid else _first(contact.normal_force, self.normal_force),
            V=_first(contact.sliding_speed, self.sliding_speed),
            law=contact.friction or self.friction,
            name=contact.name or f"contact {index + 1}",
            unilateral=contact.unilateral,
            normal=contact.normal,
            rigid=contact.rigid,
            gap=contact.gap,
            restitution=contact.restitution,
        )

    def _square(self, name: str, size: int | None) -> int:
        array = getattr(self, name)
        expected = f"a matrix of {size} rows and columns" if size else "a square matrix"
        if np.ndim(array) != 2 or array.shape[0] != array.shape[1] or (size and len(array) != size):
            raise ParameterError("OwnBrake", name, f"shape {np.shape(array)}", expected)
        return len(array)


def _first(own: Any, shared: float | Schedule) -> Any:
    return shared if own is None else own
