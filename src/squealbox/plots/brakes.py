"""A drawing of each brake from its own parameters: bodies, springs, angles, loads and the direction of sliding."""

from collections.abc import Callable
from typing import TYPE_CHECKING, Any

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
from squealbox.plots.dispatch import drawn_by
from squealbox.plots.style import COLUMN, drawing, figure_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BODY: dict[str, Any] = {"facecolor": "#dfe8f0", "edgecolor": "black", "linewidth": 1.0}
BELT, LOAD, PART = "#0072B2", "#D55E00", {"color": "black", "linewidth": 0.9}
Point = tuple[float, float]
ARROW = {"arrowstyle": "-|>", "shrinkA": 0.0, "shrinkB": 0.0, "mutation_scale": 9.0}


@drawn_by.register(Design)
def brake_drawing(design: Design, *, axes: Any = None) -> "Figure":
    """The brake as its parameters describe it; angles are to scale, lengths where the design has any.

    Blue is what slides and where it moves, orange are loads. Raises `TypeError` for a design no drawing is known
    for, or one that stands for a whole map.
    """
    draw = drawing_of(type(design))
    if draw is None:
        known = ", ".join(sorted(each.__name__ for each in DRAWINGS))
        raise TypeError(f"no drawing is known for {type(design).__name__}: expected one of {known}")
    if any(np.ndim(value) for _, about, value in design.leaves() if about.unit != "-"):
        raise TypeError(f"{type(design).__name__} stands for a map of brakes: expected one")
    with drawing(axes, width=1.3 * COLUMN, height=3.2) as panel:
        draw(panel, design)
        panel.set_aspect("equal")
        panel.set_axis_off()
        panel.margins(0.06)
        panel.autoscale_view()
        return figure_of(panel)


def drawing_of(kind: type[Design]) -> Callable[[Any, Any], None] | None:
    """How designs of this kind are drawn on a panel; None where no drawing is known."""
    if kind.draw is not Design.draw:
        return lambda panel, design: design.draw(panel)
    return next((draw for known, draw in DRAWINGS.items() if issubclass(kind, known)), None)


def _line(panel: Any, *points: Point, **look: Any) -> None:
    panel.plot([p[0] for p in points], [p[1] for p in points], **{**PART, "solid_capstyle": "round", **look})


def _text(panel: Any, at: Point, text: str, **look: Any) -> None:
    panel.text(*at, text, **{"ha": "center", "va": "center", "fontsize": 8, **look})


def size_of(brake: Design, name: str) -> float:
    """How large the arrow of a load or speed is drawn: 1 at the design's usual value, growing with the square root.

    Negative for a negative value, 0 for none; a schedule is drawn as usual.
    """
    value, usual = brake.value_of(name), getattr(type(brake), brake.aliases.get(name, (name,))[0])
    if not isinstance(value, float) or not usual:
        return 1.0
    if value == 0.0:
        return 0.0
    return float(np.sign(value) * np.clip(np.sqrt(abs(value / usual)), 0.3, 1.6))


def _arrow(
    panel: Any, start: Point, end: Point, colour: str, label: str = "", at: Point | None = None, size: float = 1.0
) -> None:
    """An arrow whose tip stays where it is while `size` moves its tail, with its label at `at`, beside the tail."""
    moved = [float((1.0 - size) * (e - s)) for s, e in zip(start, end, strict=True)]
    start = (start[0] + moved[0], start[1] + moved[1])
    at = None if at is None else (at[0] + moved[0], at[1] + moved[1])
    if size == 0.0:
        _text(panel, at or start, f"{label} = 0", color=colour)
        return
    panel.annotate("", xy=end, xytext=start, arrowprops={**ARROW, "color": colour, "linewidth": 1.4})
    panel.plot([start[0], end[0]], [start[1], end[1]], linestyle="none")  # so that the limits include it
    if label:
        _text(panel, at or start, label, color=colour)


def _spring(panel: Any, start: Point, end: Point, label: str = "", side: float = 1.0) -> None:
    """A zigzag between two points, its label beside the middle."""
    a, b = np.array(start), np.array(end)
    length = float(np.hypot(*(b - a)))
    along = (b - a) / length
    across = np.array([-along[1], along[0]])
    turns = 8
    knots = [a, a + 0.2 * length * along]
    for i in range(turns):
        knots.append(a + (0.2 + 0.6 * (i + 0.5) / turns) * length * along + (0.07 if i % 2 else -0.07) * across)
    knots += [a + 0.8 * length * along, b]
    _line(panel, *(tuple(k) for k in knots))
    if label:
        _text(panel, tuple(0.5 * (a + b) + 0.22 * side * across), label)


def _wall(panel: Any, at: Point, angle: float, width: float = 0.5) -> None:
    """A hatched support at a point, its free side towards `angle`."""
    out = np.array([np.cos(angle), np.sin(angle)])
    along = np.array([-out[1], out[0]])
    ends = [np.array(at) + s * 0.5 * width * along for s in (-1.0, 1.0)]
    _line(panel, *(tuple(e) for e in ends), linewidth=1.4)
    for s in np.linspace(-0.4, 0.5, 6):
        foot = np.array(at) + s * width * along
        _line(panel, tuple(foot), tuple(foot - 0.09 * out - 0.09 * along), linewidth=0.5)


def _box(panel: Any, corner: Point, width: float, height: float, label: str = "") -> None:
    from matplotlib.patches import Rectangle

    panel.add_patch(Rectangle(corner, width, height, **BODY))
    if label:
        _text(panel, (corner[0] + 0.5 * width, corner[1] + 0.5 * height), label)


def _belt(panel: Any, left: float, right: float, speed: float = 1.0, label: str = "V") -> None:
    """A belt below the blocks, moving to the right where its speed is positive."""
    y = 0.0
    _line(panel, (left, y), (right, y), color=BELT, linewidth=2.0)
    for r in (left, right):
        panel.add_patch(_circle((r, y - 0.16), 0.16, facecolor="white", edgecolor=BELT, linewidth=1.0))
    _line(panel, (left, y - 0.32), (right, y - 0.32), color=BELT, linewidth=1.0)
    middle = 0.5 * (left + right)
    _velocity(panel, (middle - 0.35, y - 0.16), (middle + 0.35, y - 0.16), label, (middle + 0.62, y - 0.16), speed)


def _velocity(panel: Any, start: Point, end: Point, label: str, at: Point, size: float) -> None:
    """An arrow that grows about its middle, and points the other way where `size` is negative."""
    middle, half = 0.5 * (np.array(start) + np.array(end)), 0.5 * size * (np.array(end) - np.array(start))
    if size == 0.0:
        _text(panel, at, f"{label} = 0", color=BELT)
    else:
        _arrow(panel, tuple(middle - half), tuple(middle + half), BELT)
        _text(panel, at, label, color=BELT)


def _circle(centre: Point, radius: float, **look: Any) -> Any:
    from matplotlib.patches import Circle

    return Circle(centre, radius, **look)


def _arc(panel: Any, centre: Point, radius: float, begin: float, end: float, label: str) -> None:
    """An angle from `begin` to `end` [rad] with its name."""
    angles = np.linspace(begin, end, 40)
    _line(panel, *((centre[0] + radius * np.cos(a), centre[1] + radius * np.sin(a)) for a in angles), linewidth=0.6)
    middle = 0.5 * (begin + end)
    reach = radius + 0.16
    _text(panel, (centre[0] + reach * np.cos(middle), centre[1] + reach * np.sin(middle)), label, fontsize=7)


def _mass_on_belt(panel: Any, brake: MassOnBelt) -> None:
    _belt(panel, -1.6, 1.6, size_of(brake, "sliding_speed"))
    _box(panel, (-0.4, 0.03), 0.8, 0.6, "m")
    _spring(panel, (-1.8, 0.45), (-0.4, 0.45), "k")
    _dashpot(panel, (-1.8, 0.17), (-0.4, 0.17))
    _text(panel, (-0.85, 0.27), "c", fontsize=7)
    _wall(panel, (-1.8, 0.33), 0.0, 0.8)
    _arrow(panel, (0.0, 1.2), (0.0, 0.65), LOAD, "N", (0.15, 1.1), size_of(brake, "load"))
    _arrow(panel, (0.5, 0.75), (0.95, 0.75), "black", "x", (1.05, 0.75))


def _dashpot(panel: Any, start: Point, end: Point, label: str = "", side: float = 1.0) -> None:
    """A dashpot between two points."""
    a, b = np.array(start), np.array(end)
    along = (b - a) / np.hypot(*(b - a))
    across = np.array([-along[1], along[0]])
    middle = 0.5 * (a + b)
    cup = [middle + s * 0.14 * along + h * 0.09 * across for s, h in ((1, 1), (-1, 1), (-1, -1), (1, -1))]
    _line(panel, start, tuple(middle - 0.14 * along))
    _line(panel, *(tuple(p) for p in cup))
    _line(panel, tuple(middle + 0.07 * across), tuple(middle - 0.07 * across))
    _line(panel, tuple(middle), end)
    if label:
        _text(panel, tuple(middle + 0.24 * side * across), label)


def _block_chain(panel: Any, brake: BlockChain) -> None:
    shown = min(brake.blocks, 5)
    pitch = 1.5
    _belt(panel, -1.1, pitch * (shown - 1) + 1.1, size_of(brake, "sliding_speed"))
    for i in range(shown):
        x = pitch * i
        _box(panel, (x - 0.35, 0.03), 0.7, 0.5, "m")
        _spring(panel, (x - 0.15, 0.53), (x - 0.55, 1.4), "k")
        _arrow(panel, (x + 0.12, 1.1), (x + 0.12, 0.56), LOAD, "N", (x + 0.28, 1.0), size_of(brake, "load"))
        if i:
            _spring(panel, (x - pitch + 0.35, 0.28), (x - 0.35, 0.28), "$k_c$")
    _wall(panel, (0.5 * pitch * (shown - 1) - 0.55, 1.4), -np.pi / 2, pitch * (shown - 1) + 0.7)
    if shown < brake.blocks:
        _text(panel, (pitch * (shown - 1) + 0.8, 0.28), f"... {brake.blocks} blocks", ha="left")


def _held_mass(panel: Any, brake: Design, angles: list[tuple[float, str]]) -> None:
    """A mass above a belt with its contact spring, and springs away from it at angles from the belt."""
    _belt(panel, -1.7, 1.7, size_of(brake, "sliding_speed"))
    centre = (0.0, 0.85)
    for angle, name in angles:
        way = angle if np.sin(angle) >= -1e-9 else angle + np.pi  # a spring has no sense: drawn away from the belt
        out = np.array([np.cos(way), np.sin(way)])
        end = np.array(centre) + 1.5 * out
        _spring(panel, tuple(np.array(centre) + 0.3 * out), tuple(end), name)
        _wall(panel, tuple(end), way + np.pi)
    panel.add_patch(_circle(centre, 0.3, **BODY, zorder=3))
    _text(panel, centre, "m", zorder=4)
    _spring(panel, (0.0, 0.55), (0.0, 0.04), "$k_3$", -1.0)
    _arrow(panel, (0.0, 1.75), (0.0, 1.18), LOAD, "N", (-0.14, 1.65), size_of(brake, "load"))
    _arrow(panel, (1.55, 0.35), (2.0, 0.35), "black", "x", (2.1, 0.35))
    _arrow(panel, (1.55, 0.35), (1.55, 0.07), "black", "y", (1.42, 0.15))


def _mode_coupling(panel: Any, brake: ModeCoupling) -> None:
    """The principal springs of the stiffness without the contact, at their angles."""
    stiffness = np.array([[brake.k11, brake.k12], [brake.k12, brake.k22 - brake.k3]])
    _, vectors = np.linalg.eigh(stiffness)
    # the belt's y is downwards in the figure
    names = ("soft", "stiff")
    _held_mass(panel, brake, [(float(np.arctan2(-v[1], v[0])), n) for v, n in zip(vectors.T, names, strict=True)])


def _inclined(panel: Any, brake: InclinedSprings) -> None:
    angles = [(-brake.angle1, "$k_1$"), (-brake.angle2, "$k_2$")]  # y is downwards in the figure
    _held_mass(panel, brake, [(float(np.arctan2(np.sin(a), np.cos(a))), name) for a, name in angles])


def _paradox(panel: Any, brake: DampingParadox) -> None:
    _box(panel, (-0.35, -0.35), 0.7, 0.7, "m")
    _spring(panel, (0.35, 0.0), (1.15, 0.0), "$k_1, c_1$")
    _spring(panel, (0.0, -0.35), (0.0, -1.15), "$k_2, c_2$")
    _line(panel, (1.15, -0.6), (1.15, 0.6), color=BELT, linewidth=2.0)
    _line(panel, (-0.6, -1.15), (0.6, -1.15), color=BELT, linewidth=2.0)
    speed = size_of(brake, "sliding_speed")
    _velocity(panel, (1.3, -0.4), (1.3, 0.4), "V", (1.45, 0.0), speed)
    _velocity(panel, (-0.4, -1.3), (0.4, -1.3), "V", (0.0, -1.48), speed)
    _arrow(panel, (-1.0, 0.0), (-0.38, 0.0), LOAD, "N", (-1.1, 0.0), size_of(brake, "load"))
    _arrow(panel, (0.0, 1.0), (0.0, 0.38), LOAD, "N", (0.0, 1.12), size_of(brake, "load"))
    _arrow(panel, (0.5, 0.75), (0.95, 0.75), "black", "x", (1.05, 0.75))
    _arrow(panel, (0.5, 0.75), (0.5, 0.42), "black", "y", (0.62, 0.52))


def _pad_on_disc(panel: Any, brake: PadOnDisc) -> None:
    _box(panel, (-1.2, -0.45), 2.4, 0.42, "disc $m_2$")
    _box(panel, (-0.5, 0.0), 1.0, 0.42, "pad $m_1$")
    _spring(panel, (-1.6, 0.3), (-0.5, 0.3), "$k_1$")
    _dashpot(panel, (-1.6, 0.1), (-0.5, 0.1), "", -1.0)
    _text(panel, (-1.28, -0.02), "$c_1$", fontsize=7)
    _wall(panel, (-1.6, 0.2), 0.0, 0.5)
    _spring(panel, (-2.2, -0.15), (-1.2, -0.15))
    _text(panel, (-1.85, 0.05), "$k_2$")
    _dashpot(panel, (-2.2, -0.36), (-1.2, -0.36), "$c_2$", -1.0)
    _wall(panel, (-2.2, -0.25), 0.0, 0.5)
    _velocity(panel, (-0.4, -0.68), (0.5, -0.68), "V", (0.05, -0.84), size_of(brake, "sliding_speed"))
    _arrow(panel, (0.0, 1.0), (0.0, 0.45), LOAD, "N", (0.14, 0.9), size_of(brake, "load"))


def _sprag(panel: Any, brake: SpragSlip) -> None:
    _belt(panel, -1.3, 1.9, size_of(brake, "sliding_speed"))
    _box(panel, (-0.3, 0.03), 0.6, 0.4)
    _text(panel, (-0.16, 0.3), "m")
    start = np.array([0.0, 0.23])
    out = np.array([np.cos(brake.angle), np.sin(brake.angle)])
    _spring(panel, tuple(start), tuple(start + 1.6 * out), "$k_s$")
    _wall(panel, tuple(start + 1.6 * out), brake.angle + np.pi)
    _line(panel, tuple(start), (1.1, 0.23), linewidth=0.5, linestyle=(0, (4, 2)))
    _arc(panel, (0.0, 0.23), 0.6, 0.0, brake.angle, f"{np.rad2deg(brake.angle):.0f}°")
    _arrow(panel, (-0.18, 1.1), (-0.18, 0.46), LOAD, "L", (-0.32, 1.0), size_of(brake, "load"))


def _wobbling(panel: Any, brake: WobblingDisc) -> None:
    """A section through the axis and the pins, the thickness to the scale of the pins' radius."""
    tilt = -0.1  # q1 > 0 turns the right side down
    half = max(0.5 * brake.h / brake.r, 0.02)
    turn = np.array([[np.cos(tilt), -np.sin(tilt)], [np.sin(tilt), np.cos(tilt)]])
    corners = (turn @ np.array([[-1.25, 1.25, 1.25, -1.25], [-half, -half, half, half]])).T
    from matplotlib.patches import Polygon

    panel.add_patch(Polygon(corners, **BODY))
    _line(panel, (0.0, -1.15), (0.0, 0.9), linewidth=0.6, linestyle=(0, (6, 2, 1, 2)))
    _line(panel, (-1.4, 0.0), (1.4, 0.0), linewidth=0.5, linestyle=(0, (4, 2)))
    _arc(panel, (0.0, 0.0), 1.38, tilt, 0.0, "$q_1$")
    for side in (1.0, -1.0):
        touch = np.tan(tilt) + side * half / np.cos(tilt)
        _line(panel, (1.0, touch), (1.0, touch + side * 0.2), linewidth=3.0)
        _spring(panel, (1.0, touch + side * 0.2), (1.0, touch + side * 0.8), "k, d" if side > 0 else "", -1.0)
        _wall(panel, (1.0, touch + side * 0.8), -side * np.pi / 2)
        _arrow(
            panel,
            (0.75, touch + side * 0.65),
            (0.75, touch + side * 0.12),
            LOAD,
            "$N_0$",
            (0.6, touch + side * 0.5),
            size_of(brake, "load"),
        )
    _velocity(panel, (-0.3, 0.72), (0.3, 0.72), "$\\Omega$", (-0.6, 0.72), size_of(brake, "spin"))
    _line(panel, (0.0, -1.1), (1.0, -1.1), linewidth=0.5)
    _text(panel, (0.4, -1.2), f"r = {1e3 * brake.r:.0f} mm", fontsize=7)
    _text(panel, (-0.75, -0.2), f"h = {1e3 * brake.h:.0f} mm, $k_t$, $d_t$", fontsize=7)


def _turning(panel: Any, radius: float, begin: float, end: float, label: str, size: float) -> None:
    """An arrow along a circle, the other way round where `size` is negative."""
    if size == 0.0:
        way = np.deg2rad(0.5 * (begin + end))
        _text(panel, (1.13 * radius * np.cos(way), 1.13 * radius * np.sin(way)), f"{label} = 0", color=BELT)
        return
    middle, half = 0.5 * (begin + end), 0.5 * size * (end - begin)
    begin, end = middle - half, middle + half
    angles = np.deg2rad(np.linspace(begin, end, 60))
    points = radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    _line(panel, *(tuple(p) for p in points), color=BELT, linewidth=1.4)
    _arrow(panel, tuple(points[-3]), tuple(points[-1]), BELT, label, tuple(1.13 * points[len(points) // 2]))


def _drum_brake(panel: Any, brake: DrumBrake) -> None:
    """The drum as a mass, its two shoes at their angles from the y axis."""
    panel.add_patch(_circle((0.0, 0.0), 0.8, **BODY))
    _text(panel, (-0.28, -0.28), "m")
    shoes = ((brake.theta1, "load1", "$N_1$", "$k_3$"), (brake.theta2, "load2", "$N_2$", "$k_4$"))
    for theta, number, load, name in shoes:
        out = np.array([np.sin(theta), np.cos(theta)])
        _line(panel, (0.0, 0.0), tuple(0.8 * out), linewidth=0.5, linestyle=(0, (4, 2)))
        _spring(panel, tuple(0.82 * out), tuple(1.5 * out), name)
        across = np.array([out[1], -out[0]])
        _line(panel, *(tuple(1.5 * out + s * 0.3 * across) for s in (-1.0, 1.0)), linewidth=4.0, color="#7a8a99")
        _arrow(panel, tuple(2.05 * out), tuple(1.56 * out), LOAD, load, tuple(2.2 * out), size_of(brake, number))
        begin, end = np.pi / 2, np.pi / 2 - theta
        _arc(panel, (0.0, 0.0), 0.3 if theta == brake.theta1 else 0.52, begin, end, f"{np.rad2deg(theta):.0f}°")
    _line(panel, (0.0, 0.0), (0.0, 1.15), linewidth=0.5)
    _text(panel, (-0.08, 1.1), "y", fontsize=7)
    _spring(panel, (-0.8, 0.0), (-1.5, 0.0), "$k_1$")
    _wall(panel, (-1.5, 0.0), 0.0)
    _spring(panel, (0.0, -0.8), (0.0, -1.5), "$k_2$")
    _wall(panel, (0.0, -1.5), np.pi / 2)
    _turning(panel, 0.95, 250.0, 195.0, "$V_B$", size_of(brake, "sliding_speed"))


def _shoes(panel: Any, brake: DrumBrakeShoes) -> None:
    """The drum with both shoes to scale of its radius, contact points, abutments and actuator."""
    from matplotlib.patches import Wedge

    scale = 1.0 / brake.radius
    panel.add_patch(_circle((0.0, 0.0), 1.12, **BODY))
    panel.add_patch(_circle((0.0, 0.0), 1.0, facecolor="white", edgecolor="black", linewidth=1.0))
    half = np.rad2deg(0.5 * brake.arc)
    for shoe, middle in ((0, 0.0), (1, 180.0)):
        look = {"facecolor": "#c9d3dc", "edgecolor": "black", "linewidth": 0.8}
        panel.add_patch(Wedge((0.0, 0.0), 0.9, middle - half, middle + half, width=0.14, **look))
        panel.add_patch(
            Wedge((0.0, 0.0), 1.0, middle - half, middle + half, width=0.1, facecolor="#e6c9a8", hatch="....")
        )
        for angle in brake.lining_angles(shoe):
            _line(panel, *((r * np.cos(angle), r * np.sin(angle)) for r in (0.88, 1.0)), linewidth=1.2)
        side = 1.0 if shoe == 0 else -1.0
        foot = tuple(scale * brake.abutment_point(shoe))
        edge = np.deg2rad(middle - side * half)
        _line(panel, (0.83 * np.cos(edge), 0.83 * np.sin(edge)), foot, linewidth=2.0, color="#7a8a99")
        panel.plot(*foot, "o", color="black", markersize=5)
        top = scale * brake.arm
        edge = np.deg2rad(middle + side * half)
        _line(panel, (0.83 * np.cos(edge), 0.83 * np.sin(edge)), (side * 0.42, top), linewidth=2.0, color="#7a8a99")
        _arrow(
            panel, (side * 0.05, top), (side * 0.42, top), LOAD, "F", (side * 0.2, top + 0.1), size_of(brake, "load")
        )
        _text(panel, (side * 0.55, -0.3), f"shoe {shoe + 1}", fontsize=7)
    _text(panel, (0.0, scale * -brake.arm - 0.13), "abutments", fontsize=7)
    _turning(panel, 1.22, 60.0, 120.0, "V", size_of(brake, "sliding_speed"))
    _text(panel, (0.0, 0.02), f"R = {1e3 * brake.radius:.0f} mm\n{2 * brake.points} contact points", fontsize=7)


DRAWINGS: dict[type[Design], Callable[[Any, Any], None]] = {
    DrumBrake: _drum_brake,
    DrumBrakeShoes: _shoes,
    MassOnBelt: _mass_on_belt,
    BlockChain: _block_chain,
    ModeCoupling: _mode_coupling,
    InclinedSprings: _inclined,
    DampingParadox: _paradox,
    PadOnDisc: _pad_on_disc,
    WobblingDisc: _wobbling,
    SpragSlip: _sprag,
}
