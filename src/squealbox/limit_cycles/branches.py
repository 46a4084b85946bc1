"""Branches of cycles over a parameter: stable and unstable parts, folds and the other places where stability changes.

Continuation walks the path (`squealbox.continuation`); this module starts it, reads each point and finds

fold             the path turns back in the parameter: p(s) between two points is a Hermite cubic, and p' = 0 on it
period_doubling  a real multiplier passes -1
neimark_sacker   a complex pair leaves the unit circle
grazing          least sliding speed reaches zero (harmonic balance with exact contact ends there)
sticking         a sticking phase appears or vanishes (shooting)

Folds carry the error of the cubic, of order 4 in the step; the grazing at which an exact branch ends is solved for; the
others carry the error of a linear interpolation.
"""

import itertools
from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.continuation import Follower, PathPoint, StepControl, follow
from squealbox.limit_cycles.cycle import Cycle, extremes
from squealbox.limit_cycles.harmonic_balance import Grid, harmonic_balance
from squealbox.limit_cycles.hopf import HopfPoint, family
from squealbox.limit_cycles.paths import HarmonicPath, ShootingPath
from squealbox.limit_cycles.shooting import CONTACTS, shooting
from squealbox.parameters import ParameterError, known_names
from squealbox.result import COMPLETED, Outcome, Result, quantity

METHODS = ("harmonic_balance", "shooting")
METHODS_FROM_HOPF = ("harmonic_balance", "exact")


@dataclass(frozen=True, kw_only=True, eq=False)
class Branch(Result):
    """Cycles along a branch, in the order walked, as :func:`branch` returns it."""

    value: Any = quantity("point", "", "value of the parameter, in its own unit")
    period: Any = quantity("point", "s", "period")
    lowest: Any = quantity("point dof", "m", "least displacement")
    highest: Any = quantity("point dof", "m", "largest displacement")
    multipliers: Any = quantity("point multiplier", "1", "Floquet multipliers, the trivial one first")
    least_slip: Any = quantity(
        "point", "m/s", "least sliding speed in the sense of V; negative where a contact reverses"
    )
    sticking: Any = quantity("point", "s", "longest sticking time of a contact in a period")
    unknowns: Any = quantity("point unknown", "", "what was followed")
    special_kind: Any = quantity("special", "", "fold, period_doubling, neimark_sacker, grazing or sticking")
    special_value: Any = quantity("special", "", "value of the parameter there")
    special_point: Any = quantity("special", "1", "index of the point before it")
    parameter: str = ""

    @property
    def amplitude(self) -> Any:
        """Half peak to peak [m], shape (point, dof)."""
        return 0.5 * (self.highest - self.lowest)

    @property
    def stable(self) -> Any:
        """True where all multipliers but the trivial one lie inside the unit circle, shape (point,)."""
        return np.all(np.abs(self.multipliers[:, 1:]) < 1.0, axis=1)

    def special(self, kind: str) -> Any:
        """Parameter values of one kind of special point."""
        return self.special_value[self.special_kind == kind]

    def summary(self) -> str:
        """What the branch holds, in a few lines."""
        if len(self.value) == 0:
            return f"{self.parameter}: {self.outcome}: {self.outcome.message}"
        low, high = np.min(self.value), np.max(self.value)
        walked = f"{len(self.value)} cycles, {self.parameter} from {low:.6g} to {high:.6g}"
        ended = f"{self.outcome} {self.outcome.message}".rstrip()
        lines = [f"{walked}, {int(np.sum(self.stable))} stable; ended: {ended}"]
        lines += [f"{kind} at {value:.8g}" for kind, value in zip(self.special_kind, self.special_value, strict=True)]
        return "\n".join(lines)

    def __repr__(self) -> str:
        return self.summary()


def branch(
    design: Any,
    parameter: str,
    bounds: tuple[float, float],
    start: Any = None,
    *,
    value: float | None = None,
    method: str = "harmonic_balance",
    contact: str = "exact",
    width: float = 1e-3,
    harmonics: int = 9,
    direction: float = 1.0,
    points: int = 200,
    largest_step: float = 0.05,
    rtol: float = 1e-11,
) -> Branch:
    """Follow cycles in one parameter through folds.

    Parameters
    ----------
    design : a design, or a function of one value that returns a design or system
    parameter, bounds : dotted name and the range walked
    start : a `HopfPoint` (the branch born there), or what :func:`shooting` takes, at `value` of the parameter
    value : where to start from; None takes the middle of the bounds
    method : "harmonic_balance" (smooth or smoothed cycles, fast) or "shooting" (exact stick and slip)
    contact, width, harmonics : for harmonic balance
    direction : +1 walks to larger values first, -1 to smaller
    points : most points; largest_step : longest step, in shares of the range and of the size of the motion
    rtol : for shooting

    Outcome "completed" at a bound, "most_points", "grazing" (harmonic balance with exact contact at the first contact
    that reverses), "step_underflow" (a corner: with shooting, where a sticking phase begins or ends) or why there was
    no start. Accuracy: that of the method with these harmonics. Source: Keller 1977.

    >>> from squealbox import DrumBrake, LinearSlope
    >>> from squealbox.limit_cycles import hopf_point
    >>> brake = DrumBrake(friction=LinearSlope(0.3, -0.05))
    >>> onset = hopf_point(brake, "friction.static", (0.1, 0.6))
    >>> str(branch(brake, "friction.static", (0.1, 0.6), onset, points=150).outcome)
    'grazing'
    """
    if method not in METHODS:
        raise ParameterError("branch", "method", method, known_names(str(method), list(METHODS)))
    span = float(bounds[1] - bounds[0])
    make = family(design, parameter)
    middle = 0.5 * (bounds[0] + bounds[1]) if value is None else value
    settings = {"bounds": list(bounds), "method": method, "contact": contact, "width": width, "harmonics": harmonics}
    if isinstance(start, HopfPoint) and (method, contact) != METHODS_FROM_HOPF:
        raise ParameterError("branch", "start", "a HopfPoint", "harmonic balance with exact contact from a Hopf point")
    if method == "shooting":
        path, unknowns, p, outcome = _shooting_start(make, start, middle, rtol, span)
    else:
        path, unknowns, p, outcome = _harmonic_start(make, start, middle, CONTACTS[contact], width, harmonics, span)
    if not outcome.ok:
        return _collect([], [], [], outcome, parameter, settings, make(middle))
    tangent = path.rise(unknowns) if isinstance(start, HopfPoint) else None
    control = StepControl(first=min(1e-2, largest_step), largest=largest_step, most_points=points, tolerance=1e-9)
    walk = follow(path.residual, unknowns, p, jacobian=path.jacobian, control=control, direction=direction,
                  bounds=bounds, x_scale=path.scale, p_scale=span, tangent=tangent)  # fmt: skip
    ends_at_grazing = method == "harmonic_balance" and contact == "exact"
    visited, seen, outcome = _walk(walk, path, ends_at_grazing)
    specials = _specials(visited, seen, span)
    if outcome == "grazing":
        specials.append(("grazing", outcome.evidence["p"], len(visited) - 1))
    return _collect(visited, seen, specials, outcome, parameter, settings, make(middle))


def _walk(walk: Follower, path: Any, ends_at_grazing: bool) -> tuple[list[PathPoint], list[dict[str, Any]], Outcome]:
    visited: list[PathPoint] = []
    seen: list[dict[str, Any]] = []
    for point in walk:
        visited.append(point)
        seen.append(path.describe(point.x, point.p))
        if ends_at_grazing and seen[-1]["least_slip"] < 0.0:
            at = _grazing(path, visited[-2], visited[-1], seen) if len(visited) > 1 else point.p
            message = f"a contact comes to rest on the cycle at {at:.10g}: go on with smoothing, or by shooting"
            return visited[:-1], seen[:-1], Outcome("grazing", message, p=at)
    return visited, seen, walk.outcome


def _grazing(path: HarmonicPath, a: PathPoint, b: PathPoint, seen: list[dict[str, Any]]) -> float:
    """Parameter at which the least sliding speed is zero: false position between two points, corrected to the path."""
    scale = np.append(path.scale, path.span)
    ends = [np.append(point.x, point.p) / scale for point in (a, b)]
    shares, values = [0.0, 1.0], [about["least_slip"] for about in seen[-2:]]
    y = ends[1]
    for _ in range(12):
        share = shares[0] - values[0] * (shares[1] - shares[0]) / (values[1] - values[0])
        y = ends[0] + share * (ends[1] - ends[0])
        for _ in range(6):
            x = y * scale
            matrix = np.column_stack(path.jacobian(x[:-1], float(x[-1]))) * scale
            y = y - np.linalg.lstsq(matrix, path.residual(x[:-1], float(x[-1])), rcond=None)[0]
        x = y * scale
        value = path.least_slip(x[:-1], float(x[-1]))
        if abs(value) <= 1e-12 * abs(values[0] - values[1]) or share in shares:
            break
        side = int(value < 0.0)
        shares[side], values[side], values[1 - side] = share, value, 0.5 * values[1 - side]
    return float(y[-1] * path.span)


def _harmonic_start(
    make: Any, start: Any, value: float, contact: str, width: float, harmonics: int, span: float
) -> Any:
    path = HarmonicPath(make, contact, width, Grid(harmonics), span)
    if isinstance(start, HopfPoint):
        if not start.outcome.ok:
            return path, None, value, start.outcome
        size = _visible_size(start)
        coefficients = path.grid.padded(_small_series(start, 0.05 * size))
        p = start.beside(0.05 * size)
        shift = start.frequency_slope * (p - start.value)
        unknowns = path.begin(coefficients, start.angular_frequency + float(shift), p, size)
        return path, unknowns, p, Outcome(COMPLETED)
    found = harmonic_balance(make(value), start, contact=contact, width=width, harmonics=harmonics)
    if not found.outcome.ok:
        return path, None, value, found.outcome
    series = path.grid.series(_resampled(found, path.grid))
    return path, path.begin(series, 2.0 * np.pi / float(found.period), value, float(np.max(found.amplitude))), value, \
        found.outcome  # fmt: skip


def _resampled(cycle: Cycle, grid: Grid) -> Any:
    """Displacements at the instants of the grid; the samples of harmonic balance are equidistant."""
    fine = Grid(grid.harmonics, len(cycle.t) - 1)
    return grid.values @ fine.series(cycle.q[:-1])


def _visible_size(hopf: HopfPoint) -> float:
    """Amplitude [m] of the critical mode at which a contact would come to rest."""
    system = hopf.inputs["system"]
    half = len(hopf.shape) // 2
    shape = hopf.shape / np.max(np.abs(hopf.shape[:half]))
    swings = [abs(float(c.V)) / max(abs(c.t @ shape[half:]), 1e-300) for c in system.contacts]
    return float(min(swings))


def _small_series(hopf: HopfPoint, size: float) -> Any:
    """Coefficients of steady sliding with the critical mode of the given largest amplitude [m]."""
    half = len(hopf.shape) // 2
    shape = size * hopf.shape[:half] / np.max(np.abs(hopf.shape[:half]))
    return np.array([hopf.steady[:half], shape.real, -shape.imag])


def _shooting_start(make: Any, start: Any, value: float, rtol: float, span: float) -> Any:
    path = ShootingPath(make, rtol, span)
    found = start if isinstance(start, Cycle) else shooting(make(value), start)
    if not found.outcome.ok:
        return path, None, value, found.outcome
    dof = int(np.argmax(found.amplitude))
    top = int(np.argmax(found.q[:-1, dof]))
    period, amplitude = float(found.period), float(np.max(found.amplitude))
    x = np.concatenate([found.q[top], found.qd[top]])
    return path, path.begin(x, period, value, dof, amplitude), value, found.outcome


def _specials(visited: list[PathPoint], seen: list[dict[str, Any]], span: float) -> list[tuple[str, float, int]]:
    """(kind, value, index of the point before) along the walk."""
    found = []
    for i, (a, b) in enumerate(itertools.pairwise(visited)):
        if a.tangent[-1] * b.tangent[-1] < 0.0:
            found.append(("fold", _fold(a, b, span), i))
        for kind, test in TESTS.items():
            before, after = test(seen[i]), test(seen[i + 1])
            if before * after < 0.0:
                share = before / (before - after)
                found.append((kind, float(a.p + share * (b.p - a.p)), i))
    return found


def _fold(a: PathPoint, b: PathPoint, span: float) -> float:
    """Extreme of p on the Hermite cubic between two points."""
    h = b.arclength - a.arclength
    t = np.array([0.0, h])
    low, high = extremes_of(t, np.array([a.p, b.p]), span * np.array([a.tangent[-1], b.tangent[-1]]))
    return high if a.tangent[-1] > 0.0 else low


def extremes_of(t: Any, values: Any, slopes: Any) -> tuple[float, float]:
    """Least and largest value of one Hermite cubic."""
    low, high = extremes(t, values[:, None], slopes[:, None])
    return float(low[0]), float(high[0])


def _doubling(about: dict[str, Any]) -> float:
    """Changes sign where a real multiplier passes -1."""
    others = about["multipliers"][1:]
    real = others[np.abs(others.imag) <= 1e-9 * (1.0 + np.abs(others))].real
    return float(np.prod(np.sign(real + 1.0)) * (np.min(np.abs(real + 1.0)) if real.size else 1.0))


def _torus(about: dict[str, Any]) -> float:
    """Changes sign where a complex pair passes the unit circle."""
    others = about["multipliers"][1:]
    pairs = others[others.imag > 1e-9 * (1.0 + np.abs(others))]
    return float(np.max(np.abs(pairs)) - 1.0) if pairs.size else -1.0


TESTS = {
    "period_doubling": _doubling,
    "neimark_sacker": _torus,
    "grazing": lambda about: about["least_slip"] if about["sticking"] == 0.0 else np.nan,
    "sticking": lambda about: 1.0 if about["sticking"] > 0.0 else -1.0,
}


def _collect(
    visited: list[PathPoint], seen: list[dict[str, Any]], specials: list[Any], outcome: Outcome, parameter: str,
    settings: dict[str, Any], system: Any,
) -> Branch:  # fmt: skip
    n = system.size

    def column(name: str, shape: tuple[int, ...] = ()) -> Any:
        return np.array([about[name] for about in seen]).reshape(len(seen), *shape)

    return Branch(
        inputs={"system": system}, settings=settings, outcome=outcome, parameter=parameter,
        value=np.array([point.p for point in visited]), period=column("period"), lowest=column("lowest", (n,)),
        highest=column("highest", (n,)), multipliers=column("multipliers", (2 * n,)).astype(complex),
        least_slip=column("least_slip"), sticking=column("sticking"),
        unknowns=np.array([point.x for point in visited]).reshape(len(visited), -1 if visited else 0),
        special_kind=np.array([kind for kind, _, _ in specials], dtype=str),
        special_value=np.array([value for _, value, _ in specials], dtype=float),
        special_point=np.array([index for _, _, index in specials], dtype=np.int64),
    )  # fmt: skip
