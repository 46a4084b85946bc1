"""Finite-element brakes: sparse solvers, modes with an error bar, reduction. Depends on: system, designs."""

from squealbox.factorisation import Factor, SingularMatrix, factor
from squealbox.fe.assembled import AssembledBrake, StructureFiles
from squealbox.fe.certificate import Certificate, certificate
from squealbox.fe.disc_brake import Backplates, Disc, DiscBrake, Pads, Springs, free_disc_modes
from squealbox.fe.export import write_shape
from squealbox.fe.interfaces import CoordinateSystem, Interface, Rotation
from squealbox.fe.meshed import Material, MeshedBrake, Preload
from squealbox.fe.meshed_drum import Anchors, Drum, MeshedDrumBrake, Shoes, free_drum_modes
from squealbox.fe.modified import with_component, with_mass
from squealbox.fe.pencil import Pencil, pencil_of
from squealbox.fe.published import PublishedDiscBrake
from squealbox.fe.quadratic import FullModes, full_modes
from squealbox.fe.readers import MatrixFileError, open_matrices
from squealbox.fe.real_modes import RealModes, count_below, real_modes
from squealbox.fe.reduced_brake import ReducedBrake, Reduction
from squealbox.fe.reduction import reduce
from squealbox.fe.structure import Structure, read_matrices, read_structure
from squealbox.fe.units import UNITS

__all__ = [
    "UNITS",
    "Anchors",
    "AssembledBrake",
    "Backplates",
    "Certificate",
    "CoordinateSystem",
    "Disc",
    "DiscBrake",
    "Drum",
    "Factor",
    "FullModes",
    "Interface",
    "Material",
    "MatrixFileError",
    "MeshedBrake",
    "MeshedDrumBrake",
    "Pads",
    "Pencil",
    "Preload",
    "PublishedDiscBrake",
    "RealModes",
    "ReducedBrake",
    "Reduction",
    "Rotation",
    "Shoes",
    "SingularMatrix",
    "Springs",
    "Structure",
    "StructureFiles",
    "certificate",
    "count_below",
    "factor",
    "free_disc_modes",
    "free_drum_modes",
    "full_modes",
    "open_matrices",
    "pencil_of",
    "read_matrices",
    "read_structure",
    "real_modes",
    "reduce",
    "with_component",
    "with_mass",
    "write_shape",
]
