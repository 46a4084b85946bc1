"""One function for each kind of result; each returns a matplotlib figure. Depends on: the results it draws.

`plot(result)` chooses the function by the kind of result. Every function takes ``axes=`` to draw into a panel of a
larger figure made with `panels`. Matplotlib is loaded at the first drawing.
"""

from squealbox.plots.basins import basin_picture
from squealbox.plots.brakes import brake_drawing
from squealbox.plots.cards import card
from squealbox.plots.contact import contact_comparison
from squealbox.plots.cycles import branch_diagram, cycle_overview
from squealbox.plots.diagrams import amplitude_and_section, bifurcation_diagram, coexistence_region
from squealbox.plots.dispatch import plot
from squealbox.plots.facts import facts
from squealbox.plots.fits import friction_fit
from squealbox.plots.laws import friction_curve
from squealbox.plots.maps import amplitude_map, stability_map
from squealbox.plots.measured import (
    ambient_spectrum,
    calibration_figure,
    damping_line,
    event_tracks,
    model_beside_measurement,
    noise_matrix_figure,
    specific_loudness,
    spectrograms_beside,
)
from squealbox.plots.modes import coalescence
from squealbox.plots.motion import amplitude_course, energy, motion_overview, phase_plane, time_history
from squealbox.plots.optimisation import optimum
from squealbox.plots.points import (
    birth_of_a_cycle,
    crossings,
    damping_split,
    finite_eigenvalues,
    merging_points,
    point_curve,
)
from squealbox.plots.populations import ensemble_overview
from squealbox.plots.reliability import design_point, subset_probability, surrogate
from squealbox.plots.remedies import (
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
from squealbox.plots.spectra import component_growth, loudness, spectrogram, spectrum
from squealbox.plots.stability import (
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
from squealbox.plots.style import drawn, letters, panels, save
from squealbox.plots.sweeps import search_for_a_push, sweep_overview
from squealbox.plots.uncertainty import interval_bounds, morris_effects, sobol_indices, squeal_probability

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
