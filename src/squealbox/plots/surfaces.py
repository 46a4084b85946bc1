"""A finite-element brake in 3-D on paper: a mode with its size in colour, and how its contacts press.

The farthest faces are drawn first, and those turned away not at all; the outline of the brake at rest lies over them.
"""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.plots.style import WIDTH, drawing, figure_of
from squealbox.shapes import Surface
from squealbox.words import quantity_label

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squealbox.fe import Preload

REACH = 0.09  # of its size: the largest movement, as in the workbench
VIEWS = {"": (0.6, 0.85), "along the axis": (0.0, 0.0)}  # rad: turned about the axis, and tilted
COLOURS = "cividis"
EDGE = 0.5  # rad by which faces are turned to each other at an edge of the outline
FLAT = 0.05  # of their width: how far contact points lie out of a plane


def mode_on_surface(surface: Surface, moved: np.ndarray, *, title: str = "") -> "Figure":
    """A mode at the instant of its largest motion, seen from two sides.

    Parameters
    ----------
    surface : of the brake
    moved : complex displacement (k, 3) of its nodes, as `Surface.moved` gives it
    """
    from matplotlib.collections import LineCollection, PolyCollection
    from matplotlib.colors import Normalize

    places, shares = surface.places - surface.middle, surface.shares(moved)
    bent = places + REACH * surface.size * np.real(moved)
    edges = outline(surface)
    count = len(places)
    with drawing(None, columns=2, width=WIDTH, height=3.1) as panels:
        for panel, (name, (turn, tilt)) in zip(panels, VIEWS.items(), strict=True):
            seen, rest = 1e3 * from_side(bent, turn, tilt), 1e3 * from_side(places, turn, tilt)
            order = _in_order(seen, surface)
            if surface.lone:
                at = surface.faces[order, 0]
                drawn = panel.scatter(*seen[at, :2].T, c=shares[order], s=6.0, cmap=COLOURS, vmin=0.0, vmax=1.0)
            else:
                look: dict[str, Any] = {"cmap": COLOURS, "edgecolors": "face", "linewidths": 0.2}
                drawn = PolyCollection(
                    seen[surface.faces[order], :2], array=shares[order], norm=Normalize(0, 1), **look
                )
                panel.add_collection(drawn)
                front = surface.faces[_in_order(rest, surface)]
                sides = np.sort(np.stack([front, np.roll(front, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
                near = edges[np.isin(edges @ [count, 1], sides @ [count, 1])]
                panel.add_collection(LineCollection(rest[near, :2], colors="#444444", linewidths=0.4))
            panel.set(xlim=_ends(seen[:, 0], rest[:, 0]), ylim=_ends(seen[:, 1], rest[:, 1]), title=name or title)
            panel.set_aspect("equal")
            panel.set_axis_off()
        whole = figure_of(panels[0])
        whole.colorbar(drawn, ax=list(panels), pad=0.02, fraction=0.03).set_label("motion, share of the largest")
        return whole


def from_side(places: ArrayLike, turn: float, tilt: float) -> Any:
    """Places (k, 3) as to the right, up and towards the reader, turned about z and tilted [rad]."""
    x, y, z = np.asarray(places).T
    back = np.sin(turn) * x + np.cos(turn) * y
    right = np.cos(turn) * x - np.sin(turn) * y
    return np.stack([right, np.cos(tilt) * back + np.sin(tilt) * z, np.cos(tilt) * z - np.sin(tilt) * back], axis=-1)


def outline(surface: Surface) -> Any:
    """Pairs of nodes (e, 2) between which faces meet at an angle; twice where a ring begins and ends there."""
    if surface.lone:
        return np.zeros((0, 2), dtype=int)
    part = np.zeros(len(surface.places))
    part[surface.faces] = surface.parts[:, None]
    places = np.column_stack([part, np.round(surface.places / surface.size, 6)])
    same = np.unique(places, axis=0, return_inverse=True)[1].ravel()  # where a ring begins, two nodes have one place
    corners = surface.places[surface.faces]
    normal = np.cross(corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1])
    normal /= np.linalg.norm(normal, axis=1, keepdims=True)
    pairs = np.sort(np.stack([surface.faces, np.roll(surface.faces, -1, axis=1)], axis=-1).reshape(-1, 2), axis=1)
    edges, which = np.unique(np.sort(same[pairs], axis=1), axis=0, return_inverse=True)
    sums = np.zeros((len(edges), 3))
    np.add.at(sums, which.ravel(), np.repeat(normal, 4, axis=0))
    sharp = np.linalg.norm(sums, axis=1) < 2.0 * np.cos(0.5 * EDGE)  # of two unit vectors the sum says the angle
    return np.unique(pairs[sharp[which.ravel()]], axis=0)


def contact_pressure(preload: "Preload", names: tuple[str, ...], *, title: str = "") -> "Figure":
    """The pressure [MPa] at each contact point of both linings, circles where one has lifted off.

    preload is a `Preload`; places are along x and y, of a drum along its circumference and its axis.
    """
    sides = np.unique(preload.side)
    pressure = 1e-6 * preload.pressure
    radius, angle = np.hypot(preload.place[0], preload.place[1]), np.arctan2(preload.place[1], preload.place[0])
    flat = np.ptp(preload.place[2]) < FLAT * np.ptp(preload.place[0]) or len(np.unique(np.round(radius, 4))) > 1
    with drawing(None, columns=len(sides), width=WIDTH, height=2.4) as found:
        panels = np.atleast_1d(np.asarray(found, dtype=object))
        for panel, side in zip(panels, sides, strict=True):
            mine = preload.side == side
            if flat:
                x, y, labels = 1e3 * preload.place[0], 1e3 * preload.place[1], ("x [mm]", "y [mm]")
            else:
                middle = np.angle(np.mean(np.exp(1j * angle[mine])))
                x = 1e3 * radius * np.angle(np.exp(1j * (angle - middle)))
                y, labels = 1e3 * preload.place[2], ("along the circumference [mm]", "z [mm]")
            up = preload.lifted & mine
            panel.plot(x[up], y[up], "o", markersize=2.5, markeredgewidth=0.5, markerfacecolor="none", color="#888888")
            on = mine & ~preload.lifted
            dots = panel.scatter(x[on], y[on], c=pressure[on], s=14.0, marker="s", cmap=COLOURS, vmin=0.0,
                                 vmax=float(np.max(pressure)))  # fmt: skip
            share = 100.0 * float(np.sum(preload.area[up]) / np.sum(preload.area[mine]))
            panel.set(xlabel=labels[0], ylabel=labels[1], title=f"{names[int(side)]}: {share:.0f} % lifted off")
            if flat:
                panel.set_aspect("equal", adjustable="datalim")
        whole = figure_of(panels[0])
        whole.colorbar(dots, ax=list(panels), pad=0.02).set_label(quantity_label("pressure", "MPa"))
        return whole


def largest_motion(surface: Surface, moved: np.ndarray) -> str:
    """How the parts share a mode's motion, of nodes (k, 3), and what is drawn of the surface."""
    size = np.linalg.norm(np.abs(moved), axis=1)
    nodes = [np.unique(surface.faces[surface.parts == i]) for i in range(len(surface.names))]
    shares = [float(np.max(size[each])) / float(np.max(size)) for each in nodes]
    said = ", ".join(f"{name} {100.0 * share:.0f} %" for name, share in zip(surface.names, shares, strict=True))
    what = "node of the files, which name no elements" if surface.lone else "line of the mesh"
    each = f"every {what}" if surface.step == 1 else f"one {what} in {surface.step}"
    drawn = f"{len(surface.faces)} {'points' if surface.lone else 'faces'}"
    return f"Largest motion: {said} of it. Drawn: {each}, {drawn}."


def _in_order(seen: np.ndarray, surface: Surface) -> Any:
    """Faces turned to the reader, the farthest first."""
    corners = seen[surface.faces]
    far = np.argsort(np.mean(corners[..., 2], axis=1), kind="stable")
    if surface.lone:
        return far
    one, two = corners[:, 2] - corners[:, 0], corners[:, 3] - corners[:, 1]
    return far[(one[:, 0] * two[:, 1] - one[:, 1] * two[:, 0])[far] > 0.0]


def _ends(*values: Any) -> tuple[float, float]:
    low, high = min(float(np.min(each)) for each in values), max(float(np.max(each)) for each in values)
    room = 0.02 * (high - low)
    return low - room, high + room
