"""What a mass, a damper or a spring at each place, and more of each component, would do to an eigenvalue.

With Q = lambda^2 M + lambda C + K and w^H (2 lambda M + C) u = 1, both of a `Mode`, what is added to freedom i gives

    d lambda = -conj(w_i) u_i lambda^2 dm     a mass dm
    d lambda = -conj(w_i) u_i lambda dc       a damper dc to the ground
    d lambda = -conj(w_i) u_i dk              a spring dk to the ground

exact for non-symmetric matrices (Nelson 1976, AIAA Journal 14, 1201-1205). What is fastened to a brake that slides
steadily, a spring without force, moves nothing: these are derivatives of the brake as it slides. A component with the
mass M_p and the stiffness K_p that gets a share more of its density or its modulus changes lambda by
-lambda^2 w^H M_p u and -w^H K_p u (-(1 + lambda b) w^H K_p u with damping b K_p): at contact forces that stay.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, ClassVar

import numpy as np

from squealbox.arguments import public
from squealbox.parameters import ParameterError
from squealbox.result import Array, Result, quantity
from squealbox.stability.mode import Mode
from squealbox.system import DesignOrSystem, as_system


@dataclass(frozen=True, kw_only=True, eq=False)
class LocalSensitivity(Result):
    """Derivatives of one eigenvalue in what is added at each freedom and node, as `local_sensitivity` returns them."""

    eigenvalue: Any = quantity("", "1/s", "the eigenvalue")
    mass: Array = quantity("dof", "1/(s kg)", "d lambda of a mass on each freedom")
    damper: Array = quantity("dof", "m/(N s^2)", "d lambda of a damper from each freedom to the ground")
    spring: Array = quantity("dof", "m/(N s)", "d lambda of a spring from each freedom to the ground")
    node: Array = quantity("node", "1", "number of each node, from 1")
    place: Array = quantity("node axis", "m", "place of each node; NaN where it is not known")
    node_mass: Array = quantity("node", "1/(s kg)", "d lambda of a point mass at each node, which moves with it")
    density: Array = quantity("part", "1/s", "d lambda for each component per share more density")
    modulus: Array = quantity("part", "1/s", "d lambda for each component per share more modulus")
    parts: tuple[str, ...] = ()

    table_over: ClassVar = ("dof",)

    def summary(self, most: int = 8) -> str:
        """Where a gram of mass calms most, node by node or freedom by freedom, and one per cent of each component."""
        head = f"{'growth rate [1/s]':>18} {'frequency [Hz]':>15}"
        turn = np.sign(np.imag(self.eigenvalue)) / (2.0 * np.pi)
        if len(self.node):
            lines = [f"{'node':>8} {'x [m]':>9} {'y [m]':>9} {'z [m]':>9} {head}   for +1 g"]
            where = [
                f"{i:>8} " + " ".join(f"{x:>9.4g}" for x in at) for i, at in zip(self.node, self.place, strict=True)
            ]
            grams = 1e-3 * self.node_mass
        else:
            lines = [f"{'freedom':<38} {head}   for +1 g"]
            where = [f"{name:<38}" for name in as_system(self.inputs["system"], linear=True).names]
            grams = 1e-3 * self.mass
        for i in np.argsort(np.real(grams), kind="stable")[:most]:
            lines.append(f"{where[i]} {grams[i].real:>+18.6g} {turn * grams[i].imag:>+15.6g}")
        if self.parts:
            lines.append(f"{'component':<38} {head}   for +1 %")
        for what, values in (("density", self.density), ("modulus", self.modulus)):
            for name, value in zip(self.parts, values, strict=True):
                if value == 0.0:
                    continue
                lines.append(f"{f'{name}, {what}':<38} {0.01 * value.real:>+18.6g} {0.01 * turn * value.imag:>+15.6g}")
        return "\n".join(lines)


@public(parameters=None)
def local_sensitivity(design_or_system: DesignOrSystem, mode: Mode) -> LocalSensitivity:
    """Derivatives of an eigenvalue in masses, dampers and springs at every freedom, masses at nodes, and components.

    Parameters
    ----------
    design_or_system : a design or a `System`, sparse ones too; a brake of finite elements has nodes and components
    mode : one of its modes, ``complex_modes(brake, band=...).most_unstable``

    Raises `ParameterError` for a mode of another system, or one without its left shape (``method="full"``).

    >>> from squealbox import DrumBrake, complex_modes
    >>> found = local_sensitivity(DrumBrake(), complex_modes(DrumBrake()).most_unstable)
    >>> found.mass.shape
    (2,)
    """
    system = as_system(design_or_system, linear=True)
    value, u, w = complex(mode.eigenvalue), np.asarray(mode.shape), np.asarray(mode.left)
    if u.shape != (system.size,):
        raise ParameterError("local_sensitivity", "mode", u.shape, f"a mode of this system, of shape ({system.size},)")
    if not np.all(np.isfinite(w)):
        raise ParameterError("local_sensitivity", "mode", "no left shape", 'one found by method="projection"')
    spring = -np.conj(w) * u
    rows = getattr(design_or_system, "node_rows", None)
    numbers, places = rows() if rows else (np.zeros(system.size, dtype=int), np.zeros((system.size, 3)))
    node, first, which = np.unique(numbers, return_index=True, return_inverse=True)
    at_node = np.zeros(len(node), dtype=complex)
    np.add.at(at_node, which, value**2 * spring)
    known = node > 0
    parts = _parts(design_or_system)
    return LocalSensitivity(
        eigenvalue=value,
        mass=value**2 * spring,
        damper=value * spring,
        spring=spring,
        node=node[known],
        place=places[first[known]],
        node_mass=at_node[known],
        density=np.array([-(value**2) * np.vdot(w, mass @ u) for mass, _, _ in parts.values()]),
        modulus=np.array([-(1.0 + value * b) * np.vdot(w, stiff @ u) for _, stiff, b in parts.values()]),
        parts=tuple(parts),
        inputs={"system": design_or_system},
    )


def _parts(design: Any) -> Mapping[str, tuple[Any, Any, float]]:
    """Mass and stiffness of each component of a brake that meshes itself, and its damping per stiffness [s]."""
    if not hasattr(design, "components"):
        return {}
    materials = design.materials()
    damped = {name: float(material.damping) for name, material in materials.items()}
    return {name: (mass, stiff, damped.get(name, 0.0)) for name, (mass, stiff) in design.components().items()}
