"""Bodies of a disc brake as grids in r, theta and z, with curved quadratic elements, and what is needed of them.

A body is a ring or a sector of one; its elements are the 20-node bricks of scikit-fem (extra `fe`) on a geometry of 27
nodes, so an arc is an arc to the fourth order. Where a ring closes, the freedoms of the two ends are made one.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy import sparse
from scipy.spatial import cKDTree

QUADRATURE = 4  # order that quadratic elements need for stiffness, mass and faces
MISSING = "a brake meshed here needs scikit-fem: it comes with the extra fe, pip install 'squealbox[fe]'"


def skfem() -> Any:
    """scikit-fem, or a sentence where it is not installed."""
    try:
        import skfem as library
    except ModuleNotFoundError as error:
        raise ModuleNotFoundError(MISSING) from error
    return library


@dataclass(frozen=True, eq=False)
class FacePoints:
    """Quadrature points on a face: place (3, k) [m], area (k,) [m^2], and U_x, U_y, U_z (k, n): displacement there."""

    place: Any
    area: Any
    rows: tuple[Any, Any, Any]

    def along(self, direction: Any) -> Any:
        """Rows (k, n) of the displacement along a direction (3, k)."""
        return sum(sparse.diags_array(direction[i]) @ self.rows[i] for i in range(3))


@dataclass(frozen=True, eq=False)
class Body:
    """A grid: breaks in r [m], theta [rad] and z [m]; closed where theta goes round."""

    r: Any
    theta: Any
    z: Any
    closed: bool = False

    @cached_property
    def basis(self) -> Any:
        """scikit-fem's basis of displacements."""
        fem = skfem()
        flat = fem.MeshHex2.from_mesh(fem.MeshHex.init_tensor(self.r, self.theta, self.z))
        r, theta, z = flat.doflocs
        mesh = fem.MeshHex2(np.array([r * np.cos(theta), r * np.sin(theta), z]), flat.t)
        return fem.Basis(mesh, fem.ElementVector(fem.ElementHexS2()), intorder=QUADRATURE)

    @cached_property
    def centres(self) -> Any:
        """(3, elements): r, theta and z of the middle of every element."""
        fem = skfem()
        flat = fem.MeshHex.init_tensor(self.r, self.theta, self.z)
        return flat.p[:, flat.t].mean(axis=1)

    @cached_property
    def freedoms(self) -> Any:
        """(raw,): the number of the freedom that each freedom of the open grid becomes when the ring is closed."""
        places = self.basis.doflocs
        if not self.closed:
            return np.arange(places.shape[1])
        kinds = self._components()
        scale = float(self.r[-1])
        tree = cKDTree(np.vstack([places / scale, kinds[None] * 10.0]).T)
        twins = tree.query_pairs(1e-7, output_type="ndarray")
        target = np.arange(places.shape[1])
        if len(twins):
            target[np.max(twins, axis=1)] = np.min(twins, axis=1)
        _, numbers = np.unique(target, return_inverse=True)
        return numbers

    def _components(self) -> Any:
        """(raw,): 0, 1 or 2, the direction of each freedom of the open grid."""
        basis, kinds = self.basis, np.zeros(self.basis.N, dtype=int)
        for block in (basis.nodal_dofs, basis.edge_dofs, basis.facet_dofs, basis.interior_dofs):
            for row in range(block.shape[0]):
                kinds[block[row]] = row % 3
        return kinds

    @property
    def size(self) -> int:
        """Number of freedoms."""
        return int(self.freedoms.max()) + 1

    @cached_property
    def places(self) -> Any:
        """(3, n): where each freedom is [m]."""
        found = np.zeros((3, self.size))
        found[:, self.freedoms] = self.basis.doflocs
        return found

    @cached_property
    def _fold(self) -> Any:
        raw = len(self.freedoms)
        return sparse.csr_array((np.ones(raw), (np.arange(raw), self.freedoms)), shape=(raw, self.size))

    def stiffness(self, poisson: float, inside: Any = None) -> Any:
        """K [N/m] for a Young's modulus of 1 N/m^2, of the elements marked `inside` or all."""
        fem = skfem()
        from skfem.models.elasticity import lame_parameters, linear_elasticity

        form = linear_elasticity(*lame_parameters(1.0, poisson))
        return self._folded(fem.asm(form, self._part(inside)))

    def mass(self, inside: Any = None) -> Any:
        """M [kg] for a density of 1 kg/m^3, of the elements marked `inside` or all."""
        fem = skfem()
        from skfem.helpers import dot

        form = fem.BilinearForm(lambda u, v, _: dot(u, v))
        return self._folded(fem.asm(form, self._part(inside)))

    def _part(self, inside: Any) -> Any:
        if inside is None:
            return self.basis
        fem = skfem()
        return fem.Basis(self.basis.mesh, self.basis.elem, intorder=QUADRATURE, elements=np.flatnonzero(inside))

    def _folded(self, matrix: Any) -> Any:
        found = sparse.csr_array(self._fold.T @ sparse.csr_array(matrix) @ self._fold)
        return sparse.csr_array(0.5 * (found + found.T))  # round-off of the sums alone parts them

    def face(self, where: Any) -> FacePoints:
        """Quadrature points of the boundary facets whose middle (r, theta, z) fulfils `where`."""
        fem = skfem()
        flat = fem.MeshHex.init_tensor(self.r, self.theta, self.z)
        border = flat.boundary_facets()
        middles = flat.p[:, flat.facets[:, border]].mean(axis=1)
        facets = border[where(*middles)]
        basis = fem.FacetBasis(self.basis.mesh, self.basis.elem, facets=facets, intorder=QUADRATURE)
        place = np.asarray(basis.global_coordinates()).reshape(3, -1)
        values = [np.asarray(basis.basis[i][0]) for i in range(basis.Nbfun)]
        shape = basis.dx.shape
        columns = [np.broadcast_to(basis.element_dofs[i][:, None], shape) for i in range(basis.Nbfun)]
        return FacePoints(place, basis.dx.ravel(), self._rows(values, columns, shape))

    def points(self, place: Any) -> tuple[Any, Any, Any]:
        """U_x, U_y, U_z (k, n) at places (3, k) [m] in the body or on its faces."""
        r, theta = np.hypot(place[0], place[1]), np.arctan2(place[1], place[0])
        theta = (theta - self.theta[0]) % (2.0 * np.pi) + self.theta[0]
        index = [
            np.clip(np.searchsorted(breaks, value, side="right") - 1, 0, len(breaks) - 2)
            for breaks, value in ((self.r, r), (self.theta, theta), (self.z, place[2]))
        ]
        elements = self._lookup[tuple(index)]
        basis = self.basis
        local = basis.mapping.invF(place[:, :, None], tind=elements)
        values, columns = [], []
        for i in range(basis.Nbfun):
            field = basis.elem.gbasis(basis.mapping, local, i, tind=elements)[0]
            values.append(np.asarray(field).reshape(3, -1, 1))
            columns.append(basis.element_dofs[i][elements][:, None])
        return self._rows(values, columns, (place.shape[1], 1))

    @cached_property
    def _lookup(self) -> Any:
        """(r, theta, z) cells to element numbers."""
        shape = tuple(len(breaks) - 1 for breaks in (self.r, self.theta, self.z))
        found = np.zeros(shape, dtype=int)
        cells = [
            np.searchsorted(breaks, centre) - 1
            for breaks, centre in zip((self.r, self.theta, self.z), self.centres, strict=True)
        ]
        found[tuple(cells)] = np.arange(self.centres.shape[1])
        return found

    def _rows(self, values: Any, columns: Any, shape: Any) -> tuple[Any, Any, Any]:
        count = int(np.prod(shape))
        numbers = np.broadcast_to(np.arange(count).reshape(shape), shape)
        where = np.concatenate([numbers.ravel() for _ in values])
        which = self.freedoms[np.concatenate([np.asarray(c).ravel() for c in columns])]
        rows = []
        for axis in range(3):
            entries = np.concatenate([np.asarray(v)[axis].ravel() for v in values])
            table = sparse.csr_array((entries, (where, which)), shape=(count, self.size))
            table.eliminate_zeros()
            rows.append(table)
        return rows[0], rows[1], rows[2]


def breaks(start: float, end: float, size: float, least: int = 1) -> Any:
    """Equal steps from start to end, none longer than `size`."""
    return np.linspace(start, end, max(least, int(np.ceil((end - start) / size - 1e-9))) + 1)
