"""What eigenvalues say of steady sliding: onsets, frequency curves and the map of the centres of pressure."""

from dataclasses import dataclass
from functools import cache
from typing import Any

import numpy as np

from squealbox.designs import DrumBrake
from squealbox.papers.drum_brake_2011.cases import FRICTION, MAP_ANGLES, SPEED, Case
from squealbox.stability import ComplexModes, complex_modes, critical_value, spectrum, stability_map
from squealbox.system import DesignOrSystem, as_system, linearise

MU_RANGE = (0.01, 1.0)
ROOT_STEPS = 12  # of the Illinois rule on an edge of the map: to the last digits
LOAD_RANGE = (100.0, 60e3)  # N; the paper goes to 25 kN


@dataclass(frozen=True)
class Onset:
    """Where a parameter makes sliding unstable: its value, the distance of the two frequencies there [rad/s], and why.

    `mechanism` is "flutter", "negative_slope", "mixed" or "divergence", `feeding` says what feeds the mode. Without an
    onset in the range searched `value` is infinite, `separation` is not a number and `mechanism` is empty.
    """

    value: float = np.inf
    separation: float = np.nan
    mechanism: str = ""
    feeding: str = ""

    @property
    def exists(self) -> bool:
        """False when sliding does not become unstable in the range."""
        return bool(np.isfinite(self.value))


@dataclass(frozen=True)
class PressureMap:
    """Largest growth rate [1/s] over the centres of pressure: `angles` [deg] of both, `growth` (theta1, theta2).

    `curves` are those of zero growth as traced, each (k, 2) [deg]; empty where stability changes nowhere, None where
    they were not asked for.
    """

    angles: Any
    growth: Any
    curves: list[Any] | None = None

    @property
    def unstable(self) -> Any:
        """True where a mode grows, shape (theta1, theta2)."""
        return self.growth > 0.0


@cache
def onset_in_friction(case: Case) -> Onset:
    """The friction coefficient at which sliding becomes unstable."""
    if case.alpha == 0.0 and case.speed != SPEED:
        return onset_in_friction(case.replace(speed=SPEED))  # without a slope the speed does not enter
    return _onset(case.design(), "friction.static", MU_RANGE)


@cache
def onset_in_load(case: Case) -> Onset:
    """The load [N] on both shoes at which sliding becomes unstable."""
    return _onset(case.design(), "load", LOAD_RANGE)


def pressure_map(case: Case, step: float = 1.0, mu: float = FRICTION, traced: bool = False) -> PressureMap:
    """Growth over both centres of pressure from 20 to 160 deg in steps of `step` [deg], with the `traced` boundary."""
    low, high = MAP_ANGLES
    angles = np.linspace(low, high, round((high - low) / step) + 1)
    over = dict.fromkeys(("theta1", "theta2"), np.deg2rad(angles))
    design = case.design(mu=mu)
    grown = stability_map(design, over, mechanism=False).growth_rate
    if not traced:
        return PressureMap(angles, grown)
    return PressureMap(angles, grown, _boundary(design, angles, grown))


def _boundary(design: DrumBrake, angles: np.ndarray, grown: np.ndarray) -> list[Any]:
    """The curves of zero growth through the map, each (k, 2) [deg].

    Every point lies on an edge of the grid whose ends differ in sign, and is found there by the rule of Illinois.
    """
    if not np.any(grown > 0.0) or not np.any(grown < 0.0):
        return []
    from contourpy import contour_generator

    lines: Any = contour_generator(angles, angles, np.where(grown.T > 0.0, 1.0, -1.0)).lines(0.0)
    sizes = [len(line) for line in lines]
    index = (np.concatenate(lines) - angles[0]) / (angles[1] - angles[0])  # one of both is whole, the other a half
    low, high = angles[np.floor(index).astype(int)], angles[np.ceil(index).astype(int)]

    def growth_at(points: np.ndarray) -> Any:
        theta1, theta2 = np.deg2rad(points).T
        return growth(design.replace({"theta1": theta1, "theta2": theta2}))

    at_low, at_high = growth_at(low), growth_at(high)
    moved = np.zeros(len(low), dtype=int)  # the end that moved last: 1 low, -1 high
    for _ in range(ROOT_STEPS):
        middle = low + (at_low / (at_low - at_high))[:, None] * (high - low)
        at_middle = growth_at(middle)
        left = (at_middle > 0.0) == (at_low > 0.0)
        at_high = np.where(left, np.where(moved == 1, 0.5 * at_high, at_high), at_middle)
        at_low = np.where(left, at_middle, np.where(moved == -1, 0.5 * at_low, at_low))
        low, high = np.where(left[:, None], middle, low), np.where(left[:, None], high, middle)
        moved = np.where(left, 1, -1)
    return np.split(middle, np.cumsum(sizes)[:-1])


def modes(case: Case, **parameters: Any) -> ComplexModes:
    """Complex modes of steady sliding; parameters as in `Case.design`."""
    return complex_modes(case.design(**parameters))


def frequencies(modes: ComplexModes) -> Any:
    """The two angular frequencies [rad/s], ascending, shape (..., 2)."""
    return modes.angular_frequency[..., :2]


def growth(design: DesignOrSystem) -> Any:
    """The largest growth rate [1/s], shape of the design's arrays."""
    return np.max(spectrum(linearise(as_system(design))).real, axis=-1)


def _onset(design: DrumBrake, parameter: str, bounds: tuple[float, float]) -> Onset:
    found = critical_value(design, parameter, bounds)
    if not found.outcome.ok:
        return Onset()
    there = complex_modes(design.replace({parameter: float(found.value)}))
    feeding = (
        f"{found.shares['flutter']:.0%} of what feeds it is flutter, {found.shares['negative_slope']:.0%} the slope"
    )
    return Onset(float(found.value), float(np.diff(frequencies(there))[0]), found.mechanism, feeding)
