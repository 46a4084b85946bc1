"""Finite-element brakes: sparse solvers, modes with an error bar, reduction."""

from squealbox.registers import face

__getattr__, __dir__, __all__ = face(__name__)
