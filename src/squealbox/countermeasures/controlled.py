"""A brake under control: loops that sense it and act on it."""

from typing import ClassVar

from squealbox.countermeasures.base import Countermeasure
from squealbox.loops import Loop, check_loops
from squealbox.parameters import ParameterError
from squealbox.system import System


class Controlled(Countermeasure):
    """The brake with loops. `loops` is one loop or several; "loops.0.derivative" names a parameter of the first.

    >>> from squealbox import PID, ModeCoupling, Coulomb, complex_modes
    >>> brake = Controlled(ModeCoupling(friction=Coulomb(0.9), c1=0.02), [PID(on="y", derivative=0.1)])
    >>> complex_modes(brake).outcome
    'completed'
    """

    title: ClassVar[str] = "Controlled brake"
    source: ClassVar[str] = "Hewit and Burdess 1981; Hashemi-Dehkordi, Mailah and Abu-Bakar 2009"

    loops: tuple[Loop, ...] = ()

    def __post_init__(self) -> None:
        super().__post_init__()
        if not self.loops:
            raise ParameterError("Controlled", "loops", self.loops, "one loop or more, such as PID(on='y')")
        try:
            kept = check_loops(self.loops, self.brake.system().names, ValueError)
        except ParameterError:
            raise
        except ValueError as error:
            raise ParameterError("Controlled", "loops", self.loops, str(error)) from error
        object.__setattr__(self, "loops", kept)

    def system(self) -> System:
        """The brake's equation with the loops."""
        base = self.brake.system()
        return base.replace(loops=(*base.loops, *self.loops))
