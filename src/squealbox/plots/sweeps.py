"""Figures of a sweep: one answer over the parameters of its space."""

from typing import TYPE_CHECKING, Any

import numpy as np

from squealbox.limit_cycles.pushes import DangerousPush
from squealbox.plots.dispatch import plot
from squealbox.plots.style import drawing, figure_of, line, note, quantity_label
from squealbox.studies import Sweep

if TYPE_CHECKING:
    from matplotlib.figure import Figure


def numeric_answers(found: Sweep) -> list[str]:
    """Names of the answers that are real numbers, one for each point of the space."""
    dims = found.dataset["outcome"].dims
    return [name for name in found.answers if found[name].dims == dims and found[name].dtype.kind in "fiub"]


@plot.register(Sweep)
def sweep_overview(found: Sweep, *, answer: str | None = None, title: str = "", axes: Any = None) -> "Figure":
    """One answer over the space: a line over one parameter, a map over two, sorted values over samples or more axes.

    `answer` names it, by default the first that is a number at each point. A sweep without one raises `ValueError`.
    """
    known = numeric_answers(found)
    name = answer or next(iter(known), "")
    if name not in known:
        raise ValueError(f"answer = {name!r}: expected one number a point, one of {', '.join(known) or 'none'}")
    about = found[name]
    label = quantity_label(name.replace("_", " "), _unit(about))
    values = np.asarray(about.values, dtype=float)
    names = [str(dim) for dim in about.dims if dim in found.dataset.coords]
    with drawing(axes, width=4.2 if values.ndim == 2 else None, height=3.0 if values.ndim == 2 else 2.6) as panel:
        if values.ndim == 2 and len(names) == 2:
            x, y = (found[dim] for dim in names)
            mesh = panel.pcolormesh(x.values, y.values, values.T, cmap="cividis", rasterized=True, shading="nearest")
            figure_of(panel).colorbar(mesh, ax=panel, pad=0.02).set_label(label)
            panel.set(xlabel=quantity_label(names[0], _unit(x)), ylabel=quantity_label(names[1], _unit(y)), title=title)
            return figure_of(panel)
        if values.ndim == 1 and len(names) == 1:
            along = found[names[0]]
            panel.plot(along.values, values, **line(0, marker=values.size < 60, count=values.size))
            panel.set(xlabel=quantity_label(names[0], _unit(along)))
        else:
            panel.plot(np.arange(values.size) + 1, np.sort(values.ravel()), **line(0))
            panel.set(xlabel="point, sorted by the answer")
        panel.set(ylabel=label, title=title)
        return figure_of(panel)


@plot.register(DangerousPush)
def search_for_a_push(found: DangerousPush, *, title: str = "", axes: Any = None) -> "Figure":
    """Smallest energy of a push that ends in a vibration, after each round of the search."""
    with drawing(axes, height=2.4) as panel:
        history = np.asarray(found.history)
        panel.semilogy(np.arange(history.size), history, **line(0, marker=True, count=history.size))
        panel.set(xlabel="round of the search", ylabel=quantity_label("smallest energy", "J"), title=title)
        note(panel, "each of these pushes was run and vibrates")
        return figure_of(panel)


def _unit(about: Any) -> str:
    unit = str(about.attrs.get("units", ""))
    return "" if unit in ("1", "-") else unit
