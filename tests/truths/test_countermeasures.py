"""Closed forms of countermeasures: absorbers on negative damping and on flutter, added parts, shims, dither."""

import numpy as np
import pytest
from scipy.optimize import brentq
from scipy.special import i0

from squealbox import (
    AddedDamping,
    AddedMass,
    AddedStiffness,
    Asymmetry,
    Coulomb,
    Cubic,
    Dithered,
    DrumBrake,
    Hyperbolic,
    LayerDamping,
    LinearSlope,
    MassOnBelt,
    ModeCoupling,
    NormalDither,
    Shim,
    Stribeck,
    TunedMass,
    best_absorber,
    complex_modes,
    critical_value,
)
from squealbox.countermeasures import ross_kerwin_ungar
from squealbox.friction import Table, averaged

FRICTION = "friction.static"
ROOT2 = np.sqrt(2.0) / (2.0 * np.pi)


def damped_by(c):
    """A block with m = k = 1 whose damping is c: a law of slope c at N = 1."""
    return MassOnBelt(sliding_speed=1.0, friction=LinearSlope(0.4, c))


def absorbed(c, e, g, d):
    """The block with the absorber of mass ratio e, frequency ratio g and damping d = 2 zeta g."""
    return TunedMass(damped_by(c), "x", e, g / (2.0 * np.pi), d / (2.0 * g))


def growth(brake):
    return float(complex_modes(brake).largest_growth_rate)


@pytest.mark.parametrize("e", [0.01, 0.05, 0.17])
def test_the_tuning_of_equal_ratios_holds_negative_damping_up_to_the_root_of_the_mass_ratio(e):
    g = 1.0 / np.sqrt(1.0 + e)
    d = 2.0 * g * 0.5 * np.sqrt(e / (1.0 + e))

    def rate(c):
        return growth(absorbed(-c, e, g, d))

    # at sqrt(e) itself pairs meet on the axis: the rate rises as a root beyond it
    assert rate(np.sqrt(e) * (1.0 - 1e-6)) < 0.0 < rate(np.sqrt(e) * (1.0 + 1e-6))


@pytest.mark.parametrize("e", [0.05, 0.1])
def test_no_tuning_holds_more_than_the_double_hopf_point(e):
    most = np.sqrt(2.0 * (1.0 + e - np.sqrt(1.0 + e)))
    assert float(best_absorber(damped_by(-0.999 * most), "x", e).value) < 0.0
    assert float(best_absorber(damped_by(-1.001 * most), "x", e).value) > 0.0


@pytest.mark.parametrize(("c", "rate"), [(0.0, -0.109108945), (-0.1, -0.061099835), (-0.2, -0.012305924)])
def test_best_absorber_meets_the_repeated_pairs(c, rate):
    found = best_absorber(damped_by(c), "x", 0.05)
    assert float(found.value) == pytest.approx(rate, abs=2e-9)  # the digits of the closed form's table
    if c < 0.0:
        g = 2.0 * np.pi * float(found.frequency)
        spread = 1.05
        big = g * (1.0 - g) / (spread * g - 1.0)
        a = (spread * big - 1.0) / 2.0
        assert (1.0 - 2.0 * g + spread * g * g) / (a * a + big) == pytest.approx(c * c, rel=1e-5)


def test_the_detuning_band_is_between_the_roots_of_the_quartic():
    g0, e = 1.0 / np.sqrt(1.05), 0.05
    d = 2.0 * g0 * 0.5 * np.sqrt(e / 1.05)
    edges = [brentq(lambda g: growth(absorbed(-0.1, e, g, d)), *ends, xtol=1e-14) for ends in ((0.8, g0), (g0, 1.2))]
    assert edges == pytest.approx([0.895467792, 1.031079260], abs=2e-9)


@pytest.mark.parametrize("on", ["x", "y"])
@pytest.mark.parametrize("e", [0.01, 0.05, 0.1, 0.23])
def test_flutter_with_an_undamped_absorber(on, e):
    brake = TunedMass(ModeCoupling(), on, e, ROOT2)
    assert critical_value(brake, FRICTION, (0.5, 3.0)).value == pytest.approx((2.0 + e) ** 2 - 3.0, rel=1e-9)


@pytest.mark.parametrize("mass", [0.05, 0.1, 0.5])
def test_flutter_with_added_mass(mass):
    found = critical_value(AddedMass(ModeCoupling(), "y", mass), FRICTION, (0.5, 3.0)).value
    assert found == pytest.approx(1.0 + mass**2 / (1.0 + mass), rel=1e-9)


@pytest.mark.parametrize("spring", [0.2, -0.3])
def test_flutter_with_an_added_spring(spring):
    found = critical_value(AddedStiffness(ModeCoupling(), "y", spring), FRICTION, (0.5, 3.0)).value
    assert found == pytest.approx(1.0 + spring**2 / 4.0, rel=1e-9)


def test_asymmetry_breaks_a_doublet():
    brake = ModeCoupling(k12=0.1, k3=0.2, friction=Coulomb(1.0))  # K = [[2, -s], [s, 2]] with s = 0.1
    for split, stable in ((0.099, False), (0.101, True)):
        assert bool(complex_modes(Asymmetry(brake, "x", "y", split)).stable) == stable
    assert growth(Asymmetry(brake, "x", "y", 0.099)) == pytest.approx(0.00705 / np.sqrt(2.0), abs=3e-5)


def test_damping_on_one_degree_of_freedom_leaves_the_undamped_onset():
    brake = ModeCoupling(c1=0.02, c2=0.02)
    both = AddedDamping(AddedDamping(brake, "x", 0.1), "y", 0.1)
    assert critical_value(both, FRICTION, (0.5, 3.0)).value == pytest.approx(1.0 + 0.12 * 0.12 * 2.0, rel=1e-9)


@pytest.mark.parametrize(("loss", "frequency"), [(0.3, 2000.0), (1.2, 900.0)])
def test_a_zener_shim_has_its_stiffness_and_loss_at_its_frequency(loss, frequency):
    brake, ks = DrumBrake(), 3e8
    system = Shim(brake, "shoe 1", ks, loss, frequency).system()
    s = 2j * np.pi * frequency
    dynamic = s * s * system.M + s * system.C + system.K
    seen = dynamic[:2, :2] - dynamic[:2, 2:] @ np.linalg.solve(dynamic[2:, 2:], dynamic[2:, :2])
    plain = brake.system()
    unit = plain.contacts[0].normal
    left = s * s * plain.M + s * plain.C + plain.K - brake.k3 * np.outer(unit, unit)
    series = 1.0 / (1.0 / brake.k3 + 1.0 / (ks * (1.0 + 1j * loss)))
    assert np.allclose(seen, left + series * np.outer(unit, unit), rtol=1e-10)


def test_shims_agree_at_their_frequency_and_without_loss():
    brake = DrumBrake()
    stiff = Shim(brake, "shoe 1", 1e15)
    assert np.allclose(complex_modes(stiff).eigenvalues, complex_modes(brake).eigenvalues, rtol=1e-5)
    soft = [Shim(brake, "shoe 1", 1e9, 1e-9, 2e3, loss=loss) for loss in ("zener", "kelvin_voigt")]
    lossless = complex_modes(Shim(brake, "shoe 1", 1e9)).eigenvalues
    for each in soft:
        found = complex_modes(each).eigenvalues
        near = [found[np.nanargmin(np.abs(found - value))] for value in lossless]
        assert np.allclose(near, lossless, rtol=1e-6)


def test_a_turned_shim_is_a_turned_shoe():
    brake, turn = DrumBrake(friction=Coulomb(0.3)), 0.07
    shim = complex_modes(Shim(brake, "shoe 1", 1e16, turn=turn)).eigenvalues
    assert np.allclose(shim, complex_modes(brake.replace(theta1=brake.theta1 + turn)).eigenvalues, rtol=1e-6)


def test_ross_kerwin_ungar_has_its_maximum_where_it_says():
    for eta, y in ((1.0, 1.0), (0.6, 3.0)):
        best = 1.0 / np.sqrt((1.0 + y) * (1.0 + eta**2))
        most = ross_kerwin_ungar(eta, y)
        assert most == pytest.approx(eta * y / (2.0 + y + 2.0 / best), rel=1e-12)
        assert all(ross_kerwin_ungar(eta, y, best * f) < most for f in (0.9, 1.1))
    layer = LayerDamping(MassOnBelt(k=4.0), "x", 1.0, 1.0, frequency=1.0)
    assert layer.system().C[0, 0] == pytest.approx(4.0 / 7.0 / (2.0 * np.pi), rel=1e-12)


# dither

MEANS = [
    (Coulomb(0.4), 0.5, 1.0, 0.133333333),
    (Coulomb(0.4), 0.1, 1.0, 0.025507424),
    (Coulomb(0.4), 0.9, 1.0, 0.285146965),
    (LinearSlope(0.45, -0.05), 0.5, 1.0, 0.125),
    (Stribeck(0.4, 0.25, 0.3), 0.5, 0.4, 0.292393170),
]


@pytest.mark.parametrize(("law", "v", "w", "mean"), MEANS)
def test_averaged_laws_by_their_closed_forms(law, v, w, mean):
    assert float(averaged(law, w).mu(v)) == pytest.approx(mean, abs=6e-10)


LAWS = [
    Coulomb(0.5, 0.3),
    LinearSlope(0.4, -0.5, 0.2),
    Stribeck(0.4, 0.25, 0.01),
    Hyperbolic(0.4, 2.0),
    Cubic(0.4, 0.25, 0.7),
]


@pytest.mark.parametrize("law", [*LAWS, Table([0.1, 0.4, 1.0], [0.42, 0.25, 0.3])], ids=lambda law: type(law).__name__)
@pytest.mark.parametrize(("v", "w"), [(0.5, 0.33), (0.2, 0.9), (0.0, 0.4)])
def test_an_averaged_law_is_the_mean_over_a_period(law, v, w):
    phase = 2.0 * np.pi * (np.arange(400_000) + 0.5) / 400_000
    u = v + w * np.sin(phase)
    mean = np.mean(law.mu(u) * np.sign(u))
    found = averaged(law, w)
    assert float(found.mu(v)) == pytest.approx(mean, abs=2e-6)  # the plain mean's own error at the jump
    step = 1e-6
    slope = (found.mu(v + 2.0 * step) - found.mu(v + step)) / step
    assert float(found.slope_at(v + 1.5 * step)) == pytest.approx(float(slope), abs=1e-4)


@pytest.mark.parametrize(("w", "speed"), [(0.1, 0.283163387), (0.2, 0.307337883), (0.3, 0.345661527)])
def test_dither_below_the_sliding_speed_destabilises(w, speed):
    # v_H + v0 ln I0(w/v0), with v_H of the undithered brake
    onset, v0 = 0.274887220, 0.3
    assert speed == pytest.approx(onset + v0 * np.log(i0(w / v0)), abs=2e-9)
    c = 0.15 / v0 * np.exp(-onset / v0)
    brake = Dithered(MassOnBelt(c=c, friction=Stribeck(0.4, 0.25, v0)), w)
    found = critical_value(brake, "sliding_speed", (w + 0.02, 1.0)).value
    assert found == pytest.approx(speed, abs=2e-9)


@pytest.mark.parametrize("ratio", [1.1, 1.2, 1.5, 2.0])
def test_dither_quenches_flutter_for_its_share_of_the_torque(ratio):
    brake = ModeCoupling(friction=Coulomb(ratio))  # mu_c = 1
    dithered = Dithered(brake, velocity=1.0 / np.sin(np.pi / (2.0 * ratio)))
    assert float(dithered.friction_left[0]) == pytest.approx(1.0 / ratio, rel=1e-9)


def test_flutter_with_the_averaged_damping():
    brake = Dithered(ModeCoupling(c1=0.02, c2=0.02, friction=Coulomb(1.5)), velocity=1.2)
    edges = [critical_value(brake, "velocity", ends).value for ends in ((1.0003, 1.01), (1.05, 1.3))]
    assert edges == pytest.approx([1.001686177, 1.118008189], abs=1e-9)


def test_a_falling_law_is_quenched_up_to_its_largest_dither():
    most = np.sqrt(0.2**2 + (2.0 * 0.45 / (np.pi * (0.3 - 0.1))) ** 2)
    brake = Dithered(MassOnBelt(c=0.1, sliding_speed=0.2, friction=LinearSlope(0.45, -0.3)), 1.0)
    assert critical_value(brake, "velocity", (0.3, 2.0)).value == pytest.approx(most, rel=1e-9)


@pytest.mark.parametrize(("ratio", "mean"), [(0.7, 1.0), (1.5, 1.088160799), (2.0, 1.217995562), (3.0, 1.508489764)])
def test_normal_dither_that_lifts_off(ratio, mean):
    assert float(NormalDither(ModeCoupling(), ratio).mean_normal_force) == pytest.approx(mean, abs=6e-10)


def test_dither_says_where_it_makes_it_worse():
    falling = Dithered(MassOnBelt(sliding_speed=0.5, friction=Stribeck(0.4, 0.25, 0.3)), 0.2, 0.165)
    assert "destabilises" in falling.cautions()[0]
    assert "within 20 %" in falling.cautions()[1]
    straight = Dithered(MassOnBelt(sliding_speed=0.5, friction=LinearSlope(0.4, -0.1)), 0.2, 40e3)
    assert "nothing reverses" in straight.cautions()[0]  # its mean falls as fast as it does
    assert "pulled" in " ".join(Dithered(DrumBrake(friction=LinearSlope(0.36, -0.05)), 0.3).cautions())


@pytest.mark.parametrize("law", [
    lambda x: Hyperbolic(x, 0.7), lambda x: Stribeck(x, 0.2, 0.3), lambda x: LinearSlope(x, -0.1, 0.1),
    lambda x: LinearSlope(0.5, -0.1, x), lambda x: Hyperbolic(0.4, x),
])  # fmt: skip
@pytest.mark.parametrize("w", [0.2, 0.9])
def test_an_averaged_law_takes_arrays(law, w):
    given = np.array([0.3, 0.35, 0.4])
    found = averaged(law(given), w)
    alone = [averaged(law(float(x)), w) for x in given]
    assert found.mu(0.5) == pytest.approx([float(each.mu(0.5)) for each in alone], rel=1e-12)
    assert found.slope_at(0.5) == pytest.approx([float(each.slope_at(0.5)) for each in alone], rel=1e-12)
    assert np.shape(found.static_limit) == (3,)


@pytest.mark.parametrize(("loss", "parameter"), [(1.0, 1.0), (0.4, 0.3)])
def test_a_layer_has_its_loss_as_a_state(loss, parameter):
    """The stiffness felt at its frequency is k (1 + i eta), and the loss is largest there."""
    brake, hertz = ModeCoupling(k12=0.0, k3=0.0), 0.3
    layer = LayerDamping(brake, "y", loss, parameter, frequency=hertz, model="zener")
    system, eta = layer.system(), ross_kerwin_ungar(loss, parameter)

    def felt(f):
        w = 2.0 * np.pi * f
        dynamic = system.K + 1j * w * system.C
        return dynamic[1, 1] - dynamic[1, 2] * dynamic[2, 1] / dynamic[2, 2]

    assert felt(hertz) == pytest.approx(2.0 * (1.0 + 1j * eta), rel=1e-12)
    assert all(felt(f).imag / felt(f).real < eta for f in (0.8 * hertz, 1.25 * hertz))
    viscous = LayerDamping(brake, "y", loss, parameter, frequency=hertz).system()
    assert viscous.names == ("x", "y")
    assert viscous.C[1, 1] == pytest.approx(2.0 * eta / (2.0 * np.pi * hertz), rel=1e-12)
