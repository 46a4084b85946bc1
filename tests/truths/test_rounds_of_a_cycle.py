"""The period of a cycle is the least: a motion wound several times is unwound.

That a doubled one is not: `test_settled_beside_a_doubling`.
"""

import numpy as np
import pytest

from small_systems import block_on_belt
from squealbox import Coulomb, Hyperbolic, complex_modes, harmonic_balance, shooting
from squealbox.designs import DESIGNS

BELT = block_on_belt(Coulomb(0.4, 0.25), 0.1)
SMOOTH = block_on_belt(Hyperbolic(1.0, 3.0), 0.2)
PERIOD = 3.0 + 2.0 * (np.pi - np.arctan(1.5))  # R4


@pytest.mark.parametrize("wound", [2, 3, 7])
def test_a_start_wound_several_times_is_one_cycle(wound):
    q, qd = shooting(BELT).start
    again = shooting(BELT, (q, qd, wound * PERIOD))
    assert float(again.period) == pytest.approx(PERIOD, abs=1e-9)
    assert abs(again.multipliers[0] - 1.0) < 1e-8


@pytest.mark.parametrize("options", [{}, {"harmonics": 36}], ids=["doubled", "fixed"])
def test_series_are_unwound_too(options):
    smooth = {"contact": "tanh", "width": 0.1}
    once = shooting(SMOOTH, **smooth)
    q, qd = once.start
    wound = harmonic_balance(SMOOTH, (q, qd, 3.0 * float(once.period)), **smooth, **options)
    assert wound.outcome.ok
    assert float(wound.period) == pytest.approx(float(once.period), rel=1e-6)


def test_a_run_that_has_not_settled_gives_no_five_fold_period():
    """Pad on disc, tanh of width 0.3 m/s: what dies slowly turns by 149 degrees a period, so a run passes its
    start after five turns (745 = 2 x 360 + 25 degrees) more closely than after one; seen as a cycle of 0.0314 s."""
    system = DESIGNS["pad_on_disc"]().system()
    cycle = shooting(system, contact="tanh", width=0.3)
    lowest = float(np.min(complex_modes(system).angular_frequency))
    assert cycle.stable
    assert float(cycle.period) == pytest.approx(2.0 * np.pi / lowest, rel=1e-3)
    side = cycle.multipliers[1]
    assert np.degrees(abs(np.angle(side))) == pytest.approx(149.0, abs=1.0)
    assert np.degrees(abs(np.angle(side**5))) == pytest.approx(25.0, abs=5.0)
