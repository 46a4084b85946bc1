"""Laws averaged over a dither, in time: the compiled text against NumPy's quadrature, runs against SciPy."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from squealbox import (
    Coulomb,
    Dithered,
    Hyperbolic,
    LinearSlope,
    MassOnBelt,
    ParameterError,
    Stribeck,
    simulate,
    simulate_ensemble,
)
from squealbox.files.own_law import own_law
from squealbox.friction import Averaged, Cubic, Table

BELL = "def mu(v, p):\n    a = p[1] * v\n    return 0.3 + 0.1 * np.exp(-a * a)"
LAWS = {
    "stribeck": Stribeck(0.5, 0.3, 0.1),
    "sharp stribeck": Stribeck(0.5, 0.3, 0.004),
    "hyperbolic": Hyperbolic(0.6, 5.0),
    "with a floor": LinearSlope(0.5, -0.3, 0.2),
    "table": Table([0.0, 0.2, 0.7, 1.5], [0.5, 0.4, 0.35, 0.3]),
    "own": own_law(BELL, numbers=(4.0,)),
    "cubic": Cubic(0.5, 0.3, 1.1),
}


def compiled_text(law):
    """mu and slope of the text, run as plain functions."""
    space = {"np": np}
    for text in law.texts:
        exec(text, space)
    return space["mu"], space["slope"]


@pytest.mark.parametrize("name", list(LAWS))
@pytest.mark.parametrize("dither", [0.05, 0.6, 2.0])
def test_the_text_is_the_quadrature(name, dither):
    law = Averaged(LAWS[name], dither)
    mu, slope = compiled_text(law)
    speeds, p = np.r_[0.0, 1e-6, np.linspace(0.01, 4.0, 200), dither * np.array([0.9999, 1.0001])], law.coefficients()
    assert np.max(np.abs(mu(speeds, p) - law.mu(speeds))) < 1e-14
    assert mu(0.0, p) == 0.0
    assert slope(0.0, p) == pytest.approx(float(law.slope_at(0.0)), rel=1e-7)
    assert np.max(np.abs(mu(speeds, p) - LAWS[name].mu(speeds))) > 1e-3


def test_a_text_takes_a_map_of_dithers():
    dithers = np.array([0.3, 0.6])
    whole = Averaged(LAWS["stribeck"], dithers)
    for i, dither in enumerate(dithers):
        one = Averaged(LAWS["stribeck"], float(dither))
        assert compiled_text(whole)[0](0.4, whole.coefficients())[i] == float(
            compiled_text(one)[0](0.4, one.coefficients())
        )


@pytest.mark.parametrize("name", ["stribeck", "with a floor", "own"])
def test_a_run_on_an_averaged_law_is_that_of_scipy(name):
    brake = Dithered(MassOnBelt(c=0.02, load=0.0, sliding_speed=0.3, friction=LAWS[name]), 0.6, 1e3)
    law, times = Averaged(LAWS[name], 0.6), np.linspace(0.0, 8.0, 9)
    load = float(brake.system().contacts[0].N0)

    def field(t, x):
        v = 0.3 - x[1]
        return [x[1], -0.02 * x[1] - x[0] + load * np.sign(v) * float(law.mu(v))]

    exact = solve_ivp(field, (0.0, 8.0), [0.2, 0.0], "DOP853", rtol=1e-9, atol=1e-11, t_eval=times).y[0]
    found = simulate(brake, 8.0, ([0.2], [0.0]), times=times, rtol=1e-10)
    assert found.outcome == "completed"
    assert np.max(np.abs(found.q[:, 0] - exact)) < 1e-6
    assert found.energy.relative_residual < 1e-7


def test_an_ensemble_over_the_dither_is_its_single_runs():
    brake = Dithered(MassOnBelt(c=0.02, sliding_speed=0.3, friction=LAWS["with a floor"]), 0.6, 1e3)
    many = simulate_ensemble(brake, {"velocity": [0.4, 0.6]}, 8.0, start=([1.0], [0.0]), rtol=1e-11)
    for i, dither in enumerate((0.4, 0.6)):
        one = simulate(brake.replace(velocity=dither), 8.0, ([1.0], [0.0]), rtol=1e-11)
        assert many.q[i] == pytest.approx(one.q[-1], abs=1e-8)


def test_a_law_with_two_returns_is_said():
    law = own_law("def mu(v, p):\n    if v > 1.0:\n        return 0.3\n    return 0.3", static=0.3)
    with pytest.raises(ParameterError, match="one return, at the end"):
        Averaged(law, 0.5)
    assert Averaged(Coulomb(0.3), 0.5).texts is not None
