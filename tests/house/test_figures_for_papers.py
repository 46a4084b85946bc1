"""Figures for papers: width, style and the user's own settings, text that stays text, numbers that stay apart."""

import re
from itertools import pairwise

import matplotlib as mpl
import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

from result_examples import EXAMPLES
from squealbox import (
    Contact,
    Coulomb,
    DrumBrake,
    LinearSlope,
    ParameterError,
    System,
    branch,
    complex_modes,
    hopf_point,
    plot,
    plots,
    simulate,
)
from squealbox.plots import style

MOTION = simulate(DrumBrake(), 0.02, times=2001)
MODES = complex_modes(DrumBrake())


@pytest.mark.parametrize("width", [3.4, 5.0, 7.0])
def test_a_figure_is_as_wide_as_asked_and_no_panel_is_narrow(width):
    figure = plot(MOTION, width=width)
    assert figure.get_figwidth() == width
    figure.draw_without_rendering()
    for panel in figure.axes:
        assert panel.get_position().width * width > 1.0


def test_height_and_style_are_taken():
    figure = plot(MODES, width=4.0, height=5.0, style={"axes.facecolor": "#abcdef"})
    assert tuple(figure.get_size_inches()) == (4.0, 5.0)
    assert figure.axes[0].get_facecolor() == mpl.colors.to_rgba("#abcdef")
    with pytest.raises(ParameterError, match=r"plot\.width = 'wide': expected a finite number in"):
        plot(MODES, width="wide")


def test_what_the_user_has_set_goes_before_the_look_of_the_house():
    with mpl.rc_context({"font.family": "monospace", "axes.labelsize": 12.0}):
        label = plot(MODES).axes[0].xaxis.label
    assert (label.get_fontfamily(), label.get_fontsize()) == (["monospace"], 12.0)
    label = plot(MODES).axes[0].xaxis.label
    assert (label.get_fontfamily(), label.get_fontsize()) == (["sans-serif"], 8.0)


def test_text_stays_text_in_svg_and_pdf(tmp_path):
    figure = plot(MODES)
    figure.savefig(tmp_path / "own.svg")
    (own,) = plots.save(figure, tmp_path / "saved", ["svg"])
    for path in (tmp_path / "own.svg", own):
        assert ">growth rate [1/s]</text>" in path.read_text(encoding="utf-8")
    (pdf,) = plots.save(figure, tmp_path / "figure.pdf")
    assert pdf.read_bytes().startswith(b"%PDF")
    assert b"/FontFile2" in pdf.read_bytes()  # a font, not outlines of letters


def test_numbers_along_an_axis_stay_apart():
    figure, panel = plots.panels(width=1.6, height=1.2)
    panel.set_xlim(-2345.0, 2345.0)
    style.drawn(figure)
    assert crowded(figure) == []


def crowded(figure) -> list[str]:
    """Axes of a drawn figure whose numbers run into each other, by their labels."""
    found, renderer = [], FigureCanvasAgg(figure).get_renderer()
    for panel in figure.axes:
        for axis, side in ((panel.xaxis, 0), (panel.yaxis, 1)):
            low, high = sorted(axis.get_view_interval())
            known = zip(axis.get_majorticklocs(), axis.get_ticklabels(), strict=False)
            boxes = [label.get_window_extent(renderer) for at, label in known if low <= at <= high and label.get_text()]
            spans = sorted((box.min[side], box.max[side]) for box in boxes)
            found += [axis.get_label_text()] * any(after[0] < before[1] for before, after in pairwise(spans))
    return found


def test_no_offset_is_printed_over_a_label():
    text = style.drawn(EXAMPLES["HopfPoint"]().plot(), "svg").decode()
    assert f"{style.MINUS}0.33" in re.sub(r"\s", "", text)  # the axis counts from the point


def test_a_branch_that_goes_straight_up_is_drawn_straight_and_has_no_folds():
    """Two springs and constant friction: the equation is linear while sliding, and one friction has every amplitude."""
    pad = Contact(name="pad", n=[0.0, 3e6], d=[1.0, 0.0], t=[1.0, 0.0], N0=5e3, V=1.0, law=Coulomb(0.3))
    system = System(np.eye(2), 10.0 * np.eye(2), [[3.8e6, 1e6], [1e6, 4e6]], 0.0, (pad,))
    found = branch(system, "friction.static", (0.1, 1.5), hopf_point(system, "friction.static", (0.1, 1.5)), points=12)
    assert np.ptp(found.value) < 1e-9
    assert len(found.special("fold")) == 0
    assert "it goes straight up" in found.summary()
    panel = found.plot().axes[0]
    assert panel.get_xlabel() == "friction.static [-]"
    left, right = panel.get_xlim()
    assert right - left > 1e-7
    assert "straight" not in EXAMPLES["Branch"]().summary()  # the twin


@pytest.mark.parametrize("law", [Coulomb(0.4), LinearSlope(0.45, -0.01)])
def test_a_law_that_hardly_falls_is_not_drawn_on_the_frame(law):
    bottom, top = plot(law).axes[0].get_ylim()
    assert bottom == 0.0
    assert top > 1.05 * law.mu(0.0)


def test_numbers_stay_on_the_paper_and_parameters_have_their_unit():
    figure = EXAMPLES["Boundary"]().plot()
    style.drawn(figure, dots=120)  # where ticks are thinned, and others come to the end of the axis
    figure.set_dpi(120)
    panel, renderer = figure.axes[0], FigureCanvasAgg(figure).get_renderer()
    low, high = panel.get_xlim()
    shown = [label for at, label in zip(panel.get_xticks(), panel.get_xticklabels(), strict=True) if low <= at <= high]
    assert max(label.get_window_extent(renderer).x1 for label in shown) <= figure.bbox.x1
    curve = EXAMPLES["PointCurve"]().plot().axes[0]
    assert (curve.get_xlabel(), curve.get_ylabel()) == ("friction.static [-]", "k1 [N/m]")


def test_branches_that_lie_decades_apart_share_a_logarithmic_axis():
    from squealbox.plots.cycles import _floor

    assert _floor([np.array([1.0, 2.0]), np.array([3.0, 1.0])]) == 0.0
    assert 0.0 < _floor([np.array([1.0, 2.0]), np.array([300.0, 100.0])]) < 1.1


@pytest.mark.parametrize(
    ("label", "values", "read", "last"),
    [
        ("k1 [N/m]", [1e7, 4e7], "k1 [MN/m]", "40"),
        ("damping [N s/m]", [0.0, 3e4], "damping [kN s/m]", "30"),
        ("residual [-]", [0.0, 4e-15], "residual [10⁻¹⁵]", "4"),
        ("rate [1/s²]", [0.0, 4e5], "rate [10⁵ 1/s²]", "4"),
        ("area [m²]", [0.0, 4e-5], "area [10⁻⁵ m²]", "4"),  # a prefix would be squared
        ("load [N]", [0.0, 4e3], "load [N]", "4000"),
    ],
)
def test_a_power_of_ten_stands_in_the_unit(label, values, read, last):
    figure, panel = plots.panels(width=4.0)
    panel.plot([0.0, 1.0], values)
    panel.set(ylabel=label, ylim=values)
    for _ in range(2):  # a second file has the same numbers
        style.drawn(figure)
        assert panel.get_ylabel() == read
        assert panel.yaxis.get_major_formatter().get_offset() == ""
        assert panel.get_yticklabels()[-1].get_text() == last


def test_a_branch_begins_where_it_is_born():
    brake = DrumBrake(friction=LinearSlope(0.3, -0.05))
    onset = hopf_point(brake, "friction.static", (0.1, 0.6))
    followed = branch(brake, "friction.static", (0.1, 0.6), onset, points=4)
    lines = plots.branch_diagram(followed, estimates=False).axes[0].lines
    rise = next(each for each in lines if each.get_xdata()[0] == pytest.approx(float(onset.value), abs=1e-15))
    assert rise.get_ydata()[0] == 0.0
    assert rise.get_xdata()[-1] == followed.value[0]
    mark = next(each for each in lines if each.get_label() == "onset of instability")
    assert mark.get_xdata()[0] == float(onset.value)


def test_what_is_dissipated_is_drawn_as_the_audit_has_it():
    motion = simulate(DrumBrake(friction=LinearSlope(0.45, -0.05)), 0.002)
    (drawn,) = [each for each in plots.energy(motion).axes[0].lines if each.get_label().startswith("dissipated")]
    assert np.all(drawn.get_ydata()[1:] > 0.0)
    assert drawn.get_ydata()[-1] / drawn.get_ydata()[1] == pytest.approx(
        motion.energy.dissipated[-1] / motion.energy.dissipated[1], rel=1e-9
    )
