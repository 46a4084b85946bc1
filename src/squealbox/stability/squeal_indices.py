"""Numbers by which practice ranks modes, and their conversion into each other.

With lambda = sigma + i omega: damping ratio zeta = -sigma/|lambda|; finite-element codes print -2 sigma/|omega|,
about 2 zeta; the logarithmic decrement of a cycle is -2 pi sigma/|omega|; the loss factor is 2 zeta; the tendency of
instability adds sigma/omega over the growing modes, in thousandths.
"""

from collections.abc import Mapping
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.stability.eigenvalues import MARGINAL, ComplexModes
from squealbox.stability.mode import damping_ratio

SQUEAL_BAND = (1e3, 16e3)  # Hz: where brake noise is called squeal


def squeal_index(eigenvalues: ArrayLike) -> Any:
    """-2 Re/|Im| [-], as finite-element codes print it; negative grows, NaN where Im = 0. Array in, array out."""
    with np.errstate(invalid="ignore", divide="ignore"):
        index = -2.0 * np.real(eigenvalues) / np.abs(np.imag(eigenvalues))
    return np.where(np.imag(eigenvalues) == 0.0, np.nan, index)


def logarithmic_decrement(eigenvalues: ArrayLike) -> Any:
    """ln of the ratio of two successive amplitudes, -2 pi Re/|Im| [-]; negative grows, NaN where Im = 0.

    Array in, array out.
    """
    return np.pi * squeal_index(eigenvalues)


def loss_factor(eigenvalues: ArrayLike) -> Any:
    """Loss factor 2 zeta [-] of a lightly damped mode; negative grows. Array in, array out."""
    return 2.0 * damping_ratio(eigenvalues)


def damping_ratio_from(value: ArrayLike, convention: str) -> Any:
    """Damping ratio [-] from another convention: "squeal_index", "logarithmic_decrement", "loss_factor" or "quality".

    Array in, array out.

    Exact: -2 Re/|Im| = 2 zeta / sqrt(1 - zeta^2), the decrement pi times that; loss factor 2 zeta; quality 1/(2 zeta).

    >>> round(float(damping_ratio_from(-0.02, "squeal_index")), 6)
    -0.01
    """
    value = np.asarray(value, dtype=float)
    if convention == "squeal_index":
        return value / np.sqrt(4.0 + value**2)
    if convention == "logarithmic_decrement":
        return value / np.sqrt(4.0 * np.pi**2 + value**2)
    if convention == "loss_factor":
        return value / 2.0
    if convention == "quality":
        return 0.5 / value
    known = "'squeal_index', 'logarithmic_decrement', 'loss_factor' or 'quality'"
    raise ValueError(f"convention = {convention!r}: expected {known}")


def indices(modes: ComplexModes, band: tuple[float, float] = SQUEAL_BAND) -> Mapping[str, Any]:
    """The usual numbers of a spectrum, each of shape (...).

    Parameters
    ----------
    modes : result of `complex_modes`
    band : (low, high) in Hz, within which modes are counted

    Returns a dictionary: `unstable_modes`; `unstable_in_band`; `tendency_of_instability` (sum of 1000 Re/|Im| over
    growing modes); `worst_growth_rate` [1/s], `worst_damping_ratio`, `worst_squeal_index` and `worst_frequency` [Hz] of
    the least damped mode in the band, NaN when the band is empty.
    """
    low, high = band
    if not 0.0 <= low < high:
        raise ValueError(f"band = {band}: expected (low, high) in Hz with 0 <= low < high")
    half = modes.eigenvalues.shape[-1] // 2
    values = modes.eigenvalues[..., :half]
    frequency = np.abs(values.imag) / (2.0 * np.pi)
    growing = values.real > MARGINAL * np.max(np.abs(values), axis=-1, keepdims=True)
    inside = (frequency >= low) & (frequency <= high)
    tendency = np.where(growing & (values.imag != 0.0), -500.0 * squeal_index(values), 0.0)
    ratio = np.where(inside, damping_ratio(values), np.inf)
    place = np.argmin(ratio, axis=-1)[..., None]
    some = np.any(inside, axis=-1)
    worst = np.where(some, np.take_along_axis(values, place, axis=-1)[..., 0], complex(np.nan, np.nan))
    return {
        "unstable_modes": np.sum(growing, axis=-1),
        "unstable_in_band": np.sum(growing & inside, axis=-1),
        "tendency_of_instability": np.sum(tendency, axis=-1),
        "worst_growth_rate": worst.real,
        "worst_damping_ratio": damping_ratio(worst),
        "worst_squeal_index": squeal_index(worst),
        "worst_frequency": np.abs(worst.imag) / (2.0 * np.pi),
    }
