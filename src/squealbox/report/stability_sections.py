"""The sections of a page about stability: modes, onset, ranking, energy, and the map over two parameters."""

from collections.abc import Iterator
from dataclasses import replace
from typing import Any

import numpy as np

from squealbox import plots
from squealbox.figure_data import FigureAxis, upright
from squealbox.plots import map_over_two, modes_over_parameter, unstable_stretches, upper_branches
from squealbox.report import tables, words
from squealbox.report.blocks import Chart, Section, Text
from squealbox.report.examination import Examination
from squealbox.report.pictures import picture, why_not
from squealbox.report.vibrating import vibrating


def stability(found: Examination) -> Iterator[Any]:
    """Modes, what becomes of them over a parameter, which parameter to change, and where the energy comes from."""
    if not found.modes.exists:
        yield Text(found.missing.get("stability", "there is no steady sliding"))
        return
    yield tables.modes(found.modes) if found.mode_table is None else tables.modes_in_band(found.mode_table)
    moving = vibrating(found.design, found.modes)
    if moving is not None:
        yield moving
    yield picture(plots.plot(found.modes), "Eigenvalues. To the right of the line a mode grows.")
    if found.varied is not None and found.spectra is not None:
        yield _coalescence(found)
    if found.ranking is not None:
        yield Section("Which parameter to change", (
            picture(plots.plot(found.ranking), "Change of the growth rate for one per cent more of each parameter."),
            tables.ranking(found, found.ranking),
        ))  # fmt: skip
    if found.energy is not None:
        fed = found.energy if len(found.energy.contacts) <= tables.MOST_CONTACTS else found.energy.by_group()
        yield Section("Where the energy comes from", (
            picture(plots.plot(fed), "What each contact and damper adds to the worst growth rate."),
            tables.energy(fed),
        ))  # fmt: skip
    yield from why_not(found, "error bars", "ranking", "energy", "onset")


def _coalescence(found: Examination) -> Chart:
    varied, spectra = found.varied, found.spectra
    if varied is None or spectra is None:
        raise TypeError("no parameter was varied")
    factor, unit = words.in_reading_unit(found, varied.name)
    inputs = np.sort(np.append(varied.values, found.crossings.value if found.crossings is not None else []))
    figure = plots.coalescence(factor * inputs, spectra, name=varied.name, unit=unit)
    here = factor * found.present
    for panel in figure.axes:
        panel.axvline(here, color="#000000", linewidth=0.7, linestyle=":")
    caption = f"Frequencies and growth rates over {varied.name}; hatched or shaded: unstable; broken line: this design."
    axis = FigureAxis(varied.name, unit, (factor * inputs[0], factor * inputs[-1]), varied.name, 1.0 / factor)
    worst = np.fmax.reduce(np.real(spectra.eigenvalues), axis=-1)
    unstable = unstable_stretches(factor * inputs, worst)
    moving = modes_over_parameter(axis, factor * inputs, upper_branches(spectra), unstable)[:2]
    return Chart(picture(figure, caption), [replace(each, layers=[*each.layers, upright(here)]) for each in moving])


def cures(found: Examination) -> Iterator[Any]:
    """The cures that leave the least squeal, the best first."""
    if found.remedies is not None:
        yield tables.cures(found.remedies)
        yield Text(found.remedies.assumption)
    yield from why_not(found, "cures")


def map_of_two(found: Examination) -> Iterator[Any]:
    """The map over two parameters with the boundary and the design in it."""
    plane, grid, boundary = found.plane, found.map, found.boundary
    if plane is not None and grid is not None and boundary is not None:
        names, factors, units = (plane.x.name, plane.y.name), [], []
        for name in names:
            factor, unit = words.in_reading_unit(found, name)
            factors.append(factor)
            units.append(unit)
        x, y = (factor * np.asarray(values) for factor, values in zip(factors, grid.axes.values(), strict=True))
        curves = [points * factors for points in boundary.curves]
        here = tuple(factor * float(found.design.value_of(name)) for factor, name in zip(factors, names, strict=True))
        look = {"x_name": names[0], "x_unit": units[0], "y_name": names[1], "y_unit": units[1]}
        figure = plots.stability_map(x, y, grid.growth_rate.T, curves=curves, **look)
        figure.axes[0].plot(*here, "x", color="#000000", markersize=7, markeredgewidth=2.0)
        axes = [
            FigureAxis(name, unit, (float(values[0]), float(values[-1])), name, 1.0 / factor)
            for name, unit, values, factor in zip(names, units, (x, y), factors, strict=True)
        ]
        caption = (
            f"Growth rate over {names[0]} and {names[1]}, its boundary exact on the grid; the mark is this design."
        )
        moving = map_over_two(axes[0], axes[1], grid.growth_rate.T, grid.frequency.T, curves, (here[0], here[1]))
        yield Chart(picture(figure, caption), [moving])
        yield Text(f"{grid.summary()}.".replace("\n", "; "))
    yield from why_not(found, "map")
