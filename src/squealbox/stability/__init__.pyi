from .boundary import Boundary, stability_boundary
from .contour import map_boundary
from .conventions import as_printed_by, eigenvalues_printed_by
from .crossings import first_crossings
from .eigenvalues import ComplexModes, Mode, complex_modes
from .energy import ModeEnergy, mode_energy
from .exceptional import DampingSplit, ExceptionalPoints, damping_split, exceptional_points
from .hurwitz import routh_hurwitz
from .local_sensitivities import LocalSensitivity, local_sensitivity
from .maps import StabilityMap, stability_map
from .massless import FiniteSpectrum, finite_spectrum
from .mechanisms import Mechanism, mechanism
from .modes_in_band import BandModes, band_modes, certified
from .nonnormal import TransientGrowth, pseudospectrum, transient_growth
from .onset import CriticalValue, CriticalValues, critical_value, critical_values
from .second_mesh import MeshDoubt, mesh_doubt
from .sensitivities import Sensitivity, sensitivity
from .settings import ModeSettings
from .spectra import compiled_eigenvalues
from .squeal_indices import damping_ratio_from, indices, logarithmic_decrement, loss_factor, squeal_index
from .tracking import TrackedModes, TrackedPoint, track, tracked_modes

__all__ = [
    "BandModes",
    "Boundary",
    "ComplexModes",
    "CriticalValue",
    "CriticalValues",
    "DampingSplit",
    "ExceptionalPoints",
    "FiniteSpectrum",
    "LocalSensitivity",
    "Mechanism",
    "MeshDoubt",
    "Mode",
    "ModeEnergy",
    "ModeSettings",
    "Sensitivity",
    "StabilityMap",
    "TrackedModes",
    "TrackedPoint",
    "TransientGrowth",
    "as_printed_by",
    "band_modes",
    "certified",
    "compiled_eigenvalues",
    "complex_modes",
    "critical_value",
    "critical_values",
    "damping_ratio_from",
    "damping_split",
    "eigenvalues_printed_by",
    "exceptional_points",
    "finite_spectrum",
    "first_crossings",
    "indices",
    "local_sensitivity",
    "logarithmic_decrement",
    "loss_factor",
    "map_boundary",
    "mechanism",
    "mesh_doubt",
    "mode_energy",
    "pseudospectrum",
    "routh_hurwitz",
    "sensitivity",
    "squeal_index",
    "stability_boundary",
    "stability_map",
    "track",
    "tracked_modes",
    "transient_growth",
]

# What neighbours may use too; no names of the reference (docs/house.md, Faces).
from .eigenvalues import OneEigenvalue as OneEigenvalue
from .energy import contact_groups as contact_groups
from .family import steady_sliding as steady_sliding
from .in_band import growth_about as growth_about
from .in_band import growth_of as growth_of
from .mode import modal_assurance as modal_assurance
from .mode_tables import mode_table as mode_table
from .mode_tables import table_text as table_text
from .modes_text import modes_html as modes_html
from .second_mesh import ONE_MESH as ONE_MESH
from .sentences import LINEAR as LINEAR
from .sentences import MERGE as MERGE
from .sentences import growth_in_words as growth_in_words
from .sentences import headline as headline
from .sentences import margin_in_words as margin_in_words
from .sentences import plain_words as plain_words
from .spectra import eigenvalues_of as eigenvalues_of
from .spectra import largest_growth as largest_growth
from .state_matrix import spectrum as spectrum
