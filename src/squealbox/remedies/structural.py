"""What might silence a finite-element brake: less friction, components stiffer or softer, more damped, and masses.

Which way to go and where a mass helps most is what the derivatives of the worst mode say
(:func:`squealbox.stability.local_sensitivity`); how much is needed, and what it does to all other modes of the band,
is then computed on the reduced brake.
"""

from collections.abc import Iterator
from typing import Any

import numpy as np

from squealbox.fe import ReducedBrake, changeable, with_component, with_mass
from squealbox.remedies.candidates import Candidate, parameter_candidate
from squealbox.stability import LocalSensitivity, Mode, local_sensitivity

SHARES = np.array([0.02, 0.05, 0.1, 0.2, 0.35, 0.5])  # of a modulus or density, up or down
FACTORS = np.array([1.2, 1.5, 2.0, 3.0, 5.0, 10.0])  # of damping
MASSES = np.array([0.002, 0.005, 0.01, 0.02, 0.05, 0.1])  # kg
PLACES, APART = 3, 0.03  # nodes for a mass, and by how much they stand apart [m]
ON_THE_BASIS = (
    "Computed on the basis of the brake as it is: solve the changed brake in full before believing a small growth rate "
    "(squealbox modes --set, or System.replace(M=...) for a mass)"
)


def structural_candidates(small: ReducedBrake) -> list[Candidate]:
    """Every candidate a reduced brake suggests whose full brake is kept."""
    found = [
        parameter_candidate(small, path, about, value, -1.0)
        for path, about, value in small.leaves()
        if path == "friction.static" and value
    ]
    local = _worst(small)
    damped = changeable(small.attached())
    for name, slope, heavier in zip(local.parts, local.modulus.real, local.density.real, strict=True):
        both = (("modulus", slope), ("density", heavier)) if name in damped else ()
        found += [_component(small, name, what, change) for what, change in both if change != 0.0]
    found += [_damping(small, name) for name, share in damped.items() if share > 0.0]
    return [*found, *_masses(small, local)]


def _worst(small: ReducedBrake) -> LocalSensitivity:
    """Derivatives of the mode that grows most, at the present values."""
    found = small.checked()
    k = int(np.argmax(found.eigenvalues.real))
    steady = small.attached().steady
    return local_sensitivity(
        small.whole(), Mode(complex(found.eigenvalues[k]), found.right[:, k], found.left[:, k], steady, k)
    )


def _component(small: ReducedBrake, name: str, what: str, slope: float) -> Candidate:
    sign = -1.0 if slope > 0.0 else 1.0
    word = {"modulus": "stiffer" if sign > 0.0 else "softer", "density": "heavier" if sign > 0.0 else "lighter"}[what]
    return Candidate(
        f"{name} {word}", lambda dose: with_component(small, name, **{what: 1.0 + sign * dose}), SHARES, "-",
        lambda dose: f"with_component(brake, {name!r}, {what}={float(1.0 + sign * dose)!r})",
        lambda dose: f"redesign, {what} of {name} {100.0 * sign * dose:+.3g} %", slow=True,
    )  # fmt: skip


def _damping(small: ReducedBrake, name: str) -> Candidate:
    return Candidate(
        f"{name} more damped", lambda dose: with_component(small, name, damping=dose), FACTORS, "-",
        lambda dose: f"with_component(brake, {name!r}, damping={float(dose)!r})",
        lambda dose: f"a shim or a lossy material, {dose:.3g} times the damping of {name}", slow=True,
    )  # fmt: skip


def _masses(small: ReducedBrake, local: LocalSensitivity) -> Iterator[Candidate]:
    """A mass on the node where a gram calms most, and on the next ones that stand apart from it."""
    taken: list[Any] = []
    for i in np.argsort(local.node_mass.real, kind="stable"):
        if len(taken) == PLACES or local.node_mass[i].real >= 0.0:
            return
        place, node = local.place[i], int(local.node[i])
        if any(np.linalg.norm(place - other) < APART for other in taken):
            continue
        taken.append(place)
        yield _mass(small, node, place)


def _mass(small: ReducedBrake, node: int, place: np.ndarray) -> Candidate:
    where = ", ".join(f"{1e3 * x:.0f}" for x in place)
    return Candidate(
        f"mass on node {node}", lambda dose: with_mass(small, node, dose), MASSES, "kg",
        lambda dose: f"with_mass(brake, {node}, {float(dose)!r})",
        lambda dose: f"{1e3 * dose:.3g} g at ({where}) mm", slow=True,
    )  # fmt: skip
