"""Equally spaced samples of a signal: what every function of this room starts from."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from decimal import Decimal
from typing import Any, Protocol

import numpy as np
from numpy.typing import ArrayLike

LEAST = 8  # fewer samples say nothing
COARSE = 0.05  # of the velocity: some eight instants in a period
FOLDED = 0.3  # of it: some three, fewer fold what swings
TOO_FEW = (
    "the instants kept, {rate:.4g} a second, are too few for the fastest oscillation of the motion: its lines fold"
    " and stand elsewhere; run it with more equally spaced times"
)
COARSEST = 0.25  # of a step: times written with fewer digits do not show whether a sample is missing
JITTER = 1e-3  # of a step: disturbs a line at half the sampling rate by 0.3 %, any other less


class MotionLike(Protocol):
    """A motion as this room sees it."""

    @property
    def t(self) -> Any:
        """Instants (k,) [s]."""

    @property
    def q(self) -> Any:
        """Displacement (k, n) [m]."""

    @property
    def qd(self) -> Any:
        """Velocity (k, n) [m/s]."""


Signal = ArrayLike | MotionLike  # what `values` reads as a signal


class SignalError(ValueError):
    """A signal cannot be analysed as given; the message says what was given and what is expected."""


@dataclass(frozen=True)
class Samples:
    """Equally spaced samples: `t` (k,) [s], `x` (k,), `rate` [Hz]; `caution` where they are too few for a motion."""

    t: Any
    x: Any
    rate: float
    caution: str = ""

    @property
    def duration(self) -> float:
        """Time the samples stand for, k/rate [s]."""
        return float(self.x.size / self.rate)


def samples(
    signal: Signal,
    t: ArrayLike | None = None,
    *,
    rate: float | None = None,
    dof: int | str = 0,
    begin: float | None = None,
    end: float | None = None,
) -> Samples:
    """The equally spaced samples behind a signal, cut to begin <= t <= end [s].

    `rate` [Hz]: of values without instants; `begin` [s]: first instant taken; `end` [s]: last instant taken.

    Raises `SignalError` for unequal steps, a value that is not finite, fewer than 8 samples, or missing times.
    """
    times, x = values(signal, t, dof=dof, rate=rate)
    keep = (times >= (-np.inf if begin is None else begin)) & (times <= (np.inf if end is None else end))
    times, x = times[keep], x[keep]
    if x.size < LEAST:
        raise too_few("signal", x.size, begin, end, LEAST)
    if not equal_steps(times):
        steps = np.diff(times)
        raise SignalError(
            f"the times are not equally spaced: steps from {steps.min():g} to {steps.max():g} s; expected equal steps, "
            "such as simulate(..., times=np.linspace(begin, end, count)) gives"
        )
    per_second = float((times.size - 1) / (times[-1] - times[0]))
    return Samples(times, x, per_second, folded(signal))


def too_few(what: str, count: int, begin: float | None, end: float | None, least: int) -> SignalError:
    """The error for so few samples from `begin` [s] to `end` [s], as far as these were given."""
    ends = [f" {word} {value:g} s" for word, value in (("from", begin), ("to", end)) if value is not None]
    return SignalError(f"the {what} has {count} samples{''.join(ends)}: expected {least} or more")


def folded(signal: Any) -> str:
    """A sentence where it is a motion whose instants are too few for it; "" for any other."""
    if not hasattr(signal, "qd") or carries(signal, FOLDED):
        return ""
    return TOO_FEW.format(rate=(len(signal.t) - 1) / (signal.t[-1] - signal.t[0]))


def unfolded(signal: Signal, t: ArrayLike | None = None, **cut: Any) -> Samples:
    """As :func:`samples`, for what can carry no caution: `SignalError` where instants are too few for the motion."""
    found = samples(signal, t, **cut)
    if found.caution:
        raise SignalError(found.caution)
    return found


def equal_steps(t: ArrayLike, rounding: float | np.ndarray = 0.0) -> bool:
    """True when the times (k,) are equally spaced, to a thousandth of a step and the `rounding` [s] of their digits.

    Digits as coarse as a quarter of a step are not enough: a lost sample moves times by half a step.
    """
    times = np.asarray(t, dtype=float)
    even = np.linspace(times[0], times[-1], times.size)
    step = even[1] - even[0]
    off = np.abs(times - even) - np.minimum(rounding, COARSEST * step)
    return bool(step > 0.0 and np.max(off) <= JITTER * step)


def last_digits(numbers: Sequence[str]) -> Any:
    """What the last digit of each number of a column as text is worth (k,), written with fixed places or fixed digits.

    >>> last_digits(["0.5", "1", "10.25"]).tolist()
    [0.01, 0.01, 0.01]
    """
    parts = [Decimal(each.strip()).as_tuple() for each in numbers]
    places = max(-int(part.exponent) for part in parts)
    digits = max(len(part.digits) for part in parts)
    leading = np.array([len(part.digits) + int(part.exponent) if any(part.digits) else -places for part in parts])
    return 10.0 ** np.maximum(-places, leading - digits)


def values(
    signal: Signal, t: ArrayLike | None = None, *, dof: int | str = 0, rate: float | None = None
) -> tuple[Any, Any]:
    """Times (k,) [s] and values (k,) of a signal, which need not be equally spaced.

    `signal` is an array (k,) with `t` or `rate` [Hz], or has ``.t`` and ``.q`` (k, n); `dof` is then an index or a
    name.
    """
    if hasattr(signal, "q") and hasattr(signal, "t"):
        t, x = signal.t, np.asarray(signal.q, dtype=float)
        x = x[:, column(signal, dof)] if x.ndim == 2 else x
    else:
        try:
            x = np.asarray(signal, dtype=float)
        except (TypeError, ValueError) as error:
            expected = "a motion, or an array of real numbers with its times t"
            raise SignalError(f"a {type(signal).__name__} is no signal: expected {expected}") from error
    if t is None:
        if rate is None or not rate > 0.0:
            raise SignalError(f"t is missing and rate = {rate}: expected the times t [s] or a sampling rate > 0 [Hz]")
        t = np.arange(x.size) / rate
    times = np.asarray(t, dtype=float)
    if x.ndim != 1 or times.shape != x.shape:
        raise SignalError(f"signal of shape {x.shape} with t of shape {times.shape}: expected one value for each time")
    if not (np.all(np.isfinite(x)) and np.all(np.isfinite(times))):
        first = int(np.argmin(np.isfinite(x) & np.isfinite(times)))
        raise SignalError(
            f"sample {first} is not finite (t = {times[first]:g}, value {x[first]:g}): expected finite values"
        )
    if np.any(np.diff(times) <= 0.0):
        raise SignalError("the times do not increase: expected increasing times in s")
    return times, x


def carries(motion: MotionLike, within: float = COARSE) -> bool:
    """True where the kept instants of a trajectory are close enough in time for its fastest oscillation.

    Of a trajectory both displacement and velocity are known. Where the instants are close enough,

        (q_k+1 - q_k) / h = (qd_k + qd_k+1) / 2 + O((omega h)^2 / 12),

    and the two sides differ by as much as the velocity itself where there are fewer than about three instants in a
    period: such a record is aliased. `within` [-] is the share of the velocity by which they may differ: 0.05 with some
    eight instants in a period, 0.3 with some three. Source: Taylor's series of the trapezoidal rule.

    >>> from squealbox import MassOnBelt, simulate
    >>> carries(simulate(MassOnBelt(), 100.0, times=9)), carries(simulate(MassOnBelt(), 10.0, times=999))
    (False, True)
    """
    t, q, qd = motion.t, motion.q, motion.qd
    if len(t) < 3:
        return True
    h = np.diff(t)[:, None]
    moved, speed = np.diff(q, axis=0), 0.5 * h * (qd[1:] + qd[:-1])
    late, went = t[1:] > t[-1] - 0.25 * (t[-1] - t[0]), h * np.abs(qd[1:])
    unit = np.max(went, axis=0) + np.max(np.abs(moved), axis=0) + 1e-300  # a motion that blows up has no squares
    for stretch in (late, np.ones(len(late), dtype=bool)):
        missed = np.sqrt(np.sum(((moved - speed) / unit)[stretch] ** 2, axis=0))
        size = np.sqrt(np.sum((went / unit)[stretch] ** 2, axis=0)) + 1e-9 * np.ptp(q, axis=0) / unit + 1e-300
        if np.any(missed > within * size):
            return False
    return True


def column(motion: Any, dof: int | str) -> int:
    """The index of a degree of freedom given by index or by its name in ``motion.system.names``."""
    count = np.shape(motion.q)[1]
    names = tuple(motion.system.names) if isinstance(dof, str) else ()
    index = names.index(dof) if dof in names else dof
    if isinstance(index, str) or not -count <= index < count:
        known = f"one of {', '.join(names)}" if names else f"an index from 0 to {count - 1}"
        raise SignalError(f"dof = {dof!r}: expected {known}")
    return int(index)


def given(cut: Mapping[str, Any]) -> dict[str, Any]:
    """The choices that were made, for a result's settings."""
    return {name: value for name, value in cut.items() if value is not None}
