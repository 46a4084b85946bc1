"""Masses, springs and dampers put onto a brake, and the tuned mass that combines them.

A tuned mass m_a at the row a (a unit vector, or a direction) adds the degree of freedom z with

    m_a z'' + c_a (z' - a.q') + k_a (z - a.q) = 0,    k_a = m_a w^2,  c_a = 2 zeta m_a w,  w = 2 pi frequency

and the opposite forces on the brake. Sources: Den Hartog 1956, Mechanical Vibrations, ch. 3; against self-excited
vibration Habib and Kerschen 2015, Proc. R. Soc. A 471, 20140976.
"""

from typing import Any, ClassVar

import numpy as np
from numpy.typing import ArrayLike

from squealbox.countermeasures.base import Countermeasure, added, direction, extended, outer
from squealbox.parameters import parameter
from squealbox.system import System

OWN = "chosen by the user"


class TunedMass(Countermeasure):
    """A mass on a spring and a damper, tuned to take the energy out of one vibration.

    On an oscillator with negative damping the best tuning is that of Den Hartog only for weak damping; on flutter a
    light damper is best, and it is narrow: see `best_absorber`.

    >>> from squealbox import DrumBrake
    >>> TunedMass(DrumBrake(), on="y", mass=0.05, frequency=1906.0, damping=0.013).system().names
    ('x', 'y', 'absorber')
    """

    title: ClassVar[str] = "Tuned mass"
    source: ClassVar[str] = "Den Hartog 1956; Habib and Kerschen 2015, Proc. R. Soc. A 471"

    on: str
    mass: float = parameter("kg", 0.0, low_open=True, meaning="mass of the absorber", source=OWN)
    frequency: float = parameter("Hz", 0.0, low_open=True, meaning="its own frequency when held", source=OWN)
    damping: float = parameter("-", 0.0, default=0.0, meaning="its damping ratio when held", source=OWN)

    def system(self) -> System:
        """The brake's equation with one more degree of freedom."""
        base = self.brake.system()
        relative, own = self.stretch(base), np.append(np.zeros(base.size), 1.0)
        spring, damper = self.spring_and_damper
        return added(
            extended(base, "absorber"),
            mass=outer(np.asarray(self.mass), own, own),
            damping=outer(damper, relative, relative),
            stiffness=outer(spring, relative, relative),
        )

    def stretch(self, base: System) -> Any:
        """The row (n + 1,) that reads how far the absorber is from where it hangs."""
        return np.append(-direction("TunedMass", "on", base, self.on), 1.0)

    @property
    def spring_and_damper(self) -> tuple[Any, Any]:
        """Stiffness [N/m] and damping [N s/m] between the absorber and the brake."""
        return self.tuned_to(self.frequency, self.damping)

    def tuned_to(self, frequency: ArrayLike, damping: float | np.ndarray) -> tuple[Any, Any]:
        """Those of a frequency [Hz] and a damping ratio (...) of the same mass, unchecked."""
        mass, rate = np.asarray(self.mass), 2.0 * np.pi * np.asarray(frequency)
        return mass * rate**2, 2.0 * damping * mass * rate


class AddedMass(Countermeasure):
    """Mass put onto one degree of freedom, M + m a a'.

    On mode coupling a mass on one degree of freedom moves the onset by m^2/(1 + m), whichever of the two it is.
    """

    title: ClassVar[str] = "Added mass"
    source: ClassVar[str] = "chosen here"

    on: str
    mass: float = parameter("kg", 0.0, meaning="mass put on", source=OWN)

    def system(self) -> System:
        """The brake's equation with the mass."""
        base = self.brake.system()
        row = direction("AddedMass", "on", base, self.on)
        return added(base, mass=outer(self.mass, row, row))


class AddedStiffness(Countermeasure):
    """A spring from one degree of freedom to the frame, or to another one, K + k (a - b)(a - b)'.

    A negative stiffness says that a spring is made softer.
    """

    title: ClassVar[str] = "Added stiffness"
    source: ClassVar[str] = "chosen here"

    on: str
    stiffness: float = parameter("N/m", meaning="stiffness added", source=OWN)
    to: str = ""

    def system(self) -> System:
        """The brake's equation with the spring."""
        base = self.brake.system()
        row = _between(self, base)
        return added(base, stiffness=outer(self.stiffness, row, row))


class AddedDamping(Countermeasure):
    """A damper from one degree of freedom to the frame, or to another one, C + c (a - b)(a - b)'.

    On one degree of freedom of a flutter pair alone it can destabilise.
    """

    title: ClassVar[str] = "Added damping"
    source: ClassVar[str] = "chosen here"

    on: str
    damping: float = parameter("N s/m", 0.0, meaning="damping added", source=OWN)
    to: str = ""

    def system(self) -> System:
        """The brake's equation with the damper."""
        base = self.brake.system()
        row = _between(self, base)
        return added(base, damping=outer(self.damping, row, row))


class Asymmetry(Countermeasure):
    """Two equal stiffnesses drawn apart: `stiffness` is added on one degree of freedom and taken off another.

    The doublet [[k + a, s], [-s, k - a]] of a rotor with circulation s is stable from a = s on: symmetry breaking.
    Source: Spelsberg-Korspeter 2010, Archive of Applied Mechanics 80, 1185-1197.
    """

    title: ClassVar[str] = "Asymmetry"
    source: ClassVar[str] = "Spelsberg-Korspeter 2010, Arch. Appl. Mech. 80, 1185-1197"

    on: str
    against: str
    stiffness: float = parameter("N/m", meaning="added on the one, taken off the other", source=OWN)

    def system(self) -> System:
        """The brake's equation with the two stiffnesses drawn apart."""
        base = self.brake.system()
        more, less = (direction("Asymmetry", name, base, getattr(self, name)) for name in ("on", "against"))
        return added(base, stiffness=outer(self.stiffness, more, more) - outer(self.stiffness, less, less))


def _between(measure: "AddedStiffness | AddedDamping", base: System) -> np.ndarray:
    owner = type(measure).__name__
    row: np.ndarray = direction(owner, "on", base, measure.on)
    return row if measure.to == "" else row - direction(owner, "to", base, measure.to)
