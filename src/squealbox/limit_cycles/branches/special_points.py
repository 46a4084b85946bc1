"""Special points of a branch, solved for: the place on the path where a test function is zero.

Between two points of a path y = (x, p) the test function g is solved for by Brent's method in the share s of the chord;
each trial is corrected to the path on the plane normal to the chord. With mu_i the multipliers but the trivial one,

fold             g = dp/ds, the parameter's part of the unit tangent
period_doubling  g = prod (mu_i + 1)                 a real multiplier passes -1; a complex pair leaves the sign alone
neimark_sacker   g = prod_{i<j} (mu_i mu_j - 1)      a complex pair passes the unit circle; a real pair with product 1,
                                                     a neutral saddle, has the same zero and is left out by its kind
grazing          g = least sliding speed             a contact just touches v = 0
sticking         the sign of the sticking time; it has no slope, so s is halved

Source of the products: Kuznetsov 2004, Elements of Applied Bifurcation Theory, Sec. 10.2.
"""

import itertools
from collections.abc import Callable
from dataclasses import dataclass, fields
from typing import Any

import numpy as np

from squealbox.continuation import KEEP, SLOW, PathPoint
from squealbox.limit_cycles.cycles.cycle import Cycle
from squealbox.result import quantity

STRAIGHT = 1e-11  # a tangent or a relative range of the parameter below it is round-off: the branch goes straight up
SHARE = 1e-11  # of the chord, to which s is solved for
HALVINGS = 30
NEWTON_STEPS = 12
CLOSE = 1e-10  # largest scaled correction of a point that lies on the path


@dataclass(frozen=True, kw_only=True, eq=False)
class BranchPoint(Cycle):
    """A special point of a branch: the cycle there, what it is, and how well it was located.

    Give it to :func:`branch` as its start: from a period doubling that leads onto the branch of doubled period.
    """

    value: Any = quantity("", "", "value of the parameter, in its own unit")
    test: Any = quantity("", "", "what is left of the test function of its kind")
    uncertainty: Any = quantity("", "", "how far the parameter moves over the last bracket")
    kind: str = ""
    parameter: str = ""

    def summary(self) -> str:
        """One line: kind, value, its uncertainty and the test function as evidence."""
        where = f"{self.kind} at {self.parameter} = {float(self.value):.10g} (to {float(self.uncertainty):.1e})"
        return f"{where}, test function {float(self.test):.1e}, period {float(self.period):.8g} s"


def doubling(about: dict[str, Any]) -> float:
    """prod (mu_i + 1): zero where a multiplier is -1."""
    return float(np.prod(about["multipliers"][1:] + 1.0).real)


def torus(about: dict[str, Any]) -> float:
    """prod over pairs (mu_i mu_j - 1): zero with a complex pair on the unit circle, or a real pair of product 1."""
    pairs = itertools.combinations(about["multipliers"][1:], 2)
    return float(np.prod([a * b - 1.0 for a, b in pairs]).real) if len(about["multipliers"]) > 2 else 1.0


def is_torus(multipliers: Any) -> bool:
    """True when the pair whose product is nearest to 1 is complex."""
    pairs = list(itertools.combinations(multipliers[1:], 2))
    a, _ = pairs[int(np.argmin([abs(a * b - 1.0) for a, b in pairs]))]
    return bool(abs(a.imag) > 1e-6 * abs(a))


TESTS: dict[str, Callable[[dict[str, Any]], float]] = {
    "period_doubling": doubling,
    "neimark_sacker": torus,
    "grazing": lambda about: about["least_slip"] if about["sticking"] == 0.0 else np.nan,
    "sticking": lambda about: 1.0 if about["sticking"] > 0.0 else -1.0,
}


class Chord:
    """The stretch of a path between two of its points, as a function of the share s of the chord."""

    def __init__(self, path: Any, a: PathPoint, b: PathPoint) -> None:
        self.path, self.scale = path, np.append(path.scale, path.span)
        self.a, self.b = (np.append(point.x, point.p) / self.scale for point in (a, b))
        self.normal = (self.b - self.a) / np.linalg.norm(self.b - self.a)
        self.tangents = a.tangent, b.tangent
        self.length = b.arclength - a.arclength
        self.kept: Any = None  # the derivative of the last trial, which is near enough for the next one beside it

    def derivative(self, y: Any) -> Any:
        """d residual / dy in scaled variables, shape (n, n + 1)."""
        x = y * self.scale
        return np.column_stack(self.path.jacobian(x[:-1], float(x[-1]))) * self.scale

    def at(self, s: float) -> tuple[Any, float] | None:
        """(x, p) of the path over the share s, or None where Newton's method does not reach it."""
        h0, h1 = s * (1.0 - s) ** 2 * self.length, -(s**2) * (1.0 - s) * self.length
        ends = (3.0 - 2.0 * s) * s**2
        y = (1.0 - ends) * self.a + ends * self.b + h0 * self.tangents[0] + h1 * self.tangents[1]
        y = y + self.normal * (self.normal @ (self.a + s * (self.b - self.a) - y))
        matrix, last = self.kept, np.inf
        for _ in range(NEWTON_STEPS):
            x = y * self.scale
            value = self.path.residual(x[:-1], float(x[-1]))
            if not np.all(np.isfinite(value)):
                return None
            if matrix is None or KEEP < last < np.inf:
                matrix = np.vstack([self.derivative(y), self.normal])
            if not np.all(np.isfinite(matrix)):
                return None
            change = np.linalg.lstsq(matrix, np.append(value, 0.0), rcond=None)[0]
            y, before, last = y - change, last, float(np.max(np.abs(change)))
            if last > SLOW * before:
                matrix = None
            if last < CLOSE:
                self.kept = matrix
                x = y * self.scale
                return x[:-1], float(x[-1])
        return None

    def tangent_p(self, x: Any, p: float) -> float:
        """The parameter's part of the unit tangent, along the chord."""
        _, _, rows = np.linalg.svd(self.derivative(np.append(x, p) / self.scale))
        return float(rows[-1][-1] * np.sign(rows[-1] @ self.normal))

    def test(self, kind: str, x: Any, p: float) -> float:
        """The test function of a kind."""
        if kind == "fold":
            return self.tangent_p(x, p)
        if kind == "grazing":
            return float(self.path.least_slip(x, p))
        if kind == "sticking":
            return 1.0 if self.path.sliding(x, p)[1] > 0.0 else -1.0
        return TESTS[kind](self.path.describe(x, p))


class OffPathError(ArithmeticError):
    """A trial point could not be corrected to the path."""


def located(path: Any, a: PathPoint, b: PathPoint, kind: str) -> tuple[Any, float, float, float] | None:
    """(x, p, test, uncertainty) of the special point of that kind between two points, or None where it is not found.

    Accuracy: s to 1e-11 of the chord, so p to that share of the step, or to the residual of the path. A fold is flat in
    s and better still. None where the path between the points could not be corrected, or the zero is another kind's.
    """
    from scipy.optimize import brentq

    chord = Chord(path, a, b)

    def value(s: float) -> float:
        found = chord.at(s)
        if found is None:
            raise OffPathError
        return chord.test(kind, *found)

    try:
        if kind == "sticking":
            s, width = _halved(value)
        else:
            s, width = float(brentq(value, 0.0, 1.0, xtol=SHARE, rtol=4.0 * np.finfo(float).eps)), SHARE
    except (OffPathError, ValueError):  # ValueError: the corrected ends do not bracket a zero
        return None
    at, beside = chord.at(s), chord.at(max(s - width, 0.0))
    if at is None or beside is None:
        return None
    x, p = at
    if kind == "neimark_sacker" and not is_torus(path.describe(x, p)["multipliers"]):
        return None
    return x, p, chord.test(kind, x, p), max(abs(p - beside[1]), 1e-15 * abs(p))


def _halved(value: Callable[[float], float]) -> tuple[float, float]:
    low, high, sign = 0.0, 1.0, value(0.0)
    if sign * value(1.0) > 0.0:
        raise ValueError("no change between the ends")
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if value(middle) == sign else (low, middle)
    return low, high - low


def candidates(visited: list[PathPoint], seen: list[dict[str, Any]]) -> list[tuple[str, int]]:
    """(kind, index of the point before) wherever a test function changes its sign along a walk."""
    found = []
    for i, (a, b) in enumerate(itertools.pairwise(visited)):
        turns = abs(a.tangent[-1]) + abs(b.tangent[-1]) > STRAIGHT
        if turns and a.tangent[-1] * b.tangent[-1] < 0.0:
            found.append(("fold", i))
        found += [(kind, i) for kind, test in TESTS.items() if test(seen[i]) * test(seen[i + 1]) < 0.0]
    return found


def branch_point(
    path: Any, x: Any, p: float, kind: str, parameter: str, test: float, uncertainty: float
) -> BranchPoint:
    """The cycle at a point of a path, with its name and evidence."""
    cycle = path.cycle(x, p)
    names = [each.name for each in fields(Cycle) if each.name != "provenance"]
    return BranchPoint(**{name: getattr(cycle, name) for name in names}, kind=kind, parameter=parameter,
                       value=np.asarray(p), test=np.asarray(test), uncertainty=np.asarray(uncertainty))  # fmt: skip
