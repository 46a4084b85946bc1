"""The boundary of stability over two parameters as curves, traced by continuation.

Cells in which it may run are found first (`cells`), thin tongues and small islands included. From a crossed edge the
curve is followed by pseudo-arclength steps (`continuation`) on the detector that vanishes there, a smooth function
where the growth rate has kinks and flats. A step that leaves the boundary has met a corner, where another mode takes
over; the curve is picked up again on a small circle about it. Every crossed edge that no curve passes starts the next
one, so no component is lost. At the end all points are polished onto zero growth.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from squealbox.arguments import public
from squealbox.continuation import StepControl, follow
from squealbox.family import Bounds, DesignOrRecipe
from squealbox.fe import ReducedBrake
from squealbox.result import Array, Outcome, Result, quantity
from squealbox.stability.cells import Crossing, LevelsAtPoints, crossings
from squealbox.stability.family import Steady, SteadyFamily
from squealbox.stability.plane_curves import between, onto_side, passed
from squealbox.stability.scan import coalescence, is_neutral, on_divergence
from squealbox.stability.sides import lying_on_a_side
from squealbox.stability.state_matrix import spectrum
from squealbox.system import DesignOrSystem, InvalidSystem

STEPS = tuple(  # ever shorter towards a corner
    StepControl(first=longest / 10.0, smallest=2e-6, largest=longest, tolerance=1e-8, largest_turn=0.2, most_points=60)
    for longest in (4e-2, 2e-3, 1e-4)
)
CIRCLE, WIDEST = 2e-5, 0.02  # radius on which a curve is picked up again after a corner; of circles along a jump
CLOSE = 50.0  # radii of such a small circle from a side, which is reached straight on
STRAIGHT = 0.998  # cosine of the turn up to which they grow
SHIFT = 1e-6  # of the central differences for the gradient, in shares of the axes
SHIFTS = SHIFT * np.array([[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]])
HALVINGS = 24  # of a crossed edge, down to 1e-9 of the axes


@dataclass(frozen=True, kw_only=True, eq=False)
class Boundary(Result):
    """Curves of zero growth over two parameters, as :func:`stability_boundary` returns them.

    Points of one curve follow each other, with the unstable side on the left (first parameter to the right, second up).
    """

    x: Array = quantity("point", "", "first parameter, in its own unit")
    y: Array = quantity("point", "", "second parameter, in its own unit")
    curve: Array = quantity("point", "1", "number of the curve the point is on")
    growth_rate: Array = quantity("point", "1/s", "largest growth rate at the point: what is left of zero")
    frequency: Array = quantity("point", "Hz", "frequency of the mode on the boundary")
    parameters: tuple[str, ...] = ()

    headings: ClassVar = {"curve": ""}

    def table(self) -> dict[str, Any]:
        return {"piece": self.curve + 1, **super().table()}

    @property
    def curves(self) -> list[Any]:
        """Each curve as an array (points, 2) of the two parameters."""
        points = np.column_stack([self.x, self.y])
        return [points[self.curve == i] for i in range(int(np.max(self.curve, initial=-1)) + 1)]

    def closed(self, curve: int) -> bool:
        """True when that curve ends where it begins: an island."""
        points = self.curves[curve]
        return bool(len(points) > 2 and np.array_equal(points[0], points[-1]))

    def summary(self) -> str:
        """The pieces of the boundary: from where to where each runs, and at which frequencies."""
        if len(self.x) == 0:
            return f"boundary: none, {self.outcome.message or self.outcome}"
        curves = self.curves
        pieces = f"{len(curves)} piece{'s' * (len(curves) > 1)}"
        lines = [f"boundary: {pieces}; who follows one as it is told has the unstable side on the left"]
        for i, points in enumerate(curves):
            hertz = self.frequency[self.curve == i]
            ends = (points.min(axis=0), points.max(axis=0)) if self.closed(i) else (points[0], points[-1])
            low, high = (
                ", ".join(f"{n} = {self.read_value(n, v)}" for n, v in zip(self.parameters, end, strict=True))
                for end in ends
            )
            runs = f"an island between {low} and {high}" if self.closed(i) else f"from {low} to {high}"
            lines.append(f"  {i + 1}: {runs}; {np.min(hertz):.6g} to {np.max(hertz):.6g} Hz")
        return "\n".join(lines)


@public()
def stability_boundary(
    design: DesignOrSystem, bounds: Mapping[str, Bounds], *, cells: int = 32, time: float = 0.0
) -> Boundary:
    """Curves on which stability changes, over two parameters.

    Parameters
    ----------
    design : a design, or a function of two floats that returns a design or a system
    bounds : name to (low, high) for two parameters, such as ``{"theta1": (0.3, 2.8), "theta2": (0.3, 2.8)}``
    cells : cells along each axis at the start; each is halved up to 7 times where something may hide in it
    time : instant of schedules [s]

    Returns a `Boundary`. The outcome is "no_boundary" when the whole rectangle is stable or unstable. Raises
    `ParameterError` unless `bounds` names two parameters with low < high.
    """
    if isinstance(design, ReducedBrake):
        raise InvalidSystem(
            f"a boundary of its own takes some ten thousand spectra, too many of {len(design.reduction.arrays['M'])} "
            "coordinates: of a reduced brake map_boundary follows it on the grid of a coarse stability_map"
        )
    rectangle = _Rectangle(design, bounds, time)
    edges = crossings(rectangle.sample, cells)
    along, edges = lying_on_a_side(edges, rectangle.level)
    curves: list[Any] = []
    tangents: list[Any] = []
    for start, gradient in rectangle.starts(edges):
        if not passed(start, gradient, curves, tangents, 2.0 * CIRCLE):
            points, directions = _traced(rectangle, start, gradient)
            curves.append(points)
            tangents.append(directions)
    return rectangle.result(curves + along, {"cells": cells})


class _Rectangle:
    """Two parameters scaled to the unit square, and the functions on it."""

    def __init__(self, design: DesignOrRecipe, bounds: Mapping[str, Bounds], time: float) -> None:
        self.family = SteadyFamily.within("stability_boundary", design, bounds, count=2, time=time)
        self.low = np.array([low for low, _ in self.family.spans])
        self.width = np.array([high for _, high in self.family.spans]) - self.low
        middle = self.family.at(*(self.low + 0.5 * self.width)[:, None])
        self.neutral = bool(is_neutral(middle)[0])
        self.rigid = int(np.asarray(middle.equilibrium.floating).flat[0])
        size = np.nanmax(np.abs(spectrum(middle)), initial=0.0)
        self.reference = float(size) if size > 0.0 else 1.0
        self.scale = 1.0

    def level(self, points: ArrayLike) -> Any:
        """Positive where a mode grows, at points (k, 2) of the unit square; outside, the value on its edge."""
        u = np.clip(np.asarray(points), 0.0, 1.0)
        return self._level(self.family.at(*(self.low + self.width * u).T))[0] / self.scale

    def _level(self, about: Steady) -> tuple[Any, Any]:
        eigenvalues = spectrum(about)
        if self.neutral:
            return np.where(on_divergence(about), 0.0, coalescence(eigenvalues, self.rigid)), eigenvalues
        known = np.any(np.isfinite(eigenvalues), axis=-1, keepdims=True)
        idle = (eigenvalues == 0.0) & (np.asarray(about.equilibrium.floating)[..., None] > 0)
        idle |= known & ~np.isfinite(eigenvalues)  # rigid-body motion and what has no mass: as if it died at once
        eigenvalues = np.where(idle, -self.reference, eigenvalues)
        return np.where(on_divergence(about), 0.0, np.max(eigenvalues.real, axis=-1)), eigenvalues

    def sample(self, u: np.ndarray, v: np.ndarray) -> LevelsAtPoints:
        """Level and detectors at points (u, v) of the unit square."""
        about = self.family.at(self.low[0] + self.width[0] * u, self.low[1] + self.width[1] * v)
        level, eigenvalues = self._level(about)
        if np.any(np.isfinite(level)):
            self.scale = max(self.scale, float(np.nanmedian(np.abs(level)))) if not self.neutral else 1.0
        return LevelsAtPoints(level, self._detectors(eigenvalues))

    def _detectors(self, eigenvalues: np.ndarray) -> Any:
        """Smooth functions of the parameters (2, points) that vanish on the boundary; see the module `cells`."""
        scaled = eigenvalues / self.reference
        values = scaled
        if self.neutral:
            values = scaled[..., : scaled.shape[-1] // 2] ** 2
            order = np.argsort(np.abs(values), axis=-1, kind="stable")
            values = np.take_along_axis(values, order, axis=-1)[..., self.rigid :]
            scaled = values
        product = np.ones(values.shape[:-1], dtype=complex)
        for i in range(values.shape[-1]):
            for j in range(i):
                a, b = values[..., i], values[..., j]
                product = product * ((a - b) ** 2 if self.neutral else a + b)
        return np.stack([product.real, np.prod(scaled, axis=-1).real])

    def gradient(self, points: np.ndarray) -> Any:
        """Gradient of the level at points (k, 2), by central differences in one call."""
        values = self.level((points[:, None, :] + SHIFTS).reshape(-1, 2)).reshape(-1, 4)
        return np.stack([values[:, 0] - values[:, 1], values[:, 2] - values[:, 3]], axis=-1) / (2.0 * SHIFT)

    def stencil(self, point: np.ndarray) -> tuple[Any, Any, Any]:
        """Detectors (k,) at one point and their gradients (k, 2), in one call, and where the unstable side lies.

        That is the gradient of the level, or zero where stability does not change about the point.
        """
        points = np.clip(point + np.vstack([np.zeros((1, 2)), SHIFTS]), 0.0, 1.0)
        level, eigenvalues = self._level(self.family.at(*(self.low + self.width * points).T))
        values = self._detectors(eigenvalues)
        gradients = np.column_stack([values[:, 1] - values[:, 2], values[:, 3] - values[:, 4]]) / (2.0 * SHIFT)
        centre = values[:, 0] if np.all(np.isfinite(values[:, 0])) else np.mean(values[:, 1:], axis=1)  # K_eff singular
        uphill = np.array([level[1] - level[2], level[3] - level[4]])
        changes = bool(np.any(level > 0.0) and np.any(level <= 0.0))
        return centre, gradients, uphill if changes else np.zeros(2)

    def starts(self, edges: list[Crossing]) -> list[tuple[Any, Any]]:
        """The point of the boundary on each crossed edge, by halving all edges together, with the gradient there.

        Coarse edges and those inside the square come first. An edge on which something is unknown is left out.
        """
        if not edges:
            return []
        stable, unstable = (np.array([getattr(edge, name) for edge in edges]) for name in ("stable", "unstable"))
        for _ in range(HALVINGS):
            middle = 0.5 * (stable + unstable)
            growing = (self.level(middle) > 0.0)[:, None]
            stable, unstable = np.where(growing, stable, middle), np.where(growing, middle, unstable)
        points = 0.5 * (stable + unstable)
        gradients = self.gradient(points)
        known = np.all(np.isfinite(gradients), axis=-1) & np.any(gradients != 0.0, axis=-1)
        border = np.min(np.minimum(points, 1.0 - points), axis=-1) <= SHIFT
        order = np.lexsort((-np.array([edge.size for edge in edges]), border))
        return [(points[i], gradients[i]) for i in order if known[i]]

    def polished(self, points: np.ndarray) -> Any:
        """Points moved along the gradient onto the boundary as far as round-off lets them: Newton, then halving."""
        best, size = points.copy(), np.abs(self.level(points))
        gradient = self.gradient(best)
        for _ in range(4):
            square = np.sum(gradient**2, axis=-1)
            with np.errstate(all="ignore"):
                trial = best - (self.level(best) / square)[:, None] * gradient
            trial = np.clip(np.where(np.isfinite(trial), trial, best), 0.0, 1.0)
            left = np.abs(self.level(trial))
            better = (left < size) & (np.max(np.abs(trial - best), axis=-1) < 1e-3)
            best[better], size[better] = trial[better], left[better]
            gradient = self.gradient(best)
        with np.errstate(all="ignore"):
            normal = gradient / np.linalg.norm(gradient, axis=-1)[:, None]
        normal = np.where(np.isfinite(normal), normal, 0.0)  # flat or unknown there: no way to go
        for reach in (1e-12, 1e-9, 1e-6):
            ends = [np.clip(best + side * reach * normal, 0.0, 1.0) for side in (-1.0, 1.0)]
            crossing = (self.level(ends[0]) <= 0.0) & (self.level(ends[1]) > 0.0)
            stable, unstable = ends[0][crossing], ends[1][crossing]
            for _ in range(HALVINGS if len(stable) else 0):
                middle = 0.5 * (stable + unstable)
                growing = (self.level(middle) > 0.0)[:, None]
                stable, unstable = np.where(growing, stable, middle), np.where(growing, middle, unstable)
            left = np.abs(self.level(stable)) if len(stable) else np.zeros(0)
            better = left < size[crossing]
            place = np.nonzero(crossing)[0][better]
            best[place], size[place] = stable[better], left[better]
        return best

    def result(self, curves: list[Any], settings: dict[str, Any]) -> Boundary:
        number = np.concatenate([np.full(len(points), i) for i, points in enumerate(curves)] or [np.array([], int)])
        points = np.concatenate(curves or [np.zeros((0, 2))])
        if len(points):
            points = self.polished(points)
            for i in range(len(curves)):  # a closed curve stays closed
                own = np.nonzero(number == i)[0]
                if np.array_equal(curves[i][0], curves[i][-1]):
                    points[own[-1]] = points[own[0]]
        values = self.low + self.width * points
        about = self.family.at(*values.T) if len(points) else None
        eigenvalues = np.zeros((0, 2), complex) if about is None else spectrum(about)
        if about is not None:
            eigenvalues[on_divergence(about)] = 0.0
        half = max(eigenvalues.shape[-1] // 2, 1)
        place = np.argmax(eigenvalues[:, :half].real, axis=-1)[:, None]
        worst = np.take_along_axis(eigenvalues, place, axis=-1)[:, 0]
        outcome = Outcome() if len(points) else Outcome("no_boundary", "stability does not change in the rectangle")
        spans = zip(self.family.parameters, self.low, self.width, strict=True)
        bounds = {name: [float(low), float(low + width)] for name, low, width in spans}
        return Boundary(
            x=values[:, 0],
            y=values[:, 1],
            curve=number,
            growth_rate=worst.real,
            frequency=np.abs(worst.imag) / (2.0 * np.pi),
            parameters=self.family.parameters,
            inputs=self.family.inputs,
            settings={**settings, "bounds": bounds},
            outcome=outcome,
        )


def _traced(rectangle: _Rectangle, start: np.ndarray, gradient: np.ndarray) -> tuple[Any, Any]:
    """The whole curve through `start`, with tangents; unstable on the left; first point repeated when closed."""
    heading = np.array([gradient[1], -gradient[0]]) / np.linalg.norm(gradient)
    points, tangents, closed = _walk(rectangle, start, heading, 1.0)
    if not closed:
        back, back_tangents, _ = _walk(rectangle, start, -heading, -1.0)
        points = back[:0:-1] + points
        tangents = [-t for t in back_tangents[:0:-1]] + tangents
    return np.clip(np.array(points), 0.0, 1.0), np.array(tangents)


def _walk(
    rectangle: _Rectangle, start: ArrayLike, heading: ArrayLike, side: float
) -> tuple[list[Any], list[Any], bool]:
    """Points and tangents from `start` along `heading` until the curve closes, ends, or leaves the square.

    `side` is 1 with the unstable side on the left, -1 on the right. Where no detector leads on from a corner either,
    growth jumps along the curve, and it is followed from circle to circle, wider ones while it goes straight.
    """
    points, tangents = [np.array(start)], [np.array(heading)]
    point, along, radius = np.array(start), np.array(heading), CIRCLE
    for _ in range(200):  # corners
        corner = len(points)
        for here, tangent in _smooth_part(rectangle, point, along, side):
            if np.any((here < 0.0) | (here > 1.0)):
                return [*points, np.clip(here, 0.0, 1.0)], [*tangents, tangent], False
            if between(points[-1], here, points[0], tangents[0], tangent) and len(points) > 3:
                return [*points, points[0]], [*tangents, tangents[0]], True
            points.append(here)
            tangents.append(tangent)
        stuck = len(points) == corner
        radius = radius if stuck else CIRCLE
        if radius > 2.0 * CIRCLE:
            side_ahead = onto_side(points[-1], points[-1] + 2.0 * tangents[-1])
            ahead = float(np.linalg.norm(side_ahead - points[-1]))
            if ahead < CLOSE * CIRCLE:
                return [*points, side_ahead], [*tangents, tangents[-1]], False
            radius = min(radius, 0.9 * ahead)  # beyond the side there is nothing to see
        picked = _around_corner(rectangle, points[-1], tangents[-1], side, radius)
        if picked is None:
            return points, tangents, False
        back = np.linalg.norm(picked[0] - points[0]) < 2.0 * CIRCLE
        if len(points) > 3 and (back or between(points[-1], picked[0], points[0], tangents[0], picked[1])):
            return [*points, points[0]], [*tangents, tangents[0]], True
        straight = picked[1] @ tangents[-1] > STRAIGHT
        radius = min(2.0 * radius, WIDEST) if stuck and straight else max(0.25 * radius, CIRCLE)
        point, along = picked
        points.append(point)
        tangents.append(along)
        if stuck and np.any((point <= 0.0) | (point >= 1.0)):
            return points, tangents, False
    return points, tangents, False


def _smooth_part(rectangle: _Rectangle, point: np.ndarray, along: np.ndarray, side: float) -> Iterator[tuple[Any, Any]]:
    """Points after `point` as far as one detector leads along the boundary, with shorter steps towards the corner."""
    values, gradients, _ = rectangle.stencil(point)
    which = int(np.argmin(np.abs(values) / (np.linalg.norm(gradients, axis=-1) + 1e-300)))
    last: dict[tuple[float, float], Any] = {}

    def at(x: np.ndarray, p: float) -> Any:
        key = (float(x[0]), float(p))
        if key not in last:
            last.clear()
            last[key] = rectangle.stencil(np.array(key))
        return last[key]

    size = float(np.linalg.norm(gradients[which])) + 1e-300
    pace = 0
    while pace < len(STEPS):
        control = STEPS[pace]
        path = follow(
            lambda x, p: at(x, p)[0][which] / size,
            point[:1],
            point[1],
            jacobian=lambda x, p: tuple(at(x, p)[1][which] / size),
            tangent=along,
            control=control,
            closes=False,
        )
        for i, found in enumerate(path):
            if i == 0:
                continue
            here = np.array([found.x[0], found.p])
            left = np.array([-found.tangent[1], found.tangent[0]])
            if not side * (at(found.x, found.p)[2] @ left) > 0.0:
                break
            point, along = here, found.tangent
            yield point, along
        pace = 0 if path.outcome == "most_points" else pace + 1


def _around_corner(
    rectangle: _Rectangle, point: np.ndarray, along: np.ndarray, side: float, radius: float = CIRCLE
) -> tuple[Any, Any] | None:
    """Where the boundary leaves a small circle about a corner, and the direction.

    Seen from the centre, the unstable side is on the left of the way on and on the right of the way back, so the two
    are told apart however sharp the corner.
    """
    heading = float(np.arctan2(along[1], along[0]))
    for half, count in ((0.5, 33),) * (radius > 2.0 * CIRCLE) + ((np.pi, 361),):  # along a jump first straight on
        angles = heading + np.linspace(-half, half, count)
        ring = point + radius * np.column_stack([np.cos(angles), np.sin(angles)])
        beyond = (rectangle.level(ring) > 0.0) == (side > 0.0)  # without steady sliding the level is 0 on either side
        ways = [i for i in range(count - 1) if beyond[i + 1] and not beyond[i]]
        if ways:
            break
    else:
        return None
    best = min(ways, key=lambda i: abs(0.5 * (angles[i] + angles[i + 1]) - heading))
    low, high = angles[best], angles[best + 1]
    for _ in range(HALVINGS):
        middle = 0.5 * (low + high)
        ahead = point + radius * np.array([[np.cos(middle), np.sin(middle)]])
        grows = bool(rectangle.level(ahead)[0] > 0.0)
        low, high = (low, middle) if grows == (side > 0.0) else (middle, high)
    direction = np.array([np.cos(low), np.sin(low)])
    return point + radius * direction, direction
