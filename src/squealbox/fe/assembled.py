"""A brake assembled from what another code exported: its matrices, contact pairs, friction, speed and preload."""

import functools
from typing import Any, ClassVar

import numpy as np

from squealbox.design import Design
from squealbox.fe.interfaces import CoordinateSystem, Interface, Rotation, contacts_of
from squealbox.fe.readers.matrix import MatrixFileError
from squealbox.fe.structure import Structure, read_structure
from squealbox.fe.units import unit_system
from squealbox.friction import Coulomb
from squealbox.law import FrictionLaw
from squealbox.parameters import DataSheet, ParameterError, above_zero, parameter
from squealbox.system import InvalidSystem, System


class StructureFiles(DataSheet):
    """The files of a structure; a file of several matrices may be given as "file#name". Units are asked."""

    stiffness: str
    mass: str
    units: str
    damping: str = ""
    nodes: str = ""
    labels: str = ""
    gyroscopic: str = ""
    radial: str = ""
    geometric: str = ""
    circulatory: str = ""
    structural: str = ""

    def read(self) -> Structure:
        """The structure; kept, so a study reads its files once."""
        return _read(self)

    def term(self, name: str) -> Any:
        """A further matrix (n, n) sparse by the name of its field, or None."""
        return _term(self, name) if getattr(self, name) else None


def _source(text: str) -> Any:
    path, mark, name = text.partition("#")
    return (path, name) if mark else path


@functools.lru_cache(maxsize=4)
def _read(files: StructureFiles) -> Structure:
    return read_structure(
        stiffness=_source(files.stiffness),
        mass=_source(files.mass),
        damping=_source(files.damping) if files.damping else None,
        units=files.units,
        nodes=files.nodes or None,
        labels=files.labels or None,
    )


TERMS = {"gyroscopic": 2, "radial": 0, "geometric": 2, "circulatory": 0, "structural": 0}  # powers of time in a unit


@functools.lru_cache(maxsize=16)
def _term(files: StructureFiles, name: str) -> Any:
    """A matrix read as damping is, on the labels of the stiffness, in its own power of the unit of time."""
    found = read_structure(
        stiffness=_source(files.stiffness),
        mass=_source(files.mass),
        damping=_source(getattr(files, name)),
        units=files.units,
        labels=files.labels or None,
    )
    return found.C * unit_system(files.units).time ** (TERMS[name] - 1)


class AssembledBrake(Design):
    """A finite-element brake from exported matrices; its contacts are rows of the sparse system.

    C = C_file + alpha M + beta K_file + O G + (1/O - 1/O_ref) D_R + D_4 / (2 pi F)
    K = K_file + K_R + (O^2 - O_ref^2) K_geo + k A r_n r_n' of every pair

    O is the angular speed in units of 1 rad/s. O_ref is 0 where the matrices do not hold these terms yet, and then
    D_R / O and O^2 K_geo are added whole; with O_ref = 1 it is assembly (b) of the published 4,669-freedom brake.
    Friction that turns with the sliding velocity comes from the pairs (`Contact.across`); D_R is only for an export
    that holds it as a matrix. Derived from the equation of `system.py`, with the terms of rotating friction.
    """

    title: ClassVar[str] = "A brake assembled from exported matrices"
    source: ClassVar[str] = "a finite-element model of the user's"

    structure: Any
    interfaces: tuple[Interface, ...] = ()
    systems: tuple[CoordinateSystem, ...] = ()
    friction: FrictionLaw = Coulomb(0.3)
    angular_speed: float = parameter("rad/s", 0.0, low_open=True, default=1.0, meaning="angular speed of the disc")
    sliding_speed: float = above_zero("m/s", default=None, meaning="speed where masters move along a direction")
    alpha: float = parameter("1/s", 0.0, default=0.0, meaning="mass-proportional damping")
    beta: float = parameter("s", 0.0, default=0.0, meaning="stiffness-proportional damping")
    reference_speed: float = parameter(
        "rad/s",
        0.0,
        default=0.0,
        meaning="at which the matrices hold radial and geometric terms; 0: none",
    )

    damping_frequency: float = parameter(
        "Hz", 0.0, low_open=True, default=1000.0, meaning="at which structural damping is made viscous"
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "interfaces", tuple(self.interfaces))
        object.__setattr__(self, "systems", tuple(self.systems))
        if not isinstance(self.structure, (Structure, StructureFiles)):
            raise ParameterError("AssembledBrake", "structure", self.structure, "a Structure or StructureFiles")
        turning = any(isinstance(interface.sliding, Rotation) for interface in self.interfaces)
        straight = any(not isinstance(interface.sliding, Rotation) for interface in self.interfaces)
        if turning and straight:
            raise ParameterError(
                "AssembledBrake", "interfaces", "some turn, some move straight", "one kind of sliding in a brake"
            )
        if straight and self.sliding_speed is None:
            raise ParameterError(
                "AssembledBrake", "sliding_speed", None, "the speed of masters that move straight [m/s]"
            )

    def exported(self) -> Structure:
        """The structure without friction."""
        return self.structure.read() if isinstance(self.structure, StructureFiles) else self.structure

    def node_rows(self) -> tuple[Any, Any]:
        """Node of each freedom, shape (n,), 0 for rotations and freedoms of no node; its place [m], (n, 3), or NaN."""
        structure = self.exported()
        places = np.full((structure.size, 3), np.nan)
        if structure.labels is None:
            return np.zeros(structure.size, dtype=int), places
        moves = (structure.labels[:, 0] > 0) & (structure.labels[:, 1] >= 1) & (structure.labels[:, 1] <= 3)
        numbers = np.where(moves, structure.labels[:, 0], 0)
        if structure.nodes is not None:
            known = dict(zip(structure.nodes.numbers.tolist(), structure.nodes.places, strict=True))
            for row, node in enumerate(numbers.tolist()):
                places[row] = known.get(node, places[row])
        return numbers, places

    def system(self) -> System:
        """The sparse system; `InvalidSystem` where files or pairs do not fit."""
        try:
            return self._system()
        except MatrixFileError as error:
            raise InvalidSystem(str(error)) from error

    def _system(self) -> System:
        structure = self.exported()
        turning = any(isinstance(interface.sliding, Rotation) for interface in self.interfaces)
        speed = self.angular_speed if turning or self.sliding_speed is None else self.sliding_speed
        contacts, added = contacts_of(structure, self.interfaces, self.friction, speed, self.systems) if (
            self.interfaces
        ) else (None, None)  # fmt: skip
        damping = structure.C + self.alpha * structure.M + self.beta * structure.K
        stiffness = structure.K if added is None else structure.K + added
        if isinstance(self.structure, StructureFiles):
            for name, to_damping, to_stiffness in self._turning():
                term = self.structure.term(name)
                if term is not None:
                    damping = damping + to_damping * term
                    stiffness = stiffness + to_stiffness * term
        names = () if structure.labels is None else tuple(f"{a}.{b}" for a, b in structure.labels)
        return System(structure.M, damping, stiffness, 0.0, contacts if contacts is not None else (), names)

    def _turning(self) -> tuple[tuple[str, float, float], ...]:
        """Name of each further matrix and its factors in C and K."""
        speed, base = self.angular_speed, self.reference_speed
        radial = 1.0 / speed - (1.0 / base if base else 0.0)
        return (
            ("gyroscopic", speed, 0.0),
            ("radial", radial, 0.0),
            ("geometric", 0.0, speed**2 - base**2),
            ("circulatory", 0.0, 1.0),
            ("structural", 1.0 / (2.0 * np.pi * self.damping_frequency), 0.0),
        )
