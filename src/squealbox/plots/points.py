"""Figures of results that are points or short curves over one or two parameters."""

from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.design import Design
from squealbox.limit_cycles import HopfPoint, PointCurve
from squealbox.matrices import liveliest
from squealbox.plots.dispatch import drawn_by
from squealbox.plots.style import drawing, figure_of, line, note, power_of_ten
from squealbox.stability import (
    CriticalValue,
    CriticalValues,
    DampingSplit,
    ExceptionalPoints,
    FiniteSpectrum,
    complex_modes,
)
from squealbox.system import as_system
from squealbox.words import MINUS, number, quantity_label, scaled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

DOWN, UP = "#0072B2", "#D55E00"
SMALL = 20  # degrees of freedom up to which a figure may ask for a hundred spectra


@drawn_by.register(CriticalValue)
@drawn_by.register(CriticalValues)
def crossings(found: CriticalValue | CriticalValues, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """Largest growth rate over the parameter with each crossing: up where a mode starts to grow, down where it stops.

    Without a design to ask for it (a function made the systems, or they are large) the frequency of each stands alone.
    """
    every = [found] if isinstance(found, CriticalValue) else list(found)
    every = [one for one in every if np.isfinite(one.value)]
    factor, read = scaled("Hz", *(one.frequency for one in every))
    around = _growth_around(found, [float(one.value) for one in every])
    with drawing(axes, height=2.4) as panel:
        if around is not None:
            panel.plot(*around, **line(0))
            panel.axhline(0.0, color="#000000", linewidth=0.5)
        for one in every:
            grows = one.direction == "destabilising"
            look = {"marker": "^" if grows else "v", "color": UP if grows else DOWN, "linestyle": "none"}
            at = (one.value, one.frequency / factor if around is None else 0.0)
            panel.plot(*at, **look, markersize=6.0)
            text = f"{number(one.value, 6)}\n{one.mechanism.replace('_', ' ')}"
            text += "" if around is None else f", {number(one.frequency / factor, 4)} {read}"
            place = {"xytext": (-6.0, 6.0), "va": "bottom", "ha": "right"}
            if around is None:
                place = {"xytext": (6.0, 0.0), "va": "center", "ha": "left"}
            panel.annotate(text, at, fontsize=6.5, textcoords="offset points", **place)
        panel.margins(x=0.4 if around is None else 0.0, y=0.4)
        note(panel, "▲ a mode grows above   ▼ below" if every else "no crossing", "lower left")
        name = quantity_label(found.parameter, found.unit_of(found.parameter))
        value = quantity_label("frequency", read) if around is None else quantity_label("largest growth rate", "1/s")
        panel.set(xlabel=name, ylabel=value, title=title)
        return figure_of(panel)


def _growth_around(found: CriticalValue | CriticalValues, values: list[float]) -> tuple[Any, Any] | None:
    """The parameter over its range and the largest growth rate there, of a small design; None of any other."""
    design, bounds = found.inputs.get("system"), found.settings.get("bounds")
    if not (isinstance(design, Design) and values and bounds is not None and as_system(design).size <= SMALL):
        return None
    low, high = (float(end) for end in bounds)
    at = np.union1d(np.linspace(low, high, 161), values)
    return at, complex_modes(design.replace({found.parameter: at})).growth_rate.max(axis=-1)


@drawn_by.register(FiniteSpectrum)
def finite_eigenvalues(found: FiniteSpectrum, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """The finite eigenvalues with Im >= 0 in the complex plane: dots decay, squares grow."""
    values = found.eigenvalues[np.imag(found.eigenvalues) >= 0.0]
    factor, read = scaled("Hz", np.abs(values.imag) / (2.0 * np.pi))
    with drawing(axes, height=2.8) as panel:
        for grows, marker, colour in ((False, "o", DOWN), (True, "s", UP)):
            chosen = values[(values.real > 0.0) == grows]
            panel.plot(chosen.real, chosen.imag / (2.0 * np.pi) / factor, marker, color=colour)
        panel.axvline(0.0, color="#000000", linewidth=0.5)
        panel.margins(x=0.15, y=0.25)
        panel.set(xlabel=quantity_label("growth rate", "1/s"), ylabel=quantity_label("frequency", read), title=title)
        return figure_of(panel)


@drawn_by.register(ExceptionalPoints)
def merging_points(found: ExceptionalPoints, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """Points of two parameters at which two modes merge, each with the frequency there."""
    names = found.parameters or ("", "")
    with drawing(axes, height=2.8) as panel:
        panel.plot(found.x, found.y, "o", color="#000000", markerfacecolor="white", markersize=5.0)
        for x, y, value in zip(found.x, found.y, found.eigenvalue, strict=True):
            factor, read = scaled("Hz", abs(value.imag) / (2.0 * np.pi))
            text = f"{number(abs(value.imag) / (2.0 * np.pi) / factor)} {read}"
            panel.annotate(text, (x, y), xytext=(5.0, 4.0), textcoords="offset points", fontsize=6.5)
        panel.margins(x=0.3, y=0.3)
        x_name, y_name = (quantity_label(name, found.unit_of(name)) for name in names)
        panel.set(xlabel=x_name, ylabel=y_name, title=title)
        return figure_of(panel)


@drawn_by.register(DampingSplit)
def damping_split(found: DampingSplit, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """Critical value over how the damping is shared; the best share marked, the undamped value as a line."""
    with drawing(axes, height=2.8) as panel:
        panel.plot(found.share, found.critical, **line(0, marker=True, count=np.size(found.share)), label="damped")
        panel.plot(found.best_share, found.best, "o", color=UP, label=f"best, {number(found.best)}")
        panel.axhline(float(found.undamped), **{**line(1), "linewidth": 0.8}, label="without damping")
        unit = found.unit_of(found.parameter)
        share = f"share of {found.dampers[0]}" if found.dampers else "share of the first damper"
        panel.set(xlabel=quantity_label(share, ""), ylabel=quantity_label(f"critical {found.parameter}", unit))
        panel.set(title=title, xlim=(float(found.share[0]), float(found.share[-1])))
        panel.legend(loc="best")
        return figure_of(panel)


@drawn_by.register(PointCurve)
def point_curve(found: PointCurve, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """A curve of special points over two parameters; where Hopf points give birth to unstable cycles it is dotted."""
    names = found.parameters or ("", "")
    subcritical = np.nan_to_num(np.asarray(found.lyapunov, dtype=float)) > 0.0
    with drawing(axes, height=2.8) as panel:
        for hard, look, label in ((False, line(0), found.kind or "curve"), (True, line(2), "subcritical")):
            here = subcritical == hard
            joined = here | np.r_[here[1:], False] if len(here) else here
            if np.any(here):
                panel.plot(np.where(joined, found.x, np.nan), np.where(joined, found.y, np.nan), **look, label=label)
        panel.margins(0.08)
        panel.locator_params(axis="x", nbins=5)
        panel.legend(loc="best")
        x_name, y_name = (quantity_label(name, found.unit_of(name)) for name in names)
        panel.set(xlabel=x_name, ylabel=y_name, title=title)
        return figure_of(panel)


@drawn_by.register(HopfPoint)
def birth_of_a_cycle(found: HopfPoint, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """The square-root law of amplitudes beside a Hopf point, up to where a contact would come to rest.

    Solid where the cycle is stable, dashed where it is not.
    """
    end = found.beside(_size_of_first_rest(found))
    values = np.linspace(float(found.value), end, 201)
    reach = abs(end - float(found.value))
    sizes, system = found.amplitude(values), found.inputs.get("system")
    units = getattr(system, "units", ("m",) * sizes.shape[-1])
    dof = liveliest(np.nanmax(sizes, axis=0), units)
    sizes = sizes[:, dof]
    factor, read = scaled(units[dof], sizes)
    stable = found.kind == "supercritical"
    unit = found.unit_of(found.parameter)
    narrow = reach < 0.01 * abs(float(found.value))  # then the axis counts from the point
    at, called, origin = float(found.value), found.parameter, 0.0
    if narrow:
        origin, called = at, f"{called} {MINUS} {number(at, 6)}"
    power, unit = power_of_ten(values - origin, unit) if narrow else (1.0, unit)
    with drawing(axes, height=2.6) as panel:
        panel.plot((values - origin) / power, sizes / factor, **line(0 if stable else 1), label=f"cycle, {found.kind}")
        panel.plot((at - origin) / power, 0.0, "o", color=UP, markersize=5.0, zorder=3, label="Hopf point")
        panel.set(xlabel=quantity_label(called, unit), title=title)
        panel.set(
            ylabel=quantity_label(f"amplitude {system.names[dof]}" if len(units) > 1 and system else "amplitude", read),
            xlim=((at - origin - reach) / power, (at - origin + reach) / power),
        )
        panel.set_ylim(bottom=0.0)
        panel.legend(loc="best")
        return figure_of(panel)


def _size_of_first_rest(found: HopfPoint) -> float:
    """Amplitude [m] of the critical mode at which a contact comes to rest: beyond it the square-root law ends."""
    half = len(found.shape) // 2
    shape = found.shape / np.max(np.abs(found.shape[:half]))
    rates = [abs(contact.t @ shape[half:]) / abs(float(contact.V)) for contact in found.inputs["system"].contacts]
    return 1.0 / max(rates) if max(rates, default=0.0) > 0.0 else 1e-3 * float(np.max(np.abs(found.steady))) or 1e-6
