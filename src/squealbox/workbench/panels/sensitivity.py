"""Which parameter to change: what one per cent more of each does to the growth rate of the mode that grows first."""

import numpy as np

from squealbox.designs import Design
from squealbox.stability import sensitivity
from squealbox.workbench.frames import finite
from squealbox.workbench.panels.modes import modes_of
from squealbox.workbench.panels.panel import Answer, Options, Work

MOST_BARS = 16
ROUND_OFF = 1e-12  # of the eigenvalue: smaller changes of its real part are none


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Change of growth rate [1/s] and frequency [Hz] for one per cent more of each parameter, the strongest first."""
    modes = modes_of(design)
    if not bool(modes.exists):
        return Answer({"outcome": str(modes.outcome), "message": modes.outcome.message, "bars": []})
    try:
        found = sensitivity(design)
    except ValueError as error:  # no steady sliding beside the design
        return Answer({"outcome": "no_derivative", "message": str(error), "bars": []})
    turn = np.sign(np.imag(found.eigenvalue)) / (2.0 * np.pi)
    change = 0.01 * found.values * found.first
    none = ROUND_OFF * abs(found.eigenvalue)
    order = [i for i in np.argsort(-np.abs(change.real), kind="stable") if abs(change[i].real) > none]
    bars = [
        {
            "name": found.parameters[i],
            "growth": float(change[i].real),
            "frequency": float(turn * change[i].imag),
            "value": float(found.values[i]),
        }
        for i in order[:MOST_BARS]
    ]
    data = {
        "outcome": "completed",
        "bars": bars,
        "growth": float(np.real(found.eigenvalue)),
        "condition": finite(found.condition),
        "near": found.near_defective,
    }
    return Answer(data)
