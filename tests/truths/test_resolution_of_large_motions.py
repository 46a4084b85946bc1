"""Whether kept instants carry a motion does not depend on its unit, not even where squares are beyond all numbers."""

import dataclasses

import pytest

from squealbox import MassOnBelt, simulate
from squealbox.transient.resolution import carries


@pytest.mark.filterwarnings("error")
@pytest.mark.parametrize("times", [9, 999])
def test_a_motion_beyond_squares_is_carried_as_the_same_one_in_small(times):
    motion = simulate(MassOnBelt(), 10.0 if times > 9 else 100.0, times=times)
    large = dataclasses.replace(motion, q=1e200 * motion.q, qd=1e200 * motion.qd)
    assert carries(large) == carries(motion) == (times > 9)
