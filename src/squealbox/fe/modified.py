"""A reduced brake with its structure changed: a mass on a node, a component stiffer, heavier or more damped.

The change is that of the full brake, V' dM V, V' dC V and V' dK V, on the basis of the brake as it is: what the basis
lacks of the new shapes is left out, the less the smaller the change. Steady sliding moves with it, from
V' dK (q0 + V p) at the same load. Contacts stay what they are.
"""

from typing import TYPE_CHECKING

import numpy as np

from squealbox.fe.full_brake import FullBrake
from squealbox.fe.reduced_brake import ReducedBrake
from squealbox.parameters import ParameterError, known_names
from squealbox.system import InvalidSystem

if TYPE_CHECKING:
    from scipy.sparse import sparray

CONTACT = "contact"  # among the components: its stiffness is in the rows of the contacts too, so it is no part here


def changeable(full: FullBrake) -> dict[str, float]:
    """The components of a brake that meshes itself, with their damping per stiffness [s]; {} of any other."""
    if not hasattr(full.design, "components"):
        return {}
    damped = {name: float(material.damping) for name, material in full.design.materials().items()}
    return {name: damped.get(name, 0.0) for name in full.design.components() if name != CONTACT}


def with_component(
    small: ReducedBrake, name: str, *, modulus: float = 1.0, density: float = 1.0, damping: float = 1.0
) -> ReducedBrake:
    """The brake with the `modulus` [-], `density` [-] and `damping` [-] per stiffness of one component times factors.

    `name` is one of the full brake's `components()` but the contact. Raises `ParameterError` for another, or for a
    factor that is not positive, and `InvalidSystem` where the full brake is not kept.
    """
    full = small.attached()
    known = changeable(full)
    if name not in known:
        raise ParameterError("with_component", "name", name, known_names(name, list(known)))
    for what, value in (("modulus", modulus), ("density", density), ("damping", damping)):
        if not 0.0 < value < np.inf:
            raise ParameterError("with_component", what, value, "one positive number")
    mass, stiffness, held = full.component(name)
    damper = known[name] * (modulus * damping - 1.0) * stiffness
    return _added(small, (density - 1.0) * mass, damper, (modulus - 1.0) * stiffness, (1.0 - modulus) * held)


def with_mass(small: ReducedBrake, node: int, mass: float) -> ReducedBrake:
    """The brake with a `mass` [kg] on a node of the full brake's mesh, numbered as `local_sensitivity` does."""
    full = small.attached()
    if not hasattr(full.design, "node_rows"):
        raise InvalidSystem("of this brake the nodes are not known: a mass cannot be put on one")
    if not 0.0 <= mass < np.inf:
        raise ParameterError("with_mass", "mass", mass, "one number of at least 0, in kg")
    rows = np.flatnonzero(full.design.node_rows()[0] == node)
    if not len(rows):
        raise ParameterError("with_mass", "node", node, "the number of a node of the mesh that is not held")
    moves = full.basis[rows]
    return _added(small, mass * moves.T @ moves, 0.0, 0.0, 0.0)


def _added(
    small: ReducedBrake, mass: "sparray", damping: "sparray", stiffness: "sparray", load: float | np.ndarray
) -> ReducedBrake:
    arrays = dict(small.reduction.arrays)
    for field, change in (("M", mass), ("C", damping), ("K", stiffness), ("load", load)):
        arrays[field] = arrays[field] + change
    return small.replace({"reduction": small.reduction.replace(arrays=arrays)})
