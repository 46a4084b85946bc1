"""Where a run settles beside a period doubling: on the doubled cycle, not on the unstable one inside it."""

import numpy as np
import pytest

from small_systems import two_blocks_on_belt
from squealbox import shooting
from squealbox.limit_cycles.cycles.field import Field
from squealbox.limit_cycles.cycles.rounds import rounds


@pytest.mark.parametrize("speed", [0.049138, 0.04911, 0.0490])
def test_a_run_beside_a_doubling_settles_on_the_doubled_cycle(speed):
    """A run cannot settle on an unstable cycle; the single one is there all the same, when it is asked for."""
    belt = two_blocks_on_belt(speed=speed)
    doubled = shooting(belt)
    assert doubled.stable
    q, qd = doubled.start
    single = shooting(belt, (q, qd, 0.5 * float(doubled.period)))
    assert single.outcome.ok
    assert not single.stable
    assert np.min(single.multipliers.real) < -1.0
    assert float(doubled.period) == pytest.approx(2.0 * float(single.period), rel=1e-2)
    assert abs(float(doubled.period / (2.0 * single.period)) - 1.0) > uncertainty(doubled) + uncertainty(single)
    assert turns(doubled, float(doubled.period)) == 1
    assert turns(doubled, 2.0 * float(doubled.period)) == 2


def uncertainty(cycle):
    """Of a period, relative: about 100 rtol over the distance of the multipliers from 1 (docstring of shooting)."""
    return 100.0 * cycle.settings["rtol"] / float(np.min(np.abs(cycle.multipliers[1:] - 1.0)))


def turns(cycle, duration):
    """How often the cycle goes round in a time, by the tolerance of shooting."""
    field, size = Field(cycle.system), float(np.max(np.ptp(cycle.qd, axis=0)))
    return rounds(field, np.concatenate(cycle.start), duration, size, 1e-13, cycle.settings["tolerance"])


def test_before_the_doubling_one_turn_is_enough():
    beyond = shooting(two_blocks_on_belt(speed=0.0492))
    assert beyond.stable
    assert float(beyond.period) == pytest.approx(37.207046, abs=1e-5)
