"""What is done against squeal: designs that hold a design."""

from squealbox.registers import face

__getattr__, __dir__, __all__ = face(__name__)
