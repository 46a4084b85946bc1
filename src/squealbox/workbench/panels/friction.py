"""The friction curve of each law, the speeds at which the contacts slide, and the range a squealing motion passes."""

from typing import Any

import numpy as np

from squealbox.designs import Design
from squealbox.system import linearise
from squealbox.workbench.frames import finite
from squealbox.workbench.panels.panel import Answer, Options, Work

POINTS = 241


def answer(design: Design, options: Options, work: Work) -> Answer:
    """mu(|v|) of the first contact's law, and coefficient, slope and lost damping of each contact at steady sliding."""
    system = design.system()
    steady = linearise(system)
    state = steady.equilibrium
    speeds = np.abs(state.sliding_speed)
    top = 2.5 * float(np.max(speeds, initial=0.0)) or 1.0
    v = np.linspace(0.0, top, POINTS)
    laws: list[Any] = []
    for contact in system.contacts:
        if contact.law not in laws:
            laws.append(contact.law)
    curves = np.array([np.broadcast_to(law.mu(v), v.shape) for law in laws]) if laws else np.zeros((0, POINTS))
    contacts = [
        {
            "name": system.contact_names[i],
            "law": laws.index(contact.law),
            "speed": finite(state.sliding_speed[i]),
            "mu": finite(contact.law.mu(state.sliding_speed[i])),
            "slope": finite(contact.law.slope_at(state.sliding_speed[i])),
            "normal": finite(state.normal_force[i]),
        }
        for i, contact in enumerate(system.contacts)
    ]
    data = {
        "contacts": contacts,
        "laws": [type(law).__name__ for law in laws],
        "static": [finite(law.static_limit) for law in laws],
        "outcome": str(steady.equilibrium.outcome),
        "message": steady.equilibrium.outcome.message,
    }
    return Answer(data, {"speed": v, "mu": curves})
