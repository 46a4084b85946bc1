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

    def stiffness(self, poisson: float, inside: Any = None) -> Any:
        """K [N/m] for a Young's modulus of 1 N/m^2, of the elements marked `inside` or all.

        With H_aibj = int dphi_a/dx_i dphi_b/dx_j, K_aibj = lam H_aibj + mu (H_ajbi + delta_ij sum_k H_akbk).
        """
        first, second = poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), 0.5 / (1.0 + poisson)
        basis = self._scalar
        weight = np.sqrt(basis.dx)
        slopes = np.stack([np.asarray(basis.basis[a][0].grad) * weight for a in range(basis.Nbfun)])
        slopes = np.moveaxis(slopes, 2, 0)  # element, shape function, direction, point
        count, shapes, _, points = slopes.shape
        flat = slopes.reshape(count, 3 * shapes, points)
        product = np.matmul(flat, np.swapaxes(flat, 1, 2)).reshape(count, shapes, 3, shapes, 3)
        turned = np.swapaxes(product, 2, 4)
        alike = np.einsum("eakbk->eab", product)
        element = first * product + second * turned
        for axis in range(3):
            element[:, :, axis, :, axis] += second * alike
        return self._assembled(element.reshape(count, 3 * shapes, 3 * shapes), inside)

    def mass(self, inside: Any = None) -> Any:
        """M [kg] for a density of 1 kg/m^3, of the elements marked `inside` or all."""
        basis = self._scalar
        weight = np.sqrt(basis.dx)
        values = np.stack([np.asarray(basis.basis[a][0]) * weight for a in range(basis.Nbfun)])
        values = np.moveaxis(values, 1, 0)
        product = np.matmul(values, np.swapaxes(values, 1, 2))
        count, shapes = product.shape[:2]
        element = np.zeros((count, shapes, 3, shapes, 3))
        for axis in range(3):
            element[:, :, axis, :, axis] = product
        return self._assembled(element.reshape(count, 3 * shapes, 3 * shapes), inside)

    @cached_property
    def _scalar(self) -> Any:
        """The basis of one component; its shape function a with direction i is number 3 a + i of the whole."""
        fem = skfem()
        return fem.Basis(self.basis.mesh, fem.ElementHexS2(), intorder=QUADRATURE)

    def _assembled(self, element: Any, inside: Any) -> Any:
        marked = np.arange(len(element)) if inside is None else np.flatnonzero(inside)
        numbers = self.freedoms[self.basis.element_dofs[:, marked]].T.astype(np.int32)
        width = numbers.shape[1]
        rows, columns = np.repeat(numbers, width, axis=1), np.tile(numbers, (1, width))
        matrix = sparse.coo_array((element[marked].ravel(), (rows.ravel(), columns.ravel())), shape=(self.size,) * 2)
        found = matrix.tocsr()
        return sparse.csr_array(0.5 * (found + found.T))  # round-off of the sums alone parts them

    def face(self, where: Any) -> FacePoints:
        """Quadrature points of the boundary facets whose middle (r, theta, z) fulfils `where`."""
        fem = skfem()
        flat = fem.MeshHex.init_tensor(self.r, self.theta, self.z)
        border = flat.boundary_facets()
        middles = flat.p[:, flat.facets[:, border]].mean(axis=1)
        facets = border[where(*middles)]
        basis = fem.FacetBasis(self.basis.mesh, fem.ElementHexS2(), facets=facets, intorder=QUADRATURE)
        place = np.asarray(basis.global_coordinates()).reshape(3, -1)
        values = np.stack([np.broadcast_to(np.asarray(basis.basis[a][0]), basis.dx.shape) for a in range(basis.Nbfun)])
        elements = np.broadcast_to(basis.tind[:, None], basis.dx.shape).ravel()
        return FacePoints(place, basis.dx.ravel(), self._rows(values.reshape(basis.Nbfun, -1), elements))

    def points(self, place: Any) -> tuple[Any, Any, Any]:
        """U_x, U_y, U_z (k, n) at places (3, k) [m] in the body or on its faces."""
        r, theta = np.hypot(place[0], place[1]), np.arctan2(place[1], place[0])
        theta = (theta - self.theta[0]) % (2.0 * np.pi) + self.theta[0]
        index = [
            np.clip(np.searchsorted(breaks, value, side="right") - 1, 0, len(breaks) - 2)
            for breaks, value in ((self.r, r), (self.theta, theta), (self.z, place[2]))
        ]
        elements = self._lookup[tuple(index)]
        basis = self._scalar
        local = basis.mapping.invF(place[:, :, None], tind=elements)
        values = [np.asarray(basis.elem.lbasis(local, a)[0]).reshape(-1) for a in range(basis.Nbfun)]
        return self._rows(np.stack(values), elements)

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

    def _rows(self, values: Any, elements: Any) -> tuple[Any, Any, Any]:
        """Rows of the three displacements from shape functions (20, k) in the elements (k,)."""
        shapes, count = values.shape
        where = np.tile(np.arange(count), shapes)
        rows = []
        for axis in range(3):
            which = self.freedoms[self.basis.element_dofs[axis::3][:, elements]].ravel()
            table = sparse.csr_array((values.ravel(), (where, which)), shape=(count, self.size))
            table.eliminate_zeros()
            rows.append(table)
        return rows[0], rows[1], rows[2]


def breaks(start: float, end: float, size: float, least: int = 1) -> Any:
    """Equal steps from start to end, none longer than `size`."""
    return np.linspace(start, end, max(least, int(np.ceil((end - start) / size - 1e-9))) + 1)
