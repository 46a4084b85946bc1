"""Figs. 3 to 9 of the paper for one reading: what was printed there, computed again, raw and exact together."""

from collections.abc import Iterator
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox import plots
from squealbox.papers.drum_brake_2011 import steady
from squealbox.papers.drum_brake_2011.by_eigenvalues import ZONE
from squealbox.papers.drum_brake_2011.by_transients import STRETCH
from squealbox.papers.drum_brake_2011.cases import AMPLITUDES, DURATION, Case
from squealbox.papers.drum_brake_2011.motions import BRAKE, Motion, Run, Studies
from squealbox.papers.drum_brake_2011.steady import PressureMap
from squealbox.plots import drawing
from squealbox.signals import spectrum
from squealbox.words import scaled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FRICTION_SHOWN = tuple(Run("friction", mu) for mu in (0.10, 0.39, 0.40, 0.50))
LOAD_SHOWN = tuple(Run("load", load) for load in (5e3, 10e3, 15e3, 25e3))
PRINTED_LINES = {  # rad/s, where the paper names frequencies
    Run("friction", 0.10): (11240.0, 14570.0),
    Run("friction", 0.40): (13140.0,),
    Run("friction", 0.50): (12190.0,),
    Run("load", 15e3): (11790.0, 14060.0),
    BRAKE: (11790.0,),
}
PRINTED_AMPLITUDES = {Run("friction", 0.40): 0.11, Run("friction", 0.50): 0.20, Run("load", 15e3): 0.16,
                      Run("load", 25e3): 0.16}  # mm  # fmt: skip
UPTO = 4000.0  # Hz, drawn; the paper looks at 0 to 5 kHz
PUBLISHED_FREQUENCIES = ((0.10, 11240.0), (0.10, 14570.0), (0.40, 13140.0), (0.50, 12190.0))  # mu, rad/s
LAST = 0.04  # of the run, drawn dark in phase planes: four cycles
EXACT_LINE: dict[str, Any] = {"color": "#D55E00", "linestyle": (0, (4, 2)), "linewidth": 0.9}
MARK: dict[str, Any] = {
    "color": "#CC79A7",
    "markeredgecolor": "#000000",
    "markersize": 5.5,
    "linestyle": "none",
    "zorder": 4,
}


_SHEETS: dict[Any, Any] = {}  # a figure and its panels by layout: making panels and ticks takes longer than drawing
_REUSED: ContextVar[bool] = ContextVar("reused", default=False)


@contextmanager
def on_the_same_sheets() -> Iterator[None]:
    """Within it, the figures of one layout are one figure: what was drawn in it is wiped when the next one begins."""
    token = _REUSED.set(True)
    try:
        yield
    finally:
        _REUSED.reset(token)


@dataclass(frozen=True)
class Margins:
    """Room around the panels and between them [inches]: laid out so a figure is drawn in half the time."""

    left: float = 0.62
    right: float = 0.12
    bottom: float = 0.42
    top: float = 0.25
    across: float = 0.72
    down: float = 0.3

    def panels(self, rows: int, columns: int, width: float, height: float, **keywords: Any) -> Any:
        """A figure of panels with these margins, and the panels."""
        layout = (self, rows, columns, width, height, *keywords.items())
        if _REUSED.get() and layout in _SHEETS:
            figure, panels = _SHEETS[layout]
            for panel in np.ravel(panels):
                _wipe(panel)
            return figure, panels
        figure, panels = plots.panels(rows, columns, width=width, height=height, **keywords)
        self.set(figure, rows, columns, width, height)
        wide, high = self._panel(rows, columns, width, height)
        for panel in np.ravel(panels):
            panel.yaxis.set_label_coords(-0.42 / wide, 0.5)
            panel.xaxis.set_label_coords(0.5, -0.24 / high)
        if _REUSED.get():
            _SHEETS[layout] = figure, panels
        return figure, panels

    def panel(self, width: float, height: float) -> Any:
        """One panel with these margins."""
        return self.panels(1, 1, width, height)[1]

    def set(self, figure: "Figure", rows: int, columns: int, width: float, height: float) -> None:
        """Give these margins to a figure."""
        wide, high = self._panel(rows, columns, width, height)
        figure.set_layout_engine(None)
        figure.subplots_adjust(
            left=self.left / width, right=1.0 - self.right / width, bottom=self.bottom / height,
            top=1.0 - self.top / height, wspace=self.across / wide, hspace=self.down / high,
        )  # fmt: skip

    def _panel(self, rows: int, columns: int, width: float, height: float) -> tuple[float, float]:
        wide = (width - self.left - self.right - (columns - 1) * self.across) / columns
        return wide, (height - self.bottom - self.top - (rows - 1) * self.down) / rows


def _wipe(panel: "Axes") -> None:
    """Take off all that was drawn, and let the limits follow what is drawn next."""
    for artist in (*panel.lines, *panel.patches, *panel.texts, *panel.collections, *panel.images):
        artist.remove()
    legend = panel.get_legend()
    if legend is not None:
        legend.remove()
    panel.set(title="", xlabel="", ylabel="")
    panel.axis("on")
    panel.relim()
    panel.autoscale(True)


def time_series(runs: tuple[Run, ...], raw: Studies, exact: Studies) -> "Figure":
    """Figs. 3 and 6: time series of x as the paper integrated it, the exact envelope on it, and both spectra."""
    figure, rows = Margins().panels(len(runs), 2, 7.4, 1.5 * len(runs) + 0.4, sharex="col")
    for run, (left, right) in zip(runs, rows, strict=True):
        _history(left, str(run), raw[run], exact[run])
        _spectra(right, raw[run], exact[run])
        _printed(left, right, run, raw)
        for panel in (left, right):
            panel.yaxis.get_major_locator().set_params(nbins=4)
            if run != runs[-1]:
                panel.set_xlabel("")
        if run != runs[0]:
            right.set_title("")
    return figure


def phase_planes(runs: tuple[Run, ...], raw: Studies, exact: Studies) -> "Figure":
    """Figs. 4 and 7: phase planes of x, the last raw cycles black, the last exact cycle dashed."""
    columns = 4 if len(runs) % 4 == 0 or len(runs) > 6 else min(len(runs), 3)
    rows = -(-len(runs) // columns)
    margins = Margins(across=0.6, down=0.68)
    figure, panels = margins.panels(rows, columns, 2.25 * columns, 2.4 * rows)
    panels = np.ravel(panels)
    for panel in panels[len(runs) :]:
        panel.axis("off")
    for panel, run in zip(panels, runs, strict=False):
        _phase_plane(panel, str(run), raw[run], exact[run])
        for axis in (panel.xaxis, panel.yaxis):
            axis.get_major_locator().set_params(nbins=4)
    return figure


def coalescence(case: Case) -> "Figure":
    """Fig. 5: frequencies and growth rates over the friction coefficient, with the published frequencies."""
    mu = np.linspace(0.0, 0.6, 301)
    figure, axes = Margins(down=0.12, top=0.12).panels(2, 1, 5.4, 4.4, sharex=True)
    plots.coalescence(mu, steady.modes(case, mu=mu), frequency_unit="10³ rad/s", axes=axes)
    with drawing(axes[0]) as panel:
        panel.plot(*(np.array(PUBLISHED_FREQUENCIES).T * [[1.0], [1e-3]]), marker="*", label="published", **MARK)
        panel.legend(loc="best", ncols=3)
    return figure


def braking(raw: Studies, exact: Studies) -> "Figure":
    """Fig. 8: braking from 0.2 m/s at 4 m/s^2: time series, spectrum and phase plane of x."""
    figure, (left, middle, right) = Margins(top=0.3).panels(1, 3, 9.0, 2.7)
    _history(left, "", raw[BRAKE], exact[BRAKE])
    low, high = (1e3 * t for t in STRETCH)
    left.axvspan(low, high, facecolor="#e6e6e6", edgecolor="none", zorder=0)
    _spectra(middle, raw[BRAKE], exact[BRAKE])
    _printed(left, middle, BRAKE, raw)
    _phase_plane(right, "", raw[BRAKE], exact[BRAKE])
    return figure


def pressure_maps(maps: dict[float, PressureMap]) -> "Figure":
    """Fig. 9: growth over both centres of pressure and its boundary, for some friction coefficients."""
    from matplotlib.patches import Rectangle

    width, height = 4.4 * len(maps), 3.6
    figure, panels = plots.panels(1, len(maps), width=width, height=height)
    Margins(left=0.5, right=0.15, across=0.65, bottom=0.4).set(figure, 1, len(maps), width, height)
    for panel, (mu, found) in zip(np.ravel(panels), maps.items(), strict=True):
        plots.stability_map(
            found.angles, found.angles, found.growth.T, x_name=r"$\theta_1$", x_unit="deg", y_name=r"$\theta_2$",
            y_unit="deg", curves=found.curves, title=f"mu = {mu:.2f}", axes=panel,
        )  # fmt: skip
        with drawing(panel):
            (left, right), (low, high) = ZONE
            box = Rectangle((left, low), right - left, high - low, fill=False, edgecolor="#0072B2", linewidth=1.4)
            panel.add_patch(box)
            panel.annotate("published zone", (left, high), color="#0072B2", fontsize=7, ha="right", va="bottom")
    return figure


def _history(panel: "Axes", name: str, raw: Motion, exact: Motion) -> None:
    """The raw series, the course of the exact amplitude on it, and the exact verdict in the corner."""
    title = f"{name}: raw {raw.words}".removeprefix(": ")
    course = exact.verdict if exact.completed and not exact.runs_away else None
    plots.time_history(raw.trajectory, dof="x", verdict=course, name="x", time_unit="ms", title=title, axes=panel)
    for text in panel.texts:
        text.set_text(f"exact {text.get_text()}")
    panel.set_xlim(0.0, 1e3 * DURATION)
    if not raw.completed:
        panel.axvline(1e3 * raw.trajectory.t[-1], **EXACT_LINE)


def _printed(series: Any, lines: Any, run: Run, raw: Studies) -> None:
    """The paper's frequencies as lines in the spectrum, and its amplitude as the edges of the last quarter's motion."""
    for line in PRINTED_LINES.get(run, ()):
        lines.axvline(1e-3 * line, color=MARK["color"], linewidth=1.1, zorder=0)
    amplitude = PRINTED_AMPLITUDES.get(run)
    motion = raw[run]
    if amplitude is None or motion.runs_away or not motion.completed:
        return
    x = motion.trajectory.q[motion.trajectory.t >= 0.75 * DURATION, 0]
    factor, _ = scaled("m", motion.trajectory.q[:, 0])
    half = 1e-3 * amplitude / AMPLITUDES[raw.case.amplitude]
    middle = 0.5 * (np.min(x) + np.max(x))
    for edge in (middle - half, middle + half):
        series.plot([750.0 * DURATION, 1e3 * DURATION], [edge / factor] * 2, color=MARK["color"], linewidth=1.6)


def _spectra(panel: "Axes", raw: Motion, exact: Motion) -> None:
    """The spectrum of the raw series with its peaks named, the exact one dashed."""
    lines = spectrum(exact.trajectory, dof="x")
    shown = lines.frequency <= UPTO
    factor, unit = scaled("m", lines.amplitude[shown])
    plots.spectrum(
        raw.trajectory, dof="x", upto=UPTO, peaks=2, unit=unit, frequency_unit="10³ rad/s", title="raw; exact dashed",
        axes=panel,
    )  # fmt: skip
    panel.plot(1e-3 * lines.angular_frequency[shown], lines.amplitude[shown] / factor, **EXACT_LINE)


def _phase_plane(panel: "Axes", name: str, raw: Motion, exact: Motion) -> None:
    """The raw phase plane, its last part black; the last period of the exact one dashed."""
    factor, unit = scaled("m", raw.trajectory.q[:, 0])
    speed, clock = scaled("m/s", raw.trajectory.qd[:, 0])
    plots.phase_plane(raw.trajectory, dof="x", part=LAST, unit=unit, speed_unit=clock, title=name, axes=panel)
    hertz = float(exact.verdict.frequency) if exact.verdict else np.nan
    period = 1.0 / hertz if np.isfinite(hertz) else LAST * DURATION
    late = exact.trajectory.t >= exact.trajectory.t[-1] - period
    x, velocity = exact.trajectory.q[late, 0] / factor, exact.trajectory.qd[late, 0] / speed
    panel.plot(x, velocity, **EXACT_LINE)
    panel.set_xlabel(f"x [{unit}]")
