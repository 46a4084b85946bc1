"""The usual absolute tolerance: a share of the speed at which contacts slide, or else of that which a motion has."""

from functools import reduce
from typing import Any

import numpy as np

from squealbox.schedules import Schedule
from squealbox.system import InvalidSystem, System
from squealbox.transient.methods import Method

STANDING = 1e-12  # [m/s] a belt slower than that gives no scale for a tolerance, and what is free to move does


def absolute_tolerances(
    system: System, method: Method, highest: float | np.ndarray, start: tuple[Any, Any] | None = None
) -> Any:
    """atol (2n, ...) of the states: as given, or from the speed of the motion, scaled so that both kinds weigh alike.

    highest (...) : angular frequency [rad/s]
    start : q, q' (..., n), which tell the speed where nothing slides; None where they are not known
    """
    n = system.size
    if method.atol is not None and np.ndim(method.atol) == 1:
        if np.shape(method.atol) != (2 * n,):
            raise InvalidSystem(f"atol has shape {np.shape(method.atol)}: expected a number or {2 * n} values")
        return np.array(method.atol, dtype=float)
    highest = np.where(highest > 0.0, highest, 1.0)
    velocity = method.atol
    if velocity is None:
        speed = fastest_speed(system)
        if not np.all(speed > STANDING):
            speed = np.where(speed > STANDING, speed, free_speed(system, highest, start))
        velocity = 1e-3 * method.rtol * speed
    velocity, highest = np.broadcast_arrays(velocity, highest)
    return np.stack([velocity / highest] * n + [velocity] * n) if n else np.zeros((0, *np.shape(velocity)))


def fastest_speed(system: System) -> Any:
    """Fastest sliding speed [m/s]; one for each leading axis."""
    return reduce(np.maximum, (_largest(contact.V) for contact in system.contacts), np.zeros(()))


def free_speed(system: System, highest: float | np.ndarray, start: tuple[Any, Any] | None) -> Any:
    """Speed [m/s] of a motion in which nothing slides: that which start and load lead to, 1 where neither does."""
    heaviest = np.max(np.abs(system.M), axis=(-1, -2), initial=0.0)
    push = np.asarray(_largest(system.load))
    pushed = np.max(push, axis=-1) if push.ndim else push
    with np.errstate(divide="ignore", invalid="ignore"):
        found = np.where(heaviest > 0.0, pushed / (heaviest * highest), 0.0)
    if start is not None:
        q, qd = (np.max(np.abs(each), axis=-1, initial=0.0) for each in start)
        found = np.maximum(found, np.maximum(qd, highest * q))
    return np.where(found > 0.0, found, 1.0)


def _largest(value: Any) -> Any:
    """The largest size of a number or schedule among its beginning, its kinks and a quarter of its period."""
    if not isinstance(value, Schedule):
        return np.abs(value)
    with np.errstate(divide="ignore"):
        quarter = 0.5 * np.pi / np.asarray(value.angular_frequency(), dtype=float)
    instants = (0.0, *value.breaks(), np.where(np.isfinite(quarter), quarter, 0.0))
    return reduce(np.maximum, (np.abs(value.value(t)) for t in instants))
