"""Derivatives of an eigenvalue in masses, dampers and springs at places, against brakes that have them."""

import numpy as np
import pytest
from scipy import sparse

from squealbox import Coulomb, DiscBrake, DrumBrake, complex_modes
from squealbox.parameters import ParameterError
from squealbox.stability import local_sensitivity


@pytest.mark.parametrize("what", ["mass", "damper", "spring"])
@pytest.mark.parametrize("dof", [0, 1])
def test_what_is_fastened_to_the_sliding_drum(what, dof):
    """By differences of brakes that have it; the spring is fastened without force, where the drum slides steadily."""
    system = DrumBrake().system()
    mode = complex_modes(system).most_unstable
    at = np.zeros((2, 2))
    at[dof, dof] = 1.0

    def eigenvalue(amount):
        matrix = {"mass": "M", "damper": "C", "spring": "K"}[what]
        changed = {matrix: getattr(system, matrix) + amount * at}
        if what == "spring":
            changed["load"] = system.load + amount * at @ mode.steady
        return complex_modes(system.replace(**changed)).most_unstable.eigenvalue

    size = {"mass": 1e-5, "damper": 1e-2, "spring": 1e3}[what]
    by_difference = (
        8.0 * (eigenvalue(size) - eigenvalue(-size)) - eigenvalue(2.0 * size) + eigenvalue(-2.0 * size)
    ) / (12.0 * size)
    assert getattr(local_sensitivity(system, mode), what)[dof] == pytest.approx(by_difference, rel=1e-6)


def test_nodes_and_components_of_a_meshed_brake():
    """A gram at the node where it calms most, and softer backplates: as the brake that has them, to its error bar."""
    brake = DiscBrake(friction=Coulomb(0.5), element_size=0.04)
    band = (500.0, 5e3)
    mode = complex_modes(brake, band=band).most_unstable
    found = local_sensitivity(brake, mode)
    node = int(np.argmin(found.node_mass.real))
    numbers, places = brake.node_rows()
    assert len(numbers) == brake.system().size
    np.testing.assert_allclose(places[numbers == found.node[node]], [found.place[node]] * 3, atol=1e-12)
    grams = np.where(numbers == found.node[node], 1e-4, 0.0)
    system = brake.system()
    heavier = complex_modes(system.replace(M=system.M + sparse.diags_array(grams)), band=band, tolerance=1e-4)
    base = complex_modes(system, band=band, tolerance=1e-4)
    pick = lambda modes: modes.eigenvalues[np.argmin(np.abs(modes.eigenvalues - mode.eigenvalue))]  # noqa: E731
    assert (pick(heavier) - pick(base)) / 1e-4 == pytest.approx(found.node_mass[node], rel=0.02)
    assert found.parts == ("disc", "linings", "backplates", "springs", "contact")
    whole = -(mode.eigenvalue**2) * np.vdot(mode.left, system.M @ mode.shape)
    assert np.sum(found.density) == pytest.approx(whole, rel=1e-9)
    assert "for +1 g" in found.summary()
    assert "backplates, density" in found.summary()


def test_a_mode_of_another_brake_is_refused():
    with pytest.raises(ParameterError, match="mode"):
        local_sensitivity(DiscBrake(element_size=0.04), complex_modes(DrumBrake()).most_unstable)
