"""The result of a transient: what moved, what each contact did, and where the energy went."""

from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from squealbox.power import mechanical_energy
from squealbox.result import Array, Result, optional, quantity
from squealbox.system import System

OPEN = 2  # contact modes: +1 and -1 slip with sgn(v), 0 stick, OPEN lifted off


@dataclass(frozen=True, kw_only=True, eq=False)
class EnergyAudit:
    """Where the energy went, from t[0] to each instant [J].

    stored (k,) change of kinetic plus strain energy; friction (k, contacts) work of each contact's friction on the
    motion; load (k,), circulation (k,) work of f(t) and of the skew part of K; opening (k,) work of taking an open
    contact's reaction out of K; impact (k,) work of the normal impulses of rigid contacts, negative where a landing
    loses energy; dissipated (k,) taken out by C; turnover the largest kinetic energy;
    residual (k,) = stored - friction - load - circulation - opening - impact + dissipated.
    """

    stored: Any
    friction: Any
    load: Any
    circulation: Any
    dissipated: Any
    opening: Any
    impact: Any
    residual: Any
    turnover: float = 0.0

    @property
    def relative_residual(self) -> float:
        """Largest |residual| over the largest energy turned over, by any term or as kinetic energy [-]."""
        terms = [self.stored, self.load, self.circulation, self.dissipated, self.opening, self.impact]
        terms += list(np.moveaxis(self.friction, -1, 0))
        scale = max(self.turnover, *(float(np.max(np.abs(term), initial=0.0)) for term in terms))
        worst = float(np.max(np.abs(self.residual), initial=0.0))
        return worst / scale if scale > 0.0 else worst

    def __repr__(self) -> str:
        if len(self.stored) == 0:
            return "EnergyAudit of no instants"
        ends = {"stored": self.stored[-1], "friction": float(np.sum(self.friction[-1])), "load": self.load[-1],
                "circulation": self.circulation[-1], "opening": self.opening[-1], "impact": self.impact[-1],
                "dissipated": self.dissipated[-1]}  # fmt: skip
        said = ", ".join(f"{name} {value:.6g} J" for name, value in ends.items())
        return f"EnergyAudit at the end: {said}; closes to {self.relative_residual:.1e}"


@dataclass(frozen=True, kw_only=True, eq=False)
class Trajectory(Result):
    """A motion q(t), with contact states and the energy audit, as :func:`squealbox.transient.simulate` returns it."""

    t: Array = quantity("time", "s", "time")
    q: Array = quantity("time dof", "m", "displacement")
    qd: Array = quantity("time dof", "m/s", "velocity")
    normal_force: Array = quantity("time contact", "N", "normal force N")
    sliding_velocity: Array = quantity("time contact", "m/s", "sliding velocity v = V - t.q'")
    friction_force: Array = quantity("time contact", "N", "friction force on d")
    mode: Array = quantity("time contact", "1", "+1 or -1 slip with sgn(v), 0 stick, 2 open")
    work_friction: Array = quantity("time contact", "J", "work of friction since the start")
    work_load: Array = quantity("time", "J", "work of the load since the start")
    work_circulation: Array = quantity("time", "J", "work of the skew part of K since the start")
    work_dissipated: Array = quantity("time", "J", "energy dissipated by C since the start")
    work_opening: Array = quantity("time", "J", "work of taking out the reaction of open contacts since the start")
    work_impact: Array = quantity("time", "J", "work of the normal impulses of rigid contacts since the start")
    event_time: Array = quantity("event", "s", "instants of stick, slip, reversal, lift-off and landing")
    event_contact: Array = quantity("event", "1", "contact of each event")
    event_mode: Array = quantity("event", "1", "mode the contact takes at the event")
    end_q: Array = optional("dof", "m", "displacement where the run ended")
    end_qd: Array = optional("dof", "m/s", "velocity where the run ended")
    caution: str = ""
    steps: int = 0
    rejected: int = 0
    evaluations: int = 0

    coordinates: ClassVar = {"time": "t", "event": "event_time"}
    swept: ClassVar = {
        "t": ("time", "s", "time"),
        "q": ("time dof", "m", "displacement"),
        "qd": ("time dof", "m/s", "velocity"),
        "steps": ("", "1", "accepted steps"),
    }

    @property
    def system(self) -> System:
        """The system that moved."""
        system: System = self.inputs["system"]
        return system

    @property
    def end(self) -> tuple[Any, Any]:
        """(q, qd) where the run ended, whatever instants were asked for: from there another motion can go on."""
        return (self.end_q, self.end_qd) if len(self.end_q) else (self.q[-1], self.qd[-1])

    @property
    def slip_direction(self) -> Any:
        """Angle [rad] of the relative velocity (V - t.q', -a.q') of each contact, shape (k, contacts).

        0 or pi where a contact slides in one direction only; NaN while it sticks or is open.
        """
        across = self.system.across
        aside = np.zeros_like(self.sliding_velocity) if across is None else -self.qd @ across.T
        return np.where(np.abs(self.mode) == 1, np.arctan2(aside, self.sliding_velocity), np.nan)

    @property
    def energy(self) -> EnergyAudit:
        """The energy audit from the first instant kept to each instant of `t`."""
        stored = mechanical_energy(self.system, self.q, self.qd)
        terms = (stored, self.work_friction, self.work_load, self.work_circulation, self.work_dissipated,
                 self.work_opening, self.work_impact)  # fmt: skip
        stored, friction, load, circulation, dissipated, opening, impact = (term - term[:1] for term in terms)
        given = np.sum(friction, axis=-1) + load + circulation + opening + impact
        return EnergyAudit(
            stored=stored,
            friction=friction,
            load=load,
            circulation=circulation,
            dissipated=dissipated,
            opening=opening,
            impact=impact,
            residual=stored - given + dissipated,
            turnover=float(np.max(mechanical_energy(self.system, 0.0 * self.q, self.qd), initial=0.0)),
        )
