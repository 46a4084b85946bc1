"""Random systems against a slow integrator of the tests' own: outcome, count of events and end state.

SQUEALBOX_FUZZ=10000 makes it long (`make fuzz`). Past failures stay in SEEDS.
"""

import os

import numpy as np
import pytest

from random_systems import random_system
from slow_reference import slow
from squealbox import simulate

SEEDS = (0, 4, 8, 10, 11)
LONG = int(os.environ.get("SQUEALBOX_FUZZ", "0"))


@pytest.mark.parametrize("seed", sorted({*SEEDS, *range(LONG)}))
def test_against_a_slow_integrator(seed):
    system, start, duration = random_system(seed)
    truth = slow(system, duration, *start)
    motion = simulate(system, duration, start)
    assert motion.outcome == "completed"
    assert len(motion.event_time) == len(truth.events)
    assert motion.event_time == pytest.approx([float(event[0]) for event in truth.events], abs=1e-7)
    assert motion.q[-1] == pytest.approx(truth.q, abs=1e-7 * max(1.0, float(np.max(np.abs(motion.q)))))
    assert motion.energy.relative_residual < 1e-6


@pytest.mark.parametrize("method", ["dormand-prince", "tsitouras", "bogacki-shampine"])
def test_every_method_finds_the_same_events(method):
    for seed in range(14, 34):
        system, start, duration = random_system(seed)
        one = simulate(system, duration, start, rtol=1e-11)
        other = simulate(system, duration, start, method=method, rtol=1e-9)
        assert one.outcome == other.outcome == "completed"
        assert len(one.event_time) == len(other.event_time), seed
        assert one.q[-1] == pytest.approx(other.q[-1], abs=1e-5), seed
