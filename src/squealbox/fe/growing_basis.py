"""A basis that grows, and the matrices of several linearisations of one brake on it.

Between two values of friction a brake's matrices differ by its contacts alone,

    K_eff = K - D' diag(mu sgn V) N - R' diag(open) N,      C_eff = C + D' diag(N mu') T + A' diag(mu N / |V|) A,

so M, C and K meet the basis once, each new column once, and the contacts as a few dense rows. What is left of size n
per linearisation are the residuals of the modes looked at, and one solve for each of them.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from scipy import sparse

from squealbox.factorisation import is_symmetric
from squealbox.fe.basis import fresh_directions
from squealbox.fe.pencil import Pencil
from squealbox.fe.small import Small

if TYPE_CHECKING:
    from scipy.sparse import sparray

ROWS = ("n", "d", "t", "normal", "across")


class _Product:
    """A V, A' V and V' A V of one sparse matrix A, for a basis V that grows by blocks of columns.

    The products are kept in single precision: residuals are made of them, which round-off of 1e-7 of a product leaves
    as they are. `whole` holds A V in double precision for the matrix that the basis is orthogonal by.
    """

    def __init__(self, matrix: "sparray") -> None:
        self.matrix, self.symmetric = matrix, is_symmetric(matrix)
        self.right: list[Any] = []
        self.left: list[Any] = self.right if self.symmetric else []
        self.whole: list[Any] | None = None
        self.gram = np.zeros((0, 0))

    def extend(self, basis: Sequence[Any], fresh: np.ndarray) -> None:
        new = self.matrix @ fresh
        above = np.concatenate([np.zeros((0, fresh.shape[1])), *(block.T @ new for block in basis)])
        below = above.T
        if not self.symmetric:
            back = self.matrix.T @ fresh
            below = np.concatenate([np.zeros((fresh.shape[1], 0)), *(back.T @ block for block in basis)], axis=1)
            self.left.append(back.astype(np.float32))
        self.gram = np.block([[self.gram, above], [below, fresh.T @ new]])
        self.right.append(new.astype(np.float32))
        if self.whole is not None:
            self.whole.append(new)


class _SparseRows:
    """A V of one sparse table A (contacts, n)."""

    def __init__(self, matrix: "sparray") -> None:
        self.matrix, self.dense = matrix, np.zeros((matrix.shape[0], 0))


class GrowingBasis:
    """Columns V (n, m), V' M V = I for the M of the first pencil, in `blocks`, and all `pencils` on them."""

    def __init__(self, pencils: Sequence[Pencil], basis: np.ndarray) -> None:
        self.pencils = list(pencils)
        self._products: list[_Product] = []
        self._tables: list[_SparseRows] = []
        self._of = [[self._known(self._products, _Product, part) for part in p.structural] for p in self.pencils]
        self._of[0][0].whole = []
        self._rows = [self._rows_of(pencil) for pencil in self.pencils]
        self.blocks: list[Any] = []
        self._undamped = np.zeros((0, 0))
        self._extend(basis)

    @property
    def size(self) -> int:
        """Number of columns."""
        return sum(int(block.shape[1]) for block in self.blocks)

    def add(self, vectors: np.ndarray) -> None:
        """Take in what is new of the columns of `vectors` (n, k)."""
        self._extend(fresh_directions(self.pencils[0].M, self.blocks, self._of[0][0].whole, vectors))

    def turn(self) -> None:
        """V becomes undamped modes on itself; the products of size n are given up, so it grows no more."""
        turns = self.undamped
        for product in self._products:
            product.gram = turns.T @ product.gram @ turns
            product.right = product.left = product.whole = []
        for table in self._tables:
            table.dense = table.dense @ turns
        self.blocks = [times(self.blocks, turns)]
        self._undamped = np.eye(self.size)

    def structural(self, i: int) -> dict[str, Any]:
        """M, C, K of the structure (m, m) and the contacts' rows (contacts, m) of one pencil."""
        grams = {name: product.gram for name, product in zip("MCK", self._of[i], strict=True)}
        return {**grams, **{name: self._rows[i][name].dense if name in self._rows[i] else None for name in ROWS}}

    def elastic(self, i: int) -> Any:
        """K0 of one pencil on the basis, (m, m): symmetric, without friction and without open contacts."""
        found, sliding = self._of[i][2].gram, self.pencils[i].sliding
        if sliding is not None and np.any(sliding.lifted):
            lifted, rows = np.flatnonzero(sliding.lifted), self._rows[i]
            found = found - rows["normal"].dense[lifted].T @ rows["n"].dense[lifted]
        return 0.5 * (found + found.T)

    @property
    def undamped(self) -> Any:
        """Turns (m, m) to the undamped modes of the first pencil on the basis, rising in frequency."""
        if len(self._undamped) != self.size:
            self._undamped = np.linalg.eigh(self.elastic(0))[1]
        return self._undamped

    def small(self, i: int) -> Small:
        """M, C_eff and K_eff of one pencil on the basis."""
        mass, damping, stiffness = (product.gram for product in self._of[i])
        sliding, rows = self.pencils[i].sliding, {name: table.dense for name, table in self._rows[i].items()}
        if sliding is None:
            return Small(mass, damping, stiffness)
        stiffness = stiffness - rows["d"].T @ (sliding.coupling[:, None] * rows["n"])
        lifted = np.flatnonzero(sliding.lifted)
        if len(lifted):
            stiffness = stiffness - rows["normal"][lifted].T @ rows["n"][lifted]
        damping = damping + rows["d"].T @ (sliding.along[:, None] * rows["t"])
        if "across" in rows:
            damping = damping + rows["across"].T @ (sliding.across[:, None] * rows["across"])
        return Small(mass, damping, stiffness)

    def residual(self, i: int, values: np.ndarray, x: np.ndarray) -> Any:
        """Q(lambda_k) V x_k, its real parts and then its imaginary ones (n, 2k)."""
        found = self._summed([product.right for product in self._of[i]], values, x)
        sliding, rows = self.pencils[i].sliding, self._rows[i]
        if sliding is None:
            return found
        still, moving = parts(x), parts(x * values)
        felt = rows["n"].dense @ still
        weight = -sliding.coupling[:, None] * felt
        if np.any(sliding.along):
            weight = weight + sliding.along[:, None] * (rows["t"].dense @ moving)
        found += rows["d"].matrix.T @ weight
        if "normal" in rows and np.any(sliding.lifted):
            found -= rows["normal"].matrix.T @ (sliding.lifted[:, None] * felt)
        if "across" in rows:
            found += rows["across"].matrix.T @ (sliding.across[:, None] * (rows["across"].dense @ moving))
        return found

    def left_residual(self, i: int, values: np.ndarray, y: np.ndarray) -> Any:
        """Q(lambda_k)^H V y_k, its real parts and then its imaginary ones (n, 2k)."""
        back = np.conj(values)
        found = self._summed([product.left for product in self._of[i]], back, y)
        sliding, rows = self.pencils[i].sliding, self._rows[i]
        if sliding is None:
            return found
        still, moving = parts(y), parts(y * back)
        weight = sliding.coupling[:, None] * (rows["d"].dense @ still)
        if "normal" in rows and np.any(sliding.lifted):
            weight = weight + sliding.lifted[:, None] * (rows["normal"].dense @ still)
        found -= rows["n"].matrix.T @ weight
        if np.any(sliding.along):
            found += rows["t"].matrix.T @ (sliding.along[:, None] * (rows["d"].dense @ moving))
        if "across" in rows:
            found += rows["across"].matrix.T @ (sliding.across[:, None] * (rows["across"].dense @ moving))
        return found

    def _summed(self, products: list[list[Any]], values: np.ndarray, x: np.ndarray) -> Any:
        """(lambda^2 M + lambda C + K) V x from the products with M, C and K."""
        found = np.zeros((self.pencils[0].size, 2 * x.shape[1]))
        for blocks, factor in zip(products, (values**2, values, np.ones_like(values)), strict=True):
            times(blocks, parts(x * factor).astype(np.float32), found)
        return found

    def _extend(self, fresh: np.ndarray) -> None:
        fresh = np.ascontiguousarray(fresh)
        for product in self._products:
            product.extend(self.blocks, fresh)
        for table in self._tables:
            table.dense = np.concatenate([table.dense, np.asarray(table.matrix @ fresh)], axis=1)
        self.blocks.append(fresh)

    def _rows_of(self, pencil: Pencil) -> dict[str, _SparseRows]:
        contacts = None if pencil.sliding is None else pencil.sliding.system.contacts
        tables = {name: getattr(contacts, name, None) for name in ROWS}
        return {n: self._known(self._tables, _SparseRows, table) for n, table in tables.items() if table is not None}

    def _known(self, among: list[Any], kind: type, matrix: "sparray") -> Any:
        for one in among:
            if equal(one.matrix, matrix):
                return one
        among.append(kind(matrix))
        return among[-1]


def parts(x: np.ndarray) -> Any:
    """Real parts of complex columns (m, k), and then their imaginary ones: (m, 2k)."""
    return np.concatenate([x.real, x.imag], axis=1)


def times(blocks: Sequence[Any], x: np.ndarray, onto: np.ndarray | None = None) -> Any:
    """V x for V in blocks of columns and x (m, k), all real, added to `onto` where it is given."""
    found = np.zeros((blocks[0].shape[0], x.shape[1])) if onto is None else onto
    start = 0
    for block in blocks:
        found += block @ x[start : start + block.shape[1]]
        start += block.shape[1]
    return found


def equal(one: "sparray", other: "sparray") -> bool:
    """True for two sparse arrays with the same entries in the same places."""
    if one is other:
        return True
    one, other = sparse.csr_array(one), sparse.csr_array(other)
    return bool(
        one.shape == other.shape
        and one.nnz == other.nnz
        and np.array_equal(one.indptr, other.indptr)
        and np.array_equal(one.indices, other.indices)
        and np.array_equal(one.data, other.data)
    )
