"""A reduced brake with its structure changed beside the full brake changed so, and cures made of such changes."""

import numpy as np
import pytest

from squealbox import ParameterError, complex_modes, reduce
from squealbox.fe import DiscBrake, MeshedDrumBrake, with_component, with_mass
from squealbox.remedies import silence

BAND = (500.0, 8000.0)


@pytest.fixture(scope="module")
def disc():
    brake = DiscBrake(element_size=0.03)
    return brake, reduce(brake, BAND)


def inside_band(eigenvalues):
    """Those with Im > 0, but for the end of the band, which a mode may have crossed."""
    return eigenvalues[(eigenvalues.imag > 0.0) & (eigenvalues.imag < 0.97 * 2.0 * np.pi * BAND[1])]


def apart(some, others):
    """Largest distance of an eigenvalue of some from the nearest of the others [1/s]."""
    return float(np.max(np.min(np.abs(inside_band(some)[:, None] - others), axis=1)))


def assert_changed_alike(small, changed, full):
    """A tenth of what the change moves at most is wrong."""
    values = complex_modes(changed).eigenvalues
    assert apart(values, full.corrected) < 0.1 * apart(values, complex_modes(small).eigenvalues)


@pytest.mark.parametrize(
    ("name", "factors", "change"),
    [
        ("linings", {"modulus": 0.9}, {"pads.material.young": 3.6e9}),
        ("backplates", {"density": 1.1}, {"backplates.material.density": 8635.0}),
        ("disc", {"damping": 5.0}, {"disc.material.damping": 1e-7}),
        ("springs", {"modulus": 1.1}, {"springs.caliper": 4.4e8, "springs.abutment": 8.8e7}),
    ],
)
def test_a_changed_component_is_that_of_the_brake_made_anew(disc, name, factors, change):
    brake, small = disc
    full = complex_modes(brake.replace(change), band=BAND)
    assert_changed_alike(small, with_component(small, name, **factors), full)


def test_a_mass_on_a_node_is_that_in_the_matrices(disc):
    brake, small = disc
    numbers, _ = brake.node_rows()
    node = int(numbers[len(numbers) // 3])
    system = brake.system()
    mass = system.M.tolil()
    for row in np.flatnonzero(numbers == node):
        mass[row, row] += 0.02
    full = complex_modes(system.replace(M=mass.tocsr()), band=BAND)
    assert_changed_alike(small, with_mass(small, node, 0.02), full)


def test_cures_are_the_brakes_their_lines_make(disc):
    _, small = disc
    found = silence(small, samples=2)  # of the lot nothing is asked here
    assert {"linings", "backplates", "disc"} <= {name.split()[0] for name in found.name}
    assert any(name.startswith("mass on node") for name in found.name)
    assert np.all(found.growth_at_margin <= found.growth_before + 1e3)
    row = int(np.argmin(found.growth))
    again = complex_modes(found.design(row)).growth_rate
    assert np.max(again[np.isfinite(again)]) == pytest.approx(found.growth[row], abs=1e-3)
    assert found.growth[row] < found.growth_before
    assert "on the basis of the brake as it is" in found.summary()


def test_a_drum_of_finite_elements_has_cures_too():
    found = silence(reduce(MeshedDrumBrake(element_size=0.03), (500.0, 4000.0)), samples=2)
    assert "tables" in " ".join(found.name)


def test_what_cannot_be_changed_is_named(disc):
    _, small = disc
    with pytest.raises(ParameterError, match="disc, linings, backplates, springs"):
        with_component(small, "rotor")
    with pytest.raises(ParameterError, match="modulus"):
        with_component(small, "disc", modulus=0.0)
    with pytest.raises(ParameterError, match="node"):
        with_mass(small, 10**6, 0.1)
