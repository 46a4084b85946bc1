"""Stability over a grid of parameters: growth rate, frequency, number of growing modes and mechanism at each point.

The grid is computed in blocks, so a map of millions of points needs no more memory than its own arrays, and a point
without steady sliding is a missing value, not an error. The boundary as curves is `boundary.stability_boundary`.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from squealbox.arguments import named, public
from squealbox.family import DesignOrRecipe
from squealbox.labelled import Labelled, Labels
from squealbox.result import Array, Outcome, Result, quantity
from squealbox.stability.eigenvalues import MARGINAL
from squealbox.stability.family import Steady, SteadyFamily, entry, steady_sliding
from squealbox.stability.in_band import largest_in_band
from squealbox.stability.mechanisms import NAMES, STEPS, contributions, mechanism_codes
from squealbox.stability.spectra import Engine, largest_growth
from squealbox.words import growing

STEPS_IN_BAND = 2  # of a mechanism's split at a point of a reduced brake's map
CHUNK = 1 << 15  # points computed together: their arrays stay in the processor's cache


@dataclass(frozen=True, kw_only=True, eq=False)
class StabilityMap(Result):
    """Stability over a grid, one axis for each parameter in the order given, as :func:`stability_map` returns it.

    mechanism holds codes into `mechanism_names`: 0 stable, 1 flutter, 2 negative_slope, 3 divergence, 4 mixed, -1 none;
    circulation and slope [1/s] are what the two parts of friction bring to the growth rate (0 where stable).
    """

    growth_rate: Array = quantity("...", "1/s", "largest growth rate")
    frequency: Array = quantity("...", "Hz", "frequency of the mode with the largest growth rate")
    unstable_modes: Array = quantity("...", "1", "number of growing modes")
    mechanism: Array = quantity("...", "1", "0 stable, 1 flutter, 2 negative slope, 3 divergence, 4 mixed, -1 none")
    circulation: Array = quantity("...", "1/s", "brought by circulatory forces")
    slope: Array = quantity("...", "1/s", "brought by the damping part of friction")
    axes: Mapping[str, Any]

    mechanism_names = NAMES
    headings: ClassVar = {"unstable_modes": "growing modes"}

    @property
    def unstable(self) -> Array:
        """True where a mode grows."""
        return self.unstable_modes > 0

    @property
    def exists(self) -> Array:
        """True where there is steady sliding."""
        return np.isfinite(self.growth_rate)

    def table(self) -> dict[str, Any]:
        return {**super().table(), "mechanism": np.array([*NAMES, "none"])[self.mechanism.ravel()]}

    def summary(self) -> str:
        """How much of the map is unstable, by which mechanism, and where it is worst."""
        total, known = self.growth_rate.size, int(np.sum(self.exists))
        if known == 0:
            return f"no steady sliding at any of {total} points"
        unstable = int(np.sum(self.unstable))
        names = [(name, int(np.sum(self.mechanism == code))) for code, name in enumerate(NAMES) if code > 0]
        shares = [f"{name.replace('_', ' ')} {100.0 * count / unstable:.1f} %" for name, count in names if count]
        place = np.unravel_index(int(np.nanargmax(self.growth_rate)), self.growth_rate.shape)
        at = zip(self.axes.items(), place, strict=True)
        where = ", ".join(f"{name} = {self.read_value(name, np.asarray(values)[i])}" for (name, values), i in at)
        lines = [f"{unstable} of {known} points are unstable ({100.0 * unstable / known:.1f} %)"]
        lines += [f"mechanism of the unstable points: {', '.join(shares)}"] * bool(shares)
        grows = growing(self.growth_rate[place], self.frequency[place])
        lines.append(f"the largest growth rate is {grows}, {where}")
        return "\n".join(lines + [f"{total - known} more points have no steady sliding"] * (known < total))

    def labelled(self) -> Labelled:
        """The arrays with the parameters as named coordinates."""
        names = {f"axis_{i}": name for i, name in enumerate(self.axes)}
        labels = {
            name: Labels((name,), np.asarray(at), {"units": self.unit_of(name)}) for name, at in self.axes.items()
        }
        return super().labelled().renamed(names).with_({}, labels)


@public(axes=named)
def stability_map(
    design: DesignOrRecipe,
    axes: Mapping[str, Any],
    *,
    mechanism: bool = True,
    time: float = 0.0,
    steps: int = STEPS,
    engine: Engine = "auto",
) -> StabilityMap:
    """Growth rate, frequency, number of growing modes and mechanism over any number of parameters.

    Parameters
    ----------
    design : a design, or a function of one float for each parameter that returns a design or a system
    axes : name to values, such as ``{"friction.static": mus, "load": loads}``; one axis of the map for each, in order
    mechanism : also why each unstable point is unstable; without it the map takes a fifth of the time
    time : instant of schedules [s]
    steps : of the mechanism's split, see `squealbox.stability.mechanism`
    engine : "auto" (compiled kernels for large maps), "numpy" or "compiled"

    Of a reduced brake the modes in its band are looked at, one point at a time: some 0.1 s for each at 250 coordinates.

    Raises `ParameterError` for a name or value the design refuses and for an empty axis.
    """
    family = SteadyFamily.along("stability_map", design, axes, time=time)
    names, values = family.parameters, family.spans
    shape = tuple(array.size for array in values)
    count = int(np.prod(shape))
    columns = {name: np.empty(count) for name in ("growth_rate", "frequency", "circulation", "slope")}
    columns |= {"unstable_modes": np.empty(count, dtype=np.int64), "mechanism": np.empty(count, dtype=np.int8)}
    worst = Outcome()
    chosen = "compiled" if engine == "auto" and count > CHUNK else engine
    for start in range(0, count, CHUNK if family.band is None else count):
        places = np.unravel_index(np.arange(start, min(start + CHUNK, count)), shape)
        if family.band is not None:
            columns |= _in_band(family, [array[i] for array, i in zip(values, places, strict=True)], mechanism, steps)
            break
        steady = family.at(*(array[i] for array, i in zip(values, places, strict=True)))
        worst = worst if steady.equilibrium.outcome.ok or not worst.ok else steady.equilibrium.outcome
        for name, part in _block(steady, mechanism, steps, chosen).items():
            columns[name][start : start + CHUNK] = part
    arrays: dict[str, Any] = {name: column.reshape(shape) for name, column in columns.items()}
    outcome = worst if not np.any(np.isfinite(arrays["growth_rate"])) else Outcome()
    settings = {"mechanism": mechanism, "steps": steps, "engine": engine}
    named = dict(zip(names, values, strict=True))
    return StabilityMap(**arrays, axes=named, inputs=family.inputs, settings=settings, outcome=outcome)


def _in_band(family: SteadyFamily, values: list[Any], mechanism: bool, steps: int) -> dict[str, Any]:
    """The columns of a reduced brake, from the modes of its band, point by point."""
    growth, omega, growing = largest_in_band(family, *values)
    circulation, slope = np.zeros(growth.shape), np.zeros(growth.shape)
    for i in np.flatnonzero(growing > 0) if mechanism else ():
        steady = steady_sliding(family.one(*(float(x[i]) for x in values)), family.time)
        _, circulation[i], slope[i] = contributions(steady, steps=min(steps, STEPS_IN_BAND), band=family.band)
    return _columns(growth, omega, growing, omega, circulation, slope, mechanism)


def _block(steady: Steady, mechanism: bool, steps: int, engine: Engine) -> dict[str, Any]:
    growth, omega, growing = largest_growth(steady, engine)
    circulation, slope = np.zeros(growth.shape), np.zeros(growth.shape)
    unstable, mechanism = (
        growing > 0,
        mechanism and bool(np.all(np.isfinite(steady.structural[steady.equilibrium.exists]))),
    )
    if mechanism and np.any(unstable):
        _, circulation[unstable], slope[unstable] = contributions(entry(steady, unstable), steps=steps, engine=engine)
    return _columns(growth, omega, growing, np.hypot(growth, omega), circulation, slope, mechanism)


def _columns(
    growth: np.ndarray,
    omega: np.ndarray,
    growing: np.ndarray,
    scale: np.ndarray,
    circulation: np.ndarray,
    slope: np.ndarray,
    mechanism: bool,
) -> dict[str, Any]:
    """The columns of a map; `scale` [rad/s] is the size of the worst eigenvalue, NaN where there is none."""
    unstable = growing > 0
    codes = mechanism_codes(np.where(unstable, scale, -scale), omega, circulation, slope, scale * (1.0 - MARGINAL))
    return {
        "growth_rate": growth,
        "frequency": omega / (2.0 * np.pi),
        "circulation": circulation,
        "slope": slope,
        "unstable_modes": growing,
        "mechanism": codes if mechanism else np.where(unstable, -1, codes),
    }
