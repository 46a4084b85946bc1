"""What is done against squeal: designs that hold a design. Depends on: designs, system, friction, loops, stability."""

from squealbox.registers import face

__getattr__, __dir__, __all__ = face(__name__)
