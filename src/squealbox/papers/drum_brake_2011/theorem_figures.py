"""One figure for each theorem, what published numbers ask for and equations allow; and one of the solver of 2011."""

from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.papers.drum_brake_2011 import steady, theorems
from squealbox.papers.drum_brake_2011.cases import PRINTED, RECONSTRUCTED, RESOLUTION, Case
from squealbox.papers.drum_brake_2011.figures import Margins
from squealbox.plots import drawing, figure_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

BLUE, RED, GREY, INK = "#0072B2", "#D55E00", "#808080", "#000000"
WIDTH, HEIGHT = 5.6, 3.1
MARGINS = Margins(bottom=0.4)
MARK: dict[str, Any] = {"marker": "o", "linestyle": "none", "capsize": 3.0, "markersize": 4.0, "color": INK}


def trace() -> "Figure":
    """Mean frequency over mu: the wedge through mu-3 and N-2 passes over mu-6."""
    mu = np.linspace(0.0, 0.55, 56)
    known = {each: theorems.published_trace(each) for each in (0.10, 0.30)}
    bands = [theorems.trace_line(known, float(each)) for each in mu]
    with drawing(MARGINS.panel(WIDTH, HEIGHT)) as axes:
        low, high = (_mean(np.array([getattr(band, end) for band in bands])) for end in ("low", "high"))
        axes.fill_between(mu, low, high, color=BLUE, alpha=0.2, linewidth=0.0)
        axes.text(0.02, 12.55, "all that is linear in mu\nand meets mu-3 and N-2", color=BLUE)
        for each, name in ((0.10, "mu-3"), (0.30, "N-2"), (0.40, "mu-5"), (0.50, "mu-6")):
            band = theorems.published_trace(each)
            middle = _mean(0.5 * (band.low + band.high))
            colour = RED if name == "mu-6" else INK
            axes.errorbar(each, middle, 1e-3 * RESOLUTION, **{**MARK, "color": colour})
            axes.annotate(name, (each, middle), (7, -3), textcoords="offset points", color=colour)
        axes.set(xlim=(0.0, 0.56), xlabel="friction coefficient [-]", ylabel="mean frequency [10³ rad/s]")
        axes.set_title("12190 rad/s at mu = 0.50 lies outside")
        return figure_of(axes)


def damping() -> "Figure":
    """C22 - c11 over the load: what mu-5 asks for at 1 kN and N-2 at 15 kN is on no line from the table's value."""
    load = np.linspace(0.0, 17e3, 18)
    with drawing(MARGINS.panel(WIDTH, HEIGHT)) as axes:
        for at_low in (0.0, 4.0, 10.0):
            axes.plot(1e-3 * load, theorems.damping_difference(at_low, load), color=BLUE, linewidth=1.0)
        axes.text(4.2, 190.0, "all lines from the table's -6 N s/m\nthat are positive at 1 kN", color=BLUE)
        axes.axhline(0.0, color=GREY, linewidth=0.6)
        for where, needs, name, colour in (
            (1.0, 1.0, "mu-5: upper mode grows", INK),
            (15.0, -1.0, "N-2: lower mode grows", RED),
        ):
            axes.annotate(
                "", (where, 120.0 * needs), (where, 0.0), arrowprops={"arrowstyle": "-|>", "color": colour, "lw": 1.6}
            )
            side = {"ha": "left" if where < 8 else "right", "color": colour}
            axes.text(where + (0.3 if where < 8 else -0.3), (108.0 if needs > 0 else -95.0), name, **side)
        axes.set(xlim=(0.0, 17.0), ylim=(-150.0, 260.0), xlabel="load [kN]", ylabel="$c_{22} - c_{11}$ [N s/m]")
        axes.set_title("both arrows cannot be on one line")
        return figure_of(axes)


def load_and_speed() -> "Figure":
    """Decay rates at 1 kN while the speed falls, beside what V-1 asks for."""
    speed = np.linspace(0.05, 0.2, 31)
    with drawing(MARGINS.panel(WIDTH, HEIGHT)) as axes:
        for name, colour in ((PRINTED, INK), (RECONSTRUCTED, BLUE)):
            decay = [
                -steady.growth(Case(name, alpha).design(speed=speed)) for alpha in (0.053, 0.080)
            ]  # the slopes the paper's own onset in load asks for
            axes.fill_between(speed, *decay, color=colour, alpha=0.5, linewidth=1.0, label=name.replace("_", " "))
        bound = 0.9 * float(-steady.growth(Case(PRINTED, 0.0).design(load=0.0)))
        axes.axhline(bound, color=GREY, linestyle=(0, (4, 2)), linewidth=0.9)
        axes.text(0.195, bound - 9.0, "least decay of all that is stable at 10 kN (N-1)", color=GREY)
        axes.plot([0.05, 0.12], [0.0, 0.0], color=RED, linewidth=4.0, solid_capstyle="butt")
        axes.text(0.12, 5.0, "V-1: no decay from 0.12 to 0.05 m/s", color=RED)
        axes.set(xlim=(0.2, 0.05), ylim=(-8.0, 125.0), xlabel="sliding speed, falling [m/s]", ylabel="decay rate [1/s]")
        axes.set_title("at 1 kN the decay hardly knows the speed")
        axes.legend(loc="center right")
        return figure_of(axes)


def onset() -> "Figure":
    """(w2^2 - w1^2)^2 over mu: the parabola through the table and the published frequencies vanishes at 0.44."""
    mu = np.linspace(0.0, 0.46, 93)
    values = [theorems.table_split(), theorems.squared_split(0.10), theorems.squared_split(0.30)]
    curve = np.polyval(np.polyfit([0.0, 0.10, 0.30], values, 2), mu)
    with drawing(MARGINS.panel(WIDTH, HEIGHT)) as axes:
        axes.plot(mu, 1e-15 * curve, color=BLUE, linewidth=1.2, label="the one parabola through them")
        axes.plot([0.0, 0.10, 0.30], 1e-15 * np.array(values), "o", color=INK, markersize=4.0)
        for where, value, name in zip((0.0, 0.10, 0.30), values, ("table", "mu-3", "N-2"), strict=True):
            below = name == "table"  # the dashed line passes above
            axes.annotate(name, (where, 1e-15 * value), (4, -14) if below else (6, 4), textcoords="offset points")
        case = Case(RECONSTRUCTED)
        split = np.diff(steady.frequencies(steady.modes(case, mu=mu)) ** 2)[..., 0] ** 2
        axes.plot(
            mu, 1e-15 * split, color=GREY, linewidth=1.0, linestyle=(0, (4, 2)), label="reconstructed, with slope"
        )
        axes.axhline(0.0, color=GREY, linewidth=0.6)
        axes.plot(theorems.PUBLISHED_ONSET, 0.0, "s", color=RED, markersize=6.0)
        axes.annotate("published onset 0.40", (0.40, 0.0), (-6, -12), textcoords="offset points", color=RED, ha="right")
        axes.annotate(
            f"{theorems.onset_from_frequencies():.3f}", (0.44, 0.0), (4, 8), textcoords="offset points", color=BLUE
        )
        axes.set(xlim=(0.0, 0.5), ylim=(-1.2, 10.0), xlabel="friction coefficient [-]")
        axes.set_ylabel("$(\\omega_2^2 - \\omega_1^2)^2$ [10$^{15}$ rad$^4$/s$^4$]")
        axes.set_title("modes meet where it vanishes")
        axes.legend(loc="upper right")
        return figure_of(axes)


def _mean(total: float | np.ndarray) -> Any:
    """A sum of two squared frequencies as their mean frequency [10^3 rad/s]."""
    return 1e-3 * np.sqrt(0.5 * total)


ALL = {"theorem_trace": trace, "theorem_damping": damping, "theorem_speed": load_and_speed, "theorem_onset": onset}


def solver(found: Any) -> "Figure":
    """Envelopes of a decay, exact and by the solver of 2011, on a logarithmic scale."""
    with drawing(MARGINS.panel(WIDTH, HEIGHT)) as axes:
        for each, colour, dash in zip(found, (INK, BLUE, RED), ("-", (0, (4, 2)), "-"), strict=True):
            middle = np.median(each.x[-200:])
            pieces = np.array_split(np.abs(each.x - middle), 50)
            times = [1e3 * float(np.mean(part)) for part in np.array_split(each.t, 50)]
            tops = [1e6 * float(np.max(part)) for part in pieces]
            axes.semilogy(times, tops, color=colour, linestyle=dash, linewidth=1.3, label=each.setting)
        axes.set(xlim=(0.0, 50.0), xlabel="time [ms]", ylabel="amplitude of x [µm]")
        axes.set_title("the solver's own damping, mu = 0.30")
        axes.legend(loc="lower left")
        return figure_of(axes)
