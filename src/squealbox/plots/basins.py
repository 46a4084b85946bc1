"""Pictures of basins: which starts of a plane lead to which attractor, and the shares of a box with their intervals."""

from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.limit_cycles import CYCLE, REST, SLIDING, Basin, DangerousPush, place, state_names
from squealbox.matrices import liveliest
from squealbox.plots.dispatch import drawn_by
from squealbox.plots.style import drawing, figure_of
from squealbox.words import number, quantity_label, scaled, unit_at

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

# Fill, hatch and line of the attractors beside steady sliding, which stays white; readable in grey.
LOOKS = (
    ("#fbd9b5", "////", "#D55E00"),
    ("#bcd7ee", "....", "#0072B2"),
    ("#d5c3e0", "xxxx", "#882255"),
    ("#bfe3d0", "\\\\\\\\", "#009E73"),
    ("#eeeeaa", "++++", "#777700"),
)
UNKNOWN = ("#999999", "")
FAR = 6.0  # widths of the box of starts beyond which an orbit is left out of the picture
SHORT = {"irregular": "irregular motion"}


@drawn_by.register(Basin)
def basin_picture(
    basin: Basin, *, push: DangerousPush | None = None, title: str = "", axes: "Axes | None" = None
) -> "Figure":  # fmt: skip
    """Starts of a plane by what they lead to, with steady sliding and the cycles drawn in; without a plane, the shares.

    Parameters
    ----------
    basin : with a `plane`, a picture at t = 0: the shade is that of the attractor a start leads to, the cross steady
        sliding, and each line a whole cycle seen along the other states (it need not cross the plane); without one,
        a bar for each attractor with its interval of 95 %
    push : the smallest dangerous push, drawn as an arrow, seen along the other states
    axes : draw here instead of in a new figure
    """
    if not basin.plane:
        return _shares(basin, title, axes)
    from matplotlib.patches import Rectangle

    x, y = (_axis(basin, name) for name in basin.plane)
    with drawing(axes, width=6.0, height=3.4) as panel:
        _ground(panel, basin, x, y)
        _cycles(panel, basin, x, y)
        panel.plot(*_seen(basin.rest, x, y), "+", color="#000000", markersize=9, markeredgewidth=1.4, zorder=5)
        if push is not None and push.outcome.ok:
            ends = (_seen(state, x, y) for state in (basin.rest + push.push, basin.rest))
            look = {"arrowstyle": "-|>", "color": "#000000", "shrinkA": 0, "shrinkB": 0}
            panel.annotate("", *ends, arrowprops=look, zorder=6)
        panel.set(xlabel=x.label, ylabel=y.label, title=title, xlim=_reach(basin, x), ylim=_reach(basin, y))
        if (panel.get_xlim(), panel.get_ylim()) != (x.ends, y.ends):
            corner, size = (x.ends[0], y.ends[0]), (x.ends[1] - x.ends[0], y.ends[1] - y.ends[0])
            panel.add_patch(Rectangle(corner, *size, fill=False, edgecolor="#000000", linewidth=0.7, linestyle=":"))
            panel.set_facecolor("#ebebeb")
            panel.add_patch(Rectangle(corner, *size, facecolor="white", zorder=0.5))
        panel.legend(handles=_handles(basin, push), loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0,
                     handlelength=2.0, title=_through(basin), title_fontsize=7, alignment="left")  # fmt: skip
        return figure_of(panel)


class _axis:
    """A state of a plane: its place, what its values are divided by, its label and its ends."""

    def __init__(self, basin: Basin, name: str) -> None:
        self.place = place(state_names(basin.system), name)
        moves = self.place >= len(basin.rest) // 2
        values = basin.start[:, self.place]
        self.factor, unit = scaled(unit_at(basin.system, self.place % (len(basin.rest) // 2), moves=moves), values)
        self.label = quantity_label(f"{name} at t = 0", unit)
        self.ends = (float(np.min(values)) / self.factor, float(np.max(values)) / self.factor)


def _reach(basin: Basin, axis: _axis) -> tuple[float, float]:
    """The ends of the box of starts, or as far as the orbits of the cycles reach, up to `FAR` times its width."""
    low, high = axis.ends
    width = high - low
    for i in _moving(basin):
        cycle = basin.attractors[i].cycle if basin.attractors else None
        if cycle is not None and cycle.outcome.ok:
            along = np.hstack([cycle.q, cycle.qd])[:, axis.place] / axis.factor
            low, high = min(low, 1.05 * float(np.min(along))), max(high, 1.05 * float(np.max(along)))
    within = high - low <= FAR * width
    return (low, high) if within else axis.ends


def _seen(states: np.ndarray, x: _axis, y: _axis) -> tuple[Any, Any]:
    """States (..., 2n) in the plane."""
    return states[..., x.place] / x.factor, states[..., y.place] / y.factor


def _moving(basin: Basin) -> list[int]:
    """The attractors but steady sliding that have a look of their own, by their share."""
    order = [int(i) for i in np.argsort(-basin.shares, kind="stable") if basin.kind[i] != SLIDING]
    return order[: len(LOOKS)]


def _others(basin: Basin) -> list[int]:
    """Those without a look: drawn grey, together."""
    shown = _moving(basin)
    return [i for i, kind in enumerate(basin.kind) if kind != SLIDING and i not in shown]


def _ground(panel: "Axes", basin: Basin, x: _axis, y: _axis) -> None:
    side = round(np.sqrt(len(basin.attractor)))
    label = basin.attractor.reshape(side, side)
    across, up = (np.linspace(*axis.ends, side) for axis in (x, y))
    rows = [([i], *LOOKS[k][:2]) for k, i in enumerate(_moving(basin))]
    for these, colour, hatch in [*rows, ([-1, -2, *_others(basin)], *UNKNOWN)]:
        here = np.isin(label, these).astype(float)
        if not np.any(here):
            continue
        panel.contourf(across, up, here, levels=[0.5, 1.5], colors=[colour], hatches=[hatch or None], zorder=1)
        panel.contour(across, up, here, levels=[0.5], colors=["#555555"], linewidths=0.4, zorder=2)


def _cycles(panel: "Axes", basin: Basin, x: _axis, y: _axis) -> None:
    for k, i in enumerate(_moving(basin)):
        cycle = basin.attractors[i].cycle if basin.attractors else None
        if cycle is None or not cycle.outcome.ok:
            continue
        states = np.hstack([cycle.q, cycle.qd])
        panel.plot(*_seen(states, x, y), color=LOOKS[k][2], linewidth=1.6, zorder=4)


def _handles(basin: Basin, push: DangerousPush | None) -> list[Any]:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    edge: dict[str, Any] = {"edgecolor": "#555555", "linewidth": 0.5}
    share = dict(zip(range(len(basin.kind)), basin.shares, strict=True))
    still = [i for i, kind in enumerate(basin.kind) if kind == SLIDING]
    handles: list[Any] = [
        Patch(facecolor="white", label=f"steady sliding, {number(100 * share[i], 3)} %", **edge) for i in still
    ]
    for k, i in enumerate(_moving(basin)):
        colour, hatch, own = LOOKS[k]
        handles.append(Patch(facecolor=colour, hatch=hatch, label=f"{_named(basin, i)}, {number(100 * share[i], 3)} %",
                             **edge))  # fmt: skip
        if basin.attractors and basin.attractors[i].kind == CYCLE:
            handles.append(Line2D([], [], color=own, linewidth=1.6, label="  its orbit, projected"))
    others = _others(basin)
    if others:
        told = f"{len(others)} others, {number(100 * float(np.sum(basin.shares[others])), 3)} %"
        handles.append(Patch(facecolor=UNKNOWN[0], label=told, **edge))
    if np.any(basin.attractor < 0):
        handles.append(Patch(facecolor=UNKNOWN[0], label="run failed", **edge))
    handles.append(Line2D([], [], color="#000000", marker="+", markersize=7, linestyle="none", label="steady sliding"))
    if push is not None and push.outcome.ok:
        handles.append(Line2D([], [], color="#000000", marker=">", markersize=4, label="smallest push, projected"))
    return handles


def _named(basin: Basin, i: int) -> str:
    """An attractor in few words: kind and largest amplitude."""
    kind = str(basin.kind[i])
    if kind in (SLIDING, REST):
        return kind
    sizes = 0.5 * (basin.highest[i] - basin.lowest[i])
    dof = liveliest(sizes, basin.system.units)
    size = float(sizes[dof])
    factor, unit = scaled(unit_at(basin.system, dof), size)
    return f"{SHORT.get(kind, kind)} of {number(size / factor, 3)} {unit}"


def _through(basin: Basin) -> str:
    """Which plane it is."""
    if np.array_equal(basin.through, basin.rest):
        return "plane through steady sliding"
    names, half = state_names(basin.system), len(basin.rest) // 2
    fixed = [i for i, name in enumerate(names) if name not in basin.plane]
    words = []
    for i in fixed:
        factor, unit = scaled(unit_at(basin.system, i % half, moves=i >= half), basin.through[i])
        words.append(f"{names[i]} = {number(basin.through[i] / factor, 3)} {unit}")
    return "plane at " + ", ".join(words)


def _shares(basin: Basin, title: str, axes: "Axes | None") -> "Figure":
    """A bar for each attractor, with its interval."""
    with drawing(axes, width=5.0, height=0.9 + 0.35 * max(len(basin.kind), 1)) as panel:
        shares, (low, high) = 100.0 * basin.shares, 100.0 * basin.intervals.T
        at = np.arange(len(shares))
        order = {i: k for k, i in enumerate(_moving(basin))}
        for i in range(len(shares)):
            colour, hatch, _ = LOOKS[order[i]] if i in order else ("white", "", "")
            panel.barh(i, shares[i], height=0.6, color=colour, hatch=hatch, edgecolor="#555555", linewidth=0.6)
        spans = np.maximum([shares - low, high - shares], 0.0)
        panel.errorbar(shares, at, xerr=spans, fmt="none", ecolor="#000000", capsize=3.0, linewidth=1.0)
        panel.set_yticks(at, [_named(basin, int(i)) for i in at])
        panel.set(xlabel=f"share of {len(basin.attractor)} starts, with 95 % interval [%]", xlim=(0.0, 100.0),
                  title=title)  # fmt: skip
        panel.invert_yaxis()
        panel.tick_params(axis="y", length=0.0)
        return figure_of(panel)
