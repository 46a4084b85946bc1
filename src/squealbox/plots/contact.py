"""Figure of a comparison of contact schemes: the motions over each other, and error against cost."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from squealbox.plots.dispatch import drawn_by
from squealbox.plots.style import drawing, figure_of, line, panels
from squealbox.transient import ContactComparison
from squealbox.words import quantity_label, scaled, unit_at

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@drawn_by.register(ContactComparison)
def contact_comparison(
    comparison: ContactComparison, *, periods: float = 3.0, axes: "Sequence[Axes] | None" = None
) -> "Figure":
    """The last `periods` [-] of every scheme, and the error of each against its number of evaluations.

    `axes` may give the two panels to draw in. A run read from a file has lost its motions: only the second panel is
    filled then.
    """
    first, second = panels(1, 2)[1] if axes is None else axes
    with drawing(first) as panel:
        _motions(panel, comparison, periods)
    with drawing(second) as panel:
        _costs(panel, comparison)
    return figure_of(first)


def _motions(panel: "Axes", comparison: ContactComparison, periods: float) -> None:
    dof = comparison.settings["dof"]
    runs = [(i, name, comparison.runs[name]) for i, name in enumerate(comparison.schemes) if name in comparison.runs]
    if not runs:
        panel.set_axis_off()
        return
    exact = runs[0][2]
    span = periods * comparison.period[0] if np.isfinite(comparison.period[0]) else 0.1 * np.ptp(exact.t)
    begin = max(exact.t[-1] - span, exact.t[0])
    late = exact.t >= begin
    factor, read = scaled(unit_at(exact.system, dof), exact.q[late, dof])
    second, clock = scaled("s", exact.t[late] - begin)
    for i, name, run in runs:
        shown = run.t >= begin
        panel.plot((run.t[shown] - begin) / second, run.q[shown, dof] / factor, label=name, **line(i))
    panel.set(xlabel=quantity_label("time in the last periods", clock), ylabel=quantity_label("displacement", read))
    panel.legend(loc="best")


def _costs(panel: "Axes", comparison: ContactComparison) -> None:
    for i, name in enumerate(comparison.schemes[1:], start=1):
        if np.isfinite(comparison.error[i]):
            look = {**line(i, marker=True), "linestyle": "none", "markevery": 1}
            panel.plot(comparison.evaluations[i], comparison.error[i], label=name, **look)
    panel.axvline(comparison.evaluations[0], label="cost of exact", **{**line(0), "linewidth": 0.8})
    panel.set(xscale="log", yscale="log", xlabel="evaluations of the right-hand side")
    panel.set(ylabel="error at the end of the run")
    panel.legend(loc="best")
