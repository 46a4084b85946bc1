"""The brake meshed here against closed forms: a disc's mass and modes, a pad even and tilted, forces balance."""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import jv, yv

pytest.importorskip("skfem")

from squealbox import Coulomb, ParameterError, complex_modes, reduce
from squealbox.fe import Disc, DiscBrake, Material, Pads, Springs, free_disc_modes

RIGID = Material(young=1e15, poisson=0.0, density=1.0, damping=0.0)
SOFT = Material(young=4e9, poisson=0.0, density=2500.0)


def small(**changes) -> DiscBrake:
    return DiscBrake(element_size=0.03).replace(changes)


def test_masses_are_those_of_the_volumes():
    brake = small()
    rigid = np.tile([0.0, 0.0, 1.0], brake.structure().size // 3)
    mass = {name: float(rigid @ (m @ rigid)) for name, (m, _) in brake.components().items()}
    sector = 0.5 * brake.pads.angle * (0.136**2 - 0.088**2)
    assert mass["linings"] == pytest.approx(2 * sector * 0.010 * 2500.0, rel=1e-4)
    assert mass["backplates"] == pytest.approx(2 * sector * 0.005 * 7850.0, rel=1e-4)
    assert mass["disc"] < np.pi * (0.14**2 - 0.045**2) * 0.012 * 7200.0  # its held rim is left out


def test_a_free_disc_turns_in_itself_as_bessel_says():
    """u_theta(r) = A J1(kr) + B Y1(kr) with no shear at bore and rim, whatever the thickness: exact elasticity."""
    disc = Disc(thickness=0.004)
    a, b = disc.inner_radius, disc.outer_radius
    k = brentq(lambda k: jv(2, k * a) * yv(2, k * b) - jv(2, k * b) * yv(2, k * a), 20.0, 50.0)
    shear = disc.material.young / (2.0 * (1.0 + disc.material.poisson))
    exact = k * np.sqrt(shear / disc.material.density) / (2.0 * np.pi)
    found = free_disc_modes(disc, 0.02, 1.02 * exact)
    assert found.complete
    assert np.sum(found.frequency < 1.0) == 6
    assert np.min(np.abs(found.frequency / exact - 1.0)) < 1e-3


def test_a_free_disc_is_that_of_another_program():
    """CalculiX 2.20 (Debian), 120 x 10 x 2 elements C3D20 around, outwards and through: frequencies [Hz]."""
    calculix = [552.5093, 947.5674, 1383.283, 1953.479, 2433.099, 3543.508, 3685.568, 4042.292]
    found = free_disc_modes(Disc(), 0.01, 4500.0).frequency[6:]
    nearest = [found[np.argmin(np.abs(found - exact))] for exact in calculix]
    np.testing.assert_allclose(nearest, calculix, rtol=1e-3)
    assert len(found) == 15  # all of them in pairs but the one that stays round


def test_frequencies_converge_with_the_mesh():
    first = [free_disc_modes(Disc(), size, 1500.0).frequency[6] for size in (0.03, 0.02, 0.014)]
    assert abs(first[2] / first[1] - 1.0) < 3e-3
    assert abs(first[2] - first[1]) < abs(first[1] - first[0])


def test_patch_a_pad_pressed_all_over_presses_evenly():
    """On a rigid disc, without sideways contraction, every point carries the pressure on the plate's back."""
    brake = small(friction=Coulomb(0.0), piston_radius=1.0, springs=Springs(caliper=0.0, abutment=1.0))
    brake = brake.replace({"disc.material": RIGID, "pads.material": SOFT, "backplates.material.poisson": 0.0})
    preload = brake.preload()
    np.testing.assert_allclose(preload.pressure, brake.pressure, rtol=1e-4)
    assert not np.any(preload.lifted)


def test_a_dragged_pad_digs_in_at_its_leading_end_by_its_lever():
    """Moments about the contact plane: the centre of pressure moves by mu times the height of the abutment."""
    pads = Pads(angle=0.3, inner_radius=0.108, outer_radius=0.116, thickness=0.002)
    disc = Disc(inner_radius=0.104, outer_radius=0.12, thickness=0.004)
    springs = Springs(caliper=0.0, abutment=8e7)
    brake = small(disc=disc, pads=pads, piston_radius=0.0039, springs=springs, element_size=0.0125)
    brake = brake.replace({"disc.material": RIGID, "pads.material": RIGID, "backplates.material": RIGID})
    height = 0.002 + 0.0025
    for mu in (0.0, 0.3):
        preload = brake.replace({"friction.static": mu}).preload()
        upper = preload.side == 0
        force = preload.equilibrium.normal_force[upper]
        along = np.arctan2(preload.place[1], preload.place[0])[upper] * 0.112
        assert np.sum(force * along) / np.sum(force) == pytest.approx(-mu * height, abs=0.03 * 0.3 * height)
        assert np.sum(force) == pytest.approx(1.5e6 * np.pi * 0.0039**2, rel=1e-6)


def test_points_lift_off_and_the_state_balances():
    brake = small()
    preload, system = brake.preload(), brake.system()
    state = preload.equilibrium
    assert state.exists
    assert 0.05 < np.mean(preload.lifted) < 0.6
    assert preload.force(0) == pytest.approx(preload.force(1), rel=1e-6)
    table = system.contacts
    gap = table.n @ state.q
    assert np.all(gap[preload.lifted] <= 0.0)
    left = system.K @ state.q - system.load - table.normal.T @ np.minimum(gap, 0.0)
    left -= table.d.T @ (0.5 * np.maximum(gap, 0.0))
    assert np.linalg.norm(left) < 1e-8 * np.linalg.norm(system.load)


def test_chamfer_and_slot_take_contact_away():
    whole = len(small().system().contacts)
    assert len(small(**{"pads.chamfer": 0.15}).system().contacts) < whole
    assert len(small(**{"pads.slot": 0.2}).system().contacts) < whole
    with pytest.raises(ParameterError, match="chamfer"):
        small(**{"pads.chamfer": 0.9}).system()
    with pytest.raises(ParameterError, match="outer radius|within the disc|more than its bore"):
        small(disc=Disc(inner_radius=0.2))


def test_modes_shares_and_reduction():
    brake = small()
    modes = complex_modes(brake, band=(1000.0, 3000.0))
    mode = modes.most_unstable
    shares = brake.shares(mode.shape)
    assert sum(kinetic for kinetic, _ in shares.values()) == pytest.approx(1.0)
    assert set(shares) == {"disc", "linings", "backplates", "springs", "contact"}
    reduced = reduce(brake, (1000.0, 3000.0), varying={"pads.material.young": (3.9e9, 4.3e9)})
    same = complex_modes(reduced).eigenvalues
    half = len(modes.eigenvalues) // 2
    off = [np.min(np.abs(same - value)) for value in modes.eigenvalues[:half]]
    assert max(off) < reduced.error + 0.1
    stiffer = complex_modes(brake.replace({"pads.material.young": 4.2e9}), band=(1000.0, 3000.0)).corrected
    moved = complex_modes(reduced.replace({"pads.material.young": 4.2e9})).eigenvalues
    assert max(np.min(np.abs(moved - v)) for v in stiffer[: len(stiffer) // 2]) < 2.0 * reduced.error + 0.2
