"""A brake of one's own, given by its matrices: what a design file with ``brake = "own"`` describes."""

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, ClassVar

import numpy as np

from squealbox.design import Design
from squealbox.friction import Coulomb
from squealbox.law import FrictionLaw
from squealbox.parameters import DataSheet, Matrix, Parameter, ParameterError, Vector, parameter
from squealbox.schedules import Schedule, value_at
from squealbox.system import Contact, System

NAME = "[A-Za-z][A-Za-z0-9_]{0,39}"
UNITS = {"M": "kg", "C": "N s/m", "K": "N/m", "n": "N/m", "load": "N"}  # of a value that a part multiplies


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


class Part(DataSheet):
    """What one named number brings to the matrices of an `OwnBrake`: M + value M_part, and so C, K, n and the load.

    A contact spring between the first two freedoms is ``Part("k_pad", 3e6, K=[[1, -1], [-1, 1]])``; where a contact
    feels it too, ``n`` has a row for each contact. In a file the value has the unit of what it multiplies, N/m for K.
    """

    name: str
    value: Any = parameter("", meaning="the number that is varied by the name of the part")
    M: Matrix = parameter("-", default=None, optional=True, meaning="what a value of 1 adds to the mass matrix")
    C: Matrix = parameter("-", default=None, optional=True, meaning="what a value of 1 adds to the damping matrix")
    K: Matrix = parameter("-", default=None, optional=True, meaning="what a value of 1 adds to the stiffness matrix")
    n: Matrix = parameter("-", default=None, optional=True, meaning="what a value of 1 adds to n, by contacts")
    load: Vector = parameter("-", default=None, optional=True, meaning="what a value of 1 adds to the load")

    @staticmethod
    def unit_for(given: Mapping[str, Any]) -> str:
        """Unit of the value of a part that has these arrays; none where it scales arrays of different units."""
        units = {UNITS[name] for name in UNITS if given.get(name) is not None}
        return units.pop() if len(units) == 1 else ""


class OwnBrake(Design):
    """A brake given by its matrices and contacts, with the friction, speed and normal force that its contacts share.

    The shared parameters and the parts are what a study varies, by their names: ``brake.replace({"friction.static":
    mus})`` is a map. Parts name numbers within the matrices.

    >>> contact = OwnContact(n=[0.0, 1.0], d=[1.0, 0.0])
    >>> brake = OwnBrake(M=np.eye(2), K=[[2.0, 1.0], [1.0, 2.0]], contacts=(contact,))
    >>> brake.system().size
    2
    >>> stiff = brake.replace(parts=(Part("k_pad", 3.0, K=[[1.0, -1.0], [-1.0, 1.0]]),)).replace(k_pad=5.0)
    >>> stiff.system().K.tolist()
    [[7.0, -4.0], [-4.0, 7.0]]
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
    contacts: Sequence[OwnContact] = ()
    names: tuple[str, ...] = ()
    angles: tuple[str, ...] = ()  # names of those freedoms that are rotations; a name that ends in _turn is one anyway
    parts: Sequence[Part] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        for name in ("contacts", "parts"):
            object.__setattr__(self, name, tuple(getattr(self, name)))
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
            if not re.fullmatch(NAME, name) or self.names.count(name) > 1:
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
        self._check_parts(size)

    def _check_parts(self, size: int) -> None:
        shapes = dict.fromkeys("MCK", (size, size)) | {"n": (len(self.contacts), size), "load": (size,)}
        names = [part.name for part in self.parts]
        for i, part in enumerate(self.parts):
            good = re.fullmatch(NAME, part.name) and names.count(part.name) == 1 and part.name not in self.field_names()
            if not good:
                expected = "different names of letters, digits and _, none that the brake has already"
                raise ParameterError("OwnBrake", f"parts[{i}].name", part.name, expected)
            for name, shape in shapes.items():
                value = getattr(part, name)
                if value is not None and value.shape != shape:
                    expected = " x ".join(map(str, shape)) + " numbers"
                    raise ParameterError("OwnBrake", f"parts[{i}].{name}", f"shape {value.shape}", expected)
            if all(getattr(part, name) is None for name in shapes):
                raise ParameterError("OwnBrake", f"parts[{i}]", part.name, "one or more of M, C, K, n, load")

    def _paths(self, path: str) -> tuple[str, ...]:
        """A part is known by its name alone."""
        return (f"parts.{path}.value",) if path in {part.name for part in self.parts} else super()._paths(path)

    def _known(self) -> list[str]:
        return [*super()._known(), *(part.name for part in self.parts)]

    def leaves(self, prefix: str = "") -> Iterator[tuple[str, Parameter, Any]]:
        """Every parameter with its dotted name and value, parts by their names."""
        yield from (leaf for leaf in super().leaves(prefix) if not leaf[0].startswith(f"{prefix}parts."))
        for part in self.parts:
            unit = part.unit_for({name: getattr(part, name) for name in UNITS})
            yield prefix + part.name, Parameter(unit, meaning="a part of the matrices"), part.value

    def _with_parts(self, name: str, base: np.ndarray) -> Any:
        """An array with what the parts add to it; leading axes of their values are kept."""
        given = [part for part in self.parts if getattr(part, name) is not None]
        added = [np.multiply.outer(part.value, getattr(part, name)) for part in given]
        return base + sum(added[1:], added[0]) if added else base

    def system(self) -> System:
        """The equation of motion; leading axes of the shared parameters are kept."""
        bare = {"M": self.M, "C": np.zeros_like(self.M) if self.C is None else self.C, "K": self.K}
        mass, damping, stiffness = (self._with_parts(name, array) for name, array in bare.items())
        rows = np.array([contact.n for contact in self.contacts]).reshape(-1, len(self.M))
        rows = self._with_parts("n", rows)
        contacts = tuple(self._contact(contact, rows[..., i, :], i) for i, contact in enumerate(self.contacts))
        load = self._with_parts("load", np.zeros(len(self.M)) if self.load is None else self.load)
        return System(mass, damping, stiffness, load, contacts, self.names, angles=self.angles)

    def _contact(self, contact: OwnContact, n: np.ndarray, index: int) -> Contact:
        return Contact(
            n=n,
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
