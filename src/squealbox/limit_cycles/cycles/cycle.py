"""The result of a search for a limit cycle: one period of the motion, its Floquet multipliers, how it was found.

A disturbance of a cycle is multiplied by a Floquet multiplier once each period. One of them is 1 (a shift in time); the
cycle is stable when all others lie inside the unit circle. A sticking phase gives a multiplier 0. Where bodies are free
to move together, multipliers and motion are those beside that common motion, whose own two are 1 and left out.
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from squealbox.result import Array, Result, optional, quantity
from squealbox.system import System
from squealbox.words import sizes_told

BESIDE = 1e-3  # of a period: where a turning point is looked at once more
FURTHER = 3.0  # times what the trivial multiplier is off, by which others may be
NEUTRAL = 1e-8  # how far from the unit circle a multiplier is known not to lie on it


@dataclass(frozen=True, kw_only=True, eq=False)
class Cycle(Result):
    """A limit cycle, as :func:`shooting` and :func:`harmonic_balance` return it.

    Where the search failed the outcome says why ("no_cycle", "no_convergence", "steady_sliding", ...), its evidence
    holds the residual history and advice, and the arrays hold the last attempt.

    Accuracy: `error` is the method's own estimate, relative to the size of the motion.
    """

    period: Any = quantity("", "s", "period")
    t: Array = quantity("time", "s", "instants of one period")
    q: Array = quantity("time dof", "m", "displacement")
    qd: Array = quantity("time dof", "m/s", "velocity")
    sliding_velocity: Array = quantity("time contact", "m/s", "sliding velocity v = V - t.q'")
    mode: Array = quantity(
        "time contact", "1", "mode in which the instant is reached: +1 or -1 slip with sgn(v), 0 stick, 2 open"
    )
    multipliers: Array = quantity("multiplier", "1", "Floquet multipliers, the trivial one first")
    lowest: Array = quantity("dof", "m", "least displacement")
    highest: Array = quantity("dof", "m", "largest displacement")
    event_time: Array = quantity("event", "s", "instants of stick, slip and reversal")
    event_contact: Array = quantity("event", "1", "contact of each event")
    event_mode: Array = quantity("event", "1", "mode the contact takes at the event")
    memory: Array = optional(
        "state", "m", "what is remembered beside q and q' at the beginning: bristles, loops' states"
    )
    error: float = float("nan")
    caution: str = ""

    coordinates: ClassVar = {"time": "t", "event": "event_time"}
    table_over: ClassVar = ("time",)

    swept: ClassVar = {
        "period": ("", "s", "period"),
        "frequency": ("", "Hz", "1/period"),
        "amplitude": ("dof", "m", "half peak to peak"),
        "centre": ("dof", "m", "midway between the extremes"),
        "stable": ("", "1", "True when every multiplier but the trivial one lies inside the unit circle"),
        "sticking_time": ("contact", "s", "time in a period each contact sticks"),
        "multipliers": ("multiplier", "1", "Floquet multipliers, the trivial one first"),
    }

    @property
    def system(self) -> System:
        """The system that moves."""
        system: System = self.inputs["system"]
        return system

    @property
    def frequency(self) -> float:
        """1/period [Hz]."""
        return float(1.0 / self.period)

    @property
    def amplitude(self) -> Array:
        """Half peak to peak of each degree of freedom [m], shape (dof,)."""
        return 0.5 * (self.highest - self.lowest)

    @property
    def centre(self) -> Array:
        """Midway between the extremes of each degree of freedom [m], shape (dof,)."""
        return 0.5 * (self.highest + self.lowest)

    @property
    def stable(self) -> bool:
        """True when every multiplier but the trivial one lies inside the unit circle."""
        return self.stability == "stable"

    @property
    def stability(self) -> str:
        """As `stability_of` the multipliers but the trivial one; a neutral cycle is one of a family, or splits."""
        if not self.outcome.ok:
            return "unstable"
        return stability_of(self.multipliers[1:], float(np.abs(self.multipliers[0] - 1.0)))

    @property
    def sticking_time(self) -> Array:
        """Time in a period each contact sticks [s], shape (contact,)."""
        return np.sum((self.mode[1:] == 0) * np.diff(self.t)[:, None], axis=0)

    @property
    def start(self) -> tuple[Any, ...]:
        """(q, qd) at the beginning of the period, for `simulate`; (q, qd, z) with contacts whose law has memory."""
        count = sum(contact.law.has_memory for contact in self.system.contacts)
        return (self.q[0], self.qd[0], self.memory[-count:]) if count else (self.q[0], self.qd[0])

    def summary(self) -> str:
        """One line: period, frequency, amplitudes, stability."""
        if not self.outcome.ok:
            return self.outcome.told
        sizes = sizes_told(self.system.names, self.amplitude, self.system.units)
        said = (
            f"{self.stability} cycle, period {float(self.period):.10g} s ({self.frequency:.6g} Hz), amplitude {sizes}"
        )
        return self.warned([said])


def stability_of(multipliers: np.ndarray, error: float = 0.0) -> str:
    """One of stable, unstable, or neutral where the largest lies on the unit circle as far as it is known.

    `error` is by how much another multiplier, the trivial one, is seen to be off.
    """
    largest, known = float(np.max(np.abs(multipliers), initial=0.0)), max(NEUTRAL, FURTHER * error)
    return "stable" if largest < 1.0 - known else "neutral" if largest <= 1.0 + known else "unstable"


def ordered(multipliers: ArrayLike) -> Any:
    """Multipliers with the one nearest to 1 first, the others by falling size."""
    values = np.asarray(multipliers, dtype=complex)
    if not np.all(np.isfinite(values)):
        return values
    trivial = int(np.argmin(np.abs(values - 1.0)))
    others = np.delete(values, trivial)
    return np.r_[values[trivial], others[np.argsort(-np.abs(others), kind="stable")]]


def extremes(t: np.ndarray, q: np.ndarray, qd: np.ndarray) -> tuple[Any, Any]:
    """Least and largest displacement of each column, by the Hermite cubic of each interval; error of order h^4."""
    low, high = np.min(q, axis=0), np.max(q, axis=0)
    if len(t) < 2:
        return low, high
    for value, _ in _turning(t, q, qd):
        low, high = np.minimum(low, np.min(value, axis=0)), np.maximum(high, np.max(value, axis=0))
    return low, high


def _turning(t: np.ndarray, q: np.ndarray, qd: np.ndarray) -> Iterator[tuple[Any, Any]]:
    """Values and instants at which the Hermite cubics turn, the two of each interval; its beginning where none does."""
    h = np.diff(t)[:, None]
    a, v0, v1 = q[:-1], qd[:-1] * h, qd[1:] * h
    rise = np.diff(q, axis=0)
    c2, c3 = 3.0 * rise - 2.0 * v0 - v1, v0 + v1 - 2.0 * rise  # a + s (v0 + s (c2 + s c3))
    for sign in (1.0, -1.0):
        with np.errstate(all="ignore"):
            s = -v0 / (c2 + sign * np.sqrt(c2 * c2 - 3.0 * c3 * v0))
        s = np.where((s > 0.0) & (s < 1.0), s, 0.0)
        yield a + s * (v0 + s * (c2 + s * c3)), t[:-1, None] + s * h


def refined(
    at: Callable[[Any], tuple[Any, Any]], t: np.ndarray, q: np.ndarray, qd: np.ndarray, period: float
) -> tuple[Any, Any]:
    """As `extremes` of one period, looked at once more where its cubics turn: error of 1e-9 of the swing.

    at : gives displacements and velocities (k, n) at instants (k,)
    """
    values, instants = (
        np.vstack(each) for each in zip((q, np.tile(t[:, None], q.shape[1])), *_turning(t, q, qd), strict=True)
    )
    columns, found = np.arange(q.shape[1]), []
    where = [instants[pick(values, axis=0), columns] for pick in (np.argmin, np.argmax)]
    beside = np.array([-BESIDE, 0.0, BESIDE]) * period
    looked, speeds = at((np.concatenate(where)[:, None] + beside).ravel() % period)
    for k, end in enumerate((np.minimum, np.maximum)):
        rows = 3 * (k * len(columns) + columns)
        value, (v0, v1, v2) = looked[rows + 1, columns], (speeds[rows + i, columns] for i in range(3))
        c1, c2 = (v2 - v0) / (2.0 * beside[2]), (v0 - 2.0 * v1 + v2) / (2.0 * beside[2] ** 2)
        with np.errstate(all="ignore"):
            s = -2.0 * v1 / (c1 + np.copysign(np.sqrt(c1 * c1 - 4.0 * c2 * v1), c1))
        s = np.where(np.abs(s) <= beside[2], s, 0.0)
        found.append(end(value, value + s * (v1 + s * (0.5 * c1 + s * c2 / 3.0))))
    return found[0], found[1]
