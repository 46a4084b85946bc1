"""A drum brake with two shoes, meshed and assembled here.

The drum is a ring, held at one edge, and turns with `angular_speed` from x to y. Within it stand two shoes, each a
table that carries a lining, on an anchor at its lower end and pushed outwards by the `force` of the wheel cylinder at
its upper one. Friction pulls the first shoe (at -x) into the drum, it leads; it pushes the second (at +x) away, which
trails.

          cylinder                M_n -+ M_f = force x lever about the anchor, with
     1  <--   -->  2              M_n the moment of the pressure and M_f that of its friction:
        ( drum )                  - for the leading shoe, which so helps itself
          anchors

Contact is that of `squealbox.fe.meshed`, with e_n outwards, e_t along the turning of the drum and e_a along its axis.
"""

from functools import lru_cache
from typing import Any, ClassVar, NamedTuple

import numpy as np

from squealbox.fe.contact_points import ContactPoints
from squealbox.fe.grids import MeshedBody, breaks
from squealbox.fe.meshed import (
    IRON,
    LINING,
    OWN,
    STEEL,
    FreedomsOfBodies,
    Material,
    MeshedBrake,
    MeshedStructure,
    longest_side,
    modes_alone,
    some_of,
    speed_of,
    stiffness_of_contact,
)
from squealbox.fe.undamped_modes import RealModes
from squealbox.fe.wear import check_depth, depth_worn, friction_while_wearing
from squealbox.friction import Coulomb
from squealbox.law import FrictionLaw
from squealbox.parameters import DataSheet, ParameterError, parameter

MIDDLES = (np.pi, 0.0)  # of the leading and of the trailing shoe [rad]


class Drum(DataSheet):
    """A ring on whose inner face the linings slide, held at one edge."""

    radius: float = parameter("m", 0.0, low_open=True, default=0.11, meaning="radius of the face that is slid on")
    thickness: float = parameter("m", 0.0, low_open=True, default=0.010, meaning="thickness of the wall")
    width: float = parameter("m", 0.0, low_open=True, default=0.055, meaning="width along the axis")
    material: Material = IRON


class Shoes(DataSheet):
    """Two equal shoes, each a table with a lining on it."""

    angle: float = parameter("rad", 0.0, 3.1, low_open=True, default=np.deg2rad(110.0), meaning="angle they span")
    width: float = parameter("m", 0.0, low_open=True, default=0.04, meaning="width along the axis")
    lining_thickness: float = parameter("m", 0.0, low_open=True, default=0.006, meaning="thickness of the lining")
    table_thickness: float = parameter("m", 0.0, low_open=True, default=0.012, meaning="thickness of the table")
    chamfer: float = parameter("rad", 0.0, 1.5, default=0.0, meaning="angle at either end that does not touch the drum")
    lining: Material = LINING
    table: Material = STEEL


class Anchors(DataSheet):
    """What holds each shoe: a pin through the middle of its lower end, and a guide along the axis."""

    pin: float = parameter("N/m", 0.0, low_open=True, default=5e8, meaning="stiffness of the pin in the drum's plane")
    guide: float = parameter("N/m", 0.0, low_open=True, default=1e7, meaning="stiffness along the axis, over the table")


class MeshedDrumBrake(MeshedBrake):
    """A drum brake of finite elements with a leading and a trailing shoe, made from nothing.

    >>> round(MeshedDrumBrake(element_size=0.03).drum.radius, 3)
    0.11
    """

    title: ClassVar[str] = "Drum brake of finite elements"
    source: ClassVar[str] = "dimensions of a small car's rear brake, chosen here"

    drum: Drum = Drum()
    shoes: Shoes = Shoes()
    anchors: Anchors = Anchors()
    friction: FrictionLaw = Coulomb(0.4)
    force: float = parameter(
        "N", 0.0, low_open=True, default=2000.0, meaning="of the wheel cylinder on each shoe", source=OWN
    )
    angular_speed: float = speed_of("drum")
    running_in: float = depth_worn()
    running_in_friction: float = friction_while_wearing()
    running_in_force: float = parameter(
        "N", 0.0, low_open=True, default=2000.0, meaning="force with which the linings wore", source=OWN
    )
    contact_stiffness: float = stiffness_of_contact()
    element_size: float = longest_side("along arc and axis")

    def __post_init__(self) -> None:
        super().__post_init__()
        drum, shoes = self.drum, self.shoes
        check_depth("MeshedDrumBrake", self.running_in, shoes.lining_thickness)
        if not shoes.width <= drum.width:
            raise ParameterError("Shoes", "width", shoes.width, f"at most that of the drum, {drum.width:g} m")
        if not shoes.lining_thickness + shoes.table_thickness < drum.radius:
            raise ParameterError("Shoes", "table_thickness", shoes.table_thickness, "a shoe that fits into the drum")

    def structure(self) -> MeshedStructure:
        self.one_system()
        drum, shoes = self.drum, self.shoes
        shape = (
            *(drum.radius, drum.thickness, drum.width, drum.material.poisson),
            *(shoes.angle, shoes.width, shoes.lining_thickness, shoes.table_thickness),
            *(shoes.lining.poisson, shoes.table.poisson, self.element_size),
        )
        return drum_structure(DrumBrakeShape(*(float(value) for value in shape)))

    def materials(self) -> dict[str, Material]:
        return {"drum": self.drum.material, "linings": self.shoes.lining, "tables": self.shoes.table}

    def held_by(self) -> dict[str, float]:
        return {"pin": self.anchors.pin, "guide": self.anchors.guide}

    def pressed_by(self) -> dict[str, float]:
        return {"force": self.force}

    def wearing_under(self) -> dict[str, float]:
        return {"force": self.running_in_force}

    def touching(self, made: MeshedStructure) -> Any:
        """Contact points outside chamfers."""
        inside = np.abs(made.angle) < 0.5 * self.shoes.angle - self.shoes.chamfer
        return some_of(inside, "Shoes", self.shoes.chamfer)


class DrumBrakeShape(NamedTuple):
    """What the mesh of a drum brake depends on: lengths [m], the angle [rad] and Poisson's ratios [-]."""

    radius: float
    wall: float
    deep: float
    drum_poisson: float
    angle: float
    width: float
    lining: float
    table: float
    lining_poisson: float
    table_poisson: float
    size: float


@lru_cache(maxsize=4)
def drum_structure(shape: DrumBrakeShape) -> MeshedStructure:
    """Mesh and assemble a drum and two shoes; all lengths in m, the angle in rad."""
    radius, wall, deep, drum_poisson, angle, width, lining, table, lining_poisson, table_poisson, size = shape
    drum = _ring(radius, wall, deep, size)
    under = radius - lining
    through = np.concatenate([breaks(under - table, under, size), breaks(under, radius, size)[1:]])
    across = breaks(0.5 * (deep - width), 0.5 * (deep + width), size, 2)
    shoes = [MeshedBody(through, breaks(m - 0.5 * angle, m + 0.5 * angle, size / radius, 4), across) for m in MIDDLES]
    bodies = (drum, *shoes)
    edge = np.abs(drum.places[2]) < 1e-6 * deep
    frame = FreedomsOfBodies(bodies, [edge, *(np.zeros(shoe.size, dtype=bool) for shoe in shoes)])
    mass: dict[str, Any] = {"drum": frame.square(drum.mass(), 0)}
    stiffness: dict[str, Any] = {"drum": frame.square(drum.stiffness(drum_poisson), 0)}
    for name, poisson, outside in (("linings", lining_poisson, True), ("tables", table_poisson, False)):
        marks = [(shoe.centres[0] > under) == outside for shoe in shoes]
        both = list(enumerate(zip(shoes, marks, strict=True), 1))
        mass[name] = sum(frame.square(shoe.mass(m), i) for i, (shoe, m) in both)
        stiffness[name] = sum(frame.square(shoe.stiffness(poisson, m), i) for i, (shoe, m) in both)
    pin, guide, load, moving = 0.0, 0.0, np.zeros(frame.size), np.zeros((frame.size, 2))
    points = ContactPoints(frame, 0, drum)
    for i, (shoe, middle) in enumerate(zip(shoes, MIDDLES, strict=True), 1):
        face = shoe.face(0, -1)
        turned = np.arctan2(face.place[1], face.place[0]) - middle
        offset = (turned + np.pi) % (2.0 * np.pi) - np.pi
        directions = _directions(face.place)
        below = np.array([radius * directions[0][0], radius * directions[0][1], face.place[2]])
        points.add(face, i, directions, below, offset)
        outwards = np.cos(middle)  # of the shoe, along x
        upper, lower = (0, -1) if outwards < 0.0 else (-1, 0)
        pushed, held = (shoe.face(1, end, lambda r, _t, _z: r < under) for end in (upper, lower))
        load += frame.pin(pushed, i, (outwards, 0.0, 0.0)).T @ np.ones(1)
        for direction in ((1.0, 0.0, 0.0), (0.0, 1.0, 0.0)):
            row = frame.pin(held, i, direction)
            pin = pin + row.T @ row
        anchor, own = held.place @ held.area / np.sum(held.area), frame.freedoms(i)
        moving[own[0::3], i - 1] = outwards * (shoe.places[1, 0::3] - anchor[1])
        moving[own[1::3], i - 1] = outwards * (anchor[0] - shoe.places[0, 1::3])
        inner = shoe.face(0, 0)
        guide = guide + frame.spring(inner, i, _directions(inner.place)[2])
    return MeshedStructure(
        size=frame.size,
        mass=mass,
        stiffness=stiffness,
        springs={"pin": pin, "guide": guide},
        loads={"force": load},
        **points.fields("shoe"),
        moving=moving,
        bodies=bodies,
        kept=frame.kept,
    )


def free_drum_modes(drum: Drum, element_size: float, top: float, *, held: bool = False) -> RealModes:
    """Undamped modes below `top` [Hz] of the drum alone, free or held at its edge: what a hammer test finds.

    `element_size` [m]: of the mesh.
    """
    body = _ring(drum.radius, drum.thickness, drum.width, element_size)
    edge = np.abs(body.places[2]) < 1e-6 * drum.width
    return modes_alone(body, drum.material, top, edge if held else None)


def _ring(radius: float, wall: float, deep: float, size: float) -> MeshedBody:
    around = breaks(0.0, 2.0 * np.pi, size / radius, 12)
    return MeshedBody(breaks(radius, radius + wall, size, 2), around, breaks(0.0, deep, size, 2), closed=True)


def _directions(place: np.ndarray) -> tuple[Any, Any, Any]:
    """Unit vectors (3, k) at places: outwards into the drum, in the sense of its turning, and along its axis."""
    r = np.hypot(place[0], place[1])
    cosine, sine, nothing = place[0] / r, place[1] / r, np.zeros(len(r))
    return (
        np.array([cosine, sine, nothing]),
        np.array([-sine, cosine, nothing]),
        np.array([nothing, nothing, np.ones(len(r))]),
    )
