"""A brake on two meshes: modes are found again by their shapes, and the same mesh finds all of them."""

import numpy as np
import pytest

pytest.importorskip("skfem")

from squealbox import Coulomb, DiscBrake, DrumBrake, ParameterError, complex_modes
from squealbox.stability import mesh_doubt

BAND = (500.0, 4e3)


@pytest.fixture(scope="module")
def brake():
    return DiscBrake(friction=Coulomb(0.5), element_size=0.04)


@pytest.fixture(scope="module")
def modes(brake):
    return complex_modes(brake, band=BAND)


def test_its_own_mesh_says_the_same(brake, modes):
    found = mesh_doubt(brake, modes, 0.04)
    np.testing.assert_allclose(found.likeness, 1.0, atol=1e-3)
    np.testing.assert_allclose(found.other_frequency, found.frequency, rtol=1e-5)
    np.testing.assert_allclose(found.other_growth_rate, found.growth_rate, atol=0.05)
    assert found.outcome == "same_mesh"
    assert "one mesh was looked at" in found.sentence
    assert found.freedoms[0] == found.freedoms[1] == brake.system().size


def test_a_finer_mesh_shifts_frequencies_little_and_growth_rates_much(brake, modes):
    found = mesh_doubt(brake, modes, 0.03)
    low = found.frequency < 2e3
    assert np.all(found.likeness[low] > 0.7)
    assert np.max(np.abs(found.other_frequency[low] / found.frequency[low] - 1.0)) < 0.03
    there = complex_modes(brake.replace(element_size=0.03), band=BAND)
    for i in np.flatnonzero(np.isfinite(found.other_frequency)):  # each is a mode of the other mesh
        value = found.other_growth_rate[i] + 2j * np.pi * found.other_frequency[i]
        assert np.min(np.abs(there.eigenvalues - value)) < 1.0 or found.other_frequency[i] > BAND[1]
    grows = np.nanargmax(np.abs(found.other_growth_rate - found.growth_rate) * (found.growth_rate > 0.0))
    assert f"{abs(found.other_growth_rate[grows] - found.growth_rate[grows]):.3g} 1/s" in found.sentence


def test_a_mesh_that_is_too_coarse_is_said_and_loses_nothing(brake, modes, monkeypatch):
    def none(self):
        raise ParameterError("DiscBrake", "piston_radius", 0.001, "a patch that holds at least one quadrature point")

    monkeypatch.setattr(type(brake), "system", none)
    found = mesh_doubt(brake, modes, 0.06)
    assert found.outcome == "no_second_mesh"
    assert "piston_radius" in found.sentence
    assert np.all(np.isnan(found.other_frequency))
    np.testing.assert_array_equal(found.growth_rate, modes.growth_rate[: len(found.frequency)])


def test_a_brake_without_a_mesh_of_its_own_is_refused(modes):
    with pytest.raises(ParameterError, match="meshes itself"):
        mesh_doubt(DrumBrake(), modes)
