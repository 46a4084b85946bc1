"""Is steady sliding stable? Depends on: system, continuation, result, compiled."""

from squealbox.stability.band_modes import BandModes, band_modes, certified
from squealbox.stability.boundary import Boundary, stability_boundary
from squealbox.stability.contour import map_boundary
from squealbox.stability.conventions import as_printed_by, eigenvalues_printed_by
from squealbox.stability.crossings import first_crossings
from squealbox.stability.eigenvalues import ComplexModes, Mode, complex_modes
from squealbox.stability.energy import ModeEnergy, mode_energy
from squealbox.stability.exceptional import DampingSplit, ExceptionalPoints, damping_split, exceptional_points
from squealbox.stability.indices import damping_ratio_from, indices, logarithmic_decrement, loss_factor, squeal_index
from squealbox.stability.local_sensitivity import LocalSensitivity, local_sensitivity
from squealbox.stability.maps import StabilityMap, stability_map
from squealbox.stability.massless import FiniteSpectrum, finite_spectrum
from squealbox.stability.mechanism import Mechanism, mechanism
from squealbox.stability.nonnormal import TransientGrowth, pseudospectrum, transient_growth
from squealbox.stability.onset import CriticalValue, CriticalValues, critical_value, critical_values
from squealbox.stability.routh_hurwitz import routh_hurwitz
from squealbox.stability.second_mesh import MeshDoubt, mesh_doubt
from squealbox.stability.sensitivity import Sensitivity, sensitivity
from squealbox.stability.settings import ModeSettings
from squealbox.stability.spectra import compiled_eigenvalues
from squealbox.stability.tracking import TrackedModes, TrackedPoint, track, tracked_modes

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
