"""A disc between two pads, meshed and assembled here: from thicknesses and moduli to a sparse system.

The disc is held at its bore and turns with `angular_speed`; each pad, a lining on a back plate, is pressed on it by
`pressure` on a patch of the plate, held by springs of the caliper and the abutments. Pads and disc have meshes of their
own; their contact is that of `squealbox.fe.meshed`, with e_t along the turning of the disc and e_a outwards.
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


class Disc(DataSheet):
    """An annular disc, held at its bore."""

    inner_radius: float = parameter("m", 0.0, low_open=True, default=0.045, meaning="bore, where it is held")
    outer_radius: float = parameter("m", 0.0, low_open=True, default=0.14, meaning="outer radius")
    thickness: float = parameter("m", 0.0, low_open=True, default=0.012, meaning="thickness")
    material: Material = IRON


class Pads(DataSheet):
    """Two equal pads, one on each face of the disc."""

    inner_radius: float = parameter("m", 0.0, low_open=True, default=0.088, meaning="inner radius")
    outer_radius: float = parameter("m", 0.0, low_open=True, default=0.136, meaning="outer radius")
    angle: float = parameter("rad", 0.0, 3.0, low_open=True, default=np.deg2rad(50.0), meaning="angle they span")
    thickness: float = parameter("m", 0.0, low_open=True, default=0.010, meaning="thickness of the lining")
    chamfer: float = parameter("rad", 0.0, 1.0, default=0.0, meaning="angle at either end that does not touch the disc")
    slot: float = parameter("rad", 0.0, 1.0, default=0.0, meaning="angle in the middle that does not touch the disc")
    material: Material = LINING


class Backplates(DataSheet):
    """The plates that carry the linings."""

    thickness: float = parameter("m", 0.0, low_open=True, default=0.005, meaning="thickness")
    material: Material = STEEL


class Springs(DataSheet):
    """What holds each pad: the caliper on the back of its plate, the abutments on the ends of its plate."""

    caliper: float = parameter("N/m", 0.0, default=4e8, meaning="stiffness normal to the disc, over the plate's back")
    abutment: float = parameter("N/m", 0.0, default=8e7, meaning="stiffness in the plane, over each end of the plate")


class DiscBrake(MeshedBrake):
    """A disc brake of finite elements, made from nothing.

    >>> round(DiscBrake(element_size=0.02).disc.outer_radius, 3)
    0.14
    """

    title: ClassVar[str] = "Disc brake of finite elements"
    source: ClassVar[str] = "dimensions of a passenger car's brake, chosen here"
    followers: ClassVar[str] = "caliper"

    disc: Disc = Disc()
    pads: Pads = Pads()
    backplates: Backplates = Backplates()
    springs: Springs = Springs()
    friction: FrictionLaw = Coulomb(0.5)
    pressure: float = parameter(
        "Pa", 0.0, low_open=True, default=1.5e6, meaning="pressure on the piston's patch", source=OWN
    )
    piston_radius: float = parameter(
        "m", 0.0, low_open=True, default=0.021, meaning="radius of the patch that is pressed", source=OWN
    )
    piston_offset: float = parameter(
        "m", default=0.0, meaning="of the patch from the pad's middle, along the disc's turning", source=OWN
    )
    angular_speed: float = speed_of("disc")
    running_in: float = depth_worn()
    running_in_friction: float = friction_while_wearing()
    running_in_pressure: float = parameter(
        "Pa", 0.0, low_open=True, default=1.5e6, meaning="pressure with which the linings wore", source=OWN
    )
    contact_stiffness: float = stiffness_of_contact()
    element_size: float = longest_side("in the plane of the disc")

    def __post_init__(self) -> None:
        super().__post_init__()
        disc, pads = self.disc, self.pads
        if not disc.inner_radius < disc.outer_radius:
            raise ParameterError(
                "Disc", "outer_radius", disc.outer_radius, f"more than its bore, {disc.inner_radius:g} m"
            )
        if not disc.inner_radius <= pads.inner_radius < pads.outer_radius <= disc.outer_radius:
            expected = (
                f"within the disc, {disc.inner_radius:g} to {disc.outer_radius:g} m, and the inner less than the outer"
            )
            raise ParameterError("Pads", "outer_radius", pads.outer_radius, expected)
        check_depth("DiscBrake", self.running_in, pads.thickness)
        if np.ndim(self.piston_offset) == 0 and np.ndim(self.piston_radius) == 0 and self.piston_offset != 0.0:
            room = patch_room(pads.inner_radius, pads.outer_radius, pads.angle, self.piston_offset)
            if not self.piston_radius <= room:
                expected = f"an offset that leaves the patch on the plate: its radius may be {max(room, 0.0):.4g} m"
                raise ParameterError("DiscBrake", "piston_offset", self.piston_offset, expected)

    def structure(self) -> MeshedStructure:
        self.one_system()
        lining, disc, plate = self.pads.material, self.disc.material, self.backplates.material
        shape = (
            *(self.disc.inner_radius, self.disc.outer_radius, self.disc.thickness, disc.poisson),
            *(self.pads.inner_radius, self.pads.outer_radius, self.pads.angle, self.pads.thickness, lining.poisson),
            *(self.backplates.thickness, plate.poisson, self.piston_radius, self.piston_offset, self.element_size),
        )
        return structure(DiscBrakeShape(*(float(value) for value in shape)))

    def materials(self) -> dict[str, Material]:
        return {"disc": self.disc.material, "linings": self.pads.material, "backplates": self.backplates.material}

    def held_by(self) -> dict[str, float]:
        return {"caliper": self.springs.caliper, "abutment": self.springs.abutment}

    def pressed_by(self) -> dict[str, float]:
        return {"pressure": self.pressure}

    def wearing_under(self) -> dict[str, float]:
        return {"pressure": self.running_in_pressure}

    def touching(self, made: MeshedStructure) -> Any:
        """Contact points outside chamfers and slot."""
        offset = np.abs(made.angle)
        inside = (offset < 0.5 * self.pads.angle - self.pads.chamfer) & (offset >= 0.5 * self.pads.slot)
        return some_of(inside, "Pads", self.pads.chamfer)


class DiscBrakeShape(NamedTuple):
    """What the mesh of a disc brake depends on: lengths [m], the angle [rad] and Poisson's ratios [-]."""

    bore: float
    rim: float
    thick: float
    disc_poisson: float
    inner: float
    outer: float
    angle: float
    lining: float
    lining_poisson: float
    plate: float
    plate_poisson: float
    piston: float
    offset: float
    size: float


@lru_cache(maxsize=4)
def structure(shape: DiscBrakeShape) -> MeshedStructure:
    """Mesh and assemble a disc and two pads; all lengths in m, the angle in rad."""
    bore, rim, thick, disc_poisson, inner, outer, angle = shape[:7]
    lining, lining_poisson, plate, plate_poisson, piston, offset, size = shape[7:]
    half = 0.5 * thick
    around = breaks(0.0, 2.0 * np.pi, size / (0.5 * (inner + outer)), 12)
    disc = MeshedBody(breaks(bore, rim, size, 2), around, breaks(-half, half, size, 2), closed=True)
    sector = breaks(-0.5 * angle, 0.5 * angle, size / (0.5 * (inner + outer)), 3)
    radii = breaks(inner, outer, size, 2)
    through = np.concatenate([breaks(0.0, lining, size), breaks(lining, lining + plate, size)[1:]])
    pads = [MeshedBody(radii, sector, half + through), MeshedBody(radii, sector, -(half + through)[::-1])]
    bodies = (disc, *pads)
    held = [np.hypot(*disc.places[:2]) < bore * (1.0 + 1e-6), *(np.zeros(pad.size, dtype=bool) for pad in pads)]
    frame = FreedomsOfBodies(bodies, held)
    mass: dict[str, Any] = {"disc": frame.square(disc.mass(), 0)}
    stiffness: dict[str, Any] = {"disc": frame.square(disc.stiffness(disc_poisson), 0)}
    for name, poisson, inside in (("linings", lining_poisson, True), ("backplates", plate_poisson, False)):
        marks = [(np.abs(pad.centres[2]) < half + lining) == inside for pad in pads]
        both = list(enumerate(zip(pads, marks, strict=True), 1))
        mass[name] = sum(frame.square(pad.mass(m), i) for i, (pad, m) in both)
        stiffness[name] = sum(frame.square(pad.stiffness(poisson, m), i) for i, (pad, m) in both)
    caliper, abutment, load, moving = 0.0, 0.0, np.zeros(frame.size), np.zeros((frame.size, 2))
    points = ContactPoints(frame, 0, disc)
    for i, pad in enumerate(pads):
        sign, bottom = (1.0, 0) if i == 0 else (-1.0, -1)  # the pad above presses downwards
        face = pad.face(2, bottom)
        below = np.array([face.place[0], face.place[1], np.full(face.place.shape[1], sign * half)])
        points.add(face, i + 1, _directions(face.place, sign), below, np.arctan2(face.place[1], face.place[0]))
        back = pad.face(2, -1 - bottom)
        into = _directions(back.place, sign)[0]
        caliper = caliper + frame.spring(back, i + 1, into)
        moving[frame.freedoms(i + 1)[2::3], i] = -sign
        pressed = np.hypot(back.place[0] - 0.5 * (inner + outer), back.place[1]) < piston
        if not np.any(pressed):
            raise ParameterError(
                "DiscBrake", "piston_radius", piston, "a patch that holds at least one quadrature point"
            )
        loaded = float(np.sum(back.area[pressed]))
        if piston <= patch_room(inner, outer, angle, 0.0):
            loaded = np.pi * piston**2  # the patch lies within the plate: its area is known better than by points
        force = np.where(pressed, back.area * loaded / np.sum(back.area[pressed]), 0.0)
        load += frame.rows(back.along(into), i + 1).T @ force
        if offset != 0.0:
            height, middle = sign * (half + lining + plate), 0.5 * (inner + outer)
            moved, still = (_patch(pad, middle, at, piston, height) for at in (offset, 0.0))
            load += frame.rows(-sign * (moved - still)[None, :], i + 1).toarray()[0]
        for end in (0, -1):
            side = pad.face(1, end, lambda _r, _t, z: np.abs(z) > half + lining)
            abutment = abutment + frame.spring(side, i + 1, *_directions(side.place, sign)[1:])
    return MeshedStructure(
        size=frame.size,
        mass=mass,
        stiffness=stiffness,
        springs={"caliper": caliper, "abutment": abutment},
        loads={"pressure": load},
        **points.fields("pad"),
        moving=moving,
        bodies=bodies,
        kept=frame.kept,
    )


def free_disc_modes(disc: Disc, element_size: float, top: float, *, held: bool = False) -> RealModes:
    """Undamped modes below `top` [Hz] of the disc alone, free or held at its bore: what a hammer test finds.

    `element_size` [m]: of the mesh.
    """
    half = 0.5 * disc.thickness
    around = breaks(0.0, 2.0 * np.pi, element_size / (0.5 * (disc.inner_radius + disc.outer_radius)), 12)
    radii = breaks(disc.inner_radius, disc.outer_radius, element_size, 2)
    body = MeshedBody(radii, around, breaks(-half, half, element_size, 2), closed=True)
    at_bore = np.hypot(*body.places[:2]) <= disc.inner_radius * (1.0 + 1e-6)
    return modes_alone(body, disc.material, top, at_bore if held else None)


def patch_room(inner: float, outer: float, angle: float, offset: float) -> float:
    """The largest radius [m] of a patch on the plate's middle radius, `offset` [m] along the arc from its middle."""
    middle = 0.5 * (inner + outer)
    aside = 0.5 * angle - abs(offset) / middle
    return float(min(0.5 * (outer - inner), middle * np.sin(np.clip(aside, -0.5 * np.pi, 0.5 * np.pi))))


def _patch(pad: MeshedBody, middle: float, offset: float, piston: float, height: float) -> Any:
    """Row (n,) of the displacement along z over a round patch [m^3] at `height` [m], by points of its own.

    They are Gauss's along the radius and equally spaced round it, so force and centre are those of the patch.
    """
    along, weight = np.polynomial.legendre.leggauss(8)
    radius, turns = 0.5 * piston * (along + 1.0), 2.0 * np.pi * (np.arange(32) + 0.5) / 32
    x = middle * np.cos(offset / middle) + np.outer(radius, np.cos(turns)).ravel()
    y = middle * np.sin(offset / middle) + np.outer(radius, np.sin(turns)).ravel()
    area = np.repeat(0.5 * piston * weight * radius * 2.0 * np.pi / 32, 32)
    return area @ pad.points(np.array([x, y, np.full(len(x), height)]))[2]


def _directions(place: np.ndarray, sign: float) -> tuple[Any, Any, Any]:
    """Unit vectors (3, k) at places: into the disc, in the sense of its turning, and outwards."""
    r = np.hypot(place[0], place[1])
    cosine, sine, nothing = place[0] / r, place[1] / r, np.zeros(len(r))
    return (
        np.array([nothing, nothing, np.full(len(r), -sign)]),
        np.array([-sine, cosine, nothing]),
        np.array([cosine, sine, nothing]),
    )
