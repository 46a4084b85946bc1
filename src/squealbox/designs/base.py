"""What every design is: a data sheet that makes a system."""

from typing import ClassVar

from squealbox.parameters import DataSheet
from squealbox.system import System


class Design(DataSheet):
    """A brake on paper: parameters with unit, range and source, and ``system()``, the equation it obeys.

    Every parameter may be an array with leading axes; the system then carries the same axes.
    """

    title: ClassVar[str] = ""
    source: ClassVar[str] = ""

    def system(self) -> System:
        """The equation of motion with these parameters."""
        raise NotImplementedError
