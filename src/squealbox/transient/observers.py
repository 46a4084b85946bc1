"""What is kept of a trajectory that is not stored: numbers brought up to date with every step, inside the kernel.

An observer is a plain function ``update(memory, p, before, after) -> memory`` of the step just taken. It sees one
degree of freedom (`before.t`, `.q`, `.qd`, `.qdd`), one contact (`.t`, `.velocity`, `.normal`, `.mode`, `.work`) or the
whole system (tuples `.q`, `.qd`, `.qdd`), and it is compiled together with the equation of motion. So it uses only
arithmetic, comparisons, ``abs``, the NumPy functions where, minimum, maximum, sqrt, exp, log, sin, cos, arctan and
tanh, and `extreme`. p[0] is the instant [s] from which it looks; its own `settings` follow.
"""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from squealbox.parameters import ParameterError, known_names

Memory = tuple[Any, ...]


class Watch(NamedTuple):
    """The part of an observer a kernel is compiled for."""

    update: Callable[..., Any]
    start: tuple[float, ...]
    of: str
    coefficients: int

    def copies(self, n: int, m: int) -> int:
        """How many of it run: one for each degree of freedom or contact, or one."""
        return {"dof": n, "contact": m, "system": 1}[self.of]

    @property
    def width(self) -> int:
        """Numbers each of them leaves in a row of results: its memory and its coefficients."""
        return len(self.start) + self.coefficients


@dataclass(frozen=True)
class Observer:
    """A number, or several, computed while a trajectory runs.

    name : what the result calls it
    update : plain function of (memory, p, before, after) that returns the new memory, a tuple
    start : the memory at the start of a trajectory
    of : "dof", "contact" or "system"
    finish : NumPy function of the memory, an array (..., len(start)), that returns (...) or (..., k); None takes
        memory[..., 0]
    last : share of the duration, at its end, over which it looks
    settings : further numbers, p[1], p[2], ...
    unit : of what it returns
    """

    name: str
    update: Callable[..., Any]
    start: tuple[float, ...]
    of: str = "dof"
    finish: Callable[[Any], Any] | None = None
    last: float = 1.0
    settings: tuple[float, ...] = ()
    unit: str = ""

    def __post_init__(self) -> None:
        if self.of not in ("dof", "contact", "system"):
            raise ParameterError("Observer", "of", self.of, '"dof", "contact" or "system"')
        if not 0.0 < self.last <= 1.0:
            raise ParameterError("Observer", "last", self.last, "a share of the duration in (0, 1]")

    def watch(self) -> Watch:
        """What a kernel is compiled for."""
        return Watch(self.update, tuple(float(x) for x in self.start), self.of, 1 + len(self.settings))

    def value(self, memory: Any) -> Any:
        """What the memory says."""
        return memory[..., 0] if self.finish is None else self.finish(memory)


def extreme(before: Any, after: Any) -> Any:
    """(whether q' changes sign in the step, the instant, q there); the end of the step where it does not.

    q' is the cubic of q' and q'' at both ends, q the quintic of all six values; the instant is found by the secant and
    two Newton steps. Observers may call it.
    """
    h = after.t - before.t
    turns = before.qd * after.qd < 0.0
    x = np.where(turns, before.qd / np.where(turns, before.qd - after.qd, 1.0), 1.0)
    v, a = before.qd * h, before.qdd * h * h
    rise, turn, bend = after.q - before.q - v - 0.5 * a, after.qd * h - v - a, after.qdd * h * h - a
    c3 = 10.0 * rise - 4.0 * turn + 0.5 * bend
    c4 = -15.0 * rise + 7.0 * turn - bend
    c5 = 6.0 * rise - 3.0 * turn + 0.5 * bend
    for _ in range(2):
        slope = v + x * (a + x * (3.0 * c3 + x * (4.0 * c4 + x * 5.0 * c5)))
        bent = a + x * (6.0 * c3 + x * (12.0 * c4 + x * 20.0 * c5))
        step = slope / np.where(abs(bent) > 0.0, bent, 1.0)
        x = np.where(turns, np.minimum(np.maximum(x - step, 0.0), 1.0), 1.0)
    q = before.q + x * (v + x * (0.5 * a + x * (c3 + x * (c4 + x * c5))))
    return turns, before.t + x * h, q


def amplitude_update(memory: Any, p: Any, before: Any, after: Any) -> Memory:
    """Largest and least q from p[0] on, with the extreme inside a step where q' changes sign."""
    _, at, inside = extreme(before, after)
    seen, within = after.t > p[0], at > p[0]
    high = np.where(seen, np.maximum(memory[0], after.q), memory[0])
    low = np.where(seen, np.minimum(memory[1], after.q), memory[1])
    return (np.where(within, np.maximum(high, inside), high), np.where(within, np.minimum(low, inside), low))


def amplitude(last: float = 0.2) -> Observer:
    """Half the range of each degree of freedom over the last part of the run [m]."""
    return Observer("amplitude", amplitude_update, (-np.inf, np.inf), "dof", _half_range, last, unit="m")


def _half_range(memory: Any) -> Any:
    return 0.5 * (memory[..., 0] - memory[..., 1])


def peak_update(memory: Any, p: Any, before: Any, after: Any) -> Memory:
    """Largest |q| at both ends of the step and at an extreme inside it."""
    _, _, inside = extreme(before, after)
    return (np.maximum(memory[0], np.maximum(np.maximum(abs(before.q), abs(after.q)), abs(inside))),)


def peak() -> Observer:
    """Largest |q| of each degree of freedom over the whole run, its start included [m]."""
    return Observer("peak", peak_update, (0.0,), "dof", None, 1.0, unit="m")


def frequency_update(memory: Any, p: Any, before: Any, after: Any) -> Memory:
    """Number of maxima of q from p[0] on, and the instants of the first and the last."""
    turns, at, _ = extreme(before, after)
    falls = turns & (before.qd > 0.0) & (before.t >= p[0])
    first = np.where(falls & (memory[0] < 0.5), at, memory[1])
    return (memory[0] + 1.0 * falls, first, np.where(falls, at, memory[2]))


def frequency(last: float = 0.2) -> Observer:
    """Mean frequency of the maxima of each degree of freedom over the last part [Hz]; NaN with fewer than two.

    It is the frequency of the squeal when one mode dominates; for a motion of several, take samples and their spectrum.
    """
    return Observer("frequency", frequency_update, (0.0, 0.0, 0.0), "dof", _rate_of_maxima, last, unit="Hz")


def _rate_of_maxima(memory: Any) -> Any:
    count, first, final = (memory[..., k] for k in range(3))
    several = (count >= 2.0) & (final > first)
    return np.where(several, (count - 1.0) / np.where(several, final - first, 1.0), np.nan)


def growth_update(memory: Any, p: Any, before: Any, after: Any) -> Memory:
    """Sums of a straight line through ln of half the distance of successive extremes of q over time."""
    turning, instant, q = extreme(before, after)
    turns, at = turning & (before.t >= p[0]), instant - p[0]
    swing = abs(q - memory[0])
    counts = turns & (memory[1] > 0.5) & (swing > 0.0)
    size = np.log(np.where(counts, swing, 1.0))
    return (
        np.where(turns, q, memory[0]),
        np.where(turns, 1.0, memory[1]),
        memory[2] + 1.0 * counts,
        memory[3] + np.where(counts, at, 0.0),
        memory[4] + np.where(counts, size, 0.0),
        memory[5] + np.where(counts, at * at, 0.0),
        memory[6] + np.where(counts, at * size, 0.0),
    )


def growth_rate(last: float = 1.0) -> Observer:
    """Growth rate [1/s] of each degree of freedom: slope of ln(swing between successive extremes); NaN below three."""
    return Observer("growth_rate", growth_update, (0.0,) * 7, "dof", _slope, last, unit="1/s")


def _slope(memory: Any) -> Any:
    count, t, y, tt, ty = (memory[..., k] for k in range(2, 7))
    spread = count * tt - t * t
    enough = (count >= 3.0) & (spread > 0.0)
    return np.where(enough, (count * ty - t * y) / np.where(enough, spread, 1.0), np.nan)


def settled_update(memory: Any, p: Any, before: Any, after: Any) -> Memory:
    """The last instant seen at which |q'| exceeds p[1], the last of all, the last turn of q and its longest swing."""
    turns, at, _ = extreme(before, after)
    swing = np.where(turns & (memory[2] > -1e300), at - memory[2], 0.0)
    peaks = before.qdd * after.qdd < 0.0
    x = np.where(peaks, before.qdd / np.where(peaks, before.qdd - after.qdd, 1.0), 1.0)
    h, y = after.t - before.t, 1.0 - x
    inside = y * y * ((1.0 + 2.0 * x) * before.qd + x * h * before.qdd)
    inside = inside + x * x * ((1.0 + 2.0 * y) * after.qd - y * h * after.qdd)
    seen = np.where(abs(inside) > p[1], before.t + x * h, memory[0])
    return (
        np.where(abs(after.qd) > p[1], after.t, seen),
        after.t,
        np.where(turns, at, memory[2]),
        np.maximum(memory[3], swing),
    )


def settled(level: float = 1e-4) -> Observer:
    """When |q'| of each degree of freedom fell below `level` [m/s] for good [s]; inf when it had not at the end.

    For good is longer than the longest swing from turn to turn: every oscillation is slow where it turns. It is looked
    at where steps end and where q' peaks inside, so the instant is early by up to a step.
    """
    return Observer("settled", settled_update, (0.0, 0.0, -2e300, 0.0), "dof", _when, 1.0, (level,), unit="s")


def _when(memory: Any) -> Any:
    still = memory[..., 1] - memory[..., 0]
    return np.where((still > 0.0) & (still >= memory[..., 3]), memory[..., 0], np.inf)


def energy_update(memory: Any, p: Any, before: Any, after: Any) -> Memory:
    """Work of the contact's friction from p[0] on."""
    return (memory[0] + np.where(after.t > p[0], after.work - before.work, 0.0),)


def energy(last: float = 1.0) -> Observer:
    """Energy each contact feeds into the vibration over the last part [J], from the step that reaches into it on."""
    return Observer("energy", energy_update, (0.0,), "contact", None, last, unit="J")


def sticking_update(memory: Any, p: Any, before: Any, after: Any) -> Memory:
    """Time spent sticking and time seen, from p[0] on."""
    h = np.maximum(after.t - np.maximum(before.t, p[0]), 0.0)
    return (memory[0] + np.where(abs(after.mode) < 0.5, h, 0.0), memory[1] + h)


def sticking(last: float = 1.0) -> Observer:
    """Share of time each contact sticks over the last part; 0 where sticking is not resolved (raw, smooth)."""
    return Observer("sticking", sticking_update, (0.0, 0.0), "contact", _share, last, unit="-")


def reversed_update(memory: Any, p: Any, before: Any, after: Any) -> Memory:
    """Time spent sliding against the positive sense and time seen, from p[0] on."""
    h = np.maximum(after.t - np.maximum(before.t, p[0]), 0.0)
    return (memory[0] + np.where(after.mode < -0.5, h, 0.0), memory[1] + h)


def reversed_sliding(last: float = 1.0) -> Observer:
    """Share of time each contact slides against the positive sense over the last part."""
    return Observer("reversed", reversed_update, (0.0, 0.0), "contact", _share, last, unit="-")


def _share(memory: Any) -> Any:
    return memory[..., 0] / np.where(memory[..., 1] > 0.0, memory[..., 1], 1.0)


def poincare_update(memory: Any, p: Any, before: Any, after: Any) -> Memory:
    """The latest eight maxima of q from p[0] on, newest first."""
    turns, _, q = extreme(before, after)
    falls = turns & (before.qd > 0.0) & (before.t >= p[0])
    return (
        np.where(falls, q, memory[0]),
        np.where(falls, memory[0], memory[1]),
        np.where(falls, memory[1], memory[2]),
        np.where(falls, memory[2], memory[3]),
        np.where(falls, memory[3], memory[4]),
        np.where(falls, memory[4], memory[5]),
        np.where(falls, memory[5], memory[6]),
        np.where(falls, memory[6], memory[7]),
    )


def poincare(last: float = 0.5) -> Observer:
    """The last eight maxima of each degree of freedom [m], newest first, NaN where there were fewer.

    Sections of the motion with q' = 0; over a parameter they draw a bifurcation diagram.
    """
    return Observer("poincare", poincare_update, (np.nan,) * 8, "dof", _all, last, unit="m")


def _all(memory: Any) -> Any:
    return memory


OBSERVERS: dict[str, Callable[[], Observer]] = {
    "amplitude": amplitude,
    "peak": peak,
    "frequency": frequency,
    "growth_rate": growth_rate,
    "settled": settled,
    "energy": energy,
    "sticking": sticking,
    "reversed": reversed_sliding,
    "poincare": poincare,
}


def as_observers(observe: Any) -> tuple[Observer, ...]:
    """Names and observers as observers."""
    asked = (observe,) if isinstance(observe, (str, Observer)) else tuple(observe)
    chosen = []
    for each in asked:
        if isinstance(each, Observer):
            chosen.append(each)
        elif each in OBSERVERS:
            chosen.append(OBSERVERS[each]())
        else:
            raise ParameterError("simulate_ensemble", "observe", each, known_names(str(each), list(OBSERVERS)))
    names = [each.name for each in chosen]
    if len(set(names)) != len(names):
        raise ParameterError("simulate_ensemble", "observe", names, "observers of different names")
    return tuple(chosen)
