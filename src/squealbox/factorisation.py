"""One sparse factorisation behind one small interface: solve, many right-hand sides, inertia, determinant.

`factor` is SciPy's SuperLU, which is always there, or rslab (extra `fe`), which is quicker on large matrices and
factors symmetric ones as L D L'. It knows no physics. The inertia of a symmetric matrix is the number of positive,
negative and zero eigenvalues; that of K - w^2 M counts the modes below w (Sturm).
"""

import importlib.util
from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, Literal

import numpy as np
import scipy
from numpy.typing import ArrayLike

if TYPE_CHECKING:
    from scipy.sparse import sparray

Library = Literal["auto", "superlu", "rslab"]
LIBRARIES = ("auto", "superlu", "rslab")
SYMMETRIC = 1e-12  # |A - A'| below this share of |A| is round-off
TRUSTED = 1e-6  # relative residual of a solve above which the factors are of no use
LARGE = 2000  # rows from which the quicker library pays for its import
DISSECTED = 50_000  # rows from which nested dissection is taken untried: it wins there, and trying others takes time
GOOD = 0.02  # relative error up to which factors in single precision are of use


class SingularMatrix(np.linalg.LinAlgError):
    """A sparse matrix has no inverse to working precision, or its factors cannot be trusted."""


@dataclass(frozen=True, eq=False)
class Order:
    """In what order rslab eliminates: what it found out about the places of a matrix's entries, and these."""

    symbolic: Any
    pattern: Any
    symmetric: bool


class Factor:
    """The factors of one square sparse matrix A, as :func:`factor` returns them.

    size is its number of rows, symmetric whether A = A', library which code made the factors. order serves other
    matrices with entries in the same places; None where the library has none to hand on.
    """

    library = ""
    order: Order | None = None

    def __init__(self, matrix: "sparray", symmetric: bool) -> None:
        self._matrix, self.symmetric, self.size = matrix, symmetric, int(matrix.shape[0])
        self._lu: Any = None

    def solve(self, right: ArrayLike, *, transposed: bool = False) -> Any:
        """A^-1 b, or A^-T b, for b (n,) or (n, k), real or complex."""
        right = np.asarray(right)
        if right.shape[:1] != (self.size,):
            raise ValueError(f"right-hand side has shape {right.shape}: expected ({self.size},) or ({self.size}, k)")
        if np.iscomplexobj(right) and not np.iscomplexobj(self._matrix.data):
            return self.solve(right.real, transposed=transposed) + 1j * self.solve(right.imag, transposed=transposed)
        kind = np.result_type(self._matrix.dtype, right.dtype, float)
        right = np.ascontiguousarray(right, dtype=self._matrix.dtype)
        return self._solved(right, transposed and not self.symmetric).astype(kind, copy=False)

    def solve_many(self, right: ArrayLike, *, transposed: bool = False, block: int = 64) -> Any:
        """A^-1 B for B (n, k), in blocks of columns, so that no more than a block is copied at a time."""
        right = np.asarray(right)
        kind = np.result_type(self._matrix.dtype, right.dtype, float)
        found = np.empty(right.shape, dtype=kind)
        for start in range(0, right.shape[1], block):
            part = slice(start, start + block)
            found[:, part] = self.solve(right[:, part], transposed=transposed)
        return found

    def in_single(self) -> "Factor":
        """Factors in single precision, with solves at half the price that are good to a percent or two.

        For directions, estimates and as a preconditioner. This factor itself where the library has none so good.
        """
        return self

    @property
    def inertia(self) -> tuple[int, int, int]:
        """Numbers of positive, negative and zero eigenvalues of a real symmetric A."""
        if not self.symmetric or np.iscomplexobj(self._matrix.data):
            raise ValueError("inertia: the matrix is not real symmetric; expected factor(A, symmetric=True)")
        return self._signs()

    @property
    def log_determinant(self) -> complex:
        """ln det A, whose imaginary part is the phase of det A in (-pi, pi]."""
        lu = self._superlu()
        pivots = np.asarray(lu.U.diagonal(), dtype=complex)
        turns = np.angle(pivots).sum() + np.pi * ((_parity(lu.perm_r) + _parity(lu.perm_c)) % 2)
        return complex(np.log(np.abs(pivots)).sum(), np.angle(np.exp(1j * turns)))

    def _superlu(self) -> Any:
        """SuperLU's factors; a library that keeps its pivots to itself has none of its own."""
        if self._lu is None:
            self._lu = _superlu(self._matrix, self.symmetric)
        return self._lu

    def _solved(self, right: np.ndarray, transposed: bool) -> Any:
        return self._superlu().solve(right, trans="T" if transposed else "N")

    def _signs(self) -> tuple[int, int, int]:
        lu = self._superlu()
        if not np.array_equal(lu.perm_r, lu.perm_c):  # rows were exchanged: the pivots are not those of L D L'
            lu = _decomposed(self._matrix, 0.0)
            _check(lu.solve, self._matrix)
        if not np.array_equal(lu.perm_r, lu.perm_c):
            raise SingularMatrix("inertia: a pivot on the diagonal is zero; shift the matrix, or install rslab")
        pivots = lu.U.diagonal()
        return int(np.sum(pivots > 0.0)), int(np.sum(pivots < 0.0)), int(np.sum(pivots == 0.0))


class SuperLU(Factor):
    """Factors of SciPy's SuperLU."""

    library = "superlu"

    def __init__(self, matrix: "sparray", symmetric: bool) -> None:
        super().__init__(matrix, symmetric)
        self._superlu()


class Rslab(Factor):
    """Factors of rslab: L D L' of a symmetric matrix, real or complex, L U of any other."""

    library = "rslab"

    def __init__(self, matrix: "sparray", symmetric: bool, threads: int, order: Order | None) -> None:
        import rslab

        known = order if order is not None and order.symmetric == symmetric else None
        placed = None if known is None else _placed(matrix, known.pattern)
        super().__init__(matrix if placed is None else placed, symmetric)
        if known is None or placed is None:
            how = {"path": "ldlt" if symmetric else "lu", "ordering": "metis" if self.size >= DISSECTED else "auto"}
            known = Order(rslab.analyze(matrix, threads=threads, **how), matrix, symmetric)
        self.order, self._threads = known, threads
        try:
            self._factors: Any = known.symbolic.factor(self._matrix, threads=threads)
        except RuntimeError as error:
            raise SingularMatrix(f"the matrix of {self.size} rows is singular: {error}") from error
        _check(self._factors.solve, matrix)

    def in_single(self) -> Factor:
        kind = np.complex64 if np.iscomplexobj(self._matrix.data) else np.float32
        try:
            light = Rslab(self._matrix.astype(kind), self.symmetric, self._threads, self.order)
        except SingularMatrix:
            return self
        right = np.random.default_rng(2).standard_normal(self.size)
        known = self.solve(right)
        return light if np.linalg.norm(light.solve(right) - known) <= GOOD * np.linalg.norm(known) else self

    def _solved(self, right: np.ndarray, transposed: bool) -> Any:
        if transposed:
            columns = [self._factors.solve_transpose(column) for column in np.atleast_2d(right.T)]
            return columns[0] if right.ndim == 1 else np.stack(columns, axis=1)
        return self._factors.solve(right) if right.ndim == 1 else self._factors.solve_many(right)

    def _signs(self) -> tuple[int, int, int]:
        positive, negative, zero = self._factors.inertia
        return int(positive), int(negative), int(zero)


def factor(
    A: Any,
    symmetric: bool | None = None,
    *,
    library: Library = "auto",
    threads: int = 1,
    order: Order | None = None,
) -> Factor:
    """The factors of a square matrix A, sparse or dense, real or complex.

    Parameters
    ----------
    A : shape (n, n)
    symmetric : whether A = A' (of a complex A too: not Hermitian); left out, it is looked at
    library : "superlu", "rslab" (extra `fe`), or "auto": rslab where it is installed and the matrix is large
    threads : of rslab; the factors do not depend on it
    order : of another factor: saves half the time where all entries of A are in places where that one had its own

    Raises `SingularMatrix` where A has no inverse to working precision.

    >>> two = factor([[2.0, 1.0], [1.0, -3.0]])
    >>> two.solve([3.0, -2.0]).tolist(), two.inertia
    ([1.0, 1.0], (1, 1, 0))
    """
    if library not in LIBRARIES:
        raise ValueError(f"library = {library!r}: expected one of {', '.join(LIBRARIES)}")
    mirrored = symmetric and getattr(A, "format", "") == "csr" and A.has_canonical_format  # its rows are its columns
    matrix = (
        scipy.sparse.csc_array((A.data, A.indices, A.indptr), shape=A.shape) if mirrored else scipy.sparse.csc_array(A)
    )
    matrix.sort_indices()
    matrix.sum_duplicates()
    if matrix.ndim != 2 or matrix.shape[0] != matrix.shape[1]:
        raise ValueError(f"A has shape {matrix.shape}: expected a square matrix")
    matrix = matrix.astype(complex if np.iscomplexobj(matrix.data) else float)
    matrix.indices, matrix.indptr = matrix.indices.astype(np.int32), matrix.indptr.astype(np.int32)
    if not np.all(np.isfinite(matrix.data)):
        raise ValueError("A holds a value that is not finite")
    if symmetric is None:
        symmetric = is_symmetric(matrix)
    installed = importlib.util.find_spec("rslab") is not None
    if library == "rslab" and not installed:
        raise ValueError("library = 'rslab' is not installed: it comes with the extra fe, pip install 'squealbox[fe]'")
    if library == "rslab" or (library == "auto" and installed and matrix.shape[0] >= LARGE):
        return Rslab(matrix, symmetric, threads, order)
    return SuperLU(matrix, symmetric)


def _placed(matrix: "sparray", pattern: "sparray") -> Any:
    """The matrix with zeros of its own wherever `pattern` has entries; None where it has entries elsewhere."""
    if all(np.array_equal(getattr(matrix, part), getattr(pattern, part)) for part in ("indptr", "indices")):
        return matrix
    if matrix.shape != pattern.shape or matrix.nnz > pattern.nnz:
        return None
    keys = [
        np.repeat(np.arange(one.shape[1], dtype=np.int64) * one.shape[0], np.diff(one.indptr)) + one.indices
        for one in (matrix, pattern)
    ]
    where = np.searchsorted(keys[1], keys[0])
    if np.max(where, initial=-1) >= pattern.nnz or not np.array_equal(keys[1][where], keys[0]):
        return None
    data = np.zeros(pattern.nnz, dtype=matrix.dtype)
    data[where] = matrix.data
    return scipy.sparse.csc_array((data, pattern.indices, pattern.indptr), shape=pattern.shape)


def is_symmetric(matrix: "sparray") -> bool:
    """True where A = A' to round-off."""
    matrix = scipy.sparse.csc_array(matrix)
    if matrix.shape[0] != matrix.shape[1]:
        return False
    mirrored, largest = scipy.sparse.csc_array(matrix.T), np.max(np.abs(matrix.data), initial=0.0)
    if matrix.has_canonical_format and all(
        np.array_equal(getattr(matrix, part), getattr(mirrored, part)) for part in ("indptr", "indices")
    ):
        differences = matrix.data - mirrored.data
    else:
        differences = (matrix - mirrored).data
    return bool(np.max(np.abs(differences), initial=0.0) <= SYMMETRIC * largest)


def _decomposed(matrix: "sparray", threshold: float) -> Any:
    options = {"SymmetricMode": True}
    return scipy.sparse.linalg.splu(matrix, permc_spec="MMD_AT_PLUS_A", diag_pivot_thresh=threshold, options=options)


def _superlu(matrix: "sparray", symmetric: bool) -> Any:
    """SuperLU in its mode for matrices with (nearly) symmetric pattern, which keeps to the diagonal where it can."""
    threshold = 1e-3 if symmetric else 1e-2
    try:
        lu = _decomposed(matrix, threshold)
    except RuntimeError as error:
        raise SingularMatrix(f"the matrix of {matrix.shape[0]} rows is singular: {error}") from error
    _check(lu.solve, matrix)
    return lu


def _check(solve: Callable[[Any], Any], matrix: "sparray") -> None:
    """Solve once for a known vector: factors of a matrix that is singular to round-off give a large residual."""
    known = np.random.default_rng(1).standard_normal(matrix.shape[0]).astype(matrix.dtype)
    right = matrix @ known
    found = solve(right)
    residual = np.linalg.norm(matrix @ found - right)
    columns = np.add.reduceat(np.abs(matrix.data), np.minimum(matrix.indptr[:-1], max(matrix.nnz - 1, 0)))
    scale = float(np.max(columns, initial=0.0)) * np.linalg.norm(found) + np.linalg.norm(right)
    if not residual <= TRUSTED * scale or not np.linalg.norm(found) <= 1e12 * np.linalg.norm(known):
        raise SingularMatrix(f"the matrix of {matrix.shape[0]} rows is singular to working precision")


def _parity(permutation: np.ndarray) -> int:
    """0 for an even permutation, 1 for an odd one: rows less cycles."""
    size = len(permutation)
    graph = scipy.sparse.csr_array((np.ones(size), (np.arange(size), permutation)), shape=(size, size))
    cycles = scipy.sparse.csgraph.connected_components(graph, directed=False, return_labels=False)
    return int(size - cycles) % 2
