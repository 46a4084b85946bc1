"""Newton's method on the shots of a cycle: motions first, their derivatives only where a step is taken from.

In states scaled to velocities.
"""

import functools
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.limit_cycles.cycles.differences import by_differences, derived
from squealbox.limit_cycles.cycles.field import Autonomous, Field
from squealbox.limit_cycles.cycles.variation import Flight, fly
from squealbox.result import COMPLETED, Outcome
from squealbox.transient import Trajectory, is_small

HALVINGS = 6
KNOWN = 1e-9  # share of the largest singular value below which a derivative of the motion tells nothing
ROUND_OFF = 1e-14
CLOSE = 1e-6  # mismatch of a derivative that Newton's method may take
ADVICE = "give a start nearer to the cycle, a longer `settle`, or more `shots`"


@dataclass(frozen=True, eq=False)
class Shots:
    """Starts and period, the motions from them, the residual, the size of the motion and the residual over it [-]."""

    nodes: Any
    period: float
    motions: list[Trajectory]
    residual: Any = None
    size: float = 1.0
    norm: float = np.inf


class Newton:
    """Newton's method on the shots; keeps the history of the scaled residual and counts motions and derivatives."""

    def __init__(self, field: Autonomous, nodes: np.ndarray, period: float, rtol: float) -> None:
        self.field, self.nodes, self.period, self.rtol, self.size = field, nodes, period, rtol, 1.0
        self.reference = nodes[0].copy()
        self.history: list[float] = []
        self.flights: list[Flight] = []
        self.flown, self.derived = 0, 0

    def solve(self, tolerance: float, most: int) -> Outcome:
        """Iterate until the residual is below `tolerance` and no longer falls."""
        now = self._shoot(self.nodes, self.period)
        if not now.motions[-1].outcome.ok:
            return Outcome("no_convergence", f"a shot ended early: {now.motions[-1].outcome.message}", advice=ADVICE)
        normal = self._phase(now.motions[0])
        following: Shots | None = now
        for _ in range(most):
            if following is None:
                break
            self.history.append(now.norm)
            self.flights = self._derivatives(now)
            halvings = 0 if now.norm < tolerance else HALVINGS
            known = max(KNOWN, *(flight.mismatch for flight in self.flights))
            shares = (known, CLOSE, ROUND_OFF) if halvings else (known,)  # it may tell less, or more, than it seems
            tried = (self._damped(now, self._step(now, normal, least), halvings) for least in shares)
            following = next((each for each in tried if each is not None), None)
            now = now if following is None else following
        self.nodes, self.period, self.size = now.nodes, now.period, now.size
        self.flights = self._derivatives(now, last=True)
        if now.norm > tolerance or not np.isfinite(now.norm):
            message = f"Newton's method stopped at a scaled residual of {now.norm:.3g}: {ADVICE}"
            return Outcome("no_convergence", message, history=self.history, advice=ADVICE)
        return self._degenerate(now) or Outcome(COMPLETED, "", history=self.history)

    def _shoot(self, nodes: np.ndarray, period: float) -> Shots:
        motions = []
        for node in nodes:
            motions.append(fly(self.field, node, period / len(nodes), self.rtol))
            self.flown += 1
            if not motions[-1].outcome.ok:
                return Shots(nodes, period, motions)
        states = [np.hstack([m.q, m.qd]) for m in motions]
        residual = np.roll(nodes, -1, axis=0) - np.array([x[-1] for x in states])
        scale = self.field.scale
        size = float(np.max(np.ptp(np.vstack(states), axis=0) * scale)) or 1.0
        return Shots(nodes, period, motions, residual, size, float(np.max(np.abs(residual * scale))) / size)

    def _derivatives(self, now: Shots, last: bool = False) -> list[Flight]:
        self.derived += len(now.nodes)
        duration = now.period / len(now.nodes)
        pairs = zip(now.nodes, now.motions, strict=True)
        return [self._derivative(node, duration, motion, last) for node, motion in pairs]

    def _derivative(self, x: np.ndarray, duration: float, motion: Trajectory, last: bool) -> Flight:
        """Quickly on the way to the cycle, where that tells the derivative well enough."""
        if not last and isinstance(self.field, Field) and is_small(self.field.held_fast):
            near = by_differences(self.field, x, duration, self.rtol, motion=motion)
            if near.mismatch < CLOSE:
                return near
        return derived(self.field, x, duration, self.rtol, motion=motion)

    def _phase(self, motion: Trajectory) -> Any:
        normal = self.field.rate(self.reference, motion.mode[0]) * self.field.scale
        return normal / np.linalg.norm(normal)

    def _step(self, now: Shots, normal: np.ndarray, least: float) -> Any:
        """Newton step (k 2n + 1,), in scaled states and the share of the period; none along what changes so little.

        Along a family of cycles the derivative tells nothing but its own error.
        """
        k, size = now.nodes.shape
        scale = self.field.scale
        matrix = np.zeros((k * size + 1, k * size + 1))
        for i, f in enumerate(self.flights):
            rows = slice(i * size, (i + 1) * size)
            after = (i + 1) % k
            matrix[rows, after * size : (after + 1) * size] += np.eye(size)
            matrix[rows, rows] -= f.phi * (scale[:, None] / scale)
            matrix[rows, -1] = -f.rate * scale * now.period / k
        matrix[-1, :size] = normal
        right = np.append((now.residual * scale).ravel(), normal @ ((now.nodes[0] - self.reference) * scale))
        weight = np.max(np.abs(matrix[:, -1])) or 1.0
        matrix[:, -1] /= weight
        step = np.linalg.lstsq(matrix, -right, rcond=least)[0]
        step[-1] /= weight
        return step

    def _damped(self, now: Shots, step: np.ndarray, most_halvings: int) -> Shots | None:
        """The first of the step, its half, its quarter ... that lowers the residual; None when none does."""
        share = min(1.0, 0.3 / max(abs(step[-1]), 1e-300))
        for _ in range(most_halvings + 1):
            nodes = now.nodes + share * step[:-1].reshape(now.nodes.shape) / self.field.scale
            trial = self._shoot(nodes, now.period * (1.0 + share * step[-1]))
            if trial.norm < now.norm:
                return trial
            share *= 0.5
        return None

    def _degenerate(self, now: Shots) -> Outcome | None:
        speed = max(float(np.ptp(m.qd, axis=0).max()) for m in now.motions)
        reference = float(np.max(np.abs(self.field.V), initial=0.0)) or 1.0
        if speed > 1e-9 * reference:
            return None
        return Outcome("steady_sliding", "the shots met on steady sliding, not on a cycle", history=self.history)


def monodromy(flights: list[Flight]) -> Any:
    """The derivative of the flow over one flight after the other, (2n, 2n)."""
    return functools.reduce(lambda total, flight: flight.phi @ total, flights[1:], flights[0].phi)


def nodes_along(field: Autonomous, x: np.ndarray, period: float, shots: int, rtol: float) -> Any:
    """Starts of the shots, along the motion from x."""
    if shots == 1:
        return x[None].copy()
    run = fly(field, x, period, rtol, np.linspace(0.0, period, shots + 1))
    return np.hstack([run.q, run.qd])[:shots]
