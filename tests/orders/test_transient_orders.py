"""Observed orders: error against step, fitted, for the step, the dense output and the instants of events.

A loose tolerance with first_step = largest_step makes the steps constant. Steps are chosen so that the errors lie
between the leading term's range and round-off; the slope may miss the order by what the next term adds there.
"""

from dataclasses import replace

import numpy as np
import pytest
from scipy.linalg import expm

from small_systems import METHODS, block_on_belt, two_masses
from squealbox import Method, Stribeck, System, simulate

START = ([0.4, -0.1], [0.2, 0.3])
ORDER = {"bogacki-shampine": 3, "dormand-prince": 5, "tsitouras": 5, "dormand-prince-8": 8}
DENSE = {"bogacki-shampine": 3, "dormand-prince": 4, "tsitouras": 4, "dormand-prince-8": 7}
STEPS = {
    "bogacki-shampine": (80, 120, 180, 270),
    "dormand-prince": (24, 36, 54, 80),
    "tsitouras": (24, 36, 54, 80),
    "dormand-prince-8": (8, 11, 15, 20),
}


def fixed(name, step):
    """The method with constant steps: the tolerance accepts all of them."""
    return Method(name, rtol=0.9, atol=1e9, first_step=step, largest_step=step)


def slope(steps, errors):
    """Fitted power of the step in the error."""
    return float(np.polyfit(np.log(steps), np.log(errors), 1)[0])


def exact(system, t):
    steady = np.concatenate([np.linalg.solve(system.K, system.load), np.zeros(2)])
    stiffness, damping = np.linalg.solve(system.M, system.K), np.linalg.solve(system.M, system.C)
    matrix = np.block([[np.zeros((2, 2)), np.eye(2)], [-stiffness, -damping]])
    return steady + expm(matrix * t) @ (np.concatenate(START) - steady)


@pytest.mark.parametrize("name", METHODS)
def test_order_of_the_step(name):
    # issue 2 and R6: y' = A y against the matrix exponential
    errors = []
    for count in STEPS[name]:
        motion = simulate(two_masses(), 6.0, START, method=fixed(name, 6.0 / count))
        assert motion.steps == count
        errors.append(np.max(np.abs(np.concatenate([motion.q[-1], motion.qd[-1]]) - exact(two_masses(), 6.0))))
    assert slope(6.0 / np.array(STEPS[name]), errors) == pytest.approx(ORDER[name], abs=0.35)


@pytest.mark.parametrize("name", METHODS)
def test_order_of_the_dense_output(name):
    # the error inside a step that starts from the exact state: one order above that of the polynomial
    steps = np.array([0.4, 0.3, 0.2, 0.15]) * (2.0 if name == "dormand-prince-8" else 0.5)
    errors = []
    for step in steps:
        inside = simulate(two_masses(), 2.0 * step, START, times=[0.3 * step, 0.55 * step], method=fixed(name, step))
        states = np.concatenate([inside.q, inside.qd], axis=1)
        errors.append(max(np.max(np.abs(s - exact(two_masses(), t))) for t, s in zip(inside.t, states, strict=True)))
    assert slope(steps, errors) == pytest.approx(DENSE[name] + 1, abs=0.4)


def test_a_wrong_weight_lowers_the_order(monkeypatch):
    # the negative twin: with one weight off by a thousandth the method is of order 0
    from squealbox.transient import methods

    good = methods.tableau("dormand-prince")
    bad = replace(good, name="wrong", b=good.b + 1e-3 * np.eye(6)[2])
    monkeypatch.setitem(methods.TABLEAUX, "wrong", lambda: bad)
    errors = []
    for count in STEPS["dormand-prince"]:
        motion = simulate(two_masses(), 6.0, START, method=fixed("wrong", 6.0 / count))
        errors.append(np.max(np.abs(np.concatenate([motion.q[-1], motion.qd[-1]]) - exact(two_masses(), 6.0))))
    assert slope(6.0 / np.array(STEPS["dormand-prince"]), errors) < 1.0


def braked():
    """A block that slips on a slow belt with friction that falls with speed: nothing about it is polynomial.

    Damping and start are such that the leading error term is not nearly zero at either event.
    """
    return block_on_belt(Stribeck(0.4, 0.2, 0.8), 0.3, damping=0.3)


COUNTS = {
    "bogacki-shampine": (40, 60, 90, 135),
    "dormand-prince": (16, 24, 36, 54),
    "tsitouras": (16, 24, 36, 54),
    "dormand-prince-8": (4, 5, 7, 9),
}
FIRST = {"rtol": 1e-14, "atol": 1e-16}


def first_two_events(method, **options):
    motion = simulate(braked(), 12.0, ([0.2], [-0.6]), method=method, **options)
    return motion.event_time[:2], motion.event_mode[:2]


@pytest.mark.parametrize("name", METHODS)
@pytest.mark.parametrize("event", [0, 1], ids=["slip to stick", "stick to slip"])
def test_order_of_event_times(name, event):
    # issue 3: an event is the end of a real step of the method, so its instant has the method's order. The steps are
    # such that the last one before the event is half a step, whatever their number.
    instants, modes = first_two_events("taylor", **FIRST)
    assert modes.tolist() == [0, 1]
    steps = instants[0] / (np.array(COUNTS[name]) + 0.5)
    errors = [abs(first_two_events(fixed(name, step))[0][event] - instants[event]) for step in steps]
    assert min(errors) > 1e-14, "round-off says nothing of the order"
    assert slope(steps, errors) == pytest.approx(ORDER[name], abs=0.5)


@pytest.mark.parametrize("name", METHODS)
def test_events_follow_the_tolerance(name):
    instants, _ = first_two_events("dormand-prince-8", **FIRST)
    errors = [np.max(np.abs(first_two_events(name, rtol=r, atol=r)[0] - instants)) for r in (1e-5, 1e-7, 1e-9)]
    assert np.all(np.diff(errors) < 0.0)
    assert errors[-1] < 1e-7


def test_steps_of_an_adaptive_run_scale_with_the_tolerance():
    # steps ~ rtol^(-1/order): from 1e-6 to 1e-9 a method of error order q takes about 10^(3/(q+1)) times the steps
    plain, start = System(np.eye(2), np.zeros((2, 2)), np.diag([1.0, 2.0])), ([1.0, 1.0], [0.0, 0.0])
    for name, error_order in (("bogacki-shampine", 2), ("dormand-prince", 4), ("tsitouras", 4)):
        few, many = (simulate(plain, 200.0, start, method=name, rtol=r, atol=r).steps for r in (1e-6, 1e-9))
        assert np.log10(many / few) == pytest.approx(3.0 / (error_order + 1), rel=0.1)
