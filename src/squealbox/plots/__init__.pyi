from .basins import basin_picture
from .brakes import brake_drawing
from .cards import card
from .contact import contact_comparison
from .cycles import branch_diagram, cycle_overview
from .diagrams import amplitude_and_section, bifurcation_diagram, coexistence_region
from .dispatch import plot
from .facts import facts
from .fits import friction_fit
from .laws import friction_curve
from .maps import amplitude_map, stability_map
from .measured import (
    ambient_spectrum,
    calibration_figure,
    damping_line,
    event_tracks,
    model_beside_measurement,
    noise_matrix_figure,
    specific_loudness,
    spectrograms_beside,
)
from .modes import coalescence
from .motion import amplitude_course, energy, motion_overview, phase_plane, time_history
from .optimisation import optimum
from .points import birth_of_a_cycle, crossings, damping_split, finite_eigenvalues, merging_points, point_curve
from .populations import ensemble_overview
from .reliability import design_point, subset_probability, surrogate
from .remedies import (
    countermeasure_drawing,
    detuning_map,
    loop_locus,
    loop_run,
    nyquist_curve,
    placement_figure,
    poles_figure,
    push_figure,
    remedies_figure,
)
from .spectra import component_growth, loudness, spectrogram, spectrum
from .stability import (
    boundary_curves,
    eigenvalues,
    local_sensitivity,
    mechanism_map,
    mesh_doubt,
    mode_energy,
    root_locus,
    sensitivity,
    tracked_modes,
    transient_growth,
)
from .style import drawn, letters, panels, save
from .sweeps import search_for_a_push, sweep_overview
from .uncertainty import interval_bounds, morris_effects, sobol_indices, squeal_probability

__all__ = [
    "ambient_spectrum",
    "amplitude_and_section",
    "amplitude_course",
    "amplitude_map",
    "basin_picture",
    "bifurcation_diagram",
    "birth_of_a_cycle",
    "boundary_curves",
    "brake_drawing",
    "branch_diagram",
    "calibration_figure",
    "card",
    "coalescence",
    "coexistence_region",
    "component_growth",
    "contact_comparison",
    "countermeasure_drawing",
    "crossings",
    "cycle_overview",
    "damping_line",
    "damping_split",
    "design_point",
    "detuning_map",
    "drawn",
    "eigenvalues",
    "energy",
    "ensemble_overview",
    "event_tracks",
    "facts",
    "finite_eigenvalues",
    "friction_curve",
    "friction_fit",
    "interval_bounds",
    "letters",
    "local_sensitivity",
    "loop_locus",
    "loop_run",
    "loudness",
    "mechanism_map",
    "merging_points",
    "mesh_doubt",
    "mode_energy",
    "model_beside_measurement",
    "morris_effects",
    "motion_overview",
    "noise_matrix_figure",
    "nyquist_curve",
    "optimum",
    "panels",
    "phase_plane",
    "placement_figure",
    "plot",
    "point_curve",
    "poles_figure",
    "push_figure",
    "remedies_figure",
    "root_locus",
    "save",
    "search_for_a_push",
    "sensitivity",
    "sobol_indices",
    "specific_loudness",
    "spectrogram",
    "spectrograms_beside",
    "spectrum",
    "squeal_probability",
    "stability_map",
    "subset_probability",
    "surrogate",
    "sweep_overview",
    "time_history",
    "tracked_modes",
    "transient_growth",
]
