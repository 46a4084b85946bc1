"""Friction for a frictionless export: from contact pairs to the rows n, d, t and across of a table of contacts.

With the unit normal e_n from slave to master, e_t along the velocity of the master over the slave and e_a = e_n x e_t,

    r_e = e . (u_slave - sum_j w_j u_master_j)            a row of displacements along e
    N = N0 + k A r_n . q,   v = V - r_t . q',   d = r_t,   a = r_a,   K += k A r_n r_n'   unless K holds it already

Directions are global; where a node moves along a coordinate system of its own (the CD field of Nastran, *TRANSFORM
of Abaqus, NROTAT of Ansys) each row is turned there: its entries are R' e, with R the directions of that system.
"""

import os
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.contacts import Contacts
from squealbox.fe.pairs import Pair, read_pairs
from squealbox.fe.readers.matrix import MatrixFileError
from squealbox.fe.structure import Structure
from squealbox.fe.units import unit_system
from squealbox.law import FrictionLaw
from squealbox.parameters import DataSheet, ParameterError, choice, parameter

NO_LABELS = (
    "labels of the rows, to find the nodes of pairs: a .mat has none, a .npz may hold them beside the matrix, "
    "labels (n, 2) of node and direction"
)


class Rotation(DataSheet):
    """Masters that turn about an axis: they slide over a slave at x by omega e x (x - point), less what is normal."""

    axis: Any = (0.0, 0.0, 1.0)
    point: Any = (0.0, 0.0, 0.0)

    def velocity(self, place: np.ndarray) -> Any:
        """Velocity at `place` (3,) [m] for 1 rad/s [m/s]."""
        axis = _three("Rotation", "axis", self.axis)
        return np.cross(axis / np.linalg.norm(axis), place - _three("Rotation", "point", self.point, zero=True))


class CoordinateSystem(DataSheet):
    """Directions of some nodes' displacements: rectangular, or cylindrical about `axis` (r, theta, z)."""

    nodes: Any = ()
    shape: str = choice("rectangular", "cylindrical", default="rectangular", meaning="kind of coordinates")
    origin: Any = (0.0, 0.0, 0.0)
    axis: Any = (0.0, 0.0, 1.0)
    across: Any = (1.0, 0.0, 0.0)

    def directions(self, place: ArrayLike | None) -> Any:
        """Columns are the local directions in global ones, shape (3, 3); `place` [m] matters where cylindrical."""
        e3 = _three("CoordinateSystem", "axis", self.axis)
        e3 = e3 / np.linalg.norm(e3)
        towards = _three("CoordinateSystem", "across", self.across)
        if self.shape == "cylindrical":
            towards = np.asarray(place, dtype=float) - _three("CoordinateSystem", "origin", self.origin, zero=True)
        e1 = towards - (towards @ e3) * e3
        if float(np.linalg.norm(e1)) <= 1e-9 * max(float(np.linalg.norm(towards)), 1e-300):
            raise ParameterError("CoordinateSystem", "axis", self.axis, "an axis that does not pass through the node")
        e1 = e1 / np.linalg.norm(e1)
        return np.column_stack([e1, np.cross(e3, e1), e3])


class Interface(DataSheet):
    """Two surfaces that slide: pairs from a CSV, contact stiffness, direction of sliding, preload.

    `pairs` is a path or a tuple of `Pair`. `sliding` is a `Rotation` or a direction (x, y, z) in which masters move.
    `stiffness` is per area [N/m^3]; with in_matrices the export holds the closed contact, and K stays as it is. Preload
    of a pair is pressure times its area, or its own normal_force.
    """

    pairs: Any
    name: str = "interface"
    stiffness: float = parameter("N/m^3", 0.0, low_open=True, default=1e12, meaning="contact stiffness per area")
    pressure: float = parameter("Pa", 0.0, default=0.0, meaning="mean pressure at rest; preload of a pair by its area")
    sliding: Any = (1.0, 0.0, 0.0)
    in_matrices: bool = False
    unilateral: bool = False
    in_plane: bool = True
    friction: FrictionLaw | None = None

    def read(self) -> tuple[Pair, ...]:
        """The pairs."""
        return read_pairs(self.pairs) if isinstance(self.pairs, (str, os.PathLike)) else tuple(self.pairs)


def contacts_of(
    structure: Structure,
    interfaces: tuple[Interface, ...],
    law: FrictionLaw,
    speed: float,
    systems: tuple[CoordinateSystem, ...] = (),
) -> tuple[Contacts | None, Any]:
    """The table of contacts, and the stiffness (n, n) they add to K [N/m].

    `speed` is the angular speed [rad/s] where masters turn, their speed [m/s] where they move along a direction.
    Raises `MatrixFileError` for a pair that does not fit the structure, `ParameterError` for a direction without sense.
    """
    from scipy.sparse import csr_array, vstack

    table = _ContactRows(structure, systems)
    laws: list[FrictionLaw] = []
    for interface in interfaces:
        pairs = interface.read()
        for i, pair in enumerate(pairs):
            table.add(interface, pair, i, speed)
        laws += [interface.friction or law] * len(pairs)
    if not table.names:
        return None, csr_array((structure.size, structure.size))
    unit, across, sliding = (vstack(rows, format="csr") for rows in (table.normal, table.across, table.sliding))
    k = np.array(table.stiffness)
    n = csr_array(unit.multiply(k[:, None]))
    added = csr_array(unit.T @ csr_array(unit.multiply((k * ~np.array(table.held))[:, None])))
    same = all(one is laws[0] for one in laws)
    planes = np.array(table.plane)
    if not planes.all():
        across = csr_array(across.multiply(planes[:, None].astype(float)))
    contacts = Contacts(
        n=n,
        d=sliding,
        t=sliding,
        N0=np.array(table.force),
        V=np.array(table.speed),
        law=laws[0] if same else laws,
        names=tuple(table.names),
        unilateral=np.array(table.unilateral),
        normal=unit if any(table.unilateral) else None,
        across=across if planes.any() else None,
    )
    return contacts, added


class _ContactRows:
    """Rows of the contacts as they come."""

    def __init__(self, structure: Structure, systems: tuple[CoordinateSystem, ...]) -> None:
        self.structure = structure
        if structure.labels is None:
            raise ParameterError("structure", "labels", None, NO_LABELS)
        self.where = {(int(a), int(b)): i for i, (a, b) in enumerate(structure.labels)}
        self.known = set(structure.labels[:, 0].tolist())
        self.turned = {int(node): system for system in systems for node in system.nodes}
        self.normal: list[Any] = []
        self.sliding: list[Any] = []
        self.across: list[Any] = []
        self.stiffness: list[float] = []
        self.force: list[float] = []
        self.speed: list[float] = []
        self.names: list[str] = []
        self.unilateral: list[bool] = []
        self.held: list[bool] = []
        self.plane: list[bool] = []
        units = unit_system(structure.units) if structure.units else unit_system("SI")
        self.area_unit = units.length**2
        self.force_unit = units.mass * units.length / units.time**2

    def add(self, interface: Interface, pair: Pair, index: int, speed: float) -> None:
        """One pair."""
        path = Path(str(interface.pairs)) if isinstance(interface.pairs, (str, os.PathLike)) else Path(interface.name)
        if pair.normal is None:
            raise MatrixFileError(path, "a pair without a normal: expected nx, ny, nz", pair.line)
        normal = pair.normal
        sliding, rate = self._sliding(path, interface, pair, speed)
        across = np.cross(normal, sliding)
        if pair.area is None and pair.stiffness is None:
            raise MatrixFileError(path, "a pair without an area: expected area, or stiffness of its own", pair.line)
        area = (pair.area or 0.0) * self.area_unit
        own = pair.stiffness * self.force_unit / np.sqrt(self.area_unit) if pair.stiffness is not None else None
        for name, direction in (("normal", normal), ("sliding", sliding), ("across", across)):
            getattr(self, name).append(self._row(path, pair, direction))
        self.stiffness.append(own if own is not None else interface.stiffness * area)
        preload = pair.normal_force * self.force_unit if pair.normal_force is not None else interface.pressure * area
        self.force.append(preload)
        self.speed.append(rate)
        self.names.append(pair.name or f"{interface.name} {index + 1}")
        self.unilateral.append(interface.unilateral)
        self.held.append(interface.in_matrices)
        self.plane.append(interface.in_plane)

    def _sliding(self, path: Path, interface: Interface, pair: Pair, speed: float) -> tuple[Any, float]:
        """Unit direction of sliding in the tangent plane, and the speed [m/s]."""
        if pair.sliding is not None:
            velocity, given = pair.sliding, speed
            if isinstance(interface.sliding, Rotation):
                given = float(np.linalg.norm(interface.sliding.velocity(self._place(path, pair.slave, pair)))) * speed
            velocity = velocity * given
        elif isinstance(interface.sliding, Rotation):
            velocity = interface.sliding.velocity(self._place(path, pair.slave, pair)) * speed
        else:
            direction = _three("Interface", "sliding", interface.sliding)
            velocity = direction / np.linalg.norm(direction) * speed
        whole = float(np.linalg.norm(velocity))
        velocity = velocity - (velocity @ pair.normal) * pair.normal
        rate = float(np.linalg.norm(velocity))
        if rate <= 1e-6 * whole or rate == 0.0:
            raise MatrixFileError(
                path,
                f"pair {pair.slave}: it slides along its normal or not at all: expected along the surface",
                pair.line,
            )
        return velocity / rate, rate

    def _place(self, path: Path, node: int, pair: Pair) -> Any:
        if self.structure.nodes is None:
            raise MatrixFileError(path, "places of nodes are needed for this direction: give nodes", pair.line)
        try:
            return self.structure.nodes.at(node)
        except KeyError as error:
            raise MatrixFileError(path, f"node {node} has no place in the file of nodes", pair.line) from error

    def _row(self, path: Path, pair: Pair, direction: np.ndarray) -> Any:
        from scipy.sparse import csr_array

        columns: list[int] = []
        values: list[float] = []
        for node, weight in ((pair.slave, 1.0), *((master, -w) for master, w in pair.masters)):
            if node not in self.known:
                raise MatrixFileError(path, f"node {node} is not in the structure", pair.line)
            local = direction
            if node in self.turned:
                system = self.turned[node]
                place = self._place(path, node, pair) if system.shape == "cylindrical" else None
                local = system.directions(place).T @ direction
            for axis in range(3):
                if abs(local[axis]) < 1e-14:
                    continue
                row = self.where.get((node, axis + 1))
                if row is None and abs(local[axis]) > 1e-9 and not self._fixed(node, axis + 1):
                    raise MatrixFileError(
                        path, f"the structure has no freedom {node}.{axis + 1}, along which the pair acts", pair.line
                    )
                if row is not None:
                    columns.append(row)
                    values.append(weight * float(local[axis]))
        return csr_array((values, ([0] * len(values), columns)), shape=(1, self.structure.size))

    def _fixed(self, node: int, direction: int) -> bool:
        fixed = self.structure.constrained
        return fixed is not None and bool(np.any((fixed[:, 0] == node) & (fixed[:, 1] == direction)))


def _three(owner: str, name: str, value: ArrayLike, *, zero: bool = False) -> Any:
    array = np.asarray(value, dtype=float) if np.shape(value) == (3,) else None
    if array is None or not np.all(np.isfinite(array)) or (not zero and not np.any(array)):
        raise ParameterError(owner, name, value, "three finite numbers, not all zero")
    return array
