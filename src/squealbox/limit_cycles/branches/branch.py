"""Branches of cycles over a parameter: stable and unstable parts, folds and the other places where stability changes.

Continuation walks the path (`squealbox.continuation`); this module starts it, reads each point and finds

fold, period_doubling, neimark_sacker, grazing, sticking and, at a corner (`corners`), event_order. They are solved for,
not interpolated (`special_points`): `Branch.points` holds the cycle at each with what is left of its test function.
Where a path could not be corrected between two points, the value is their middle, its uncertainty NaN, and there is no
such cycle.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar

import numpy as np

from squealbox import cautions
from squealbox.arguments import public
from squealbox.continuation import PathPoint, StepControl, along
from squealbox.family import Bounds, DesignOrRecipe, Family, Varied, kept_unit, unit_of
from squealbox.limit_cycles.branches.doubling import doubled
from squealbox.limit_cycles.branches.harmonic_path import HarmonicPath
from squealbox.limit_cycles.branches.hopf import HopfPoint
from squealbox.limit_cycles.branches.paths import CyclePath
from squealbox.limit_cycles.branches.phases import begun, heading
from squealbox.limit_cycles.branches.shooting_path import ShootingPath
from squealbox.limit_cycles.branches.special_points import STRAIGHT, BranchPoint
from squealbox.limit_cycles.branches.walks import Special, special_points, walked
from squealbox.limit_cycles.cycles.cycle import Cycle
from squealbox.limit_cycles.cycles.harmonic_balance import Grid, harmonic_balance
from squealbox.limit_cycles.cycles.shooting import CONTACTS, shooting
from squealbox.parameters import ParameterError, known_names
from squealbox.result import COMPLETED, Array, Outcome, Result, quantity
from squealbox.start import StartLike
from squealbox.system import System
from squealbox.words import sizes_told, unit_at

METHODS = ("harmonic_balance", "shooting")
METHODS_FROM_HOPF = (("harmonic_balance", "exact"), ("shooting", "exact"))
RISE = 6  # points by harmonic balance from a Hopf point to the cycle where shooting takes over


@dataclass(frozen=True, kw_only=True, eq=False)
class Branch(Result):
    """Cycles along a branch, in the order walked, as :func:`branch` returns it.

    `points` (the cycle at each special point) and `family` (the design or function followed) are not saved.
    """

    value: Array = quantity("point", "", "value of the parameter, in its own unit")
    period: Array = quantity("point", "s", "period")
    lowest: Array = quantity("point dof", "m", "least displacement")
    highest: Array = quantity("point dof", "m", "largest displacement")
    multipliers: Array = quantity("point multiplier", "1", "Floquet multipliers, the trivial one first")
    start: Array = quantity("point state", "m", "state (q, q') at the beginning of the period, q' in m/s")
    least_slip: Array = quantity(
        "point", "m/s", "least sliding speed in the sense of V; negative where a contact reverses"
    )
    sticking: Array = quantity("point", "s", "longest sticking time of a contact in a period")
    unknowns: Array = quantity("point unknown", "", "what was followed")
    special_kind: Array = quantity("special", "", "fold, period_doubling, neimark_sacker, grazing or sticking")
    special_value: Array = quantity("special", "", "value of the parameter there")
    special_point: Array = quantity("special", "1", "index of the point before it")
    special_uncertainty: Array = quantity("special", "", "of the value; NaN where it lies midway between two points")
    special_test: Array = quantity("special", "", "what is left of the test function")
    parameter: str = ""
    caution: str = ""
    points: tuple[BranchPoint, ...] = field(default=(), metadata={"transient": True})
    family: Any = field(default=None, metadata={"transient": True})

    derived: ClassVar = {
        "frequency": ("point", "Hz", "frequency"), "stable": ("point", "1", "True where stable"),
        "largest_multiplier": ("point", "1", "absolute value of the largest Floquet multiplier but the trivial one"),
        "amplitude": ("point dof", "m", "half peak to peak"),
    }  # fmt: skip
    headings: ClassVar = {
        "lowest": "least {}", "highest": "largest {}", "multipliers": "", "start": "", "unknowns": "",
        "sticking": "longest sticking",
    }  # fmt: skip

    @property
    def frequency(self) -> Array:
        """1 / period [Hz], shape (point,)."""
        return 1.0 / self.period

    @property
    def largest_multiplier(self) -> Array:
        """Absolute value of the largest Floquet multiplier but the trivial one [-], shape (point,)."""
        return np.max(np.abs(self.multipliers[:, 1:]), axis=1)

    @property
    def amplitude(self) -> Array:
        """Half peak to peak [m], shape (point, dof)."""
        return 0.5 * (self.highest - self.lowest)

    @property
    def stable(self) -> Array:
        """True where all multipliers but the trivial one lie inside the unit circle, shape (point,)."""
        return np.all(np.abs(self.multipliers[:, 1:]) < 1.0, axis=1)

    def special(self, kind: str) -> Any:
        """Parameter values of one kind of special point."""
        return self.special_value[self.special_kind == kind]

    def summary(self) -> str:
        """What the branch holds, in a few lines."""
        if len(self.value) == 0:
            return f"{self.parameter}: {self.outcome.told}"
        low, high = np.min(self.value), np.max(self.value)
        first, last = (self.read_value(self.parameter, end) for end in (low, high))
        pitch = f"{np.min(self.frequency):.6g} to {np.max(self.frequency):.6g} Hz"
        moved = np.array([np.min(self.amplitude, axis=0), np.max(self.amplitude, axis=0)]).T
        dofs = [unit_at(self.kept_system(), i) for i in range(len(moved))]
        names = getattr(self.kept_system(), "names", [""] * len(moved))
        ended = self.outcome.message or str(self.outcome)
        lines = [
            f"{len(self.value)} cycles, {self.parameter} from {first} to {last}, {pitch}, amplitude "
            f"{sizes_told(names, moved, dofs)}, {int(np.sum(self.stable))} stable; ended: {ended}"
        ]
        if len(self.value) > 2 and high - low < STRAIGHT * max(abs(low), abs(high)):
            lines += [f"it goes straight up: cycles of every amplitude at {self.parameter} = {low:.8g}"]
        one_way = self.settings.get("one_way")
        if one_way:
            lines += [f"the other way from its start is another walk: direction={-one_way:g}"]
        special = zip(self.special_kind, self.special_value, strict=True)
        lines += [f"{kind.replace('_', ' ')} at {self.read_value(self.parameter, at, 8)}" for kind, at in special]
        return self.warned(lines)


@public()
def branch(
    design: DesignOrRecipe,
    parameter: Varied,
    bounds: Bounds | None = None,
    start: Cycle | HopfPoint | StartLike = None,
    *,
    value: float | None = None,
    method: str = "auto",
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
    parameter, bounds : {name: (low, high)}, the range walked, in the parameter's own unit; or the name and the bounds
        one after the other
    start : a `HopfPoint` (the branch born there; with method "shooting" on past the first contact at rest), a
        period doubling out of `Branch.points` (the branch of doubled
        period, with method "shooting"), or what :func:`shooting` takes, at `value` of the parameter
    value : where to start from, in the parameter's own unit; None takes the middle of the bounds
    method : "harmonic_balance" (smooth or smoothed cycles, fast), "shooting" (exact stick and slip), or "auto":
        shooting where the cycle at the start sticks or reverses and contact is exact, else harmonic balance
    contact, width, harmonics : for harmonic balance; width in [m/s]
    direction : +1 walks to larger values at first, -1 to smaller [-]; from a cycle in the middle the other way is a
        walk of its own, which the summary says
    points : most points
    largest_step : longest step [-], in shares of the range and of the size of the motion
    rtol : relative tolerance of the integration [-], for shooting

    Outcome "completed" at a bound or where the cycle shrinks to steady sliding, "most_points", "grazing" (harmonic
    balance with exact contact at the first contact that reverses), "jump" (shooting: no cycle lies beside the last),
    "step_underflow" or why there was no start. Shooting goes on past corners, where a contact begins to touch v = 0 or
    two events change places. Accuracy: that of the method with these harmonics. Source: Keller 1977.

    >>> from squealbox import DrumBrake, LinearSlope
    >>> from squealbox.limit_cycles import hopf_point
    >>> brake = DrumBrake(friction=LinearSlope(0.3, -0.05))
    >>> onset = hopf_point(brake, {"friction.static": (0.1, 0.6)})
    >>> str(branch(brake, {"friction.static": (0.1, 0.6)}, onset, points=150).outcome)
    'grazing'
    """
    if method not in (*METHODS, "auto"):
        raise ParameterError("branch", "method", method, known_names(str(method), [*METHODS, "auto"]))
    family = Family.within("branch", design, parameter, bounds)
    make, parameter, bounds = family.system, family.name, family.spans[0]
    span = float(bounds[1] - bounds[0])
    middle = 0.5 * (bounds[0] + bounds[1]) if value is None else value
    if not bounds[0] <= middle <= bounds[1]:
        raise ParameterError("branch", "value", value, f"a value within the bounds, {bounds[0]:g} to {bounds[1]:g}")
    if method == "auto":
        method, start = _chosen(make, start, middle, contact)
    settings = {"bounds": list(bounds), "method": method, "contact": contact, "width": width, "harmonics": harmonics}
    settings |= kept_unit(design, parameter)
    if isinstance(start, HopfPoint) and (method, contact) not in METHODS_FROM_HOPF:
        raise ParameterError("branch", "start", "a HopfPoint", "shooting or exact contact from a Hopf point")
    if isinstance(start, HopfPoint) and start.outcome.ok:
        settings["born_at"] = float(start.value)
    if isinstance(start, BranchPoint):
        middle = float(start.value) if value is None else middle
        if start.kind == "period_doubling" and method != "shooting":
            raise ParameterError("branch", "method", method, '"shooting" from a period doubling')
    inside = bounds[0] < middle < bounds[1] and not isinstance(start, (HopfPoint, BranchPoint))
    settings["one_way"] = float(direction) if inside else 0.0
    tangent = None
    if method == "shooting" and isinstance(start, HopfPoint):
        path, unknowns, p, tangent, outcome = _risen(family, start, bounds, harmonics, rtol)
    elif method == "shooting":
        path, unknowns, p, outcome = _shooting_start(family, start, middle, rtol)
    else:
        path, unknowns, p, outcome = _harmonic_start(make, start, middle, CONTACTS[contact], width, harmonics, span)
    if not outcome.ok:
        return _collect([], [], [], outcome, parameter, settings, make(middle), design)
    if method != "shooting" and isinstance(start, HopfPoint):
        tangent = path.rise(unknowns)
    if isinstance(start, BranchPoint) and start.kind == "period_doubling":
        unknowns, tangent = doubled(path, unknowns, p)
    control = StepControl(first=min(1e-2, largest_step), largest=largest_step, most_points=points, tolerance=1e-9)
    ends_at_grazing = method == "harmonic_balance" and contact == "exact"
    for _ in range(2):  # once more where numbers were taken for sums of the parameter and are none
        walk = along(path, unknowns, p, control=control, direction=direction, bounds=bounds, tangent=tangent)
        done = walked(path, walk, control, bounds, ends_at_grazing)
        if path.confirmed([at.p for at in done.visited]):
            break
    specials = special_points(done, parameter)
    if ends_at_grazing and done.outcome == "grazing" and len(done.visited) > 1:
        done.drop_last()
        done.outcome = _grazing_outcome(specials, done.visited[-1].p)
    found = _collect(done.visited, done.seen, specials, done.outcome, parameter, settings, make(middle), design)
    return replace(found, caution=_caution(path, done.visited, found, unit_of(design, parameter)))


def _caution(path: CyclePath, visited: list[PathPoint], found: Branch, unit: str) -> str:
    """Where the cycles leave the range of their model: at both ends of the branch and where they are largest."""
    if not visited:
        return ""
    units = np.array(found.inputs["system"].units)
    ranks = found.amplitude / np.max(found.amplitude, axis=0, where=np.isfinite(found.amplitude), initial=1e-300)
    places = {0, len(visited) - 1, *(int(np.argmax(ranks[:, i])) for i in range(units.size))}
    said: dict[str, str] = {}  # the contact or freedom, and what is said of the largest cycle first
    for i in sorted(places, key=lambda i: -float(np.max(ranks[i]))):
        cycle = path.cycle(visited[i].x, visited[i].p)
        place = cautions.told_place(found.parameter, visited[i].p, unit)
        for each in cautions.along(cycle.system, cycle.q, cycle.qd):
            said.setdefault(each.split(":")[0] + each[-20:], f"at {place} {each}")
    return "; ".join(said.values())


def _chosen(
    make: Callable[[float], System], start: Cycle | HopfPoint | StartLike, value: float, contact: str
) -> tuple[str, Any]:
    """The method that can follow the cycle at the start, and the start, which may have become that cycle."""
    if isinstance(start, BranchPoint):
        return ("shooting" if start.kind == "period_doubling" else "harmonic_balance"), start
    if isinstance(start, HopfPoint) or CONTACTS.get(contact) != "exact":
        return "harmonic_balance", start
    found = start if isinstance(start, Cycle) else shooting(make(value), start)
    if not found.outcome.ok:
        return "harmonic_balance", start
    reverses = bool(np.any(found.mode == 0)) or len(found.event_time) > 0
    return ("shooting", found) if reverses else ("harmonic_balance", start)


def _grazing_outcome(specials: list[Special], last: float) -> Outcome:
    """How a branch with exact contact ends: where the least sliding speed is zero."""
    at = next((value for kind, value, _, _ in reversed(specials) if kind == "grazing"), last)
    message = f"a contact comes to rest on the cycle at {at:.10g}: go on with smoothing, or by shooting"
    return Outcome("grazing", message, p=at)


def _harmonic_start(
    make: Callable[[float], System],
    start: Any,
    value: float,
    contact: str,
    width: float,
    harmonics: int,
    span: float,
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
    return path, path.through(found, value), value, found.outcome


def _risen(family: Family, hopf: HopfPoint, bounds: Bounds, harmonics: int, rtol: float) -> tuple[Any, ...]:
    """(path, unknowns, p, tangent, outcome) by shooting, a few points by harmonic balance up from a Hopf point."""
    span = bounds[1] - bounds[0]
    path, x, p, outcome = _harmonic_start(family.system, hopf, float(hopf.value), "exact", 1e-3, harmonics, span)
    if not outcome.ok:
        return path, None, p, None, outcome
    control = StepControl(largest=0.1, most_points=RISE, tolerance=1e-9)
    walk = along(path, x, p, control=control, bounds=bounds, tangent=path.rise(x))
    points = [point for point in walk if path.least_slip(point.x, point.p) > 0.0][-2:]
    if len(points) < 2:
        return (
            path,
            None,
            p,
            None,
            Outcome("no_start", f"no slipping cycles were reached from the Hopf point: {walk.outcome}"),
        )
    cycles = tuple(path.cycle(point.x, point.p) for point in points)
    exact, p = _shooting_path(family, rtol), points[1].p
    x = begun(exact, cycles[1], p)
    return exact, x, p, heading(exact, x, p, cycles[::-1], points[0].p), outcome


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


def _shooting_path(family: Family, rtol: float) -> ShootingPath:
    low, high = family.spans[0]
    return ShootingPath(family.system, rtol, high - low, (low, high), at_once=family.recipe is None)


def _shooting_start(family: Family, start: Any, value: float, rtol: float) -> Any:
    path = _shooting_path(family, rtol)
    found = start if isinstance(start, Cycle) else shooting(family.system(value), start)
    if not found.outcome.ok:
        return path, None, value, found.outcome
    return path, begun(path, found, value), value, found.outcome


def _collect(
    visited: list[PathPoint], seen: list[dict[str, Any]], specials: list[Special], outcome: Outcome, parameter: str,
    settings: dict[str, Any], system: System, family_: DesignOrRecipe,
) -> Branch:  # fmt: skip
    n = system.size
    counted = len(seen[0]["multipliers"]) if seen else 2 * n  # without those of a free common motion

    def column(name: str, shape: tuple[int, ...] = ()) -> Any:
        return np.array([about[name] for about in seen]).reshape(len(seen), *shape)

    return Branch(
        inputs={"system": system}, settings=settings, outcome=outcome, parameter=parameter,
        value=np.array([point.p for point in visited]), period=column("period"), lowest=column("lowest", (n,)),
        highest=column("highest", (n,)), start=column("begin", (2 * n,)), family=family_,
        multipliers=column("multipliers", (counted,)).astype(complex), least_slip=column("least_slip"),
        sticking=column("sticking"),
        unknowns=np.array([point.x for point in visited]).reshape(len(visited), -1 if visited else 0),
        special_kind=np.array([kind for kind, _, _, _ in specials], dtype=str),
        special_value=np.array([value for _, value, _, _ in specials], dtype=float),
        special_point=np.array([index for _, _, index, _ in specials], dtype=np.int64),
        special_uncertainty=np.array([np.nan if at is None else float(at.uncertainty) for *_, at in specials]),
        special_test=np.array([np.nan if at is None else float(at.test) for *_, at in specials]),
        points=tuple(at for *_, at in specials if at is not None),
    )  # fmt: skip
