"""A cycle does not know its units: forces, lengths and times may be scaled."""

import numpy as np
from hypothesis import given, settings
from hypothesis import strategies as st

from small_systems import block_on_belt
from squealbox import Coulomb, shooting

factor = st.floats(0.05, 20.0)


@settings(max_examples=8, deadline=None)
@given(force=factor, length=factor, time=factor)
def test_r4_in_other_units(force, length, time):
    """m, N, k, v in other units: T scales with time, the amplitude with length, multipliers not at all."""
    system = block_on_belt(
        Coulomb(0.4, 0.25),
        0.1 * length / time,
        mass=force * time**2 / length,
        normal=force,
        stiffness=force / length,
    )
    cycle = shooting(system, settle=60.0 * time)
    assert cycle.outcome.ok
    np.testing.assert_allclose(float(cycle.period) / time, 3.0 + 2.0 * (np.pi - np.arctan(1.5)), rtol=1e-9)
    np.testing.assert_allclose(cycle.amplitude / length, np.hypot(0.15, 0.1), rtol=1e-9)
    np.testing.assert_allclose(np.abs(cycle.multipliers), [1.0, 0.0], atol=1e-8)
