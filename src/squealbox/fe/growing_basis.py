"""A basis that grows, and the matrices of several linearisations of one brake on it.

Between two values of friction a brake's matrices differ by its contacts alone,

    K_eff = K - D' diag(mu sgn V) N - R' diag(open) N,      C_eff = C + D' diag(N mu') T + A' diag(mu N / |V|) A,

so M, C and K meet the basis once, each new column once, and the contacts as a few dense rows. What is left of size n
per linearisation are the residuals of the modes looked at, and one solve for each of them.
"""

from collections.abc import Sequence
from typing import Any

import numpy as np
from scipy import sparse

from squealbox.factorisation import is_symmetric
from squealbox.fe.basis import fresh_directions
from squealbox.fe.pencil import Pencil
from squealbox.fe.small import Small

ROWS = ("n", "d", "t", "normal", "across")


class _Product:
    """A V, A' V and V' A V of one sparse matrix A, for a basis V that grows."""

    def __init__(self, matrix: Any) -> None:
        self.matrix, self.symmetric = matrix, is_symmetric(matrix)
        size = matrix.shape[0]
        self.right, self.gram = np.zeros((size, 0)), np.zeros((0, 0))
        self.left = self.right

    def extend(self, basis: Any, fresh: Any) -> None:
        new = self.matrix @ fresh
        above = basis.T @ new
        below = above.T if self.symmetric else fresh.T @ self.right
        self.gram = np.block([[self.gram, above], [below, fresh.T @ new]])
        self.right = np.concatenate([self.right, new], axis=1)
        if self.symmetric:
            self.left = self.right
        else:
            self.left = np.concatenate([self.left, self.matrix.T @ fresh], axis=1)


class GrowingBasis:
    """Columns V (n, m), V' M V = I for the M of the first pencil, and all `pencils` on them."""

    def __init__(self, pencils: Sequence[Pencil], basis: Any) -> None:
        self.pencils = list(pencils)
        self._products: list[_Product] = []
        self._of = [[self._known(matrix) for matrix in pencil.structural] for pencil in self.pencils]
        self._rows: list[dict[str, Any]] = [{} for _ in self.pencils]
        self.basis = np.zeros((self.pencils[0].size, 0))
        self._extend(basis)

    @property
    def size(self) -> int:
        """Number of columns."""
        return int(self.basis.shape[1])

    def add(self, vectors: Any) -> None:
        """Take in what is new of the columns of `vectors` (n, k)."""
        mass = self._of[0][0]
        self._extend(fresh_directions(self.pencils[0].M, self.basis, mass.right, vectors))

    def turn(self, turns: Any) -> None:
        """V becomes V T for a square T (m, m); the products of size n are given up, so it grows no more."""
        for product in self._products:
            product.gram = turns.T @ product.gram @ turns
            product.right = product.left = np.zeros((0, 0))
        for rows in self._rows:
            rows.update({name: table @ turns for name, table in rows.items()})
        self.basis = self.basis @ turns

    def without(self, vectors: Any) -> Any:
        """What of `vectors` (n, k) the basis does not hold, orthogonal in M."""
        weighted = self._of[0][0].right
        for _ in range(2):
            vectors = vectors - self.basis @ (weighted.T @ vectors)
        return vectors

    def structural(self, i: int) -> dict[str, Any]:
        """M, C, K of the structure (m, m) and the contacts' rows (contacts, m) of one pencil."""
        grams = {name: product.gram for name, product in zip("MCK", self._of[i], strict=True)}
        return {**grams, **{name: self._rows[i].get(name) for name in ROWS}}

    def small(self, i: int) -> Small:
        """M, C_eff and K_eff of one pencil on the basis."""
        mass, damping, stiffness = (product.gram for product in self._of[i])
        sliding, rows = self.pencils[i].sliding, self._rows[i]
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

    def residual(self, i: int, values: Any, x: Any) -> Any:
        """Q(lambda_k) V x_k (n, k)."""
        mass, damping, stiffness = (product.right for product in self._of[i])
        found = times(mass, x * values**2) + times(damping, x * values) + times(stiffness, x)
        sliding, rows, table = self.pencils[i].sliding, self._rows[i], self._table(i)
        if sliding is None:
            return found
        felt = rows["n"] @ x
        found -= table.d.T @ (sliding.coupling[:, None] * felt)
        if table.normal is not None:
            found -= table.normal.T @ (sliding.lifted[:, None] * felt)
        if np.any(sliding.along):
            found += table.d.T @ (sliding.along[:, None] * (rows["t"] @ (x * values)))
        if "across" in rows:
            found += table.across.T @ (sliding.across[:, None] * (rows["across"] @ (x * values)))
        return found

    def left_residual(self, i: int, values: Any, y: Any) -> Any:
        """Q(lambda_k)^H V y_k (n, k)."""
        mass, damping, stiffness = (product.left for product in self._of[i])
        back = np.conj(values)
        found = times(mass, y * back**2) + times(damping, y * back) + times(stiffness, y)
        sliding, rows, table = self.pencils[i].sliding, self._rows[i], self._table(i)
        if sliding is None:
            return found
        weight = sliding.coupling[:, None] * (rows["d"] @ y)
        if "normal" in rows:
            weight = weight + sliding.lifted[:, None] * (rows["normal"] @ y)
        found -= table.n.T @ weight
        if np.any(sliding.along):
            found += table.t.T @ (sliding.along[:, None] * (rows["d"] @ (y * back)))
        if "across" in rows:
            found += table.across.T @ (sliding.across[:, None] * (rows["across"] @ (y * back)))
        return found

    def _extend(self, fresh: Any) -> None:
        fresh = np.ascontiguousarray(fresh)
        for product in self._products:
            product.extend(self.basis, fresh)
        for i, rows in enumerate(self._rows):
            for name in ROWS if self.pencils[i].sliding is not None else ():
                table = getattr(self._table(i), name)
                if table is not None:
                    new = np.asarray(table @ fresh)
                    rows[name] = np.concatenate([rows[name], new], axis=1) if name in rows else new
        self.basis = np.concatenate([self.basis, fresh], axis=1)

    def _table(self, i: int) -> Any:
        sliding = self.pencils[i].sliding
        return None if sliding is None else sliding.system.contacts

    def _known(self, matrix: Any) -> _Product:
        for product in self._products:
            if equal(product.matrix, matrix):
                return product
        self._products.append(_Product(matrix))
        return self._products[-1]


def times(columns: Any, x: Any) -> Any:
    """V x for a real V and a complex x, without a complex copy of V."""
    if not np.iscomplexobj(x):
        return columns @ x
    return columns @ np.ascontiguousarray(x.real) + 1j * (columns @ np.ascontiguousarray(x.imag))


def equal(one: Any, other: Any) -> bool:
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
