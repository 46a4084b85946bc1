"""Figures of optimised designs: the Pareto front, and how far each parameter moved within its bounds."""

from collections.abc import Mapping
from textwrap import wrap
from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.plots.dispatch import drawn_by
from squealbox.plots.style import COLUMN, LINES, WIDTH, drawing, figure_of, line
from squealbox.studies import Optimum
from squealbox.words import number, quantity_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squealbox.plots.style import Panels

WRAPPED = 42  # characters of a line of an axis label
BEFORE, AFTER = "#888888", "#D55E00"
HOLE = 0.15  # of the range of a goal: a wider gap in the front is said


@drawn_by.register(Optimum)
def optimum(found: Optimum, *, title: str = "", axes: "Panels | None" = None) -> "Figure":
    """One goal: each parameter within its bounds, before and after. Two: the Pareto front and its parameters.

    With three goals or more the front is drawn as a line for each design over the goals, each scaled by its range.
    `axes` is one panel, for the front (or the parameters, with one goal).
    """
    count = len(found.settings["goals"])
    first = _moves if count == 1 else _front if count == 2 else _parallel
    if axes is not None or count == 1:
        height = 1.2 + 0.3 * len(found.names)
        with drawing(axes, width=1.4 * COLUMN, height=height) as panel:
            first(panel, found, title)
            return figure_of(panel)
    with drawing(None, 1, 2, width=WIDTH, height=max(2.9, 1.1 + 0.28 * len(found.names))) as (left, right):
        first(left, found, title)
        _along(right, found)
        return figure_of(left)


def _label(about: Mapping[str, Any]) -> str:
    return quantity_label(f"{about['name']}", about["unit"])


def _front(panel: "Axes", found: Optimum, title: str) -> None:
    """Every design of the front over its two goals, with the design before and the compromise."""
    x, y = found.goals.T
    panel.plot(x, y, ".", color="#0072B2", markersize=4, label=f"{len(x)} designs of the front")
    panel.plot(x[found.best], y[found.best], "o", color=AFTER, markersize=6, label="compromise")
    if np.all(np.isfinite(found.goals_before)):
        panel.plot(*found.goals_before, "s", color=BEFORE, markersize=6, label="before")
    across = np.sort(x)
    if x.size > 2 and np.max(np.diff(across)) > HOLE * np.ptp(across):
        panel.plot([], [], " ", label="gaps: nothing better was found there")
    panel.legend(loc="best")
    words = ["\n".join(wrap(f"{_label(about)}, {about['sense']}", WRAPPED)) for about in found.settings["goals"]]
    panel.set(xlabel=words[0], ylabel=words[1], title=title)


def _along(panel: "Axes", found: Optimum) -> None:
    """The varied parameters over the first goal, as places within their bounds."""
    box = np.asarray(found.settings["box"])
    share = (found.values - box[:, 0]) / np.ptp(box, axis=1)
    order = np.argsort(found.goals[:, 0])
    for i, name in enumerate(found.names):
        low, high = box[i]
        label = f"{name}: {number(low)} to {number(high)}"
        panel.plot(found.goals[order, 0], share[order, i], **line(i, marker=True, count=len(order)), label=label)
    panel.axvline(found.goals[found.best, 0], color=AFTER, linewidth=0.8)
    panel.set_ylim(-0.04, 1.04 + 0.14 * len(found.names))
    panel.set_yticks(np.linspace(0.0, 1.0, 6))
    panel.legend(loc="upper center", fontsize=6)
    panel.set(xlabel=_label(found.settings["goals"][0]), ylabel="place within the bounds")


def _parallel(panel: "Axes", found: Optimum, title: str) -> None:
    """A line for each design over the goals, 0 the best and 1 the worst of the front."""
    factor = np.array([1.0 if about["sense"] == "minimise" else -1.0 for about in found.settings["goals"]])
    costs = found.goals * factor
    width = np.ptp(costs, axis=0)
    scaled = (costs - np.min(costs, axis=0)) / np.where(width > 0.0, width, 1.0)
    places = np.arange(costs.shape[1])
    for row in scaled:
        panel.plot(places, row, color="#0072B2", linewidth=0.4, alpha=0.5)
    panel.plot(places, scaled[found.best], color=AFTER, linewidth=1.6, label="compromise")
    panel.set_xticks(places, ["\n".join(wrap(about["name"], 18)) for about in found.settings["goals"]])
    panel.set(ylabel="0 best, 1 worst of the front", title=title)
    panel.legend(loc="best")


def _moves(panel: "Axes", found: Optimum, title: str) -> None:
    """Each parameter within its bounds, before and after."""
    box = np.asarray(found.settings["box"])
    places = np.arange(len(found.names))
    share = (np.stack([found.before, found.values[found.best]]) - box[:, 0]) / np.ptp(box, axis=1)
    panel.hlines(places, 0.0, 1.0, color="#bbbbbb", linewidth=0.8, zorder=0)
    for place, (start, end) in enumerate(share.T):
        if np.isfinite(start):
            panel.annotate("", (end, place), (start, place), arrowprops={"arrowstyle": "->", "color": LINES[0][0]})
        after = number(found.values[found.best, place])
        panel.annotate(after, (end, place), (0, 6), textcoords="offset points", ha="center", fontsize=6.5)
    if np.any(np.isfinite(found.before)):
        panel.plot(share[0], places, "s", color=BEFORE, markersize=5, label="before", clip_on=False)
    panel.plot(share[1], places, "o", color=AFTER, markersize=6, label="after", clip_on=False)
    panel.set_yticks(places, [f"{n}: {number(a)} to {number(b)}" for n, (a, b) in zip(found.names, box, strict=True)])
    panel.set(xlim=(-0.04, 1.04), ylim=(len(found.names) - 0.5, -0.75), xlabel="place within the bounds")
    about = found.settings["goals"][0]
    old, new = (number(float(value)) for value in (found.goals_before[0], found.goals[found.best, 0]))
    arrow = f"{old} \N{RIGHTWARDS ARROW} {new}" if np.isfinite(found.goals_before[0]) else new
    text = f"{about['name']}: {arrow} {about['unit']}".rstrip()
    panel.set_title(f"{title}\n{text}" if title else text)
    panel.legend(loc="upper left", bbox_to_anchor=(1.0, 1.0))
