"""How much friction a lot stands: up to where each of its brakes is stable, and whose scatter decides that."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.design import Design
from squealbox.parameters import ParameterError
from squealbox.remedies.candidates import laws_of, more_friction
from squealbox.remedies.production import DAMPERS, SPRINGS, lot_size, usual_scatter
from squealbox.scatter import Scatter
from squealbox.stability import complex_modes, growth_of
from squealbox.studies import binomial_interval, sobol_indices

FRICTIONS = 40  # looked at, from none to the largest; narrower windows of squeal between two of them are not seen
HALVINGS = 14  # of the step in which a brake is lost
BRAKES = 1024
SENSED = 128  # brakes, times parameters and two, from which it is told whose scatter matters
ASSUMED = (
    f"Assumed to scatter: springs {100.0 * SPRINGS:.0f} %, dampers {100.0 * DAMPERS:.0f} % (standard deviation), "
    "nothing else; friction is the axis"
)
NONE = 1e-7  # of the highest angular frequency: growth up to this is round-off of what neither grows nor decays
Say = Callable[[float], None]


@dataclass(frozen=True, eq=False)
class Lot:
    """For each brake of a lot the friction (n,) at which it is lost first, inf where that is not up to `top`.

    `nominal` is that of the brake as drawn. names and share: what part of its variance over the lot the scatter of each
    parameter alone makes (first Sobol' index), the largest first; empty where it does not vary.
    """

    lost: Any
    nominal: float
    top: float
    names: tuple[str, ...] = ()
    share: tuple[float, ...] = ()

    def stable(self, friction: ArrayLike) -> Any:
        """Share of the lot that is stable at every friction up to this."""
        return np.mean(self.lost > np.asarray(friction)[..., None], axis=-1)

    def interval(self, friction: float) -> tuple[float, float]:
        """Its exact 95 % interval, as of independent brakes."""
        hits = int(np.count_nonzero(self.lost > friction))
        return binomial_interval(hits, 0, len(self.lost), 0.95)

    def friction(self, share: float) -> float:
        """Up to which friction that share of the lot is stable; inf where that is beyond `top`."""
        return float(np.sort(self.lost)[int((1.0 - share) * len(self.lost))])


def lot_of(brake: Design, top: float = 1.0, *, brakes: int = BRAKES, seed: int = 0, say: Say = lambda _: None) -> Lot:
    """The lot of a brake whose stiffnesses and dampers scatter as `usual_scatter` assumes, over friction up to `top`.

    All coefficients of its laws rise together; `top` and all frictions are those of its static limit. A brake without
    steady sliding counts as lost. `say` hears how far the work is. Raises `ParameterError` where nothing scatters.
    """
    limit = max((float(np.max(law.static_limit)) for _, law in laws_of(brake)), default=0.0)
    if not limit > 0.0:
        raise ParameterError("lot_of", "brake", type(brake).__name__, "a brake with friction")
    chosen = {name: one for name, one in usual_scatter(brake).distributions.items() if not name.endswith("static")}
    if not chosen:
        raise ParameterError("lot_of", "brake", type(brake).__name__, "a brake with springs or dampers that scatter")
    scatter = Scatter(chosen)
    none = NONE * 2.0 * np.pi * float(np.nanmax(complex_modes(more_friction(brake, 0.0)).frequency))

    def lost(values: Mapping[str, Any], begin: float, end: float) -> Any:
        def grows(which: np.ndarray, friction: np.ndarray) -> Any:
            some = brake.replace({name: np.asarray(each)[which] for name, each in values.items()})
            return growth_of(more_friction(some, friction / limit)) > none

        count = len(next(iter(values.values())))
        return _lost(grows, count, top, lambda share: say(begin + (end - begin) * share))

    whole = lot_size(brake, brakes)
    found = lost(scatter.sample(whole, seed=seed), 0.0, 0.5)
    nominal = float(lost({name: np.array([brake.value_of(name)]) for name in chosen}, 0.5, 0.5)[0])
    sensed = sobol_indices(
        None, scatter, lambda at: np.minimum(lost(at, 0.5, 1.0), top), samples=min(SENSED, whole), seed=seed
    )
    order: Any = np.argsort(-sensed.first) if sensed.outcome.ok else []
    names, share = [sensed.names[i] for i in order], [float(sensed.first[i]) for i in order]
    return Lot(found, nominal, top, tuple(names), tuple(share))


def _lost(grows: Callable[[Any, Any], Any], count: int, top: float, say: Say) -> Any:
    """The friction at which each of `count` brakes first has a mode that grows, (count,); inf for none up to `top`."""
    high, left = np.full(count, np.inf), np.arange(count)
    for k in range(1, FRICTIONS + 1):
        say(k / FRICTIONS)
        if len(left):
            now = grows(left, np.full(len(left), top * k / FRICTIONS))
            high[left[now]] = top * k / FRICTIONS
            left = left[~now]
    gone = np.flatnonzero(np.isfinite(high))
    low = high - top / FRICTIONS
    for _ in range(HALVINGS if len(gone) else 0):
        middle = 0.5 * (low[gone] + high[gone])
        now = grows(gone, middle)
        high[gone[now]], low[gone[~now]] = middle[now], middle[~now]
    return high
