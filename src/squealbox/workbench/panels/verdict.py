"""The verdict in words: is steady sliding stable, by which mechanism is it lost, where, how far away is that?"""

from typing import Any

import numpy as np

from squealbox.cautions import pulled
from squealbox.designs import Design
from squealbox.stability import critical_values, mechanism
from squealbox.system import equilibrium
from squealbox.workbench.frames import finite
from squealbox.workbench.panels.modes import modes_of
from squealbox.workbench.panels.panel import Answer, Options, Work, axis_of, try_value

POINTS, COARSE = 201, 21  # of brakes of few and of many degrees of freedom
FEW = 40


def answer(design: Design, options: Options, work: Work) -> Answer:
    """State, mechanism, critical values of the chosen parameter, and margin to the nearest."""
    parameter = options.parameter("parameter", design, "friction.static")
    low, high = options.span("span", design, parameter)
    modes = modes_of(design)
    axis = axis_of(design, parameter)
    data: dict[str, Any] = {"axis": axis, "value": try_value(design, parameter), "span": [low, high]}
    if not bool(modes.exists):
        return Answer({**data, "state": "unknown", "reason": modes.outcome.message})
    worst = modes.most_unstable
    system = design.system()
    bilateral = np.zeros(len(system.contacts), dtype=bool)  # an open unilateral contact has N = 0
    data["pulled"] = [list(each) for each in pulled(system.contact_names, bilateral, equilibrium(system).normal_force)]
    data |= {"growth": worst.growth_rate, "frequency": worst.frequency, "damping": finite(worst.damping_ratio)}
    data["near"] = bool(np.any(modes.near_defective))
    if bool(modes.stable):
        data["state"] = "stable"
    else:
        why = mechanism(design)
        data |= {
            "state": "unstable",
            "mechanism": why.name,
            "flutterShare": finite(why.flutter_share),
            "modes": min(int(modes.unstable_modes), modes.eigenvalues.shape[-1] // 2),
        }
    found = critical_values(design, parameter, (low, high), points=POINTS if system.size <= FEW else COARSE)
    data["crossings"] = [
        {
            "value": float(each.value),
            "direction": each.direction,
            "mechanism": each.mechanism,
            "frequency": each.frequency,
            "changes": each.changes_stability,
        }
        for each in found
    ]
    data["noCrossing"] = "" if found.outcome.ok else found.outcome.message
    return Answer(data)
