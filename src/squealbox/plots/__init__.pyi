from .as_data import map_over_two, modes_over_parameter, motion_and_spectrum
from .basins import basin_picture
from .brakes import brake_drawing
from .cards import card
from .contact import contact_comparison
from .cycles import branch_diagram, cycle_overview
from .diagrams import amplitude_and_section, bifurcation_diagram, coexistence_region
from .dispatch import plot
from .fits import friction_fit
from .key_numbers import facts
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
from .paper import drawn_on_paper
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
    "drawn_on_paper",
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
    "map_over_two",
    "mechanism_map",
    "merging_points",
    "mesh_doubt",
    "mode_energy",
    "model_beside_measurement",
    "modes_over_parameter",
    "morris_effects",
    "motion_and_spectrum",
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

# What neighbours may use too; no names of the reference (docs/house.md, Faces).
from .brakes import has_drawing as has_drawing
from .cards import ARRAYS as ARRAYS
from .cards import array_rows as array_rows
from .cards import drawable as drawable
from .cards import has_figure as has_figure
from .cards import parameter_rows as parameter_rows
from .cards import setting_rows as setting_rows
from .key_numbers import shown as shown
from .modes import followed as followed
from .modes import unstable_stretches as unstable_stretches
from .modes import upper_branches as upper_branches
from .paper import KINDS as KINDS
from .paper import LARGEST as LARGEST
from .style import FORMATS as FORMATS
from .style import drawing as drawing
from .style import figure_of as figure_of
from .style import styled as styled
from .surfaces import contact_pressure as contact_pressure
from .surfaces import largest_motion as largest_motion
from .surfaces import mode_on_surface as mode_on_surface
from .surfaces import outline as outline
from .sweeps import numeric_answers as numeric_answers
