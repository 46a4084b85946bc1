"""How errors of cycles fall: with harmonics exponentially, with Magnus steps by order 4, with Newton quadratically."""

import numpy as np
import pytest

from small_systems import block_on_belt, drum, two_blocks_on_belt
from squealbox import Hyperbolic, harmonic_balance, shooting
from squealbox.limit_cycles.cycles.field import Field
from squealbox.limit_cycles.cycles.variation import flight, quick_flight


@pytest.fixture(scope="module")
def smooth():
    return shooting(drum(0.45), contact="smooth", width=0.1)


def test_harmonics_converge_exponentially(smooth):
    counts = np.array([3, 5, 7, 9, 11])
    errors = []
    for count in counts:
        found = harmonic_balance(drum(0.45), smooth, contact="smooth", width=0.1, harmonics=int(count))
        errors.append(abs(float(found.period / smooth.period) - 1.0))
    slope = np.polyfit(counts, np.log(errors), 1)[0]
    assert slope < -0.5  # each harmonic takes more than a third of the error: faster than any power
    assert errors[-1] < 1e-2 * errors[0]
    assert errors[0] > 1e-8


def test_steps_of_the_derivative_are_of_order_four():
    """A block that only slips: with a reversal the smoothed law has a kink, and the order there is lower."""
    field, x = Field(block_on_belt(Hyperbolic(1.0, 3.0), 2.0)), np.array([0.1, 0.9])
    exact = flight(field, x, 6.0).phi
    steps = np.array([12, 24, 48])
    errors = [np.max(np.abs(quick_flight(field, x, 6.0, 1e-13, int(n)).phi - exact)) for n in steps]
    assert -np.polyfit(np.log(steps), np.log(errors), 1)[0] == pytest.approx(4.0, abs=0.3)


def test_newton_is_quadratic_across_events():
    """With the right saltation matrices each residual is about the square of the one before; without, a factor."""
    cycle = shooting(two_blocks_on_belt())
    q, qd = cycle.start
    again = shooting(two_blocks_on_belt(), (q * 1.003, qd * 0.997, 1.002 * float(cycle.period)))
    history = np.array(again.outcome.evidence["history"])
    assert len(history) <= 7
    late = history[(history > 1e-9) & (history < 1e-2)]
    assert np.all(late[1:] < 30.0 * late[:-1] ** 2)
