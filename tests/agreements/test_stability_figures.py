"""Every stability result has its figure, through the one door `plot`, and the figure shows what the result holds."""

import numpy as np
import pytest

from squealbox.designs import DrumBrake
from squealbox.plots import mechanism_map, plot, root_locus
from squealbox.stability import (
    mode_energy,
    sensitivity,
    stability_boundary,
    stability_map,
    tracked_modes,
    transient_growth,
)

BOUNDS = {"friction.static": (0.1, 0.6), "load": (100.0, 5e3)}


@pytest.mark.parametrize("analysis", [mode_energy, sensitivity, transient_growth])
def test_figures_of_one_design(analysis) -> None:
    assert len(plot(analysis(DrumBrake())).axes) == 1


def test_figures_of_tracks() -> None:
    tracked = tracked_modes(DrumBrake(), "friction.static", np.linspace(0.1, 0.4, 31))
    assert len(plot(tracked).axes) == 2
    locus = root_locus(tracked).axes[0]
    drawn = np.concatenate([line.get_xdata() for line in locus.get_lines()])
    assert np.nanmax(drawn) == pytest.approx(np.max(tracked.growth_rate))


def test_map_with_its_boundary() -> None:
    axes = {name: np.linspace(*span, 21) for name, span in BOUNDS.items()}
    boundary = stability_boundary(DrumBrake(), BOUNDS)
    panel = mechanism_map(stability_map(DrumBrake(), axes), boundary=boundary, scales={"load": (1e-3, "kN")}).axes[0]
    assert panel.get_ylabel() == "load [kN]"
    assert np.max(panel.get_lines()[0].get_ydata()) == pytest.approx(np.max(boundary.y) * 1e-3)
    assert len(plot(boundary).axes) == 1
    labels = [text.get_text() for text in panel.get_legend().get_texts()]
    assert labels[0] == "stable"
    assert "flutter" in labels


def test_a_map_of_one_parameter_is_refused() -> None:
    with pytest.raises(ValueError, match="expected two parameters"):
        mechanism_map(stability_map(DrumBrake(), {"load": [1e3, 2e3]}))
