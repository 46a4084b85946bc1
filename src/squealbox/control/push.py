"""The push that defeats a loop with a limited force: stable near steady sliding, and beaten by a knock.

Pushes along one direction, each followed until the motion has clearly died down or grown; between the largest that is
kept and the smallest that is not lies the stable side of an unstable cycle, found by halving in the logarithm.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import public
from squealbox.control.closed_loops import closed_loop
from squealbox.control.plants import with_loops
from squealbox.loops import Loop
from squealbox.parameters import ParameterError
from squealbox.result import COMPLETED, Array, Outcome, Result, quantity
from squealbox.stability import complex_modes
from squealbox.system import DesignOrSystem, equilibrium
from squealbox.transient import simulate

PERIODS, LONGEST = 40, 16  # of the pushed mode in one run, and longer ones before it counts as not dying down
DEAD, GROWN = 0.3, 1.0 / 0.3  # of the first amplitude: where a motion has clearly died down, or grown
FIRST, DOUBLINGS = 1e-3, 40  # the first push, over the speed at which the force reaches its limit, and how many more


@dataclass(frozen=True, kw_only=True, eq=False)
class DefeatingPush(Result):
    """Between which pushes a limited loop is beaten, as :func:`defeating_push` returns it.

    Outcome "completed"; "unstable" when it is not even stable near steady sliding; "no_danger" when nothing tried beats
    it; "no_edge" when the least that was tried does; "failed_run" when a motion ended early, and so told nothing.
    """

    kept: Any = quantity("", "m/s", "largest push that still dies down")
    defeated: Any = quantity("", "m/s", "smallest push that does not")
    amplitude: Array = quantity("dof", "m", "of the motion between the two, near the unstable cycle")
    direction: Array = quantity("dof", "1", "velocities of a push of 1 m/s")
    runs: int = 0

    @property
    def push(self) -> float:
        """The push at the edge [m/s]."""
        return float(np.sqrt(self.kept * self.defeated))

    def summary(self) -> str:
        """The edge, and the amplitude there."""
        if not self.outcome.ok:
            return self.outcome.told
        return (
            f"defeated by pushes above {self.push:.6g} m/s; the motion at the edge has an amplitude of "
            f"{float(np.max(self.amplitude)):.6g} m ({self.runs} runs)"
        )


@public()
def defeating_push(
    design_or_system: DesignOrSystem, direction: ArrayLike | None = None, *, precision: float = 1e-3, rtol: float = 1e-9
) -> DefeatingPush:
    """The smallest push that defeats the limited loops of a brake that is stable with them near steady sliding.

    Parameters
    ----------
    design_or_system : `Controlled(brake, loops)` with a `limit` on some loop
    direction : velocities (n,) of the brake's freedoms; None takes the mode that grows fastest without the loops
    precision : [-] relative distance of the two pushes between which the edge lies
    rtol : [-] of the motions

    >>> from squealbox import PID, System
    >>> block = System([[1.0]], [[-0.1]], [[1.0]], loops=(PID(on="q1", derivative=0.3, limit=0.01),))
    >>> 0.1255 < defeating_push(block, precision=1e-2).push < 0.1265
    True
    """
    system = with_loops(design_or_system)
    limits = [loop for loop in system.loops if loop.limit is not None]
    if not limits:
        raise ParameterError(
            "defeating_push", "loops", len(system.loops), "a loop with a limit: others no push defeats"
        )
    if not (0.0 < precision < 1.0):
        raise ParameterError("defeating_push", "precision", precision, "a number in (0, 1)")
    bare, n = system.replace(loops=()), system.size
    worst = complex_modes(bare).most_unstable
    shape = np.real(worst.shape)[:n] if direction is None else np.asarray(direction, dtype=float)
    if shape.shape != (n,) or not np.all(np.isfinite(shape)) or not np.any(shape):
        raise ParameterError("defeating_push", "direction", direction, f"{n} velocities, one of them not 0")
    shape = shape / np.max(np.abs(shape))
    nothing: dict[str, Any] = {
        "kept": np.asarray(np.nan),
        "defeated": np.asarray(np.nan),
        "amplitude": np.full(n, np.nan),
    }
    common: dict[str, Any] = {
        "direction": shape,
        "inputs": {"system": design_or_system},
        "settings": {"precision": precision},
    }
    near = closed_loop(design_or_system)
    if not near.stable:
        message = f"it grows at {near.growth_rate:.6g} 1/s near steady sliding: any push defeats it"
        return DefeatingPush(**nothing, **common, outcome=Outcome("unstable", message))
    period = 1.0 / max(float(worst.frequency), 1e-300)
    search = _Pushed(design_or_system, equilibrium(bare).q, shape, period, rtol)
    first = FIRST * max(float(loop.limit or 0.0) / _gain(loop, system.names, shape, period) for loop in limits)
    low, high, outcome = search.bracket(first)
    while outcome.ok and search.failed.ok and high > low * (1.0 + precision):
        middle = float(np.sqrt(low * high))
        low, high = (low, middle) if search.grows(middle) else (middle, high)
    outcome = outcome if search.failed.ok else search.failed
    if not outcome.ok:
        return DefeatingPush(**nothing, **common, runs=search.runs, outcome=outcome)
    return DefeatingPush(
        kept=np.asarray(low), defeated=np.asarray(high), amplitude=search.amplitude, runs=search.runs, **common,
        outcome=Outcome(COMPLETED),
    )  # fmt: skip


def _gain(loop: Loop, names: tuple[str, ...], shape: np.ndarray, period: float) -> float:
    """Force per m/s of a vibration along the shape, near enough to begin with."""
    row = loop.controller(names)
    return float(np.abs(row.R @ shape) + np.abs(row.P @ shape) * period / (2.0 * np.pi)) or 1.0


class _Pushed:
    """Runs after pushes of one direction."""

    def __init__(self, brake: DesignOrSystem, rest: np.ndarray, shape: np.ndarray, period: float, rtol: float) -> None:
        self.brake, self.rest, self.shape, self.period, self.rtol = brake, rest, shape, period, rtol
        self.runs, self.amplitude, self.failed = 0, np.zeros(len(rest)), Outcome(COMPLETED)

    def bracket(self, first: float) -> tuple[float, float, Outcome]:
        """A push that dies down and twice it, which does not, from the first one tried."""
        upwards, push = not self.grows(first), first
        for _ in range(DOUBLINGS):
            before, push = push, push * (2.0 if upwards else 0.5)
            if self.grows(push) == upwards or not self.failed.ok:
                return min(before, push), max(before, push), Outcome(COMPLETED)
        if upwards:
            return push, push, Outcome("no_danger", f"no push up to {push:.4g} m/s defeats it")
        return push, push, Outcome("no_edge", f"pushes down to {push:.4g} m/s still defeat it")

    def grows(self, push: float) -> bool:
        """Whether the motion after a push does not die down."""
        n, length = len(self.rest), 2.0 * PERIODS * self.period
        for round_ in range(LONGEST):  # longer ones: what a controller remembers is no start that can be given
            count = 64 * PERIODS * (round_ + 1) + 1
            duration = length * (round_ + 1)
            motion = simulate(self.brake, duration, (self.rest, push * self.shape), count, rtol=self.rtol)
            self.runs += 1
            if motion.outcome == "not_finite":
                return True
            if not motion.outcome.ok:
                message = f"the motion after a push of {push:.6g} m/s ended early: {motion.outcome.message}"
                self.failed = Outcome("failed_run", message, push=push)
                return True
            away = motion.q[:, :n] - self.rest
            early, late = (np.ptp(away[part], axis=0) for part in (slice(0, 128), slice(-128, None)))
            share = float(np.max(late) / np.max(early))
            if share < DEAD:
                return False
            self.amplitude = 0.5 * np.ptp(away[len(away) // 4 : len(away) // 4 + 128], axis=0)
            if share > GROWN:
                return True
        return True
