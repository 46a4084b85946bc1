"""Finite-element brakes: sparse solvers, modes with an error bar, reduction. Depends on: system, designs."""

from squealbox.factorisation import Factor, SingularMatrix, factor
from squealbox.fe.certificate import Certificate, certificate
from squealbox.fe.pencil import Pencil, pencil_of
from squealbox.fe.published import PublishedDiscBrake
from squealbox.fe.quadratic import FullModes, full_modes
from squealbox.fe.real_modes import RealModes, count_below, real_modes
from squealbox.fe.reduced_brake import ReducedBrake, Reduction
from squealbox.fe.reduction import reduce

__all__ = [
    "Certificate",
    "Factor",
    "FullModes",
    "Pencil",
    "PublishedDiscBrake",
    "RealModes",
    "ReducedBrake",
    "Reduction",
    "SingularMatrix",
    "certificate",
    "count_below",
    "factor",
    "full_modes",
    "pencil_of",
    "real_modes",
    "reduce",
]
