"""The verdict in words: is steady sliding stable, by which mechanism is it lost, where, how far away is that?"""

from typing import Any

import numpy as np

from squealbox.cautions import pulled
from squealbox.designs import Design
from squealbox.stability import mechanism, sentences
from squealbox.system import equilibrium
from squealbox.words import quantity
from squealbox.workbench.panels.declared import Panel
from squealbox.workbench.panels.modes import crossings_of, modes_of
from squealbox.workbench.panels.panel import Answer, Options, Work, try_value

PANEL = Panel("Verdict")

LINEAR = ("Linear and about steady sliding: it says whether squeal can start, not how loud it gets; stable sliding can "
          "still squeal after a push.")  # fmt: skip
MERGE = "Two modes nearly merge here: growth rate and shares react strongly to small changes."


def answer(design: Design, options: Options, work: Work) -> Answer:
    """Headline, reasons and caveats; critical values of the chosen parameter and the margin to the nearest."""
    parameter = options.parameter("parameter", design, "friction.static")
    ends = options.span("span", design, parameter)
    axis, value, modes = options.axis(design, parameter, ends), try_value(design, parameter), modes_of(design)
    exists = bool(modes.exists)
    why = mechanism(design) if exists and not bool(modes.stable) else None
    data: dict[str, Any] = {
        "state": "unknown" if not exists else "unstable" if why else "stable",
        "headline": sentences.headline(modes, why),
        "why": [sentences.growth(modes, why)],
        "value": value,
    }
    if not exists:
        return Answer({**data, "caveats": LINEAR})
    system = design.system()
    bilateral = np.zeros(len(system.contacts), dtype=bool)  # an open unilateral contact has N = 0
    data["pulled"] = [list(each) for each in pulled(system.contact_names, bilateral, equilibrium(system).normal_force)]
    found = crossings_of(design, parameter, ends)
    data["crossings"] = [{"value": float(each.value), "changes": each.changes_stability} for each in found]
    if found.outcome.ok or found.changes:
        data["why"] += [" ", *sentences.margin(axis.label, value, found, ends, axis.value)]
    else:
        data["why"].append(f" {found.outcome.message}.")
    near = bool(np.any(modes.near_defective))
    data["caveats"] = " ".join([*_pulling(data["pulled"]), LINEAR, *([MERGE] if near else [])])
    return Answer(data)


def _pulling(pulled: list[Any]) -> list[str]:
    """A sentence on the contacts that pull in steady sliding."""
    named = ", ".join(f"{name} is pulled ({quantity(force, 'N')})" for name, force in pulled)
    return [f"{named}: a contact that cannot pull would lift off."] if named else []
