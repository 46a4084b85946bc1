"""Curves over two parameters: of Hopf points, and of special points of cycles (folds, grazing, period doubling, ...).

A Hopf curve is the root of the extended system in (u, w, omega, a) over b, with q = u + i w, A(a, b) df/dx at steady
sliding and q0 the vector at the start:

    A u + omega w = 0,    A w - omega u = 0,    <q0, q> = 1

A curve of special points is the root of the residual R of the path and of the test function of its kind, in (x, a) over
b. At a fold that function is the g of the bordered system (with r and l the null vectors at the start)

    [R_x  l] [v]   [0]
    [r'   0] [g] = [1]

Both are followed in both directions by pseudo-arclength. Source: Govaerts 2000, Numerical Methods for Bifurcations of
Dynamical Equilibria, Ch. 4 (Hopf) and Sec. 3.2 (bordered fold).
"""

import copy
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.continuation import StepControl, follow
from squealbox.limit_cycles.field import Field
from squealbox.limit_cycles.harmonic_balance import Grid
from squealbox.limit_cycles.harmonic_path import HarmonicPath
from squealbox.limit_cycles.hopf import HopfPoint, critical_pair, hopf_point, lyapunov_coefficient, steady_modes
from squealbox.limit_cycles.shooting_path import ShootingPath
from squealbox.limit_cycles.special_points import TESTS, BranchPoint
from squealbox.limit_cycles.starting import steady_state
from squealbox.parameters import ParameterError
from squealbox.result import Outcome, Result, quantity
from squealbox.system import System, as_system

Bounds = dict[str, tuple[float, float]]


@dataclass(frozen=True, kw_only=True, eq=False)
class PointCurve(Result):
    """A curve of special points over two parameters, as :func:`hopf_curve` and :func:`point_curve` return it."""

    x: Any = quantity("point", "", "first parameter, in its own unit")
    y: Any = quantity("point", "", "second parameter, in its own unit")
    frequency: Any = quantity("point", "Hz", "frequency there")
    residual: Any = quantity("point", "1", "largest scaled residual of the extended system")
    lyapunov: Any = quantity("point", "1", "first Lyapunov coefficient of Hopf points; NaN on other curves")
    parameters: tuple[str, ...] = ()
    kind: str = ""

    def summary(self) -> str:
        """One line: kind, points and ranges."""
        if len(self.x) == 0:
            return f"{self.kind} curve: {self.outcome}: {self.outcome.message}"
        spans = [f"{name} {np.min(v):.6g} to {np.max(v):.6g}"
                 for name, v in zip(self.parameters, (self.x, self.y), strict=True)]  # fmt: skip
        return f"{self.kind} curve, {len(self.x)} points: {', '.join(spans)}; ended: {self.outcome.message}"

    def __repr__(self) -> str:
        return self.summary()


def two_parameters(design: Any, bounds: Bounds) -> tuple[Callable[[float, float], System], tuple[str, str]]:
    """A function of two values that returns a system, and the two names."""
    names = tuple(bounds)
    if len(names) != 2 or not all(low < high for low, high in bounds.values()):
        raise ParameterError("limit_cycles", "bounds", bounds, "two parameters, each with low < high")
    if callable(design) and not hasattr(design, "replace"):
        return lambda a, b: as_system(design(a, b)), names
    return lambda a, b: as_system(design.replace({names[0]: a, names[1]: b})), names


def hopf_curve(design: Any, bounds: Bounds, *, value: float | None = None, points: int = 100) -> PointCurve:
    """Hopf points over two parameters, through the first one found in the first parameter.

    Parameters
    ----------
    design : a design, or a function of two values that returns a design or system
    bounds : name to (low, high) for two parameters
    value : of the second parameter, at which the start is looked for; None takes the middle
    points : most points in each direction

    Outcome "completed" where both ends reach a bound or the curve closes, else why it ended, or that of `hopf_point`
    where there is no start. Accuracy: 1e-10 of the ranges. Source: as this module.

    >>> from squealbox import DrumBrake, LinearSlope
    >>> brake = DrumBrake(friction=LinearSlope(0.3, -0.05))
    >>> hopf_curve(brake, {"friction.static": (0.1, 0.6), "load": (500.0, 2000.0)}).outcome.ok
    True
    """
    make, names = two_parameters(design, bounds)
    (low, high), (bottom, top) = bounds.values()
    middle = 0.5 * (bottom + top) if value is None else float(value)
    born = hopf_point(lambda a: make(a, middle), names[0], (low, high))
    if not born.outcome.ok:
        return _curve([], lambda *_: (0.0, 0.0), names, "hopf", born.outcome)
    extended = _Hopf(make, born)
    walks = _both_ways(extended.residual, extended.start, middle, bounds, extended.scale(high - low), points)
    return _curve(walks, extended.describe, names, "hopf", _ending(walks))


class _Hopf:
    """The extended system of a Hopf point, in states scaled to velocities."""

    def __init__(self, make: Callable[[float, float], System], born: HopfPoint) -> None:
        self.make = make
        self.units = Field(born.inputs["system"]).scale
        q = born.shape * self.units
        self.reference = q / np.linalg.norm(q)
        self.rate = born.angular_frequency
        self.start = np.concatenate([self.reference.real, self.reference.imag, [self.rate, float(born.value)]])

    def scale(self, width: float) -> Any:
        """Typical sizes of the unknowns."""
        return np.concatenate([np.ones(len(self.start) - 2), [self.rate, width]])

    def residual(self, x: Any, b: float) -> Any:
        """Of the extended system, over the frequency at the start; NaN outside the range of a parameter."""
        u, w, omega, a = *np.split(x[:-2], 2), x[-2], x[-1]
        try:
            field = Field(self.make(float(a), float(b)))
        except ParameterError:
            return np.full(len(x), np.nan)
        steady = steady_state(field)
        matrix = field.jacobian(steady, steady_modes(field, steady)) * (self.units[:, None] / self.units)
        phase = np.vdot(self.reference, u + 1j * w) - 1.0
        parts = [(matrix @ u + omega * w) / self.rate, (matrix @ w - omega * u) / self.rate]
        return np.concatenate([*parts, [phase.real, phase.imag]])

    def describe(self, x: Any, b: float) -> tuple[float, float]:
        """Frequency [Hz] and first Lyapunov coefficient."""
        field = Field(self.make(float(x[-1]), float(b)))
        eigenvalue, q, p, steady = critical_pair(field, float(x[-2]))
        return float(x[-2]) / (2.0 * np.pi), lyapunov_coefficient(field, steady, eigenvalue.imag, q, p)


def point_curve(design: Any, bounds: Bounds, point: BranchPoint, value: float, *, points: int = 60) -> PointCurve:
    """Special points of cycles over two parameters: folds, grazing, period doubling or Neimark-Sacker.

    Parameters
    ----------
    design : a design, or a function of two values that returns a design or system
    bounds : name to (low, high) for two parameters; the first is the one `point` was found in
    point : from `Branch.points`, followed by its own method
    value : of the second parameter, at which `point` was found
    points : most points in each direction

    Outcome as for :func:`hopf_curve`; "no_start" where `point` does not satisfy the extended system. A sticking point
    has no smooth test function and is refused with a `ParameterError`. Accuracy: 1e-9 of the ranges, with the
    harmonics of the branch. Source: as this module.

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
    if point.kind not in (*TESTS, "fold") or point.kind == "sticking":
        raise ParameterError("point_curve", "point", point.kind, "a fold, grazing, period doubling or Neimark-Sacker")
    make, names = two_parameters(design, bounds)
    extended = _Special(make, point, bounds, float(value))
    scale = np.append(extended.path.scale, extended.span)
    walks = _both_ways(extended.residual, extended.start, float(value), bounds, scale, points)
    return _curve(walks, extended.describe, names, point.kind, _ending(walks))


class _Special:
    """Residual of a path and the test function of one kind of point, over the second parameter."""

    def __init__(self, make: Any, point: BranchPoint, bounds: Bounds, value: float) -> None:
        (low, high), _ = bounds.values()
        self.make, self.kind, self.span, settings = make, point.kind, high - low, point.settings
        p, period = float(point.value), float(point.period)
        if "harmonics" in settings:
            grid = Grid(settings["harmonics"])
            self.path: Any = HarmonicPath(lambda a: make(a, value), settings["contact"], settings["width"], grid,
                                          self.span)  # fmt: skip
            series = grid.values @ Grid(grid.harmonics, len(point.t) - 1).series(point.q[:-1])
            x = self.path.begin(grid.series(series), 2.0 * np.pi / period, p, float(np.max(point.amplitude)))
        else:
            self.path = ShootingPath(lambda a: make(a, value), settings["rtol"], self.span)
            dof = int(np.argmax(point.amplitude))
            top = int(np.argmax(point.q[:-1, dof]))
            start = np.concatenate([point.q[top], point.qd[top]])
            x = self.path.begin(start, period, p, dof, float(np.max(point.amplitude)))
        self.start = np.append(x, p)
        self.slip = max(abs(float(point.system.contacts[0].V)), 1e-300) if point.system.contacts else 1.0
        left, _, right = np.linalg.svd(self._square(self.path, self.start))
        self.left, self.right = left[:, -1], right[-1]

    def at(self, b: float) -> Any:
        """The path at a value of the second parameter."""
        path = copy.copy(self.path)
        path.make = lambda a: self.make(a, float(b))
        for name in ("balances", "fields", "runs", "flights"):
            if hasattr(path, name):
                setattr(path, name, {})
        return path

    def residual(self, x: Any, b: float) -> Any:
        """(residual of the path, test function); NaN outside the range of a parameter."""
        path = self.at(b)
        value = path.residual(x[:-1], float(x[-1]))
        test = self._test(path, x) if np.all(np.isfinite(value)) else np.nan
        return np.append(value, test)

    def _test(self, path: Any, x: Any) -> float:
        if self.kind == "grazing":
            return float(path.least_slip(x[:-1], float(x[-1]))) / self.slip
        if self.kind != "fold":
            return TESTS[self.kind](path.describe(x[:-1], float(x[-1])))
        square = self._square(path, x)
        bordered = np.block([[square, self.left[:, None]], [self.right[None], np.zeros((1, 1))]])
        return float(np.linalg.solve(bordered, np.append(np.zeros(len(square)), 1.0))[-1])

    def _square(self, path: Any, x: Any) -> Any:
        return path.jacobian(x[:-1], float(x[-1]))[0] * path.scale

    def describe(self, x: Any, b: float) -> tuple[float, float]:
        """Frequency [Hz]; these points have no Lyapunov coefficient here."""
        period = float(self.at(b).describe(x[:-1], float(x[-1]))["period"])
        return 1.0 / period, float("nan")


def _both_ways(residual: Any, x: Any, b: float, bounds: Bounds, scale: Any, points: int) -> list[Any]:
    """Points (x, b, residual) from one end of the curve to the other, and how the two walks ended."""
    _, (bottom, top) = bounds.values()
    low, high = next(iter(bounds.values()))
    walks = []
    for way in (-1.0, 1.0):
        control = StepControl(first=1e-2, largest=5e-2, most_points=points, tolerance=1e-9)
        walk = follow(residual, x, b, control=control, direction=way, bounds=(bottom, top), x_scale=scale,
                      p_scale=top - bottom)  # fmt: skip
        kept, ended = [], None
        for at in walk:
            if not low <= at.x[-1] <= high:
                ended = Outcome(message="reached a bound of the first parameter")
                break
            kept.append(at)
        walks.append((kept, ended or walk.outcome))
        if walk.outcome.evidence.get("closed"):
            break
    return walks


def _ending(walks: list[Any]) -> Outcome:
    bad = [outcome for _, outcome in walks if not outcome.ok]
    if bad:
        return Outcome(str(bad[0]), bad[0].message, **bad[0].evidence)
    return Outcome(message="; ".join(outcome.message for _, outcome in walks))


def _curve(walks: list[Any], describe: Any, names: tuple[str, str], kind: str, outcome: Outcome) -> PointCurve:
    line = [at for i, (kept, _) in enumerate(walks) for at in (kept[:0:-1] if i == 0 and len(walks) > 1 else kept)]
    about = np.array([describe(at.x, at.p) for at in line]).reshape(-1, 2)
    return PointCurve(
        outcome=outcome, x=np.array([at.x[-1] for at in line]), y=np.array([at.p for at in line]),
        frequency=about[:, 0], residual=np.array([at.residual for at in line]), lyapunov=about[:, 1],
        parameters=names, kind=kind,
    )  # fmt: skip
