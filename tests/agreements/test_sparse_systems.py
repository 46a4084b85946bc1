"""A sparse system and the same one with dense matrices give the same answers."""

import numpy as np
import pytest
from scipy import sparse

from fe_brakes import dense, pad_brake
from squealbox import (
    Contact,
    Coulomb,
    LinearSlope,
    System,
    complex_modes,
    equilibrium,
    linearise,
    mode_energy,
    simulate,
)
from squealbox.contacts import Contacts
from squealbox.stability import mechanism
from squealbox.system import InvalidSystem

LAW = LinearSlope(0.5, -0.03)


@pytest.mark.parametrize("unilateral", [False, True])
def test_steady_sliding_and_linearisation(unilateral):
    system = pad_brake(friction=LAW, unilateral=unilateral)
    same = dense(system)
    state, expected = equilibrium(system), equilibrium(same)
    assert state.exists
    assert expected.exists
    assert np.any(expected.normal_force == 0.0) == unilateral
    np.testing.assert_allclose(state.q, expected.q, rtol=1e-9, atol=1e-12 * np.max(np.abs(expected.q)))
    np.testing.assert_allclose(state.normal_force, expected.normal_force, rtol=1e-9, atol=1e-9)
    about, wanted = linearise(system), linearise(same)
    np.testing.assert_allclose(about.K.toarray(), wanted.K, rtol=1e-12, atol=1e-6)
    np.testing.assert_allclose(about.C.toarray(), wanted.C, rtol=1e-9, atol=1e-9)


def test_the_modes_in_a_band_are_those_of_the_whole_spectrum():
    system = pad_brake(friction=LAW)
    every = complex_modes(dense(system)).eigenvalues
    modes = complex_modes(system, band=(3000.0, 8000.0))
    half = len(modes.eigenvalues) // 2
    inside = (every.imag > 2 * np.pi * 3000.0) & (every.imag < 2 * np.pi * 8000.0)
    assert half == np.sum(inside) > 5
    nearest = np.array([np.min(np.abs(every - value)) for value in modes.eigenvalues[:half]])
    assert np.max(nearest) < 0.06
    assert np.all(nearest <= 1.5 * modes.error[:half] + 1e-6)
    corrected = np.array([np.min(np.abs(every - value)) for value in modes.corrected[:half]])
    assert np.max(corrected) < 0.01
    full = complex_modes(system, band=(3000.0, 8000.0), method="full")
    np.testing.assert_allclose(np.sort_complex(full.eigenvalues), np.sort_complex(modes.eigenvalues), atol=0.06)
    exact = np.array([np.min(np.abs(every - value)) for value in full.eigenvalues[:half]])
    assert np.max(exact) < 1e-6


@pytest.mark.parametrize("band", [(3000.0, 5000.0), (1000.0, 20e3)])
def test_no_error_bar_is_below_what_floating_point_leaves(band):
    """A basis that spans everything leaves no residual, and still no eigenvalue is known to 1e-25 1/s."""
    system = pad_brake(friction=LAW)
    every = complex_modes(dense(system)).eigenvalues
    modes = complex_modes(system, band=band)
    half = len(modes.eigenvalues) // 2
    assert np.all(modes.error[:half] > np.finfo(float).eps * np.abs(modes.eigenvalues[:half]))
    nearest = np.array([np.min(np.abs(every - value)) for value in modes.eigenvalues[:half]])
    assert np.all(nearest <= 3.0 * modes.error[:half])
    lines = modes.summary().splitlines()
    told = [line for line in lines if line.split()[0].isdigit()]
    assert len(told) == min(half, 30)  # of more modes the least damped
    assert any(line.startswith(f"and {half - 30} more") for line in lines) == (half > 30)


def test_energies_close_and_agree_contact_by_contact():
    system = pad_brake(friction=LAW, unilateral=True)
    mode = complex_modes(system, band=(3000.0, 8000.0), method="full").most_unstable
    energy, expected = mode_energy(system, mode), mode_energy(dense(system), mode)
    assert energy.residual < 1e-9
    assert energy.growth_rate == pytest.approx(mode.growth_rate, abs=1e-6 * abs(mode.eigenvalue))
    for name in ("circulation", "slope", "across", "dissipated", "kinetic", "strain"):
        got, want = getattr(energy, name), getattr(expected, name)
        np.testing.assert_allclose(got, want, rtol=1e-8, atol=1e-10 * np.max(np.abs(want)), err_msg=name)
    assert np.sum(energy.across) > 0.0


def test_friction_across_the_sliding_direction_damps_by_its_closed_form():
    """One mass that slides along x and is free across: C_eff gains mu N / |V| there, and only there."""
    row = np.eye(2)
    contact = Contact(n=[0.0, 0.0], d=row[0], t=row[0], N0=7.0, V=-0.5, law=Coulomb(0.3), across=row[1])
    system = System(np.eye(2), np.zeros((2, 2)), 100.0 * np.eye(2), contacts=(contact,))
    damping = linearise(system).C
    np.testing.assert_allclose(damping, [[0.0, 0.0], [0.0, 0.3 * 7.0 / 0.5]], rtol=1e-14)
    modes = complex_modes(system)
    across = int(np.argmin(modes.growth_rate[:2]))
    assert modes.growth_rate[across] == pytest.approx(-0.3 * 7.0 / 0.5 / 2.0)
    energy = mode_energy(system, across)
    assert energy.growth_rate == pytest.approx(modes.growth_rate[across], rel=1e-12)
    assert energy.shares[2][0] == "contact 1: across"
    assert mechanism(system).name == "stable"


def test_a_motion_refuses_the_cross_direction():
    contact = Contact(n=[0.0], d=[0.0], t=[0.0], N0=7.0, V=0.5, law=Coulomb(0.3), across=[1.0])
    with pytest.raises(InvalidSystem, match="across"):
        simulate(System([[1.0]], [[0.0]], [[1.0]], contacts=(contact,)), 1.0)


def test_dense_analyses_say_reduce_first():
    with pytest.raises(InvalidSystem, match="240 degrees of freedom.*reduce"):
        simulate(pad_brake(), 1e-3)
    with pytest.raises(InvalidSystem, match="reduce"):
        mechanism(pad_brake())
    with pytest.raises(ValueError, match="band"):
        complex_modes(pad_brake())
    with pytest.raises(ValueError, match="certify"):
        complex_modes(dense(pad_brake()), certify=True)
    some = complex_modes(dense(pad_brake()), band=(3000.0, 6000.0))
    assert np.all((some.frequency > 3000.0) & (some.frequency < 6000.0))


def test_single_contacts_with_sparse_rows_make_the_same_table():
    system = pad_brake(unilateral=True)
    singles = System(system.M, system.C, system.K, system.load, tuple(system.contacts))
    assert len(singles.contacts) == len(system.contacts) == 40
    np.testing.assert_array_equal(equilibrium(singles).normal_force, equilibrium(system).normal_force)
    assert singles == System(system.M, system.C, system.K, system.load, tuple(system.contacts))
    assert singles != System(system.M, system.C, 2.0 * system.K, system.load, tuple(system.contacts))


def test_bad_tables_are_named():
    eye = np.eye(3)
    with pytest.raises(InvalidSystem, match=r"contacts\.d has shape"):
        Contacts(n=eye, d=eye[:2], t=eye, N0=1.0, V=1.0, law=Coulomb(0.3))
    with pytest.raises(InvalidSystem, match="normal is missing"):
        Contacts(n=eye, d=eye, t=eye, N0=1.0, V=1.0, law=Coulomb(0.3), unilateral=True)
    with pytest.raises(InvalidSystem, match=r"contacts\.V has shape"):
        Contacts(n=eye, d=eye, t=eye, N0=1.0, V=[1.0, 2.0], law=Coulomb(0.3))
    with pytest.raises(InvalidSystem, match="not finite"):
        System(sparse.eye_array(2), sparse.eye_array(2), sparse.diags_array([1.0, np.nan]))
    with pytest.raises(InvalidSystem, match="M is not symmetric"):
        System(sparse.csr_array([[1.0, 1.0], [0.0, 1.0]]), sparse.eye_array(2), sparse.eye_array(2))
