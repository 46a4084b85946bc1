"""Where the energy of a mode comes from and goes to, contact by contact.

With q = Re(a u exp(lambda t)) and means over the phase of a, the mechanical energy E = kinetic + strain of a mode
changes at 2 Re(lambda) E, and that is exactly the sum of the mean powers

    contact c, normal force:  1/2 Re(conj(lambda) u^H d (mu sgn(V) n' u)), its skew part: circulation
    contact c, slope:        -1/2 |lambda|^2 N mu'(V) Re(u^H d t' u)
    contact c, across:       -1/2 |lambda|^2 mu N / |V| |a' u|^2, where sliding is in a plane
    structure:               -1/2 |lambda|^2 Re(u^H C u), by degree of freedom; and the skew part of K itself

The symmetric part of mu d n' stores energy like a spring and is counted as strain. Work in a cycle is power times
period. C is told apart into dampers: with symmetric C, v.C v = sum_i (sum_j C_ij) v_i^2 - sum_(i<j) C_ij (v_i - v_j)^2,
that is one damper from each degree of freedom to ground and one between each two. In a mode that diverges without
damping kinetic and strain energy cancel: E = 0, and the powers add up to nothing.
"""

import re
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from squealbox.arguments import public
from squealbox.fe import ReducedBrake
from squealbox.memory_rows import no_memory
from squealbox.result import Array, Result, quantity
from squealbox.stability.eigenvalues import Mode, complex_modes, modes_of
from squealbox.stability.family import across_dampers, steady_sliding
from squealbox.system import DesignOrSystem, System, as_system, linearise
from squealbox.words import growing

MOST_DAMPERS = 12  # named one by one; the damping of a larger structure is given by degree of freedom


@dataclass(frozen=True, kw_only=True, eq=False)
class ModeEnergy(Result):
    """Mean powers and energies of one mode at amplitude 1 m of u (they grow with its square).

    phase [rad] is by how much the normal force of a contact leads its sliding velocity t.q'; friction feeds the mode
    when the normal force is large while the contact moves along the friction force.
    """

    circulation: Array = quantity("contact", "W", "mean power fed in by normal force varying, skew part")
    slope: Array = quantity("contact", "W", "mean power fed in by friction varying with speed")
    across: Array = quantity(
        "contact", "W", "mean power taken out by friction turning with the velocity across sliding"
    )
    dissipated: Array = quantity("dof", "W", "mean power taken out by the damping C, by degree of freedom")
    dampers: Array = quantity("damper", "W", "mean power taken out by each damper that C is made of")
    structure: Any = quantity("", "W", "mean power fed in by the skew part of the structure's own K")
    kinetic: Array = quantity("dof", "J", "mean kinetic energy, by degree of freedom")
    strain: Array = quantity("dof", "J", "mean strain energy with friction's symmetric part, by degree of freedom")
    phase: Array = quantity("contact", "rad", "phase of the normal force before the sliding velocity")
    eigenvalue: Any = quantity("", "1/s", "eigenvalue of the mode")
    contacts: tuple[str, ...] = ()
    dofs: tuple[str, ...] = ()
    damper_names: tuple[str, ...] = ()

    @property
    def total(self) -> float:
        """Mean mechanical energy [J]."""
        return float(np.sum(self.kinetic) + np.sum(self.strain))

    @property
    def balanced(self) -> bool:
        """True where kinetic and strain energy cancel to round-off, so that no growth rate follows from powers."""
        return abs(self.total) <= 1e-12 * self._size

    @property
    def power(self) -> float:
        """Sum of the mean powers [W]."""
        fed = np.sum(self.circulation) + np.sum(self.slope) + float(self.structure)
        return float(fed - np.sum(self.across) - np.sum(self.dissipated))

    @property
    def growth_rate(self) -> float:
        """Growth rate [1/s] from the sum of powers: sum / (2 E); NaN where E = 0 (`balanced`)."""
        return np.nan if self.balanced else self.power / (2.0 * self.total)

    @property
    def residual(self) -> float:
        """What the sum of powers misses of 2 Re(lambda) E, relative to 2 |lambda| (kinetic + |strain|) [-]."""
        expected = 2.0 * float(np.real(self.eigenvalue)) * self.total
        scale = 2.0 * abs(complex(self.eigenvalue)) * self._size
        return abs(self.power - expected) / scale if scale > 0.0 else 0.0

    @property
    def shares(self) -> list[tuple[str, float]]:
        """Name and contribution of each contact and damper: to the growth rate [1/s], or its power [W] where E = 0."""
        per = 1.0 if self.balanced else 1.0 / (2.0 * self.total)
        rows = list(zip((f"{name}: normal force" for name in self.contacts), self.circulation * per, strict=True))
        rows += zip((f"{name}: slope" for name in self.contacts), self.slope * per, strict=True)
        rows += [(f"{name}: across", -w * per) for name, w in zip(self.contacts, self.across, strict=True) if w != 0.0]
        few = len(self.damper_names) <= MOST_DAMPERS
        names = self.damper_names if few else tuple(f"damping of {name}" for name in self.dofs)
        rows += zip(names, (self.dampers if few else self.dissipated) * -per, strict=True)
        rows += [("skew stiffness of the structure", float(self.structure) * per)] * bool(self.structure)
        rows += [("damping of the structure", -float(np.sum(self.dissipated)) * per)] * (not self.damper_names)
        return [(name, float(value) + 0.0) for name, value in rows]

    def by_group(self) -> "ModeEnergy":
        """The same with contacts summed by their name without its number, and all damping in one; no phases."""
        rows = contact_groups(self.contacts)

        def summed(values: np.ndarray) -> Any:
            return np.array([np.sum(values[each]) for each in rows.values()])

        arrays: dict[str, Any] = {name: summed(getattr(self, name)) for name in ("circulation", "slope", "across")}
        for name in ("dissipated", "dampers", "kinetic", "strain"):
            arrays[name] = np.array([np.sum(getattr(self, name))])
        names: dict[str, Any] = {"contacts": tuple(rows), "dofs": ("the structure",)}
        names["damper_names"] = ("damping of the structure",)
        return replace(self, **arrays, phase=np.full(len(rows), np.nan), **names)

    @property
    def _size(self) -> float:
        return float(np.sum(np.abs(self.kinetic)) + np.sum(np.abs(self.strain)))

    @property
    def work_per_cycle(self) -> Any:
        """Work of each contact in one cycle [J], (contacts,); infinite for a mode that does not oscillate."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return (self.circulation + self.slope) * 2.0 * np.pi / np.abs(np.imag(self.eigenvalue))

    @property
    def dissipated_per_cycle(self) -> Any:
        """Energy each degree of freedom's damping takes out in one cycle [J], (dof,)."""
        with np.errstate(divide="ignore", invalid="ignore"):
            return self.dissipated * 2.0 * np.pi / np.abs(np.imag(self.eigenvalue))

    def summary(self) -> str:
        """What each contact and damper brings to the growth rate [1/s]."""
        hertz = abs(np.imag(self.eigenvalue)) / (2.0 * np.pi)
        rows = [f"growth rate {growing(np.real(self.eigenvalue), hertz)}"]
        unit = "W" if self.balanced else "1/s"
        rows += ["  kinetic and strain energy cancel; powers at 1 m instead"] * self.balanced
        rows += [f"  {name}: {value:+.6g} {unit}" for name, value in self.shares]
        rows += [
            f"  {name}: normal force leads its sliding velocity by {np.rad2deg(phase):+.4g} deg"
            for name, phase in zip(self.contacts, self.phase, strict=True)
        ]
        return "\n".join(rows)


def contact_groups(names: Sequence[str]) -> dict[str, Any]:
    """Contacts by their name without the number at its end."""
    heads = [re.sub(r"[ _]*\d+$", "", name) or name for name in names]
    return {head: np.flatnonzero(np.array(heads) == head) for head in dict.fromkeys(heads)}


@public()
def mode_energy(design_or_system: DesignOrSystem, mode: Mode | int | None = None, time: float = 0.0) -> ModeEnergy:
    """Energies and powers of one mode of one system.

    Parameters
    ----------
    design_or_system : without leading axes
    mode : a `Mode`, or its index in the spectrum; by default the most unstable. A sparse system needs a `Mode`
    time : instant of schedules [s]

    The sum of the powers is the growth rate to round-off (`residual`). Raises `ValueError` without steady sliding.
    """
    system: System = as_system(design_or_system, linear=True)
    if system.is_sparse:
        return sparse_energy(system, mode, time)
    no_memory(system.contacts, "the energy of a mode")
    steady = steady_sliding(system, time)
    if steady.K.ndim > 2:
        raise ValueError(f"leading axes {steady.K.shape[:-2]}: mode_energy() is for one system")
    modes = complex_modes(design_or_system, time) if isinstance(design_or_system, ReducedBrake) else modes_of(steady)
    chosen = mode if isinstance(mode, Mode) else modes.most_unstable if mode is None else modes.mode(mode)
    value, u = chosen.eigenvalue, chosen.shape
    velocity = value * u
    state = steady.equilibrium
    circulation, slope, phase = [], [], []
    structure = np.array(steady.K)
    for i, contact in enumerate(system.contacts):
        normal, speed, mu = (float(a[i]) for a in (state.normal_force, state.sliding_speed, state.friction))
        closed = 0.0 if contact.unilateral and normal <= 0.0 else 1.0
        coupling = closed * mu * np.sign(speed) * np.outer(contact.d, contact.n)
        structure = structure + coupling
        force = 0.5 * (coupling - coupling.T) @ u
        circulation.append(0.5 * np.real(np.conj(velocity) @ force))
        weight = closed * normal * float(contact.law.slope_at(speed))
        slope.append(-0.5 * weight * np.real((np.conj(velocity) @ contact.d) * (contact.t @ velocity)))
        phase.append(np.angle((contact.n @ u) * np.conj(contact.t @ velocity)))
    own_skew = 0.5 * (structure - structure.T)
    own_skew = np.where(np.max(np.abs(own_skew)) <= 1e-13 * np.max(np.abs(structure)), 0.0, own_skew)  # round-off
    symmetric = 0.5 * (steady.K + steady.K.T)
    damper_names, dampers = _dampers(system.C, velocity, system.names)
    across = [0.5 * float(x) * np.real(np.conj(velocity) @ a @ velocity) for x, a in across_dampers(system, steady)]
    return ModeEnergy(
        circulation=np.array(circulation),
        slope=np.array(slope),
        across=np.array(across),
        dissipated=0.5 * np.real(np.conj(velocity) * (system.C @ velocity)),
        dampers=dampers,
        structure=float(-0.5 * np.real(np.conj(velocity) @ own_skew @ u)),
        kinetic=0.25 * np.real(np.conj(velocity) * (steady.M @ velocity)),
        strain=0.25 * np.real(np.conj(u) * (symmetric @ u)),
        phase=np.array(phase),
        eigenvalue=complex(value),
        contacts=system.contact_names,
        dofs=system.names,
        damper_names=damper_names,
        inputs={"system": design_or_system, "time": time},
    )


def sparse_energy(system: System, mode: Mode | int | None, time: float) -> ModeEnergy:
    """The same of a sparse system, contact by contact without a loop; damping by degree of freedom."""
    if not isinstance(mode, Mode):
        raise ValueError(f"mode = {mode!r}: a sparse system needs a Mode, as complex_modes(system, band=...) gives it")
    about = linearise(system, time)
    state, table = about.equilibrium, system.contacts
    value, u = mode.eigenvalue, mode.shape
    velocity = value * u
    closed = (state.normal_force > 0.0) | ~table.unilateral
    pressing = np.where(closed, state.normal_force, 0.0)
    coupling = np.where(closed, state.friction * np.sign(state.sliding_speed), 0.0)
    sensed, along, moved, sideways = (
        np.zeros(len(table)) if rows is None else rows @ u for rows in (table.n, table.d, table.t, table.across)
    )
    _, slope = table.friction(state.sliding_speed)
    # 1/2 Re(conj(lambda) u^H A u) with A the skew part of mu d n'
    skew = 0.5 * coupling * (np.conj(along) * sensed - np.conj(sensed) * along)
    own = system.K - 0.5 * (system.K + system.K.T)
    symmetric = 0.5 * (about.K + about.K.T)
    if table.normal is not None:
        open_rows = table.normal.T @ (np.where(closed, 0.0, 1.0) * sensed)
        own_work = np.conj(velocity) @ (own @ u) - 0.5 * (np.conj(velocity) @ open_rows)
        own_work = own_work + 0.5 * np.conj(velocity) @ (table.n.T @ (np.where(closed, 0.0, 1.0) * (table.normal @ u)))
    else:
        own_work = np.conj(velocity) @ (own @ u)
    size = abs(value) * float(np.linalg.norm(symmetric @ u))
    structure = float(-0.5 * np.real(own_work))
    return ModeEnergy(
        circulation=0.5 * np.real(np.conj(value) * skew),
        slope=-0.5 * abs(value) ** 2 * pressing * slope * np.real(np.conj(along) * moved),
        across=0.5 * abs(value) ** 2 * pressing * state.friction / np.abs(state.sliding_speed) * np.abs(sideways) ** 2,
        dissipated=0.5 * np.real(np.conj(velocity) * (system.C @ velocity)),
        dampers=np.zeros(0),
        structure=0.0 if abs(structure) <= 1e-13 * size else structure,
        kinetic=0.25 * np.real(np.conj(velocity) * (system.M @ velocity)),
        strain=0.25 * np.real(np.conj(u) * (symmetric @ u)),
        phase=np.angle(sensed * np.conj(moved * value)),
        eigenvalue=complex(value),
        contacts=table.names,
        dofs=system.names,
        inputs={"system": None, "time": time},
    )


def _dampers(damping: np.ndarray, velocity: np.ndarray, dofs: tuple[str, ...]) -> tuple[tuple[str, ...], Any]:
    """Names and mean powers [W] of the dampers that C is made of: to ground, and between two degrees of freedom."""
    symmetric = 0.5 * (damping + damping.T)  # the skew part does no work
    rest = 1e-14 * np.max(np.abs(symmetric))
    found = []
    for i, name in enumerate(dofs):
        grounded = float(np.sum(symmetric[i]))
        if abs(grounded) > rest:
            found.append((f"damping of {name}", 0.5 * grounded * abs(velocity[i]) ** 2))
        for j in range(i):
            if abs(symmetric[i, j]) > rest:
                power = -0.5 * symmetric[i, j] * abs(velocity[i] - velocity[j]) ** 2
                found.append((f"damping between {dofs[j]} and {name}", power))
    return tuple(name for name, _ in found), np.array([float(power) for _, power in found])
