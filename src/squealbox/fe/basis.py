"""A basis on which a brake's modes are small: real modes, enriched by what friction and damping do to them.

Real modes Phi of the elastic brake K0 alone are a poor basis: the friction part Kf = K - K0 pushes shapes towards
K0^-1 Kf Phi, left shapes towards K0^-1 Kf' Phi and damping towards K0^-1 C Phi. An eigenvalue's error is the product of
what right and left shapes miss, so all three are added; of their span the directions with most strain energy are kept.
"""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.fe.pencil import Pencil
from squealbox.fe.undamped_modes import RealModes

if TYPE_CHECKING:
    from scipy.sparse import sparray

NEGLIGIBLE = 1e-13  # share of the largest length below which a direction is round-off


def enriched_basis(pencil: Pencil, modes: RealModes, top: float, allowed: float = 10.0) -> Any:
    """Columns V (n, m) with V' M V = I: the real modes, and of the vectors for those up to `top` [Hz] the strongest.

    A vector's strain energy over the angular frequency is what leaving it out may cost an eigenvalue [1/s]; those left
    out hold `allowed` of it together.
    """
    shapes = modes.shapes
    below = modes.frequency <= max(top, float(np.min(modes.frequency, initial=0.0)))
    some, rates = shapes[:, below], 2.0 * np.pi * np.maximum(modes.frequency[below], 1e-3 * modes.top)
    held = pencil.elastic @ some
    parts = [*((part - held) / rates for part in pencil.stiffness_on(some)), pencil.damping_on(some)]
    parts = [part * np.sqrt(0.5 * rates) for part in parts if np.any(part)]
    right = np.concatenate(parts or [np.zeros((pencil.size, 0))], axis=1)
    return joined(pencil, shapes, strongest(pencil, modes, modes.base.solve_many(right), allowed))


def strongest(pencil: Pencil, modes: RealModes, vectors: np.ndarray, allowed: float) -> Any:
    """The directions of most strain energy in `vectors` less their part in the real modes, but for `allowed` of it."""
    shapes = modes.shapes
    vectors = vectors - shapes @ (shapes.T @ (pencil.M @ vectors))
    energy = vectors.T @ (pencil.elastic @ vectors)
    values, turns = np.linalg.eigh(0.5 * (energy + energy.T))
    values = np.maximum(values, 0.0)
    keep = np.cumsum(values) > max(allowed, NEGLIGIBLE * float(np.sum(values)))
    return vectors @ (turns[:, keep] / np.sqrt(values[keep]))


def joined(pencil: Pencil, basis: np.ndarray, vectors: np.ndarray) -> Any:
    """`basis` with the part of `vectors` that is new, V' M V = I; what is not new to round-off is left out."""
    fresh = fresh_directions(pencil.M, [basis], [pencil.M @ basis], vectors)
    return np.concatenate([basis, fresh], axis=1)


def fresh_directions(mass: "sparray", basis: Sequence[Any], weighted: Sequence[Any], vectors: np.ndarray) -> Any:
    """What of `vectors` is new to a basis V in blocks (n, m), with M V in `weighted`: W, W' M W = I and W' M V = 0."""
    lengths = np.sqrt(np.maximum(np.einsum("ij,ij->j", vectors, mass @ vectors), 0.0))
    vectors = _without(vectors[:, lengths > 0.0] / lengths[lengths > 0.0], basis, weighted)
    gram = vectors.T @ (mass @ vectors)
    values, turns = np.linalg.eigh(0.5 * (gram + gram.T))
    keep = values > NEGLIGIBLE
    fresh = vectors @ (turns[:, keep] / np.sqrt(values[keep]))
    fresh = _without(fresh, basis, weighted)  # what the small directions lost of their right angle
    return fresh @ np.linalg.inv(np.linalg.cholesky(fresh.T @ (mass @ fresh))).T


def _without(vectors: np.ndarray, basis: Sequence[Any], weighted: Sequence[Any]) -> Any:
    for block, heavy in zip(basis, weighted, strict=True):
        vectors = vectors - block @ (heavy.T @ vectors)
    return vectors
