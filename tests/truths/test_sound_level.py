"""How loud: the piston in a wall against closed forms, against an integral over its field, and the standard's table."""

import numpy as np
import pytest

from squealbox.signals import SignalError, a_weighting, piston_efficiency, sound_level
from squealbox.signals.radiation import DENSITY, HEARING, SPEED_OF_SOUND

RATE = 100_000.0
T = np.arange(20_000) / RATE


def tone(frequency, velocity=0.1):
    """A surface velocity [m/s] of one frequency."""
    return velocity * np.sin(2.0 * np.pi * frequency * T)


def test_a_small_surface_is_a_monopole():
    # ka = 0.002: the piston deviates from rho f S v / r by (ka)^2/12, far below the 1e-4 of a peak read by a parabola
    area, frequency, velocity, distance = 1e-6, 200.0, 0.1, 0.7
    found = sound_level(tone(frequency, velocity), T, area=area, distance=distance)
    assert float(found.pressure) == pytest.approx(
        DENSITY * frequency * area * velocity / np.sqrt(2.0) / distance, rel=1e-4
    )
    assert float(found.level) == pytest.approx(20.0 * np.log10(float(found.pressure) / HEARING), abs=1e-12)


def test_a_large_surface_radiates_a_plane_wave():
    # sigma = 1: W = rho c S v_rms^2
    area, velocity = 25.0, 0.1
    found = sound_level(tone(18e3, velocity), T, area=area)
    assert float(found.power) == pytest.approx(DENSITY * SPEED_OF_SOUND * area * 0.5 * velocity**2, rel=2e-3)


@pytest.mark.parametrize("ka", [0.05, 0.5, 1.0, 2.0, 5.0, 12.0])
def test_the_efficiency_is_the_power_through_a_half_sphere(ka):
    # Far field of a piston in a wall (Rayleigh): |p| = rho c k a^2 v / (2 r) |2 J1(ka sin) / (ka sin)|. Its intensity
    # over the half sphere, by quadrature, must be rho c S v^2 sigma / 2.
    from scipy.integrate import quad
    from scipy.special import j1

    def intensity(angle):
        x = ka * np.sin(angle)
        beam = 2.0 * j1(x) / x if x > 1e-8 else 1.0
        return (0.5 * ka * beam) ** 2 * np.sin(angle)  # of (rho c v)^2 a^2 / (2 rho c r^2)

    power = 2.0 * np.pi * quad(intensity, 0.0, 0.5 * np.pi, epsabs=1e-13)[0]  # times rho c v^2 a^2 / 2
    area = 0.01
    frequency = ka * SPEED_OF_SOUND / (2.0 * np.pi * np.sqrt(area / np.pi))
    assert float(piston_efficiency(frequency, area)) == pytest.approx(power / np.pi, rel=1e-9)
    assert float(piston_efficiency(frequency, 2.0 * area)) != pytest.approx(power / np.pi, rel=1e-3)


def test_the_efficiency_has_no_step_where_its_series_ends():
    area = np.pi
    around = np.array([1e-2 * (1.0 - 1e-12), 1e-2 * (1.0 + 1e-12)]) * SPEED_OF_SOUND / (2.0 * np.pi)
    low, high = piston_efficiency(around, area)
    assert high == pytest.approx(low, rel=1e-8)


@pytest.mark.parametrize(
    ("frequency", "decibel"),
    [
        (31.5, -39.4),
        (100.0, -19.1),
        (500.0, -3.2),
        (1000.0, 0.0),
        (2000.0, 1.2),
        (4000.0, 1.0),
        (10e3, -2.5),
        (16e3, -6.6),
    ],
)
def test_a_weighting_is_the_table_of_the_standard(frequency, decibel):
    # IEC 61672-1, table 3, given at the exact frequencies 1000 10^(n/10), to 0.1 dB
    exact = 1000.0 * 10.0 ** (round(10.0 * np.log10(frequency / 1000.0)) / 10.0)
    assert 20.0 * np.log10(float(a_weighting(exact))) == pytest.approx(decibel, abs=0.05001)


def test_twice_the_velocity_is_six_decibel_and_twice_the_distance_takes_them_away():
    one = float(sound_level(tone(2000.0), T).level)
    assert float(sound_level(tone(2000.0, 0.2), T).level) - one == pytest.approx(20.0 * np.log10(2.0), abs=1e-9)
    assert one - float(sound_level(tone(2000.0), T, distance=2.0).level) == pytest.approx(
        20.0 * np.log10(2.0), abs=1e-9
    )
    assert float(sound_level(tone(2000.0, 0.3), T).level) - one != pytest.approx(20.0 * np.log10(2.0), abs=0.5)


def test_powers_of_two_lines_add():
    both = sound_level(tone(2000.0) + tone(3500.0, 0.05), T)
    parts = [float(sound_level(tone(2000.0), T).power), float(sound_level(tone(3500.0, 0.05), T).power)]
    assert float(both.power) == pytest.approx(sum(parts), rel=1e-4)  # each line's side lobes reach the other
    assert both.frequency == pytest.approx([2000.0, 3500.0], rel=1e-6)
    assert np.all(np.diff(both.line_level) < 0.0)


def test_what_people_cannot_hear_does_not_count():
    assert sound_level(tone(30e3), T).outcome == "silent"
    assert sound_level(np.zeros_like(T), T).outcome == "silent"
    assert float(sound_level(np.zeros_like(T), T).level) == -np.inf
    mixed = sound_level(tone(2000.0) + tone(30e3), T)
    assert float(mixed.level) == pytest.approx(float(sound_level(tone(2000.0), T).level), abs=1e-3)


def test_a_fixed_efficiency_is_used_and_named():
    found = sound_level(tone(2000.0), T, efficiency=0.25)
    assert found.efficiency == pytest.approx([0.25])
    assert "efficiency 0.25" in found.assumption
    assert "100 cm²" in found.summary()


@pytest.mark.parametrize("bad", [{"area": 0.0}, {"distance": -1.0}, {"efficiency": 0.0}, {"area": np.nan}])
def test_a_number_without_sense_is_refused(bad):
    with pytest.raises(SignalError, match=f"{next(iter(bad))} = .* expected a number above 0"):
        sound_level(tone(2000.0), T, **bad)
