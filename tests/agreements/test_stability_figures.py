"""Every stability result has its figure, through the one door `plot`, and the figure shows what the result holds."""

import warnings

import numpy as np
import pytest

from squealbox.countermeasures import TunedMass
from squealbox.designs import DrumBrake
from squealbox.plots import coalescence, mechanism_map, plot, root_locus
from squealbox.plots.style import drawn
from squealbox.stability import (
    critical_value,
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


@pytest.mark.parametrize(("traced", "within"), [(True, 1e-3), (False, 1e-3)])
def test_colour_ends_at_the_boundary(traced, within) -> None:
    """Stable up to the critical friction; a cell is 0.05 wide."""
    axes = {"friction.static": np.linspace(0.1, 0.6, 11), "load": np.linspace(500.0, 2e3, 7)}
    spans = {name: (float(x[0]), float(x[-1])) for name, x in axes.items()}
    boundary = stability_boundary(DrumBrake(), spans) if traced else None
    panel = mechanism_map(stability_map(DrumBrake(), axes), boundary=boundary).axes[0]
    assert "boundary" in [text.get_text() for text in panel.get_legend().get_texts()]
    outline = next(each.get_clip_path() for each in panel.collections if getattr(each, "hatches", [None]) != [None])
    path, _ = outline.get_transformed_path_and_affine()  # in the units of the axes
    for load in axes["load"][1:-1]:
        edge = critical_value(DrumBrake().replace({"load": load}), "friction.static", spans["friction.static"]).value
        beside = np.linspace(edge - 0.05, edge + 0.05, 201)
        inside = [path.contains_point((x, load)) for x in beside]
        assert beside[np.argmax(inside)] == pytest.approx(edge, abs=within)


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


@pytest.mark.parametrize(("low", "high"), [(100.0, 800.0), (10.0, 20.0)])
def test_a_map_that_is_stable_all_over_has_the_axes_it_was_asked_for(low, high) -> None:
    found = stability_map(
        DrumBrake(), {"friction.static": np.linspace(0.05, 0.2, 5), "load": np.linspace(low, high, 5)}
    )
    assert np.all(found.growth_rate < 0.0)
    panel = plot(found).axes[0]
    assert (panel.get_xlim(), panel.get_ylim()) == ((0.05, 0.2), (low, high))


def test_what_all_contacts_share_and_what_a_held_brake_has_is_drawn_with_its_unit() -> None:
    held = TunedMass(DrumBrake(), on="x", mass=0.05, frequency=2000.0)
    for brake in (held, DrumBrake().system()):
        axes = {"friction.static": np.linspace(0.1, 0.5, 3), "sliding_speed": np.linspace(0.1, 1.0, 3)}
        panel = plot(stability_map(brake, axes)).axes[0]
        assert (panel.get_xlabel(), panel.get_ylabel()) == ("friction.static [-]", "sliding_speed [m/s]")
    assert [held.unit_of(name) for name in ("k3", "brake.k3", "mass", "load")] == ["N/m", "N/m", "kg", "N"]
    names = ("normal_force", "contacts.1.V", "K", "friction", "nothing")
    assert [DrumBrake().system().unit_of(name) for name in names] == ["N", "m/s", "N/m", "", ""]


def test_of_many_modes_those_that_may_grow_are_named_and_the_others_grey() -> None:
    """Forty modes in a legend hid the curves and pushed the figure out of its frame."""
    mu = np.linspace(0.0, 1.0, 21)
    growth = np.tile(-10.0 - np.arange(40.0), (mu.size, 1))
    growth[:, 17] = -5.0 + 20.0 * mu
    values = growth + 2j * np.pi * np.linspace(500.0, 9000.0, 40)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        figure = coalescence(mu, np.concatenate([values, values.conj()], axis=1))
        drawn(figure, "png")
    above, below = figure.axes
    assert [text.get_text() for text in above.get_legend().get_texts()] == ["mode 1", "mode 2", "mode 3", "mode 18"]
    assert len(above.get_lines()) == 40  # all are drawn
    assert below.get_ylim()[1] > 15.0
    few = coalescence(mu, np.concatenate([values[:, 14:19], values[:, 14:19].conj()], axis=1)).axes[0]
    assert len(few.get_legend().get_texts()) == 5  # the twin: a few modes are all named


def test_a_map_of_one_parameter_is_refused() -> None:
    with pytest.raises(ValueError, match="expected two parameters"):
        mechanism_map(stability_map(DrumBrake(), {"load": [1e3, 2e3]}))
