"""The right-hand side of the equation of motion and its derivative, with each contact in a given mode.

With x = (q, q') and the modes fixed, x' = f(x) is smooth. A contact that slips in the sense s carries
F = s mu(s v) N, one that sticks the force that keeps t.q'' = 0, an open one nothing. So

    a  = M^-1 (f - C q' - K q + sum_slip d F + sum_open normal N),    q'' = P a
    P  = I - M^-1 d G^-1 t',  G = t' M^-1 d    over the sticking contacts
    da = M^-1 (-K + sum_slip s mu d n' + sum_open normal n') dq - M^-1 (C + sum_slip mu' N d t') dq'

because dv = -t.dq'. Smoothed laws put tanh(v/width) or (2/pi) arctan(v/width) for sgn(v) and have no modes.
"""

from dataclasses import replace
from typing import Any

import numpy as np

from squealbox.limit_cycles.cycles.cycle import ordered
from squealbox.limit_cycles.cycles.pinned import pinned
from squealbox.matrices import Equilibrium
from squealbox.memory_rows import no_memory
from squealbox.parameters import ParameterError
from squealbox.schedules import Constant, Schedule, value_at
from squealbox.system import DesignOrSystem, InvalidSystem, System, as_system, equilibrium
from squealbox.transient import (
    SCHEMES,
    WITH_MASS,
    Flows,
    Method,
    Trajectory,
    Widened,
    inverse_mass,
    row_kinds,
    system_of,
    usual_method,
)

OPEN = 2
SMOOTHINGS = ("tanh", "arctan")


def smoothed_sign(v: np.ndarray, width: float, kind: str) -> tuple[Any, Any]:
    """The smooth sgn(v) [-] and its derivative [s/m]; kind is "tanh" or "arctan"."""
    r = v / width
    if kind == "tanh":
        value = np.tanh(r)
        return value, (1.0 - value**2) / width
    return 2.0 / np.pi * np.arctan(r), 2.0 / (np.pi * width * (1.0 + r * r))


OTHERWISE = 'shooting() and branch(method="shooting") find the cycles of such a system, simulate() its motion'


def check_states(system: System) -> None:
    """Raise `InvalidSystem` for a system that has other states than q and q'."""
    remembers_nothing(system)
    if any(kind != WITH_MASS for kind in row_kinds(system)):
        raise InvalidSystem(
            f"M has rows without mass: expected a mass for every freedom, as q and q' are the states here; {OTHERWISE}"
        )


def remembers_nothing(system: System) -> None:
    """Raise `InvalidSystem` where something beside the rows of a system is remembered."""
    no_memory(system.contacts, "this analysis")
    if isinstance(system_of(system), Widened):
        raise InvalidSystem(
            "M is singular otherwise than by rows without mass, or a loop remembers: expected displacements and "
            f"velocities as the only states here; {OTHERWISE}"
        )


def q_and_qd(design_or_system: DesignOrSystem) -> System:
    """The system of a design whose states are q and q' alone; `InvalidSystem` for another."""
    system = as_system(design_or_system)
    check_states(system)
    return system


class Autonomous:
    """An autonomous system without leading axes as a search for cycles sees it: a start, a motion, a rate.

    system is what results know, asked the one given, held_fast what moves; a state is the displacements and velocities
    (2 size,) of all its rows, scale what makes velocities of them. Those below raise `ParameterError` for a system that
    varies with time, whose motion has no period of its own, or that has leading axes.
    """

    def __init__(
        self, asked: System, system: System, moves: System, contact: str, width: float, frequency: float
    ) -> None:  # fmt: skip
        self.asked, self.system, self.held_fast, self.contact, self.width = asked, system, moves, contact, width
        n, rows = moves.size, moves.contacts
        self.size = n
        self.n, self.t, self.d = (np.array([getattr(c, x) for c in rows]).reshape(-1, n) for x in ("n", "t", "d"))
        self.N0, self.V = (np.array([float(value_at(getattr(c, x), 0.0)) for c in rows]) for x in ("N0", "V"))
        self.unilateral = np.array([c.unilateral for c in rows], dtype=bool)
        self.static = np.array([float(c.law.static_limit) for c in rows])
        self.frequency, self.late = frequency, any(not loop.linear for loop in asked.loops)
        self.scale = np.r_[np.full(n, frequency or 1.0), np.ones(n)]
        self._flows: dict[Method, Flows] = {}

    def flows(self, method: Method, duration: float) -> Flows:
        """Many motions at once, by the series of the equation where it has one."""
        if method not in self._flows:
            taken = replace(method, tableau=usual_method(self.held_fast, self.contact))
            self._flows[method] = Flows([self.held_fast], taken, SCHEMES[self.contact], self.width, duration)
        return self._flows[method]

    def contact_state(self, x: np.ndarray) -> tuple[Any, Any]:
        """Normal force [N] and sliding velocity [m/s] of each contact."""
        return self.N0 + x[..., : self.size] @ self.n.T, self.V - x[..., self.size :] @ self.t.T

    def sliding(self) -> Equilibrium:
        """Steady sliding of the rows that results know."""
        return equilibrium(self.held_fast)

    def state(self, q: np.ndarray, qd: np.ndarray, memory: np.ndarray | None = None) -> Any:
        """State of displacements and velocities (n,), with what is remembered beside them where that is known."""
        raise NotImplementedError

    def rate(self, x: np.ndarray, mode: np.ndarray) -> Any:
        """x' at a state, with the contacts in the modes (contacts,)."""
        raise NotImplementedError

    def delay_error(self, run: Trajectory) -> float:
        """How far the rows that stand for delays are from them along one period, over the largest command [-]."""
        return 0.0

    def own_modes(self) -> tuple[Any, Any]:
        """Angular frequencies [rad/s] and shapes (n, modes) of the system without contacts."""
        raise NotImplementedError

    def multipliers(self, monodromy: np.ndarray) -> Any:
        """Floquet multipliers, as `ordered` puts them; NaN where unknown."""
        raise NotImplementedError


class Field(Autonomous):
    """f(x, mode) and df/dx of a system whose states are q and q'.

    contact is "exact" (modes), "tanh" or "arctan" (smoothed over `width`, m/s).
    """

    def __init__(self, system: System, contact: str = "exact", width: float = 1e-3) -> None:
        system = system_of(system)
        check_states(system)
        check_autonomous(system)
        inverse = inverse_mass(system.M)
        frequency = float(np.sqrt(np.max(np.abs(np.linalg.eigvals(inverse @ system.K)))))
        moves, self.rest = pinned(system, frequency)  # all that moves, but for a common motion of bodies
        super().__init__(system, system, moves, contact, width, frequency)
        self.mk, self.mc = (inverse @ matrix for matrix in (moves.K, moves.C))
        self.mf, self.md = inverse @ value_at(system.load, 0.0), self.d @ inverse.T
        normal = [np.zeros(self.size) if c.normal is None else c.normal for c in system.contacts]
        self.mw = np.array(normal).reshape(-1, self.size) @ inverse.T
        self.laws = [c.law for c in system.contacts]
        self.same = bool(self.laws) and all(law == self.laws[0] for law in self.laws)
        self._holds: dict[tuple[int, ...], Any] = {}

    def state(self, q: np.ndarray, qd: np.ndarray, memory: np.ndarray | None = None) -> Any:
        return np.concatenate([q, qd])

    def own_modes(self) -> tuple[Any, Any]:
        values, shapes = np.linalg.eig(self.mk)
        return np.sqrt(np.abs(values)), shapes

    @property
    def beside(self) -> Any:
        """Basis of the states beside a free common motion of bodies, shape (2n, 2n - 2 common)."""
        none = np.zeros(self.rest.shape)
        return np.block([[self.rest, none], [none, self.rest]])

    def multipliers(self, monodromy: np.ndarray) -> Any:
        """Floquet multipliers of the motion beside a free common one, as `ordered` puts them; NaN where unknown."""
        inside = monodromy if self.held_fast is self.system else self.beside.T @ monodromy @ self.beside
        if not np.all(np.isfinite(inside)):
            return np.full(len(inside), np.nan)
        return ordered(np.linalg.eigvals(inside))

    def coefficients(self, v: np.ndarray) -> tuple[Any, Any]:
        """mu and dmu/d|v| of each contact at speeds v (..., contacts) of either sign."""
        if self.same:
            return self.laws[0].mu(v), self.laws[0].slope_at(v)
        mu = [law.mu(v[..., i]) for i, law in enumerate(self.laws)]
        slope = [law.slope_at(v[..., i]) for i, law in enumerate(self.laws)]
        empty = np.zeros(np.shape(v))
        return (np.stack(mu, -1), np.stack(slope, -1)) if mu else (empty, empty)

    def forces(self, x: np.ndarray, mode: np.ndarray) -> tuple[Any, Any, Any, Any]:
        """F, dF/dN, dF/dv of the contacts that slip and the mask of open ones; F of a sticking contact is 0 here."""
        normal, v = self.contact_state(x)
        if self.contact == "exact":
            slips = np.abs(mode) == 1
            sense = np.where(slips, mode, 0)
            u = sense * v
            mu, slope = self.coefficients(np.maximum(u, 0.0))
            factor = sense * (mu + np.minimum(u, 0.0) * slope)  # the tangent beyond a reversal, as in the engine
            return factor * normal, factor, np.where(slips, slope * normal, 0.0), np.equal(mode, OPEN)
        mu, slope = self.coefficients(v)
        sign, steep = smoothed_sign(v, self.width, self.contact)
        opened = self.unilateral & (normal <= 0.0)
        closed = ~opened
        by_speed = (slope * np.sign(v) * sign + mu * steep) * normal
        return mu * sign * normal * closed, mu * sign * closed, by_speed * closed, opened

    def rate(self, x: np.ndarray, mode: np.ndarray) -> Any:
        """x' = f(x), shape (2n,)."""
        force, _, _, opened = self.forces(x, mode)
        q, qd = x[: self.size], x[self.size :]
        a = self.mf - self.mk @ q - self.mc @ qd + force @ self.md
        if np.any(opened):
            a = a + (self.contact_state(x)[0] * opened) @ self.mw
        return np.concatenate([qd, a + self.held(mode, a)])

    def rates(self, states: np.ndarray, mode: np.ndarray) -> Any:
        """x' at states (k, 2n) in the modes (m,) or (k, m), shape (k, 2n)."""
        force, _, _, opened = self.forces(states, mode)
        q, qd = states[:, : self.size], states[:, self.size :]
        a = self.mf - q @ self.mk.T - qd @ self.mc.T + force @ self.md
        if np.any(opened):
            a = a + (self.contact_state(states)[0] * opened) @ self.mw
        for rows, hold in self._holding_rows(mode):
            a[rows] -= a[rows] @ hold.T
        return np.hstack([qd, a])

    def held(self, mode: np.ndarray, a: np.ndarray) -> Any:
        """What the sticking contacts add to accelerations a (n,) or to the columns of a matrix (n, k)."""
        stuck = self.sticking(mode)
        return -(self._hold(stuck) @ a) if stuck.size else 0.0

    def _hold(self, stuck: np.ndarray) -> Any:
        """M^-1 d G^-1 t' over the sticking contacts, shape (n, n); those that hold the same motion share."""
        key = tuple(stuck)
        if key not in self._holds:
            t, md = self.t[stuck], self.md[stuck]
            self._holds[key] = md.T @ np.linalg.pinv(t @ md.T, rcond=1e-12) @ t
        return self._holds[key]

    def _holding_rows(self, mode: np.ndarray) -> list[tuple[Any, Any]]:
        """Which of the rows with modes (m,) or (k, m) stick alike, and what holds them."""
        if self.contact != "exact":
            return []
        if np.ndim(mode) == 1:
            alike = [(slice(None), self.sticking(mode))]
        else:
            held = np.equal(mode, 0)
            begins = np.flatnonzero(np.append(True, np.any(held[1:] != held[:-1], axis=1)))  # few: a motion's stretches
            ends = np.append(begins[1:], len(held))
            alike = [(slice(i, k), np.flatnonzero(held[i])) for i, k in zip(begins, ends, strict=True)]
        return [(rows, self._hold(stuck)) for rows, stuck in alike if stuck.size]

    def sticking(self, mode: np.ndarray) -> Any:
        """Indices of the sticking contacts."""
        return np.flatnonzero(np.equal(mode, 0)) if self.contact == "exact" else np.zeros(0, dtype=int)

    def _holding(self, stuck: np.ndarray, a: np.ndarray) -> Any:
        """Forces -G^-1 t'a; contacts that hold the same motion share (least squares)."""
        return -np.linalg.lstsq(self.t[stuck] @ self.md[stuck].T, self.t[stuck] @ a, rcond=1e-12)[0]

    def jacobian(self, x: np.ndarray, mode: np.ndarray) -> Any:
        """df/dx, shape (2n, 2n)."""
        by_q, by_v = self._free_jacobian(x, mode)
        free = np.hstack([by_q, by_v])
        n = self.size
        return np.vstack([np.hstack([np.zeros((n, n)), np.eye(n)]), free + self.held(mode, free)])

    def jacobians(self, states: np.ndarray, mode: np.ndarray) -> Any:
        """df/dx at states (k, 2n) with modes (m,) or (k, m), shape (k, 2n, 2n)."""
        n = self.size
        _, by_normal, by_speed, opened = self.forces(states, mode)
        out = np.zeros((len(states), 2 * n, 2 * n))
        out[:, :n, n:] = np.eye(n)
        out[:, n:, :n] = -self.mk + np.einsum("...c,ci,cj->...ij", by_normal, self.md, self.n)
        if np.any(opened):
            out[:, n:, :n] += np.einsum("...c,ci,cj->...ij", 1.0 * opened, self.mw, self.n)
        out[:, n:, n:] = -self.mc - np.einsum("...c,ci,cj->...ij", by_speed, self.md, self.t)
        for rows, hold in self._holding_rows(mode):
            out[rows, n:] -= hold @ out[rows, n:]
        return out

    def _free_jacobian(self, x: np.ndarray, mode: np.ndarray) -> tuple[Any, Any]:
        _, by_normal, by_speed, opened = self.forces(x, mode)
        by_q = -self.mk + self.md.T @ (by_normal[:, None] * self.n)
        if np.any(opened):
            by_q = by_q + self.mw.T @ (opened[:, None] * self.n)
        return by_q, -self.mc - self.md.T @ (by_speed[:, None] * self.t)

    def holding_force(self, x: np.ndarray, mode: np.ndarray, contact: int) -> tuple[float, Any]:
        """Force [N] a sticking contact carries, and its gradient (2n,)."""
        stuck = self.sticking(mode)
        at = int(np.flatnonzero(stuck == contact)[0])
        force, _, _, opened = self.forces(x, mode)
        q, qd = x[: self.size], x[self.size :]
        a = self.mf - self.mk @ q - self.mc @ qd + force @ self.md
        if np.any(opened):
            a = a + (self.contact_state(x)[0] * opened) @ self.mw
        free = np.hstack(self._free_jacobian(x, mode))
        return float(self._holding(stuck, a)[at]), self._holding(stuck, free)[at]


def check_autonomous(system: System) -> None:
    """Raise `ParameterError` for leading axes and for what varies with time."""
    if system.shape != ():
        raise ParameterError("limit_cycles", "system", f"leading axes {system.shape}", "one system, without them")
    varying = [system.load, *(c.N0 for c in system.contacts), *(c.V for c in system.contacts)]
    for value in varying:
        if isinstance(value, Schedule) and not isinstance(value, Constant):
            expected = "constant loads, speeds and normal forces; forced_cycle() finds the motion of others"
            raise ParameterError("limit_cycles", "system", value, expected)
