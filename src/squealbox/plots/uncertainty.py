"""Figures of studies under scatter: how the answer is spread, and which parameter makes it so."""

import textwrap
from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.family import unit_of
from squealbox.plots.dispatch import drawn_by
from squealbox.plots.style import COLUMN, LINES, WIDTH, drawing, figure_of, line, power_of_ten
from squealbox.studies import IntervalBounds, MorrisEffects, SobolIndices, SquealProbability
from squealbox.words import number, quantity_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squealbox.plots.style import Panels

QUIET, SQUEAL = "#9ecae1", "#f0b27a"
SIGMA = "\N{GREEK SMALL LETTER SIGMA}"
LETTERS = 36  # of a line below an axis in a column of a paper
MOST = 4  # parameters drawn beside the histogram
BINS = 12  # of equal probability, in which the share of squeal is counted


@drawn_by.register(SquealProbability)
def squeal_probability(found: SquealProbability, *, title: str = "", axes: "Panels | None" = None) -> "Figure":
    """How the quantity is spread, with the part that squeals, and the share of squeal over each parameter.

    `axes` is one panel, for the histogram alone; a figure of its own also gets a panel for each of up to four
    parameters, those over which the share of squeal changes most.
    """
    if axes is not None:
        with drawing(axes) as panel:
            _histogram(panel, found, title)
            return figure_of(panel)
    shares = [_shares(found, i) for i in range(len(found.names))]
    order = sorted(range(len(shares)), key=lambda i: -float(np.ptp(shares[i][1])))[:MOST]
    ratios = [1.9, *(1.0 for _ in order)]
    top = min(1.0, 1.2 * max((float(np.max(shares[i][3])) for i in order), default=1.0))
    with drawing(None, 1, 1 + len(order), width=WIDTH, height=2.5, width_ratios=ratios) as panels:
        first, *rest = np.ravel(panels)
        _histogram(first, found, title)
        for place, (panel, i) in enumerate(zip(rest, order, strict=True)):
            middles, share, low, high = shares[i]
            unit = unit_of(found.inputs.get("design"), found.names[i])
            factor, unit = power_of_ten(middles, unit)
            panel.fill_between(middles / factor, low, high, facecolor="#d9d9d9", edgecolor="none")
            panel.plot(middles / factor, share, **line(0), marker="o")
            panel.set_ylim(-0.03 * top, 1.03 * top)
            panel.set_xlabel(quantity_label(found.names[i], unit))
            if place == 0 or panel.get_gridspec().ncols == 1:  # below each other nothing is shared
                panel.set_ylabel("share of squeal, 95 % band")
            else:
                panel.tick_params(labelleft=False)
        return figure_of(first)


def _histogram(panel: "Axes", found: SquealProbability, title: str) -> None:
    about = found.settings["quantity"]
    values = found.values[np.isfinite(found.values)]
    limit = about["limit"]
    if values.size:
        edges = _edges(values, limit)
        inside = np.clip(values, edges[0], edges[-1])
        squeals = values > limit if about["squeals"] == "above" else values < limit
        parts = [inside[~squeals], inside[squeals]]
        weights = [np.full(part.shape, 1.0 / found.values.size) for part in parts]
        panel.hist(
            parts, edges, weights=weights, stacked=True, color=[QUIET, SQUEAL], label=["quiet", "squeal"],
            edgecolor="white", linewidth=0.3,
        )  # fmt: skip
        panel.axvline(limit, color="#000000", linewidth=0.8, linestyle="--")
        panel.legend(loc="upper right", handlelength=1.2)
    low, middle, high = (number(float(value), 3) for value in (found.low, found.probability, found.high))
    text = f"P(squeal) = {middle} ({low} to {high})"
    panel.set(xlabel=quantity_label(about["name"], about["unit"]), ylabel="share of points")
    panel.set_title(f"{title}\n{text}" if title else text)


def _edges(values: np.ndarray, limit: float) -> Any:
    """Edges of the bars, one of them at the limit where it is within the values; far outliers go to the last bar."""
    low, high = np.quantile(values, (0.001, 0.999))
    if low == high:
        low, high = low - 0.5, high + 0.5
    step = (high - low) / 30.0
    if not low < limit < high:
        return np.linspace(low, high, 31)
    below, above = np.ceil((limit - low) / step), np.ceil((high - limit) / step)
    return limit + step * np.arange(-below, above + 1.0)


def _shares(found: SquealProbability, i: int) -> tuple[Any, Any, Any, Any]:
    """Middle, share of squeal and its 95 % interval in bins of equal probability of parameter i."""
    from scipy.stats import binomtest

    x, squeals = found.points[:, i], found.squeals
    groups = np.array_split(np.argsort(x, kind="stable"), min(BINS, max(x.size // 20, 1)))
    rows = []
    for group in groups:
        hits = int(np.count_nonzero(squeals[group]))
        ends = binomtest(hits, group.size).proportion_ci(0.95)
        rows.append((float(np.median(x[group])), hits / group.size, ends.low, ends.high))
    columns = np.array(rows).T
    return columns[0], columns[1], columns[2], columns[3]


@drawn_by.register(SobolIndices)
def sobol_indices(found: SobolIndices, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """First-order and total index of each parameter as bars with their intervals, the strongest first."""
    order = np.argsort(-found.total)
    places = np.arange(order.size)
    with drawing(axes, width=1.3 * COLUMN, height=0.9 + 0.42 * order.size) as panel:
        for shift, name, label, colour, hatch in (
            (-0.19, "first", "first order", QUIET, ""),
            (0.19, "total", "total, with interactions", SQUEAL, "////"),
        ):
            value, low, high = (getattr(found, name + end)[order] for end in ("", "_low", "_high"))
            errors = np.abs(np.stack([value - low, high - value]))
            panel.barh(
                places + shift, value, 0.36, xerr=errors, color=colour, edgecolor="#000000", linewidth=0.4, hatch=hatch,
                label=label, error_kw={"linewidth": 0.8, "capsize": 2},
            )  # fmt: skip
        panel.set_yticks(places, [found.names[i] for i in order])
        panel.invert_yaxis()
        panel.axvline(0.0, color="#000000", linewidth=0.5)
        panel.set_xlim(right=max(1.0, float(np.nanmax(found.total_high, initial=0.0)) * 1.02))
        about = found.settings["quantity"]
        panel.set(xlabel=textwrap.fill(f"share of the variance of the {about['name']}", LETTERS), title=title)
        panel.legend(loc="lower right")
        return figure_of(panel)


@drawn_by.register(MorrisEffects)
def morris_effects(found: MorrisEffects, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """Strength mu* against spread sigma; below the line sigma = mu*/2 a parameter acts nearly alone and straight."""
    about = found.settings["quantity"]
    with drawing(axes, width=1.3 * COLUMN, height=2.9) as panel:
        top = max(float(np.nanmax(found.strength + found.strength_error)), 1e-300)
        for i, name in enumerate(found.names):
            colour, _, shape = LINES[i % len(LINES)]
            panel.errorbar(
                found.strength[i], found.spread[i], xerr=found.strength_error[i], color=colour, marker=shape,
                linestyle="none", markersize=5, capsize=2, linewidth=0.8, label=name,
            )  # fmt: skip
        panel.plot(
            [0.0, 1.05 * top],
            [0.0, 0.525 * top],
            color="#888888",
            linewidth=0.6,
            linestyle="--",
            label=f"{SIGMA} = µ*/2",
        )
        panel.get_lines()[-1].set_label(f"{SIGMA} = µ*/2")
        panel.set_xlim(-0.03 * top, 1.1 * top)
        panel.set_ylim(-0.03 * top, max(0.55 * top, 1.1 * float(np.nanmax(found.spread))))
        panel.set(
            xlabel=quantity_label(f"strength µ* on {about['name']}", about["unit"]),
            ylabel=quantity_label(f"spread {SIGMA} of the effect", about["unit"]),
            title=title,
        )
        panel.legend(loc="upper left")
        return figure_of(panel)


@drawn_by.register(IntervalBounds)
def interval_bounds(found: IntervalBounds, *, title: str = "", axes: "Panels | None" = None) -> "Figure":
    """The range as a bar with the limit of squeal; a figure of its own also shows where in the box the ends lie."""
    if axes is not None:
        with drawing(axes) as panel:
            _range(panel, found, title)
            return figure_of(panel)
    box, names = np.asarray(found.settings["box"]), found.names
    size = {"width": 1.4 * COLUMN, "height": 1.9 + 0.25 * len(names), "height_ratios": [1.0, 0.4 + 0.3 * len(names)]}
    with drawing(None, 2, 1, **size) as (top, below):
        _range(top, found, title)
        places = np.arange(len(names))
        for at, label, (colour, _, _), marker in (
            (found.low_at, "least value", LINES[1], "v"),
            (found.high_at, "largest value", LINES[2], "^"),
        ):
            share = (at - box[:, 0]) / (box[:, 1] - box[:, 0])
            below.plot(share, places, marker, color=colour, markersize=6, label=label, clip_on=False)
        below.hlines(places, 0.0, 1.0, color="#888888", linewidth=0.6, zorder=0)
        below.set_yticks(places, [f"{n}: {number(a)} to {number(b)}" for n, (a, b) in zip(names, box, strict=True)])
        below.set(
            xlim=(-0.04, 1.04), ylim=(len(names) - 0.5, -0.5), xlabel="place within the interval, 0 low to 1 high"
        )
        below.legend(loc="upper center", bbox_to_anchor=(0.5, -0.32 - 0.25 / len(names)), ncols=2)
        return figure_of(top)


def _range(panel: "Axes", found: IntervalBounds, title: str) -> None:
    about = found.settings["quantity"]
    low, high = float(found.low), float(found.high)
    limit = about["limit"]
    above = about["squeals"] == "above"
    quiet = (low, min(high, limit)) if above else (max(low, limit), high)
    squeal = (max(low, limit), high) if above else (low, min(high, limit))
    for (start, end), colour, label in ((quiet, QUIET, "quiet"), (squeal, SQUEAL, "squeal")):
        if start < end:
            panel.barh(0.0, end - start, 0.5, left=start, color=colour, edgecolor="#000000", linewidth=0.4, label=label)
    panel.plot(float(found.nominal), 0.0, "o", color="#000000", label="middle of the box")
    panel.axvline(limit, color="#000000", linewidth=0.8, linestyle="--")
    panel.set_ylim(-0.6, 0.9)
    panel.set_yticks([])
    panel.legend(loc="upper center", ncols=3, borderpad=0.1)
    panel.set(xlabel=quantity_label(about["name"], about["unit"]), title=title)
