"""Measured friction coefficients with the laws fitted to them."""

from typing import TYPE_CHECKING

import numpy as np

from squealbox.fit import FrictionFit
from squealbox.plots.dispatch import drawn_by
from squealbox.plots.style import COLUMN, drawing, figure_of, line
from squealbox.words import quantity_label

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


@drawn_by.register(FrictionFit)
def friction_fit(fit: FrictionFit, *, title: str = "", axes: "Axes | None" = None) -> "Figure":
    """Points, the fitted curves, and the confidence band of the law with the least AIC."""
    with drawing(axes, width=1.4 * COLUMN, height=3.0) as panel:
        for place, row in enumerate(np.argsort(fit.aic, kind="stable")):
            if np.isfinite(fit.aic[row]):
                name = fit.names[row].replace("_", " ")
                look = {**line(place), "linewidth": 1.5 if place == 0 else 0.8}
                panel.plot(fit.curve_speeds, fit.curves[row], label=f"{name}, AIC {fit.aic[row]:.1f}", **look)
        if np.isfinite(fit.aic[fit.best]):
            band = (fit.low[fit.best], fit.high[fit.best])
            label = f"{100 * fit.settings['level']:g} % band of the first"
            panel.fill_between(fit.curve_speeds, *band, facecolor="#d9d9d9", edgecolor="none", label=label, zorder=0)
        panel.plot(fit.speeds, fit.values, "o", color="#D55E00", markersize=3, label="measured", zorder=3)
        panel.set_xlim(0.0, float(np.max(fit.speeds)) * 1.02)
        panel.set(xlabel=quantity_label("sliding speed", "m/s"), ylabel=quantity_label("friction coefficient µ", ""))
        panel.set_title(title)
        panel.legend(loc="best", fontsize=6)
        return figure_of(panel)
