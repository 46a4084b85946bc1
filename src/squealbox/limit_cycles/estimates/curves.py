"""Quick estimates as curves over a parameter, to be drawn beside branches.

The describing function is harmonic balance with one harmonic, sgn(v) smoothed by tanh over a small share of the sliding
speed and sampled finely enough for it. One curve is followed through each branch, from the first of its cycles from
which the one-harmonic balance is solved. Averaging is `estimates.averaged_curve`.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.arguments import public
from squealbox.continuation import StepControl, along
from squealbox.family import Bounds, DesignOrRecipe, Family, Varied
from squealbox.limit_cycles.branches.branch import Branch
from squealbox.limit_cycles.branches.harmonic_path import HarmonicPath
from squealbox.limit_cycles.cycles.harmonic_balance import Grid, harmonic_balance
from squealbox.limit_cycles.estimates.averaging import averaged_curve
from squealbox.system import System

WIDTH = 5e-2  # of the fastest sliding speed, over which sgn(v) is smoothed; the balance is seldom solved with less
SAMPLES = 1024  # of a period, some ten of them within that width, and more where v turns
TRIED = 5  # cycles of a branch from which the balance is tried
POINTS = 60  # of a curve, each way
LEAST = 0.02  # of the largest amplitude of a curve: it ends where it shrinks to steady sliding
SAME = 0.02  # of the ranges of a figure: a curve that passes nearer than this is the same curve
DESCRIBING = "describing function (one harmonic)"
AVERAGED = "averaging (Thomsen-Fidlin), slip only"


@dataclass(frozen=True, eq=False, repr=False)
class EstimateCurve:
    """A quick estimate over a parameter: its name, values (k,), amplitudes (k, dof) [m], and where it may be trusted.

    off, most : |amplitude / amplitude of the nearest cycle followed - 1|, of the degree of freedom that moves most:
        half of the length of the curve, as it is drawn, is within `off`, nine tenths within `most`; NaN where no cycle
        was followed at its values
    """

    label: str
    value: Any
    amplitude: Any
    validity: str
    off: float = float("nan")
    most: float = float("nan")

    def __repr__(self) -> str:
        return f"{self.label}: {self.validity}" + (f"; {self.beside}" if np.isfinite(self.off) else "")

    @property
    def beside(self) -> str:
        """How far the curve is from the cycles followed, in words."""
        half, most = (float(f"{100.0 * share:.2g}") for share in (self.off, self.most))
        return f"half within {half:g} %, nine tenths within {most:g} % of the cycles"


@public()
def estimate_curves(
    design: DesignOrRecipe, parameter: Varied, bounds: Bounds | None = None, branches: Sequence[Branch] = ()
) -> tuple[EstimateCurve, ...]:
    """The describing function through each branch, and averaging where the system is a block on a belt.

    Parameters
    ----------
    design, parameter, bounds : as for :func:`branch`, in the parameter's own unit
    branches : of the same design and parameter

    Accuracy: none is promised; `EstimateCurve.off` says how far each is from the cycles followed. Where the balance is
    not solved from any of a branch's cycles that branch has no curve. Source: Gelb and Vander Velde 1968; Thomsen and
    Fidlin 2003, as in `describing_function` and `averaged_swings`.

    >>> from squealbox import DrumBrake, LinearSlope, branch, shooting
    >>> drum = DrumBrake(friction=LinearSlope(0.45, -0.05))
    >>> walk = branch(drum, "friction.static", (0.4, 0.5), shooting(drum), value=0.45, method="shooting", points=3)
    >>> [curve.label for curve in estimate_curves(drum, "friction.static", (0.4, 0.5), [walk])]
    ['describing function (one harmonic)']
    """
    family = Family.within("estimate_curves", design, parameter, bounds)
    (low, high), found = family.spans[0], list[EstimateCurve]()
    for one in branches:
        curve = _through(family, one, found)
        if curve is not None:
            found.append(curve)
    values, sizes = averaged_curve(design, {family.name: np.linspace(low, high, 201)})
    if len(values):
        validity = "holds for damping and friction small against the spring"
        found.append(EstimateCurve(AVERAGED, values, sizes[:, None], validity))
    return tuple(EstimateCurve(c.label, c.value, c.amplitude, c.validity, *_off(c, branches)) for c in found)


def _through(family: Family, one: Branch, known: list[EstimateCurve]) -> EstimateCurve | None:
    """The describing function through a branch; None where it is not found, or is one of the known curves."""
    if len(one.value) == 0:
        return None
    make, bounds = family.system, family.spans[0]
    order = np.argsort(~one.stable, kind="stable")  # stable cycles first
    for i in order[np.linspace(0, len(order) - 1, TRIED + 2).astype(int)[1:-1]]:
        value, start, n = float(one.value[i]), one.start[i], one.amplitude.shape[1]
        width = WIDTH * _fastest(make(value))
        if not width > 0.0:
            return None
        begin = (start[:n], start[n:], float(one.period[i]))
        cycle = harmonic_balance(make(value), begin, contact="tanh", width=width, harmonics=1, samples=SAMPLES)
        if not cycle.outcome.ok:
            continue
        path = HarmonicPath(make, "tanh", width, Grid(1, SAMPLES), bounds[1] - bounds[0])
        x = path.begin(path.grid.series(cycle.q[:-1][:: (len(cycle.q) - 1) // SAMPLES]), 2.0 * np.pi * cycle.frequency,
                       value, float(np.max(cycle.amplitude)))  # fmt: skip
        if any(_near(curve, value, cycle.amplitude, bounds, one) for curve in known):
            return None
        back, forth = (_followed(path, x, value, bounds, way) for way in (-1.0, 1.0))
        points = back[:0:-1] + forth
        if len(points) < 2:  # the first step of the walk did not converge
            continue
        validity = "holds while higher harmonics are small"
        return EstimateCurve(DESCRIBING, np.array([p for p, _ in points]), np.array([a for _, a in points]), validity)
    return None


def _fastest(system: System) -> float:
    return max((abs(float(np.asarray(c.V))) for c in system.contacts), default=0.0)


def _followed(
    path: HarmonicPath, x: np.ndarray, p: float, bounds: tuple[float, float], way: float
) -> list[tuple[float, Any]]:
    """(value, amplitudes) along the curve one way, until it leaves the bounds or shrinks to steady sliding."""
    control = StepControl(first=1e-2, largest=0.1, most_points=POINTS, tolerance=1e-8, newton_steps=6)
    walk = along(path, x, p, control=control, direction=way, bounds=bounds)
    start, _ = path.series(x)
    column = path.column - 2 * start.shape[1]  # its sign changes where the amplitude passes zero
    points: list[tuple[float, Any]] = []
    for point in walk:
        series, _ = path.series(point.x)
        points.append((point.p, np.hypot(series[1], series[2])))
        largest = max(float(np.max(size)) for _, size in points)
        turned = start[1, column] * series[1, column] < 0.0
        if turned or np.max(points[-1][1]) < LEAST * largest:
            return points[:-1] if turned else points
    return points


def _near(curve: EstimateCurve, value: float, size: np.ndarray, bounds: tuple[float, float], one: Branch) -> bool:
    """True where a curve passes through an amplitude at a value, nearly."""
    scale = np.append(bounds[1] - bounds[0], np.max(one.amplitude))
    here = np.append(value, np.max(size)) / scale
    there = np.column_stack([curve.value, np.max(curve.amplitude, axis=1)]) / scale
    return bool(len(there) and np.min(np.linalg.norm(there - here, axis=1)) < SAME)


def _off(curve: EstimateCurve, branches: Sequence[Branch]) -> tuple[float, float]:
    """How far half of the curve, and nine tenths, are from the nearest cycles followed at its values.

    Points weigh by the length of the curve about them: they are packed where it turns or goes straight up.
    """
    slips, away = curve.label == AVERAGED, []
    drawn = np.column_stack([curve.value, np.max(curve.amplitude, axis=1)])
    steps = np.linalg.norm(np.diff(drawn / np.maximum(np.ptp(drawn, axis=0), 1e-300), axis=0), axis=1)
    lengths = 0.5 * (np.append(steps, 0.0) + np.append(0.0, steps))
    for value, size, length in zip(curve.value, curve.amplitude, lengths, strict=True):
        dof = int(np.argmax(size))
        cycles = [a for one in branches for a in _at(one, float(value), dof, slips)]
        if cycles and size[dof] > 0.0:
            away.append((min(abs(size[dof] / a - 1.0) for a in cycles), length))
    if not away:
        return float("nan"), float("nan")
    errors, weights = np.array(sorted(away)).T
    half, most = np.searchsorted(np.cumsum(weights), np.array([0.5, 0.9]) * np.sum(weights))
    return float(errors[half]), float(errors[most])


def _at(one: Branch, value: float, dof: int, slips: bool) -> list[float]:
    """Amplitudes of a branch at a value, by interpolation between its points; `slips`: of cycles without sticking."""
    beside, size = one.value - value, one.amplitude[:, dof]
    counts = (one.least_slip > 0.0) | (not slips)
    i = np.flatnonzero((beside[:-1] * beside[1:] < 0.0) & counts[:-1] & counts[1:])
    share = beside[i] / (beside[i] - beside[i + 1])
    return [float(a) for a in size[i] + share * (size[i + 1] - size[i])]
