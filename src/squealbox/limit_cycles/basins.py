"""Which starts lead to which attractor: basins, their share with its uncertainty, and the least dangerous push.

Starts fill a box about steady sliding; each is run and judged by the swing of its last part. The share p of n starts
that vibrate carries the Wilson interval (p + z^2/2n +- z sqrt(p (1 - p)/n + z^2/4n^2)) / (1 + z^2/n).
Basin stability: Menck, Heitzig, Marwan and Kurths 2013, Nature Physics 9, 89-92.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.limit_cycles.field import Field
from squealbox.limit_cycles.starting import GUESS_RTOL, steady_state
from squealbox.limit_cycles.variation import fly
from squealbox.parameters import ParameterError
from squealbox.result import COMPLETED, Outcome, Result, quantity
from squealbox.stability import complex_modes
from squealbox.system import System, as_system

FinalSwings = Callable[[System, Any, float], Any]
LAST = 0.1  # share of a run by whose swing it is judged
RAN = 0.05  # share of the sliding speed; a last swing above it is a vibration


@dataclass(frozen=True, kw_only=True, eq=False)
class Basin(Result):
    """Starts and what became of them, as :func:`basin` returns it."""

    start: Any = quantity("start state", "m", "starts (q, q'), displacements in m and velocities in m/s")
    swing: Any = quantity("start", "m/s", "half peak to peak of the fastest velocity at the end; NaN = run failed")
    vibrates: Any = quantity("start", "1", "True where the run ends in a vibration")
    share: Any = quantity("", "1", "share of the starts that vibrate")
    interval: Any = quantity("end", "1", "Wilson interval of that share, 95 %")

    def summary(self) -> str:
        """One line: the share with its interval."""
        low, high = self.interval
        share = f"{100 * float(self.share):.1f} % of {len(self.swing)} starts vibrate"
        return f"{share} ({100 * low:.1f} to {100 * high:.1f} %)"

    def __repr__(self) -> str:
        return self.summary()


def final_swings(system: System, starts: Any, duration: float) -> Any:
    """Half peak to peak of the fastest velocity [m/s] in the last part of each run; NaN where a run failed."""
    field = Field(system)
    swings = []
    for start in starts:
        instants = np.linspace((1.0 - LAST) * duration, duration, 400)
        run = fly(field, start, duration, GUESS_RTOL, instants)
        swings.append(0.5 * float(np.max(np.ptp(run.qd, axis=0))) if run.outcome.ok else np.nan)
    return np.array(swings)


def basin(
    design_or_system: Any,
    spread: Any,
    starts: int = 100,
    *,
    duration: float | None = None,
    seed: int = 1,
    plane: Sequence[int] | None = None,
    run: FinalSwings = final_swings,
) -> Basin:
    """What becomes of `starts` starts in a box of half widths `spread` about steady sliding.

    Parameters
    ----------
    design_or_system : a design or a `System` with constant loads and speeds
    spread : half widths, shape (2n,): displacements [m] and velocities [m/s]
    starts : number of starts, a Sobol sequence with `seed`; with `plane`, about that many on a square grid
    duration : [s] of each run; None takes 200 periods of the slowest mode
    plane : two places in the state (q, q'), for a picture of the plane through steady sliding
    run : function of system, starts (k, 2n) and duration that returns the last swings; for an engine of your own

    Outcome "completed", "failed_runs" (some runs failed; they count as vibrating) or "no_sliding".

    >>> from squealbox import DrumBrake, LinearSlope
    >>> basin(DrumBrake(friction=LinearSlope(0.3, -0.05)), [1e-6, 1e-6, 0.0, 0.0], 4).share
    array(0.)
    """
    system = as_system(design_or_system)
    field = Field(system)
    half = np.asarray(spread, dtype=float)
    if half.shape != (2 * field.size,) or not np.all(np.isfinite(half)) or np.any(half < 0.0):
        raise ParameterError("basin", "spread", spread, f"{2 * field.size} half widths of at least 0")
    centre = steady_state(field)
    points = np.zeros((0, 2 * field.size))
    if np.all(np.isfinite(centre)):
        points = centre + half * _unit_starts(2 * field.size, starts, seed, plane)
    length = 200.0 * _slowest(system) if duration is None else duration
    swings = run(system, points, length) if len(points) else np.zeros(0)
    vibrates = ~(swings <= RAN * float(np.max(np.abs(field.V), initial=0.0)))
    share, interval = wilson(int(np.sum(vibrates)), len(vibrates))
    settings = {"spread": half.tolist(), "duration": length, "seed": seed}
    return Basin(inputs={"system": system}, settings=settings, outcome=_outcome(swings), start=points, swing=swings,
                 vibrates=vibrates, share=np.asarray(share), interval=interval)  # fmt: skip


def dangerous_push(
    design_or_system: Any,
    direction: Any,
    bounds: tuple[float, float],
    *,
    duration: float | None = None,
    steps: int = 30,
) -> float:
    """The least multiple of `direction` (2n,) between `bounds` that ends in a vibration; NaN if none does.

    By bisection. A basin boundary may be folded: this is the first one bisection meets, not proven to be the least.
    """
    system = as_system(design_or_system)
    field = Field(system)
    centre, along = steady_state(field), np.asarray(direction, dtype=float)
    length = 200.0 * _slowest(system) if duration is None else duration
    limit = RAN * float(np.max(np.abs(field.V), initial=0.0))

    def vibrates(size: float) -> bool:
        return not bool(final_swings(system, [centre + size * along], length)[0] <= limit)

    low, high = bounds
    if vibrates(low):
        return float(low)
    if not vibrates(high):
        return float("nan")
    for _ in range(steps):
        middle = 0.5 * (low + high)
        low, high = (low, middle) if vibrates(middle) else (middle, high)
    return float(high)


def wilson(successes: int, count: int) -> tuple[float, Any]:
    """Share and its 95 % Wilson interval, shape (2,); NaN without a count."""
    if count == 0:
        return float("nan"), np.full(2, np.nan)
    z, p = 1.959963984540054, successes / count
    middle = (p + z**2 / (2 * count)) / (1.0 + z**2 / count)
    half = z * np.sqrt(p * (1.0 - p) / count + z**2 / (4.0 * count**2)) / (1.0 + z**2 / count)
    return p, np.array([max(middle - half, 0.0), min(middle + half, 1.0)])


def _unit_starts(size: int, starts: int, seed: int, plane: Sequence[int] | None) -> Any:
    """Points of the cube [-1, 1]^size."""
    if plane is not None:
        side = np.linspace(-1.0, 1.0, max(2, round(np.sqrt(starts))))
        out = np.zeros((side.size**2, size))
        out[:, plane[0]], out[:, plane[1]] = (x.ravel() for x in np.meshgrid(side, side))
        return out
    from scipy.stats import qmc

    power = int(np.ceil(np.log2(max(starts, 2))))
    return 2.0 * qmc.Sobol(size, seed=seed).random_base2(power)[:starts] - 1.0


def _slowest(system: System) -> float:
    frequencies = np.asarray(complex_modes(system).frequency)
    moving = frequencies[frequencies > 0.0]
    return float(1.0 / np.min(moving)) if moving.size else 1.0


def _outcome(swings: Any) -> Outcome:
    if len(swings) == 0:
        return Outcome("no_sliding", "there is no steady sliding to start about")
    failed = int(np.sum(~np.isfinite(swings)))
    if failed:
        return Outcome("failed_runs", f"{failed} of {len(swings)} runs did not reach their end", failed=failed)
    return Outcome(COMPLETED)
