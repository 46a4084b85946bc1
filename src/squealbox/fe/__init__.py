"""Finite-element brakes: sparse solvers, modes with an error bar, reduction. Depends on: system, designs."""

from squealbox.registers import face

__getattr__, __dir__, __all__ = face(__name__)
