"""R1, R2 and R5: published or exactly solvable eigenvalues and critical values, each with a negative twin."""

import numpy as np
import pytest

from squealbox.designs import DrumBrake, published_matrices
from squealbox.friction import LinearSlope
from squealbox.stability import complex_modes, critical_value
from squealbox.system import System

HALF_DIGIT_6 = 0.5e-6  # six digits after the point are printed
EXACT = 1e-9  # closed forms; the root finder is asked for 1e-12 relative


def mode_coupling(d: float, c1: float = 0.0, c2: float = 0.0) -> System:
    """R1, Hoffmann et al. 2002, normalised: x'' = -2x - (1-D)y, y'' = -x - 2y, so lambda^2 = -2 +- sqrt(1 - D)."""
    return System(M=np.eye(2), C=np.diag([c1, c2]), K=[[2.0, 1.0 - d], [1.0, 2.0]])


W1, W2 = 2.0 * np.pi * 100.0, 2.0 * np.pi * 75.0


def hulten(mu: float, eta1: float = 0.0, eta2: float = 0.0) -> System:
    """R2: K = [[w1^2, -mu w2^2], [mu w1^2, w2^2]], C = diag(eta1 w1, eta2 w2)."""
    stiffness = [[W1**2, -mu * W2**2], [mu * W1**2, W2**2]]
    return System(M=np.eye(2), C=np.diag([eta1 * W1, eta2 * W2]), K=stiffness)


def hulten_onset(eta1: float, eta2: float) -> tuple[float, float]:
    """Critical mu and frequency [Hz] of R2, from the imaginary and real parts of the characteristic polynomial.

    (s^2 + c1 s + w1^2)(s^2 + c2 s + w2^2) + mu^2 w1^2 w2^2 = 0 at s = i w: the imaginary part gives
    w^2 = (c1 w2^2 + c2 w1^2)/(c1 + c2), the real part mu^2 = (c1 c2 w^2 - (w1^2 - w^2)(w2^2 - w^2))/(w1 w2)^2.
    """
    c1, c2 = eta1 * W1, eta2 * W2
    square = (c1 * W2**2 + c2 * W1**2) / (c1 + c2)
    mu = np.sqrt(c1 * c2 * square - (W1**2 - square) * (W2**2 - square)) / (W1 * W2)
    return float(mu), float(np.sqrt(square) / (2.0 * np.pi))


@pytest.mark.parametrize(
    ("d", "expected"),
    [
        (0.0, (1.0j, 1.732051j)),
        (0.5, (1.137055j, 1.645328j)),
        (1.5, (0.246293 + 1.4355j,)),
        (2.0, (0.343561 + 1.455347j,)),
    ],
)
def test_r1_eigenvalues(d: float, expected: tuple[complex, ...]) -> None:
    values = complex_modes(mode_coupling(d)).eigenvalues
    for value in expected:
        for sign in (value, -np.conj(value), np.conj(value)):
            assert np.min(np.abs(values - sign)) < 2.0 * HALF_DIGIT_6  # half a digit in each part
    exact = np.sqrt(np.array([-2.0 + np.sqrt(1.0 - d + 0j), -2.0 - np.sqrt(1.0 - d + 0j)]))
    exact = np.concatenate([exact, -exact])
    assert np.max(np.min(np.abs(values[:, None] - exact), axis=0)) < 1e-14  # round-off of a (4, 4) problem


def test_r1_the_other_sign_of_the_coupling_is_another_system() -> None:
    wrong = complex_modes(System(M=np.eye(2), C=np.zeros((2, 2)), K=[[2.0, 1.5], [1.0, 2.0]])).eigenvalues
    assert np.min(np.abs(wrong - 1.137055j)) > 0.01


@pytest.mark.parametrize(("c1", "c2"), [(0.0, 0.0), (0.01, 0.01), (0.1, 0.1), (0.2, 0.1), (0.5, 0.5), (0.02, 0.0)])
def test_r1_onset(c1: float, c2: float) -> None:
    onset = critical_value(lambda d: mode_coupling(d, c1, c2), "D", (0.0, 3.0))
    assert float(onset.value) == pytest.approx(1.0 + 2.0 * c1 * c2, abs=EXACT)
    # the pair merges there when undamped, and a merged eigenvalue carries the square root of round-off
    assert onset.angular_frequency == pytest.approx(np.sqrt(2.0), abs=EXACT if c1 * c2 else 1e-5)
    assert onset.direction == "destabilising"


def test_r1_onset_depends_on_both_dampings() -> None:
    onset = critical_value(lambda d: mode_coupling(d, 0.2, 0.1), "D", (0.0, 3.0))
    assert abs(float(onset.value) - (1.0 + 2.0 * 0.2**2)) > 0.01


@pytest.mark.parametrize(
    ("eta1", "eta2", "mu", "frequency"),
    [
        (0.02, 0.002, 0.148713, 77.008),
        (0.02, 0.005, 0.212906, None),
        (0.02, 0.01, 0.260144, None),
        (0.02, 0.02, 0.289367, 86.6025),
        (0.02, 0.04, 0.287309, None),
        (0.02, 0.08, 0.256324, None),
    ],
)
def test_r2_onset(eta1: float, eta2: float, mu: float, frequency: float | None) -> None:
    onset = critical_value(lambda m: hulten(m, eta1, eta2), "mu", (0.0, 0.6))
    exact, exact_frequency = hulten_onset(eta1, eta2)
    assert float(onset.value) == pytest.approx(exact, abs=EXACT)
    assert onset.frequency == pytest.approx(exact_frequency, abs=1e-6)
    assert abs(exact - mu) <= HALF_DIGIT_6
    if frequency is not None:
        assert onset.frequency == pytest.approx(frequency, abs=0.5e-3)  # the digits given


def test_r2_onset_undamped() -> None:
    onset = critical_value(hulten, "mu", (0.0, 0.6))
    assert float(onset.value) == pytest.approx((W1**2 - W2**2) / (2.0 * W1 * W2), abs=EXACT)  # discriminant = 0
    assert float(onset.value) == pytest.approx(0.2916667, abs=0.5e-7)
    assert onset.frequency == pytest.approx(88.388348, abs=1e-5)  # merged pair: square root of round-off


def test_r2_more_damping_on_one_side_destabilises() -> None:
    little, more = (critical_value(lambda m, e=e: hulten(m, 0.02, e), "mu", (0.0, 0.6)) for e in (0.02, 0.08))
    assert float(more.value) < float(little.value) - 0.03


def drum(mu: float, alpha: float = 0.0) -> DrumBrake:
    return DrumBrake(friction=LinearSlope(mu, -alpha), reading="eq3")


@pytest.mark.parametrize(
    ("mu", "expected"),
    [
        (0.0, (-107.4 + 11010.5j, -107.6 + 14688.3j)),
        (0.1, (-107.4 + 11322.2j, -107.6 + 14449.4j)),
        (0.3, (-107.3 + 12012.8j, -107.7 + 13880.5j)),
        (0.45, (126.4 + 12981.6j,)),
        (0.5, (455.5 + 12992.2j,)),
    ],
)
def test_r5_eigenvalues(mu: float, expected: tuple[complex, ...]) -> None:
    values = complex_modes(drum(mu)).eigenvalues
    for value in expected:
        gap = values - value
        assert np.min(np.maximum(np.abs(gap.real), np.abs(gap.imag))) <= 0.05 + 1e-9  # one digit after the point


R5 = [
    (0.0, 0.442173, 0.442173),
    (0.01, 0.444026, 0.444225),
    (0.05, 0.451425, 0.452333),
    (0.1, 0.460659, 0.462216),
    (0.3, 0.497579, 0.497745),
]


@pytest.mark.parametrize(("alpha", "rows", "printed"), R5)
def test_r5_critical_friction(alpha: float, rows: float, printed: float) -> None:
    design = drum(0.3, alpha)
    from_rows = critical_value(design, "friction.static", (0.0, 0.7))
    printed_system = lambda mu: published_matrices(design.replace({"friction.static": mu}))  # noqa: E731
    from_print = critical_value(printed_system, "friction.static", (0.0, 0.7))
    assert abs(float(from_rows.value) - rows) <= HALF_DIGIT_6
    assert abs(float(from_print.value) - printed) <= HALF_DIGIT_6


@pytest.mark.parametrize(("reading", "near"), [("consistent", 0.331), ("eq3_signed", 0.324)])
def test_r5_other_readings_lose_stability_elsewhere(reading: str, near: float) -> None:
    onset = critical_value(drum(0.3).replace(reading=reading), "friction.static", (0.0, 0.7))
    assert float(onset.value) == pytest.approx(near, abs=0.5e-3)  # "near" is given to three digits


def test_no_onset_is_a_named_result_with_evidence() -> None:
    result = critical_value(drum(0.3), "friction.static", (0.0, 0.4))
    assert result.outcome == "no_onset"
    assert np.isnan(result.value)
    assert result.outcome.evidence["growth_rate_low"] == pytest.approx(-107.393, abs=0.001)
    assert result.outcome.evidence["growth_rate_high"] < 0.0


def test_standstill_has_no_spectrum_and_says_why() -> None:
    modes = complex_modes(drum(0.3).replace(sliding_speed=np.array([0.0, 0.2])))
    assert modes.outcome == "no_sliding"
    assert list(modes.exists) == [False, True]
    assert np.all(np.isnan(modes.eigenvalues[0]))
    assert np.all(np.isfinite(modes.eigenvalues[1]))
    assert list(modes.stable) == [False, True]
