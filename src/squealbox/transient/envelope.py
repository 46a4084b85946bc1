"""The course of an amplitude: half peak to peak of a motion in successive windows.

A smooth curve through the samples (cubic Hermite where the velocity is known, else a cubic spline) gives the turning
points between them. So coarse samples do not lower the peaks, and steps need not be equal.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.signals import LEAST, column, too_few, values

PERIODS = 2  # in a window: one holds a crest and a trough; the second leaves room for an error of the period
LONGEST = 6  # periods of the dominant frequency after which a cycle may repeat: subharmonics down to a sixth
RETURNS = 0.1  # a motion that misses itself by more after its period is no cycle; 2 % of change adds 0.02
WINDOWS = 400  # at most, however long the run


@dataclass(frozen=True)
class Curve:
    """A smooth curve through the samples `t` (k,) [s], `x` (k,) of one degree of freedom, with its turning points."""

    t: Any
    x: Any
    spline: Any
    total: Any
    turns: Any
    points: Any
    heights: Any

    @property
    def begin(self) -> float:
        """First instant [s]."""
        return float(self.t[0])

    @property
    def end(self) -> float:
        """Last instant [s]."""
        return float(self.t[-1])

    def mean(self, left: float | np.ndarray, right: float | np.ndarray) -> Any:
        """Mean over a stretch, or over many."""
        return (self.total(right) - self.total(left)) / (right - left)

    def even(self, left: float | None = None, right: float | None = None) -> tuple[Any, Any]:
        """Equally spaced samples of a stretch, about four for each turning point and as many as were given."""
        left = self.begin if left is None else left
        right = self.end if right is None else right
        given = int(np.count_nonzero((self.t >= left) & (self.t <= right)))
        turns = int(np.count_nonzero((self.turns >= left) & (self.turns <= right)))
        times = np.linspace(left, right, max(given, 4 * turns, 64))
        return times, self.spline(times)

    def swing(self, left: float | np.ndarray, right: float | np.ndarray, period: float | np.ndarray) -> tuple[Any, Any]:
        """Half peak to peak and mid-height in windows, about a line through the means of its first and last period.

        `left` and `right` [s] are of one window, or arrays (k,) of many.
        """
        ends = np.stack(np.broadcast_arrays(left, right)).astype(float).reshape(2, -1)
        first, last = np.searchsorted(self.points, ends)
        count = last - first
        inside = np.arange(np.sum(count)) + np.repeat(first - np.cumsum(count) + count, count)
        window = np.repeat(np.arange(count.size), count)
        width, middle = ends[1] - ends[0], 0.5 * (ends[0] + ends[1])
        rises = width > 1.5 * period
        wide = ends[:, rises]
        slope = np.zeros(width.size)
        rise = self.mean(wide[1] - period, wide[1]) - self.mean(wide[0], wide[0] + period)
        slope[rises] = rise / (width[rises] - period)
        heights = self.heights[inside] - slope[window] * (self.points[inside] - middle[window])
        at_ends = self.spline(ends) - slope * (ends - middle)
        low, high = np.min(at_ends, axis=0), np.max(at_ends, axis=0)
        np.minimum.at(low, window, heights)
        np.maximum.at(high, window, heights)
        shape = np.shape(left)
        return 0.5 * (high - low).reshape(shape), 0.5 * (high + low).reshape(shape)


def smooth_curve(
    motion: Any,
    t: np.ndarray | None = None,
    *,
    dof: int | str = 0,
    begin: float | None = None,
    end: float | None = None,
) -> Curve:
    """The curve through a trajectory, or an array and its times, between `begin` and `end` [s]."""
    from scipy.interpolate import CubicHermiteSpline, CubicSpline

    times, x = values(motion, t, dof=dof)
    keep = (times >= (-np.inf if begin is None else begin)) & (times <= (np.inf if end is None else end))
    count = int(np.count_nonzero(keep))
    if count < LEAST:
        raise too_few("motion", count, begin, end, LEAST)
    times, x = times[keep], x[keep]
    velocity = getattr(motion, "qd", None)
    if velocity is None:
        spline = CubicSpline(times, x)
    else:
        velocity = np.asarray(velocity)[:, column(motion, dof)][keep]
        spline = CubicHermiteSpline(times, x, velocity)
    turns = spline.derivative().roots(extrapolate=False)
    turns = turns[np.isfinite(turns) & (turns > times[0]) & (turns < times[-1])]
    points = np.concatenate([times, turns])
    order = np.argsort(points)
    heights = np.concatenate([x, spline(turns)])[order]
    return Curve(times, x, spline, spline.antiderivative(), turns, points[order], heights)


def repetition(curve: Curve, left: float, right: float, frequency: float) -> tuple[int, float]:
    """After how many periods of `frequency` [Hz] the motion repeats best, and how badly it then does.

    The misfit is the root mean square of x(t + P) - x(t) over that of two unrelated motions of the same strength: 0 for
    a cycle, about 1 for noise. Of nearly equal misfits the shortest period counts.
    """
    times = np.linspace(left, right, max(curve.even(left, right)[0].size, 512))
    strength = float(np.sqrt(2.0) * np.std(curve.spline(times))) or 1.0
    misfits = []
    for count in range(1, LONGEST + 1):
        early = times[times <= right - count / frequency]
        if early.size < 64 or right - left < 2.0 * count / frequency:
            break
        change = curve.spline(early + count / frequency) - curve.spline(early)
        misfits.append(float(np.sqrt(np.mean(change**2))) / strength)
    if not misfits:
        return 1, 1.0
    best = next(i for i, misfit in enumerate(misfits) if misfit <= 1.1 * min(misfits) + 0.02)
    return best + 1, misfits[best]


def last_period(curve: Curve) -> tuple[float, float]:
    """The shortest time [s] after which the motion repeats itself at its end, and how badly it then does.

    The misfit is that of :func:`repetition`, of the last period and the one before it, so that two periods are enough:
    a transform resolves no frequency of so few. (NaN, NaN) where no period, down to the hundredth part of the record,
    is the nearest return of its surroundings and misses by less than `RETURNS`.
    """
    from scipy.optimize import minimize_scalar

    share, length = np.linspace(0.0, 1.0, 257), curve.end - curve.begin

    def misfit(period: float | np.ndarray) -> Any:
        early = curve.end - np.multiply.outer(period, 2.0 - share)
        before, after = curve.spline(early), curve.spline(early + np.expand_dims(period, -1))
        strength = np.sqrt(2.0) * np.std(np.concatenate([before, after], axis=-1), axis=-1)
        return np.sqrt(np.mean((after - before) ** 2, axis=-1)) / np.maximum(strength, 1e-12 * np.ptp(curve.heights))

    periods = np.geomspace(0.01, 0.5, 400) * length
    found = misfit(periods)
    lowest = np.flatnonzero((found[1:-1] < found[:-2]) & (found[1:-1] <= found[2:]) & (found[1:-1] < 0.5)) + 1
    returns = []
    for i in lowest:
        best = minimize_scalar(
            misfit, bounds=periods[[i - 1, i + 1]], method="bounded", options={"xatol": 1e-9 * periods[i]}
        )
        returns.append((float(best.x), float(best.fun)))
    least = min((miss for _, miss in returns), default=np.inf)
    if least >= RETURNS:
        return np.nan, np.nan
    return next(each for each in returns if each[1] <= 1.1 * least + 0.02)


def envelope(curve: Curve, frequency: float, repeat: int = 1) -> tuple[Any, Any, Any]:
    """Middle of each window [s], half peak to peak and mid-height in it.

    `frequency` [Hz] is the dominant one; the motion repeats after `repeat` of its periods, and a window holds that many
    or a multiple.
    """
    length = curve.end - curve.begin
    periods = repeat * -(-PERIODS // repeat)
    count = int(np.clip(length * frequency / periods, 4, WINDOWS))
    edges = np.linspace(curve.begin, curve.end, count + 1)
    middle = 0.5 * (edges[1:] + edges[:-1])
    half = 0.5 * min(periods / frequency, length / count)
    return middle, *curve.swing(middle - half, middle + half, repeat / frequency)
