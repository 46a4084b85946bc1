"""The verdict in words: is steady sliding stable, by which mechanism is it lost, where, how far away is that?"""

from typing import Any

import numpy as np

from squealbox.cautions import pulled, pulling
from squealbox.design import Design
from squealbox.stability import LINEAR, MERGE, growth_in_words, headline, margin_in_words, mechanism
from squealbox.system import equilibrium
from squealbox.workbench.panels.declared import OVER, Panel
from squealbox.workbench.panels.modes import crossings_of, modes_of
from squealbox.workbench.panels.panel import Answer, Options, Work, try_value

PANEL = Panel("Verdict")


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Headline, reasons and caveats; critical values of the chosen parameter and the margin to the nearest."""
    parameter, ends = options.over(design, OVER)
    axis, value, modes = options.axis(design, parameter, ends), try_value(design, parameter), modes_of(design)
    exists = bool(modes.exists)
    why = mechanism(design) if exists and not bool(modes.stable) else None
    data: dict[str, Any] = {
        "state": "unknown" if not exists else "unstable" if why else "stable",
        "headline": headline(modes, why),
        "why": [growth_in_words(modes, why)],
        "value": value,
    }
    if not exists:
        return Answer({**data, "caveats": LINEAR})
    system = design.system()
    bilateral = np.zeros(len(system.contacts), dtype=bool)  # an open unilateral contact has N = 0
    contacts = (system.contact_names, bilateral, equilibrium(system).normal_force)
    data["pulled"] = [list(each) for each in pulled(*contacts)]
    found = crossings_of(design, parameter, ends)
    data["crossings"] = [{"value": float(each.value), "changes": each.changes_stability} for each in found]
    if found.outcome.ok or found.changes:
        data["why"] += [" ", *margin_in_words(axis.label, value, found, ends, axis.value)]
    else:
        data["why"].append(f" {found.outcome.message}.")
    near = bool(np.any(modes.near_defective))
    data["caveats"] = " ".join([*map("{}.".format, pulling(*contacts)), LINEAR, *[MERGE] * near])
    return Answer(data)
