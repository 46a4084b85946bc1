"""The readings inferred from the paper's numbers: the digits they were found with, and the sign they rest on."""

import numpy as np
import pytest

from squealbox.designs import DrumBrake
from squealbox.designs.drum_brake_readings import READINGS
from squealbox.friction import LinearSlope
from squealbox.stability import complex_modes, critical_value
from squealbox.system import as_system, equilibrium, linearise
from squealbox.transient import simulate

# The digits the search of November 2026 found them with; the tolerance is half a unit of the last one.
ONSET = {"reconstructed": 0.3967, "reconstructed_simple": 0.3993}
GAP = {"reconstructed": 523.0, "reconstructed_simple": 627.0}
AT_LOW_FRICTION = {"reconstructed": (11130.0, 14590.0), "reconstructed_simple": (11130.0, 14600.0)}
LOAD_ONSET = {"reconstructed": 14.61e3, "reconstructed_simple": 14.57e3}
AT_15_KN = {"reconstructed": (11910.0, 13970.0), "reconstructed_simple": (11890.0, 13980.0)}
NAMES = tuple(ONSET)


@pytest.mark.parametrize("name", NAMES)
def test_onset_in_friction_by_flutter(name: str) -> None:
    found = critical_value(DrumBrake(reading=name), "friction.static", (0.01, 1.0))
    assert float(found.value) == pytest.approx(ONSET[name], abs=5e-5)
    assert found.mechanism == "flutter"


@pytest.mark.parametrize("name", NAMES)
def test_frequencies_over_friction(name: str) -> None:
    modes = complex_modes(DrumBrake(reading=name).replace({"friction.static": np.array([0.10, 0.39])}))
    both = modes.angular_frequency[..., :2]
    assert both[0] == pytest.approx(AT_LOW_FRICTION[name], abs=5.0)
    assert float(np.diff(both[1])[0]) == pytest.approx(GAP[name], abs=0.5)


@pytest.mark.parametrize("name", NAMES)
def test_onset_in_load_by_the_slope(name: str) -> None:
    found = critical_value(DrumBrake(reading=name), "load", (100.0, 60e3))
    assert float(found.value) == pytest.approx(LOAD_ONSET[name], abs=5.0)
    assert found.mechanism == "negative_slope"
    at = complex_modes(DrumBrake(reading=name, load1=15e3, load2=15e3))
    assert at.angular_frequency[:2] == pytest.approx(AT_15_KN[name], abs=5.1)  # 13970 stands for 13971, 13980 for 13984
    assert at.growth_rate[0] > 0.0 > at.growth_rate[1]


@pytest.mark.parametrize(("scheme", "sizes"), [("raw", (0.108, 0.204)), ("exact", (0.110, 0.205))])
def test_amplitudes_at_two_frictions_peak_to_peak(scheme: str, sizes: tuple[float, float]) -> None:
    """Of x [mm] over the last quarter of 0.05 s, from rest, as the paper ran it and exactly; published 0.11, 0.20."""
    how = {"method": "bogacki-shampine", "rtol": 1e-3} if scheme == "raw" else {}
    for mu, size in zip((0.40, 0.50), sizes, strict=True):
        run = simulate(DrumBrake(reading="reconstructed").replace({"friction.static": mu}), 0.05, contact=scheme, **how)
        assert run.outcome.ok
        late = run.t > 0.75 * run.t[-1]
        assert 1e3 * np.ptp(run.q[late, 0]) == pytest.approx(
            size, abs=1e-3
        )  # the quarter looked at moves the last digit


def test_the_printed_sign_gives_none_of_it() -> None:
    """Negative twin: with the paper's -, + along y the same slope and speed miss the frequencies at mu = 0.1."""
    own = READINGS["reconstructed_simple"]
    brake = DrumBrake(reading="eq3_signed", friction=LinearSlope(0.3, own.slope), sliding_speed=own.sliding_speed)
    printed = complex_modes(brake.replace({"friction.static": 0.1})).angular_frequency[:2]
    assert abs(printed[0] - 11240.0) > 126.0  # the paper's lower frequency, and what its window resolves


def test_their_own_slope_and_speed_stand_where_nothing_is_given() -> None:
    brake = DrumBrake(reading="reconstructed")
    assert (brake.friction, brake.sliding_speed) == (LinearSlope(0.3, -0.0653), 1.48)
    brake = DrumBrake(reading="reconstructed_simple")
    assert (brake.friction, brake.sliding_speed) == (LinearSlope(0.3, -0.1), 1.0)
    assert DrumBrake() == DrumBrake(friction=LinearSlope(0.3, -0.05), sliding_speed=0.2, reading="consistent")


def test_what_is_given_is_kept() -> None:
    table = DrumBrake(reading="reconstructed", friction=LinearSlope(0.3, -0.05), sliding_speed=0.2)
    assert (table.friction.slope, table.sliding_speed) == (-0.05, 0.2)
    assert DrumBrake().replace(reading="reconstructed").sliding_speed == 0.2
    assert DrumBrake(reading="reconstructed").replace(reading="consistent").sliding_speed == 1.48


@pytest.mark.parametrize("name", READINGS)
def test_friction_drags_the_drum_along_its_belt(name: str) -> None:
    """d = t in every row, so friction takes mu N |v| out of the sliding of drum and belt wherever N >= 0."""
    for contact in DrumBrake(reading=name).system().contacts:
        np.testing.assert_array_equal(contact.d, contact.t)


def test_both_rows_carry_the_signs_of_the_same_two_normal_forces() -> None:
    """+, - along x and along y; the paper's own form has -, + along y."""

    def signs(name: str) -> list[float]:
        return [float(np.sign(np.sum(contact.n))) for contact in DrumBrake(reading=name).system().contacts]

    assert signs("reconstructed") == signs("reconstructed_simple") == [1.0, -1.0, 1.0, -1.0]
    assert signs("eq3_signed") == [1.0, -1.0, -1.0, 1.0]


def test_the_preloads_give_the_damping_of_eq3_with_minus_and_plus() -> None:
    """c11 = c1 - alpha N (cos^2 + cos^2) and c22 = c2 + alpha N (sin^2 - sin^2), apart from the static compression."""
    brake = DrumBrake(reading="reconstructed")
    system = as_system(brake)
    linear = linearise(system)
    q0 = equilibrium(system).q
    s1, c1, s2, c2 = brake.directions
    alpha, load = -brake.friction.slope, brake.load1
    compression = [float(contact.n @ q0) for contact in system.contacts]
    expected = (
        brake.c1 - alpha * (load * (c1**2 + c2**2) + compression[0] + compression[1]),
        brake.c2 + alpha * (load * (s1**2 - s2**2) - compression[2] - compression[3]),
    )
    assert np.diag(linear.C) == pytest.approx(expected, rel=1e-12)


@pytest.mark.parametrize("name", ["reconstructed", "reconstructed_simple"])
def test_its_source_says_what_is_inferred_and_when_it_is_not_run_as_found(name: str) -> None:
    own = DrumBrake(reading=name)
    assert "inferred from its numbers, not printed" in own.source
    assert "found with" not in own.replace({"friction.static": 0.1}).source
    for other in (DrumBrake().replace(reading=name), own.replace(sliding_speed=np.array([0.2, 1.0]))):
        assert "found with a slope of" in other.source
    assert own.replace(reading="eq3").source == DrumBrake.source
