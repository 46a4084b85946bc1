"""What an event does to a small disturbance: saltation matrices.

At an event h(x) = 0 the motion passes from x' = f- to x' = f+ with x continuous. A disturbance dx reaches h = 0 by
dt = -h_x dx / (h_x f-) later, so it leaves as dx + (f- - f+) dt, that is by

    S = I + (f+ - f-) h_x' / (h_x . f-)

slip -> stick   h = v = V - t.q'      h_x = (0, -t).  f+ keeps v = 0, so h_x S = 0: S is singular, and the cycle has a
                                       multiplier 0; what led up to the stop is forgotten
stick -> slip   h = mu_s N -+ F       F the force that holds; h_x by the field's derivative. f+ = f- and S = I when the
                                       law begins at its static limit; with static > kinetic friction S differs from I
reversal        h = v                 the same as the first, with f+ slipping the other way: S is regular
lift-off, landing   h = N             h_x = (n, 0); friction mu N and reaction vanish with N, so f+ = f- and S = I

Where the equation and h depend on a parameter p, the motion's derivative by p gains (f+ - f-) h_p / (h_x . f-) more.

Sources: Leine and Nijmeijer 2004, Dynamics and Bifurcations of Non-Smooth Mechanical Systems, Springer, Ch. 7 (S for
Filippov systems); di Bernardo, Budd, Champneys and Kowalczyk 2008, Piecewise-smooth Dynamical Systems, Springer, Ch. 2.
"""

from typing import Any

import numpy as np

from squealbox.limit_cycles.cycles.field import OPEN, Field


def surface(field: Field, x: np.ndarray, before: np.ndarray, contact: int) -> tuple[float, float, Any]:
    """The event function h of a contact in its mode before the event, its size, and h_x, shape (2n,)."""
    n = field.size
    normal, speed = field.contact_state(x)
    if before[contact] == 0:
        force, gradient = field.holding_force(x, before, contact)
        limit = field.static[contact] * normal[contact]
        full = np.concatenate([field.static[contact] * field.n[contact], np.zeros(n)]) - np.sign(force) * gradient
        return float(limit - abs(force)), float(abs(limit)), full
    if before[contact] == OPEN or (field.unilateral[contact] and abs(speed[contact]) > 1e-9 * abs(field.V[contact])):
        size = abs(field.N0[contact]) + np.abs(field.n[contact]) @ np.abs(x[:n])
        return float(normal[contact]), float(size), np.concatenate([field.n[contact], np.zeros(n)])
    size = abs(field.V[contact]) + np.abs(field.t[contact]) @ np.abs(x[n:])
    return float(speed[contact]), float(size), np.concatenate([np.zeros(n), -field.t[contact]])


def saltation(
    field: Field, x: np.ndarray, before: np.ndarray, after: np.ndarray,
    beside: tuple[Field, Field, float] | None = None, rates: tuple[Any, Any] | None = None,
) -> tuple[Any, float, int]:  # fmt: skip
    """S (2n, 2n) at state x between two sets of modes, the event's rate h_x.f- scaled by |h_x||f-|, and its contact.

    With `beside`, the fields at two values of a parameter and their distance, S is (2n + 1, 2n + 1), p its last state.
    rates : x' before and after, where they are known.
    When contacts change together, the one whose own event function is nearest to zero is taken for the cause. A rate
    near zero means grazing: S then grows without bound.
    """
    changed = np.flatnonzero(np.not_equal(before, after))
    surfaces = [surface(field, x, before, int(c)) for c in changed]
    cause = int(np.argmin([abs(value) / (size + 1e-300) for value, size, _ in surfaces]))
    gradient = surfaces[cause][2]
    f_before, f_after = rates or (field.rate(x, before), field.rate(x, after))
    rate = float(gradient @ f_before)
    size = float(np.linalg.norm(gradient / field.scale) * np.linalg.norm(field.scale * f_before))
    if beside is not None:
        low, high = (surface(each, x, before, int(changed[cause]))[0] for each in beside[:2])
        gradient = np.append(gradient, (high - low) / beside[2])
    matrix = np.eye(len(gradient))
    matrix[: 2 * field.size] += np.outer(f_after - f_before, gradient) / rate
    return matrix, rate / (size + 1e-300), int(changed[cause])
