"""Follow the roots of residual(x, p) = 0 as the parameter p varies, through folds: pseudo-arclength continuation.

Knows no physics. With y = (x, p), each step predicts along the tangent and corrects on the plane normal to it,

    residual(y) = 0,   tangent . (y - y_predicted) = 0      (both in scaled variables)

so the path may turn back in p. A :class:`Follower` is walked like any iterator; when it ends, `outcome` says why.
Source: Keller 1977, "Numerical solution of bifurcation and nonlinear eigenvalue problems".
"""

from collections.abc import Callable, Iterator
from dataclasses import dataclass, field
from typing import Any, NamedTuple, Protocol

import numpy as np
from numpy.typing import ArrayLike

from squealbox.result import COMPLETED, Outcome

KEEP = 1e-2  # scaled correction below which Newton's method keeps its derivative for the next one
SLOW = 0.1  # share of the one before by which a correction with a kept derivative must shrink
FAR = 10.0  # step lengths from the prediction beyond which Newton's method has lost the path
STEEP = 1e4  # 1/cos of the angle to the last tangent above which the null vector is taken from singular values

Residual = Callable[[Any, float], Any]
Jacobian = Callable[[Any, float], tuple[Any, Any]]


@dataclass(frozen=True)
class StepControl:
    """Tolerances of the follower: lengths are arclengths in scaled variables.

    first, smallest, largest : step lengths
    tolerance : Newton stops when the scaled correction falls below it
    residual_tolerance : a root at which the residual's largest entry is above it is refused
    newton_steps : most Newton steps before a step is refused
    wanted_steps : Newton steps at which the step length is kept
    largest_turn : [rad] a step over which the tangent turns by more is refused
    most_points : the walk ends after this many points
    """

    first: float = 1e-2
    smallest: float = 1e-8
    largest: float = 1e-1
    tolerance: float = 1e-10
    residual_tolerance: float = np.inf
    newton_steps: int = 8
    wanted_steps: int = 3
    largest_turn: float = 0.35
    most_points: int = 2000


@dataclass(frozen=True, eq=False)
class PathPoint:
    """A point on the path.

    x (n,), p; tangent (n + 1,) in scaled variables, of length 1; arclength from the start; step that led here; Newton
    iterations; largest |residual|; fold when p turned back since the last point; branching when the determinant of
    the bordered Jacobian changed sign, as it does where another path crosses.
    """

    x: Any
    p: float
    tangent: Any
    arclength: float
    step: float
    iterations: int
    residual: float
    fold: bool = False
    branching: bool = False
    sign: float = field(default=1.0, repr=False)


class Path(Protocol):
    """What is followed: the root x (n,) of a residual over the parameter p, each with its typical size."""

    scale: Any
    span: float

    def residual(self, x: np.ndarray, p: float) -> Any:
        """Zero on the path, shape (n,)."""

    def jacobian(self, x: np.ndarray, p: float) -> tuple[Any, Any]:
        """Its derivatives by x (n, n) and by p (n,)."""


class Corrected(NamedTuple):
    """What Newton's method came to: y or None, corrections, derivatives taken, largest |residual|, derivative kept."""

    y: Any
    iterations: int
    fresh: int
    residual: float
    kept: Any = None


class Equation:
    """residual(x, p) = 0 in scaled variables y = (x, p)/scale, (n + 1,); without `jacobian` by central differences."""

    def __init__(self, residual: Residual, jacobian: Jacobian | None, scale: np.ndarray) -> None:
        self.residual, self.jacobian, self.scale = residual, jacobian, scale

    @classmethod
    def of(cls, path: Path) -> "Equation":
        """That of a path."""
        return cls(path.residual, path.jacobian, np.append(path.scale, path.span))

    def y(self, x: np.ndarray, p: float) -> Any:
        """A point in scaled variables."""
        return np.append(x, p) / self.scale

    def point(self, y: np.ndarray) -> tuple[Any, float]:
        """(x, p)."""
        x = y * self.scale
        return x[:-1], float(x[-1])

    def value(self, y: np.ndarray) -> Any:
        """The residual, (n,)."""
        return np.atleast_1d(np.asarray(self.residual(*self.point(y)), dtype=float))

    def derivative(self, y: np.ndarray) -> Any:
        """d residual / d y, (n, n + 1); NaN where the residual is."""
        if self.jacobian is not None:
            by_x, by_p = self.jacobian(*self.point(y))
            return np.column_stack([np.atleast_2d(by_x), np.atleast_1d(by_p)]) * self.scale
        step = np.cbrt(np.finfo(float).eps) * np.maximum(1.0, np.abs(y))
        columns = []
        for i in range(y.size):
            shift = np.zeros(y.size)
            shift[i] = step[i]
            columns.append((self.value(y + shift) - self.value(y - shift)) / (2.0 * step[i]))
        return np.column_stack(columns)

    def corrected(
        self,
        guess: np.ndarray,
        normal: np.ndarray,
        most: int,
        tolerance: float,
        reach: float = np.inf,
        kept: np.ndarray | None = None,
    ) -> Corrected:
        """Newton's method on the plane through `guess` with that normal, to a correction within the tolerance.

        A derivative is kept as long as corrections shrink well by it. One that leads farther than `reach` from the
        guess ends the search: values there mean nothing and may be costly.
        """
        y, size, matrix, last, fresh = guess.copy(), np.inf, kept, np.inf, 0
        for iteration in range(1, most + 1):
            value = self.value(y)
            size = float(np.max(np.abs(value)))
            if not np.isfinite(size):
                return Corrected(None, iteration, fresh, size)
            if matrix is None or KEEP < last < np.inf:
                matrix, fresh = np.vstack([self.derivative(y), normal]), fresh + 1
            change = _solved(matrix, np.append(value, normal @ (y - guess)))
            y, before, last = y - change, last, float(np.max(np.abs(change)))
            if not np.linalg.norm(y - guess) <= reach:  # also where the derivative is NaN
                return Corrected(None, iteration, fresh, size)
            if last > SLOW * before:
                matrix = None
            if last <= tolerance:
                return Corrected(y, iteration, fresh, size, matrix)
        return Corrected(None, most, fresh, size)


class Follower:
    """The path through (x, p), as an iterator over :class:`PathPoint`; see :func:`follow`."""

    def __init__(self, residual: Residual, x: ArrayLike, p: float, **options: Any) -> None:
        jacobian: Jacobian | None = options.pop("jacobian", None)
        self.control: StepControl = options.pop("control", StepControl())
        self.direction: float = options.pop("direction", 1.0)
        self.bounds: tuple[float, float] = options.pop("bounds", (-np.inf, np.inf))
        self.closes: bool = options.pop("closes", True)
        self.tangent: Any = options.pop("tangent", None)
        x = np.atleast_1d(np.asarray(x, dtype=float))
        x_scale = np.broadcast_to(np.asarray(options.pop("x_scale", 1.0), dtype=float), x.shape)
        self.scale = np.append(x_scale, options.pop("p_scale", 1.0))
        self.equation = Equation(residual, jacobian, self.scale)
        if options:
            raise TypeError(f"follow() has no option {sorted(options)}")
        self.start = self.equation.y(x, float(p))
        self.outcome = Outcome("not_finished", "the walk has not been ended")

    def __iter__(self) -> Iterator[PathPoint]:
        point = self._first()
        if point is None:
            return
        yield point
        origin, step, furthest = point, self.control.first, 0.0
        for _ in range(self.control.most_points - 1):
            advanced = self._advance(point, step)
            if advanced is None:
                message = f"no step above {self.control.smallest:g} could be taken at {point.p:.10g}"
                self.outcome = Outcome("step_underflow", message, p=point.p, arclength=point.arclength)
                return
            previous, (point, step) = point, advanced
            if not self.bounds[0] <= point.p <= self.bounds[1]:
                yield from self._landing(previous, point)
                return
            distance = self._distance(origin, point)
            if self.closes and furthest > 2.0 * point.step and self._returned(origin, previous, point):
                self.outcome = Outcome(COMPLETED, "the path closed on itself", closed=True)
                return
            furthest = max(furthest, distance)
            yield point
        self.outcome = Outcome("most_points", f"stopped after {self.control.most_points} points", p=point.p)

    def _first(self) -> PathPoint | None:
        fixed_p = np.append(np.zeros(self.start.size - 1), 1.0)
        given = self.tangent is not None
        normal = np.asarray(self.tangent, dtype=float) if given else fixed_p
        y, iterations, size = self._correct(self.start, normal, 4 * self.control.newton_steps)
        if y is None:
            message = f"Newton's method found no root at the start, p = {self.start[-1] * self.scale[-1]:.10g}"
            self.outcome = Outcome("no_start", message, residual=size)
            return None
        tangent, sign = self._tangent(y, normal)
        if not given:
            along = tangent[-1] if tangent[-1] != 0.0 else 1.0
            tangent = tangent * np.sign(along) * np.sign(self.direction)
            sign = self._sign(y, tangent)
        return self._point(y, tangent, 0.0, 0.0, iterations, size, sign=sign)

    def _advance(self, point: PathPoint, step: float) -> tuple[PathPoint, float] | None:
        """The next point and the step to try after it, or None when the step length fell below the smallest."""
        control = self.control
        y = self.equation.y(point.x, point.p)
        while step >= control.smallest:
            guess = y + step * point.tangent
            found, iterations, size = self._correct(guess, point.tangent, control.newton_steps, FAR * step)
            if found is not None and np.linalg.norm(found - y) < 2.0 * step:
                tangent, sign = self._tangent(found, point.tangent)
                turn = np.arccos(np.clip(tangent @ point.tangent, -1.0, 1.0))
                if turn <= control.largest_turn:
                    grown = self._grown(step, iterations, turn)
                    marks = {"fold": tangent[-1] * point.tangent[-1] < 0.0, "branching": sign != point.sign}
                    length = point.arclength + step
                    return self._point(found, tangent, length, step, iterations, size, sign=sign, **marks), grown
            step *= 0.5
        return None

    def _grown(self, step: float, iterations: int, turn: float) -> float:
        by_newton = 2.0 ** ((self.control.wanted_steps - iterations) / 2.0)
        by_turn = 0.7 * self.control.largest_turn / max(turn, 1e-12)
        return float(np.clip(step * min(by_newton, by_turn, 2.0), self.control.smallest, self.control.largest))

    def _landing(self, previous: PathPoint, beyond: PathPoint) -> Iterator[PathPoint]:
        """The point on the bound that was stepped over."""
        bound = self.bounds[0] if beyond.p < self.bounds[0] else self.bounds[1]
        self.outcome = Outcome(COMPLETED, f"reached the bound {bound:.10g}", bound=bound)
        if previous.p == bound:
            return
        share = (bound - previous.p) / (beyond.p - previous.p)
        ends = [self.equation.y(point.x, point.p) for point in (previous, beyond)]
        guess = ends[0] + share * (ends[1] - ends[0])
        guess[-1] = bound / self.scale[-1]
        fixed_p = np.append(np.zeros(guess.size - 1), 1.0)
        y, iterations, size = self._correct(guess, fixed_p, 2 * self.control.newton_steps)
        if y is None:
            message = f"Newton's method found no root on the bound {bound:.10g}"
            self.outcome = Outcome("no_landing", message, p=previous.p, residual=size)
            return
        tangent, sign = self._tangent(y, previous.tangent)
        step = share * beyond.step
        yield self._point(y, tangent, previous.arclength + step, step, iterations, size, sign=sign)

    def _correct(
        self, guess: np.ndarray, normal: np.ndarray, most: int, reach: float = np.inf
    ) -> tuple[Any, int, float]:
        """The root on the plane through `guess` or None, steps, largest |residual|.

        Corrections with a kept derivative are cheap, so they count as steps only up to those that are wanted.
        """
        found = self.equation.corrected(guess, normal, most, self.control.tolerance, reach)
        if found.y is None:
            return None, found.iterations, found.residual
        size = float(np.max(np.abs(self.equation.value(found.y))))
        steps = min(found.iterations, max(found.fresh + 1, self.control.wanted_steps))
        return (found.y if size <= self.control.residual_tolerance else None), steps, size

    def _tangent(self, y: np.ndarray, along: np.ndarray) -> tuple[Any, float]:
        """Unit null vector of the derivative on the side of `along` (or NaN), and the bordered determinant's sign."""
        derivative = self.equation.derivative(y)
        if not np.all(np.isfinite(derivative)):
            return np.full(y.size, np.nan), 0.0
        tangent = null_vector(derivative, along)
        return tangent, float(np.linalg.slogdet(np.vstack([derivative, tangent]))[0])

    def _sign(self, y: np.ndarray, tangent: np.ndarray) -> float:
        return float(np.linalg.slogdet(np.vstack([self.equation.derivative(y), tangent]))[0])

    def _point(self, y: np.ndarray, tangent: np.ndarray, *numbers: Any, **marks: Any) -> PathPoint:
        return PathPoint(*self.equation.point(y), tangent, *numbers, **marks)

    def _distance(self, a: PathPoint, b: PathPoint) -> float:
        return float(np.linalg.norm(self.equation.y(b.x, b.p) - self.equation.y(a.x, a.p)))

    def _returned(self, origin: PathPoint, previous: PathPoint, point: PathPoint) -> bool:
        """True when the start lies between the last two points, on the same strand and in the same direction."""
        start, a, b = (self.equation.y(q.x, q.p) for q in (origin, previous, point))
        span = b - a
        along = (start - a) @ span / (span @ span)
        off = np.linalg.norm(start - a - along * span)
        same_way = origin.tangent @ point.tangent > 0.0
        return bool(0.0 < along <= 1.0 and off < 0.3 * np.linalg.norm(span) and same_way)


def _solved(matrix: np.ndarray, right: np.ndarray) -> Any:
    """The correction; the shortest of several, and NaN for a derivative that is."""
    if not np.all(np.isfinite(matrix)):
        return np.full(len(right), np.nan)
    try:
        return np.linalg.solve(matrix, right)
    except np.linalg.LinAlgError:
        return np.linalg.lstsq(matrix, right, rcond=None)[0]


def null_vector(matrix: np.ndarray, along: np.ndarray) -> Any:
    """Unit vector t with matrix t = 0, shape (n, n + 1), on the side of `along`, where it is not normal to that."""
    try:
        tangent = np.linalg.solve(np.vstack([matrix, along]), np.append(np.zeros(len(matrix)), 1.0))
    except np.linalg.LinAlgError:
        tangent = np.full(len(along), np.inf)
    size = float(np.linalg.norm(tangent))
    if size < STEEP:
        return tangent / size
    last = np.linalg.svd(matrix)[2][-1]
    return last if last @ along >= 0.0 else -last


def follow(residual: Residual, x: ArrayLike, p: float, **options: Any) -> Follower:
    """Follow the root of residual(x, p) = 0 nearest to x at p; returns a :class:`Follower` to iterate over.

    Parameters
    ----------
    residual : function of x (n,) and p that returns (n,)
    x, p : [SI] start, corrected before the walk: at fixed p, or across `tangent` when that is given
    jacobian : function of x and p that returns (d residual/dx (n, n), d residual/dp (n,)); default central differences
    control : :class:`StepControl`
    direction : +1 walks towards larger p first, -1 towards smaller
    tangent : (n + 1,) in scaled variables, to start along instead of by `direction`
    bounds : (low, high) of p; the walk lands on the bound it meets
    x_scale, p_scale : typical sizes; all lengths and tolerances are relative to them
    closes : end when the path comes back to its start

    When the iteration ends, `outcome` is "completed" (bound reached or path closed), "most_points", "step_underflow"
    (a corner, an end or a noisy residual), "no_landing", or "no_start" (then there was no point at all).

    >>> circle = follow(lambda x, p: x**2 + p**2 - 1.0, 1.0, 0.0)
    >>> len([point for point in circle if point.fold])
    2
    >>> circle.outcome.evidence
    {'closed': True}
    """
    return Follower(residual, x, p, **options)


def along(path: Path, x: ArrayLike, p: float, **options: Any) -> Follower:
    """The walk along a path, with the other options of :func:`follow`."""
    return follow(path.residual, x, p, jacobian=path.jacobian, x_scale=path.scale, p_scale=path.span, **options)
