"""Which arithmetic answers a batch: NumPy's eigvals, or the compiled kernels when the batch is worth loading them for.

Both give the same numbers to round-off (a test compares them); `engine` chooses by name, and "auto" by size.
"""

from collections.abc import Callable
from typing import Any, Literal

import numpy as np
from numpy.typing import ArrayLike

from squealbox.compiled import LANES, room
from squealbox.stability import kernels_qr, kernels_spectra, kernels_two_dof
from squealbox.stability.deflation import SLOW
from squealbox.stability.eigenvalues import MARGINAL, modes_of
from squealbox.stability.state_matrix import special_entries, state_matrix, with_special
from squealbox.system import Equilibrium, Linearised

Engine = Literal["auto", "numpy", "compiled"]
WORTH_IT = 5000  # systems in a batch from which loading the compiled kernels (a tenth of a second) pays
LARGEST_COMPILED = 60  # state variables up to which the kernels were measured; 5 times as fast as LAPACK there


def largest_growth(about: Linearised, engine: Engine = "auto") -> tuple[Any, Any, Any]:
    """Largest growth rate [1/s], the angular frequency [rad/s] of its mode and the number of growing modes, (...) each.

    NaN, NaN and 0 where there is no spectrum.
    """
    entries = special_entries(about)
    special = np.any(entries)
    if about.M.shape[-1] == 2 and compiled(about, engine) and not special:
        return _two_dof(about)
    values = eigenvalues_of(about, engine, entries)
    known = np.isfinite(values.real)
    if special:  # rigid-body motion is no vibration
        known &= (values != 0.0) | (np.asarray(about.equilibrium.floating)[..., None] == 0)
    place = np.argmax(np.where(known, values.real, -np.inf), axis=-1)[..., None]
    worst = np.take_along_axis(values, place, axis=-1)[..., 0]
    scale = np.max(np.nan_to_num(np.abs(values)), axis=-1, keepdims=True)
    growing = known & (values.real > MARGINAL * scale)
    growing &= ~_round_off(about, values, growing & (np.abs(values) < SLOW * scale))
    pairs = np.sum(growing & (values.imag > 0.0), axis=-1) + np.sum(growing & (values.imag == 0.0), axis=-1)
    return worst.real, np.abs(worst.imag), pairs


def _round_off(about: Linearised, values: np.ndarray, doubtful: np.ndarray) -> Any:
    """True for slow eigenvalues whose growth is less than their own condition leaves sure, (..., 2n)."""
    idle = np.zeros(values.shape, dtype=bool)
    for at in map(tuple, np.argwhere(np.any(doubtful, axis=-1))):
        state = about.equilibrium
        parts = (np.asarray(x)[at] for x in (state.q, state.normal_force, state.sliding_speed, state.friction))
        q, normal, speed, mu = parts
        alone = Equilibrium(q, normal, speed, mu, np.asarray(state.exists)[at], state.outcome)
        one = Linearised(about.M[at], about.C[at], about.K[at], alone)
        idle[at] = doubtful[at] & (modes_of(one).unstable_modes == 0)
    return idle


def asymptotically_stable(about: Linearised, engine: Engine = "auto") -> Any:
    """True where every growth rate is negative, (...); an undamped or missing system is False."""
    if about.M.shape[-1] == 2 and compiled(about, engine):
        mass, damping, stiffness, shape, usable = _flat(about)
        return flags_of(mass, damping, stiffness).reshape(shape) & usable
    return largest_growth(about, engine)[0] < 0.0


def flags_of(mass: np.ndarray, damping: np.ndarray, stiffness: np.ndarray) -> Any:
    """True where every real part is negative, (count,), of flat matrices of 2 x 2; of M one or as many."""
    number = damping.size // 4
    words = np.empty(-(-number // LANES), dtype=np.int64)
    two_dof_kernels().flags(mass, damping, stiffness, number, words, room(4))
    return np.unpackbits(words.astype("<u2").view(np.uint8), count=number, bitorder="little").view(bool)


def eigenvalues_of(about: Linearised, engine: Engine = "auto", special: np.bool_ | np.ndarray | None = None) -> Any:
    """All eigenvalues (..., 2n) [1/s] in no particular order; NaN without a spectrum. special : see `with_special`."""
    if about.M.shape[-1] == 2 and compiled(about, engine):
        return with_special(about, _two_dof_spectrum(about), special)
    matrix, rate, usable, _ = state_matrix(about)
    size = matrix.shape[-1]
    matrix[~usable] = np.eye(size)
    if size > LARGEST_COMPILED or not compiled(about, engine):
        values = np.linalg.eigvals(matrix).astype(complex)
    else:
        values = compiled_eigenvalues(matrix)
    values *= rate[..., None]
    values[~usable] = np.nan
    return with_special(about, values, special)


def compiled_eigenvalues(matrices: ArrayLike) -> Any:
    """Eigenvalues (..., n) of many small real matrices (..., n, n), as `numpy.linalg.eigvals`, several times faster.

    The steps are LAPACK's (balance, Householder, double-shift QR), taken by sixteen matrices together in packed
    registers, so the accuracy is LAPACK's too: backward stable; in no particular order. What the kernels leave, a row
    or column that stands alone, a size near overflow, QR that does not converge, LAPACK itself answers
    (:func:`by_lapack`); a matrix that is not finite has NaN. The first call in a process loads the kernel, the first
    on a machine compiles it. Raises ValueError for what is no real square matrix.

    Source: Golub & Van Loan, Matrix Computations, 4th ed., sections 7.4 and 7.5; LAPACK dgebal, dgehrd, dlahqr.

    >>> import numpy as np
    >>> from squealbox.stability import compiled_eigenvalues
    >>> found = compiled_eigenvalues(np.array([[[0.0, 1.0], [-4.0, 0.0]], [[2.0, 1.0], [0.0, 3.0]]]))
    >>> np.round(found, 12).tolist()
    [[2j, -2j], [(2+0j), (3+0j)]]
    """
    matrices = np.asarray(matrices)
    if matrices.ndim < 2 or matrices.shape[-1] != matrices.shape[-2] or np.iscomplexobj(matrices):
        raise ValueError(f"matrices are {matrices.dtype} of shape {matrices.shape}: expected real (..., n, n)")
    if not matrices.size:
        return np.empty(matrices.shape[:-1], dtype=complex)
    flat = np.require(matrices.reshape(-1, *matrices.shape[-2:]), float, ["C", "W"])
    values, n = np.empty(flat.shape[:2], dtype=complex), flat.shape[-1]
    spectra_kernels().spectra(flat, parts_of(values), room(n * n), room(n), room(n), room(n))
    left = np.isnan(values[:, 0].real)  # the kernel leaves a matrix whole
    if np.any(left):
        values[left] = by_lapack(flat[left])
    return values.reshape(matrices.shape[:-1])


def two_dof_kernels() -> Any:
    """The functions of `kernels_two_dof`, compiled at their first call on a machine."""
    from squealbox.compiled import translated

    return translated(kernels_two_dof)


def spectra_kernels() -> Any:
    """Those of `kernels_spectra`."""
    from squealbox.compiled import translated

    return translated(kernels_qr, kernels_spectra)


def parts_of(values: np.ndarray) -> Any:
    """Real and imaginary parts of complex numbers (...), the same memory, (..., 2)."""
    return values.view(float).reshape(*values.shape, 2)


def by_lapack(matrices: np.ndarray) -> Any:
    """What the kernels leave: rows or columns that stand alone, sizes near overflow, QR that does not converge.

    NaN for matrices that are not finite, or on which LAPACK fails too.
    """
    values = np.full(matrices.shape[:2], np.nan, dtype=complex)
    finite = np.all(np.isfinite(matrices), axis=(-1, -2))
    try:
        values[finite] = np.linalg.eigvals(matrices[finite])
    except np.linalg.LinAlgError:  # NumPy answers no matrix of a batch when one fails
        if len(matrices) > 1:
            return np.concatenate([by_lapack(one[None]) for one in matrices])
    return values


def compiled(about: Linearised, engine: Engine) -> bool:
    """True when `engine` asks for the compiled kernels, or leaves it open and the batch is large enough."""
    if engine not in ("auto", "numpy", "compiled"):
        raise ValueError(f"engine = {engine!r}: expected 'auto', 'numpy' or 'compiled'")
    return engine == "compiled" or (engine == "auto" and about.K.size >= WORTH_IT * about.K.shape[-1] ** 2)


def growth_of_parts(about: Linearised, passive: np.ndarray, elastic: np.ndarray) -> Callable[[float, float], Any]:
    """The largest growth rate of E + x (K - E) and P + y (C - P), as a compiled function of x and y.

    P is `passive`, E `elastic`. For two degrees of freedom; the matrices are read once, whatever the number of calls.
    """
    mass, damping, stiffness, shape, _ = _flat(about)
    base, springs = (
        np.require(np.broadcast_to(part, about.C.shape), float, ["C", "W"]).reshape(-1) for part in (passive, elastic)
    )

    kernels = two_dof_kernels()

    def growth(x: float, y: float) -> Any:
        out = np.empty(damping.size // 4)
        kernels.growth_of_parts(mass, base, damping, springs, stiffness, (float(x), float(y)), out, room(4))
        return out.reshape(shape)

    return growth


def _two_dof_spectrum(about: Linearised) -> Any:
    mass, damping, stiffness, shape, usable = _flat(about)
    values = np.empty((damping.size // 4, 4), dtype=complex)
    parts = parts_of(values).reshape(-1, 8)
    two_dof_kernels().spectrum(mass, damping, stiffness, parts, room(8))
    return np.where(usable[..., None], values.reshape(*shape, 4), np.nan)


def _two_dof(about: Linearised) -> tuple[Any, Any, Any]:
    mass, damping, stiffness, shape, usable = _flat(about)
    growth, omega, count = (np.empty(damping.size // 4) for _ in range(3))
    two_dof_kernels().growth_and_frequency(mass, damping, stiffness, growth, omega, count, room(4))
    known = usable & np.isfinite(growth.reshape(shape))
    growth, omega = (np.where(known, values.reshape(shape), np.nan) for values in (growth, omega))
    return growth, omega, np.where(known, count.reshape(shape), 0.0).astype(np.int64)


def _flat(about: Linearised) -> tuple[Any, Any, Any, tuple[int, ...], Any]:
    """The matrices as flat arrays, M once when it is shared, the leading shape, and where there is a spectrum."""
    shape = about.K.shape[:-2]
    shared = all(stride == 0 for stride in about.M.strides[:-2]) or about.M.ndim == 2
    mass = about.M[(0,) * (about.M.ndim - 2)] if shared else about.M
    determinant = mass[..., 0, 0] * mass[..., 1, 1] - mass[..., 0, 1] * mass[..., 1, 0]
    usable = np.asarray(about.equilibrium.exists) & (np.abs(determinant) > 1e-15 * np.max(np.abs(mass)) ** 2)
    # writable copies where needed, so that the kernels are compiled for one kind of array only
    mass, damping, stiffness = (np.require(a, float, ["C", "W"]).reshape(-1) for a in (mass, about.C, about.K))
    return mass, damping, stiffness, shape, usable
