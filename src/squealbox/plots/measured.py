"""What was measured: squeal events, the noise matrix of a campaign, a calibration, a model beside a measurement."""

from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.calibration import Calibration, Comparison
from squealbox.plots.dispatch import drawn_by
from squealbox.plots.style import COLUMN, WIDTH, drawing, figure_of, line, note, panels
from squealbox.signals import (
    DampingOnset,
    NoiseMatrix,
    OperationalModes,
    Recording,
    SoundQuality,
    SquealEvents,
    spectrogram,
)
from squealbox.words import number, quantity_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

NARROW = 0.45  # inches a row of a short table of bars
LONGER, PIECES = 8.0, 8.0  # times the motion that is shown of a recording, and pieces of the shorter one
SURE = 1.96  # standard deviations of a 95 % interval


@drawn_by.register(SquealEvents)
def event_tracks(found: SquealEvents, *, title: str = "") -> "Figure":
    """Frequency of each event over time, coloured by its level, and the levels below, over the whole recording."""
    unit = found.settings.get("unit", "dB")
    figure, axes = panels(2, 1, width=1.5 * COLUMN, height=3.6, sharex=True)
    with drawing(axes) as (tracks, levels):
        shown = found.track_level[np.isfinite(found.track_level)]
        ends = (float(np.min(shown)), float(np.max(shown))) if shown.size else (0.0, 1.0)
        points = None
        for i in range(found.count):
            known = np.isfinite(found.track_frequency[i])
            time, level = found.track_time[i, known], found.track_level[i, known]
            points = tracks.scatter(time, 1e-3 * found.track_frequency[i, known], c=level, s=5, vmin=ends[0],
                                    vmax=ends[1], cmap="viridis", rasterized=known.sum() > 2000)  # fmt: skip
            levels.plot(time, level, **line(0))
            for panel in (tracks, levels):
                panel.axvspan(found.onset[i], found.end[i], color="#eeeeee", zorder=0)
        if points is not None:
            figure.colorbar(points, ax=axes, label=quantity_label("level", unit), pad=0.02)
        else:
            note(tracks, str(found.outcome), "center")
        tracks.set(ylabel=quantity_label("frequency", "kHz"), title=title)
        if points is not None:  # a steady tone is a line, not its last digits
            known = 1e-3 * found.track_frequency[np.isfinite(found.track_frequency)]
            middle, half = 0.5 * (known.max() + known.min()), max(0.6 * np.ptp(known), 0.05 * known.max())
            tracks.set_ylim(middle - half, middle + half)
        levels.set(xlabel=quantity_label("time", "s"), ylabel=quantity_label("level", unit))
        levels.set_xlim(0.0, found.duration)
    return figure


@drawn_by.register(NoiseMatrix)
def noise_matrix_figure(found: NoiseMatrix, *, title: str = "") -> "Figure":
    """Share of the stops that squeal in each cell, with their numbers, and the histogram of the frequencies."""
    x, y = found.settings["x"], found.settings["y"]
    figure, axes = panels(1, 2, width=WIDTH, height=2.8, width_ratios=[1.3, 1.0])
    with drawing(axes) as (cells, bins):
        filled = cells.pcolormesh(found.x_edges, found.y_edges, 100.0 * found.share.T, cmap="YlOrRd", vmin=0.0,
                                  vmax=100.0, edgecolors="white", linewidth=0.5)  # fmt: skip
        figure.colorbar(filled, ax=cells, label=quantity_label("stops that squeal", "%"))
        middles = (0.5 * (edges[:-1] + edges[1:]) for edges in (found.x_edges, found.y_edges))
        across, up = np.meshgrid(*middles, indexing="ij")
        for i in np.ndindex(*found.stops.shape):
            if found.stops[i]:
                dark = found.noisy[i] > 0.7 * found.stops[i]
                cells.text(across[i], up[i], f"{found.noisy[i]:.0f} / {found.stops[i]:.0f}", ha="center", va="center",
                           fontsize=6, color="white" if dark else "black")  # fmt: skip
        cells.set(xlabel=x, ylabel=y, title="noisy / all stops")
        bins.stairs(found.histogram, 1e-3 * found.frequency_edges, fill=True, color="#0072B2")
        bins.set(xlabel=quantity_label("frequency", "kHz"), ylabel="events")
        bins.yaxis.get_major_locator().set_params(integer=True)
    figure.suptitle(title or f"{found.total_noisy} of {found.total} stops squeal", fontsize=8)
    return figure


@drawn_by.register(Calibration)
def calibration_figure(found: Calibration, *, title: str = "") -> "Figure":
    """Each parameter with its 95 % interval, as a share of its best value, and the residuals in standard deviations."""
    measured = [str(each) for each in found.settings["measured"]]
    height = 1.0 + NARROW * max(len(found.names), len(measured)) * 0.6
    figure, axes = panels(1, 2, width=WIDTH, height=height)
    with drawing(axes) as (values, residuals):
        rows = np.arange(len(found.names))
        size = np.where(found.values == 0.0, 1.0, np.abs(found.values))
        known = np.isfinite(found.errors)
        low = np.where(np.isfinite(found.low), found.low, found.values - SURE * found.errors)
        high = np.where(np.isfinite(found.high), found.high, found.values + SURE * found.errors)
        reach = 100.0 * np.stack([found.values - low, high - found.values]) / size
        look: dict[str, Any] = {"fmt": "o", "color": "#0072B2", "markersize": 4, "capsize": 3, "linewidth": 1.0}
        values.errorbar(0.0 * rows, rows, xerr=np.where(known, np.maximum(reach, 0.0), 0.0), **look)
        told = [f"{name} = {number(value)}" for name, value in zip(found.names, found.values, strict=True)]
        values.set_yticks(rows, told, fontsize=7)
        values.set(xlabel=quantity_label("95 % interval, of the best value", "%"))
        rows = np.arange(len(measured))
        residuals.axvspan(-SURE, SURE, color="#eeeeee", zorder=0)
        residuals.axvline(0.0, color="black", linewidth=0.6)
        residuals.plot(found.residuals, rows, "o", color="#D55E00", markersize=4)
        residuals.set_xlim(*(np.array([-1.1, 1.1]) * max(3.0, float(np.nanmax(np.abs(found.residuals), initial=0.0)))))
        residuals.set_yticks(rows, measured, fontsize=7)
        residuals.set(xlabel=quantity_label("measured less predicted", "sd"))
        for panel in (values, residuals):
            panel.margins(y=0.3)
            panel.invert_yaxis()
    ended = "" if found.outcome.ok else found.outcome.told
    figure.suptitle("\n".join(filter(None, (title, ended))), fontsize=8, wrap=True)
    return figure


@drawn_by.register(Comparison)
def model_beside_measurement(found: Comparison, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """How far each simulated number lies from the measured one, beside the measured number's own 95 % error.

    Of a level in dB, which has no per cent, the difference stands beside its numbers. What one side alone tells is left
    to the table.
    """
    known = np.isfinite(found.simulated) & np.isfinite(found.measured)
    known = known if np.any(known) else ~known
    simulated, measured, error = (x[known] for x in (found.simulated, found.measured, found.error))
    names, units = (np.array(each)[known] for each in (found.names, found.settings["units"]))
    share = 100.0 * error / np.where(measured == 0.0, 1.0, np.abs(measured))
    off = 100.0 * (simulated / np.where(measured == 0.0, np.nan, measured) - 1.0)
    off[[unit.startswith("dB") for unit in units]] = np.nan
    with drawing(axes, width=1.5 * COLUMN, height=0.9 + NARROW * len(names)) as panel:
        rows = np.arange(len(names))
        panel.axvline(0.0, color="black", linewidth=0.6)
        both = np.isfinite(off)  # without a reference there is nothing to stand at zero
        panel.errorbar(np.where(both, 0.0, np.nan), rows, xerr=np.nan_to_num(share), fmt="s", color="#000000",
                       markersize=4, capsize=3, linewidth=1.0, label="measured, 95 %")  # fmt: skip
        panel.plot(off, rows, "o", color="#D55E00", markersize=5, label="simulated")
        numbers = zip(names, simulated, measured, units, strict=True)
        told = [f"{name}\n{_or_dash(a)} for {_or_dash(b)}{_in_dB(a - b, unit)}" for name, a, b, unit in numbers]
        panel.set_yticks(rows, told, fontsize=7)
        panel.set(xlabel=quantity_label("away from the measured number", "%"), title=title)
        panel.set_ylim(len(rows) - 0.5, -1.1)  # with a row without marks, and room for the key
        panel.legend(loc="upper right", ncols=2, fontsize=6)
        return figure_of(panel)


def _in_dB(difference: float, unit: str) -> str:
    return f", {difference:+.3g} dB" if unit.startswith("dB") and np.isfinite(difference) else ""


def spectrograms_beside(
    simulated: Any, recording: Recording, events: SquealEvents | None = None, *,
    channel: int | str = 0, dof: int | str = 0, title: str = "",
) -> "Figure":  # fmt: skip
    """The spectrogram of a motion beside that of a recording, in dB below the largest of each, at one resolution.

    Of the recording the loudest event is shown, from its onset on, as long as eight times the motion at most; without
    `events` its beginning. `channel` is the recording's, `dof` the motion's that is heard.
    """
    heard = recording.channel(channel)
    began, ended = 0.0, len(heard) / recording.rate
    if events is not None and events.count:
        loudest = int(np.argmax(events.level))
        began, ended = float(events.onset[loudest]), float(events.end[loudest])
    length = float(simulated.t[-1] - simulated.t[0])
    ended = min(ended, began + LONGER * length)
    segment = min(length, ended - began) / PIECES
    cut: dict[str, Any] = {"begin": began, "end": ended, "segment": segment}
    grids = (spectrogram(simulated, dof=dof, segment=segment), spectrogram(heard, recording.t, **cut))
    upto = 2.0 * max(grid.strongest for grid in grids)
    figure, axes = panels(1, 2, width=WIDTH, height=2.8, sharey=True)
    with drawing(axes) as both:
        for panel, grid, name in zip(both, grids, ("simulated", "recorded"), strict=True):
            shown = grid.frequency <= upto
            level = 20.0 * np.log10(np.maximum(grid.amplitude[shown] / np.max(grid.amplitude[shown]), 1e-3))
            look = {"cmap": "Blues", "vmin": -60.0, "vmax": 0.0, "rasterized": True}
            mesh = panel.pcolormesh(1e3 * (grid.time - grid.time[0]), 1e-3 * grid.frequency[shown], level, **look)
            panel.set(xlabel=quantity_label("time", "ms"), title=name)
        both[0].set_ylabel(quantity_label("frequency", "kHz"))
        figure.colorbar(mesh, ax=list(both), pad=0.02).set_label(quantity_label("below the largest", "dB"))
    figure.suptitle(title, fontsize=8)
    return figure


@drawn_by.register(OperationalModes)
def ambient_spectrum(found: OperationalModes, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """The measured spectrum, that of the modes and the noise, and each mode with its damping ratio."""
    with drawing(axes, width=1.5 * COLUMN, height=2.8) as panel:
        panel.semilogy(found.line, found.measured, color="#b0b0b0", linewidth=0.6, label="measured")
        panel.semilogy(found.line, found.fitted, color="#D55E00", label="modes and noise")
        for f, zeta, error in zip(found.frequency, found.damping_ratio, found.damping_error, strict=True):
            panel.axvline(f, color="black", linewidth=0.5, linestyle=":")
            panel.annotate(f" {number(100.0 * zeta, 3)} ± {number(100.0 * error, 1)} %", (f, 0.98), fontsize=6,
                           va="top", xycoords=("data", "axes fraction"))  # fmt: skip
        panel.set(xlabel=quantity_label("frequency", "Hz"), ylabel="power", title=title)
        panel.margins(x=0.0)
        panel.set_ylim(top=4.0 * panel.get_ylim()[1])  # room for the numbers
        panel.legend(loc="lower left", fontsize=6)
        return figure_of(panel)


@drawn_by.register(DampingOnset)
def damping_line(found: DampingOnset, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """Growth rates with their errors over what was varied, the line through them, and where it meets zero."""
    with drawing(axes, width=1.4 * COLUMN, height=2.6) as panel:
        panel.axhline(0.0, color="black", linewidth=0.6)
        panel.errorbar(found.at, found.growth_rate, yerr=found.growth_error, fmt="o", color="#0072B2", markersize=4,
                       capsize=3, linewidth=1.0, label="measured, 95 %")  # fmt: skip
        ends = [*found.at, *([float(found.value)] if found.outcome.ok else [])]
        reach = np.array([min(ends), max(ends)])
        panel.plot(reach, found.line[0] + found.line[1] * reach, color="#0072B2", linewidth=0.8, linestyle="--")
        if found.outcome.ok:
            panel.errorbar([found.value], [0.0], xerr=[[found.value - found.low], [found.high - found.value]], fmt="D",
                           color="#D55E00", markersize=4, capsize=3, label="onset, 95 %")  # fmt: skip
        panel.set(xlabel=found.settings["name"], ylabel=quantity_label("growth rate", "1/s"), title=title)
        panel.legend(loc="best", fontsize=6)
        return figure_of(panel)


@drawn_by.register(SoundQuality)
def specific_loudness(found: SoundQuality, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """Loudness in each critical band; the sums stand in the title."""
    with drawing(axes, width=1.4 * COLUMN, height=2.4) as panel:
        panel.fill_between(found.bark, found.specific_loudness, color="#0072B2", linewidth=0.0)
        panel.set(xlabel=quantity_label("critical band", "Bark"), ylabel=quantity_label("loudness", "sone/Bark"))
        panel.set_title(title or f"{number(found.loudness, 3)} sone, {number(found.sharpness, 3)} acum, "
                                 f"{number(found.roughness, 2)} asper")  # fmt: skip
        panel.set_xlim(0.0, 24.0)
        panel.set_ylim(bottom=0.0)
        return figure_of(panel)


def _or_dash(value: float) -> str:
    return number(float(value), 5) if np.isfinite(value) else "-"
