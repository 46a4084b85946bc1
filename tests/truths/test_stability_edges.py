"""Where an analysis of stability meets the edge of what it is defined for: a right answer or a named error."""

import numpy as np
import pytest

from squealbox.designs import DrumBrake
from squealbox.friction import LinearSlope
from squealbox.stability import complex_modes, mode_energy, pseudospectrum, sensitivity, transient_growth
from squealbox.system import Contact, InvalidSystem, System, linearise

ROUND_OFF = 1e-14


def test_undamped_divergence_has_no_net_energy() -> None:
    """q'' = q grows as exp(t); kinetic 1/2 q'^2 and strain -1/2 q^2 cancel, and nothing feeds it."""
    energy = mode_energy(System(M=np.eye(2), C=np.zeros((2, 2)), K=np.diag([-1.0, 2.0])))
    assert energy.balanced
    assert np.isnan(energy.growth_rate)
    assert energy.residual < ROUND_OFF
    assert "cancel" in energy.summary()
    damped = mode_energy(System(M=[[1.0]], C=[[0.5]], K=[[-1.0]]))
    assert not damped.balanced
    assert damped.growth_rate == pytest.approx(np.sqrt(1.0 + 0.25**2) - 0.25, rel=1e-14)


def test_dampers_are_told_apart() -> None:
    """A chain wall - c1 - mass - c2 - mass: C = [[c1 + c2, -c2], [-c2, c2]] is these two dampers and no other."""
    c1, c2 = 0.3, 0.7
    energy = mode_energy(System(M=np.eye(2), C=[[c1 + c2, -c2], [-c2, c2]], K=[[3.0, -1.0], [-1.0, 2.0]]))
    assert energy.damper_names == ("damping of q1", "damping between q1 and q2")
    mode = complex_modes(energy.inputs["system"]).most_unstable
    speed = mode.eigenvalue * mode.shape
    expected = [0.5 * c1 * abs(speed[0]) ** 2, 0.5 * c2 * abs(speed[0] - speed[1]) ** 2]
    assert energy.dampers == pytest.approx(expected, rel=1e-13)
    assert np.sum(energy.dampers) == pytest.approx(float(np.sum(energy.dissipated)), rel=1e-13)
    gyroscopic = mode_energy(System(M=np.eye(2), C=[[0.1, 5.0], [-5.0, 0.1]], K=np.diag([1.0, 2.0])))
    assert gyroscopic.damper_names == ("damping of q1", "damping of q2")  # the skew part does no work


def test_shares_of_energy_add_up_to_the_growth_rate() -> None:
    for mu in (0.2, 0.45):
        energy = mode_energy(DrumBrake(friction=LinearSlope(mu, -0.05)))
        assert sum(value for _, value in energy.shares) == pytest.approx(float(energy.eigenvalue.real), rel=1e-9)


def symmetric_drum(k2: float) -> DrumBrake:
    """Shoes at right angles on equal springs without friction: both modes have one eigenvalue when k2 = 19e6."""
    return DrumBrake(
        friction=LinearSlope(0.0, 0.0), k1=19e6, k2=k2, k3=1e8, k4=1e8,
        theta1=np.pi / 4.0, theta2=3.0 * np.pi / 4.0, c1=100.0, c2=100.0,
    )  # fmt: skip


def test_a_repeated_eigenvalue_has_no_derivative() -> None:
    found = sensitivity(symmetric_drum(19e6))
    assert found.repeated
    assert not found.near_defective
    assert np.all(np.isnan(found.first))
    assert "share" in found.summary()
    apart = sensitivity(symmetric_drum(18e6), ["m"], 0)
    assert not apart.repeated
    # lambda = -c/2m + i sqrt(k/m - (c/2m)^2): with k = 118 MN/m, c = 100, m = 1
    omega = np.sqrt(118e6 - 2500.0)
    assert complex(apart.first[0]) == pytest.approx(50.0 + 1j * (-118e6 + 2.0 * 2500.0) / (2.0 * omega), rel=1e-8)


def test_an_energy_needs_a_positive_definite_mass() -> None:
    system = System(M=np.diag([1.0, 0.0]), C=0.1 * np.eye(2), K=[[2.0, 1.0], [1.0, 2.0]])
    with pytest.raises(ValueError, match="positive definite mass"):
        transient_growth(system)
    with pytest.raises(ValueError, match="positive definite mass"):
        pseudospectrum(system, [0.0], [1.0])


@pytest.mark.parametrize("size", [1e-300, 1e-160, 1.0, 1e160, 1e300])
def test_scale_of_the_numbers_does_not_matter(size: float) -> None:
    system = System(M=np.eye(2), C=np.zeros((2, 2)), K=size * np.array([[2.0, 1.0], [1.0, 2.0]]))
    modes = complex_modes(system)
    assert modes.outcome.ok
    assert modes.angular_frequency[:2] == pytest.approx(np.sqrt(size) * np.array([1.0, np.sqrt(3.0)]), rel=1e-14)
    free = complex_modes(system.replace(K=size * np.ones((2, 2))))
    assert free.outcome.ok
    assert free.floating == 1
    assert np.count_nonzero(free.eigenvalues == 0.0) == 2
    assert complex_modes(system.replace(K=size * np.ones((2, 2)), load=[size, 0.0])).outcome == "singular"


@pytest.mark.parametrize("wrong", [np.array([[2.0, 1.0j], [1.0, 2.0]]), [["2", "1"], ["1", "2"]]])
def test_what_is_not_real_is_refused(wrong: object) -> None:
    with pytest.raises(InvalidSystem, match="K: expected an array of real numbers"):
        System(M=np.eye(2), C=np.zeros((2, 2)), K=wrong)


def test_modes_warn_of_a_contact_that_would_have_to_pull() -> None:
    """One block on a spring k, pressed by N0: N = N0 + n q with q = mu N / k, so N = N0 / (1 - mu n / k)."""

    def block(preload: float) -> System:
        pad = Contact(n=[50.0], d=[1.0], t=[1.0], N0=preload, V=1.0, law=LinearSlope(0.4, 0.0), name="pad")
        return System(M=[[1.0]], C=[[0.1]], K=[[100.0]], contacts=(pad,))

    pressed, pulled = complex_modes(block(10.0)), complex_modes(block(-10.0))
    assert pressed.normal_force == pytest.approx([12.5], rel=1e-14)
    assert pressed.contacts == ("pad",)
    assert "Caution" not in pressed.summary()
    assert "pad (-12.5 N)" in pulled.summary()
    assert "pad (-12.5 N)" in pulled._repr_html_()
    assert linearise(block(10.0)).equilibrium.normal_force == pytest.approx(pressed.normal_force)
