"""Where the energy of a mode comes from and goes to, contact by contact.

With q = Re(a u exp(lambda t)) and means over the phase of a, the mechanical energy E = kinetic + strain of a mode
changes at 2 Re(lambda) E, and that is exactly the sum of the mean powers

    contact c, normal force:  1/2 Re(conj(lambda) u^H d (mu sgn(V) n' u)), its skew part: circulation
    contact c, slope:        -1/2 |lambda|^2 N mu'(V) Re(u^H d t' u)
    structure:               -1/2 |lambda|^2 Re(u^H C u), by degree of freedom; and the skew part of K itself

The symmetric part of mu d n' stores energy like a spring and is counted as strain. Work in a cycle is power times
period.
"""

from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.result import Result, quantity
from squealbox.stability.eigenvalues import Mode, modes_of
from squealbox.stability.family import steady_sliding
from squealbox.system import System, as_system


@dataclass(frozen=True, kw_only=True, eq=False)
class ModeEnergy(Result):
    """Mean powers and energies of one mode at amplitude 1 m of u (they grow with its square).

    phase [rad] is by how much the normal force of a contact leads its sliding velocity t.q'; friction feeds the mode
    when the normal force is large while the contact moves along the friction force.
    """

    circulation: Any = quantity("contact", "W", "mean power fed in by normal force varying, skew part")
    slope: Any = quantity("contact", "W", "mean power fed in by friction varying with speed")
    dissipated: Any = quantity("dof", "W", "mean power taken out by the damping C, by degree of freedom")
    structure: Any = quantity("", "W", "mean power fed in by the skew part of the structure's own K")
    kinetic: Any = quantity("dof", "J", "mean kinetic energy, by degree of freedom")
    strain: Any = quantity("dof", "J", "mean strain energy with friction's symmetric part, by degree of freedom")
    phase: Any = quantity("contact", "rad", "phase of the normal force before the sliding velocity")
    eigenvalue: Any = quantity("", "1/s", "eigenvalue of the mode")
    contacts: tuple[str, ...] = ()
    dofs: tuple[str, ...] = ()

    @property
    def total(self) -> float:
        """Mean mechanical energy [J]."""
        return float(np.sum(self.kinetic) + np.sum(self.strain))

    @property
    def growth_rate(self) -> float:
        """Growth rate [1/s] from the sum of powers: sum / (2 E)."""
        powers = np.sum(self.circulation) + np.sum(self.slope) + float(self.structure) - np.sum(self.dissipated)
        return float(powers / (2.0 * self.total))

    @property
    def residual(self) -> float:
        """What the sum of powers misses of the growth rate, relative to |lambda| [-]."""
        return abs(self.growth_rate - float(np.real(self.eigenvalue))) / abs(complex(self.eigenvalue))

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
        per = 1.0 / (2.0 * self.total)
        hertz = abs(np.imag(self.eigenvalue)) / (2.0 * np.pi)
        rows = [f"growth rate {float(np.real(self.eigenvalue)):+.6g} 1/s at {hertz:.6g} Hz"]
        for i, name in enumerate(self.contacts):
            rows.append(
                f"  {name}: normal force {self.circulation[i] * per:+.6g}, slope {self.slope[i] * per:+.6g} 1/s, "
                f"phase {np.rad2deg(self.phase[i]):+.4g} deg"
            )
        rows += [f"  damping of {name}: {-self.dissipated[i] * per:+.6g} 1/s" for i, name in enumerate(self.dofs)]
        rows += [f"  skew stiffness of the structure: {float(self.structure) * per:+.6g} 1/s"] * bool(self.structure)
        return "\n".join(rows)

    def __repr__(self) -> str:
        return self.summary()


def mode_energy(design_or_system: Any, mode: Mode | int | None = None, time: float = 0.0) -> ModeEnergy:
    """Energies and powers of one mode of one system.

    Parameters
    ----------
    design_or_system : without leading axes
    mode : a `Mode`, or its index in the spectrum; by default the most unstable
    time : instant of schedules [s]

    The sum of the powers is the growth rate to round-off (`residual`). Raises `ValueError` without steady sliding.
    """
    system: System = as_system(design_or_system)
    steady = steady_sliding(system, time)
    if steady.K.ndim > 2:
        raise ValueError(f"leading axes {steady.K.shape[:-2]}: mode_energy() is for one system")
    modes = modes_of(steady)
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
    return ModeEnergy(
        circulation=np.array(circulation),
        slope=np.array(slope),
        dissipated=0.5 * np.real(np.conj(velocity) * (steady.structural @ velocity)),
        structure=float(-0.5 * np.real(np.conj(velocity) @ own_skew @ u)),
        kinetic=0.25 * np.real(np.conj(velocity) * (steady.M @ velocity)),
        strain=0.25 * np.real(np.conj(u) * (symmetric @ u)),
        phase=np.array(phase),
        eigenvalue=complex(value),
        contacts=tuple(contact.name or f"contact {i + 1}" for i, contact in enumerate(system.contacts)),
        dofs=system.names,
        inputs={"system": design_or_system, "time": time},
    )
