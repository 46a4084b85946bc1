"""Worn linings against closed forms: Archard's law on a rigid lining, pressure times radius when all is run in."""

import numpy as np
import pytest
from scipy import sparse
from scipy.linalg import expm
from scipy.optimize import brentq

pytest.importorskip("skfem")

from squealbox import Coulomb, DiscBrake, MeshedDrumBrake, ParameterError, complex_modes, reduce
from squealbox.fe import Material, Pads, Springs
from squealbox.fe.wear import Pressed, run_in
from squealbox.files import read_design
from squealbox.system import InvalidSystem

RIGID = Material(young=1e15, poisson=0.0, density=1.0, damping=0.0)


def disc(**changes) -> DiscBrake:
    return DiscBrake(element_size=0.05, friction=Coulomb(0.4)).replace(changes)


def drum(**changes) -> MeshedDrumBrake:
    return MeshedDrumBrake(element_size=0.03, friction=Coulomb(0.4)).replace(changes)


def spread(values):
    return float(np.ptp(values) / np.mean(values))


def rigid_lining() -> Pressed:
    """One freedom u, pushed by 30 N onto three places on springs: g' = k r (u - g), sum of A k (u - g) = 30 N."""
    area, radius, k = np.array([1.0, 2.0, 1.5]), np.array([0.05, 0.1, 0.2]), 1e3
    rows = sparse.csr_array(np.ones((3, 1)))
    stiffness = sparse.csr_array([[k * float(np.sum(area))]])
    return Pressed(stiffness, np.array([30.0]), rows, 0.0 * rows, area, radius, k, 0.0, np.ones((1, 1)))


def exactly(brake: Pressed, mean: float):
    """g after `mean`, by the exponential of the linear equation."""
    k, area, radius = brake.contact, brake.area, brake.radius
    matrix = np.zeros((4, 4))
    matrix[:3, :3] = k * radius[:, None] * (np.outer(np.ones(3), area / np.sum(area)) - np.eye(3))
    matrix[:3, 3] = radius * brake.load[0] / np.sum(area)

    def after(a):
        return expm(matrix * a)[:3, 3]

    return after(brentq(lambda a: area @ after(a) / np.sum(area) - mean, 0.0, 1e3 * mean))


@pytest.mark.parametrize("mean", [1e-3, 1e-2, 1.0])
def test_a_rigid_lining_wears_as_its_linear_equation_says(mean):
    brake = rigid_lining()
    worn = run_in(brake, mean)
    assert brake.area @ worn.depth / np.sum(brake.area) == pytest.approx(mean, rel=1e-7)
    exact = exactly(brake, mean)
    np.testing.assert_allclose(worn.depth - mean, exact - mean, atol=6e-3 * np.ptp(exact))


def test_the_error_of_the_steps_is_of_second_order():
    brake = rigid_lining()
    off = [np.max(np.abs(run_in(brake, 1e-2, steps=n, longer=r).depth - exactly(brake, 1e-2)))
           for n, r in ((16, 1.0), (32, 1.0), (64, 1.0))]  # fmt: skip
    assert np.log2(off[0] / off[1]) == pytest.approx(2.0, abs=0.3)
    assert np.log2(off[1] / off[2]) == pytest.approx(2.0, abs=0.2)


def test_new_linings_are_today_s_brake():
    brake = disc()
    system = brake.system()
    assert brake.worn() is None
    assert not np.any(system.contacts.N0)
    np.testing.assert_array_equal(system.load, brake.pressure * brake.structure().loads["pressure"])
    assert not np.any(brake.preload().worn)


def test_a_disc_brake_runs_in_until_pressure_times_radius_is_even():
    new = disc().preload()
    some, deep = (disc(running_in=depth).preload() for depth in (1e-6, 1e-4))
    assert np.mean(new.lifted) > np.mean(some.lifted) > 0.0
    assert not np.any(deep.lifted)
    for worn, depth in ((some, 1e-6), (deep, 1e-4)):
        assert np.sum(worn.area * worn.worn) / np.sum(worn.area) == pytest.approx(depth, rel=1e-7)
        for side in (0, 1):
            assert worn.force(side) == pytest.approx(new.force(side), rel=1e-6)
    even = deep.pressure * np.hypot(*deep.place[:2])
    assert spread(even) < 2e-3 < 0.3 < spread((deep.pressure)[deep.side == 0])


def test_a_drum_brake_runs_in_to_the_sine_of_the_angle_from_the_anchor():
    """An elastic shoe, too: it turns on its anchor, so the depth grows with the way of each point."""
    brake = drum(running_in=1e-3)
    preload, made = brake.preload(), brake.structure()
    for side, turned in ((0, -1.0), (1, 1.0)):
        of = preload.side == side
        shape = np.sin(0.5 * brake.shoes.angle + turned * made.angle[of])
        assert spread(preload.pressure[of] / shape) < 0.03
    assert spread(drum().preload().pressure) > 1.0
    assert preload.force(0) > preload.force(1)


@pytest.mark.parametrize("brake", [disc(running_in=2e-6), drum(running_in=5e-6)])
def test_what_wears_off_next_is_pressure_times_radius_as_steady_sliding_has_it(brake):
    """The worn system, about which modes are computed, presses as the last step of running in did."""
    h = brake.running_in
    before, now, after = (brake.replace({"running_in": s * h}).preload() for s in (0.98, 1.0, 1.02))
    rate = (after.worn - before.worn) / (0.04 * h)
    even = now.pressure * np.hypot(*now.place[:2])
    expected = even / (now.area @ even) * np.sum(now.area)
    np.testing.assert_allclose(rate, expected, atol=0.05 * np.max(expected))


def test_friction_and_pressure_of_the_stop_leave_the_lining_as_it_is():
    brake = disc(running_in=5e-6)
    other = brake.replace({"friction.static": 0.2, "pressure": 1e6, "angular_speed": 3.0})
    assert other.worn() is brake.worn()
    assert brake.replace({"running_in_friction": 0.2}).worn() is not brake.worn()


def test_a_caliper_without_stiffness_changes_no_force_either():
    brake = disc(running_in=2e-5, springs=Springs(caliper=0.0))
    preload = brake.preload()
    assert preload.equilibrium.exists
    assert preload.force(0) == pytest.approx(1.5e6 * np.pi * 0.021**2, rel=1e-6)


def test_a_worn_brake_reduces_over_friction_and_a_wide_range_of_depth_is_refused():
    brake = DiscBrake(element_size=0.05, running_in=1e-5)
    band = (2500.0, 4000.0)
    small = reduce(brake, band, varying={"friction.static": (0.2, 0.6)})
    full = complex_modes(brake.replace({"friction.static": 0.3}), band=band).corrected
    found = complex_modes(small.replace({"friction.static": 0.3})).eigenvalues
    assert max(np.min(np.abs(found - value)) for value in full[: len(full) // 2]) < 3.0 * small.error + 0.2
    with pytest.raises(InvalidSystem, match="narrower range"):
        reduce(brake, band, varying={"running_in": (5e-6, 2e-5)})


def test_from_a_file(tmp_path):
    path = tmp_path / "disc.toml"
    path.write_text('brake = "disc_brake"\nelement_size = "50 mm"\nrunning_in = "20 um"\npiston_offset = "2 mm"\n')
    brake = read_design(path)
    assert (brake.running_in, brake.piston_offset) == (pytest.approx(2e-5), pytest.approx(2e-3))
    with pytest.raises(ParameterError, match="running_in"):
        brake.replace({"running_in": -1e-6})
    for worn in (disc, drum):
        with pytest.raises(ParameterError, match="less than the thickness of the lining"):
            worn(running_in=0.02)


def test_a_shifted_piston_shifts_the_pressure_by_as_much():
    """Moments of a rigid pad: its centre of pressure is the patch's, less friction times the abutment's height."""
    pads = Pads(angle=0.3, inner_radius=0.108, outer_radius=0.116, thickness=0.002)
    brake = disc(pads=pads, piston_radius=0.0039, springs=Springs(caliper=0.0, abutment=8e7), element_size=0.0125)
    brake = brake.replace({"disc.inner_radius": 0.104, "disc.outer_radius": 0.12, "disc.thickness": 0.004})
    brake = brake.replace(dict.fromkeys(("disc.material", "pads.material", "backplates.material"), RIGID))
    height, middle = 0.002 + 0.0025, 0.112
    for offset in (0.002, -0.001):
        preload = brake.replace({"piston_offset": offset, "friction.static": 0.3}).preload()
        for side in (0, 1):
            force = preload.equilibrium.normal_force[preload.side == side]
            along = preload.place[1][preload.side == side]
            centre = np.sum(force * along) / np.sum(force)
            assert centre == pytest.approx(middle * np.sin(offset / middle) - 0.3 * height, abs=5e-5)
            assert np.sum(force) == pytest.approx(1.5e6 * np.pi * 0.0039**2, rel=1e-6)


def test_the_load_of_a_shifted_piston_is_that_of_its_patch():
    made = disc(piston_offset=5e-3).structure()
    y = np.concatenate([body.places[1] for body in made.bodies])[made.kept]
    z = np.concatenate([body.places[2] for body in made.bodies])[made.kept]
    load = np.where((np.arange(made.size) % 3 == 2) & (z > 0.0), made.loads["pressure"], 0.0)
    assert np.sum(load) == pytest.approx(-np.pi * 0.021**2, rel=1e-9)
    assert load @ y / np.sum(load) == pytest.approx(0.112 * np.sin(5e-3 / 0.112), rel=1e-9)
    with pytest.raises(ParameterError, match="leaves the patch on the plate"):
        disc(piston_offset=0.03)
