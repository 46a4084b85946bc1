"""The meshed drum brake against closed forms: rigid shoes by hand, a ring's bending, moments about the anchors."""

import numpy as np
import pytest

pytest.importorskip("skfem")

from squealbox import Coulomb, MeshedDrumBrake, ParameterError, complex_modes, reduce
from squealbox.fe import Anchors, Drum, Material, Shoes, free_drum_modes
from squealbox.files import read_design

RIGID = Material(young=1e14, poisson=0.0, density=1.0, damping=0.0)


def small(**changes) -> MeshedDrumBrake:
    return MeshedDrumBrake(element_size=0.03).replace(changes)


def rigid(mu: float) -> MeshedDrumBrake:
    brake = small(anchors=Anchors(pin=1e13), contact_stiffness=1e10, friction=Coulomb(mu))
    return brake.replace(dict.fromkeys(("drum.material", "shoes.lining", "shoes.table"), RIGID))


def by_hand(brake: MeshedDrumBrake, mu: float, sign: float) -> float:
    """Torque of a rigid shoe whose pressure grows with the sine of the angle from its anchor (Winkler's lining)."""
    shoes, radius = brake.shoes, brake.drum.radius
    pivot, a = radius - shoes.lining_thickness - 0.5 * shoes.table_thickness, shoes.angle
    pressing = pivot * (0.5 * a - 0.25 * np.sin(2.0 * a))
    rubbing = mu * (radius * (1.0 - np.cos(a)) - 0.5 * pivot * np.sin(a) ** 2)
    lever = 2.0 * pivot * np.sin(0.5 * a)
    return mu * radius * (1.0 - np.cos(a)) * brake.force * lever / (pressing - sign * rubbing)


@pytest.mark.parametrize("mu", [0.1, 0.3, 0.5])
def test_the_torque_of_rigid_shoes_is_that_of_the_textbook(mu):
    brake = rigid(mu)
    preload = brake.preload()
    assert not np.any(preload.lifted)
    for side, sign in ((0, 1.0), (1, -1.0)):
        assert preload.torque(side) == pytest.approx(by_hand(brake, mu, sign), rel=5e-3)


def test_the_pressure_of_a_rigid_shoe_grows_with_the_sine_of_the_angle_from_its_anchor():
    brake = rigid(0.3)
    preload, made = brake.preload(), brake.structure()
    for side, turned in ((0, -1.0), (1, 1.0)):  # the anchors are at the lower ends
        of = preload.side == side
        shape = np.sin(0.5 * brake.shoes.angle + turned * made.angle[of])
        np.testing.assert_allclose(preload.pressure[of] / shape, np.mean(preload.pressure[of] / shape), rtol=0.02)


def test_the_leading_shoe_helps_itself_the_more_the_more_friction():
    ratios = []
    for mu in (0.1, 0.3, 0.5):
        preload = small(**{"friction.static": mu}).preload()
        ratios.append(preload.torque(0) / preload.torque(1))
    assert 1.0 < ratios[0] < ratios[1] < ratios[2]
    still = small(**{"friction.static": 0.0}).preload()
    assert still.force(0) == pytest.approx(still.force(1), rel=1e-3)


@pytest.mark.parametrize("mu", [0.0, 0.45])
def test_moments_about_each_anchor_balance(mu):
    """Elastic, some points lifted off: pressure, friction and cylinder have no moment about the pin together."""
    brake = small(**{"friction.static": mu, "shoes.lining.young": 1e9})
    preload, made = brake.preload(), brake.structure()
    pivot = brake.drum.radius - brake.shoes.lining_thickness - 0.5 * brake.shoes.table_thickness
    x, y = preload.place[:2]
    normal = preload.equilibrium.normal_force
    for side, middle, end in ((0, np.pi, 1.0), (1, 0.0, -1.0)):
        at = pivot * np.array([np.cos(middle + end * 0.5 * brake.shoes.angle), np.sin(-0.5 * brake.shoes.angle)])
        of = preload.side == side
        radial = np.stack([x, y])[:, of] / made.radius[of]
        force = normal[of] * (-radial + mu * np.stack([-radial[1], radial[0]]))
        moment = np.sum((x[of] - at[0]) * force[1] - (y[of] - at[1]) * force[0])
        pushed = -np.cos(middle) * brake.force * (-2.0 * at[1])
        assert moment + pushed == pytest.approx(0.0, abs=2e-3 * abs(pushed))


def test_a_free_ring_bends_as_a_thin_ring():
    """f = n (n^2 - 1) / sqrt(n^2 + 1) sqrt(E I / (m R^4)) / 2 pi for n from 2 to 4, for a narrow thin ring."""
    drum = Drum(radius=0.098, thickness=0.004, width=0.006)
    iron = drum.material
    found = free_drum_modes(drum, 0.006, 1200.0)
    assert np.sum(found.frequency < 1.0) == 6
    for n in (2, 3, 4):
        stiff = np.sqrt(iron.young * drum.thickness**2 / (12.0 * iron.density * 0.1**4))
        exact = n * (n**2 - 1) / np.sqrt(n**2 + 1) * stiff / (2.0 * np.pi)
        assert np.sum(np.abs(found.frequency / exact - 1.0) < 5e-3) >= 2  # sine and cosine


def test_masses_are_those_of_the_volumes():
    brake = small()
    rising = np.tile([0.0, 0.0, 1.0], brake.structure().size // 3)
    mass = {name: float(rising @ (m @ rising)) for name, (m, _) in brake.components().items()}
    outer, inner = 0.11, 0.11 - 0.006
    sector = 0.5 * brake.shoes.angle * brake.shoes.width
    assert mass["linings"] == pytest.approx(2 * sector * (outer**2 - inner**2) * 2500.0, rel=1e-4)
    assert mass["tables"] == pytest.approx(2 * sector * (inner**2 - (inner - 0.012) ** 2) * 7850.0, rel=1e-4)


def test_modes_shares_reduction_and_chamfer():
    brake = small()
    band = (500.0, 4000.0)
    modes = complex_modes(brake, band=band)
    assert set(brake.shares(modes.most_unstable.shape)) == {"drum", "linings", "tables", "springs", "contact"}
    reduced = reduce(brake, band, varying={"friction.static": (0.2, 0.5)})
    same = complex_modes(reduced).eigenvalues
    half = len(modes.eigenvalues) // 2
    assert max(np.min(np.abs(same - value)) for value in modes.eigenvalues[:half]) < reduced.error + 0.1
    assert len(small(**{"shoes.chamfer": 0.2}).system().contacts) < len(brake.system().contacts)
    with pytest.raises(ParameterError, match="chamfer"):
        small(**{"shoes.chamfer": 1.4}).system()
    with pytest.raises(ParameterError, match="width"):
        small(shoes=Shoes(width=0.08))


def test_from_a_file(tmp_path):
    path = tmp_path / "drum.toml"
    shoes = '[shoes]\nangle = "100 deg"\nlining = { young = "2 GPa" }\n'
    path.write_text(f'brake = "meshed_drum_brake"\nforce = "1.5 kN"\n{shoes}')
    brake = read_design(path)
    assert isinstance(brake, MeshedDrumBrake)
    assert brake.force == 1500.0
    assert brake.shoes.lining.young == 2e9
    assert brake.shoes.angle == pytest.approx(np.deg2rad(100.0))
