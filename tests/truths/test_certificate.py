"""The winding number counts what is inside: nothing missing, one hidden, one too many; and it says when it cannot."""

import numpy as np
import pytest

from fe_brakes import dense, pad_brake
from squealbox import Coulomb, complex_modes
from squealbox.fe import certificate, count_below, pencil_of, real_modes
from squealbox.fe.certificates import certified_band
from squealbox.fe.growing_basis import GrowingBasis
from squealbox.fe.projection import basis_for, modes_on, refined
from squealbox.stability import certified
from squealbox.stability.modes_in_band import known_eigenvalues

BAND = (3000.0, 7000.0)


@pytest.fixture(scope="module")
def brake():
    system = pad_brake(friction=Coulomb(0.9))
    values = complex_modes(dense(system)).eigenvalues
    return pencil_of(system), values[values.imag > 0.0], system


def unstable(values):
    inside = (values.imag > 2 * np.pi * BAND[0]) & (values.imag < 2 * np.pi * BAND[1])
    return np.flatnonzero(inside & (values.real > 0.0))


def test_none_is_missing_from_the_whole_spectrum(brake):
    pencil, values, _ = brake
    found = certificate(pencil, values, BAND)
    assert found.certified
    assert found.factorisations <= 150
    assert "none missed" in str(found)
    assert found.known >= len(unstable(values)) > 0


def test_every_hidden_unstable_mode_is_noticed(brake):
    pencil, values, _ = brake
    for hidden in unstable(values):
        found = certificate(pencil, np.delete(values, hidden), BAND)
        assert found.missing == 1
        assert not found.certified
        assert "1 mode missing" in found.reason


def test_two_hidden_modes_and_one_invented_are_counted(brake):
    pencil, values, _ = brake
    known = certificate(pencil, values, BAND)
    inside = np.flatnonzero(
        (values.real > known.growth[0])
        & (values.imag > 2 * np.pi * known.band[0])
        & (values.imag < 2 * np.pi * known.band[1])
    )
    assert certificate(pencil, np.delete(values, inside[:2]), BAND).missing == 2
    invented = np.append(values, 200.0 + 2j * np.pi * 5000.0)
    assert certificate(pencil, invented, BAND).missing == -1


def test_a_list_of_which_most_are_wrong_is_counted_all_the_same(brake):
    """The eigenvalues near the contour are found where it is hard to follow, whatever the list says of them."""
    pencil, values, _ = brake
    random = np.random.default_rng(3)
    off = 40.0 * (random.standard_normal(len(values)) + 1j * random.standard_normal(len(values)))
    wrong = np.delete(values + off, unstable(values)[0])
    found = certificate(pencil, wrong, BAND)
    (left, right), (low, high) = found.growth, 2 * np.pi * np.array(found.band)
    inside = (values.real > left) & (values.real < right) & (values.imag > low) & (values.imag < high)
    assert found.missing == np.sum(inside) - found.known
    assert found.factorisations <= 150


def test_too_few_factorisations_certify_nothing(brake):
    pencil, values, _ = brake
    found = certificate(pencil, values, BAND, most=10)
    assert found.missing is None
    assert not found.certified
    assert "10 factorisations" in found.reason


def test_through_the_analyses(brake):
    _, values, system = brake
    modes = complex_modes(system, band=BAND, certify=True)
    assert modes.certified
    assert modes.missing == 0
    assert modes.real_modes_complete
    assert certified(system, np.delete(values, unstable(values)[0]), BAND).missing == 1
    assert not complex_modes(system, band=BAND).certified


def test_sturm_counts_the_real_modes():
    pencil = pencil_of(pad_brake())
    exact = np.sqrt(
        np.linalg.eigvalsh(pencil.elastic.toarray() / pencil.M.diagonal()[:, None] ** 0.5 / pencil.M.diagonal() ** 0.5)
    ) / (2 * np.pi)
    for top in (4000.0, 8000.0, 1e6):
        found = real_modes(pencil.elastic, pencil.M, top)
        assert found.complete
        assert count_below(pencil.elastic, pencil.M, top) == np.sum(exact < top)
        np.testing.assert_allclose(found.frequency, exact[exact < top], rtol=1e-9)


def counted(pencil, found, phases):
    known, others = known_eigenvalues(found)
    return certificate(pencil, known, BAND, believed=others, phases=phases)


def test_a_growing_mode_that_the_basis_lacks_is_noticed_and_nothing_else(brake):
    """The basis less the right shape of one growing mode: its eigenvalue is then nowhere in the list."""
    pencil, _, _ = brake
    modes, basis = basis_for(pencil, BAND)
    onto = GrowingBasis([pencil], basis)
    refined(onto, modes.base, BAND, 0.05)
    whole = modes_on(onto, 0, modes.base, certified_band(BAND))[0]
    basis = np.concatenate(onto.blocks, axis=1)
    phases = {}
    assert counted(pencil, whole, phases).certified
    growing = np.flatnonzero(whole.eigenvalues.real > np.abs(whole.error))
    assert len(growing)
    for hidden in growing:
        shape = whole.x[:, [hidden]]
        gone = np.linalg.qr(np.concatenate([shape.real, shape.imag], axis=1))[0]
        rest = np.linalg.svd(np.eye(len(gone)) - gone @ gone.T)[0][:, : len(gone) - 2]
        less = modes_on(GrowingBasis([pencil], basis @ rest), 0, modes.base, certified_band(BAND))[0]
        found = counted(pencil, less, phases)
        assert found.missing >= 1  # without that shape others may be too far off to be known
        assert found.factorisations <= 150
