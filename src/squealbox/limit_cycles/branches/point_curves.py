"""Curves of special points of cycles over two parameters: folds, grazing, period doubling, Neimark-Sacker.

A curve is the root of the residual R of the path and of the test function of its kind, in (x, a) over b. At a fold that
function is the g of the bordered system (with r and l the null vectors at the start)

    [R_x  l] [v]   [0]
    [r'   0] [g] = [1]

Source: Govaerts 2000, Numerical Methods for Bifurcations of Dynamical Equilibria, Sec. 3.2.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, cast

import numpy as np

from squealbox.family import Bounds, DesignOrRecipe, Family
from squealbox.limit_cycles.branches.curves import PointCurve, both_ways, curve_of, ending
from squealbox.limit_cycles.branches.harmonic_path import HarmonicPath
from squealbox.limit_cycles.branches.paths import CyclePath
from squealbox.limit_cycles.branches.phases import begun
from squealbox.limit_cycles.branches.shooting_path import ShootingPath
from squealbox.limit_cycles.branches.special_points import EVENTS, BranchPoint
from squealbox.limit_cycles.cycles.harmonic_balance import Grid
from squealbox.parameters import ParameterError
from squealbox.system import System

PARAMETER_STEP = 1e-6  # of the range: differences of the path's residual
TEST_STEP = 1e-5  # in scaled variables: differences of a test function


def point_curve(
    design: DesignOrRecipe, bounds: Mapping[str, Bounds], point: BranchPoint, value: float, *, points: int = 60
) -> PointCurve:
    """Special points of cycles over two parameters: folds, grazing, period doubling or Neimark-Sacker.

    Parameters
    ----------
    design : a design, or a function of two values that returns a design or system
    bounds : name to (low, high) for two parameters; the first is the one `point` was found in
    point : from `Branch.points`, followed by its own method
    value : of the second parameter, in its own unit, at which `point` was found
    points : most points in each direction

    Returns
    -------
    PointCurve. Its outcome is as for `hopf_curve`; "no_start" where `point` does not satisfy the extended system. A
    sticking point has no smooth test function and is refused with a `ParameterError`. Accuracy: 1e-9 of the ranges,
    with the harmonics of the branch. Source: as this module.

    >>> from squealbox import Contact, Stribeck, System
    >>> from squealbox.limit_cycles import branch, hopf_point
    >>> def block(speed, damping):
    ...     belt = Contact(n=[0.0], d=[1.0], t=[1.0], N0=1.0, V=speed, law=Stribeck(0.4, 0.25, 0.3))
    ...     return System([[1.0]], [[damping]], [[1.0]], 0.0, (belt,))
    >>> born = hopf_point(lambda speed: block(speed, 0.2), "speed", (0.05, 1.0))
    >>> end = branch(lambda speed: block(speed, 0.2), "speed", (0.05, 1.0), born).points[-1]
    >>> point_curve(block, {"speed": (0.05, 1.0), "damping": (0.15, 0.25)}, end, 0.2, points=2).kind
    'grazing'
    """
    if point.kind not in EVENTS or EVENTS[point.kind].jumps:
        raise ParameterError("point_curve", "point", point.kind, "a fold, grazing, period doubling or Neimark-Sacker")
    family = Family.within("point_curve", design, bounds, count=2)
    extended = _Special(family.system, point, family.spans, float(value))
    walks = both_ways(
        extended.residual, extended.start, float(value), family.spans, extended.scale, points, extended.jacobian
    )
    return curve_of(design, walks, extended.describe, family.parameters, point.kind, ending(walks))


class _Special:
    """Residual of a path and the test function of one kind of point, over the second parameter."""

    def __init__(self, make: Callable[..., System], point: BranchPoint, spans: Sequence[Bounds], value: float) -> None:
        (low, high), (bottom, top) = spans
        self.make, self.kind, self.span, settings = make, point.kind, high - low, point.settings
        self.span_b = top - bottom
        p, first = float(point.value), lambda a: make(a, value)
        if "harmonics" in settings:
            grid = Grid(settings["harmonics"])
            series = HarmonicPath(first, settings["contact"], settings["width"], grid, self.span)
            self.path, x = cast(CyclePath, series), series.through(point, p)
        else:
            shots = ShootingPath(first, settings["rtol"], self.span)
            self.path, x = cast(CyclePath, shots), begun(shots, point, p)
        self.start, self.scale = np.append(x, p), np.append(self.path.scale, self.span)
        self.slip = max(abs(float(point.system.contacts[0].V)), 1e-300) if point.system.contacts else 1.0
        left, _, right = np.linalg.svd(self._square(self.path, self.start))
        self.left, self.right = left[:, -1], right[-1]

    def at(self, b: float) -> CyclePath:
        """The path at a value of the second parameter."""
        return self.path.again(lambda a: self.make(a, float(b)))

    def residual(self, x: np.ndarray, b: float) -> Any:
        """(residual of the path, test function); NaN outside the range of a parameter."""
        path = self.at(b)
        value = path.residual(x[:-1], float(x[-1]))
        test = self._test(path, x) if np.all(np.isfinite(value)) else np.nan
        return np.append(value, test)

    def _test(self, path: CyclePath, x: np.ndarray) -> float:
        event = EVENTS[self.kind]
        if event.of != "along":
            told = event.test(getattr(path, event.of)(x[:-1], float(x[-1])))
            return told / self.slip if event.of == "least_slip" else told
        square = self._square(path, x)
        bordered = np.block([[square, self.left[:, None]], [self.right[None], np.zeros((1, 1))]])
        return float(np.linalg.solve(bordered, np.append(np.zeros(len(square)), 1.0))[-1])

    def _square(self, path: CyclePath, x: np.ndarray) -> Any:
        return path.jacobian(x[:-1], float(x[-1]))[0] * path.scale

    def jacobian(self, x: np.ndarray, b: float) -> tuple[Any, Any]:
        """Derivative of `residual` by x and by b; the test function's along the null space of the path's part only.

        What is left out is the test function's change across that space, by as much as the path's residual is away from
        zero: of second order in a step of Newton's method, and it saves one cycle for each unknown.
        """
        path, step = self.at(b), PARAMETER_STEP * self.span_b
        ahead, behind = (self.at(b + s * step).residual(x[:-1], float(x[-1])) for s in (1.0, -1.0))
        by_b = (ahead - behind) / (2.0 * step)
        known = np.column_stack([*path.jacobian(x[:-1], float(x[-1])), by_b])
        scale = np.concatenate([self.scale, [self.span_b]])
        if not np.all(np.isfinite(known)):
            return np.full((len(x), len(x)), np.nan), np.full(len(x), np.nan)
        row = np.zeros(len(scale))
        for along in np.linalg.svd(known * scale)[2][-2:]:
            ends = []
            for sign in (1.0, -1.0):
                y = np.append(x, b) + sign * TEST_STEP * along * scale
                ends.append(self._test(self.at(float(y[-1])), y[:-1]))
            row += (ends[0] - ends[1]) / (2.0 * TEST_STEP) * along
        total = np.vstack([known, row / scale])
        return total[:, :-1], total[:, -1]

    def describe(self, x: np.ndarray, b: float) -> tuple[float, float]:
        """Frequency [Hz]; these points have no Lyapunov coefficient here."""
        period = float(self.at(b).describe(x[:-1], float(x[-1]))["period"])
        return 1.0 / period, float("nan")
