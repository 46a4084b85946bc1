"""Where a motion leaves the range of its model: friction that drives, contacts that pull, laws beyond their data."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from squealbox.contacts import numbered
from squealbox.friction import Table
from squealbox.schedules import value_at
from squealbox.system import System

SMALL = 0.25  # rad: beyond it sin differs from its angle by more than 1 %, and the equation knows only the angle
PULL = 1e-9  # of the largest normal force: less is round-off


def along(system: System, q: Any, qd: Any) -> tuple[str, ...]:
    """As :func:`out_of_range`, from the displacements and velocities (..., n) of a motion under constant N0 and V.

    Rotations beyond `SMALL` are said too: the equation is linear in them.

    >>> wheel = System([[1.0]], [[0.0]], [[1.0]], 0.0, (), names=("wheel_turn",))
    >>> along(wheel, [[0.5]], [[0.0]])
    ('wheel_turn turns by 28.6 deg: the equation is linear in rotations and holds for small ones',)
    """
    q, qd = np.atleast_2d(np.asarray(q, dtype=float)), np.atleast_2d(np.asarray(qd, dtype=float))
    n, _, t, _ = system.rows
    N0, V = (np.array([float(value_at(getattr(c, x), 0.0)) for c in system.contacts]) for x in ("N0", "V"))
    return (*out_of_range(system, N0 + q @ n.T, V - qd @ t.T), *turned(system, q))


def turned(system: System, q: Any) -> tuple[str, ...]:
    """A sentence for each rotation (..., n) that leaves the range of small angles."""
    most = np.max(np.abs(np.nan_to_num(np.atleast_2d(q))), axis=0, initial=0.0)
    return tuple(
        f"{name} turns by {np.rad2deg(size):.3g} deg: the equation is linear in rotations and holds for small ones"
        for name, size, unit in zip(system.names, most, system.units, strict=True)
        if unit == "rad" and size > SMALL
    )


PULLS = "{name}: N falls to {least:.4g} N: it would have to pull, where a unilateral contact lifts off"


def pulled(names: Sequence[str], unilateral: Any, normal_force: Any) -> tuple[tuple[str, float], ...]:
    """Name and N [N] of each bilateral contact that pulls in steady sliding, from tables (contacts,).

    >>> pulled(("pad", "shoe"), [False, True], [-2.0, 0.0])
    (('pad', -2.0),)
    """
    force = np.atleast_1d(np.asarray(normal_force, dtype=float))
    which = np.flatnonzero((force < 0.0) & ~np.asarray(unilateral, dtype=bool))
    return tuple((numbered(names)[i], float(force[i])) for i in which)


def pulling(names: Sequence[str], unilateral: Any, normal_force: Any) -> tuple[str, ...]:
    """A sentence for each contact that is `pulled`.

    >>> pulling(("pad", "shoe"), [False, True], [-2.0, 0.0])
    ('pad: N falls to -2 N: it would have to pull, where a unilateral contact lifts off',)
    """
    return tuple(PULLS.format(name=name, least=least) for name, least in pulled(names, unilateral, normal_force))


def out_of_range(system: System, normal_force: Any, sliding_velocity: Any) -> tuple[str, ...]:
    """Sentences on what a motion asks of its contacts that their model does not promise.

    Parameters
    ----------
    system : the system
    normal_force, sliding_velocity : shape (..., contacts) [N], [m/s], of steady sliding or along a motion

    A bilateral contact whose N falls below 0 pulls, a coefficient below 0 drives the sliding and does not oppose it; a
    table is constant beyond its last point, which nobody measured. Source: the equation in `squealbox.system`.

    >>> from squealbox import Contact, LinearSlope, System
    >>> pad = Contact(n=[0.0], d=[1.0], t=[1.0], N0=1.0, V=20.0, law=LinearSlope(0.45, -0.03))
    >>> out_of_range(System([[1.0]], [[0.0]], [[1.0]], 0.0, (pad,)), [1.0], [20.0])
    ('contact 1: friction is negative at 20 m/s (mu = -0.15) and drives the sliding: give the law a floor',)
    """
    normal = np.atleast_2d(np.asarray(normal_force, dtype=float))
    speed = np.atleast_2d(np.abs(np.asarray(sliding_velocity, dtype=float)))
    said: list[str] = []
    for i, contact in enumerate(system.contacts):
        name = system.contact_names[i]
        n, v = normal[..., i].ravel(), speed[..., i].ravel()
        n, v = n[np.isfinite(n)], v[np.isfinite(v)]
        least, most = float(np.min(n, initial=0.0)), float(np.max(np.abs(n), initial=0.0))
        if not contact.unilateral and least < -PULL * most:
            said.append(PULLS.format(name=name, least=least))
        if v.size == 0:
            continue
        fastest = float(np.max(v))
        if any(np.ndim(x) for x in contact.law.coefficients()):  # a family of laws, each at its own speed
            looked = np.abs(np.asarray(sliding_velocity, dtype=float)[..., i])
        else:
            looked = np.linspace(0.0, fastest, 65) if v.size > 1 else v
        mu = np.asarray(contact.law.mu(looked), dtype=float)
        least_mu = float(np.nanmin(mu))
        if least_mu < 0.0:
            at = float(np.broadcast_to(looked, mu.shape).flat[int(np.nanargmin(mu))])
            said.append(f"{name}: friction is negative at {at:.4g} m/s (mu = {least_mu:.4g}) and drives the sliding: "
                        "give the law a floor")  # fmt: skip
        if isinstance(contact.law, Table) and fastest > float(np.max(contact.law.speeds)) * (1.0 + 1e-12):
            known = float(np.max(contact.law.speeds))
            said.append(f"{name}: it slides at {fastest:.4g} m/s, beyond the law's data, which end at {known:.4g} m/s")
    return tuple(said)
