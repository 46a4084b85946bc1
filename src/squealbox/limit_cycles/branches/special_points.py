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

from squealbox.continuation import Equation, PathPoint, null_vector
from squealbox.limit_cycles.branches.paths import CyclePath
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


def doubling(multipliers: np.ndarray) -> float:
    """prod (mu_i + 1): zero where a multiplier is -1."""
    return float(np.prod(multipliers[1:] + 1.0).real)


def torus(multipliers: np.ndarray) -> float:
    """prod over pairs (mu_i mu_j - 1): zero with a complex pair on the unit circle, or a real pair of product 1."""
    pairs = itertools.combinations(multipliers[1:], 2)
    return float(np.prod([a * b - 1.0 for a, b in pairs]).real) if len(multipliers) > 2 else 1.0


def is_torus(multipliers: np.ndarray) -> bool:
    """True when the pair whose product is nearest to 1 is complex."""
    pairs = list(itertools.combinations(multipliers[1:], 2))
    a, _ = pairs[int(np.argmin([abs(a * b - 1.0) for a, b in pairs]))]
    return bool(abs(a.imag) > 1e-6 * abs(a))


@dataclass(frozen=True)
class Event:
    """What is looked for on a path: where a test function of one thing a path tells of a cycle changes its sign.

    of : what that is, such as "multipliers"; "along" is the parameter's part of the unit tangent
    jumps : the test function has a sign only, so its place is found by halving
    meant : whether a zero is one of this kind, where that is not sure
    told : whether a change of sign is reported also where its place could not be solved for
    """

    kind: str
    of: str
    test: Callable[[Any], float]
    jumps: bool = False
    meant: Callable[[Any], bool] | None = None
    told: bool = True


EVENTS = {
    each.kind: each
    for each in (
        Event("fold", "along", float),
        Event("period_doubling", "multipliers", doubling),
        Event("neimark_sacker", "multipliers", torus, meant=is_torus, told=False),  # else it may be a neutral saddle
        Event("grazing", "least_slip", float),
        Event("sticking", "sticking", lambda time: 1.0 if time > 0.0 else -1.0, jumps=True),
    )
}


class Chord:
    """The stretch of a path between two of its points, as a function of the share s of the chord."""

    def __init__(self, path: CyclePath, a: PathPoint, b: PathPoint) -> None:
        self.path, self.equation = path, Equation.of(path)
        self.a, self.b = (self.equation.y(point.x, point.p) for point in (a, b))
        self.normal = (self.b - self.a) / np.linalg.norm(self.b - self.a)
        self.tangents = a.tangent, b.tangent
        self.length = b.arclength - a.arclength
        self.kept: Any = None

    def at(self, s: float) -> tuple[Any, float]:
        """(x, p) of the path over the share s; `OffPathError` where Newton's method does not reach it."""
        h0, h1 = s * (1.0 - s) ** 2 * self.length, -(s**2) * (1.0 - s) * self.length
        ends = (3.0 - 2.0 * s) * s**2
        y = (1.0 - ends) * self.a + ends * self.b + h0 * self.tangents[0] + h1 * self.tangents[1]
        y = y + self.normal * (self.normal @ (self.a + s * (self.b - self.a) - y))
        found = self.equation.corrected(y, self.normal, NEWTON_STEPS, CLOSE, kept=self.kept)
        if found.y is None:
            raise OffPathError
        self.kept = found.kept
        return self.equation.point(found.y)

    def told(self, event: Event, s: float) -> Any:
        """What the test function is of."""
        x, p = self.at(s)
        if event.of == "along":
            return null_vector(self.equation.derivative(self.equation.y(x, p)), self.normal)[-1]
        return getattr(self.path, event.of)(x, p)


class OffPathError(ArithmeticError):
    """A trial point could not be corrected to the path."""


def located(path: CyclePath, a: PathPoint, b: PathPoint, event: Event) -> tuple[Any, float, float, float] | None:
    """(x, p, test, uncertainty) of the special point of that kind between two points, or None where it is not found.

    Accuracy: s to 1e-11 of the chord, so p to that share of the step, or to the residual of the path. A fold is flat in
    s and better still. None where the path between the points could not be corrected, or the zero is another kind's.
    """
    from scipy.optimize import brentq

    chord = Chord(path, a, b)

    def value(s: float) -> float:
        return event.test(chord.told(event, s))

    try:
        if event.jumps:
            s, width = _halved(value)
        else:
            s, width = float(brentq(value, 0.0, 1.0, xtol=SHARE, rtol=4.0 * np.finfo(float).eps)), SHARE
        (x, p), beside, told = chord.at(s), chord.at(max(s - width, 0.0)), chord.told(event, s)
    except (OffPathError, ValueError):  # ValueError: the corrected ends do not bracket a zero
        return None
    return (
        (x, p, event.test(told), max(abs(p - beside[1]), 1e-15 * abs(p)))
        if event.meant is None or event.meant(told)
        else None
    )


def _halved(value: Callable[[float], float]) -> tuple[float, float]:
    low, high, sign = 0.0, 1.0, value(0.0)
    if sign * value(1.0) > 0.0:
        raise ValueError("no change between the ends")
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        low, high = (middle, high) if value(middle) == sign else (low, middle)
    return low, high - low


def candidates(seen: list[dict[str, Any]]) -> list[tuple[Event, int]]:
    """(event, index of the point before) wherever a test function changes its sign along a walk."""
    found = []
    for i, pair in enumerate(itertools.pairwise(seen)):
        for event in EVENTS.values():
            before, after = (event.test(about[event.of]) for about in pair)
            flat = event.kind == "fold" and abs(before) + abs(after) <= STRAIGHT
            stuck = event.kind == "grazing" and any(about["sticking"] > 0.0 for about in pair)
            if before * after < 0.0 and not flat and not stuck:
                found.append((event, i))
    return found


def branch_point(
    path: CyclePath, x: np.ndarray, p: float, kind: str, parameter: str, test: float, uncertainty: float
) -> BranchPoint:
    """The cycle at a point of a path, with its name and evidence."""
    cycle = path.cycle(x, p)
    names = [each.name for each in fields(Cycle) if each.name != "provenance"]
    return BranchPoint(**{name: getattr(cycle, name) for name in names}, kind=kind, parameter=parameter,
                       value=np.asarray(p), test=np.asarray(test), uncertainty=np.asarray(uncertainty))  # fmt: skip
