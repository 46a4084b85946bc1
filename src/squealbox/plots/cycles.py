"""Figures of limit cycles: one cycle with its multipliers, and branches of cycles over a parameter."""

import textwrap
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.limit_cycles import (
    AVERAGED,
    DESCRIBING,
    Branch,
    Cycle,
    EstimateCurve,
    ForcedCycle,
    HopfPoint,
    estimate_curves,
)
from squealbox.matrices import liveliest
from squealbox.parameters import DataSheet, ParameterError
from squealbox.plots.dispatch import drawn_by
from squealbox.plots.key_numbers import read_of
from squealbox.plots.style import LOOK, WIDTH, cautioned, drawing, figure_of, line, panels
from squealbox.words import number, quantity_label, scaled, unit_at

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

APART = 10.0  # times as large: branches that differ by more do not share a linear axis
NARROWEST = 1e-6  # of its values: half the least width of the axis of a parameter
BESIDE = 4  # entries; a longer legend stands beside the panel
ENTRY = 0.15  # inches, of a line of a legend
# Marks of the special points: shape, and what the legend calls them.
MARKS = {
    "fold": ("o", "fold"),
    "grazing": ("v", "first contact at rest"),
    "sticking": ("^", "sticking begins or ends"),
    "period_doubling": ("s", "period doubling"),
    "neimark_sacker": ("D", "Neimark-Sacker"),
    "event_order": ("|", "two events change places"),
}

ESTIMATES = {DESCRIBING: ("#0072B2", ":"), AVERAGED: ("#009E73", "-.")}


@drawn_by.register(ForcedCycle)
@drawn_by.register(Cycle)
def cycle_overview(cycle: Cycle | ForcedCycle, *, dof: int | None = None, title: str = "") -> "Figure":
    """One period in time (sticking shaded), the orbit in the phase plane and the multipliers in the unit circle.

    dof : index of the degree of freedom; None takes the one that moves most. The axes name it, the title the cautions.
    """
    names = cycle.system.names
    dof = liveliest(cycle.amplitude, cycle.system.units) if dof is None else dof
    shown = read_of(names, dof)
    figure, axes = panels(1, 3, height=2.5, width_ratios=[1.4, 1.0, 1.0])
    factor, read = scaled(unit_at(cycle.system, dof), cycle.q[:, dof])
    speed, clock = scaled(unit_at(cycle.system, dof, moves=True), cycle.qd[:, dof])
    second, time = scaled("s", cycle.t)
    stuck = np.any(cycle.mode == 0, axis=1)
    with drawing(axes) as (history, plane, circle):
        history.plot(cycle.t / second, cycle.q[:, dof] / factor, **line(0))
        history.fill_between(cycle.t / second, 0.0, 1.0, where=stuck, color="#dddddd", linewidth=0.0,
                             transform=history.get_xaxis_transform())  # fmt: skip
        sticking = [name for i, name in enumerate(cycle.system.contact_names) if np.any(cycle.mode[:, i] == 0)]
        if sticking:
            history.set_title(textwrap.shorten(f"grey: {' or '.join(sticking)} sticks", 60), fontsize=7)
        history.set(xlabel=quantity_label("time", time), ylabel=quantity_label(shown, read))
        history.set_xlim(0.0, cycle.t[-1] / second)
        plane.plot(cycle.q[:, dof] / factor, cycle.qd[:, dof] / speed, **line(0))
        sticks = np.where(stuck, cycle.qd[:, dof], np.nan)
        plane.plot(cycle.q[:, dof] / factor, sticks / speed, color="#888888", linewidth=2.5, zorder=1)
        plane.set(xlabel=quantity_label(shown, read), ylabel=quantity_label("velocity", clock))
        plane.margins(0.08)
        angle = np.linspace(0.0, 2.0 * np.pi, 181)
        circle.plot(np.cos(angle), np.sin(angle), color="#888888", linewidth=0.7)
        values = cycle.multipliers
        circle.plot(values[1:].real, values[1:].imag, "o", color="#000000", markerfacecolor="white")
        circle.plot(values[:1].real, values[:1].imag, "x", color="#000000")
        circle.set(xlabel="Re multiplier [-]", ylabel="Im multiplier [-]")
        circle.set_aspect("equal", adjustable="datalim")
    kind = cycle.stability
    what = "forced motion" if isinstance(cycle, ForcedCycle) else "cycle"
    said = f"{kind} {what}, {number(cycle.frequency)} Hz" if cycle.outcome.ok else str(cycle.outcome)
    caution = cycle.warned()
    figure.suptitle(". ".join(filter(None, (title, said))) + (f"\n{caution}" if caution else ""), fontsize=8, wrap=True)
    return figure


@drawn_by.register(Branch)
def branch_diagram(
    branches: Branch | Sequence[Branch],
    *,
    dof: int | None = None,
    hopf: HopfPoint | None = None,
    runs: tuple[Any, Any] | None = None,
    estimates: bool | Sequence[EstimateCurve] = True,
    labels: Sequence[str] = (),
    name: str | None = None,
    scale: float = 1.0,
    title: str = "",
    axes: "Axes | None" = None,
) -> "Figure":
    """Amplitude over the parameter: stable parts solid, unstable ones dashed, special points marked.

    Parameters
    ----------
    branches : one or several
    dof : index of the degree of freedom; None takes the one that moves most, and the axis names it
    hopf : marks where the branch is born; a branch that was followed from such a point has its mark without, and is
        joined to it as amplitudes rise there, by the root of the distance
    runs : (values, amplitudes [m]) of long runs, drawn as crosses
    estimates : quick estimates, drawn as dotted curves with how far they are off; True computes those of
        :func:`limit_cycles.estimate_curves` where the branches know what they were followed in, False draws none
    labels, name : of the branches (each then has a colour of its own) and of the parameter, with its unit
    scale : [-] what the parameter is divided by
    axes : draw here instead of in a new figure
    """
    several = [branches] if isinstance(branches, Branch) else list(branches)
    system = several[0].inputs.get("system")
    names, units = getattr(system, "names", ()), getattr(system, "units", ())
    if dof is None:
        peaks = [np.max(b.amplitude, axis=0) for b in several if len(b.value)]
        dof = liveliest(np.max(peaks, axis=0), units) if peaks and names else 0
    read_as = f"amplitude {names[dof]}" if len(names) > 1 else "amplitude"
    largest = [b.amplitude[:, dof] for b in several]
    factor, read = scaled(unit_at(system, dof), *largest)
    with drawing(axes) as panel:
        shown: set[str] = set()
        for i, one in enumerate(several):
            label = labels[i] if i < len(labels) else ""
            _parts(panel, one, one.amplitude[:, dof] / factor, scale, line(i if labels else 0)["color"], label, shown)
            _marks(panel, one, one.amplitude[:, dof] / factor, scale, shown)
        floor = _floor([size / factor for size in largest])
        births = {float(hopf.value)} if hopf is not None and hopf.outcome.ok else set()
        for i, one in enumerate(several):
            born = one.settings.get("born_at")
            if born is not None and len(one.value):
                births.add(float(born))
                _rise(panel, one, one.amplitude[0, dof] / factor, float(born), scale, line(i if labels else 0)["color"])
        for k, born in enumerate(sorted(births)):
            panel.plot(born / scale, floor, "o", color="#000000", label=None if k else "onset of instability", zorder=4,
                       clip_on=False)  # fmt: skip
        if floor > 0.0:
            panel.set_yscale("log")
        ends = panel.get_ylim()
        _estimates(panel, _known(several) if estimates is True else estimates or (), dof, factor, scale)
        room = 1.0 if floor else 1.05  # the branch does not end on the frame
        panel.set_ylim(top=max(room * ends[1], floor))  # an estimate far above the cycles leaves the panel
        if runs is not None:
            at, sizes = (np.asarray(x) for x in runs)
            panel.plot(at / scale, sizes / factor, "+", color="#555555", markersize=4.5, label="long run")
        panel.set(xlabel=name or _parameter(several[0]), ylabel=quantity_label(read_as, read), title=title)
        panel.set_ylim(bottom=floor)
        panel.margins(x=0.05)
        _wide_enough(panel)
        _legend(panel, alone=axes is None)
        cautioned(panel, [one.caution for one in several], axes is None)
        return figure_of(panel)


def _parameter(one: Branch) -> str:
    """The parameter with its unit, where what was followed declares one."""
    followed: Any = one.family if isinstance(one.family, DataSheet) else one.inputs.get("system")
    try:
        followed.value_of(one.parameter)
    except (AttributeError, ParameterError):  # a function's own name for what it varies
        return one.parameter
    return quantity_label(one.parameter, followed.unit_of(one.parameter))


def _wide_enough(panel: "Axes") -> None:
    """A branch that goes straight up is drawn so: its parameter is no better known than to `NARROWEST` of itself."""
    left, right = panel.get_xlim()
    middle, half = 0.5 * (left + right), NARROWEST * max(abs(left), abs(right))
    if right - left < 2.0 * half:
        panel.set_xlim(middle - half, middle + half)


def _floor(sizes: Sequence[Any]) -> float:
    """Where the axis of amplitudes begins: 0, or where branches lie decades apart and the axis is logarithmic."""
    usual = [float(np.median(size[size > 0.0])) for size in sizes if np.any(size > 0.0)]
    if not usual or max(usual) < APART * min(usual):
        return 0.0
    return 0.5 * min(float(np.quantile(size[size > 0.0], 0.1)) for size in sizes if np.any(size > 0.0))


def _known(several: Sequence[Branch]) -> tuple[EstimateCurve, ...]:
    """The quick estimates beside branches that were followed together."""
    together = [one for one in several if len(one.value) and one.family is not None]
    if not together or len({one.parameter for one in together}) > 1:
        return ()
    ends = np.array([one.settings["bounds"] for one in together])
    bounds = float(np.min(ends)), float(np.max(ends))
    return estimate_curves(together[0].family, together[0].parameter, bounds, together)


def _estimates(panel: "Axes", curves: Sequence[EstimateCurve], dof: int, factor: float, scale: float) -> None:
    """Each kind in a look of its own; the legend says how far it is off the cycles."""
    for label in dict.fromkeys(curve.label for curve in curves):
        alike = [curve for curve in curves if curve.label == label]
        worst = max(alike, key=lambda curve: np.nan_to_num(curve.most, nan=-1.0))
        text = label.replace(" (", "\n(") + (
            f"\n{worst.beside}".replace(", ", ",\n") if np.isfinite(worst.most) else ""
        )
        colour, dash = ESTIMATES.get(label, ("#0072B2", ":"))
        for i, curve in enumerate(alike):
            panel.plot(curve.value / scale, curve.amplitude[:, dof] / factor, dash, color=colour, linewidth=1.2,
                       label=None if i else text, zorder=1)  # fmt: skip


def _legend(panel: "Axes", alone: bool) -> None:
    """Within the panel; of a figure of ours a long one beside it, or above it where a width was asked for."""
    handles, texts = panel.get_legend_handles_labels()
    if alone and len(texts) > BESIDE:
        figure = figure_of(panel)
        width, height = figure.get_size_inches()
        if LOOK.get().width is None:
            figure.set_size_inches(WIDTH, height)
            figure.legend(handles, texts, loc="outside right upper")
            return
        lines = sum(1 + text.count("\n") for text in texts)
        if LOOK.get().height is None:
            figure.set_size_inches(width, height + ENTRY * lines)
        figure.legend(handles, texts, loc="outside upper center")
    elif texts:
        panel.legend(loc="best")


def _parts(
    panel: "Axes", one: Branch, size: np.ndarray, scale: float, colour: str, label: str, shown: set[str]
) -> None:
    stable = one.stable
    for wanted, dash in ((True, "-"), (False, "--")):
        here = stable == wanted
        joined = here | np.r_[here[1:], False] if len(here) else here  # reach the next part
        kind = "stable" if wanted else "unstable"
        if np.any(here):
            text = f"{label}, {kind}" if label else kind
            told = text in shown
            shown.add(text)
            panel.plot(np.where(joined, one.value, np.nan) / scale, np.where(joined, size, np.nan), color=colour,
                       linestyle=dash, label=None if told else text)  # fmt: skip


def _rise(panel: "Axes", one: Branch, size: float, born: float, scale: float, colour: str) -> None:
    """From where a branch is born to its first point."""
    share = np.linspace(0.0, 1.0, 33)
    at = born + (float(one.value[0]) - born) * share**2
    panel.plot(at / scale, size * share, color=colour, linestyle="-" if one.stable[0] else "--", linewidth=0.7)


def _marks(panel: "Axes", one: Branch, size: np.ndarray, scale: float, shown: set[str]) -> None:
    for kind, value, at in zip(one.special_kind, one.special_value, one.special_point, strict=True):
        shape, text = MARKS[str(kind)]
        label = None if text in shown else text
        shown.add(text)
        panel.plot(value / scale, size[int(at)], shape, color="#D55E00", markerfacecolor="white", label=label, zorder=4)
