"""Energy of a motion and the power of what feeds and damps it: friction, load, damping, a skew part of K."""

from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.matrices import form
from squealbox.schedules import Schedule
from squealbox.system import System, contact_state


def mechanical_energy(system: System, q: np.ndarray, qd: np.ndarray) -> Any:
    """Kinetic plus strain energy [J], 1/2 q'.M q' + 1/2 q.Ks q with Ks the symmetric part of K; shape (...)."""
    symmetric = 0.5 * (system.K + np.swapaxes(system.K, -1, -2))
    return 0.5 * form(qd, system.M, qd) + 0.5 * form(q, symmetric, q)


def power_of_friction(system: System, time: float | np.ndarray, q: np.ndarray, qd: np.ndarray) -> Any:
    """Power [W] each contact feeds into the vibration, (d.q') mu sgn(v) N, shape (..., contacts)."""
    _, _, forces = contact_state(system, time, q, qd)
    along = [np.sum(contact.d * qd, axis=-1) for contact in system.contacts]
    return np.stack(along, axis=-1) * forces if along else forces


def power_dissipated(system: System, qd: np.ndarray) -> Any:
    """Power [W] the damping takes out, q'.C q', shape (...)."""
    return form(qd, system.C, qd)


def power_of_circulation(system: System, q: np.ndarray, qd: np.ndarray) -> Any:
    """Power [W] fed in by the skew part Ka of the stiffness itself, -q'.Ka q, shape (...); 0 for a symmetric K."""
    skew = 0.5 * (system.K - np.swapaxes(system.K, -1, -2))
    return -form(qd, skew, q)


def power_of_load(system: System, time: ArrayLike, qd: np.ndarray) -> Any:
    """Power [W] of the load, q'.f(t), shape (...)."""
    if isinstance(system.load, Schedule):
        load = np.stack([np.asarray(system.load.value(t)) for t in np.ravel(time)])
        load = load.reshape(*np.shape(time), -1)
    else:
        load = system.load
    return np.sum(load * qd, axis=-1)
