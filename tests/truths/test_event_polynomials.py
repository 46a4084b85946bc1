"""Polynomials through what is known of an event function are exact for their degree, and not for the next."""

import numpy as np
import pytest

from squealbox.transient.lanes.event_text import probes, slope_weights
from squealbox.transient.lanes.roots import quartic_root, quintic_root
from squealbox.transient.methods import tableau

PLACES = (0.0, 0.3, 0.6, 0.85, 1.0)
ROUND_OFF = 1e-12  # of numbers of size 1 and weights up to 20


@pytest.mark.parametrize("name", ["dormand-prince-8", "tsitouras", "bogacki-shampine"])
def test_slope_at_the_end_of_a_step(name):
    rule = tableau(name)
    places = np.array([0.0, *rule.c[probes(rule)], 1.0])
    weights = slope_weights(list(places))
    degree = len(places) - 1
    for power in range(degree + 1):
        assert np.dot(weights, places**power) == pytest.approx(power, abs=ROUND_OFF)
    assert abs(np.dot(weights, places ** (degree + 1)) - (degree + 1)) > 1e-3


def test_the_first_root_of_a_quartic():
    x = np.array(PLACES)
    for root in (0.05, 0.31, 0.72, 0.97):
        quartic = (root - x) * (1.0 + x**2) * (1.7 - x)
        assert quartic_root(PLACES, tuple(quartic)) == pytest.approx(root, abs=1e-8)  # of four steps of Newton
    assert quartic_root(PLACES, tuple((0.2 - x) * (0.45 - x) * (0.9 - x))) == pytest.approx(
        0.2, abs=1e-4
    )  # a bent one, from a poor chord
    sine = np.sin(3.0 * (0.72 - x))
    assert abs(quartic_root(PLACES, tuple(sine)) - 0.72) > 1e-5


def test_root_of_a_quintic_from_a_cubic_guess():
    h, end, root = 0.3, 1.0, 0.62

    def known(f, rate):
        ends = (f(0.0), rate(0.0), end, f(end), rate(end))
        return quintic_root(ends, h, f(h), rate(h), root + 3e-3)

    quintic = np.polynomial.Polynomial([root, -1.0]) * np.polynomial.Polynomial([1.0, 0.0, 0.3, 0.1, 0.2])
    assert known(quintic, quintic.deriv()) == pytest.approx(root, abs=ROUND_OFF)
    assert 1e-9 < abs(known(lambda x: np.sin(root - x), lambda x: -np.cos(root - x)) - root) < 1e-5
