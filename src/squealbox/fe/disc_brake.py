"""A disc between two pads, meshed and assembled here: from thicknesses and moduli to a sparse system.

The disc is held at its bore and turns with `angular_speed`; each pad, a lining on a back plate, is pressed on it by
`pressure` on a patch of the plate, held by springs of the caliper and the abutments. Pads and disc have meshes of their
own. Contact is at the quadrature points of the linings' faces, where a point of area A has the spring k A between the
lining and the disc below it. With u the lining's displacement less the disc's, there

    N = k A (u . e_n),  e_n from the lining into the disc       sliding V = r O,  t = d = e_theta . u,  across = e_r . u

so each point may lift off; how many do, and what friction adds to the pressure distribution, steady sliding says.
"""

from dataclasses import dataclass
from functools import lru_cache
from typing import Any, ClassVar

import numpy as np
from scipy import sparse

from squealbox.contacts import Contacts
from squealbox.designs.base import Design
from squealbox.fe.grids import Body, breaks
from squealbox.fe.real_modes import RealModes, real_modes
from squealbox.friction import Coulomb, FrictionLaw
from squealbox.parameters import DataSheet, ParameterError, parameter
from squealbox.system import Equilibrium, System, equilibrium

OWN = "chosen here"


class Material(DataSheet):
    """An elastic material with damping proportional to its stiffness."""

    young: float = parameter("Pa", 0.0, low_open=True, default=210e9, meaning="Young's modulus")
    poisson: float = parameter("-", -1.0, 0.5, low_open=True, high_open=True, default=0.3, meaning="Poisson's ratio")
    density: float = parameter("kg/m^3", 0.0, low_open=True, default=7850.0, meaning="density")
    damping: float = parameter("s", 0.0, default=2e-8, meaning="damping per stiffness")


STEEL = Material()
IRON = Material(young=110e9, poisson=0.26, density=7200.0)
LINING = Material(young=4e9, poisson=0.25, density=2500.0, damping=1e-7)


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


class DiscBrake(Design):
    """A disc brake of finite elements, made from nothing.

    >>> round(DiscBrake(element_size=0.02).disc.outer_radius, 3)
    0.14
    """

    title: ClassVar[str] = "Disc brake of finite elements"
    source: ClassVar[str] = "dimensions of a passenger car's brake, chosen here"

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
    angular_speed: float = parameter(
        "rad/s", 0.0, low_open=True, default=18.0, meaning="angular speed of the disc", source=OWN
    )
    contact_stiffness: float = parameter(
        "N/m^3", 0.0, low_open=True, default=1e12, meaning="stiffness of contact per area", source=OWN
    )
    element_size: float = parameter(
        "m", 1e-4, default=0.012, meaning="longest side of an element in the plane of the disc", source=OWN
    )

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

    def structure(self) -> "Structure":
        """Matrices per unit of modulus and density, contact points and faces; the same for all that shares a mesh."""
        for name, _, value in self.leaves():
            if np.ndim(value) and not name.startswith("friction"):
                raise ParameterError(
                    "DiscBrake", name, value, "one number: one system at a time; reduce() makes a sweep"
                )
        lining, disc, plate = self.pads.material, self.disc.material, self.backplates.material
        shape = (
            *(self.disc.inner_radius, self.disc.outer_radius, self.disc.thickness, disc.poisson),
            *(self.pads.inner_radius, self.pads.outer_radius, self.pads.angle, self.pads.thickness, lining.poisson),
            *(self.backplates.thickness, plate.poisson, self.piston_radius, self.element_size),
        )
        return structure(*(float(value) for value in shape))

    def components(self) -> dict[str, tuple[Any, Any]]:
        """Mass and stiffness of each component, on all freedoms: disc, linings, backplates, springs, contact."""
        made = self.structure()
        parts = {"disc": self.disc.material, "linings": self.pads.material, "backplates": self.backplates.material}
        found = {
            name: (material.density * made.mass[name], material.young * made.stiffness[name])
            for name, material in parts.items()
        }
        nothing = sparse.csr_array((made.size, made.size))
        springs = self.springs.caliper * made.caliper + self.springs.abutment * made.abutment
        weight = self.contact_stiffness * made.area[self._touching(made)]
        rows = made.normal[self._touching(made)]
        return {
            **found,
            "springs": (nothing, springs),
            "contact": (nothing, rows.T @ sparse.diags_array(weight) @ rows),
        }

    def system(self) -> System:
        """M, C, K with every contact closed, the pressure as load, and a unilateral contact at every point."""
        made, parts = self.structure(), self.components()
        mass = sum(m for m, _ in parts.values())
        stiffness = sum(k for _, k in parts.values())
        dampings = {"disc": self.disc.material, "linings": self.pads.material, "backplates": self.backplates.material}
        damping = sum(material.damping * parts[name][1] for name, material in dampings.items())
        touching = self._touching(made)
        normal = made.normal[touching]
        spring = self.contact_stiffness * made.area[touching]
        contacts = Contacts(
            n=sparse.diags_array(spring) @ normal,
            d=made.along[touching],
            t=made.along[touching],
            N0=0.0,
            V=self.angular_speed * made.radius[touching],
            law=self.friction,
            names=tuple(np.array(made.names)[touching]),
            unilateral=True,
            normal=normal,
            across=made.across[touching],
        )
        return System(mass, damping, stiffness, self.pressure * made.load, contacts)

    def preload(self) -> "Preload":
        """Steady sliding under the pressure: which points lift off, how unevenly the others press."""
        made, system = self.structure(), self.system()
        touching = self._touching(made)
        return Preload(equilibrium(system), made.area[touching], made.place[:, touching], made.side[touching])

    def shares(self, shape: Any) -> dict[str, tuple[float, float]]:
        """Each component's share of a mode's kinetic and of its strain energy, for a shape (n,)."""
        energies = {
            name: tuple(float(np.real(np.vdot(shape, matrix @ shape))) for matrix in pair)
            for name, pair in self.components().items()
        }
        kinetic, strain = (sum(pair[i] for pair in energies.values()) for i in (0, 1))
        return {name: (pair[0] / kinetic, pair[1] / strain) for name, pair in energies.items()}

    def _touching(self, made: "Structure") -> Any:
        """Contact points outside chamfers and slot."""
        offset = np.abs(made.angle)
        inside = (offset < 0.5 * self.pads.angle - self.pads.chamfer) & (offset >= 0.5 * self.pads.slot)
        if not np.any(inside):
            raise ParameterError(
                "Pads", "chamfer", self.pads.chamfer, "an angle that leaves some of the lining to touch"
            )
        return np.flatnonzero(inside)


@dataclass(frozen=True, eq=False)
class Preload:
    """Steady sliding of a disc brake, and of each contact point its area [m^2], place (3, k) [m] and pad, 0 or 1."""

    equilibrium: Equilibrium
    area: Any
    place: Any
    side: Any

    @property
    def lifted(self) -> Any:
        """True where a point has lifted off, (k,)."""
        return self.equilibrium.normal_force <= 0.0

    @property
    def pressure(self) -> Any:
        """Contact pressure [Pa] at each point, (k,)."""
        return self.equilibrium.normal_force / self.area

    def force(self, side: int) -> float:
        """Normal force of one pad [N]."""
        return float(np.sum(self.equilibrium.normal_force[self.side == side]))


@dataclass(frozen=True, eq=False)
class Structure:
    """A meshed brake per unit of each modulus, density, stiffness and pressure, on all n freedoms."""

    size: int
    mass: dict[str, Any]
    stiffness: dict[str, Any]
    caliper: Any
    abutment: Any
    load: Any
    normal: Any
    along: Any
    across: Any
    area: Any
    place: Any
    radius: Any
    angle: Any
    side: Any
    names: tuple[str, ...]
    bodies: tuple[Body, ...]
    kept: Any


@lru_cache(maxsize=4)
def structure(
    bore: float,
    rim: float,
    thick: float,
    disc_poisson: float,
    inner: float,
    outer: float,
    angle: float,
    lining: float,
    lining_poisson: float,
    plate: float,
    plate_poisson: float,
    piston: float,
    size: float,
) -> Structure:
    """Mesh and assemble a disc and two pads; all lengths in m, the angle in rad."""
    half = 0.5 * thick
    around = breaks(0.0, 2.0 * np.pi, size / (0.5 * (inner + outer)), 12)
    disc = Body(breaks(bore, rim, size, 2), around, breaks(-half, half, size, 2), closed=True)
    sector = breaks(-0.5 * angle, 0.5 * angle, size / (0.5 * (inner + outer)), 3)
    radii = breaks(inner, outer, size, 2)
    through = np.concatenate([breaks(0.0, lining, size), breaks(lining, lining + plate, size)[1:]])
    pads = [Body(radii, sector, half + through), Body(radii, sector, -(half + through)[::-1])]
    bodies = (disc, *pads)
    starts = np.cumsum([0, *(body.size for body in bodies)])
    whole = int(starts[-1])
    r = np.hypot(disc.places[0], disc.places[1])
    held = np.flatnonzero(r < bore * (1.0 + 1e-6))
    kept = np.setdiff1d(np.arange(whole), held)
    into = sparse.csr_array((np.ones(len(kept)), (kept, np.arange(len(kept)))), shape=(whole, len(kept)))

    def on_all(matrix: Any, body: int) -> Any:
        place = sparse.csr_array(
            (np.ones(bodies[body].size), (starts[body] + np.arange(bodies[body].size), np.arange(bodies[body].size))),
            shape=(whole, bodies[body].size),
        )
        return sparse.csr_array(matrix @ place.T @ into)

    def square(matrix: Any, body: int) -> Any:
        return sparse.csr_array(on_all(sparse.csr_array(on_all(matrix, body)).T, body))

    mass: dict[str, Any] = {"disc": square(disc.mass(), 0)}
    stiffness: dict[str, Any] = {"disc": square(disc.stiffness(disc_poisson), 0)}
    for name, poisson, inside in (("linings", lining_poisson, True), ("backplates", plate_poisson, False)):
        marks = [(np.abs(pad.centres[2]) < half + lining) == inside for pad in pads]
        mass[name] = sum(square(pad.mass(m), i + 1) for i, (pad, m) in enumerate(zip(pads, marks, strict=True)))
        stiffness[name] = sum(
            square(pad.stiffness(poisson, m), i + 1) for i, (pad, m) in enumerate(zip(pads, marks, strict=True))
        )
    caliper, abutment, load = 0.0, 0.0, np.zeros(len(kept))
    tables: dict[str, list[Any]] = {key: [] for key in ("normal", "along", "across", "area", "place", "angle", "side")}
    for i, pad in enumerate(pads):
        sign = 1.0 if i == 0 else -1.0  # the pad above presses downwards
        face = pad.face(lambda _r, _t, z: np.abs(np.abs(z) - half) < 1e-9)
        normal, turned, outward = _directions(face.place, sign)
        below = disc.points(np.array([face.place[0], face.place[1], np.full(face.place.shape[1], sign * half)]))
        for key, direction in (("normal", normal), ("along", turned), ("across", outward)):
            lower = sum(sparse.diags_array(direction[j]) @ below[j] for j in range(3))
            tables[key].append(on_all(face.along(direction), i + 1) - on_all(lower, 0))
        tables["area"].append(face.area)
        tables["place"].append(face.place)
        tables["angle"].append(np.arctan2(face.place[1], face.place[0]))
        tables["side"].append(np.full(len(face.area), i))
        back = pad.face(lambda _r, _t, z: np.abs(np.abs(z) - half - lining - plate) < 1e-9)
        down = on_all(back.along(_directions(back.place, sign)[0]), i + 1)
        caliper = caliper + down.T @ sparse.diags_array(back.area / np.sum(back.area)) @ down
        pressed = np.hypot(back.place[0] - 0.5 * (inner + outer), back.place[1]) < piston
        if not np.any(pressed):
            raise ParameterError(
                "DiscBrake", "piston_radius", piston, "a patch that holds at least one quadrature point"
            )
        middle, loaded = 0.5 * (inner + outer), float(np.sum(back.area[pressed]))
        if piston <= 0.5 * (outer - inner) and piston <= middle * np.sin(min(0.5 * angle, 0.5 * np.pi)):
            loaded = np.pi * piston**2  # the patch lies within the plate: its area is known better than by points
        load += down.T @ np.where(pressed, back.area * loaded / np.sum(back.area[pressed]), 0.0)
        for end in (-0.5 * angle, 0.5 * angle):
            side = pad.face(lambda _r, t, z, end=end: (np.abs(t - end) < 1e-9) & (np.abs(z) > half + lining))
            _, turned, outward = _directions(side.place, sign)
            for direction in (turned, outward):
                rows = on_all(side.along(direction), i + 1)
                abutment = abutment + rows.T @ sparse.diags_array(side.area / np.sum(side.area)) @ rows
    stacked = {k: sparse.vstack(tables[k], format="csr") for k in ("normal", "along", "across")}
    places = np.concatenate(tables["place"], axis=1)
    sides = np.concatenate(tables["side"])
    names = tuple(f"pad {s + 1} point {i + 1}" for i, s in enumerate(sides))
    return Structure(
        size=len(kept),
        mass=mass,
        stiffness=stiffness,
        caliper=sparse.csr_array(caliper),
        abutment=sparse.csr_array(abutment),
        load=load,
        **stacked,
        area=np.concatenate(tables["area"]),
        place=places,
        radius=np.hypot(places[0], places[1]),
        angle=np.concatenate(tables["angle"]),
        side=sides,
        names=names,
        bodies=bodies,
        kept=kept,
    )


def free_disc_modes(disc: Disc, element_size: float, top: float, *, held: bool = False) -> RealModes:
    """Undamped modes below `top` [Hz] of the disc alone, free or held at its bore: what a hammer test finds."""
    half = 0.5 * disc.thickness
    around = breaks(0.0, 2.0 * np.pi, element_size / (0.5 * (disc.inner_radius + disc.outer_radius)), 12)
    radii = breaks(disc.inner_radius, disc.outer_radius, element_size, 2)
    body = Body(radii, around, breaks(-half, half, element_size, 2), closed=True)
    stiffness, mass = disc.material.young * body.stiffness(disc.material.poisson), disc.material.density * body.mass()
    if held:
        kept = np.flatnonzero(np.hypot(*body.places[:2]) > disc.inner_radius * (1.0 + 1e-6))
        stiffness, mass = stiffness[kept][:, kept], mass[kept][:, kept]
    return real_modes(sparse.csr_array(stiffness), sparse.csr_array(mass), top)


def _directions(place: Any, sign: float) -> tuple[Any, Any, Any]:
    """Unit vectors (3, k) at places: into the disc, in the sense of its turning, and outwards."""
    r = np.hypot(place[0], place[1])
    cosine, sine, nothing = place[0] / r, place[1] / r, np.zeros(len(r))
    return (
        np.array([nothing, nothing, np.full(len(r), -sign)]),
        np.array([-sine, cosine, nothing]),
        np.array([cosine, sine, nothing]),
    )
