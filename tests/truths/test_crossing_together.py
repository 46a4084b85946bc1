"""Which mode leaves where several lie on the imaginary axis at once: oscillators apart, each with its own onset."""

import numpy as np
import pytest

from squealbox import Contact, LinearSlope, System, critical_value, critical_values


def oscillators(damping, contacts):
    """Masses of 1 kg at 1 and 2 rad/s, with friction N (0.5 - 0.01 v) on those named; N mu' + c = 0 at N = 100 c."""
    law = LinearSlope(static=0.5, slope=-0.01)
    rows = [Contact([0.0, 0.0], np.eye(2)[i], np.eye(2)[i], 10.0, 1.0, law) for i in contacts]
    return System(np.eye(2), np.diag(damping), np.diag([1.0, 4.0]), 0.0, tuple(rows))


def test_two_that_cross_at_once_are_both_told():
    found = critical_values(oscillators([0.2, 0.2], (0, 1)), {"normal_force": (1.0, 100.0)})
    assert found.value == pytest.approx([20.0, 20.0])
    assert np.sort(np.abs(found.eigenvalue.imag)) == pytest.approx([1.0, 2.0])


@pytest.mark.parametrize("bounds", [(-0.1, 0.1), (-0.1, 0.02), (-0.05, 0.5)])
@pytest.mark.parametrize("spectator", [0.0, 1e-12, 1e-6])
@pytest.mark.parametrize("made", ["bounds", "function"])
def test_one_that_touches_no_contact_does_not_leave(bounds, spectator, made):
    system = oscillators([spectator, 0.2], (1,))
    if made == "bounds":
        found = critical_value(system, {"friction.slope": bounds})
    else:
        found = critical_value(lambda slope: system.replace({"friction.slope": slope}), "slope", bounds)
    assert float(found.value) == pytest.approx(-0.02, rel=1e-9)
    assert found.eigenvalue.imag == pytest.approx(2.0, rel=1e-9)
    assert found.mechanism == "negative_slope"


@pytest.mark.parametrize("bounds", [(-2.0, 2.0), (-1.0, 3.0), (-2.0, 2.1)])
def test_a_stiffness_that_vanishes_at_a_point_of_the_scan(bounds):
    found = critical_value(lambda k: System([[1.0]], [[0.1]], [[k]]), "k", bounds)
    assert float(found.value) == pytest.approx(0.0, abs=1e-9)
    assert found.mechanism == "divergence"
