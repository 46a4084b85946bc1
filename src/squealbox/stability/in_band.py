"""A reduced brake along its parameters by the modes of its band alone, one value at a time.

Above its band a reduced brake has modes that are none of the full one, and the whole spectrum costs many times what the
band does. So scans, maps and what feeds a mode look at the band; the growth rates there are those of the full brake to
`ReducedBrake.error`, where that was checked.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.fe import ReducedBrake, Small, condensed, vibrating
from squealbox.stability.eigenvalues import complex_modes
from squealbox.stability.family import SteadyFamily, steady_sliding
from squealbox.stability.spectra import largest_growth
from squealbox.system import Linearised

POINTS = 81  # values of a scan; narrow windows are looked for between them as ever
IDLE = 1e-9  # share of |lambda| up to which a growth rate is round-off


def eigenvalues_along(family: SteadyFamily, *values: Any) -> Iterator[Any]:
    """The eigenvalues with Im > 0 in the band at each of the values (k,), NaN where there is no steady sliding."""
    for point in zip(*(np.ravel(value) for value in values), strict=True):
        yield eigenvalues_in_band(family.one(*(float(x) for x in point)), family.time)


def eigenvalues_in_band(design: ReducedBrake, time: float) -> Any:
    """The same of one brake, good to 1e-8."""
    found = design.band_modes(None, time, rough=True)
    if found is not None:
        return found[0].values
    modes = complex_modes(design, time)
    return modes.eigenvalues[: len(modes.eigenvalues) // 2] if modes.exists else np.array([complex(np.nan)])


def growth_in_band(family: SteadyFamily, values: ArrayLike) -> Any:
    """Growth rates less round-off [1/s] (values, modes), the largest first; NaN where there is no mode more."""
    rows = [-np.sort(-(found.real - IDLE * np.abs(found))) for found in eigenvalues_along(family, values)]
    most = max((len(row) for row in rows), default=0)
    return np.stack([np.pad(row, (0, most - len(row)), constant_values=np.nan) for row in rows])


def largest_in_band(family: SteadyFamily, *values: ArrayLike) -> tuple[Any, Any, Any]:
    """Largest growth rate [1/s], angular frequency of its mode [rad/s] and growing modes, (k,); as `largest_growth`."""
    growth, omega, growing = np.array([worst_in_band(found) for found in eigenvalues_along(family, *values)]).T
    return growth, omega, growing.astype(np.int64)


def worst_in_band(eigenvalues: np.ndarray) -> tuple[float, float, int]:
    """The same of the eigenvalues of one brake; NaN, NaN and 0 without a mode."""
    known = eigenvalues[np.isfinite(eigenvalues)]
    if not len(known):
        return np.nan, np.nan, 0
    worst = known[np.argmax(known.real)]
    return float(worst.real), abs(float(worst.imag)), int(np.sum(known.real > IDLE * np.abs(known)))


def growth_of(design: Any) -> Any:
    """The largest growth rate [1/s] of a design of arrays, inf without steady sliding; of a reduced one in its band."""
    if isinstance(design, ReducedBrake):
        every = [design.entry(at) for at in np.ndindex(design.shape)] if design.shape else [design]
        found = np.array([worst_in_band(eigenvalues_in_band(one, 0.0))[0] for one in every])
        return np.where(np.isfinite(found), found, np.inf).reshape(design.shape)
    return growth_about(steady_sliding(design))


def growth_about(sliding: Linearised) -> Any:
    """As `growth_of`, of what is linearised already."""
    growth: Any = largest_growth(sliding)[0]
    return np.where(np.isfinite(growth), growth, np.inf)


def ranked_in_band(small: Small, band: tuple[float, float], rank: int) -> Any:
    """The `rank`-th largest growth rate [1/s] in the band, the fast coordinates following statically."""
    slow = condensed(small, band[1])
    values = (small if slow is None else slow.small).eigenvalues()
    low, high = (2.0 * np.pi * f for f in band)
    inside = (values.imag >= low) & (values.imag <= high) & vibrating(values)
    growth = -np.sort(-values[inside].real)
    return np.asarray(growth[min(rank, len(growth) - 1)] if len(growth) else np.nan)
