"""Two roads, one answer: what becomes of a linear motion, by its eigenvalues and by looking at it."""

from types import SimpleNamespace

import numpy as np
import pytest
from scipy.linalg import expm

from squealbox.designs import DrumBrake
from squealbox.friction import LinearSlope
from squealbox.signals import growth_rate, peaks, spectrum
from squealbox.stability import complex_modes
from squealbox.system import linearise
from squealbox.transient import simulate
from squealbox.transient.verdicts import verdict

T = np.linspace(0.0, 0.05, 5001)
READINGS = ("eq3", "eq3_signed", "componentwise", "consistent")


def linear_motion(brake, start=None):
    """The drum's linearised motion by the matrix exponential, from `start` (q, qd) or from rest under sudden load."""
    system = brake.system()
    matrices = linearise(system)
    steady = matrices.equilibrium.q
    stiffness, damping = (np.linalg.solve(matrices.M, a) for a in (matrices.K, matrices.C))
    step = expm(np.block([[np.zeros((2, 2)), np.eye(2)], [-stiffness, -damping]]) * T[1])
    states = np.empty((T.size, 4))
    state = np.concatenate([-steady, np.zeros(2)]) if start is None else np.concatenate([start[0] - steady, start[1]])
    for i in range(T.size):
        states[i], state = state, step @ state
    return SimpleNamespace(t=T, q=states[:, :2] + steady, qd=states[:, 2:], system=system)


def brake(friction, reading, slope=-0.05):
    return DrumBrake(friction=LinearSlope(friction, slope), reading=reading)


@pytest.mark.parametrize("reading", READINGS)
def test_verdict_has_the_sign_of_the_largest_growth_rate(reading):
    for friction in np.linspace(0.1, 0.55, 10):
        modes = complex_modes(brake(friction, reading))
        motion = linear_motion(brake(friction, reading))
        for dof in ("x", "y"):
            found = verdict(motion, dof=dof)
            assert found.kind == ("grows" if modes.largest_growth_rate > 0.0 else "decays"), found


@pytest.mark.parametrize("friction", [0.36, 0.38, 0.39, 0.40, 0.43, 0.44])
def test_beating_before_coalescence_is_no_growth(friction):
    # eq3 coalesces at 0.4516 with this slope: from 0.36 on, the beat grows slower than the run is long.
    motion = linear_motion(brake(friction, "eq3"))
    found = verdict(motion)
    assert found.kind == "decays"
    assert (
        abs(found.growth_rate - complex_modes(brake(friction, "eq3")).largest_growth_rate)
        < 3.0 * found.growth_rate_error
    )


def test_just_beyond_onset_grows_and_just_below_decays():
    # 0.1 % either side of the onset at 0.4516, where the growth rate passes zero at 6e4 1/s for each unit of friction.
    for friction, kind in ((0.4511, "decays"), (0.4521, "grows")):
        assert verdict(linear_motion(brake(friction, "eq3"))).kind == kind


@pytest.mark.parametrize(("friction", "reading"), [(0.3, "eq3"), (0.5, "eq3"), (0.4, "consistent")])
def test_one_mode_has_its_eigenvalue(friction, reading):
    mode = complex_modes(brake(friction, reading)).most_unstable
    motion = linear_motion(brake(friction, reading), mode.start(1e-9))
    found = growth_rate(motion, dof="y")
    assert found.rate == pytest.approx(mode.growth_rate, rel=1e-4)
    assert found.frequency == pytest.approx(mode.frequency, rel=1e-6)
    plain = spectrum(motion, dof="y")  # the twin: its grid is 5 Hz wide
    assert plain.frequency[np.argmax(plain.amplitude)] != pytest.approx(mode.frequency, rel=1e-6)


def test_lines_of_the_spectrum_are_the_frequencies_of_the_modes():
    motion, modes = linear_motion(brake(0.1, "eq3")), complex_modes(brake(0.1, "eq3"))
    # Both decay at about 115 1/s: the line is a Lorentzian 37 Hz wide, its top known to a tenth of that.
    assert np.sort(peaks(spectrum(motion), 2).frequency) == pytest.approx(modes.frequency[:2], abs=4.0)


@pytest.mark.parametrize(("friction", "kind"), [(0.30, "decays"), (0.40, "settles_on_cycle")])
def test_verdict_of_a_transient(friction, kind):
    """The consistent reading is stable below 0.3327; beyond, stick and slip bound the motion to a cycle."""
    run = simulate(brake(friction, "consistent"), 0.05, times=T)
    found = verdict(run, dof="y")
    assert found.kind == kind
    last = run.q[T > 0.0375, 1]
    if kind == "settles_on_cycle":
        # Half peak to peak, on samples 50 a period: the highest is 0.2 % low at worst.
        assert found.amplitude == pytest.approx(0.5 * np.ptp(last), rel=2e-3)
        assert verdict(simulate(brake(friction, "consistent"), 0.05), dof="y").amplitude == pytest.approx(
            found.amplitude, rel=5e-3
        )  # at the integrator's own, unequal steps, about 20 a period
    else:
        # The other mode, which dies sooner, is not quite gone in the last half.
        assert found.growth_rate == pytest.approx(
            complex_modes(brake(friction, "consistent")).largest_growth_rate, rel=0.02
        )
