"""What a reader must know of a run whose contacts left the range of their model, in a sentence each."""

from typing import Any

import numpy as np

from squealbox.schedules import value_at
from squealbox.system import Contact, System

PULLED = "it cannot open, and its friction then drives its sliding"
SPEEDS = 257  # at which a law is looked at


def pulled(contact: Contact, lowest: Any) -> Any:
    """Whether the least normal force [N] of a contact that cannot open is below zero by more than round-off."""
    size = float(np.max(np.abs(value_at(contact.N0, 0.0)))) + float(np.max(np.abs(contact.n), initial=0.0))
    return np.isfinite(lowest) & (np.asarray(lowest) < -1e-12 * size)


def of_a_run(system: System, lowest: Any, fastest: Any) -> list[str]:
    """Of one run, from the least normal force [N] and the largest sliding speed [m/s] of each contact."""
    said = []
    for c, (name, contact) in enumerate(zip(system.contact_names, system.contacts, strict=True)):
        if pulled(contact, lowest[c]):
            said.append(f"{name} is pulled, N down to {lowest[c]:.4g} N: {PULLED}")
        mu = float(np.min(contact.law.mu(np.linspace(0.0, float(fastest[c]), SPEEDS))))
        if mu < 0.0:
            said.append(
                f"{name} leaves the range of its friction law: mu down to {mu:.4g} at sliding speeds up to "
                f"{fastest[c]:.4g} m/s"
            )
        if contact.law.has_memory and np.any(contact.law.feeds(np.linspace(0.0, float(fastest[c]), SPEEDS))):
            said.append(
                f"{name}: at sliding speeds up to {fastest[c]:.4g} m/s the damping of its bristles is "
                "above 4 g/|v|, where they may feed energy in"
            )
    return said


def of_an_ensemble(system: System, lowest: Any) -> str:
    """Of many runs, from the least normal forces [N], shape (runs, contacts), NaN where there was no run."""
    said = []
    for c, (name, contact) in enumerate(zip(system.contact_names, system.contacts, strict=True)):
        which = pulled(contact, lowest[:, c])
        if np.any(which):
            least = float(np.min(lowest[which, c]))
            count = f"{int(np.sum(which))} of {len(which)} trajectories"
            said.append(f"{name} is pulled in {count}, N down to {least:.4g} N: {PULLED}")
    return "; ".join(said)
