"""Who feeds a mode and who damps it: what each contact and damper brings to its growth rate."""

from typing import Any

import numpy as np

from squealbox.design import Design
from squealbox.figure_data import Bars
from squealbox.stability import mode_energy
from squealbox.words import number, quantity
from squealbox.workbench.frames import finite
from squealbox.workbench.panels.declared import Panel, Place, shared
from squealbox.workbench.panels.modes import modes_of, seen
from squealbox.workbench.panels.panel import Answer, Options, Work

PANEL = Panel(
    "Energy by contact", questions=("why",), figures=(Place("energy", bars=True),),
    choices=(shared("moving", "mode"),),
)  # fmt: skip

MOST_BARS = 24
LOOKS = {"normal force": "b0", "slope": "b1", "damping": "b2"}


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Bars [1/s] that add up to the growth rate of the mode that is seen to move, usually the one that grows first."""
    modes = modes_of(design)
    if not bool(modes.exists):
        return Answer(
            {"outcome": str(modes.outcome), "words": f"{modes.outcome.message}."}, figures=[Bars("energy", "", [])]
        )
    order, chosen = seen(design, options)
    parts = mode_energy(design, modes.mode(order[chosen]))
    per = 1.0 / (2.0 * parts.total)
    bars: list[dict[str, Any]] = []
    for i, name in enumerate(parts.contacts):
        circulation, slope = float(parts.circulation[i] * per), float(parts.slope[i] * per)
        bars.append(
            {
                "name": name,
                "parts": [(LOOKS["normal force"], circulation), (LOOKS["slope"], slope)],
                "sum": circulation + slope,
            }
        )
    for i, name in enumerate(parts.dofs):
        taken = -float(parts.dissipated[i] * per)
        bars.append({"name": f"damping of {name}", "parts": [(LOOKS["damping"], taken)], "sum": taken})
    if parts.structure:
        skew = float(parts.structure * per)
        bars.append({"name": "skew stiffness", "parts": [(LOOKS["normal force"], skew)], "sum": skew})
    bars.sort(key=lambda bar: -abs(bar["sum"]))
    growth, left = float(np.real(parts.eigenvalue)), len(bars[MOST_BARS:])
    hertz = quantity(abs(np.imag(parts.eigenvalue)) / (2.0 * np.pi), "Hz")
    words = f"Together {number(growth)} 1/s at {hertz}: to the right feeds the mode, to the left damps it."
    data = {
        "outcome": "completed",
        "growth": growth,
        "residual": finite(parts.residual),
        "words": f"{words} {left} smaller ones are not shown." if left else words,
    }
    legend = [(look, name) for name, look in LOOKS.items()]
    return Answer(data, figures=[Bars("energy", "share of the growth rate [1/s]", bars[:MOST_BARS], legend)])
