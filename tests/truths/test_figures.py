"""Figures show the numbers they are given, in the units they name, and read in grey."""

import re
import subprocess
import sys
from types import SimpleNamespace

import numpy as np
import pytest

from squealbox import plots, words
from squealbox.designs import DrumBrake
from squealbox.friction import Coulomb, LinearSlope, Stribeck
from squealbox.plots import style
from squealbox.plots.modes import followed, unstable_stretches
from squealbox.result import Outcome
from squealbox.signals import SignalError, spectrogram, spectrum
from squealbox.stability import complex_modes
from squealbox.transient.trajectory import Trajectory
from squealbox.transient.verdicts import verdict

T = np.linspace(0.0, 0.05, 2501)
OMEGA = 2.0 * np.pi * 2000.0
MUS = np.linspace(0.0, 0.55, 56)


def motion(t=T):
    envelope = 1e-4 * np.exp(-60.0 * t)
    q = np.column_stack([envelope * np.sin(OMEGA * t), 0.5 * envelope * np.cos(OMEGA * t)])
    qd = np.column_stack([OMEGA * envelope * np.cos(OMEGA * t), -0.5 * OMEGA * envelope * np.sin(OMEGA * t)])
    return SimpleNamespace(t=t, q=q, qd=qd, system=SimpleNamespace(names=("x", "y")))


def trajectory(t=T, outcome=None):
    """A trajectory written down, with works that make its audit close to nothing in particular."""
    moved, system = motion(t), DrumBrake().system()
    none, contacts = np.zeros(t.size), np.zeros((t.size, 2))
    return Trajectory(
        t=t, q=moved.q, qd=moved.qd, normal_force=contacts, sliding_velocity=contacts, friction_force=contacts,
        mode=contacts, work_friction=contacts + 1e-3 * t[:, None], work_load=1e-4 * t, work_circulation=none,
        work_dissipated=2e-3 * t, work_opening=none, work_impact=none, event_time=none[:0], event_contact=none[:0],
        event_mode=none[:0], inputs={"system": system}, outcome=outcome or Outcome(),
    )  # fmt: skip


def modes(**changes):
    return complex_modes(DrumBrake(friction=LinearSlope(MUS, -0.05), **changes))


ANGLES = np.linspace(20.0, 160.0, 15)


def growth():
    angles = np.deg2rad(ANGLES)
    brake = DrumBrake(friction=LinearSlope(0.33, -0.05), theta1=angles[None, :], theta2=angles[:, None])
    return complex_modes(brake).largest_growth_rate


DRAWN = {
    "time_history": lambda axes=None: plots.time_history(motion(), dof="x", verdict=verdict(motion()), axes=axes),
    "phase_plane": lambda axes=None: plots.phase_plane(motion(), axes=axes),
    "spectrum": lambda axes=None: plots.spectrum(motion(), axes=axes),
    "logarithmic spectrum": lambda axes=None: plots.spectrum(
        spectrum(motion()), logarithmic=True, frequency_unit="rad/s", axes=axes
    ),
    "spectrogram": lambda axes=None: plots.spectrogram(spectrogram(motion()), axes=axes),
    "friction_curve": lambda axes=None: plots.friction_curve(
        {"a": Coulomb(0.3), "b": Stribeck(0.4, 0.2, 0.1)}, operating=(0.1, 0.3), speed=0.2, axes=axes
    ),
    "stability_map": lambda axes=None: plots.stability_map(
        ANGLES, ANGLES, growth(), x_name="theta 1", x_unit="°", y_name="theta 2", y_unit="°", axes=axes
    ),
    "amplitude_course": lambda axes=None: plots.amplitude_course(verdict(motion()), axes=axes),
}
PAIRS = {
    "coalescence": lambda axes=None: plots.coalescence(MUS, modes(), axes=axes),
    "energy": lambda axes=None: plots.energy(trajectory(), axes=axes),
}


def labels(figure):
    """The labels of all axes that have one; shared ones of inner panels are empty."""
    return [text for axes in figure.axes for text in (axes.get_xlabel(), axes.get_ylabel()) if text]


@pytest.mark.parametrize("name", [*DRAWN, *PAIRS])
def test_every_axis_has_its_unit_and_the_figure_is_drawn_without_a_warning(name, tmp_path):
    figure = {**DRAWN, **PAIRS}[name]()
    assert len(labels(figure)) >= 2
    for text in labels(figure):
        assert re.search(r"\[[^\]]+\]$", text), f"{text!r} has no unit"
    assert [path.suffix for path in plots.save(figure, tmp_path / "figure")] == [".png", ".svg"]


@pytest.mark.parametrize("name", DRAWN)
def test_every_function_draws_into_a_panel_of_another_figure(name):
    figure, axes = plots.panels(1, 2)
    assert DRAWN[name](axes=axes[1]) is figure
    assert axes[1].has_data()
    assert not axes[0].has_data()


@pytest.mark.parametrize("name", PAIRS)
def test_two_panel_figures_draw_into_a_column_of_another(name):
    figure, axes = plots.panels(2, 2)
    assert PAIRS[name](axes=axes[:, 1]) is figure
    assert [panel.has_data() for panel in axes.flat] == [False, True, False, True]


def test_the_numbers_drawn_are_the_numbers_given():
    panel = plots.time_history(motion()).axes[0]
    assert panel.get_xlabel() == "time [ms]"
    assert panel.get_ylabel() == "displacement [µm]"
    assert panel.lines[0].get_xdata() == pytest.approx(1e3 * T)
    assert panel.lines[0].get_ydata() == pytest.approx(1e6 * motion().q[:, 0])
    forced = plots.time_history(motion(), unit="mm", time_unit="s").axes[0]
    assert forced.get_ylabel() == "displacement [mm]"
    assert forced.lines[0].get_ydata() == pytest.approx(1e3 * motion().q[:, 0])
    assert plots.time_history(motion(), dof=["x", "y"]).axes[0].get_legend() is not None


def test_the_peak_is_named_in_the_unit_of_the_axis():
    for unit, value in (("kHz", "2"), ("rad/s", "12566"), ("Hz", "2000")):
        panel = plots.spectrum(motion(), frequency_unit=unit).axes[0]
        assert value in [text.get_text() for text in panel.texts]
    assert any("Hann window, resolution 20 Hz" in text.get_text() for text in panel.texts)


def test_coalescence_names_the_onset_and_shades_what_is_beyond():
    above, below = plots.coalescence(MUS, modes()).axes
    assert len(above.lines) == 2
    low, high = map(float, re.search(r"between ([\d.]+) and ([\d.]+)", below.texts[0].get_text()).groups())
    assert low < 0.3327 < high  # the onset of the consistent reading
    assert high - low == pytest.approx(0.01)
    assert not plots.coalescence(MUS[:20], modes().eigenvalues[:20]).axes[1].texts
    with pytest.raises(ValueError, match=r"shape \(56, 4\) for 3 values"):
        plots.coalescence([1.0, 2.0, 3.0], modes())


def test_branches_are_followed_through_a_crossing():
    s = np.linspace(-1.0, 1.0, 21)
    crossing = np.column_stack([2j + 1j * s, 2j - 1j * s])
    ordered = np.take_along_axis(crossing, np.argsort(crossing.imag, axis=1), axis=1)
    slopes = np.diff(followed(ordered).imag, axis=0)
    assert np.allclose(slopes, slopes[0])
    assert not np.allclose(np.diff(ordered.imag, axis=0), slopes)  # the twin: sorted branches have a kink


def test_unstable_stretches_end_where_the_line_crosses_zero():
    values = np.linspace(0.0, 4.0, 5)
    assert unstable_stretches(values, np.array([1.0, -1.0, -1.0, 3.0, 1.0])) == [(0.0, 0.5), (2.25, 4.0)]
    assert unstable_stretches(values, -np.ones(5)) == []


def test_a_map_may_be_yes_or_no_or_unknown_in_places():
    known = growth()
    words = lambda figure: [text.get_text() for text in figure.axes[0].get_legend().get_texts()]  # noqa: E731
    assert words(plots.stability_map(ANGLES, ANGLES, known)) == ["stable", "unstable"]
    assert words(plots.stability_map(ANGLES, ANGLES, -np.abs(known))) == ["stable"]
    yes_or_no = plots.stability_map(ANGLES, ANGLES, known > 0.0)
    assert len(yes_or_no.axes) == 1  # no bar of growth rates
    known[:4, :4] = np.nan
    assert words(plots.stability_map(ANGLES, ANGLES, known)) == ["stable", "unstable", "not known"]
    with pytest.raises(ValueError, match=r"growth of shape \(15, 15\): expected \(15, 3\)"):
        plots.stability_map([1.0, 2.0, 3.0], ANGLES, known)


def test_lines_and_their_greys_differ():
    def grey(colour):
        red, green, blue = (int(colour[i : i + 2], 16) / 255.0 for i in (1, 3, 5))
        return 0.299 * red + 0.587 * green + 0.114 * blue

    first = [grey(colour) for colour, _, _ in style.LINES[:3]]
    assert min(abs(a - b) for i, a in enumerate(first) for b in first[:i]) > 0.05
    assert len({str(dash) for _, dash, _ in style.LINES}) == len(style.LINES)
    assert len({marker for _, _, marker in style.LINES}) == len(style.LINES)


@pytest.mark.parametrize(
    ("unit", "value", "expected"),
    [
        ("m", 3e-4, (1e-6, "µm")), ("m", 1e-3, (1e-3, "mm")), ("m", 0.0, (1.0, "m")), ("s", 0.05, (1e-3, "ms")),
        ("Hz", 2e3, (1e3, "kHz")), ("Hz", 20.0, (1.0, "Hz")), ("Pa", 4e6, (1e6, "MPa")), ("N", 1e4, (1e3, "kN")),
        ("1/s", 5.0, (1.0, "1/s")),
    ],
)  # fmt: skip
def test_scale_for_reading(unit, value, expected):
    assert words.scaled(unit, [0.0, -value]) == expected
    with pytest.raises(ValueError, match="unit = 'furlong': expected one of"):
        words.scaled(unit, [value], to="furlong")


def test_numbers_as_a_reader_writes_them():
    minus = "\N{MINUS SIGN}"
    assert [words.number(x) for x in (0.0, 2.0, 0.33271, 12566.37, -53.16, 1e-7)] == [
        "0", "2", "0.3327", "12566", f"{minus}53.16", f"1e{minus}07",
    ]  # fmt: skip
    assert style.uncertain(-117.3, 18.0) == f"{minus}120 ± 20"
    assert style.uncertain(-2.8, 20.0) == "0 ± 20"
    assert style.uncertain(3.14159, 0.012) == "3.14 ± 0.01"
    assert style.uncertain(5.0, 0.0) == "5"


def test_equal_figures_give_equal_files(tmp_path):
    first = plots.save(plots.coalescence(MUS, modes()), tmp_path / "a")
    again = plots.save(plots.coalescence(MUS, modes()), tmp_path / "b.png")
    other = plots.save(plots.coalescence(MUS, modes(reading="eq3")), tmp_path / "c")
    assert [path.name for path in again] == ["b.png", "b.svg"]
    for a, b, c in zip(first, again, other, strict=True):
        assert a.read_bytes() == b.read_bytes()
        assert a.read_bytes() != c.read_bytes()
    assert b"date" not in first[1].read_bytes().lower()


def test_settings_of_matplotlib_are_left_as_they_were():
    import matplotlib as mpl

    before = dict(mpl.rcParams)
    plots.time_history(motion())
    assert dict(mpl.rcParams) == before


def test_plot_finds_the_figure_of_a_result():
    assert len(plots.plot(trajectory()).axes) == 4  # a hundred periods: the last of them apart
    assert len(plots.plot(trajectory(T[: T.size // 20])).axes) == 3
    assert len(plots.plot(spectrum(motion())).axes) == 1
    assert len(plots.plot(verdict(motion())).axes) == 1
    assert len(plots.plot(Coulomb(0.3)).axes) == 1
    assert len(plots.plot({"a": Coulomb(0.3)}).axes) == 1
    with pytest.raises(TypeError, match=r"no figure is known for ndarray: expected one of .*Trajectory"):
        plots.plot(np.zeros(3))


def test_unequal_steps_and_failed_runs_are_drawn_and_said():
    uneven = np.sort(np.random.default_rng(0).uniform(0.0, 0.05, 2000))
    notes = [text.get_text() for panel in plots.plot(trajectory(uneven)).axes for text in panel.texts]
    assert any("through unequal steps" in each for each in notes)
    failed = plots.plot(trajectory(T[:5], Outcome("step_underflow", "no step was small enough")))
    assert len(failed.axes) == 2
    assert "no step was small enough" in failed.get_suptitle()


def test_several_columns_of_an_array_have_no_names():
    with pytest.raises(SignalError, match="need a trajectory that names them"):
        plots.time_history(SimpleNamespace(t=T, q=motion().q), dof=[0, 1])


def test_nothing_needs_a_display_or_pyplot(tmp_path):
    code = (
        "import sys; import squealbox.plots; assert 'matplotlib' not in sys.modules\n"
        "import numpy as np; t = np.linspace(0, 0.01, 500)\n"
        "squealbox.plots.save(squealbox.plots.time_history(np.sin(1e4 * t), t), sys.argv[1])\n"
        "assert 'matplotlib.pyplot' not in sys.modules"
    )
    clean = {"HOME": str(tmp_path), "MPLCONFIGDIR": str(tmp_path)}
    done = subprocess.run([sys.executable, "-c", code, tmp_path / "a.png"], env=clean, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
