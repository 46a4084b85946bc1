"""Figures of a spectrum and of a spectrogram."""

from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox import signals
from squealbox.plots.dispatch import drawn_by
from squealbox.plots.style import LINES, drawing, figure_of, line, note, uncertain
from squealbox.words import number, quantity_label, scaled, unit_at

WIDER = 2.4  # so much of the frequency of the highest peak is drawn: its first harmonic with its name
NAMED = 0.03  # share of the highest peak from which a peak is named

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from squealbox.signals import Spectrogram


def spectrum(
    signal: Any,
    t: ArrayLike | None = None,
    *,
    peaks: int = 3,
    upto: float | None = None,
    logarithmic: bool = False,
    unit: str | None = None,
    frequency_unit: str | None = None,
    name: str = "amplitude",
    quantity: str = "",
    remark: str = "",
    title: str = "",
    axes: "Axes | None" = None,
    **cut: Any,
) -> "Figure":
    """One-sided amplitude spectrum of a signal, or a `Spectrum` already made, with its highest peaks named.

    Parameters
    ----------
    signal, t : a `Spectrum`, a trajectory, or an array (k,) in m with its times [s]
    peaks : how many peaks to name at most
    upto : highest frequency drawn [Hz]; by default beyond twice that of the highest peak
    logarithmic : draw the amplitude over five decades on a logarithmic scale
    unit, frequency_unit : "mm", "µm", "kHz", "rad/s", "10³ rad/s" ...; by default what suits the numbers
    quantity : unit of the signal, by default that of the degree of freedom, m or rad
    remark : what the corner says beside window and resolution
    cut : `dof`, `begin`, `end`, `window` ... of :func:`squealbox.signals.spectrum`
    """
    lines = signal if isinstance(signal, signals.Spectrum) else signals.spectrum(signal, t, **cut)
    found = signals.peaks(lines, least=NAMED)
    limit = upto or WIDER * float(found.frequency[0] if found.frequency.size else lines.frequency[-1] / WIDER)
    shown = lines.frequency <= limit
    hertz, read = scaled("Hz", lines.frequency[shown], to=frequency_unit)
    own = quantity or unit_at(getattr(signal, "system", None), cut.get("dof", 0))
    factor, size = scaled(own, lines.amplitude[shown], to=unit)
    with drawing(axes) as panel:
        draw = panel.semilogy if logarithmic else panel.plot
        draw(lines.frequency[shown] / hertz, lines.amplitude[shown] / factor, **{**line(0), "linewidth": 0.8})
        top = float(np.max(lines.amplitude[shown])) / factor or 1.0
        panel.set_ylim(*((1e-5 * top, 100.0 * top) if logarithmic else (0.0, 1.4 * top)))
        panel.set_xlim(0.0, limit / hertz)
        named = _named(found, peaks, limit, 4.0 * lines.resolution)
        for frequency, amplitude in named:
            beside = [other for other, _ in named if 0.0 < abs(other - frequency) < 0.15 * limit]
            side = "center" if not beside else "right" if frequency < min(beside) else "left"
            _name_peak(panel, frequency / hertz, amplitude / factor, side)
        panel.set(xlabel=quantity_label("frequency", read), ylabel=quantity_label(name, size), title=title)
        said = f"{lines.window.capitalize()} window, resolution {_fine(lines.resolution, read)}"
        note(panel, f"{said}\n{remark}" if remark else said)
        return figure_of(panel)


def _named(found: signals.Peaks, count: int, limit: float, drift: float) -> list[tuple[float, float]]:
    """The peaks to name: the highest, none slower than `drift` and no two so close that their names would touch."""
    chosen: list[tuple[float, float]] = []
    for frequency, amplitude in found:
        clear = all(abs(frequency - other) > 0.02 * limit for other, _ in chosen)
        if drift <= frequency <= limit and clear and len(chosen) < count:
            chosen.append((frequency, amplitude))
    return chosen


def _fine(resolution: float, read: str) -> str:
    if "rad" in read:
        return f"{number(2.0 * np.pi * resolution, 3)} rad/s"
    return f"{number(resolution, 3)} Hz"


def _name_peak(panel: "Axes", x: float, y: float, side: str) -> None:
    panel.plot(x, y, "v", color="#D55E00", markersize=3, zorder=3)
    panel.annotate(
        number(x),
        (x, y),
        textcoords="offset points",
        xytext=({"left": 2, "center": 0, "right": -2}[side], 4),
        ha=side,
        fontsize=6.5,
    )


def spectrogram(
    signal: "Spectrogram",
    t: ArrayLike | None = None,
    *,
    upto: float | None = None,
    decades: float = 3.0,
    unit: str | None = None,
    frequency_unit: str | None = None,
    title: str = "",
    axes: "Axes | None" = None,
    **cut: Any,
) -> "Figure":
    """Amplitude over time and frequency, dark where it is large, over `decades` [-] below the largest.

    `signal` is a `Spectrogram`, a trajectory, or an array (k,) in m with its times `t` [s]; `upto` [Hz] is the highest
    frequency drawn; `cut` goes to :func:`squealbox.signals.spectrogram`.
    """
    from matplotlib.colors import LogNorm

    grid = signal if isinstance(signal, signals.Spectrogram) else signals.spectrogram(signal, t, **cut)
    shown = grid.frequency <= (upto or 2.0 * grid.strongest)
    hertz, read = scaled("Hz", grid.frequency[shown], to=frequency_unit)
    own = unit_at(getattr(signal, "system", None), cut.get("dof", 0))
    factor, size = scaled(own, grid.amplitude[shown], to=unit)
    second, clock = scaled("s", grid.time)
    top = float(np.max(grid.amplitude[shown])) / factor
    with drawing(axes, height=2.6) as panel:
        shade = LogNorm(top * 10.0**-decades, top)
        floor = np.maximum(grid.amplitude[shown] / factor, top * 10.0**-decades)
        mesh = panel.pcolormesh(
            grid.time / second, grid.frequency[shown] / hertz, floor, norm=shade, cmap="Blues", rasterized=True
        )
        bar = figure_of(panel).colorbar(mesh, ax=panel, pad=0.02)
        bar.set_label(quantity_label("amplitude", size))
        panel.set(xlabel=quantity_label("time", clock), ylabel=quantity_label("frequency", read), title=title)
        pieces = f"pieces of {number(grid.segment / second, 3)} {clock}"
        note(panel, f"{grid.window.capitalize()} window, {pieces}, resolution {_fine(grid.resolution, read)}")
        return figure_of(panel)


@drawn_by.register(signals.GrowthRate)
def component_growth(found: signals.GrowthRate, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """The amplitude of one component piece by piece, on a logarithmic scale, and the rate fitted to it."""
    second, clock = scaled("s", found.time)
    middle = 0.5 * (found.time[0] + found.time[-1])
    line_through = np.exp(np.mean(np.log(found.envelope)) + found.rate * (found.time - middle))
    with drawing(axes, height=2.4) as panel:
        panel.semilogy(found.time / second, found.envelope, "o", color=LINES[0][0], markersize=3.0, label="measured")
        label = f"{uncertain(found.rate, found.rate_error)} 1/s"
        panel.semilogy(found.time / second, line_through, **line(2), label=label)
        panel.set(
            xlabel=quantity_label("time", clock),
            ylabel=quantity_label("amplitude of the component", "unit of the signal"),
            title=title,
        )
        factor, read = scaled("Hz", found.frequency)
        note(panel, f"at {number(found.frequency / factor, 5)} {read}", "lower left")
        panel.legend(loc="best")
        return figure_of(panel)


@drawn_by.register(signals.SoundLevel)
def loudness(found: signals.SoundLevel, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """Estimated sound pressure level of each line, with the sum in the title and what it rests on below."""
    factor, read = scaled("Hz", found.frequency)
    floor = float(np.min(found.line_level, initial=0.0))
    with drawing(axes, height=2.6) as panel:
        panel.vlines(found.frequency / factor, min(floor, 0.0), found.line_level, color=LINES[1][0], linewidth=2.0)
        panel.plot(found.frequency / factor, found.line_level, "o", color=LINES[1][0])
        panel.set_xlim(left=0.0)
        panel.set_ylim(bottom=min(floor, 0.0))
        panel.margins(x=0.1, y=0.15)
        total = f"estimate: {number(found.level, 3)} dB, {number(found.weighted, 3)} dB(A)"
        panel.set_title(". ".join(filter(None, (title, total))))
        panel.set(xlabel=quantity_label("frequency", read), ylabel=quantity_label("level at the ear", "dB re 20 µPa"))
        return figure_of(panel)


drawn_by.register(signals.Spectrum, spectrum)
drawn_by.register(signals.Spectrogram, spectrogram)
