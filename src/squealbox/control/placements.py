"""Where to sense and where to act: what velocity feedback between two freedoms does to each mode, first order.

A force -g q_s' on row o adds g e_o e_s' to the damping. With left and right modes w, u, w^H (2 lambda M + C) u = 1,

    d lambda/d g = -lambda conj(w_o) u_s          [1/s per N s/m]

A pair serves a mode where its real part is negative, and spills over into every other where it is positive.
"""

from dataclasses import dataclass

import numpy as np

from squealbox.arguments import public
from squealbox.parameters import ParameterError
from squealbox.result import Array, Result, quantity
from squealbox.stability import complex_modes
from squealbox.system import DesignOrSystem, as_system

SHOWN = 6


@dataclass(frozen=True, kw_only=True, eq=False)
class Placement(Result):
    """What each pair of sensor and actuator does to each mode, as :func:`placement` returns it."""

    poles: Array = quantity("mode", "1/s", "eigenvalues of the brake, those with Im >= 0")
    shift: Array = quantity("sense act mode", "1/kg", "d lambda/d g of velocity feedback; negative real parts damp")
    names: tuple[str, ...] = ()

    @property
    def target(self) -> int:
        """The mode with the largest growth rate."""
        return int(np.nanargmax(self.poles.real))

    def ranked(self, mode: int | None = None) -> list[tuple[str, str, float, float]]:
        """(sense, act, what it does to the mode, the worst it does to another) [1/kg], the best pair first.

        mode : None takes the one with the largest growth rate
        """
        at = self.target if mode is None else mode
        growth = self.shift.real
        others = np.delete(growth, at, axis=-1)
        found = []
        for i, sense in enumerate(self.names):
            for k, act in enumerate(self.names):
                worst = float(np.max(others[i, k], initial=-np.inf)) if others.shape[-1] else 0.0
                found.append((sense, act, float(growth[i, k, at]), worst))
        return sorted(found, key=lambda row: row[2])

    def summary(self) -> str:
        """The best pairs for the mode with the largest growth rate, and what they do to the others."""
        if not self.outcome.ok:
            return self.outcome.told
        pole = self.poles[self.target]
        lines = [
            f"mode at {abs(pole.imag) / (2.0 * np.pi):.6g} Hz, growth {pole.real:+.6g} 1/s; per N s/m of feedback:"
        ]
        lines += [
            f"sense {sense}, act on {act}: {own:+.4g} 1/s, worst of the other modes {worst:+.4g} 1/s"
            for sense, act, own, worst in self.ranked()[:SHOWN]
        ]
        return "\n".join(lines)


@public()
def placement(design_or_system: DesignOrSystem, time: float = 0.0) -> Placement:
    """Which pair of sensor and actuator damps which mode, from the mode shapes.

    Parameters
    ----------
    design_or_system : one brake, without leading axes
    time : instant of schedules [s]

    First order in the gain; `closed_loop` says what a finite gain does.

    >>> from squealbox import Coulomb, ModeCoupling
    >>> found = placement(ModeCoupling(c1=0.02, c2=0.02, friction=Coulomb(1.2)))
    >>> sense, act, own, _ = found.ranked()[0]
    >>> own < 0.0
    True
    """
    system = as_system(design_or_system)
    if system.shape != ():
        raise ParameterError("placement", "design_or_system", f"leading axes {system.shape}", "one brake, without them")
    modes = complex_modes(design_or_system, time)
    upper = np.flatnonzero(np.isfinite(modes.eigenvalues[: len(modes.eigenvalues) // 2]))
    heavy = [i for i in range(system.size) if np.any(system.M[i])]
    values = modes.eigenvalues[upper]
    right, left = modes.right[:, upper][heavy], modes.left[:, upper][heavy]
    return Placement(
        poles=values, shift=-values * right[:, None, :] * np.conj(left)[None, :, :],
        names=tuple(system.names[i] for i in heavy), inputs={"system": design_or_system, "time": time},
        outcome=modes.outcome,
    )  # fmt: skip
