"""The drawing of a brake as data: shapes with a role, the parameters they stand for, and what they move with.

A design's `draw` adds them; `plots.brake_drawing` draws them with Matplotlib, `drawing.js` in a browser. Of a brake of
finite elements the drawing is its surface.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

MOST_SHOWN = 12  # degrees of freedom of a brake without a drawing
Point = tuple[float, float] | np.ndarray
Moves = Mapping[int, Point | float]  # with a degree of freedom: along a way, or, a number [m/rad], about the origin
STILL: Moves = {}
RIGHT, UP, DOWN = (1.0, 0.0), (0.0, 1.0), (0.0, -1.0)


@dataclass(frozen=True)
class DrawnShape:
    """A ``line``, ``polygon``, ``circle`` (its middle), ``arrow`` (tail and tip) or ``text``, and what it is.

    `role` is ``body``, ``shoe``, ``lining``, ``hollow``, ``pivot``, ``part``, ``spring``, ``damper``, ``support``,
    ``contact``, ``motion`` (what slides, and how), ``load`` or ``measure``. `points` (k, 2) are in units of the
    picture; the first of them moves with `moves[0]`, the last with `moves[1]`, those between with a share of both.
    `of` names the parameters a text stands for; `about` holds the width, dashes, radius, text, size and anchor.
    """

    kind: str
    role: str
    points: Any
    moves: tuple[Moves, Moves]
    of: tuple[str, ...]
    about: Mapping[str, Any]

    def moved(self, size: int) -> Any:
        """What one metre or radian of each of `size` degrees of freedom adds to its points, (size, k, 2)."""
        way = np.r_[0.0, np.cumsum(np.hypot(*np.diff(self.points, axis=0).T))]
        share = (way / way[-1] if way[-1] else way)[:, None]
        first, last = (_moved(self.points, moves, size) for moves in self.moves)
        return (1.0 - share) * first + share * last


class Shapes:
    """The shapes of a brake, and its contacts: the place of each, the way the normal force presses there, its moves."""

    def __init__(self, design: Any) -> None:
        self.design = design
        self.shapes: list[DrawnShape] = []
        self.contacts: list[tuple[Point, Point, Moves]] = []

    def data(self) -> dict[str, Any]:
        """For a page: shapes with the count of their `points`, the box (left, right, bottom, top), contacts."""
        shapes = [{"kind": each.kind, "role": each.role, "count": len(each.points), **each.about}
                  for each in self.shapes]  # fmt: skip
        radii = np.concatenate([np.full(len(each.points), each.about.get("radius", 0.0)) for each in self.shapes])
        low, high = (self.points - radii[:, None]).min(axis=0), (self.points + radii[:, None]).max(axis=0)
        contacts = [[float(x) for x in (*place, *press)] for place, press, _ in self.contacts]
        return {"shapes": shapes, "box": np.ravel([low, high], "F").tolist(), "contacts": contacts}

    @property
    def points(self) -> Any:
        """The points of all shapes one after the other, (k, 2)."""
        return np.concatenate([each.points for each in self.shapes])

    def moved(self, size: int) -> Any:
        """What one metre or radian of each of `size` degrees of freedom adds to `points`, (size, k, 2)."""
        return np.concatenate([each.moved(size) for each in self.shapes], axis=1)

    def contacts_moved(self, size: int) -> Any:
        """The same of the places of the contacts, (size, c, 2)."""
        found = [_moved(np.array([place]), moves, size) for place, _, moves in self.contacts]
        return np.concatenate([np.zeros((size, 0, 2)), *found], axis=1)

    def places(self) -> dict[str, tuple[float, float]]:
        """Where parameters are written: the name of each to the place of the first text that stands for it."""
        found: dict[str, tuple[float, float]] = {}
        for shape in self.shapes:
            for name in shape.of:
                found.setdefault(name, (float(shape.points[0][0]), float(shape.points[0][1])))
        return found

    def _add(self, kind: str, role: str, points: Any, *moves: Moves, of: str = "", **about: Any) -> None:
        moves = moves or (STILL,)
        self.shapes.append(DrawnShape(kind, role, np.round(points, 4), (moves[0], moves[-1]), tuple(of.split()), about))

    # shapes

    def line(
        self, *points: Point, role: str = "measure", width: float = 0.9, dashes: Sequence[float] = (),
        moves: Sequence[Moves] = (),
    ) -> None:  # fmt: skip
        """A line, `width` in points; `moves` are those of the whole or of its two ends."""
        self._add("line", role, points, *moves, width=width, dashes=list(dashes))

    def polygon(self, points: Sequence[Point], role: str = "body", moves: Moves = STILL) -> None:
        """A filled polygon; its last point need not be its first."""
        self._add("polygon", role, [*points, points[0]], moves)

    def circle(self, centre: Point, radius: float, role: str = "body", moves: Moves = STILL) -> None:
        """A filled circle."""
        self._add("circle", role, [centre], moves, radius=radius)

    def arrow(self, start: Point, end: Point, role: str = "measure", moves: Moves = STILL) -> None:
        """An arrow."""
        self._add("arrow", role, [start, end], moves)

    def text(
        self, at: Point, text: str, of: str = "", role: str = "measure", *, size: float = 8.0, anchor: str = "center",
        moves: Moves = STILL,
    ) -> None:  # fmt: skip
        """A text, `$k_1$` for a symbol, that stands for the parameters named in `of` with blanks between."""
        self._add("text", role, [at], moves, of=of, text=text, size=size, anchor=anchor)

    # what brakes are made of

    def box(
        self, corner: Point, width: float, height: float, text: str = "", of: str = "", moves: Moves = STILL
    ) -> None:
        """A rectangular body from its lower left corner, its name in the middle."""
        (x, y), (right, top) = corner, (corner[0] + width, corner[1] + height)
        self.polygon([(x, y), (right, y), (right, top), (x, top)], moves=moves)
        if text:
            self.text((x + 0.5 * width, y + 0.5 * height), text, of, "body", moves=moves)

    def ring(
        self, outer: float, width: float, begin: float, end: float, role: str = "body", moves: Moves = STILL
    ) -> None:
        """A piece of a ring about the origin between two angles [rad], `outer` its radius."""
        rim = _around(np.linspace(begin, end, 30))
        self.polygon([*(outer * rim), *((outer - width) * rim[::-1])], role, moves)

    def spring(
        self, start: Point, end: Point, text: str = "", of: str = "", side: float = 1.0, moves: Sequence[Moves] = ()
    ) -> None:
        """A zigzag between two points, its name beside the middle; `moves` are those of its two ends."""
        a, b, _, across = _frame(start, end)
        zigzag = [a + (0.2 + 0.6 * (i + 0.5) / 8) * (b - a) + (0.07 if i % 2 else -0.07) * across for i in range(8)]
        self.line(a, a + 0.2 * (b - a), *zigzag, a + 0.8 * (b - a), b, role="spring", moves=moves)
        if text:
            self.text(tuple(0.5 * (a + b) + 0.22 * side * across), text, of)

    def dashpot(
        self, start: Point, end: Point, text: str = "", of: str = "", side: float = 1.0,
        moves: Sequence[Moves] = (STILL, STILL),
    ) -> None:  # fmt: skip
        """A dashpot: its cup goes with the start, its piston with the end."""
        a, b, along, across = _frame(start, end)
        middle = 0.5 * (a + b)
        cup = [middle + s * 0.14 * along + h * 0.09 * across for s, h in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
        piston = (middle + 0.07 * across, middle - 0.07 * across)
        for points, goes in (((a, middle - 0.14 * along), 0), (cup, 0), (piston, 1), ((middle, b), 1)):
            self.line(*points, role="damper", moves=moves[goes : goes + 1])
        if text:
            self.text(middle + 0.24 * side * across, text, of)

    def wall(self, at: Point, angle: float, width: float = 0.5) -> None:
        """A hatched support at a point, its free side towards `angle` [rad]."""
        (out,) = _around([angle])
        along = np.array([-out[1], out[0]])
        self.line(*(at + s * width * along for s in (-0.5, 0.5)), role="support", width=1.4)
        for s in np.linspace(-0.4, 0.5, 6):
            foot = at + s * width * along
            self.line(foot, foot - 0.09 * out - 0.09 * along, role="support", width=0.5)

    def arc(
        self, centre: Point, radius: float, begin: float, end: float, text: str, of: str = "", moves: Moves = STILL
    ) -> None:
        """An angle from `begin` to `end` [rad] with its name."""
        self.line(*(centre + radius * _around(np.linspace(begin, end, 40))), width=0.6, moves=(moves,))
        (middle,) = centre + (radius + 0.16) * _around([0.5 * (begin + end)])
        self.text(middle, text, of, size=7.0, moves=moves)

    def axis(self, start: Point, end: Point, text: str, at: Point) -> None:
        """An arrow in the direction of a coordinate, with its name."""
        self.arrow(start, end)
        self.text(at, text)

    def load(self, start: Point, end: Point, text: str, of: str, at: Point, moves: Moves = STILL) -> None:
        """The force that the parameter `of` is, its tip at `end`; the larger, the longer, its name at `at` with it."""
        size = self.size_of(of)
        shift = (1.0 - size) * np.subtract(end, start)
        if size:
            self.arrow(start + shift, end, "load", moves)
        self.text(at + shift, text if size else f"{text} = 0", of, "load", moves=moves)

    def velocity(self, start: Point, end: Point, text: str, of: str, at: Point) -> None:
        """The speed that the parameter `of` is: an arrow about its middle, the other way where it is negative."""
        size = self.size_of(of)
        middle, half = 0.5 * np.add(start, end), 0.5 * size * np.subtract(end, start)
        if size:
            self.arrow(middle - half, middle + half, "motion")
        self.text(at, text if size else f"{text} = 0", of, "motion")

    def turning(self, radius: float, begin: float, end: float, text: str, of: str) -> None:
        """The same about the origin, between two angles [rad]."""
        size, middle = self.size_of(of), 0.5 * (begin + end)
        half = 0.5 * size * (end - begin)
        points = radius * _around(np.linspace(middle - half, middle + half, 60))
        if size:
            self.line(*points, role="motion", width=1.4)
            self.arrow(points[-3], points[-1], "motion")
        self.text(1.13 * points[30], text if size else f"{text} = 0", of, "motion")

    def belt(self, left: float, right: float, of: str = "sliding_speed") -> None:
        """A belt below the blocks, which moves to the right where its speed is positive."""
        self.line((left, 0.0), (right, 0.0), role="motion", width=2.0)
        for x in (left, right):
            self.circle((x, -0.16), 0.16, "motion")
        self.line((left, -0.32), (right, -0.32), role="motion", width=1.0)
        middle = 0.5 * (left + right)
        self.velocity((middle - 0.35, -0.16), (middle + 0.35, -0.16), "V", of, (middle + 0.62, -0.16))

    def contact(self, at: Point, press: Point, moves: Moves = STILL) -> None:
        """The next contact of the system: its place, and the way its normal force presses on what moves there."""
        self.contacts.append((at, press, moves))

    def size_of(self, name: str) -> float:
        """How long the arrow of a load or speed is: 1 at its usual value, the square root of how many times that else.

        Negative for a negative value, 0 for none; a schedule is drawn as usual.
        """
        value, usual = self.design.value_of(name), self.design.usual(name)
        if not isinstance(value, float) or not usual:
            return 1.0
        return float(np.sign(value) * np.clip(np.sqrt(abs(value / usual)), 0.3, 1.6)) if value else 0.0


def drawing_of(design: Any) -> Shapes:
    """The drawing of a brake, without what a countermeasure adds; of one without, a box for each degree of freedom.

    Its contacts are known where it has as many as the system.

    >>> from squealbox import MassOnBelt
    >>> shapes = drawing_of(MassOnBelt())
    >>> sorted({shape.kind for shape in shapes.shapes}), sorted(shapes.places())
    (['arrow', 'circle', 'line', 'polygon', 'text'], ['c', 'k', 'load', 'm', 'sliding_speed'])
    """
    system, shapes = design.system(), Shapes(design.innermost)
    design.innermost.draw(shapes)
    if not shapes.shapes:
        for i, name in enumerate(system.names[:MOST_SHOWN]):
            shapes.box((1.4 * (i % 4) - 0.4, -1.3 * (i // 4) - 0.3), 0.8, 0.6, str(name), moves={i: RIGHT})
    if len(shapes.contacts) != len(system.contacts):
        shapes.contacts = []
    return shapes


def _moved(points: np.ndarray, moves: Moves, size: int) -> Any:
    """What `moves` adds to points (k, 2) for each of `size` degrees of freedom, (size, k, 2)."""
    found = np.zeros((size, len(points), 2))
    for dof, way in moves.items():
        found[dof] = way * np.stack([-points[:, 1], points[:, 0]], axis=1) if isinstance(way, float) else way
    return found


def _around(angles: Sequence[float] | np.ndarray) -> Any:
    """Points of the unit circle, (k, 2)."""
    return np.stack([np.cos(angles), np.sin(angles)], axis=1)


def _frame(start: Point, end: Point) -> tuple[Any, Any, Any, Any]:
    """Both points, and the directions along and across."""
    a, b = np.array(start), np.array(end)
    along = (b - a) / np.hypot(*(b - a))
    return a, b, along, np.array([-along[1], along[0]])


@dataclass(frozen=True, eq=False)
class Surface:
    """Of k nodes their places (k, 3) [m], and faces (f, 4), nodes in a turn; a lone node stands there four times.

    parts (f,) numbers the component of each face in `names`. rows (k, 3) is the freedom along x, y and z, -1 where it
    is held; of a reduced brake moves (k, 3, m) is what each of its m coordinates does to the nodes instead. touching
    (contacts, 3) [m] is where the contacts are, empty where that is not known. Every `step`-th line of the mesh, or
    node, is there.
    """

    places: Any
    faces: Any
    parts: Any
    names: tuple[str, ...]
    rows: Any
    touching: Any
    step: int
    moves: Any = None

    left_out_of_files: ClassVar[bool] = True

    @property
    def lone(self) -> bool:
        """True where it has no faces, only nodes."""
        return bool(np.all(self.faces[:, :1] == self.faces))

    @property
    def size(self) -> float:
        """Half the diagonal of the box it stands in [m]."""
        return 0.5 * float(np.linalg.norm(np.ptp(self.places, axis=0)))

    @property
    def middle(self) -> Any:
        """Middle of that box, (3,) [m]."""
        return 0.5 * (self.places.min(axis=0) + self.places.max(axis=0))

    def moved(self, shape: Any) -> Any:
        """Displacement (k, 3) of the nodes in a shape, turned and scaled so that its largest component is 1.

        The shape is one of all freedoms (n,), of a reduced brake one of its coordinates (m,).
        """
        if self.moves is None:
            moved = np.where(self.rows >= 0, np.asarray(shape)[self.rows], 0.0)
        else:
            moved = np.asarray(self.moves, dtype=float) @ shape
        return moved / moved.flat[np.argmax(np.abs(moved))]

    def shares(self, moved: Any) -> Any:
        """Of the motion of each face, the share (f,) of that of the node that moves most."""
        size = np.linalg.norm(np.abs(moved), axis=1)
        return np.mean(size[self.faces], axis=1) / np.max(size)

    def next_to_contacts(self) -> Any:
        """The node nearest to each contact (contacts,)."""
        nearest = [int(np.argmin(np.sum((self.places - at) ** 2, axis=1))) for at in self.touching]
        return np.array(nearest, dtype=int)
