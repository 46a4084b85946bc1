"""Figures of rare squeal and of surrogates: the way to the design point, levels of a simulation, held-out points."""

from typing import TYPE_CHECKING

import numpy as np

from squealbox.plots.dispatch import drawn_by
from squealbox.plots.style import COLUMN, WIDTH, drawing, figure_of, line
from squealbox.plots.uncertainty import QUIET, SQUEAL
from squealbox.studies import DesignPoint, SubsetProbability, Surrogate
from squealbox.words import number, quantity_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squealbox.plots.style import Panels


@drawn_by.register(DesignPoint)
def design_point(found: DesignPoint, *, title: str = "", axes: "Panels | None" = None) -> "Figure":
    """The quantity on the straight way from the median to the design point and beyond; importance of the parameters.

    `axes` is one panel, for the way alone.
    """
    if axes is not None:
        with drawing(axes) as panel:
            _way(panel, found, title)
            return figure_of(panel)
    height = max(2.5, 0.9 + 0.25 * len(found.names))
    with drawing(None, 1, 2, width=WIDTH, height=height) as (left, right):
        _way(left, found, title)
        order = np.argsort(-found.importance)
        places = np.arange(order.size)
        bars = right.barh(places, 100.0 * found.importance[order], color=QUIET, edgecolor="#000000", linewidth=0.4)
        moved = [f"{found.normal_point[i]:+.2f} sd".replace("-", "\N{MINUS SIGN}") for i in order]
        right.bar_label(bars, labels=moved, padding=3, fontsize=6.5)
        right.set_yticks(places, [found.names[i] for i in order])
        right.invert_yaxis()
        right.set_xlim(0.0, 118.0)
        right.set_xlabel("importance [%], and where it squeals")
        return figure_of(left)


def _way(panel: "Axes", found: DesignPoint, title: str) -> None:
    about = found.settings["quantity"]
    panel.plot(found.distance, found.values, **line(0))
    panel.axhline(about["limit"], color="#000000", linewidth=0.8, linestyle="--")
    low, high = panel.get_ylim()
    squeal = (about["limit"], high) if about["squeals"] == "above" else (low, about["limit"])
    panel.axhspan(*squeal, facecolor=SQUEAL, alpha=0.35, edgecolor="none", label="squeal")
    panel.set_ylim(low, high)
    panel.set_xlim(0.0, float(found.distance[-1]))
    if np.isfinite(found.beta):
        label = f"design point, β = {number(float(found.beta), 4)}"
        panel.plot(abs(float(found.beta)), about["limit"], "o", color="#D55E00", label=label)
        text = f"P(squeal) = {_small(found.sampled)} ({_small(found.low)} to {_small(found.high)})"
        panel.set_title(f"{title}\n{text}" if title else text)
    panel.legend(loc="best")
    panel.set(
        xlabel="distance from the median [standard deviations]", ylabel=quantity_label(about["name"], about["unit"])
    )


@drawn_by.register(SubsetProbability)
def subset_probability(found: SubsetProbability, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """Probability that the quantity is beyond a value, level by level towards the limit, one line for each run."""
    about = found.settings["quantity"]
    with drawing(axes, width=1.3 * COLUMN, height=2.9) as panel:
        for levels, beyond in zip(np.atleast_2d(found.thresholds), np.atleast_2d(found.exceedance), strict=True):
            known = np.isfinite(levels)
            panel.semilogy(levels[known], beyond[known], **{**line(1), "linestyle": "-", "linewidth": 0.7}, marker=".")
        panel.get_lines()[0].set_label(f"{len(np.atleast_2d(found.thresholds))} runs, level by level")
        panel.axvline(about["limit"], color="#000000", linewidth=0.8, linestyle="--", label="limit of squeal")
        if found.probability > 0.0 and np.isfinite(found.low):
            value = float(found.probability)
            errors = [[value - float(found.low)], [float(found.high) - value]]
            label = f"P(squeal) = {_small(value)}"
            panel.errorbar(
                about["limit"], value, yerr=errors, color="#D55E00", marker="o", capsize=3, linewidth=1.0, label=label
            )
        if panel.get_ylim()[1] < 10.0 * panel.get_ylim()[0]:
            panel.set_yscale("linear")
            panel.set_ylim(bottom=0.0)
        panel.legend(loc="best")
        word = "above" if about["squeals"] == "above" else "below"
        panel.set(
            xlabel=quantity_label(about["name"], about["unit"]), ylabel=f"probability of a value {word}", title=title
        )
        return figure_of(panel)


@drawn_by.register(Surrogate)
def surrogate(found: Surrogate, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """What the surrogate says of points it has not seen, against what was computed; misjudged points stand out."""
    about = found.settings["quantity"]
    with drawing(axes, width=COLUMN, height=3.2) as panel:
        excess = found.quantity.excess
        wrong = (excess(found.values) > 0.0) != (excess(found.held_out) > 0.0)
        panel.plot(found.values[~wrong], found.held_out[~wrong], ".", color="#0072B2", markersize=3)
        if np.any(wrong):
            label = f"squeal misjudged, {100.0 * found.misjudged:.2g} %"
            panel.plot(found.values[wrong], found.held_out[wrong], "x", color="#D55E00", markersize=4, label=label)
            panel.legend(loc="lower right")
        both = np.concatenate([found.values, found.held_out])
        ends = np.array([np.nanmin(both), np.nanmax(both)])
        panel.plot(ends, ends, color="#000000", linewidth=0.6)
        for draw in (panel.axvline, panel.axhline):
            if ends[0] < about["limit"] < ends[1]:
                draw(about["limit"], color="#000000", linewidth=0.6, linestyle="--")
        text = f"Q² = {number(float(found.q2), 4)}, {found.values.size} points"
        panel.set_title(f"{title}\n{text}" if title else text)
        label = quantity_label(about["name"], about["unit"])
        panel.set(xlabel=f"{label}, computed", ylabel=f"{label}, not seen")
        return figure_of(panel)


def _small(value: float) -> str:
    return f"{float(value):.2e}" if 0.0 < abs(float(value)) < 1e-3 else number(float(value), 3)
