"""Fig. 1, the model to scale from the design's parameters, and Fig. 2, the friction law."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox import plots
from squealbox.designs import DrumBrake
from squealbox.papers.drum_brake_2011.cases import Case
from squealbox.papers.drum_brake_2011.figures import Margins
from squealbox.plots import drawing, figure_of
from squealbox.words import number

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

INK, BLUE, RED = "#000000", "#0072B2", "#D55E00"
DRUM = 1.0  # radius drawn
GROUND = 2.3  # distance of the walls drawn


def model(case: Case) -> "Figure":
    """Fig. 1: the drum on its springs and dampers and the two belts at their centres of pressure, angles to scale."""
    from matplotlib.patches import Circle

    brake = case.design()
    with drawing(Margins(0.02, 0.02, 0.02, 0.02).panel(5.2, 4.6)) as axes:
        axes.add_patch(Circle((0.0, 0.0), DRUM, facecolor="#efefef", edgecolor=INK, linewidth=1.0))
        axes.text(-0.5, -0.15, f"m = {brake.m:g} kg", ha="center", va="center")
        _supports(axes, brake)
        for i, (theta, stiffness) in enumerate(((brake.theta1, brake.k3), (brake.theta2, brake.k4)), start=1):
            _shoe(axes, i, float(theta), float(stiffness), float(brake.sliding_speed))
        _axes_cross(axes)
        axes.set(xlim=(-2.9, 2.9), ylim=(-2.55, 2.75), aspect="equal")
        axes.axis("off")
        return figure_of(axes)


def friction(case: Case) -> "Figure":
    """Fig. 2: the friction coefficient over sliding speed for three coefficients at rest."""
    laws = {f"$\\mu_0$ = {mu:.2f}": case.design(mu=mu).friction for mu in (0.10, 0.30, 0.50)}
    with drawing(Margins(bottom=0.4).panel(4.6, 3.0)) as axes:
        plots.friction_curve(laws, upto=1.0, axes=axes)
        axes.axvline(
            case.speed, color="#808080", linewidth=0.6, label=f"sliding speed of the table, {case.speed:g} m/s"
        )
        axes.set_ylim(0.0, 0.75)
        axes.set_title(f"slope {number(-case.alpha)} s/m, an assumption")
        axes.legend(loc="upper right", ncols=2)
        return figure_of(axes)


def _supports(axes: "Axes", brake: DrumBrake) -> None:
    """k1 and c1 to the left, k2 and c2 below."""
    for offset, kind, name in (
        (0.32, _spring, f"$k_1$ = {brake.k1 / 1e6:g} N/µm"),
        (-0.32, _damper, f"$c_1$ = {brake.c1:g} N s/m"),
    ):
        root = -np.sqrt(DRUM**2 - offset**2)
        kind(axes, (root, offset), (-GROUND, offset))
        axes.text(-1.65, offset + (0.2 if offset > 0 else -0.25), name, ha="center", va="center", fontsize=7)
    for offset, kind, name in (
        (-0.32, _spring, f"$k_2$ = {brake.k2 / 1e6:g} N/µm"),
        (0.32, _damper, f"$c_2$ = {brake.c2:g} N s/m"),
    ):
        root = -np.sqrt(DRUM**2 - offset**2)
        kind(axes, (offset, root), (offset, -GROUND))
        side: dict[str, Any] = {"ha": "right" if offset < 0 else "left", "va": "center", "fontsize": 7}
        axes.text(offset + (-0.2 if offset < 0 else 0.2), -1.75, name, **side)
    _wall(axes, (-GROUND, 0.0), (0.0, 1.0))
    _wall(axes, (0.0, -GROUND), (1.0, 0.0))


def _shoe(axes: Any, which: int, theta: float, stiffness: float, speed: float) -> None:
    """The contact spring along e = (sin, cos), and the belt running along tau = (cos, -sin)."""
    line, along = np.array([np.sin(theta), np.cos(theta)]), np.array([np.cos(theta), -np.sin(theta)])
    touch, belt = DRUM * line, (DRUM + 0.75) * line
    _spring(axes, touch, belt)
    axes.plot(
        *np.stack([belt - 0.55 * along, belt + 0.55 * along]).T, color=BLUE, linewidth=3.0, solid_capstyle="round"
    )
    arrow = {"arrowstyle": "-|>", "color": BLUE, "shrinkA": 0.0, "shrinkB": 0.0}
    above = belt + 0.14 * line
    axes.annotate("", above + 0.55 * along, above - 0.1 * along, arrowprops=arrow)
    axes.text(*(above + 0.72 * along), "$V_B$", color=BLUE, ha="center", va="center")
    push = {"arrowstyle": "-|>", "color": RED, "shrinkA": 0.0, "shrinkB": 0.0}
    axes.annotate("", belt + 0.08 * line - 0.3 * along, belt + 0.6 * line - 0.3 * along, arrowprops=push)
    axes.text(*(belt + 0.72 * line - 0.3 * along), f"$N_{which}$", color=RED, ha="center", va="center")
    axes.plot(*np.stack([np.zeros(2), touch]).T, color="#808080", linewidth=0.6, linestyle=(0, (4, 3)))
    sweep = np.linspace(0.0, theta, 40)
    radius = 0.42 + 0.16 * (which - 1)
    axes.plot(radius * np.sin(sweep), radius * np.cos(sweep), color="#808080", linewidth=0.6)
    middle = 0.5 * theta if which == 1 else 0.78 * theta
    axes.text(
        (radius + 0.13) * np.sin(middle),
        (radius + 0.13) * np.cos(middle),
        rf"$\theta_{which}$",
        ha="center",
        va="center",
    )
    name = f"shoe {which}: θ = {np.rad2deg(theta):g}°\n$k_{which + 2}$ = {stiffness / 1e6:g} N/µm"
    axes.text(*(belt - 0.75 * along), name, fontsize=7, ha="right" if which == 1 else "left", va="bottom")


def _axes_cross(axes: Any) -> None:
    arrow = {"arrowstyle": "-|>", "color": INK, "shrinkA": 0.0, "shrinkB": 0.0}
    origin = np.array([-2.55, 1.75])
    for end, name in (((0.6, 0.0), "x"), ((0.0, 0.6), "y")):
        axes.annotate("", origin + end, origin, arrowprops=arrow)
        axes.text(*(origin + 1.2 * np.array(end)), name, ha="center", va="center")
    axes.text(*(origin - (0.0, 0.2)), "angles from the y-axis, clockwise", fontsize=6.5, va="center")


def _spring(axes: "Axes", start: ArrayLike, end: ArrayLike) -> None:
    """A zigzag between two points."""
    share = np.concatenate([[0.0], np.linspace(0.2, 0.8, 13), [1.0]])
    aside = np.concatenate([[0.0, 0.0], np.resize([0.09, -0.09], 11), [0.0, 0.0]])
    axes.plot(*_along(start, end, share, aside).T, color=INK, linewidth=0.9)


def _damper(axes: "Axes", start: ArrayLike, end: ArrayLike) -> None:
    """A pot and a piston between two points."""
    for share, aside in (
        ([0.0, 0.45], [0.0, 0.0]),
        ([0.45, 0.45], [-0.09, 0.09]),
        ([0.35, 0.62, 0.62, 0.35], [0.12, 0.12, -0.12, -0.12]),
        ([0.62, 1.0], [0.0, 0.0]),
    ):
        axes.plot(*_along(start, end, np.array(share), np.array(aside)).T, color=INK, linewidth=0.9)


def _along(start: ArrayLike, end: ArrayLike, share: np.ndarray, aside: np.ndarray) -> Any:
    start, end = np.asarray(start, dtype=float), np.asarray(end, dtype=float)
    line = end - start
    across = np.array([-line[1], line[0]]) / np.linalg.norm(line)
    return start + share[:, None] * line + aside[:, None] * across


def _wall(axes: "Axes", middle: ArrayLike, along: ArrayLike) -> None:
    middle, along = np.asarray(middle), np.asarray(along)
    outwards = middle / np.linalg.norm(middle)
    ends = np.stack([middle - 0.6 * along, middle + 0.6 * along])
    axes.plot(*ends.T, color=INK, linewidth=1.2)
    for s in np.linspace(-0.55, 0.55, 9):
        foot = middle + s * along
        axes.plot(*np.stack([foot, foot + 0.12 * outwards - 0.1 * along]).T, color=INK, linewidth=0.5)
