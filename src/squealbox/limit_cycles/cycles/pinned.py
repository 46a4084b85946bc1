"""Systems whose bodies may move together: the common motion is held, exactly and without touching the motion beside it.

Let R span the motions without a spring, a damper or a contact that feels them and without a force that drives them:
K R = C R = 0, n R = t R = 0, R' K = R' C = 0, R' d = R' f = 0. With symmetric M the coordinates y = R' M q obey
y'' = 0 whatever else happens, and

    K + b M R (R' M R)^-1 R' M,  C + c M R (R' M R)^-1 R' M

change nothing but y'' + c y' + b y = 0. So cycles have one place to be, and Newton's method a regular matrix. What the
springs bring is left out of every result: multipliers and exponents are those of the motion with R' M q = 0.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from squealbox.schedules import Schedule, value_at
from squealbox.system import System

FELT = 1e-12  # share of the largest entry below which a motion is not felt


def pinned(system: System, frequency: float) -> tuple[System, Any]:
    """The system with its common motions held by about `frequency` [rad/s], and a basis (n, n - held) of the rest.

    Without such a motion the system is returned as it is, with the unit matrix.
    """
    n, mass = system.size, np.asarray(system.M)
    motions = _common(system)
    weighted = mass @ motions
    inertia = motions.T @ weighted
    if motions.shape[1] == 0 or not np.allclose(mass, mass.T, rtol=1e-12) or np.linalg.cond(inertia) > 1e12:
        return system, np.eye(n)
    held = weighted @ np.linalg.solve(inertia, weighted.T)
    rate = frequency or 1.0
    rest = np.linalg.svd(weighted.T)[2][motions.shape[1] :].T
    return replace(system, K=system.K + 2.0 * rate**2 * held, C=system.C + 3.0 * rate * held), rest


def at_rest_together(system: System) -> System:
    """The system with its common motions held, as starts and attractors are asked for; one that varies, as it is."""
    if system.shape or isinstance(system.load, Schedule):
        return system
    rate = float(np.sqrt(np.max(np.abs(system.K)) / (np.max(np.abs(system.M)) or 1.0)))
    return pinned(system, rate)[0]


def _common(system: System) -> Any:
    """Basis (n, held) of the motions that nothing feels and nothing drives."""
    contacts = system.contacts
    stiff = np.linalg.svd(system.K, compute_uv=False)
    if len(stiff) and stiff[-1] > FELT**0.5 * stiff[0]:  # springs feel every motion
        return np.zeros((system.size, 0))
    felt = [system.K, system.C]
    felt += [np.atleast_2d(getattr(c, name)) for c in contacts for name in ("n", "t", "across")
             if getattr(c, name) is not None]  # fmt: skip
    driven = [np.transpose(system.K), np.transpose(system.C), np.atleast_2d(value_at(system.load, 0.0))]
    driven += [np.atleast_2d(getattr(c, name)) for c in contacts for name in ("d", "normal")
               if getattr(c, name) is not None]  # fmt: skip
    rows = np.vstack([part / (np.max(np.abs(part)) or 1.0) for part in (*felt, *driven)])
    _, sizes, v = np.linalg.svd(rows)
    return v[int(np.sum(sizes > FELT * max(sizes[0], 1e-300))) :].T
