"""Quick estimates as curves beside branches: what they must agree with, and how far off they say they are."""

import numpy as np
import pytest

from small_systems import block_on_belt
from squealbox import DrumBrake, LinearSlope, Stribeck, branch, hopf_point, shooting
from squealbox.cli import DONE, main
from squealbox.files import write_design
from squealbox.limit_cycles import Branch, EstimateCurve, averaged_swings, estimate_curves
from squealbox.limit_cycles.estimates.curves import AVERAGED, DESCRIBING, WIDTH, _off
from squealbox.plots import branch_diagram

LAW = Stribeck(0.4, 0.25, 0.3)
BOUNDS = (0.05, 1.0)


def block(speed):
    return block_on_belt(LAW, speed, damping=0.2)


@pytest.fixture(scope="module")
def cycles():
    """Stick-slip below the corner, and the unstable cycles of slip born at the Hopf point."""
    sticking = branch(block, "V", BOUNDS, value=0.15, method="shooting", points=12, largest_step=0.1)
    return sticking, branch(block, "V", BOUNDS, hopf_point(block, "V", BOUNDS), harmonics=12, points=40)


@pytest.fixture(scope="module")
def curves(cycles):
    return estimate_curves(block, "V", BOUNDS, cycles)


def test_of_slip_both_estimates_and_the_cycles_agree(cycles, curves):
    """Without sticking one harmonic and averaging are the same to second order in damping, 0.2^2 = 4 %."""
    averaged = next(curve for curve in curves if curve.label == AVERAGED)
    assert averaged.off < 0.04
    exact = [np.max(averaged_swings(LAW, float(v), 1.0, 0.2)) for v in averaged.value]
    np.testing.assert_allclose(averaged.amplitude[:, 0], exact, rtol=1e-12)
    one = next(c for c in curves if c.label == DESCRIBING and np.max(c.value) > 0.28 and np.min(c.value) > 0.2)
    beside = np.interp(one.value, averaged.value, averaged.amplitude[:, 0], np.nan, np.nan)
    middle = np.isfinite(beside) & (one.amplitude[:, 0] < 0.8 * one.value)  # beyond that the smoothing is felt
    assert np.sum(middle) > 3
    np.testing.assert_allclose(one.amplitude[middle, 0], beside[middle], rtol=0.04)


def test_in_stick_slip_one_harmonic_moves_as_fast_as_the_belt(cycles, curves):
    """The describing function of sgn holds the swing at the belt's speed: A omega = V but for the smoothing.

    The cycles are larger, so the curve says that it is off, and by about as much as it is.
    """
    sticking = next(c for c in curves if c.label == DESCRIBING and np.min(c.value) < 0.1)
    slow = sticking.value < 0.2
    ratio = sticking.amplitude[slow, 0] / sticking.value[slow]
    assert np.all(ratio < 1.0)
    assert np.all(ratio > 1.0 - 6.0 * WIDTH)  # tanh falls to the slope the balance needs within some widths
    true = np.interp(sticking.value[slow], cycles[0].value, cycles[0].amplitude[:, 0])
    assert np.all(true > sticking.amplitude[slow, 0])
    assert 0.03 < sticking.off < 0.5


def test_points_packed_at_one_end_do_not_make_a_curve_right():
    """20 % off over its length, right at a hundred points on a thousandth of it; nine tenths are within 30 %."""
    value = np.append(np.linspace(0.0, 0.001, 100), np.linspace(0.01, 1.0, 20))
    share = np.where(value > 0.001, np.where(value > 0.7, 1.3, 1.2), 1.0)
    size = np.array([1.0, 1.0])
    ends = Branch(
        value=np.array([-1.0, 2.0]), period=np.ones(2), lowest=-size[:, None], highest=size[:, None],
        multipliers=np.ones((2, 1)), start=np.zeros((2, 2)), least_slip=np.ones(2), sticking=np.zeros(2),
        unknowns=np.zeros((2, 1)), special_kind=np.array([]), special_value=np.array([]),
        special_point=np.array([], dtype=int), special_uncertainty=np.array([]), special_test=np.array([]),
    )  # fmt: skip
    curve = EstimateCurve(DESCRIBING, value, share[:, None], "always")
    assert _off(curve, [ends]) == (pytest.approx(0.2), pytest.approx(0.3))


def test_the_figure_draws_them_unless_told_not_to(cycles):
    def texts(**options):
        return [
            text for panel in branch_diagram(cycles, **options).axes for text in panel.get_legend_handles_labels()[1]
        ]

    with_them, without = texts(), texts(estimates=False)
    assert any(text.startswith("describing function") and "half within" in text for text in with_them)
    assert any(text.startswith("averaging") for text in with_them)
    assert without == [text for text in with_them if not text.startswith(("describing", "averaging"))]


def test_no_cycles_no_curve():
    quiet = branch(DrumBrake(), "friction.static", (0.05, 0.2), value=0.1, method="shooting", points=3)
    assert len(quiet.value) == 0
    assert estimate_curves(DrumBrake(), "friction.static", (0.05, 0.2), [quiet]) == ()
    assert estimate_curves(DrumBrake(), "friction.static", (0.1, 0.2), []) == ()


@pytest.mark.parametrize("method", ["harmonic_balance", "shooting"])
def test_beside_a_rise_from_the_hopf_point_a_curve_is_whole_or_absent(method):
    """The drum's branch is almost vertical there: a walk that does not get off its first point is no curve."""
    design = DrumBrake(friction=LinearSlope(0.3, -0.05), reading="consistent")
    born = hopf_point(design, "friction.static", (0.1, 0.6))
    rise = branch(design, "friction.static", (0.1, 0.6), born, points=30, method=method)
    curves = estimate_curves(design, "friction.static", (0.1, 0.6), [rise, rise])
    assert all(len(curve.value) >= 2 and curve.amplitude.shape == (len(curve.value), 2) for curve in curves)
    if method == "harmonic_balance":  # one harmonic is right for small swings: the curve begins at the Hopf point
        assert len(curves) == 1
        least = np.argmin(curves[0].amplitude[:, 1])
        assert curves[0].value[least] == pytest.approx(float(born.value), abs=1e-6)


def test_the_command_says_how_far_off(tmp_path, capsys):
    brake = write_design(DrumBrake(friction=LinearSlope(0.3, -0.05), reading="consistent"), tmp_path / "brake.toml")
    words = ["branch", str(brake), "--parameter", "friction.static", "--range", "0.29", "0.31", "--points", "20",
             "--at", "1", "--runs", "3", "--start", "runs"]  # fmt: skip
    assert main(words) == DONE
    line = next(x for x in capsys.readouterr().out.splitlines() if x.startswith("Estimate beside them: describing"))
    off = float(line.split("half within ")[1].split(" %")[0])
    cycle = shooting(DrumBrake(friction=LinearSlope(0.3, -0.05), reading="consistent"), ([3e-5, 1e-5], [0.3, -0.3]))
    assert float(np.max(cycle.amplitude)) == pytest.approx(2.98820e-5, rel=1e-4)
    assert 5.0 < off < 30.0
    assert main([*words, "--no-estimates"]) == DONE
    assert "Estimate" not in capsys.readouterr().out
