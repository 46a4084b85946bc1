"""Curves over two parameters: their result, and the curve of Hopf points.

A Hopf curve is the root of the extended system in (u, w, omega, a) over b, with q = u + i w, A(a, b) df/dx at steady
sliding and q0 the vector at the start:

    A u + omega w = 0,    A w - omega u = 0,    <q0, q> = 1

It is followed in both directions by pseudo-arclength. Source: Govaerts 2000, Numerical Methods for Bifurcations of
Dynamical Equilibria, Ch. 4.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.arguments import public
from squealbox.continuation import StepControl, follow
from squealbox.family import Bounds, DesignOrRecipe, Family
from squealbox.limit_cycles.branches.hopf import (
    HopfPoint,
    critical_pair,
    hopf_point,
    lyapunov_coefficient,
    steady_modes,
)
from squealbox.limit_cycles.cycles.field import Field
from squealbox.limit_cycles.cycles.starting import steady_state
from squealbox.parameters import DataSheet, ParameterError
from squealbox.result import Array, Outcome, Result, quantity
from squealbox.system import System


@dataclass(frozen=True, kw_only=True, eq=False)
class PointCurve(Result):
    """A curve of special points over two parameters, as :func:`hopf_curve` and :func:`point_curve` return it."""

    x: Array = quantity("point", "", "first parameter, in its own unit")
    y: Array = quantity("point", "", "second parameter, in its own unit")
    frequency: Array = quantity("point", "Hz", "frequency there")
    residual: Array = quantity("point", "1", "largest scaled residual of the extended system")
    lyapunov: Array = quantity("point", "1", "first Lyapunov coefficient of Hopf points; NaN on other curves")
    parameters: tuple[str, ...] = ()
    kind: str = ""

    def summary(self) -> str:
        """One line: kind, points and ranges."""
        if len(self.x) == 0:
            return f"{self.kind} curve: {self.outcome.told}"
        spans = [f"{name} {np.min(v):.6g} to {np.max(v):.6g}"
                 for name, v in zip(self.parameters, (self.x, self.y), strict=True)]  # fmt: skip
        return f"{self.kind} curve, {len(self.x)} points: {', '.join(spans)}; ended: {self.outcome.message}"


@public()
def hopf_curve(
    design: DesignOrRecipe, bounds: Mapping[str, Bounds], *, value: float | None = None, points: int = 100
) -> PointCurve:
    """Hopf points over two parameters, through the first one found in the first parameter.

    Parameters
    ----------
    design : a design, or a function of two values that returns a design or system
    bounds : name to (low, high) for two parameters
    value : of the second parameter, in its own unit, at which the start is looked for; None takes the middle
    points : most points in each direction

    Outcome "completed" where both ends reach a bound or the curve closes, else why it ended, or that of `hopf_point`
    where there is no start. Accuracy: 1e-10 of the ranges. Source: as this module.

    >>> from squealbox import DrumBrake, LinearSlope
    >>> brake = DrumBrake(friction=LinearSlope(0.3, -0.05))
    >>> hopf_curve(brake, {"friction.static": (0.1, 0.6), "load": (500.0, 2000.0)}).outcome.ok
    True
    """
    family = Family.within("hopf_curve", design, bounds, count=2)
    make, names, spans = family.system, family.parameters, family.spans
    (low, high), (bottom, top) = spans
    middle = 0.5 * (bottom + top) if value is None else float(value)
    born = hopf_point(lambda a: make(a, middle), {names[0]: (low, high)})
    if not born.outcome.ok:
        return curve_of(design, [], lambda *_: (0.0, 0.0), names, "hopf", born.outcome)
    extended = _Hopf(make, born, (high - low, top - bottom))
    walks = both_ways(extended.residual, extended.start, middle, spans, extended.scale(), points, extended.jacobian)
    return curve_of(design, walks, extended.describe, names, "hopf", ending(walks))


class _Hopf:
    """The extended system of a Hopf point, in states scaled to velocities."""

    def __init__(
        self, make: Callable[[float, float], System], born: HopfPoint, widths: tuple[float, float]
    ) -> None:  # fmt: skip
        self.make, self.widths = make, widths
        self.units = Field(born.inputs["system"]).scale
        q = born.shape * self.units
        self.reference = q / np.linalg.norm(q)
        self.rate = born.angular_frequency
        self.start = np.concatenate([self.reference.real, self.reference.imag, [self.rate, float(born.value)]])

    def scale(self) -> Any:
        """Typical sizes of the unknowns."""
        return np.concatenate([np.ones(len(self.start) - 2), [self.rate, self.widths[0]]])

    def matrix(self, a: float, b: float) -> Any:
        """df/dx about steady sliding; NaN outside the range of a parameter."""
        try:
            field = Field(self.make(float(a), float(b)))
        except ParameterError:
            return np.full((len(self.units), len(self.units)), np.nan)
        steady = steady_state(field)
        return field.jacobian(steady, steady_modes(field, steady)) * (self.units[:, None] / self.units)

    def residual(self, x: np.ndarray, b: float) -> Any:
        """Of the extended system, over the frequency at the start; NaN outside the range of a parameter."""
        u, w, omega, a = *np.split(x[:-2], 2), x[-2], x[-1]
        matrix = self.matrix(a, b)
        phase = np.vdot(self.reference, u + 1j * w) - 1.0
        parts = [(matrix @ u + omega * w) / self.rate, (matrix @ w - omega * u) / self.rate]
        return np.concatenate([*parts, [phase.real, phase.imag]])

    def jacobian(self, x: np.ndarray, b: float) -> tuple[Any, Any]:
        """By the unknowns and by the second parameter; the matrix by both from central differences."""
        u, w, omega, a = *np.split(x[:-2], 2), x[-2], x[-1]
        matrix, one, none = self.matrix(a, b), np.eye(len(u)), np.zeros(1)
        by = []
        for da, db in np.diag(self.widths) * np.cbrt(np.finfo(float).eps):
            slope = (self.matrix(a + da, b + db) - self.matrix(a - da, b - db)) / (2.0 * (da + db))
            by.append(np.concatenate([slope @ u / self.rate, slope @ w / self.rate, none, none]))
        r, s = self.reference.real, self.reference.imag
        by_motion = np.block([[matrix / self.rate, omega / self.rate * one], [-omega / self.rate * one,
                             matrix / self.rate], [r, s], [-s, r]])  # fmt: skip
        by_omega = np.concatenate([w / self.rate, -u / self.rate, none, none])
        return np.column_stack([by_motion, by_omega, by[0]]), by[1]

    def describe(self, x: np.ndarray, b: float) -> tuple[float, float]:
        """Frequency [Hz] and first Lyapunov coefficient."""
        field = Field(self.make(float(x[-1]), float(b)))
        eigenvalue, q, p, steady = critical_pair(field, float(x[-2]))
        return float(x[-2]) / (2.0 * np.pi), lyapunov_coefficient(field, steady, eigenvalue.imag, q, p)


def both_ways(
    residual: Callable[[Any, float], Any],
    x: np.ndarray,
    b: float,
    spans: Sequence[Bounds],
    scale: np.ndarray,
    points: int,
    jacobian: Callable[[Any, float], Any] | None = None,
) -> list[Any]:
    """Points (x, b, residual) from one end of the curve to the other, and how the two walks ended."""
    (low, high), (bottom, top) = spans
    walks = []
    for way in (-1.0, 1.0):
        control = StepControl(
            first=1e-2, largest=0.2, most_points=points, tolerance=1e-9, newton_steps=12, wanted_steps=5
        )
        walk = follow(residual, x, b, control=control, direction=way, bounds=(bottom, top), x_scale=scale,
                      p_scale=top - bottom, jacobian=jacobian)  # fmt: skip
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


def ending(walks: list[Any]) -> Outcome:
    """Where both walks ended, or why one ended early."""
    bad = [outcome for _, outcome in walks if not outcome.ok]
    if bad:
        return Outcome(str(bad[0]), bad[0].message, **bad[0].evidence)
    return Outcome(message="; ".join(outcome.message for _, outcome in walks))


def curve_of(
    design: DesignOrRecipe,
    walks: list[Any],
    describe: Callable[[Any, float], Any],
    names: tuple[str, ...],
    kind: str,
    outcome: Outcome,
) -> PointCurve:
    """The result of the walks; a design is kept, since it knows the units of its parameters."""
    line = [at for i, (kept, _) in enumerate(walks) for at in (kept[:0:-1] if i == 0 and len(walks) > 1 else kept)]
    about = np.array([describe(at.x, at.p) for at in line]).reshape(-1, 2)
    return PointCurve(
        inputs={"system": design} if isinstance(design, DataSheet) else {}, outcome=outcome,
        x=np.array([at.x[-1] for at in line]), y=np.array([at.p for at in line]), frequency=about[:, 0],
        residual=np.array([at.residual for at in line]), lyapunov=about[:, 1], parameters=names, kind=kind,
    )  # fmt: skip
