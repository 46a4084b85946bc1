"""Observers against closed forms: a damped oscillator without contacts, and the Coulomb belt of case R4."""

import numpy as np
import pytest

from small_systems import block_on_belt
from squealbox import Coulomb, Method, System, simulate_ensemble
from squealbox.transient.observers import energy, poincare, settled, sticking

# x'' + 2 d x' + w0^2 x = 0 from (1, 0): x = e^(-d t)(cos w t + d/w sin w t), x' = -(w0^2/w) e^(-d t) sin w t, and
# extremes (-1)^k e^(-d k pi/w) at t = k pi/w, with w^2 = w0^2 - d^2.
NATURAL, DAMPING, LENGTH, LEVEL = 2.0, np.array([0.1, 0.2]), 19.0, 0.1
DAMPED = np.sqrt(NATURAL**2 - DAMPING**2)
STEP = 0.02  # the largest step, to which `settled` can tell an instant

# R4: the block slips about 0.25 on the amplitude sqrt(0.15^2 + 0.1^2), sticks for 3 s
SPEED, DROP, KINETIC = 0.1, 0.15, 0.25
PERIOD = 2.0 * DROP / SPEED + 2.0 * (np.pi - np.arctan(DROP / SPEED))
HIGHEST = KINETIC + np.hypot(DROP, SPEED)


@pytest.fixture(scope="module")
def oscillators():
    """Two dampings, from a displacement of 1 m."""
    systems = [System([[1.0]], [[2.0 * d]], [[NATURAL**2]], 0.0) for d in DAMPING]
    observe = ("amplitude", "peak", "frequency", "growth_rate", settled(LEVEL))
    method = Method(rtol=1e-10, largest_step=STEP)
    return simulate_ensemble(systems, None, LENGTH, method, observe, start=([1.0], [0.0]))


def closed(t, d, w):
    """(x, x') of the oscillator."""
    envelope = np.exp(-d * t)
    return envelope * (np.cos(w * t) + d / w * np.sin(w * t)), -(NATURAL**2) / w * envelope * np.sin(w * t)


def test_an_oscillator_ends_where_the_closed_form_says(oscillators):
    assert np.all(oscillators.ended == "completed")
    x, v = closed(LENGTH, DAMPING, DAMPED)
    assert oscillators.q[:, 0] == pytest.approx(x, abs=1e-8)  # rtol 1e-10 over a thousand steps
    assert oscillators.qd[:, 0] == pytest.approx(v, abs=1e-8)


def test_amplitude_and_peak(oscillators):
    window = np.linspace(0.8 * LENGTH, LENGTH, 40_001)  # it begins on the way to an extreme; 1e-4 s tell it to 5e-9
    for k, (d, w) in enumerate(zip(DAMPING, DAMPED, strict=True)):
        assert oscillators["amplitude"][k, 0] == pytest.approx(0.5 * np.ptp(closed(window, d, w)[0]), rel=1e-7)
    assert oscillators["peak"][:, 0] == pytest.approx(1.0, abs=1e-15)  # it starts at the largest displacement


def test_frequency_and_growth_rate(oscillators):
    assert oscillators["frequency"][:, 0] == pytest.approx(DAMPED / (2.0 * np.pi), rel=1e-8)  # quintic in the step
    assert oscillators["growth_rate"][:, 0] == pytest.approx(-DAMPING, rel=1e-7)
    for name, value in (("frequency", NATURAL / (2.0 * np.pi)), ("growth_rate", DAMPING)):
        assert not np.any(np.isclose(oscillators[name][:, 0], value, rtol=1e-4))  # nor undamped, nor growing


def test_settled(oscillators):
    instants = np.linspace(0.0, LENGTH, 2_000_001)
    for k, (d, w) in enumerate(zip(DAMPING, DAMPED, strict=True)):
        last = instants[np.abs(closed(instants, d, w)[1]) > LEVEL]
        if last[-1] > LENGTH - np.pi / w:  # no whole swing was seen since
            assert oscillators["settled"][k, 0] == np.inf
        else:
            assert last[-1] - STEP <= oscillators["settled"][k, 0] <= last[-1] + 1e-5
    assert np.array_equal(np.isinf(oscillators["settled"][:, 0]), [True, False])  # one rings on, one has come to rest


@pytest.mark.parametrize("end", [0.5, 0.5003, 0.5005, 0.501])
def test_what_grows_has_not_settled(end):
    """500 Hz, 5/s up and 10/s down, from 1 um: 12 um at the end, or below 1e-4 m/s from ln(31.4)/10 s on."""
    systems = [System([[1.0]], [[-2.0 * rate]], [[(1000.0 * np.pi) ** 2]], 0.0) for rate in (5.0, -10.0)]
    grown, fallen = simulate_ensemble(systems, None, end, observe="settled", start=([1e-6], [0.0]))["settled"][:, 0]
    assert grown == np.inf
    assert fallen == pytest.approx(np.log(1e-6 * 1000.0 * np.pi / 1e-4) / 10.0, abs=1e-3)  # a half period


@pytest.fixture(scope="module")
def belts():
    """The belt of R4 over twenty periods, and one whose static limit is lower."""
    cases = [block_on_belt(Coulomb(0.4, KINETIC), SPEED), block_on_belt(Coulomb(0.3, KINETIC), SPEED)]
    observe = (sticking(0.5), energy(), poincare())
    return simulate_ensemble(cases, None, 20.0 * PERIOD, observe=observe, rtol=1e-10)


def test_share_of_time_sticking(belts):
    # ten whole periods of the cycle, so the share does not depend on where in it they begin
    assert belts["sticking"][0, 0] == pytest.approx(3.0 / PERIOD, abs=1e-7)
    assert pytest.approx(7.317597861, abs=1e-9) == PERIOD
    assert abs(belts["sticking"][1, 0] - 3.0 / PERIOD) > 0.1


def test_maxima_on_a_cycle_are_one(belts):
    assert belts["poincare"].shape == (2, 1, 8)
    assert belts["poincare"][0, 0] == pytest.approx(HIGHEST, abs=1e-6)  # the quintic of a step of at most T/6
    assert abs(belts["poincare"][1, 0, 0] - HIGHEST) > 0.01


def test_friction_feeds_what_the_oscillator_holds(belts):
    # no damping and no load: the work of friction is the change of kinetic and strain energy
    held = 0.5 * (belts.q[:, 0] ** 2 + belts.qd[:, 0] ** 2)
    assert belts["energy"][:, 0] == pytest.approx(held, abs=1e-8)
    assert abs(belts["energy"][0, 0] - 2.0 * held[0]) > 1e-3
