"""The course of an amplitude: half peak to peak of a motion in successive windows.

A smooth curve through the samples (cubic Hermite where the velocity is known, else a cubic spline) gives the turning
points between them. So coarse samples do not lower the peaks, and steps need not be equal.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.signals import SignalError, column, values

PERIODS = 2.0  # in a window: one holds a crest and a trough; the second leaves room for an error of the period
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

    def mean(self, left: float, right: float) -> float:
        """Mean over a stretch."""
        return float(self.total(right) - self.total(left)) / (right - left)

    def even(self, left: float, right: float) -> tuple[Any, Any]:
        """Equally spaced samples of a stretch, about four for each turning point and as many as were given."""
        given = np.count_nonzero((self.t >= left) & (self.t <= right))
        turns = np.count_nonzero((self.turns >= left) & (self.turns <= right))
        times = np.linspace(left, right, max(given, 4 * turns, 64))
        return times, self.spline(times)

    def half_range(self, left: float, right: float, period: float) -> float:
        """Half peak to peak in a window, about the line through the means of its first and its last period."""
        inside = slice(*np.searchsorted(self.points, (left, right)))
        points = np.concatenate([self.points[inside], (left, right)])
        heights = np.concatenate([self.heights[inside], self.spline((left, right))])
        if right - left > 1.5 * period:
            rise = self.mean(right - period, right) - self.mean(left, left + period)
            heights = heights - rise / (right - left - period) * (points - left)
        return 0.5 * float(np.ptp(heights))


def smooth_curve(motion: Any, t: Any, dof: int | str, begin: float | None, end: float | None) -> Curve:
    """The curve through a trajectory, or an array and its times, between `begin` and `end` [s]."""
    from scipy.interpolate import CubicHermiteSpline, CubicSpline

    times, x = values(motion, t, dof=dof)
    keep = (times >= (-np.inf if begin is None else begin)) & (times <= (np.inf if end is None else end))
    count = np.count_nonzero(keep)
    if count < 8:
        raise SignalError(f"the motion has {count} samples between begin = {begin} and end = {end}: expected 8 or more")
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


def envelope(curve: Curve, frequency: float) -> tuple[Any, Any]:
    """Middle of each window [s] and half peak to peak in it, for a motion of the given frequency [Hz]."""
    length = curve.end - curve.begin
    count = int(np.clip(length * frequency / PERIODS, 4, WINDOWS))
    edges = np.linspace(curve.begin, curve.end, count + 1)
    middle = 0.5 * (edges[1:] + edges[:-1])
    half = 0.5 * min(PERIODS / frequency, length / count)
    return middle, np.array([curve.half_range(m - half, m + half, 1.0 / frequency) for m in middle])
