"""A brake under control as x' = A x + sum_a B_a u_a(t - T_a), u_a = H_a x: the linear form poles and margins are of.

x = (q, q' of what has mass, loop states), about steady sliding. u_a is the command of loop a; B_a holds what it drives:
an actuator of finite bandwidth, a state of A, or the brake and the loop's own memory (G) at once. Loops without delay
and sampling are still apart from A, so that each can be broken.
"""

from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from squealbox.loops import Loop, first_order, folded
from squealbox.parameters import ParameterError
from squealbox.result import Outcome
from squealbox.system import DesignOrSystem, Equilibrium, System, linearise


@dataclass(frozen=True, eq=False)
class Plant:
    """A (d, d), B (d, a), H (a, d), delay (a,) [s] of the loops that are not ideal, sampling (a,) [Hz] or 0.

    displacement (n, d) and velocity (n, d) read q and q' from x; outcome is that of steady sliding.
    """

    A: Any
    B: Any
    H: Any
    delay: Any
    sampling: Any
    displacement: Any
    velocity: Any
    loops: tuple[Loop, ...]
    names: tuple[str, ...]
    outcome: Outcome

    @property
    def closed(self) -> Any:
        """A + B H: every loop closed at once, without its delay and sampling."""
        return self.A + self.B @ self.H

    def replaced(self, delay: np.ndarray) -> "Plant":
        """The same with other delays (a,) [s]."""
        return replace(self, delay=delay)


def with_loops(design_or_system: DesignOrSystem) -> System:
    """The system with its loops still apart."""
    return design_or_system if isinstance(design_or_system, System) else design_or_system.system()


def plant(design_or_system: DesignOrSystem, time: float = 0.0) -> Plant:
    """The linear form of a brake with loops; `ParameterError` without loops or with leading axes.

    `time` [s]: instant at which schedules are taken.
    """
    system = with_loops(design_or_system)
    if not system.loops:
        raise ParameterError(
            "closed_loop",
            "design",
            type(design_or_system).__name__,
            "a brake with loops: Controlled(brake, [PID(on='y')])",
        )
    rows = [loop.controller(system.names) for loop in system.loops]
    if system.shape != () or any(np.ndim(row.P) > 1 for row in rows):
        raise ParameterError("closed_loop", "design", f"leading axes {system.shape}", "one brake, without them")
    whole = folded(
        system.replace(loops=tuple(loop.replace(delay=0.0, sampling=None, computing=0.0) for loop in system.loops)),
        near=True,
    )
    steady = linearise(whole, time).equilibrium
    about = linearise(system.replace(loops=()), time)
    if bool(steady.exists) and whole.contacts:  # steady sliding is that of the closed loop
        about = _about(system, steady, time)
    outcome = steady.outcome
    A, displacement, velocity, into = first_order(about.M, about.C, about.K)
    n = system.size  # loops sense and push the brake's own rows, not the bristles of its contacts
    displacement, velocity, into = displacement[:n], velocity[:n], into[:, :n]
    d, lags = len(A), [loop.rate is not None for loop in system.loops]
    total = d + sum(row.memory + lag for row, lag in zip(rows, lags, strict=True))
    wide = np.zeros((total, total))
    wide[:d, :d] = A
    B, H = np.zeros((total, len(rows))), np.zeros((len(rows), total))
    at = d
    for a, row in enumerate(rows):
        m, f = slice(at, at + row.memory), at + row.memory
        at = f + lags[a]
        wide[m, :d] = row.E @ displacement + row.F @ velocity
        wide[m, m] = row.A
        force = np.zeros(total)  # what a unit of force does
        force[:d], force[m] = into @ row.b, row.G
        if lags[a]:
            rate = float(system.loops[a].rate)
            wide[:, f] += force
            wide[f, f] -= rate
            B[f, a] = rate
        else:
            B[:, a] = force
        H[a, :d], H[a, m] = row.P @ displacement + row.R @ velocity, row.S
    pad = ((0, 0), (0, total - d))
    return Plant(
        wide, B, H, np.array([loop.late for loop in system.loops]),
        np.array([loop.sampling or 0.0 for loop in system.loops]), np.pad(displacement, pad), np.pad(velocity, pad),
        system.loops, system.names, outcome,
    )  # fmt: skip


def _about(system: System, steady: Equilibrium, time: float) -> Any:
    """The brake's own matrices at the steady state of the closed loop, with the loops' static pull on the contacts."""
    shifted = tuple(
        contact.replace(
            N0=float(steady.normal_force[i]) if not contact.unilateral or steady.normal_force[i] > 0.0 else 0.0,
            n=0.0 * contact.n,
        )
        for i, contact in enumerate(system.contacts)
    )
    found = linearise(system.replace(loops=(), contacts=shifted, load=np.zeros(system.size)), time)
    stiffness, n = np.array(found.K), system.size
    for i, contact in enumerate(system.contacts):
        closed = not contact.unilateral or steady.normal_force[i] > 0.0
        factor = steady.friction[i] * np.sign(steady.sliding_speed[i]) if closed else 0.0
        stiffness[:n, :n] -= factor * np.outer(contact.d, contact.n)
        if not closed:
            stiffness[:n, :n] -= np.outer(contact.normal, contact.n)
    return type(found)(found.M, found.C, stiffness, steady)
