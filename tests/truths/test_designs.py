"""Designs against closed forms and the reference cases; each with a wrong twin that must fail."""

import numpy as np
import pytest

from squealbox import (
    BlockChain,
    Body,
    Coulomb,
    Cubic,
    DampingParadox,
    DrumBrakeShoes,
    InclinedSprings,
    LinearSlope,
    MassOnBelt,
    ModeCoupling,
    OwnMechanism,
    PadOnDisc,
    SpragSlip,
    Spring,
    Touch,
    WobblingDisc,
    complex_modes,
    critical_value,
    equilibrium,
    linearise,
    simulate,
)

ROUND_OFF = 1e-9  # eigenvalues of matrices of two to eight rows


@pytest.mark.parametrize(
    ("mu", "expected"),
    [(0.0, [1j, 1.732051j]), (0.5, [1.137055j, 1.645328j]), (1.5, [0.246293 + 1.4355j]), (2.0, [0.343561 + 1.455347j])],
)
def test_mode_coupling_is_r1(mu, expected):
    found = complex_modes(ModeCoupling(friction=Coulomb(mu))).eigenvalues
    for value in expected:
        assert np.min(np.abs(found - value)) < 1e-6  # the digits of the table
    wrong = complex_modes(ModeCoupling(k12=-1.0, friction=Coulomb(mu))).eigenvalues
    assert mu == 0.0 or np.min(np.abs(wrong - expected[0])) > 1e-3


@pytest.mark.parametrize(
    ("c1", "c2", "onset"), [(0.01, 0.01, 1.0002), (0.1, 0.1, 1.02), (0.2, 0.1, 1.04), (0.5, 0.5, 1.5)]
)
def test_damped_mode_coupling_is_r1(c1, c2, onset):
    assert critical_value(ModeCoupling(c1=c1, c2=c2), "friction.static", (0.5, 2.0)).value == pytest.approx(onset, 1e-9)


@pytest.mark.parametrize(
    ("eta2", "onset"),
    [(0.002, 0.148713), (0.005, 0.212906), (0.01, 0.260144), (0.02, 0.289367), (0.04, 0.287309), (0.08, 0.256324)],
)
def test_damping_paradox_is_r2(eta2, onset):
    brake = DampingParadox(eta1=0.02, eta2=eta2)
    assert critical_value(brake, "friction.static", (0.05, 0.5)).value == pytest.approx(onset, abs=1e-6)
    swapped = critical_value(brake.replace(eta1=eta2, eta2=0.03), "friction.static", (0.05, 0.5)).value
    assert swapped != pytest.approx(onset, abs=1e-6)


def test_block_on_belt_is_r3():
    # one period of the limit cycle from the instant it begins to slip, x = F_s/k and x' = V
    motion = simulate(MassOnBelt(), 2.0 * 12.001031295, start=([1.0], [0.2]), rtol=1e-10, times=24001)
    assert motion.q.max() == pytest.approx(1.133944676, abs=1e-6)
    late = motion.t >= 12.0
    again = np.interp(12.001031295, motion.t, motion.q[:, 0])
    assert again == pytest.approx(1.0, abs=1e-5)
    assert np.interp(11.5, motion.t, motion.q[:, 0]) != pytest.approx(1.0, abs=1e-3)
    assert motion.q[late].max() == pytest.approx(1.133944676, abs=1e-6)


def test_coulomb_block_is_r4():
    block = MassOnBelt(sliding_speed=0.1, friction=Coulomb(0.4, 0.25))
    motion = simulate(block, 14.8, start=([0.4], [0.1]), rtol=1e-10, times=14801)
    assert 0.5 * np.ptp(motion.q) == pytest.approx(0.180277564, abs=1e-6)
    assert np.interp(7.317597861, motion.t, motion.q[:, 0]) == pytest.approx(0.4, abs=1e-6)


def test_cubic_law_loses_stability_where_the_slope_says():
    block = MassOnBelt(c=0.05, friction=Cubic(0.4, 0.25, 0.5))
    expected = 0.5 * np.sqrt(1.0 - 2.0 * 0.05 * 0.5 / (3.0 * 0.15))
    assert critical_value(block, "sliding_speed", (0.2, 0.6)).value == pytest.approx(expected, rel=1e-9)


@pytest.mark.parametrize("blocks", [1, 2, 7])
def test_chain_has_the_frequencies_of_a_free_chain(blocks):
    chain = BlockChain(blocks=blocks, c=0.0, friction=Coulomb(0.3))
    found = np.sort(complex_modes(chain).eigenvalues.imag)[-blocks:]
    expected = np.sqrt(1.0 + 4.8 * np.sin(np.pi * np.arange(blocks) / (2.0 * blocks)) ** 2)
    assert np.max(np.abs(found - expected)) < ROUND_OFF


def test_equal_pad_and_disc_lose_half_the_damping():
    brake = PadOnDisc(k2=1e6, friction=LinearSlope(0.6, 0.0))
    assert critical_value(brake, "friction.slope", (-0.02, 0.0)).value == pytest.approx(-0.005, rel=1e-7)


@pytest.mark.parametrize("angle", [20.0, 45.0, 70.0])
def test_sprag_digs_in_at_the_cotangent(angle):
    brake = SpragSlip(angle=np.deg2rad(angle), friction=Coulomb(0.3))
    expected = 100.0 / (1.0 - 0.3 * np.tan(np.deg2rad(angle)))
    assert equilibrium(brake.system()).normal_force[0] == pytest.approx(expected, rel=1e-9)
    limit = 1.0 / np.tan(np.deg2rad(angle))
    signs = []
    for factor in (1.0 - 1e-6, 1.0 + 1e-6):
        near = brake.replace({"friction.static": factor * limit}).system()
        signs.append(np.sign(np.linalg.det(linearise(near).K)))
    assert signs == [1.0, -1.0]


def test_wobbling_disc_feeds_energy_by_circulation():
    # the two rows of the docstring, written out with the friction law's slope zero
    disc = WobblingDisc()
    mu, speed = 0.6, disc.r * disc.spin
    found = linearise(disc.system())
    assert found.K[1, 0] == pytest.approx(mu * disc.h * disc.k * disc.r, rel=1e-12)
    assert found.K[0, 1] == pytest.approx(-mu * disc.load * disc.h**2 / (2.0 * disc.r), rel=1e-12)
    assert found.K[1, 1] == pytest.approx(disc.kt + (1.0 + mu**2) * disc.load * disc.h, rel=1e-12)
    assert found.C[0, 0] - disc.dt - 2 * disc.d * disc.r**2 == pytest.approx(
        mu * disc.load * disc.h**2 / (2 * speed), rel=1e-9
    )


@pytest.mark.parametrize("points", [1, 3, 8])
def test_shoes_carry_the_same_without_friction(points):
    brake = DrumBrakeShoes(points=points, friction=Coulomb(0.0))
    normal = equilibrium(brake.system()).normal_force
    assert np.allclose(normal[:points], normal[points:][::-1], rtol=1e-9)


@pytest.mark.parametrize("pressure", ["wear", "spring"])
def test_shoes_are_in_moment_balance(pressure):
    # about its abutment, whatever it carries, a shoe balances the actuator with the forces of its lining
    brake = DrumBrakeShoes(points=5, pressure=pressure)
    normal = equilibrium(brake.system()).normal_force
    for shoe, side in ((0, 1.0), (1, -1.0)):
        foot = brake.abutment_point(shoe)
        total = -2.0 * side * brake.arm * brake.load
        for angle, force in zip(brake.lining_angles(shoe), normal[5 * shoe : 5 * shoe + 5], strict=True):
            radial, along = np.array([np.cos(angle), np.sin(angle)]), np.array([-np.sin(angle), np.cos(angle)])
            arm, push = brake.radius * radial - foot, -force * radial + 0.35 * force * along
            total += arm[0] * push[1] - arm[1] * push[0]
        assert abs(total) < 1e-9 * brake.arm * brake.load
    assert normal[5:].sum() > normal[:5].sum()  # the leading shoe


def test_worn_lining_has_a_sinusoidal_pressure():
    brake = DrumBrakeShoes(points=5, pressure="wear")
    normal = equilibrium(brake.system()).normal_force[:5]
    foot = brake.abutment_point(0)
    shape = np.sin(brake.lining_angles(0) - np.arctan2(foot[1], foot[0]))
    assert np.ptp(normal / shape) < 1e-9 * np.max(normal)


def test_mechanism_assembles_the_inclined_springs():
    brake = InclinedSprings(c1=0.02, c2=0.03)
    springs = (
        Spring("mass", angle=brake.angle1, stiffness=brake.k1, damping=0.02),
        Spring("mass", angle=brake.angle2, stiffness=brake.k2, damping=0.03),
    )
    parts = OwnMechanism(
        bodies=(Body("mass", 1.0),),
        springs=springs,
        contacts=(Touch("mass", stiffness=1.0),),
        friction=brake.friction,
        normal_force=1.0,
    )
    for found, expected in zip((parts.system(), parts.system()), (brake.system(), brake.system()), strict=True):
        for name in ("M", "C", "K"):
            assert np.max(np.abs(getattr(found, name) - getattr(expected, name))) < 1e-12
    for name in ("K", "C"):
        left, right = linearise(parts.system()), linearise(brake.system())
        assert np.max(np.abs(getattr(left, name) - getattr(right, name))) < 1e-12
    turned = parts.replace(contacts=(Touch("mass", stiffness=1.0, angle=-np.pi / 2),))
    assert np.max(np.abs(linearise(turned.system()).K - linearise(brake.system()).K)) < 1e-12  # both directions turn


def test_a_body_that_turns_feels_the_arm():
    # one spring at x = a from the centre: coupling k a between lift and turn, k a^2 on the turn
    body = OwnMechanism(
        bodies=(Body("pad", 2.0, 0.5),), springs=(Spring("pad", angle=np.pi / 2, stiffness=3.0, x=0.2, y=0.0),)
    )
    expected = [[0.0, 0.0, 0.0], [0.0, 3.0, 0.6], [0.0, 0.6, 0.12]]
    assert np.max(np.abs(body.system().K - expected)) < 1e-12
    assert body.system().names == ("pad_x", "pad_y", "pad_turn")
