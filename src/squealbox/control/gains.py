"""Which gains hold a brake: the ranges of a common factor on the forces of loops in which every pole decays."""

from dataclasses import dataclass

import numpy as np

from squealbox.arguments import public
from squealbox.control import sampled
from squealbox.control.plants import Plant, plant
from squealbox.control.poles import Late, late_poles
from squealbox.parameters import ParameterError
from squealbox.result import Array, Outcome, Result, quantity
from squealbox.system import DesignOrSystem

LEAST, MOST, POINTS, FEWER = 1e-3, 1e3, 97, 37  # factors looked at, beside 0; fewer where each asks for late poles
TIGHT = 1e-13  # relative width to which an end of a range is solved for


@dataclass(frozen=True, kw_only=True, eq=False)
class StableGains(Result):
    """The ranges, as :func:`stable_gains` returns them.

    Outcome "completed", or "no_stable_gain" where no factor up to 1000 holds the brake.
    """

    low: Array = quantity("range", "1", "factor from which on the brake is stable")
    high: Array = quantity("range", "1", "factor up to which it is; inf where 1000 still is")
    factor: Array = quantity("factor", "1", "factors looked at")
    growth: Array = quantity("factor", "1/s", "growth rate with each")

    @property
    def least_growth(self) -> float:
        """The least growth rate [1/s] of all factors looked at; NaN without any."""
        return float(np.min(self.growth, initial=np.inf)) if len(self.growth) else float("nan")

    @property
    def best(self) -> float:
        """The factor with the least growth rate; NaN without any."""
        return float(self.factor[np.argmin(self.growth)]) if len(self.growth) else float("nan")

    def summary(self) -> str:
        """The ranges, or that there is none."""
        if not self.outcome.ok:
            return self.outcome.told
        spans = ", ".join(f"{a:.6g} to {b:.6g}" for a, b in zip(self.low, self.high, strict=True))
        return (
            f"stable with the loops' forces times {spans}; fastest decay {self.least_growth:.6g} 1/s at {self.best:.6g}"
        )


@public()
def stable_gains(design_or_system: DesignOrSystem, loop: int | None = None, *, time: float = 0.0) -> StableGains:
    """The ranges of a factor >= 0 on the forces of the loops in which the brake is stable, delays and sampling kept.

    Parameters
    ----------
    design_or_system : `Controlled(brake, loops)`, any design around it, or a `System` with loops
    loop : place of the one loop whose force is multiplied, the others as they are; None multiplies all
    time : instant of schedules [s]

    97 factors from 0.001 to 1000 (37 with delays) and 0 are looked at, and the least growth between two of them; the
    ends of a range are solved for to round-off. With a delay T a decay faster than 1/T is told as that.

    >>> from squealbox import PID, System
    >>> block = System([[1.0]], [[-0.1]], [[1.0]], loops=(PID(on="q1", derivative=0.3),))
    >>> round(float(stable_gains(block).low[0]), 12)
    0.333333333333
    """
    from scipy.optimize import brentq, minimize_scalar

    found = plant(design_or_system, time)
    if loop is not None and not (isinstance(loop, int) and 0 <= loop < len(found.loops)):
        raise ParameterError("stable_gains", "loop", loop, f"a whole number from 0 to {len(found.loops) - 1}, or None")
    inputs, nothing = {"system": design_or_system, "loop": loop, "time": time}, np.zeros(0)
    if not found.outcome.ok:
        return StableGains(
            low=nothing, high=nothing, factor=nothing, growth=nothing, inputs=inputs, outcome=found.outcome
        )

    def growth(factor: float) -> float:
        return _growth(found, np.where([loop is None or a == loop for a in range(len(found.loops))], factor, 1.0))

    late = np.any(found.delay > 0.0) and not np.any(found.sampling > 0.0)
    factors = np.concatenate([[0.0], np.geomspace(LEAST, MOST, FEWER if late else POINTS)])
    rates = np.array([growth(float(g)) for g in factors])
    for i in range(1, len(factors) - 1):
        if rates[i] <= min(rates[i - 1], rates[i + 1]):
            near = minimize_scalar(growth, bounds=(factors[i - 1], factors[i + 1]), method="bounded",
                                   options={"xatol": 1e-6 * factors[i]})  # fmt: skip
            factors, rates = np.append(factors, near.x), np.append(rates, near.fun)
    order = np.argsort(factors)
    factors, rates = factors[order], rates[order]
    least, at = float(np.min(rates)), float(factors[np.argmin(rates)])
    holds, low, high = rates < 0.0, [], []
    for i in range(len(factors)):
        if holds[i] and (i == 0 or not holds[i - 1]):
            low.append(0.0 if i == 0 else brentq(growth, factors[i - 1], factors[i], rtol=TIGHT, xtol=1e-300))
        if holds[i] and (i + 1 == len(factors) or not holds[i + 1]):
            last = i + 1 == len(factors)
            high.append(np.inf if last else brentq(growth, factors[i], factors[i + 1], rtol=TIGHT, xtol=1e-300))
    message = f"no factor from 0 to {MOST:g} on the loops' forces holds the brake: it grows at {least:.6g} 1/s at best"
    outcome = Outcome() if low else Outcome("no_stable_gain", message, least_growth=least, factor=at)
    return StableGains(
        low=np.array(low), high=np.array(high), factor=factors, growth=rates, inputs=inputs, outcome=outcome
    )


def _growth(found: Plant, gains: np.ndarray) -> float:
    """Largest growth rate [1/s] with the commands times gains (a,)."""
    if np.any(found.sampling > 0.0):
        matrix, step = sampled.held(found, gains=gains)
        return float(np.log(np.max(np.abs(np.linalg.eigvals(matrix)), initial=1e-300)) / step)
    late = found.delay > 0.0
    A = found.A + (found.B[:, ~late] * gains[~late]) @ found.H[~late]
    parts = [(float(t), gains[a] * np.outer(found.B[:, a], found.H[a]))
             for a, t in enumerate(found.delay) if t > 0.0 and gains[a] != 0.0]  # fmt: skip
    if not parts:
        return float(np.max(np.linalg.eigvals(A).real))
    line = -1.0 / float(np.max(found.delay))
    return float(np.max(late_poles(Late(A, parts), line)[0].real, initial=line))
