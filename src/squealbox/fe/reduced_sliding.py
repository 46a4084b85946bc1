"""Steady sliding of a reduced brake and its linearisation from tables of contacts: no `Contact` is made, none asked.

Sums D' diag(w) [N, N0] over thousands of contacts are taken once, at the reference; at other values of friction only
the contacts that have opened or closed since, or whose weight does not follow the others', are added or taken away.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from squealbox.fe.small import Small
from squealbox.friction import Table
from squealbox.law import FrictionLaw
from squealbox.static_deflection import ended
from squealbox.system import Equilibrium

ALIKE = 1e-14  # of the largest weight: two weights are the same to round-off
STEP = 1e-12  # change of the normal forces, relative to them, at which the set of open contacts has settled


@dataclass
class WeightedSum:
    """left' diag(weight) right of rows (contacts, m) and (contacts, k), kept for the last weights asked for."""

    left: Any
    right: Any
    weight: Any = None
    value: Any = None

    def at(self, weight: np.ndarray) -> Any:
        """The sum for weights (contacts,), from the last one where few weights have changed but for a common factor."""
        if self.value is not None:
            both = (self.weight != 0.0) & (weight != 0.0)
            factor = float(np.median(weight[both] / self.weight[both])) if np.any(both) else 1.0
            change = weight - factor * self.weight
            rows = np.flatnonzero(np.abs(change) > ALIKE * np.max(np.abs(weight), initial=0.0))
            if len(rows) < 0.5 * np.count_nonzero(weight):
                self.value = factor * self.value + self._over(rows, change)
                self.weight = weight
                return self.value
        self.weight, self.value = weight, self._over(np.flatnonzero(weight), weight)
        return self.value

    def _over(self, rows: np.ndarray, weight: np.ndarray) -> Any:
        return (self.left[rows] * weight[rows, None]).T @ self.right[rows]


@dataclass(frozen=True, eq=False)
class Sums:
    """What all values of friction share: the sums of closed and of open contacts, and the rows across in single."""

    pushing: WeightedSum
    lifting: WeightedSum | None
    across: Any


def sums_of(rows: dict[str, Any], unilateral: np.ndarray, *, added: bool = True) -> Sums:
    """The sums of the contacts that press at q = 0, for mu = 1; not `added` up yet where they serve one value alone."""
    pressed = np.concatenate([rows["n"], rows["N0"][:, None]], axis=1)
    pushing, closed = WeightedSum(rows["d"], pressed), (rows["N0"] > 0.0) | ~unilateral
    lifting = None if rows["normal"] is None else WeightedSum(rows["normal"], pressed)
    if added:
        pushing.at(np.where(closed, np.sign(rows["V"]), 0.0))
        if lifting is not None:
            lifting.at(np.where(closed, 0.0, 1.0))
    across = None if rows["across"] is None else np.asarray(rows["across"], dtype=np.float32)
    return Sums(pushing, lifting, across)


def steady_small(
    rows: dict[str, Any], law: FrictionLaw, unilateral: np.ndarray, sums: Sums | None = None
) -> tuple[Small, Equilibrium] | None:
    """M, C_eff, K_eff and steady sliding; None where there is none that is settled, or the law has memory, is a
    family of laws, or leaves its range: then the general road answers, and says so.

    rows holds the fields of a `Reduction` at one value of each parameter, sums those of the same n, d, normal, across
    and N0.
    """
    if law.has_memory or any(np.ndim(value) for value in law.coefficients()):
        return None
    speed, preload, n = rows["V"], rows["N0"], rows["n"]
    mu = np.broadcast_to(law.mu(speed), speed.shape)
    if np.any(mu < 0.0) or (isinstance(law, Table) and np.max(np.abs(speed)) > np.max(law.speeds)):
        return None  # the general road says what is wrong with the law
    drag = mu * np.sign(speed)
    sums = sums_of(rows, unilateral, added=False) if sums is None else sums
    pushing, lifting = replace(sums.pushing), None if sums.lifting is None else replace(sums.lifting)
    q, normal = np.zeros(len(rows["load"])), preload
    settled = False
    for _ in range(2 + 2 * len(speed)):
        closed = (normal > 0.0) | ~unilateral
        pressed = pushing.at(np.where(closed, drag, 0.0))
        if lifting is not None:
            pressed = pressed + lifting.at(np.where(closed, 0.0, 1.0))
        stiffness = rows["K"] - pressed[:, :-1]
        residual = stiffness @ q - rows["load"] - pressed[:, -1]
        try:
            step = np.linalg.solve(stiffness, residual)
        except np.linalg.LinAlgError:
            return None
        q = q - step
        before, normal = normal, preload + n @ q
        same = np.array_equal((normal > 0.0) | ~unilateral, closed)
        if (same and np.linalg.norm(normal - before) <= STEP * np.linalg.norm(normal)) or not np.any(unilateral):
            settled = True
            break
    if not settled or np.any(speed == 0.0):
        return None
    force = np.where(closed, normal, 0.0)
    damping = rows["C"]
    slope = np.broadcast_to(law.direct_slope(speed), speed.shape)
    if np.any(slope):
        damping = damping + (rows["d"] * (force * slope)[:, None]).T @ rows["t"]
    if sums.across is not None:  # in single precision: damping is a thousandth of |lambda|
        damping = damping + _square(sums.across, (force * mu / np.abs(speed)).astype(np.float32))
    outcome = ended(np.array(False), np.array(True), np.array(True), speed)
    state = Equilibrium(q, force, speed, np.array(mu), np.array(True), outcome, np.array(0))
    return Small(rows["M"], damping, stiffness), state


def untouched(rows: dict[str, Any]) -> tuple[Small, Equilibrium] | None:
    """M, C, K and the deflection of a brake whose friction is in its matrices; None where K is singular."""
    try:
        q = np.linalg.solve(rows["K"], rows["load"])
    except np.linalg.LinAlgError:
        return None
    nothing, yes = np.zeros(0), np.array(True)
    outcome = ended(np.array(False), yes, yes, nothing)
    return Small(rows["M"], rows["C"], rows["K"]), Equilibrium(q, nothing, nothing, nothing, yes, outcome, np.array(0))


def without_friction(rows: dict[str, Any], unilateral: np.ndarray, small: Small, state: Equilibrium) -> tuple[Any, Any]:
    """C with the damping across the sliding direction, and the symmetric part of K less open contacts, (m, m) each.

    Of what `steady_small` found; friction's stiffness is in neither.
    """
    closed = (state.normal_force > 0.0) | ~unilateral
    drag = np.where(closed, state.friction * np.sign(state.sliding_speed), 0.0)
    elastic = small.K + (rows["d"] * drag[:, None]).T @ rows["n"]
    turning = state.normal_force * state.friction / np.abs(state.sliding_speed)
    damping = rows["C"] if rows["across"] is None else rows["C"] + _square(rows["across"], turning)
    return damping, 0.5 * (elastic + elastic.T)


def _square(rows: np.ndarray, weight: np.ndarray) -> Any:
    """A' diag(w) A for w >= 0, by a product that knows it is symmetric."""
    if np.any(weight < 0.0):
        return (rows * weight[:, None]).T @ rows
    scaled = rows * np.sqrt(weight)[:, None]
    return scaled.T @ scaled
