"""Where a motion leaves the range of its model: friction that drives, contacts that pull, laws beyond their data."""

import math
from collections.abc import Sequence
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from squealbox.contacts import numbered
from squealbox.friction import Table
from squealbox.loops import Loop, highest_rate
from squealbox.schedules import value_at
from squealbox.system import Contact, System

SPEEDS = np.linspace(0.0, 1.0, 65)  # of the fastest sliding, at which a law is looked at
SMALL = 0.25  # rad: beyond it sin differs from its angle by more than 1 %, and the equation knows only the angle
COARSE = 1e-10  # of a run's duration: instants known no better are told
PULL = 1e-9  # of the largest normal force: less is round-off


def along(system: System, q: ArrayLike, qd: ArrayLike) -> tuple[str, ...]:
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


def turned(system: System, q: ArrayLike) -> tuple[str, ...]:
    """A sentence for each rotation (..., n) that leaves the range of small angles."""
    most = np.max(np.abs(np.nan_to_num(np.atleast_2d(q))), axis=0, initial=0.0)
    return tuple(
        f"{name} turns by {np.rad2deg(size):.3g} deg: the equation is linear in rotations and holds for small ones"
        for name, size, unit in zip(system.names, most, system.units, strict=True)
        if unit == "rad" and size > SMALL
    )


def aliased(system: System, loops: Sequence[Loop]) -> list[str]:
    """A sentence for each loop that samples a mode of the system, without friction, less than twice in its period."""
    said, highest = [], highest_rate(system) / (2.0 * np.pi)
    for loop in loops:
        rate = np.inf if loop.sampling is None else float(loop.sampling)
        if highest > 0.5 * rate:
            taken = abs(highest - rate * round(highest / rate))
            said.append(
                f"the loop on {loop.on} samples at {rate:g} Hz, less than twice the mode at {highest:.6g} Hz, which it "
                f"takes for {taken:.6g} Hz"
            )
    return said


DRIVES = "{name}: friction is negative at {speed:.4g} m/s (mu = {mu:.4g}) and drives the sliding: give the law a floor"
BEYOND = "{name}: it slides at {speed:.4g} m/s, beyond the law's data, which end at {known:.4g} m/s"
FEEDS = (
    "{name}: at sliding speeds up to {speed:.4g} m/s the damping of its bristles is above 4 g/|v|, where they may feed "
    "energy in"
)
PULLS = "{name}: N falls to {least:.4g} N: it would have to pull, where a unilateral contact lifts off"


def pulled(names: Sequence[str], unilateral: ArrayLike, normal_force: ArrayLike) -> tuple[tuple[str, float], ...]:
    """Name and N [N] of each bilateral contact that pulls in steady sliding, from tables (contacts,).

    >>> pulled(("pad", "shoe"), [False, True], [-2.0, 0.0])
    (('pad', -2.0),)
    """
    force = np.atleast_1d(np.asarray(normal_force, dtype=float))
    which = np.flatnonzero((force < 0.0) & ~np.asarray(unilateral, dtype=bool))
    return tuple((numbered(names)[i], float(force[i])) for i in which)


def pulling(names: Sequence[str], unilateral: ArrayLike, normal_force: ArrayLike) -> tuple[str, ...]:
    """A sentence for each contact that is `pulled`.

    >>> pulling(("pad", "shoe"), [False, True], [-2.0, 0.0])
    ('pad: N falls to -2 N: it would have to pull, where a unilateral contact lifts off',)
    """
    return tuple(PULLS.format(name=name, least=least) for name, least in pulled(names, unilateral, normal_force))


def out_of_range(system: System, normal_force: ArrayLike, sliding_velocity: ArrayLike) -> tuple[str, ...]:
    """Sentences on what a motion asks of its contacts that their model does not promise.

    Parameters
    ----------
    system : the system
    normal_force, sliding_velocity : shape (..., contacts) [N], [m/s], of steady sliding or along a motion

    A bilateral contact whose N falls below 0 pulls, a coefficient below 0 drives the sliding and does not oppose it; a
    table is constant beyond its last point, which nobody measured; bristles with too much damping may feed energy in.
    Source: the equation in `squealbox.system`.

    >>> from squealbox import Contact, LinearSlope, System
    >>> pad = Contact(n=[0.0], d=[1.0], t=[1.0], N0=1.0, V=20.0, law=LinearSlope(0.45, -0.03))
    >>> out_of_range(System([[1.0]], [[0.0]], [[1.0]], 0.0, (pad,)), [1.0], [20.0])
    ('contact 1: friction is negative at 20 m/s (mu = -0.15) and drives the sliding: give the law a floor',)
    """
    normal = np.atleast_2d(np.asarray(normal_force, dtype=float))
    speed = np.atleast_2d(np.abs(np.asarray(sliding_velocity, dtype=float)))
    said: list[str] = []
    for i, contact in enumerate(system.contacts):
        n, v = normal[..., i].ravel(), speed[..., i].ravel()
        n, v = n[np.isfinite(n)], v[np.isfinite(v)]
        least, most = float(np.min(n, initial=0.0)), float(np.max(np.abs(n), initial=0.0))
        name = system.contact_names[i]
        said += _pulls(name, contact, least, PULL * most)
        if v.size == 0:
            continue
        fastest = float(np.max(v))
        if any(np.ndim(x) for x in contact.law.coefficients()):  # a family of laws, each at its own speed
            looked = np.abs(np.asarray(sliding_velocity, dtype=float)[..., i])
        else:
            looked = fastest * SPEEDS if v.size > 1 else v
        said += _leaves(name, contact, looked, fastest)
    return tuple(said)


def of_a_run(system: System, lowest: np.ndarray, fastest: np.ndarray) -> tuple[str, ...]:
    """As :func:`out_of_range`, from the least normal force [N] and the fastest sliding [m/s] of each contact."""
    said: list[str] = []
    for name, contact, least, most in zip(system.contact_names, system.contacts, lowest, fastest, strict=True):
        if -np.inf < least < 0.0:
            said += _pulls(name, contact, float(least), _round_off(contact))
        said += _leaves(name, contact, float(most) * SPEEDS, float(most))
    return tuple(said)


def of_the_clock(begin: float, duration: float) -> tuple[str, ...]:
    """A sentence where a run [s] begins so late that a number of its instants has lost digits.

    >>> of_the_clock(0.0, 0.05)
    ()
    >>> of_the_clock(1e6, 0.05)
    ('start_time = 1e+06 s: instants are known to 1.2e-10 s there, 2.3e-09 of the duration; V(t) and f(t) no better',)
    """
    known = float(np.spacing(abs(begin) + duration))
    if known <= COARSE * duration:
        return ()
    lost = f"instants are known to {known:.2g} s there, {known / duration:.2g} of the duration"
    return (f"start_time = {begin:g} s: {lost}; V(t) and f(t) no better",)


def of_many_runs(system: System, lowest: np.ndarray, fastest: np.ndarray, least_mu: np.ndarray) -> tuple[str, ...]:
    """As :func:`of_a_run`, of runs told in the rows of three tables (runs, contacts), NaN where there was no run."""
    said: list[str] = []
    for c, (name, contact) in enumerate(zip(system.contact_names, system.contacts, strict=True)):
        low, mu, fast, count = lowest[:, c], least_mu[:, c], fastest[:, c], len(lowest)
        if np.any(which := np.isfinite(low) & (low < -_round_off(contact))):
            said += _pulls(_in(name, which, count), contact, float(np.min(low[which])), 0.0)
        if np.any(which := mu < 0.0):
            worst = int(np.nanargmin(mu))
            said.append(DRIVES.format(name=_in(name, which, count), speed=fast[worst], mu=mu[worst]))
        if isinstance(contact.law, Table) and np.any(which := fast > _known(contact.law)):
            said.append(
                BEYOND.format(name=_in(name, which, count), speed=np.max(fast[which]), known=_known(contact.law))
            )
    return tuple(said)


def least_coefficient(contact: Contact, fastest: ArrayLike) -> Any:
    """The least mu between rest and the fastest sliding [m/s] of each run (runs,); the law may be a family (runs,)."""
    return np.min(contact.law.mu(np.linspace(0.0, 1.0, 17)[:, None] * np.asarray(fastest)), axis=0)


def _in(name: str, which: np.ndarray, count: int) -> str:
    return f"{name} in {int(np.sum(which))} of {count} trajectories"


def _round_off(contact: Contact) -> float:
    """A normal force [N] below which nothing is said."""
    return 1e-12 * float(np.max(np.abs(value_at(contact.N0, 0.0))) + np.abs(contact.n).max(initial=0.0))


def _known(law: Table) -> float:
    return float(np.max(law.speeds)) * (1.0 + 1e-12)


def _pulls(name: str, contact: Contact, least: float, round_off: float) -> list[str]:
    return [PULLS.format(name=name, least=least)] if not contact.unilateral and least < -round_off else []


def _leaves(name: str, contact: Contact, looked: np.ndarray, fastest: float) -> list[str]:
    """What is to be said of the law of a contact at the speeds `looked` at, up to the fastest [m/s]."""
    said, mu = [], np.asarray(contact.law.mu(looked), dtype=float)
    least = float(np.fmin.reduce(mu, axis=None))
    if least < 0.0:
        at = float(np.broadcast_to(looked, mu.shape).flat[int(np.flatnonzero(mu == least)[0])])
        said.append(DRIVES.format(name=name, speed=at, mu=least))
    if isinstance(contact.law, Table) and fastest > _known(contact.law):
        said.append(BEYOND.format(name=name, speed=fastest, known=_known(contact.law)))
    if contact.law.has_memory and np.any(contact.law.feeds(looked)):  # type: ignore[attr-defined]
        said.append(FEEDS.format(name=name, speed=fastest))
    return said


def told_place(parameter: str, value: float, unit: str) -> str:
    """Where a caution is about, with its unit, angles in degrees as well: "theta1 = 0.5 rad (28.65 deg),"."""
    degrees = f" ({math.degrees(value):.4g} deg)" if unit == "rad" else ""
    return f"{parameter} = {value:.6g}{f' {unit}' if unit else ''}{degrees},"
