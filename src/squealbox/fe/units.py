"""Systems of units of finite-element models: no exported file says its own, so a user does."""

from dataclasses import dataclass
from typing import Any

import numpy as np

from squealbox.parameters import ParameterError, known_names


@dataclass(frozen=True)
class UnitSystem:
    """What one unit of length [m], mass [kg] and time [s] is in SI."""

    length: float
    mass: float
    time: float

    @property
    def energy(self) -> float:
        """One unit of energy in J."""
        return self.mass * self.length**2 / self.time**2

    def scales(self, labels: np.ndarray | None, size: int) -> Any:
        """What one unit of each freedom is in SI, shape (n,): a length for displacements, 1 for rotations.

        Freedoms without labels are taken as displacements.
        """
        if labels is None:
            return np.full(size, self.length)
        direction = np.asarray(labels)[:, 1]
        return np.where((direction >= 4) & (direction <= 6), 1.0, self.length)


INCH, POUND_FORCE = 0.0254, 4.4482216152605
UNITS = {
    "SI": UnitSystem(1.0, 1.0, 1.0),
    "m kg s": UnitSystem(1.0, 1.0, 1.0),
    "mm t s": UnitSystem(1e-3, 1e3, 1.0),
    "mm kg ms": UnitSystem(1e-3, 1.0, 1e-3),
    "mm g ms": UnitSystem(1e-3, 1e-3, 1e-3),
    "mm kg s": UnitSystem(1e-3, 1.0, 1.0),
    "in lbf s": UnitSystem(INCH, POUND_FORCE / INCH, 1.0),
}


def unit_system(units: str | None) -> UnitSystem:
    """The preset of that name; ``mm-t-s`` and ``mm t s`` are the same.

    Raises `ParameterError` for none or an unknown one: a file does not say its units.

    >>> unit_system("mm-t-s").length
    0.001
    """
    if units is None:
        raise ParameterError("structure", "units", None, f"the units of the matrices, {known_names('', list(UNITS))}")
    name = units.replace("-", " ").replace("_", " ").replace(",", " ")
    name = " ".join(name.split())
    if name not in UNITS:
        raise ParameterError("structure", "units", units, known_names(name, list(UNITS)))
    return UNITS[name]
