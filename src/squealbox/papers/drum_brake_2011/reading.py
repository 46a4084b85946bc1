"""Everything about one reading: its findings by every road, its runs raw beside exact, and its figures."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.papers.drum_brake_2011 import by_eigenvalues, by_transients, ensemble_figures, ensembles, figures, steady
from squealbox.papers.drum_brake_2011.cases import DEFAULT_READING, FRICTION, INFERRED, RECONSTRUCTED, Case
from squealbox.papers.drum_brake_2011.claims import EIGENVALUES, EXACT, RAW, Finding
from squealbox.papers.drum_brake_2011.motions import FRICTION as FRICTION_RUNS
from squealbox.papers.drum_brake_2011.motions import LOAD as LOAD_RUNS
from squealbox.papers.drum_brake_2011.motions import RUNS, Motion, Studies, distance, doubt, studies
from squealbox.plots import save as saved_figure
from squealbox.plots import styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ALONG_FRICTION = (DEFAULT_READING, "eq3")  # readings with a diagram of the maxima over friction
DOTS = 160  # per inch
MAP_FRICTION = (FRICTION, 0.35)  # the paper compares its map with one measured at 0.35
WHOLE_STUDY = {RECONSTRUCTED: (FRICTION_RUNS, LOAD_RUNS)}  # readings whose figures show every run
Drawer = Callable[[], "Figure"]


def study(case: Case, folder: Path, sizes: ensembles.Sizes = ensembles.USUAL) -> dict[str, Any]:
    """Findings, runs, shares of maps and figure files of one case, as plain data; figures are written to `folder`."""
    friction, load = WHOLE_STUDY.get(case.reading, (figures.FRICTION_SHOWN, figures.LOAD_SHOWN))
    shown = (FRICTION, 0.40) if case.reading in INFERRED else MAP_FRICTION  # they meet their onset at 0.40
    maps = {mu: steady.pressure_map(case, mu=mu, traced=mu == FRICTION) for mu in shown}
    found = {EIGENVALUES: by_eigenvalues.findings(case, maps[FRICTION])}
    drawn: dict[str, Drawer] = {
        "fig5": lambda: figures.coalescence(case),
        "fig9": lambda: figures.pressure_maps(maps),
    }
    runs: list[dict[str, Any]] = []
    shares: list[dict[str, Any]] = []
    if case.has_contacts:
        raw, exact = studies(case, RAW), studies(case, EXACT)
        found |= {RAW: by_transients.findings(raw, exact), EXACT: by_transients.findings(exact)}
        runs = _runs(raw, exact)
        drawn |= {
            "fig3": lambda: figures.time_series(friction, raw, exact),
            "fig4": lambda: figures.phase_planes(friction, raw, exact),
            "fig6": lambda: figures.time_series(load, raw, exact),
            "fig7": lambda: figures.phase_planes(load, raw, exact),
            "fig8": lambda: figures.braking(raw, exact),
        }
        if case.reading in sizes.mapped:
            more, shares = _ensembles(case, sizes)
            drawn |= more
    else:
        found |= {RAW: by_transients.without_contacts(), EXACT: by_transients.without_contacts()}
    with styled(), figures.on_the_same_sheets():
        for name, draw in sorted(drawn.items()):
            save(draw(), folder / name, ("png", "svg") if sizes.vector else ("png",))
    plain = {road: _plain(each) for road, each in found.items()}
    return {"findings": plain, "amplitude": case.amplitude, "runs": runs, "shares": shares, "figures": sorted(drawn)}


def _ensembles(case: Case, sizes: ensembles.Sizes) -> tuple[dict[str, Drawer], list[dict[str, Any]]]:
    """Figures of the maps by transients, and the share of each of their kinds."""
    centres = ensembles.pressure(case, sizes.pressure)
    drawn: dict[str, Drawer] = {"maps_pressure": lambda: ensemble_figures.pressure(centres)}
    maps = {"centres of pressure": centres}
    if case.reading in sizes.planes:
        load, speed = (each(case, sizes.plane) for each in (ensembles.friction_and_load, ensembles.friction_and_speed))
        maps |= {"friction and load": load, "friction and speed": speed}
        drawn["maps_friction"] = lambda: ensemble_figures.planes(load, speed)
    if case.reading in ALONG_FRICTION:
        over, onset = ensembles.maxima(case, sizes.friction), steady.onset_in_friction(case).value
        drawn["maxima"] = lambda: ensemble_figures.maxima(case, over, onset)
    return drawn, [
        {"map": name, "points": each.kind.size, "run": int(np.sum(each.run)), "shares": each.shares}
        for name, each in maps.items()
    ]


def save(figure: "Figure", path: Path, formats: tuple[str, ...] = ("png", "svg")) -> None:
    """Write the figure as PNG and SVG, with plain numbers at the ticks and titles in their place.

    Numbers as formulas, and titles that look for room above the ticks, would take longer than all the rest.
    """
    from matplotlib.ticker import ScalarFormatter

    path.parent.mkdir(parents=True, exist_ok=True)
    for axis in (axis for axes in figure.axes for axis in (axes.xaxis, axes.yaxis)):
        formatter = axis.get_major_formatter()
        if isinstance(formatter, ScalarFormatter):
            formatter.set_useMathText(False)
    with styled():
        for axes in figure.axes:
            axes.set_title(axes.get_title(), y=1.0)
    saved_figure(figure, path, formats, dots=DOTS)


def _plain(found: dict[str, Finding]) -> dict[str, Any]:
    return {key: {"value": each.value, "note": each.note, "trusted": each.trusted} for key, each in found.items()}


def _runs(raw: Studies, exact: Studies) -> list[dict[str, Any]]:
    return [
        {
            "run": str(run),
            "raw": _run(raw[run]),
            "exact": _run(exact[run]),
            "distance": distance(raw[run], exact[run]),
            "doubt": doubt(raw[run], exact[run]),
        }
        for run in RUNS
    ]


def _run(motion: Motion) -> dict[str, Any]:
    trajectory = motion.trajectory
    return {
        "outcome": str(trajectory.outcome),
        "verdict": motion.words,
        "amplitude": 1e3 * motion.amplitude,
        "growth_rate": float(motion.verdict.growth_rate) if motion.verdict else np.nan,
        "steps": int(trajectory.steps + trajectory.rejected),
        "events": len(trajectory.event_time),
    }
