from squealbox.factorisation import Factor, SingularMatrix, factor

from .assembled import AssembledBrake, StructureFiles
from .certificates import Certificate, certificate
from .disc_brake import Backplates, Disc, DiscBrake, Pads, Springs, free_disc_modes
from .export import write_shape
from .interfaces import CoordinateSystem, Interface, Rotation
from .meshed import Material, MeshedBrake, Preload
from .meshed_drum import Anchors, Drum, MeshedDrumBrake, Shoes, free_drum_modes
from .modified import with_component, with_mass
from .pencil import Pencil, pencil_of
from .published import PublishedDiscBrake
from .quadratic import FullModes, full_modes
from .readers import MatrixFileError, open_matrices
from .reduced_brake import ReducedBrake, Reduction
from .reduction import reduce
from .structure import Structure, read_matrices, read_structure
from .undamped_modes import RealModes, count_below, real_modes
from .units import UNITS

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

# What neighbours may use too; no names of the reference (docs/house.md, Faces).
from .band_spectrum import band_pairs as band_pairs
from .band_spectrum import condensed as condensed
from .certificates import certified_band as certified_band
from .describing import described as described
from .growing_basis import GrowingBasis as GrowingBasis
from .mode_shapes import write_uff as write_uff
from .mode_shapes import write_vtu as write_vtu
from .modified import changeable as changeable
from .pencil import MOST_DAMPED as MOST_DAMPED
from .pencil import vibrating as vibrating
from .projection import Projected as Projected
from .projection import basis_for as basis_for
from .projection import modes_on as modes_on
from .projection import refined as refined
from .projection import with_shapes as with_shapes
from .reduced_files import load_reduced as load_reduced
from .reduced_files import save_reduced as save_reduced
from .reduction import MOST_AXES as MOST_AXES
from .small import Small as Small
from .surface import with_surface as with_surface
