"""Forced periodic sliding: Floquet multipliers across reversals against averaging and closed forms."""

from dataclasses import replace

import numpy as np
import pytest
from scipy.optimize import brentq

from squealbox import (
    Contact,
    Coulomb,
    Dithered,
    DrumBrake,
    LinearSlope,
    MassOnBelt,
    ModeCoupling,
    NormalDither,
    ParameterError,
    Sinusoid,
    System,
    complex_modes,
    shooting,
    simulate,
)
from squealbox.limit_cycles import forced_branch, forced_cycle, forced_path
from squealbox.result import Outcome

BLOCK = MassOnBelt(c=0.02, k=1.0, sliding_speed=0.5, load=1.0, friction=Coulomb(0.4))
AVERAGED = 0.02 + 2.0 * 0.4 / (np.pi * np.sqrt(1.0 - 0.25))


def dithered(omega, velocity=1.0, brake=BLOCK):
    return Dithered(brake, velocity, omega / (2.0 * np.pi), direct=True)


def test_direct_damping_comes_to_the_averaged_one_with_the_square_of_the_frequency():
    found = [forced_cycle(dithered(omega)) for omega in (10.0, 20.0, 40.0, 80.0)]
    assert [each.events for each in found] == [2] * 4
    damping = np.array([each.damping for each in found])
    assert damping == pytest.approx([0.315274406, 0.314345987, 0.314117799, 0.314060992], abs=1e-9)
    errors = damping - AVERAGED
    assert np.all(np.abs(errors[1:-1] / errors[2:] - 4.0) < 0.2)


def test_the_threshold_of_flutter_under_direct_dither():
    brake = ModeCoupling(c1=0.02, c2=0.02, friction=Coulomb(1.5))
    edge = brentq(lambda w: forced_cycle(dithered(30.0, w, brake)).growth_rate, 1.122, 1.127, xtol=1e-10)
    assert edge == pytest.approx(1.12423298, abs=1e-7)


@pytest.mark.parametrize("ratio", [0.2, 0.9])
def test_normal_dither_without_lift_off_does_nothing(ratio):
    brake = DrumBrake(friction=Coulomb(0.3))
    found = forced_cycle(NormalDither(brake, ratio, 20e3))
    alone = complex_modes(brake).eigenvalues
    expected = np.exp(alone * float(found.period))
    gaps = np.abs(found.multipliers[:, None] - expected[None, :]).min(axis=1)
    assert found.outcome == "completed"
    assert np.max(gaps) < 1e-8


def test_normal_dither_pumps_a_falling_law_at_twice_its_mode():
    # C(t) = c + s N(t): c0 = 0.05 in the mean, c1 = 0.2 in amplitude
    falling = MassOnBelt(c=0.25, k=1.0, sliding_speed=1.0, load=1.0, friction=LinearSlope(0.4, -0.2))
    pumped = forced_cycle(NormalDither(falling, 1.0 - 1e-12, 1.0 / np.pi))
    assert pumped.growth_rate == pytest.approx(0.025014617, abs=1e-8)
    assert forced_cycle(NormalDither(falling, 0.9, 20.0 / (2.0 * np.pi))).growth_rate == pytest.approx(-0.025, abs=1e-4)


def test_a_branch_over_the_amplitude():
    found = list(forced_branch(lambda w: dithered(20.0, w), [0.8, 1.0, 1.5]))
    assert [each.outcome for each in found] == ["completed"] * 3
    assert np.all(np.diff([each.damping for each in found]) < 0.0)


def stopped(omega):
    """m = k = 1, c = 0.1 under 0.12 sin(omega t), with a stop of stiffness 4 at q = 0.5."""
    stop = Contact([4.0], [0.0], [0.0], -2.0, 1.0, Coulomb(0.0), unilateral=True, normal=[1.0])
    return System([[1.0]], [[0.1]], [[5.0]], Sinusoid(2.0, 0.12, omega / (2.0 * np.pi)) * np.array([1.0]), (stop,))


def test_a_path_over_the_frequency_goes_through_its_fold():
    """Below the stop the motion is linear; where it grazes the path turns back, unstable, beside the linear one."""

    def linear(omega):
        return 0.12 / (1.0 - omega**2 + 0.1j * omega)

    begin = 1.115
    start = [linear(begin).imag], [(1j * begin * linear(begin)).imag]
    found = list(
        forced_path(stopped, (1.09, begin), begin, start, direction=-1.0, first=0.5, largest=2.0, most_points=20)
    )
    below = [(omega, cycle) for omega, cycle in found if cycle.events == 0]
    assert len(below) >= 2
    for omega, cycle in below:
        assert cycle.q[0, 0] == pytest.approx(linear(omega).imag, rel=1e-7)
        assert cycle.stable
    lowest = min(omega for omega, _ in found)
    grazing = brentq(lambda omega: abs(linear(omega)) - 0.5, 1.05, begin)
    assert lowest == pytest.approx(grazing, abs=1e-3)
    omega, last = found[-1]
    assert omega > lowest
    assert last.events == 2
    assert not last.stable
    assert float(last.amplitude[0]) > 1.005 * abs(linear(omega))


def test_a_path_that_no_step_leads_on_says_so(monkeypatch):
    """Motions that end early beyond a force of 0.3 N stand for what no engine can run."""

    def block(force):
        return System([[1.0]], [[0.2]], [[1.0]], load=Sinusoid(0.0, force, 0.1) * [1.0])

    def breaking(system, *given, **options):
        motion = simulate(system, *given, **options)
        swing = max(abs(weight) * part.amplitude for weight, part in system.load.terms() if hasattr(part, "amplitude"))
        return replace(motion, outcome=Outcome("step_limit", "too many")) if np.max(swing) > 0.3 else motion

    whole = list(forced_path(block, (0.1, 0.5), 0.1, ([0.0], [0.0]), largest=0.5))
    assert whole[-1][0] == 0.5
    assert all(cycle.outcome == "completed" for _, cycle in whole)
    monkeypatch.setattr("squealbox.limit_cycles.cycles.forced.simulate", breaking)
    cut = list(forced_path(block, (0.1, 0.5), 0.1, ([0.0], [0.0]), largest=0.5))
    assert cut[-1][1].outcome == "step_underflow"
    assert cut[-1][0] == pytest.approx(0.3, abs=1e-2)
    assert all(cycle.outcome == "completed" for _, cycle in cut[:-1])


def test_what_is_not_periodic_is_refused():
    with pytest.raises(ParameterError, match="everything is constant.*shooting"):
        forced_cycle(BLOCK)
    with pytest.raises(ParameterError, match="forced_cycle.. finds the motion of others"):
        shooting(dithered(20.0))
    assert "forced_cycle() finds the motion it repeats" in complex_modes(dithered(20.0)).outcome.message
    two = Dithered(Dithered(BLOCK, 1.0, 1.0, direct=True), 0.5, np.sqrt(2.0), direct=True)
    with pytest.raises(ParameterError, match="whole numbers"):
        forced_cycle(two)
