"""The state matrix of linearised sliding and its eigenvalues, singular pencils solved exactly.

[[0, I], [-M^-1 K, -M^-1 C]], with time scaled by a typical angular frequency.
"""

from functools import lru_cache
from typing import Any

import numpy as np

from squealbox.result import COMPLETED, Outcome
from squealbox.stability.deflation import special_modes
from squealbox.stability.first_order import first_order_spectra
from squealbox.stability.free_bodies import free_body_spectra
from squealbox.stability.ordering import spectrum_order
from squealbox.static_deflection import levelled
from squealbox.system import Linearised


def spectrum(about: Linearised) -> Any:
    """Only the eigenvalues (..., 2n), ordered as in :class:`ComplexModes`; NaN where there are none."""
    matrix, rate, usable, _ = state_matrix(about)
    scaled = np.linalg.eigvals(np.where(usable[..., None, None], matrix, stand_in(matrix))).astype(complex)
    scaled = np.take_along_axis(scaled, spectrum_order(scaled), axis=-1)
    return with_special(about, np.where(usable[..., None], scaled * rate[..., None], np.nan))


def special_entries(about: Linearised) -> Any:
    """True where steady sliding exists and a freedom carries no mass or moves as a rigid body, (...)."""
    exists = np.asarray(about.equilibrium.exists)
    known = np.broadcast_to(_regular(_once(about.M)), exists.shape)
    return exists & (~known | (np.asarray(about.equilibrium.floating) > 0))


def with_special(about: Linearised, eigenvalues: np.ndarray, special: np.bool_ | np.ndarray | None = None) -> Any:
    """Eigenvalues (..., 2n) with those entries solved exactly whose pencil is singular; see `deflation`.

    special : what `special_entries` says, where it was asked
    """
    special = special_entries(about) if special is None else special
    if not np.any(special):
        return eigenvalues
    eigenvalues = np.array(eigenvalues)
    quick = special & (np.asarray(about.equilibrium.floating) == 0)
    if np.any(quick):
        values, answered = first_order_spectra(
            *(np.broadcast_to(part, about.K.shape)[quick] for part in (about.M, about.C, about.K))
        )
        known = np.where(
            np.isnan(values), -1e3 * np.nanmax(np.abs(values), axis=-1, keepdims=True, initial=1.0), values
        )
        values = np.take_along_axis(values, spectrum_order(known), axis=-1)
        special = np.array(special)
        if np.any(answered):
            places = np.argwhere(quick)[answered]
            eigenvalues[tuple(places.T)] = values[answered]
            special[tuple(places.T)] = False
    floating = np.broadcast_to(about.equilibrium.floating, special.shape)
    free = special & (floating > 0) & np.broadcast_to(_regular(_once(about.M)), special.shape)
    if np.any(free):
        mass, damping, stiffness = (np.broadcast_to(part, about.K.shape)[free] for part in (about.M, about.C, about.K))
        values, answered = free_body_spectra(mass, damping, stiffness, floating[free])
        values = np.take_along_axis(values, spectrum_order(values), axis=-1)
        if np.any(answered):
            places = np.argwhere(free)[answered]
            eigenvalues[tuple(places.T)], special = values[answered], np.array(special)
            special[tuple(places.T)] = False
    for at in map(tuple, np.argwhere(special)):
        found = special_modes(about.M[at], about.C[at], about.K[at])
        eigenvalues[at] = np.nan if found is None else found[0]
    return eigenvalues


def state_matrix(about: Linearised) -> tuple[Any, Any, Any, Outcome]:
    """[[0, I], [-M^-1 K/r^2, -M^-1 C/r]], its time scale r (...) [1/s], where it can be used, and the outcome."""
    size = about.M.shape[-1]
    exists = np.asarray(about.equilibrium.exists)
    with np.errstate(all="ignore"):
        mass = _once(about.M)
        regular = _regular(mass)
        mass = np.where(regular[..., None, None], mass, np.eye(size))
        stiffness = _divided(mass, np.where(exists[..., None, None], about.K, 0.0))
        damping = _divided(mass, np.where(exists[..., None, None], about.C, 0.0))
        rate = np.maximum(np.sqrt(_largest(stiffness)), _largest(damping))
        rate = np.where(np.isfinite(rate) & (rate > 0.0), rate, 1.0)
        matrix = np.zeros((*stiffness.shape[:-2], 2 * size, 2 * size))
        matrix[..., :size, size:] = np.eye(size)
        np.divide(stiffness, -(rate[..., None, None] ** 2), out=matrix[..., size:, :size])
        np.divide(damping, -rate[..., None, None], out=matrix[..., size:, size:])
    regular = np.broadcast_to(regular, exists.shape)
    finite = np.all(np.isfinite(matrix[..., size:, :]), axis=(-1, -2))
    return matrix, rate, exists & regular & finite, _outcome(about, exists, finite | ~regular)


def _regular(mass: np.ndarray) -> Any:
    """Whether M can be inverted, judged after its rows and columns are brought to one size: kg beside kg m2."""
    if mass.ndim == 2:
        return _regular_alone(np.asarray(mass, dtype=float).tobytes(), len(mass))
    with np.errstate(all="ignore"):
        regular = np.asarray(np.linalg.cond(mass, 1) < 1.0 / np.finfo(float).eps)
        if not np.all(regular):
            regular[~regular] = np.linalg.cond(levelled(mass[~regular])[0], 1) < 1.0 / np.finfo(float).eps
    return regular


@lru_cache(maxsize=64)
def _regular_alone(content: bytes, size: int) -> Any:
    """Of one M, which searches ask about thousands of times."""
    return _regular(np.frombuffer(content).reshape(1, size, size))[0]


def _once(mass: np.ndarray) -> Any:
    """M (n, n) where all systems share one, else as it is."""
    shared = all(step == 0 for step in mass.strides[:-2])
    return mass[(0,) * (mass.ndim - 2)] if shared and mass.size else mass


def _divided(mass: np.ndarray, matrix: np.ndarray) -> Any:
    """M^-1 A; one factorisation where all systems share one M."""
    if mass.ndim > 2 or matrix.ndim == 2:
        return np.linalg.solve(mass, matrix)
    columns = np.moveaxis(matrix, -2, 0)
    return np.moveaxis(np.linalg.solve(mass, columns.reshape(len(mass), -1)).reshape(columns.shape), 0, -2)


def stand_in(matrix: np.ndarray) -> Any:
    """A harmless matrix for entries without a spectrum."""
    return np.diag(np.arange(1.0, matrix.shape[-1] + 1.0))


def _outcome(about: Linearised, exists: np.ndarray, finite: bool | np.bool_ | np.ndarray) -> Outcome:
    if not np.all(exists):
        return about.equilibrium.outcome
    if not np.all(finite):
        return Outcome("not_finite", "M^-1 K or M^-1 C overflows", entries=int(np.sum(~finite)))
    return Outcome(COMPLETED)


def _largest(matrix: np.ndarray) -> Any:
    return np.max(np.abs(matrix), axis=(-1, -2))
