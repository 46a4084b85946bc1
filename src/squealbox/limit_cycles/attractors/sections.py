"""Poincare sections: where a motion passes a plane of the state space, and what is read there.

A plane is normal.(q, q') = offset. The maxima of a degree of freedom lie in the plane where its velocity falls through
zero. A plane on which a motion stays for a while, as on v = 0 while a contact sticks, is passed where it is reached.
Source: Parker and Chua 1989, Practical Numerical Algorithms for Chaotic Systems, Ch. 2 (its method, on the Hermite
cubic of each interval of output).
"""

from dataclasses import dataclass
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.parameters import ParameterError, known_names
from squealbox.schedules import value_at
from squealbox.system import System
from squealbox.transient import Trajectory

ON = 1e-9  # of the largest distance from a plane: nearer is on it
BISECTIONS = 50


def maxima(motion: Trajectory, dof: int = 0) -> tuple[Any, Any]:
    """Instants [s] and displacements [m], each (k,), of the maxima of one degree of freedom: its Poincare section.

    Found on the Hermite cubic of each interval of output, with an error of order 4 in it.

    >>> from squealbox import DrumBrake, simulate
    >>> len(maxima(simulate(DrumBrake(), 1e-3, times=2001))[0]) > 1
    True
    """
    t, x, v = motion.t, motion.q[:, dof], motion.qd[:, dof]
    i = np.flatnonzero((v[:-1] > 0.0) & (v[1:] <= 0.0))
    h, rise = t[i + 1] - t[i], x[i + 1] - x[i]
    a, b = h * (v[i] + v[i + 1]) - 2.0 * rise, 3.0 * rise - h * (2.0 * v[i] + v[i + 1])
    s = -h * v[i] / (b - np.sqrt(np.maximum(b * b - 3.0 * a * h * v[i], 0.0)))
    return t[i] + s * h, x[i] + s * (h * v[i] + s * (b + s * a))


def poincare_section(
    motion: Trajectory, normal: ArrayLike, offset: float = 0.0, *, direction: int = 1
) -> tuple[Any, Any]:
    """Instants [s] and states (k, 2n) at which normal.(q, q') passes offset: a Poincare section on any plane.

    Parameters
    ----------
    motion : with enough instants of output: error of order 4 in their distance in q, of order 3 in q'; of order 2
        where an event lies between two of them
    normal : (2n,), weights of displacements and velocities
    offset : where the plane lies, in the unit of the product
    direction : +1 only where the product rises through offset, -1 only where it falls, 0 both

    Raises `ParameterError` for a normal of another length, or zero. Source: as this module.

    >>> from squealbox import DrumBrake, simulate
    >>> motion = simulate(DrumBrake(), 1e-3, times=2001)
    >>> instants, states = poincare_section(motion, [0.0, 0.0, 1.0, 0.0], direction=-1)  # x' falls through zero
    >>> bool(abs(states[0, 2]) < 1e-12), states.shape[1]
    (True, 4)
    """
    n = motion.q.shape[1]
    weights = np.asarray(normal, dtype=float)
    if weights.shape != (2 * n,) or not np.all(np.isfinite(weights)) or not np.any(weights):
        raise ParameterError("poincare_section", "normal", normal, f"{2 * n} finite weights, not all zero")
    _, instants, states = passages(motion.t, motion.q[None], motion.qd[None], weights[None], [offset], direction)
    return instants, states


def passages(
    t: np.ndarray, q: np.ndarray, qd: np.ndarray, normal: np.ndarray, offset: ArrayLike, direction: int
) -> tuple[Any, Any, Any]:
    """(index of the motion, instant, state) of each passage in order, of q, qd (m, k, n) through normal (m, 2n)."""
    states, offset = np.concatenate([q, qd], axis=-1), np.asarray(offset, dtype=float)
    beside = np.einsum("mki,mi->mk", states, normal) - offset[:, None]
    on = ON * np.max(np.abs(beside), axis=1, keepdims=True, initial=0.0)
    before, after = beside[:, :-1], beside[:, 1:]
    falls, rises = (before > on) & (after <= on), (before < -on) & (after >= -on)
    which, i = np.nonzero({1: rises, -1: falls}.get(int(direction), rises | falls))
    side, near, weights = np.sign(beside[which, i]), on[which, 0], normal[which]
    landed = (np.abs(beside[which, i + 1]) <= near) & (i > 0)  # an event on the plane: from before it, extrapolated
    first = i - landed
    ends, h = (states[which, first], states[which, first + 1]), t[first + 1] - t[first]
    low, high = 1.0 * landed, 1.0 + landed
    for _ in range(BISECTIONS):  # of all passages at once
        middle = 0.5 * (low + high)
        early = side * (np.sum(_between(ends, h, middle) * weights, axis=1) - offset[which]) > 0.0
        low, high = np.where(early, middle, low), np.where(early, high, middle)
    return which, t[first] + high * h, _between(ends, h, high)


def _between(ends: tuple[Any, Any], h: np.ndarray, share: np.ndarray) -> Any:
    """States (k, 2n) at shares of intervals h between two states: the Hermite cubic of q, and its derivative."""
    (first, last), n, s, h = ends, ends[0].shape[1] // 2, share[:, None], h[:, None]
    q, v, rise, w = first[:, :n], h * first[:, n:], last[:, :n] - first[:, :n], h * last[:, n:]
    b, a = 3.0 * rise - 2.0 * v - w, v + w - 2.0 * rise
    return np.hstack([q + s * (v + s * (b + s * a)), (v + s * (2.0 * b + s * 3.0 * a)) / h])


@dataclass(frozen=True)
class Section:
    """A Poincare section by names: `read` is what is drawn where `where` passes `level` in a `direction`.

    read : a displacement or a velocity of the system: "y" or "y'"
    where : a displacement, counted from steady sliding; a velocity; or "v1", "v2" ..., sliding velocity of a contact
    level : [m] or [m/s]
    direction : +1 where it rises, -1 where it falls, 0 both

    >>> Section.maxima("y")
    Section(read='y', where="y'", level=0.0, direction=-1)
    """

    read: str
    where: str
    level: float = 0.0
    direction: int = -1

    @classmethod
    def maxima(cls, name: str) -> "Section":
        """The largest values of a displacement."""
        return cls(name, f"{name}'")

    @classmethod
    def minima(cls, name: str) -> "Section":
        """The least values of a displacement."""
        return cls(name, f"{name}'", direction=1)

    @classmethod
    def returns(cls, name: str) -> "Section":
        """The velocities at which a displacement rises through steady sliding: a return map."""
        return cls(f"{name}'", name, direction=1)

    def __str__(self) -> str:
        verb = {1: "rises through", -1: "falls through"}.get(self.direction, "passes")
        if self.level == 0.0 and self.where == f"{self.read}'" and self.direction:
            return f"{self.read} at its {'maxima' if self.direction < 0 else 'minima'}"
        level = "steady sliding" if self.level == 0.0 and not self.where.endswith("'") else f"{self.level:g}"
        level = "0" if self.where.startswith("v") and self.level == 0.0 else level
        return f"{self.read} where {self.where} {verb} {level}"

    def column(self, system: System) -> int:
        """Place of `read` in (q, q')."""
        return _place("read", self.read, state_names(system))

    def plane(self, system: System, rest: np.ndarray) -> tuple[Any, Any]:
        """normal (..., 2n) and offset (...) beside steady sliding, rest (..., n)."""
        names, n, shape = state_names(system), system.size, np.shape(rest)[:-1]
        contacts = [f"v{i + 1}" for i in range(len(system.contacts))]
        normal = np.zeros((*shape, 2 * n))
        if self.where in contacts and self.where not in names:
            contact = system.contacts[contacts.index(self.where)]
            normal[..., n:] = -np.asarray(contact.t)
            return normal, self.level - np.broadcast_to(np.asarray(value_at(contact.V, 0.0), dtype=float), shape)
        column = _place("where", self.where, [*names, *contacts])
        normal[..., column] = 1.0
        return normal, self.level + (rest[..., column] if column < n else np.zeros(shape))


def _place(key: str, name: str, names: list[str]) -> int:
    if name not in names:
        raise ParameterError("Section", key, name, known_names(str(name), names))
    return names.index(name)


def state_names(system: System) -> list[str]:
    """Names of the state (q, q'): those of the degrees of freedom, then with a prime."""
    return [*system.names, *(f"{name}'" for name in system.names)]
