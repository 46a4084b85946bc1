"""Who feeds the mode that grows first and who damps it: what each contact and damper brings to its growth rate."""

from typing import Any

import numpy as np

from squealbox.designs import Design
from squealbox.stability import mode_energy
from squealbox.workbench.frames import finite
from squealbox.workbench.panels.modes import modes_of
from squealbox.workbench.panels.panel import Answer, Options, Work

MOST_BARS = 24


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Bars [1/s] that add up to the growth rate of the mode with the largest one."""
    modes = modes_of(design)
    if not bool(modes.exists):
        return Answer({"outcome": str(modes.outcome), "message": modes.outcome.message, "bars": []})
    parts = mode_energy(design, modes.most_unstable)
    per = 1.0 / (2.0 * parts.total)
    bars: list[dict[str, Any]] = []
    for i, name in enumerate(parts.contacts):
        circulation, slope = float(parts.circulation[i] * per), float(parts.slope[i] * per)
        bars.append({"name": name, "parts": {"normal force": circulation, "slope": slope}, "sum": circulation + slope})
    for i, name in enumerate(parts.dofs):
        taken = -float(parts.dissipated[i] * per)
        bars.append({"name": f"damping of {name}", "parts": {"damping": taken}, "sum": taken})
    if parts.structure:
        skew = float(parts.structure * per)
        bars.append({"name": "skew stiffness", "parts": {"normal force": skew}, "sum": skew})
    bars.sort(key=lambda bar: -abs(bar["sum"]))
    data = {
        "outcome": "completed",
        "growth": float(np.real(parts.eigenvalue)),
        "frequency": float(abs(np.imag(parts.eigenvalue)) / (2.0 * np.pi)),
        "residual": finite(parts.residual),
        "bars": bars[:MOST_BARS],
        "left": len(bars[MOST_BARS:]),
    }
    return Answer(data)
