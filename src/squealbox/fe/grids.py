"""Bodies of a brake as grids in r, theta and z, with curved quadratic elements, and what is needed of them.

A body is a ring or a sector of one; its elements are the 20-node bricks of scikit-fem (extra `fe`) on a geometry that
is quadratic along the arc, so an arc is an arc to the fourth order. With s from -1 to 1 over an element whose middle is
at the angle m and whose half angle is a,

    (x, y) = r R(m) g(s),   g = (1 - (1 - cos a) s^2, s sin a)

so elements that differ in their angle alone have the same matrices, turned. Where a ring closes, the freedoms of the
two ends are made one.
"""

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np
from scipy import sparse

from squealbox.extras import extra

QUADRATURE = 4  # order that quadratic elements need for stiffness, mass and faces


def skfem() -> Any:
    """scikit-fem, or a sentence where it is not installed."""
    with extra("fe"):
        import skfem as library
    return library


@dataclass(frozen=True, eq=False)
class FacePoints:
    """Quadrature points on a face: place (3, k) [m], area (k,) [m^2], and U_x, U_y, U_z (k, n): displacement there."""

    place: Any
    area: Any
    rows: tuple[Any, Any, Any]

    def along(self, direction: np.ndarray) -> Any:
        """Rows (k, n) of the displacement along a direction (3, k)."""
        return sum(sparse.diags_array(direction[i]) @ self.rows[i] for i in range(3))


@dataclass(frozen=True, eq=False)
class MeshedBody:
    """A grid: breaks in r [m], theta [rad] (equal steps) and z [m]; closed where theta goes round."""

    r: Any
    theta: Any
    z: Any
    closed: bool = False

    @property
    def breaks(self) -> tuple[Any, Any, Any]:
        """Breaks in r, theta and z."""
        return self.r, self.theta, self.z

    @cached_property
    def _flat(self) -> Any:
        return skfem().MeshHex.init_tensor(self.r, self.theta, self.z)

    @cached_property
    def _element(self) -> Any:
        return skfem().ElementHexS2()

    @cached_property
    def centres(self) -> Any:
        """(3, elements): r, theta and z of the middle of every element."""
        return self._flat.p[:, self._flat.t].mean(axis=1)

    @cached_property
    def cells(self) -> Any:
        """(3, elements): the number of each element along r, theta and z."""
        pairs = zip(self.breaks, self.centres, strict=True)
        return np.stack([np.searchsorted(breaks, middle) - 1 for breaks, middle in pairs])

    @cached_property
    def _lookup(self) -> Any:
        """(r, theta, z) cells to element numbers."""
        found = np.zeros(tuple(len(breaks) - 1 for breaks in self.breaks), dtype=int)
        found[tuple(self.cells)] = np.arange(self.cells.shape[1])
        return found

    @cached_property
    def _senses(self) -> Any:
        """(3, 2): the local coordinate that runs along r, theta and z, and -1 where it runs the other way."""
        corners = np.concatenate([np.zeros((3, 1)), np.eye(3)], axis=1)
        places = np.asarray(self._flat.mapping().F(corners, tind=np.array([0]))).reshape(3, 4)
        steps = places[:, 1:] - places[:, :1]
        local = np.argmax(np.abs(steps), axis=1)
        return np.stack([local, np.sign(steps[np.arange(3), local])], axis=1).astype(int)

    def _shapes(self, share: np.ndarray) -> tuple[Any, Any]:
        """Shape functions (20, k) at shares (3, k) of an element's sides, and their slopes (20, 3, k) by the shares."""
        local = np.empty_like(share)
        for axis, (where, sense) in enumerate(self._senses):
            local[where] = share[axis] if sense > 0 else 1.0 - share[axis]
        pairs = [self._element.lbasis(local, a) for a in range(20)]
        slopes = np.stack([np.asarray(slope) for _, slope in pairs])[:, self._senses[:, 0]]
        return np.stack([np.asarray(value) for value, _ in pairs]), slopes * self._senses[:, 1][None, :, None]

    @cached_property
    def _dofs(self) -> Any:
        fem = skfem()
        return fem.assembly.Dofs(self._flat, fem.ElementVector(self._element))

    @property
    def _raw(self) -> Any:
        """(60, elements): numbers of the freedoms of the open grid; row 3 a + i is shape a along i."""
        return self._dofs.element_dofs

    @property
    def corners(self) -> tuple[Any, Any]:
        """Freedoms of each corner of the open grid (3, corners), and the corners of each element (elements, 8)."""
        return self._dofs.nodal_dofs, self._flat.t.T

    @property
    def grid_points(self) -> Any:
        """(3, corners): r, theta and z of each corner of the open grid."""
        return self._flat.p

    @property
    def corner_places(self) -> Any:
        """(3, corners): x, y and z [m] of each corner of the open grid."""
        r, theta, z = self.grid_points
        return np.stack([r * np.cos(theta), r * np.sin(theta), z])

    @property
    def reference_corners(self) -> Any:
        """(3, 8): local coordinates of an element's corners, in the order in which it lists them."""
        return self._element.refdom.p

    @cached_property
    def _raw_places(self) -> Any:
        """(4, raw): r, theta, z and the direction 0, 1 or 2 of each freedom of the open grid."""
        found = np.zeros((4, int(self._raw.max()) + 1))
        for a, local in enumerate(np.stack([np.asarray(place) for place in self._element.doflocs[:20]])):
            for axis, (where, sense) in enumerate(self._senses):
                low = self.breaks[axis][self.cells[axis]]
                size = self.breaks[axis][self.cells[axis] + 1] - low
                share = local[where] if sense > 0 else 1.0 - local[where]
                for i in range(3):
                    found[axis, self._raw[3 * a + i]] = low + share * size
            for i in range(3):
                found[3, self._raw[3 * a + i]] = i
        return found

    @cached_property
    def freedoms(self) -> Any:
        """(raw,): the number of the freedom that each freedom of the open grid becomes when the ring is closed."""
        r, theta, z, kind = self._raw_places
        target = np.arange(len(r))
        if not self.closed:
            return target
        step = 1e-3 * (self.theta[1] - self.theta[0])
        first, last = (np.flatnonzero(np.abs(theta - end) < step) for end in (self.theta[0], self.theta[-1]))
        fine = 1e-9 * float(self.r[-1])
        order = [side[np.lexsort((kind[side], np.rint(z[side] / fine), np.rint(r[side] / fine)))]
                 for side in (first, last)]  # fmt: skip
        target[order[1]] = order[0]
        return np.unique(target, return_inverse=True)[1]

    @cached_property
    def size(self) -> int:
        """Number of freedoms."""
        return int(self.freedoms.max()) + 1

    @cached_property
    def places(self) -> Any:
        """(3, n): where each freedom is [m]."""
        r, theta, z, _ = self._raw_places
        found = np.zeros((3, self.size))
        found[:, self.freedoms] = r * np.cos(theta), r * np.sin(theta), z
        return found

    def stiffness(self, poisson: float, inside: np.ndarray | None = None) -> Any:
        """K [N/m] for a Young's modulus of 1 N/m^2, of the elements marked `inside` or all.

        With H_aibj = int dphi_a/dx_i dphi_b/dx_j, K_aibj = lam H_aibj + mu (H_ajbi + delta_ij sum_k H_akbk).
        """
        first, second = poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson)), 0.5 / (1.0 + poisson)
        _, slopes, weight = self._column
        slopes = slopes * np.sqrt(weight)[:, None, None]
        count, shapes, _, points = slopes.shape
        flat = slopes.reshape(count, 3 * shapes, points)
        product = np.matmul(flat, np.swapaxes(flat, 1, 2)).reshape(count, shapes, 3, shapes, 3)
        element = first * product + second * np.swapaxes(product, 2, 4)
        alike = second * np.einsum("eakbk->eab", product)
        for axis in range(3):
            element[:, :, axis, :, axis] += alike
        return self._assembled(element.reshape(count, 3 * shapes, 3 * shapes), inside)

    def mass(self, inside: np.ndarray | None = None) -> Any:
        """M [kg] for a density of 1 kg/m^3, of the elements marked `inside` or all."""
        values, _, weight = self._column
        product = np.einsum("aq,bq,eq->eab", values, values, weight, optimize=True)
        element = np.einsum("eab,ij->eaibj", product, np.eye(3))
        found = self._assembled(element.reshape(len(product), 60, 60), inside, turned=False)
        found.eliminate_zeros()
        return found

    @cached_property
    def _column(self) -> tuple[Any, Any, Any]:
        """Of the elements (r, z) about the angle 0: shape functions (20, q), slopes (e, 20, 3, q), weights (e, q)."""
        fem = skfem()
        share, weight = fem.quadrature.get_quadrature(self._element.refdom, QUADRATURE)
        values, slopes = self._shapes(share)
        half = 0.5 * (self.theta[1] - self.theta[0])
        g, turn = _arc(half, 2.0 * share[1] - 1.0)
        wide, high = (part.ravel() for part in np.meshgrid(np.diff(self.r), np.diff(self.z), indexing="ij"))
        inner = np.repeat(self.r[:-1], len(self.z) - 1)
        r = inner[:, None] + wide[:, None] * share[0]
        cross = g[0] * turn[1] - g[1] * turn[0]
        by_r, by_arc = slopes[:, 0] / wide[:, None, None], slopes[:, 1] / (2.0 * r)[:, None]
        found = np.stack(
            [
                (by_r * turn[1] - by_arc * g[1]) / cross,
                (by_arc * g[0] - by_r * turn[0]) / cross,
                slopes[:, 2] / high[:, None, None],
            ],
            axis=2,
        )
        return values, found, weight * 2.0 * r * cross * (wide * high)[:, None]

    def _assembled(self, element: np.ndarray, inside: np.ndarray | None, *, turned: bool = True) -> Any:
        """Matrices (r z, 60, 60) of the elements about the angle 0, turned to where each is and summed up."""
        marked = np.arange(self.cells.shape[1]) if inside is None else np.flatnonzero(inside)
        i, j, k = self.cells[:, marked]
        data = element[i * (len(self.z) - 1) + k]
        if turned:
            middle = 0.5 * (self.theta[j] + self.theta[j + 1])
            whole = np.zeros((len(self.theta) - 1, 60, 60))
            for one, angle in zip(j, middle, strict=True):
                if whole[one, 0, 0] == 0.0:
                    whole[one] = np.kron(np.eye(20), _turn(angle))
            data = np.matmul(np.matmul(whole[j], data), np.swapaxes(whole, 1, 2)[j])
        numbers = self.freedoms[self._raw[:, marked]].T.astype(np.int32)
        rows, columns = np.repeat(numbers, 60, axis=1), np.tile(numbers, (1, 60))
        matrix = sparse.coo_array((data.ravel(), (rows.ravel(), columns.ravel())), shape=(self.size,) * 2)
        found = matrix.tocsr()
        return sparse.csr_array(0.5 * (found + found.T))  # round-off of the sums alone parts them

    def face(self, axis: int, end: int, where: Callable[[Any, Any, Any], Any] | None = None) -> FacePoints:
        """Quadrature points of the face at the first (0) or last (-1) break along r, theta or z (axis 0, 1, 2).

        where takes r, theta and z of the middles of elements and says which belong to it.
        """
        fem = skfem()
        elements = np.take(self._lookup, end, axis=axis).ravel()
        if where is not None:
            elements = elements[where(*self.centres[:, elements])]
        plane, weight = fem.quadrature.get_quadrature(fem.ElementQuad1().refdom, QUADRATURE)
        share = np.insert(plane, axis, 0.0 if end == 0 else 1.0, axis=0)
        low = np.stack([breaks[cell] for breaks, cell in zip(self.breaks, self.cells[:, elements], strict=True)])
        size = np.stack([b[cell + 1] for b, cell in zip(self.breaks, self.cells[:, elements], strict=True)]) - low
        g, turn = _arc(0.5 * (self.theta[1] - self.theta[0]), 2.0 * share[1] - 1.0)
        r = low[0][:, None] + size[0][:, None] * share[0]
        z = low[2][:, None] + size[2][:, None] * share[2]
        sides = np.zeros((3, 3, *r.shape))  # of the place by the shares
        sides[0, :2] = size[0][:, None] * g[:, None]
        sides[1, :2] = 2.0 * r * turn[:, None]
        sides[2, 2] = size[2][:, None]
        first, second = (sides[i] for i in range(3) if i != axis)
        area = weight * np.linalg.norm(np.cross(first, second, axis=0), axis=0)
        middle = low[1] + 0.5 * size[1]
        place = np.stack([*np.einsum("ije,jq->ieq", _turn(middle)[:2, :2], g) * r, z])
        values = np.tile(self._shapes(share)[0], (1, len(elements)))
        return FacePoints(
            place.reshape(3, -1), area.ravel(), self._rows(values, np.repeat(elements, len(weight)))
        )  # fmt: skip

    def points(self, place: np.ndarray) -> tuple[Any, Any, Any]:
        """U_x, U_y, U_z (k, n) at places (3, k) [m] in the body or on its faces."""
        r, theta = np.hypot(place[0], place[1]), np.arctan2(place[1], place[0])
        theta = (theta - self.theta[0]) % (2.0 * np.pi) + self.theta[0]
        cell = [
            np.clip(np.searchsorted(breaks, value, side="right") - 1, 0, len(breaks) - 2)
            for breaks, value in zip(self.breaks, (r, theta, place[2]), strict=True)
        ]
        low, high = (np.stack([b[c + i] for b, c in zip(self.breaks, cell, strict=True)]) for i in (0, 1))
        half = 0.5 * (self.theta[1] - self.theta[0])
        tangent = np.tan(theta - 0.5 * (low[1] + high[1]))
        s = 2.0 * tangent / (np.sin(half) + np.sqrt(np.sin(half) ** 2 + 4.0 * tangent**2 * (1.0 - np.cos(half))))
        true = np.stack([r / np.linalg.norm(_arc(half, s)[0], axis=0), theta, place[2]])
        share = (true - low) / (high - low)
        share[1] = 0.5 * (s + 1.0)
        return self._rows(self._shapes(share)[0], self._lookup[tuple(cell)])

    def _rows(self, values: np.ndarray, elements: np.ndarray) -> tuple[Any, Any, Any]:
        """Rows of the three displacements from shape functions (20, k) in the elements (k,)."""
        shapes, count = values.shape
        where = np.tile(np.arange(count), shapes)
        rows = []
        for axis in range(3):
            which = self.freedoms[self._raw[axis::3][:, elements]].ravel()
            table = sparse.csr_array((values.ravel(), (where, which)), shape=(count, self.size))
            table.eliminate_zeros()
            rows.append(table)
        return rows[0], rows[1], rows[2]


def _arc(half: float, s: np.ndarray) -> tuple[Any, Any]:
    """g (2, k) of the module's head at s, for the half angle of an element, and its slope by s."""
    flat = 1.0 - np.cos(half)
    return (
        np.stack([1.0 - flat * s**2, np.sin(half) * s]),
        np.stack([-2.0 * flat * s, np.full_like(s, np.sin(half))]),
    )


def _turn(angle: float | np.ndarray) -> Any:
    """R(angle): a turn about z, (3, 3, ...)."""
    cosine, sine, one = np.cos(angle), np.sin(angle), np.ones_like(angle)
    return np.array([[cosine, -sine, 0.0 * one], [sine, cosine, 0.0 * one], [0.0 * one, 0.0 * one, one]])


def breaks(start: float, end: float, size: float, least: int = 1) -> Any:
    """Equal steps from start to end, none longer than `size`."""
    return np.linspace(start, end, max(least, int(np.ceil((end - start) / size - 1e-9))) + 1)
