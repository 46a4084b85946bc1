"""Series arithmetic on plain numbers: coefficients against Cauchy's integral, by a Fourier transform on a circle."""

import numpy as np
import pytest

from squealbox import Contact, Sinusoid, Stribeck, System, simulate
from squealbox.transient.lanes import series
from squealbox.transient.lanes.series import Series, derivative, integral, value, value_and_slope

ORDER, RADIUS, POINTS = 12, 0.25, 64
INNER = (0.7, 0.4, -0.3, 0.2)  # x(t), a cubic
FORMULAS = {
    "exp": (series.exp, np.exp),
    "tanh": (series.lane_tanh, np.tanh),
    "sin": (series.sin, np.sin),
    "cos": (series.cos, np.cos),
    "arctan": (series.arctan, np.arctan),
    "log": (series.log, np.log),
    "sqrt": (series.sqrt, np.sqrt),
    "quotient": (lambda x: (1.0 - x) / (2.0 + x * x), lambda x: (1.0 - x) / (2.0 + x * x)),
    "power": (lambda x: 3.0 - x**5, lambda x: 3.0 - x**5),
    "sum": (lambda x: 2.0 * x - 3.0 * (x * x) + -x, lambda x: x - 3.0 * x * x),
}


def inner():
    """x(t) as a series."""
    return Series(lambda k: INNER[k] if k < len(INNER) else None)


def coefficients(found):
    """The first ones, None as 0."""
    return np.array([0.0 if found[k] is None else found[k] for k in range(ORDER + 1)])


def by_cauchy(formula):
    """The coefficients of formula(x(t)): its values on a circle within which it is analytic, transformed."""
    t = RADIUS * np.exp(2j * np.pi * np.arange(POINTS) / POINTS)
    x = sum(c * t**k for k, c in enumerate(INNER))
    return np.real(np.fft.fft(formula(x)) / POINTS)[: ORDER + 1] / RADIUS ** np.arange(ORDER + 1)


@pytest.mark.parametrize("name", FORMULAS)
def test_recurrences_give_the_coefficients(name):
    of_series, of_numbers = FORMULAS[name]
    # round-off 1e-16 over RADIUS**12 is 2e-9 at the last coefficient, and the terms left out are below it
    allowed = 1e-15 / RADIUS ** np.arange(ORDER + 1) + 1e-13
    assert np.all(np.abs(coefficients(of_series(inner())) - by_cauchy(of_numbers)) < allowed)


def test_one_formula_is_not_another():
    assert np.max(np.abs(coefficients(series.lane_tanh(inner())) - by_cauchy(np.arctan))) > 1e-2


def test_derivative_and_integral_undo_each_other():
    one = coefficients(series.exp(inner()))
    assert coefficients(derivative(integral(series.exp(inner())))) == pytest.approx(one, rel=1e-14)
    assert coefficients(derivative(series.exp(inner()))) != pytest.approx(one, rel=1e-3)


def test_value_and_slope_are_those_of_the_polynomial():
    t, polynomial = 0.3, np.polynomial.Polynomial(INNER)
    assert value(inner(), t, ORDER) == pytest.approx(polynomial(t), rel=1e-14)
    assert value_and_slope(inner(), t, ORDER)[1] == pytest.approx(polynomial.deriv()(t), rel=1e-14)


def test_a_law_that_is_hidden_below_round_off_is_seen_before_it_acts():
    """At 1 m/s the fall over 0.02 m/s is exp(-50): no term of a series tells of it, and one step leads to rest."""
    belt = Contact(np.zeros(1), [1.0], [1.0], 1.0, Sinusoid(0.0, 1.0, 0.3), Stribeck(0.4, 0.2, 0.02))
    brake = System([[1.0]], [[0.05]], [[9.0]], [0.3], (belt,))
    start = ([0.2], [0.0])
    truth = simulate(brake, 8.0, start, rtol=1e-12, method="dormand-prince")
    for rtol in (1e-8, 1e-10):
        motion = simulate(brake, 8.0, start, rtol=rtol, method="taylor")
        assert np.max(np.abs(motion.q[-1] - truth.q[-1])) < rtol  # once 2e-4 at 1e-8
        assert np.max(np.abs(motion.event_time - truth.event_time)) < rtol
