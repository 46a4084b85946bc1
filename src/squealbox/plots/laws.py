"""Friction coefficient against sliding speed."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from squealbox.law import FrictionLaw
from squealbox.plots.dispatch import drawn_by
from squealbox.plots.style import drawing, figure_of, line
from squealbox.words import number, quantity_label

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from squealbox.plots.style import Panels


@drawn_by.register(FrictionLaw)
@drawn_by.register(Mapping)
def friction_curve(
    law: FrictionLaw | Mapping[str, FrictionLaw],
    *,
    upto: float = 1.0,
    operating: tuple[float, float] | None = None,
    speed: float | None = None,
    title: str = "",
    axes: "Panels | None" = None,
) -> "Figure":
    """mu(v) of one law, or of several given by name, up to a sliding speed [m/s].

    `upto` [m/s]: largest sliding speed drawn.

    `operating` [m/s] is a range of sliding speeds to shade, `speed` [m/s] the one of steady sliding, where the slope
    is written.
    """
    laws = law if isinstance(law, Mapping) else {"": law}
    speeds = np.linspace(0.0, upto, 401)
    with drawing(axes) as panel:
        if operating is not None:
            panel.axvspan(*operating, facecolor="#e6e6e6", edgecolor="none", label="operating range", zorder=0)
        for i, (name, each) in enumerate(laws.items()):
            look = line(i, marker=len(laws) > 1, count=speeds.size)
            label = name
            if speed is not None:
                label = f"{name}, slope {number(each.slope_at(speed), 3)} s/m".removeprefix(", ")
                panel.plot(speed, each.mu(speed), "o", color=look["color"], markersize=4.5, zorder=3)
            panel.plot(speeds, each.mu(speeds), label=label or None, **look)
        if speed is not None:
            panel.axvline(speed, color="#808080", linewidth=0.6, label=f"steady sliding, {number(speed, 3)} m/s")
        every = np.concatenate([np.ravel(each.mu(speeds)) for each in laws.values()])
        lowest, highest = float(np.min(every)), float(np.max(every))
        panel.set_xlim(0.0, upto)
        panel.set_ylim(bottom=min(0.0, 1.1 * lowest), top=1.1 * highest if highest > 0.0 else None)
        panel.set(xlabel=quantity_label("sliding speed", "m/s"), ylabel=quantity_label("friction coefficient µ", ""))
        panel.set_title(title)
        if panel.get_legend_handles_labels()[1]:
            panel.legend(loc="best")
        return figure_of(panel)
