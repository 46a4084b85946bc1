"""What brakes meshed here have in common: bodies to matrices per unit of each parameter, and these to a system.

Contact is at quadrature points of the linings' faces, where a point of area A has the spring k A between the lining and
the body below it. With u the lining's displacement less that body's and e_n from the lining into it, there

    N = k A (u . e_n),   sliding V = r O,   t = d = e_t . u,   across = e_a . u

so each point may lift off; how many do, and what friction adds to the pressure distribution, steady sliding says.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike
from scipy import sparse

from squealbox.contacts import Contacts, unchanging
from squealbox.design import Design
from squealbox.fe.grids import FacePoints, MeshedBody
from squealbox.fe.undamped_modes import RealModes, real_modes
from squealbox.fe.wear import Pressed, Worn, run_in
from squealbox.parameters import DataSheet, ParameterError, parameter
from squealbox.system import Equilibrium, System, equilibrium

if TYPE_CHECKING:
    from scipy.sparse import sparray

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


@dataclass(frozen=True, eq=False)
class MeshedStructure:
    """A meshed brake per unit of each modulus, density, spring and load, on all n freedoms, and its contact points.

    mass, stiffness and springs are matrices (n, n) by name, loads vectors (n,) by name; normal, along and across are
    rows (k, n) at the contact points, with their area, place (3, k), radius of sliding, side (which lining) and name,
    and for each the angle from the middle of its lining. moving (n, linings) is how each lining follows what is worn
    off it, as `wear` has it. kept lists what of the bodies' freedoms is not held.
    """

    size: int
    mass: dict[str, Any]
    stiffness: dict[str, Any]
    springs: dict[str, Any]
    loads: dict[str, Any]
    normal: Any
    along: Any
    across: Any
    area: Any
    place: Any
    radius: Any
    angle: Any
    side: Any
    names: tuple[str, ...]
    moving: Any
    bodies: tuple[MeshedBody, ...]
    kept: Any

    def by_body(self, values: ArrayLike) -> list[Any]:
        """Of values (n, ...) on the freedoms those of each body, with zeros where it is held."""
        sizes = [body.size for body in self.bodies]
        whole = np.zeros((sum(sizes), *np.shape(values)[1:]), dtype=np.asarray(values).dtype)
        whole[self.kept] = values
        return np.split(whole, np.cumsum(sizes)[:-1])


def speed_of(part: str) -> Any:
    """The parameter `angular_speed` of a brake whose disc or drum turns."""
    return parameter("rad/s", 0.0, low_open=True, default=18.0, meaning=f"angular speed of the {part}", source=OWN)


def stiffness_of_contact() -> Any:
    """The parameter `contact_stiffness`."""
    return parameter("N/m^3", 0.0, low_open=True, default=1e12, meaning="stiffness of contact per area", source=OWN)


def longest_side(where: str) -> Any:
    """The parameter `element_size`."""
    return parameter("m", 1e-4, default=0.012, meaning=f"longest side of an element {where}", source=OWN)


def some_of(inside: np.ndarray, sheet: str, chamfer: float) -> Any:
    """The places that hold; `ParameterError` where the chamfer of a sheet leaves none."""
    if not np.any(inside):
        raise ParameterError(sheet, "chamfer", chamfer, "an angle that leaves some of the lining to touch")
    return np.flatnonzero(inside)


class MeshedBrake(Design):
    """A brake that meshes itself; a subclass says of what it is made.

    It has the parameters `friction`, `angular_speed`, `contact_stiffness`, `running_in` and `running_in_friction`.
    """

    followers: ClassVar[str] = ""
    """The springs whose ends come along with a lining that wears, if there are such."""

    def structure(self) -> MeshedStructure:
        """Matrices per unit of modulus and density, contact points and faces; the same for all that shares a mesh."""
        raise NotImplementedError

    def materials(self) -> dict[str, Material]:
        """The material of each meshed component, by its name."""
        raise NotImplementedError

    def held_by(self) -> dict[str, float]:
        """The stiffness of each kind of spring [N/m], by its name."""
        raise NotImplementedError

    def pressed_by(self) -> dict[str, float]:
        """How much of each load acts, by its name."""
        raise NotImplementedError

    def wearing_under(self) -> dict[str, float]:
        """How much of each load acts while the linings wear, by its name."""
        raise NotImplementedError

    def touching(self, made: MeshedStructure) -> Any:
        """Contact points that touch, as numbers."""
        return np.arange(len(made.area))

    def one_system(self) -> None:
        """Raise `ParameterError` where a parameter is an array."""
        for name, _, value in self.leaves():
            if np.ndim(value) and not name.startswith("friction"):
                raise ParameterError(
                    type(self).__name__, name, value, "one number: one system at a time; reduce() makes a sweep"
                )

    def components(self) -> dict[str, tuple[Any, Any]]:
        """Mass and stiffness of each component on all freedoms, the springs and the contact among them."""
        made = self.structure()
        parts = self.materials()
        found = {name: (m.density * made.mass[name], m.young * made.stiffness[name]) for name, m in parts.items()}
        nothing = sparse.csr_array((made.size, made.size))
        springs = sum(value * made.springs[name] for name, value in self.held_by().items())
        touching = self.touching(made)
        rows = made.normal[touching]
        contact = rows.T @ sparse.diags_array(self.value_of("contact_stiffness") * made.area[touching]) @ rows
        return {**found, "springs": (nothing, sparse.csr_array(springs)), "contact": (nothing, contact)}

    def node_rows(self) -> tuple[Any, Any]:
        """Number from 1 of the node, shape (n,), and place [m], shape (n, 3), that each freedom belongs to."""
        made = self.structure()
        places = np.concatenate([body.places[:3] for body in made.bodies], axis=1).T[made.kept]
        body = np.repeat(np.arange(len(made.bodies)), [body.size for body in made.bodies])[made.kept]
        apart = np.round(np.column_stack([body, places]), 9)  # bodies that touch do not share their nodes
        return np.unique(apart, axis=0, return_inverse=True)[1].ravel() + 1, places

    def system(self) -> System:
        """M, C, K with every contact closed, what presses as load, and a unilateral contact at every point."""
        self.one_system()
        made = self.structure()
        touching = self.touching(made)
        stiffness = float(self.value_of("contact_stiffness"))
        matrices, (normal, pushed, along, across) = summed(*self._sums(made, touching))
        load = sum(value * made.loads[name] for name, value in self.pressed_by().items())
        worn, preload = self.worn(), 0.0
        if worn is not None:
            preload = -stiffness * made.area[touching] * worn.uneven
            load = load - normal.T @ preload  # of closed contacts, as `Contact` has it
        contacts = Contacts(
            n=pushed,
            d=along,
            t=along,
            N0=preload,
            V=self.value_of("angular_speed") * made.radius[touching],
            law=self.value_of("friction"),
            names=tuple(np.array(made.names)[touching]),
            unilateral=True,
            normal=normal,
            across=across,
        )
        return System(*matrices, load, contacts)

    def worn(self) -> Worn | None:
        """What running in has worn off each contact point that touches; None of new linings."""
        depth, friction = (float(self.value_of(name)) for name in ("running_in", "running_in_friction"))
        if depth == 0.0:
            return None
        made = self.structure()
        loads = tuple((name, float(value)) for name, value in self.wearing_under().items())
        return worn_linings(self._sums(made, self.touching(made)), loads, self.followers, friction, depth)

    def _sums(self, made: MeshedStructure, touching: np.ndarray) -> tuple[Any, ...]:
        """What `summed` takes."""
        elastic = tuple((name, *(float(x) for x in vars_of(part))) for name, part in self.materials().items())
        springs = tuple((name, float(value)) for name, value in self.held_by().items())
        return made, elastic, springs, float(self.value_of("contact_stiffness")), touching.tobytes()

    def preload(self, state: Equilibrium | None = None) -> "Preload":
        """Steady sliding, found here or known: which points lift off, how unevenly the others press."""
        made = self.structure()
        touching, worn = self.touching(made), self.worn()
        about = made.area[touching], made.place[:, touching], made.side[touching]
        state = equilibrium(self.system()) if state is None else state
        return Preload(state, *about, np.zeros(len(touching)) if worn is None else worn.depth)

    def shares(self, shape: np.ndarray) -> dict[str, tuple[float, float]]:
        """Each component's share of a mode's kinetic and of its strain energy, for a shape (n,)."""
        energies = {
            name: tuple(float(np.real(np.vdot(shape, matrix @ shape))) for matrix in pair)
            for name, pair in self.components().items()
        }
        kinetic, strain = (sum(pair[i] for pair in energies.values()) for i in (0, 1))
        return {name: (pair[0] / kinetic, pair[1] / strain) for name, pair in energies.items()}


@dataclass(frozen=True, eq=False)
class Preload:
    """Steady sliding of a brake, and of each contact point its area [m^2], place (3, k) [m], lining, 0 or 1, and the
    depth worn off [m].
    """

    equilibrium: Equilibrium
    area: Any
    place: Any
    side: Any
    worn: Any

    @property
    def lifted(self) -> Any:
        """True where a point has lifted off, (k,)."""
        return self.equilibrium.normal_force <= 0.0

    @property
    def pressure(self) -> Any:
        """Contact pressure [Pa] at each point, (k,)."""
        return self.equilibrium.normal_force / self.area

    def force(self, side: int) -> float:
        """Normal force of one lining [N]."""
        return float(np.sum(self.equilibrium.normal_force[self.side == side]))

    def torque(self, side: int) -> float:
        """Torque of one lining's friction about the axis [N m]."""
        friction = self.equilibrium.friction * self.equilibrium.normal_force
        return float(np.sum((friction * np.hypot(self.place[0], self.place[1]))[self.side == side]))


def vars_of(material: Material) -> tuple[float, float, float]:
    """Density, Young's modulus and damping."""
    return material.density, material.young, material.damping


@lru_cache(maxsize=2)
def summed(
    made: MeshedStructure,
    elastic: tuple[tuple[str, float, float, float], ...],
    springs: tuple[tuple[str, float], ...],
    contact: float,
    touching: bytes,
) -> tuple[tuple[Any, Any, Any], tuple[Any, ...]]:
    """M, C and K of a structure, and the rows normal, n, along and across of its contacts.

    Kept, because friction, pressure and speed change none of them.
    """
    mass = sum(density * made.mass[name] for name, density, _, _ in elastic)
    damping = sum(young * share * made.stiffness[name] for name, _, young, share in elastic)
    some = np.frombuffer(touching, dtype=np.int64)
    normal, along, across = (rows[some] for rows in (made.normal, made.along, made.across))
    pushed = sparse.csr_array(sparse.diags_array(contact * made.area[some]) @ normal)
    light = normal.T @ pushed + sum(k * made.springs[name] for name, k in springs)
    stiffness = sum(young * made.stiffness[name] for name, _, young, _ in elastic) + light
    matrices, rows = (mass, damping, stiffness), (normal, pushed, along, across)
    return tuple(tuple(unchanging(sparse.csr_array(table)) for table in tables) for tables in (matrices, rows))  # type: ignore[return-value]


@lru_cache(maxsize=8)
def worn_linings(
    sums: tuple[Any, ...], loads: tuple[tuple[str, float], ...], followers: str, friction: float, depth: float
) -> Worn:
    """What running in wears off the linings of a brake that `summed` sums up; kept, because sweeps ask for it again."""
    made, _, springs, contact, touching = sums
    some = np.frombuffer(touching, dtype=np.int64)
    (_, _, stiffness), (normal, _, along, _) = summed(*sums)
    brake = Pressed(
        stiffness=stiffness,
        load=sum(value * made.loads[name] for name, value in loads),
        normal=normal,
        along=along,
        area=made.area[some],
        radius=made.radius[some],
        contact=contact,
        friction=friction,
        moving=made.moving,
    )
    return run_in(brake, depth, dict(springs)[followers] * made.springs[followers] if followers else None)


def modes_alone(body: MeshedBody, material: Material, top: float, held: Any = None) -> RealModes:
    """Undamped modes below `top` [Hz] of one body, free or without the freedoms marked `held` (n,)."""
    kept = np.arange(body.size) if held is None else np.flatnonzero(~held)
    stiffness, mass = material.young * body.stiffness(material.poisson), material.density * body.mass()
    return real_modes(sparse.csr_array(stiffness[kept][:, kept]), sparse.csr_array(mass[kept][:, kept]), top)


class FreedomsOfBodies:
    """Where the freedoms of several bodies stand among all, without those that are held."""

    def __init__(self, bodies: Sequence[MeshedBody], held: Sequence[Any]) -> None:
        self.inner = [np.flatnonzero(~at) for at in held]
        self.starts = np.cumsum([0, *(len(inner) for inner in self.inner)])
        self.size = int(self.starts[-1])
        whole = np.cumsum([0, *(body.size for body in bodies)])
        self.kept = np.concatenate([start + inner for start, inner in zip(whole, self.inner, strict=False)])

    def freedoms(self, body: int) -> Any:
        """Where a body's freedoms stand."""
        return np.arange(self.starts[body], self.starts[body + 1])

    def square(self, matrix: "sparray", body: int) -> Any:
        """A body's matrix on all freedoms."""
        inside = self.rows(sparse.csr_array(matrix)[self.inner[body]], body)
        before, after = self.starts[body], self.size - self.starts[body + 1]
        ends = np.concatenate([np.zeros(before), inside.indptr, np.full(after, inside.indptr[-1])]).astype(np.int32)
        return sparse.csr_array((inside.data, inside.indices, ends), shape=(self.size, self.size))

    def rows(self, table: "sparray", body: int) -> Any:
        """Rows (k, n of the body) on all freedoms."""
        inside = sparse.csr_array(table)
        if len(self.inner[body]) < inside.shape[1]:
            inside = inside[:, self.inner[body]]
        where = (inside.indices + self.starts[body]).astype(np.int32)
        return sparse.csr_array((inside.data, where, inside.indptr), shape=(inside.shape[0], self.size))

    def pin(self, face: FacePoints, body: int, direction: ArrayLike) -> Any:
        """The row (1, n) of a face's mean displacement along a direction (3,)."""
        directions = np.repeat(np.asarray(direction)[:, None], len(face.area), axis=1)
        share = sparse.csr_array((face.area / np.sum(face.area))[None, :])
        return share @ self.rows(face.along(directions), body)

    def spring(self, face: FacePoints, body: int, *directions: Any) -> Any:
        """A spring of 1 N/m over a face along each of the directions (3, k), spread by area."""
        rows = [self.rows(face.along(direction), body) for direction in directions]
        return sum(row.T @ sparse.diags_array(face.area / np.sum(face.area)) @ row for row in rows)
