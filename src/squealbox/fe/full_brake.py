"""What a reduced brake keeps of the full one: how to make it at other parameters, the basis and a factor."""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any

import numpy as np

from squealbox.factorisation import Factor
from squealbox.fe.growing_basis import ROWS, GrowingBasis
from squealbox.fe.pencil import SlidingPencil, pencil_of
from squealbox.fe.projection import Projected, modes_on, with_shapes
from squealbox.sparse_sliding import Nearby
from squealbox.system import InvalidSystem, System, as_system


@dataclass(frozen=True, eq=False)
class FullBrake:
    """The full design or system, its basis V (n, m), steady sliding q0 (n,) at the reference, the factor of K0."""

    design: Any
    basis: Any
    steady: Any
    base: Factor
    time: float = 0.0

    left_out_of_files = True

    def at(self, values: Mapping[str, Any]) -> Any:
        """The full design at other parameters, or the full system."""
        return full_system(self.design, values) if isinstance(self.design, System) else self.design.replace(values)

    def component(self, name: str) -> tuple[Any, Any, Any]:
        """V' M V, V' K V (m, m) and V' K q0 (m,) of one component of a brake that meshes itself."""
        if name not in self._components:
            mass, stiffness = self.design.components()[name]
            moved = stiffness @ self.basis
            self._components[name] = self.basis.T @ (mass @ self.basis), self.basis.T @ moved, moved.T @ self.steady
        return self._components[name]

    @cached_property
    def _components(self) -> dict[str, tuple[Any, Any, Any]]:
        return {}

    def system(self, values: Mapping[str, Any]) -> System:
        """The full system at other parameters."""
        return full_system(self.design, values)

    def pencil(self, values: Mapping[str, Any]) -> SlidingPencil:
        """The full matrices about steady sliding at other parameters."""
        return pencil_of(self.system(values), self.time, start=Nearby(self.steady, self.base))

    def checked(self, values: Mapping[str, Any], band: tuple[float, float]) -> Projected:
        """Modes on the basis, with the error against the full brake."""
        onto = GrowingBasis([self.pencil(values)], self.basis)
        return with_shapes(onto, modes_on(onto, 0, self.base, band)[0])

    def missed(
        self, values: Mapping[str, Any], eigenvalue: complex, x: np.ndarray, y: np.ndarray, like: tuple[bool, type]
    ) -> complex | None:
        """The estimate [1/s] of the full brake's eigenvalue less this one's, for its right and left shape x and y (m,).

        To first order what the matrices on the basis lack, to second what the basis does, as `projection` has it. None
        where the contacts are not `like` these: whether they have a cross direction, and the kind of their law.
        """
        pencil, back = self.pencil(values), np.conj(eigenvalue)
        table = pencil.sliding.system.contacts
        if (table.across is not None, type(table.law)) != like:
            return None
        right, left = self.basis @ x, self.basis @ y
        lacks = pencil.residual(eigenvalue, right)
        lacks_left = pencil.K.T @ left + back * (pencil.C.T @ left) + back**2 * (pencil.M @ left)
        slope = np.vdot(left, 2.0 * eigenvalue * (pencil.M @ right) + pencil.C @ right)
        return complex((np.vdot(lacks_left, self.base.solve(lacks)) - np.vdot(left, lacks)) / slope)

    def projected_arrays(self, system: System, known: Mapping[str, Any] | None = None) -> dict[str, Any]:
        """Every field of a system on the basis, measured from q0; what is `known` of it is not computed again."""
        basis, table = self.basis, system.contacts
        load = np.asarray(system.load if not hasattr(system.load, "value") else system.load.value(self.time))
        arrays: dict[str, Any] = dict(known or {})
        for field in ROWS if known is None else ():
            rows = getattr(table, field)
            arrays[field] = None if rows is None else np.asarray(rows @ basis)
        for field in ("M", "C", "K") if known is None else ():
            arrays[field] = basis.T @ (getattr(system, field) @ basis)
        arrays["load"] = basis.T @ (load - system.K @ self.steady)
        arrays["N0"] = table.at("N0", self.time) + table.n @ self.steady
        arrays["V"] = np.array(table.at("V", self.time))
        return arrays


def full_system(design: Any, values: Mapping[str, Any]) -> System:
    """A design's sparse system at other parameters; a bare system takes the coefficients of its one friction law."""
    if not isinstance(design, System):
        return as_system(design.replace(values) if values else design, linear=True)
    if not values:
        return design
    law = design.contacts.law
    inner = {name.removeprefix("friction."): value for name, value in values.items()}
    if isinstance(law, tuple) or not all(name.startswith("friction.") for name in values):
        unknown = ", ".join(values)
        raise InvalidSystem(f"{unknown}: of a bare system only the coefficients of one shared friction law can vary")
    return design.replace(contacts=design.contacts.replace(law=law.replace(inner)))
