"""The rule by which a Taylor step adds up its works is that of Radau: exact to degree 14, and not to degree 15."""

import numpy as np
import pytest

from squealbox import DrumBrake, LinearSlope, simulate
from squealbox.transient.lanes.works_text import NODES, radau


@pytest.mark.parametrize("degree", range(2 * NODES))
def test_it_is_exact_to_degree_14(degree):
    nodes, weights = radau()
    off = abs(float(weights @ nodes**degree) * (degree + 1) - 1.0)
    assert nodes[-1] == 1.0
    assert (off < 1e-13) == (degree <= 2 * NODES - 2)


@pytest.mark.parametrize("rtol", [1e-4, 1e-6, 1e-10])
def test_the_audit_closes_well_within_the_tolerance(rtol):
    """Whatever instants are kept: a row within a step has works of its own, from the start of the step."""
    brake = DrumBrake(friction=LinearSlope(0.44, -0.05), reading="consistent")
    for times in (None, 300):
        assert simulate(brake, 0.02, times=times, rtol=rtol).energy.relative_residual < max(0.1 * rtol, 1e-11)


def test_the_least_normal_force_is_seen_inside_a_step():
    """N = N0 + n q of a free oscillation falls to its least value between the ends of steps."""
    brake = DrumBrake(friction=LinearSlope(0.1, 0.0), reading="consistent")
    every = simulate(brake, 0.01, times=20_001)
    assert np.min(every.normal_force) < 0.0
    said = float(every.caution.split("N falls to ")[1].split(" N")[0])
    assert said == pytest.approx(float(np.min(every.normal_force)), rel=3e-3)  # 7e-3 at halves of steps
