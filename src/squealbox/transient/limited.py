"""Loops in time. A velocity loop with a limit is a contact without sliding speed: its force is a law of its speed.

    u = sat(R . q')  acts along b    is    mu(|v|) sgn(v) along b,  v = R . q'/|R|,  mu(v) = min(|R| v, limit),  N = 1

so every engine takes it, exact contact, ensembles and limit cycles included; it never sticks, its static limit is 0.
"""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.law import NEVER_STICKS, FrictionLaw
from squealbox.parameters import parameter
from squealbox.system import Contact, System
from squealbox.transient.widened import RunApart, widened


class Limited(FrictionLaw):
    """mu = min(gain |v|, limit): the force of a velocity loop with a limit, as a law with N = 1 N.

    >>> [float(Limited(0.3, 1.0).mu(v)) for v in (1.0, 10.0)]
    [0.3, 1.0]
    """

    gain: float = parameter("s/m", 0.0, meaning="rise with speed")
    limit: float = parameter("-", 0.0, meaning="largest value")

    def coefficients(self) -> tuple[Any, ...]:
        return (NEVER_STICKS, self.gain, self.limit)

    def mu(self, velocity: ArrayLike) -> Any:
        return np.minimum(self.gain * np.abs(velocity), self.limit)

    def slope_at(self, velocity: ArrayLike) -> Any:
        return self.gain * (self.gain * np.abs(velocity) < self.limit)

    @property
    def texts(self) -> tuple[str, str]:
        """The source of the law and its slope, for the compiled engines."""
        mu = "def mu(v, p):\n    return np.minimum(p[1] * v, p[2])\n"
        return mu, "def slope(v, p):\n    return p[1] * (p[1] * v < p[2])\n"


def in_time(system: System, delays: bool = False) -> System:
    """The system whose loops are all rows or contacts, with rows for all it remembers; with `delays` those too.

    Raises `RunApart` for a loop that is run in pieces.
    """
    contacts, others = list(system.contacts), []
    for i, loop in enumerate(system.loops):
        rows = loop.rows(system.names)
        if delays and loop.sampling is None and not loop.linear:
            others.append(loop)
            continue
        if not loop.linear:
            what = "sampling" if loop.sampling is not None else "a delay"
            raise RunApart(f"loops[{i}] has {what}: expected loops without; simulate() runs it, piece by piece")
        if rows.memory or np.any(rows.P) or np.ndim(rows.R) > 1:
            others.append(loop)
            continue
        gain = float(np.linalg.norm(rows.R))
        if gain == 0.0:
            continue
        still = np.zeros(system.size)
        law = Limited(gain, float(loop.limit or 0.0))
        contacts.append(Contact(still, rows.b, -rows.R / gain, 1.0, 0.0, law, name=f"loop on {loop.on}"))
    return widened(system.replace(loops=tuple(others), contacts=tuple(contacts)) if system.loops else system)
