"""The gains that hold a brake against closed forms, and the brakes that no gain holds."""

import numpy as np
import pytest

from squealbox import (
    PID,
    Controlled,
    Coulomb,
    DrumBrake,
    LinearSlope,
    ModeCoupling,
    ParameterError,
    System,
    closed_loop,
    stable_gains,
)


def block(c, *loops):
    return System([[1.0]], [[c]], [[1.0]], loops=loops)


def test_velocity_feedback_holds_from_the_damping_it_makes_up_for():
    found = stable_gains(block(-0.17, PID(on="q1", derivative=0.4)))
    assert found.low == pytest.approx([0.17 / 0.4], rel=1e-12)
    assert found.high.tolist() == [np.inf]


@pytest.mark.parametrize(
    ("computing", "low", "high"), [(0.0, 0.104291297, 3.917179234), (1.0, 0.142869674, 1.484853056)]
)
def test_sampled_feedback_holds_between_the_gains_of_jury(computing, low, high):
    found = stable_gains(block(-0.1, PID(on="q1", derivative=1.0, sampling=2.0, computing=computing)))
    assert [found.low[0], found.high[0]] == pytest.approx([low, high], abs=1e-9)


def test_late_feedback_holds_between_its_gain_margins():
    brake = block(-0.1, PID(on="q1", derivative=0.3, delay=0.8))
    found = stable_gains(brake)
    assert [found.low[0], found.high[0]] == pytest.approx(closed_loop(brake).gain_margin, rel=1e-9)


def test_no_gain_holds_flutter_from_one_side():
    """Without damping on x, D_H = 1 whatever y feels: at D = 1.2 every gain squeals, and damping on x mends it."""
    brake = Controlled(ModeCoupling(friction=Coulomb(1.2)), PID(on="y", derivative=0.3))
    found = stable_gains(brake)
    assert found.outcome == "no_stable_gain"
    assert found.low.size == 0
    assert 0.0 < found.least_growth == pytest.approx(float(found.outcome.evidence["least_growth"]))
    both = Controlled(brake, PID(on="x", derivative=0.3))
    assert stable_gains(both).outcome == "completed"
    assert stable_gains(both, loop=0).low.size == 1


def test_the_drum_needs_many_times_the_damping_on_one_side():
    drum = DrumBrake(friction=LinearSlope(0.36, -0.05))
    needed = [float(stable_gains(Controlled(drum, [PID(on=n, derivative=1.0e3) for n in names])).low[0])
              for names in ("xy", "y", "x")]  # fmt: skip
    assert needed == pytest.approx([1.061, 11.768, 14.025], abs=1e-3)


def test_a_loop_that_is_not_there_is_said():
    with pytest.raises(ParameterError, match="stable_gains.loop = 3"):
        stable_gains(block(-0.1, PID(on="q1", derivative=0.3)), loop=3)
