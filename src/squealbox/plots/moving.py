"""How a drawing moves with its brake: which part goes along with which degree of freedom, and where the contacts are.

A point inside a part moves with it, a point outside stands still; along a line (a spring) the motion of its two ends is
shared out. So one table of parts a design makes its drawing (`brake_strokes`) move.
"""

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

from squealbox.designs import (
    BlockChain,
    DampingParadox,
    Design,
    DrumBrake,
    DrumBrakeShoes,
    InclinedSprings,
    MassOnBelt,
    ModeCoupling,
    PadOnDisc,
    SpragSlip,
    WobblingDisc,
)
from squealbox.plots.strokes import brake_strokes

MOST_SHOWN = 12  # degrees of freedom of a brake without a drawing
Inside = Callable[[Any], Any]
Part = tuple[Inside, Mapping[int, tuple[float, float] | float]]  # a number: it turns about the middle, m to a unit
RIGHT, UP, DOWN = (1.0, 0.0), (0.0, 1.0), (0.0, -1.0)


def moving_strokes(design: Design) -> dict[str, Any]:
    """The strokes of a brake with the places of its contacts, and how each of its points moves.

    `points` (k, 2) are those of the strokes one after the other, `moves` (n, k, 2) is what one metre or radian of each
    degree of freedom adds to them; each stroke says with which point it begins and how many it has.

    >>> from squealbox import MassOnBelt
    >>> moving_strokes(MassOnBelt())["moves"].shape[0]
    1
    """
    brake = design.innermost
    drawn, system = brake_strokes(brake), design.system()
    size = system.size
    kind = next((kind for kind in PARTS if isinstance(brake, kind)), None)
    if kind is None:
        drawn, parts, contacts = _boxes(system.names)
    else:
        parts, contacts = PARTS[kind](brake)
    points, goes, strokes = [], [], []
    for stroke in drawn["strokes"]:
        names = [name for name in ("points", "at", "start", "end") if name in stroke]
        own = np.concatenate([np.reshape(stroke[name], (-1, 2)) for name in names])
        strokes.append({key: value for key, value in stroke.items() if key not in names} | {"count": len(own)})
        points.append(own)
        goes.append(_goes_with(stroke["kind"], own, float(stroke.get("radius", 0.0))))
    moves = _at(np.concatenate(points), parts, size, of=np.concatenate(goes))
    first = 0
    for stroke, own in zip(strokes, points, strict=True):
        if stroke["kind"] == "line" and len(own) > 1:
            part = slice(first, first + len(own))
            moves[:, part] = _shared_out(own, moves[:, first], moves[:, part.stop - 1])
        first += len(own)
    known = contacts if len(contacts) == len(system.contacts) else []
    return {
        "strokes": strokes,
        "box": drawn["box"],
        "points": np.concatenate(points),
        "moves": moves,
        "contacts": known,
        "contactMoves": np.stack([_at(np.reshape(at[:2], (1, 2)), parts, size)[:, 0] for at in known], axis=1)
        if known else np.zeros((size, 0, 2)),
    }  # fmt: skip


def _goes_with(kind: str, points: Any, radius: float) -> Any:
    """The places (k, 2) whose part each point of a stroke goes along with: a whole polygon with its middle."""
    if kind == "polygon":
        return np.broadcast_to(np.mean(points[:-1], axis=0), points.shape)
    if kind == "circle":
        return points + np.array([radius, 0.0])
    return np.broadcast_to(points[-1], points.shape) if kind == "arrow" else points


def _shared_out(points: Any, begin: Any, end: Any) -> Any:
    """Along a line (k, 2) the moves (size, 2) of its ends, shared out by the way, shape (size, k, 2)."""
    way = np.r_[0.0, np.cumsum(np.hypot(*np.diff(points, axis=0).T))]
    share = (way / way[-1] if way[-1] else way)[None, :, None]
    return (1.0 - share) * begin[:, None] + share * end[:, None]


def _at(points: Any, parts: list[Part], size: int, of: Any = None) -> Any:
    found = np.zeros((size, len(points), 2))
    for inside, dofs in parts:
        within = np.broadcast_to(inside(points if of is None else of), len(points))
        for dof, way in dofs.items():
            if dof < size:
                turned = np.stack([-points[:, 1], points[:, 0]], axis=1)
                step = np.asarray(way) * (turned if isinstance(way, float) else np.ones((len(points), 1)))
                found[dof, within] += step[within]
    return found


def _box(left: float, right: float, bottom: float, top: float) -> Inside:
    return lambda p: (p[:, 0] >= left) & (p[:, 0] <= right) & (p[:, 1] >= bottom) & (p[:, 1] <= top)


def _disc(x: float, y: float, radius: float, hole: float = 0.0) -> Inside:
    return lambda p: (np.hypot(p[:, 0] - x, p[:, 1] - y) <= radius) & (np.hypot(p[:, 0] - x, p[:, 1] - y) >= hole)


Contacts = list[tuple[float, float, float, float]]  # place, and the way the normal force presses the moving part


def _drum_brake(brake: DrumBrake) -> tuple[list[Part], Contacts]:
    ways = [(np.sin(angle), np.cos(angle)) for angle in (float(brake.theta1), float(brake.theta2))]
    return [(_disc(0.0, 0.0, 0.83), {0: RIGHT, 1: UP})], [(0.8 * x, 0.8 * y, -x, -y) for x, y in ways]


def _shoes(brake: DrumBrakeShoes) -> tuple[list[Part], Contacts]:
    radius = float(brake.radius)
    parts: list[Part] = [(_disc(0.0, 0.0, 1.2, 0.995), {0: RIGHT, 1: UP})]
    contacts: Contacts = []
    for shoe, side in ((0, 1.0), (1, -1.0)):
        half = _box(0.03, 2.0, -2.0, 2.0) if side > 0.0 else _box(-2.0, -0.03, -2.0, 2.0)

        def inside(p: Any, half: Inside = half) -> Any:
            reach = np.hypot(p[:, 0], p[:, 1])
            return half(p) & (reach > 0.6) & (reach < 0.99)

        parts.append((inside, {2 + 3 * shoe: RIGHT, 3 + 3 * shoe: UP, 4 + 3 * shoe: radius}))
        contacts += [(0.95 * np.cos(a), 0.95 * np.sin(a), -np.cos(a), -np.sin(a)) for a in brake.lining_angles(shoe)]
    return parts, contacts


def _belted(brake: Design) -> tuple[list[Part], Contacts]:
    return [(_box(-0.42, 0.42, 0.02, 0.66), {0: RIGHT})], [(0.0, 0.03, 0.0, -1.0)]


def _chain(brake: BlockChain) -> tuple[list[Part], Contacts]:
    shown = range(min(brake.blocks, 5))
    parts: list[Part] = [(_box(1.5 * i - 0.36, 1.5 * i + 0.36, 0.02, 0.54), {i: RIGHT}) for i in shown]
    return parts, [(1.5 * i, 0.03, 0.0, -1.0) for i in shown]


def _held(brake: Design) -> tuple[list[Part], Contacts]:
    return [(_disc(0.0, 0.85, 0.31), {0: RIGHT, 1: DOWN})], [(0.0, 0.04, 0.0, -1.0)]


def _paradox(brake: Design) -> tuple[list[Part], Contacts]:
    return [(_box(-0.36, 0.36, -0.36, 0.36), {0: RIGHT, 1: DOWN})], [(1.15, 0.0, -1.0, 0.0), (0.0, -1.15, 0.0, 1.0)]


def _pad(brake: Design) -> tuple[list[Part], Contacts]:
    parts: list[Part] = [
        (_box(-0.51, 0.51, -0.01, 0.43), {0: RIGHT}), (_box(-1.21, 1.21, -0.46, -0.02), {1: RIGHT})
    ]  # fmt: skip
    return parts, [(0.0, 0.0, 0.0, -1.0)]


def _sprag(brake: Design) -> tuple[list[Part], Contacts]:
    return [(_box(-0.31, 0.31, 0.02, 0.44), {0: RIGHT, 1: DOWN})], [(0.0, 0.03, 0.0, -1.0)]


def _wobbling(brake: WobblingDisc) -> tuple[list[Part], Contacts]:
    half = max(0.5 * float(brake.h) / float(brake.r), 0.02)
    ends = [(1.0, np.tan(-0.1) + side * half / np.cos(0.1), 0.0, -side) for side in (1.0, -1.0)]
    return [(_box(-1.3, 1.3, -0.14 - half, 0.14 + half), {0: -float(brake.r)})], ends


def _boxes(freedoms: tuple[str, ...]) -> tuple[dict[str, Any], list[Part], Contacts]:
    """A brake without a drawing: a box for each degree of freedom, side by side."""
    names = freedoms[:MOST_SHOWN]
    strokes: list[dict[str, Any]] = []
    parts: list[Part] = []
    for i, name in enumerate(names):
        x, y = 1.4 * (i % 4), -1.3 * (i // 4)
        corners = [[x - 0.4, y - 0.3], [x + 0.4, y - 0.3], [x + 0.4, y + 0.3], [x - 0.4, y + 0.3], [x - 0.4, y - 0.3]]
        strokes.append({"kind": "polygon", "role": "body", "fill": "#dfe8f0", "points": corners})
        strokes.append({"kind": "text", "role": "body", "at": [x, y], "text": str(name), "anchor": "center"})
        parts.append((_box(x - 0.5, x + 0.5, y - 0.4, y + 0.4), {i: RIGHT}))
    wide, high = min(len(names), 4), (len(names) - 1) // 4
    box = [-0.7, 1.4 * (wide - 1) + 0.7, -1.3 * high - 0.5, 0.5]
    return {"strokes": strokes, "box": box}, parts, []


PARTS: dict[type[Design], Callable[[Any], tuple[list[Part], Contacts]]] = {
    DrumBrake: _drum_brake,
    DrumBrakeShoes: _shoes,
    MassOnBelt: _belted,
    BlockChain: _chain,
    ModeCoupling: _held,
    InclinedSprings: _held,
    DampingParadox: _paradox,
    PadOnDisc: _pad,
    SpragSlip: _sprag,
    WobblingDisc: _wobbling,
}
