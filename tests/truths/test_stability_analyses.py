"""Mechanism, energy, sensitivity, exceptional points, non-normal growth, tracking and indices against what is known."""

import numpy as np
import pytest

from squealbox.designs import DrumBrake, published_matrices
from squealbox.friction import LinearSlope
from squealbox.parameters import DataSheet, parameter
from squealbox.stability import (
    complex_modes,
    critical_value,
    critical_values,
    damping_ratio_from,
    damping_split,
    exceptional_points,
    indices,
    mechanism,
    mode_energy,
    pseudospectrum,
    routh_hurwitz,
    sensitivity,
    squeal_index,
    tracked_modes,
    transient_growth,
)
from squealbox.stability.family import steady_sliding
from squealbox.stability.hurwitz import undamped_squares
from squealbox.stability.state_matrix import spectrum
from squealbox.system import Contact, System

ROUND_OFF = 1e-10  # sums of exact identities; eigenvalues of these systems are good to about 1e-13 of their size
W1, W2 = 2.0 * np.pi * 100.0, 2.0 * np.pi * 75.0


class Hulten(DataSheet):
    """R2 as a design: K = [[w1^2, -mu w2^2], [mu w1^2, w2^2]], C = diag(c1, c2)."""

    mu: float = parameter("-", 0.0, default=0.2)
    c1: float = parameter("1/s", 0.0, default=0.02 * W1)
    c2: float = parameter("1/s", 0.0, default=0.02 * W2)

    def system(self) -> System:
        mu, c1, c2 = np.broadcast_arrays(self.mu, self.c1, self.c2)
        zero = np.zeros(mu.shape)
        stiffness = np.stack([np.stack([W1**2 + zero, -mu * W2**2], -1), np.stack([mu * W1**2, W2**2 + zero], -1)], -2)
        damping = np.stack([np.stack([c1, zero], -1), np.stack([zero, c2], -1)], -2)
        return System(M=np.eye(2), C=damping, K=stiffness)


def drum(reading: str, mu: float = 0.3, alpha: float = 0.05) -> DrumBrake:
    return DrumBrake(friction=LinearSlope(mu, -alpha), reading=reading)


# ----- mechanism: the two studies of the paper, in each reading that loses stability in them


@pytest.mark.parametrize("alpha", [0.0, 0.05])
@pytest.mark.parametrize("reading", ["eq3", "eq3_signed", "consistent", "published"])
def test_friction_study_ends_in_flutter(reading: str, alpha: float) -> None:
    base = drum("eq3" if reading == "published" else reading, alpha=alpha)
    design = base
    if reading == "published":
        design = lambda mu: published_matrices(base.replace({"friction.static": mu}))  # noqa: E731
    onset = critical_value(design, "friction.static", (0.0, 0.9))
    assert onset.mechanism == "flutter"
    assert onset.direction == "destabilising"
    terms = onset.base + onset.circulation + onset.slope
    assert abs(terms) < ROUND_OFF * onset.angular_frequency  # the terms add up to the growth rate, here zero
    assert onset.shares["flutter"] + onset.shares["negative_slope"] == pytest.approx(1.0)


@pytest.mark.parametrize("reading", ["eq1_printed", "componentwise", "consistent", "published"])
def test_load_study_ends_in_negative_slope(reading: str) -> None:
    base = drum("eq3" if reading == "published" else reading)
    design = base
    if reading == "published":
        design = lambda load: published_matrices(base.replace({"load": load}))  # noqa: E731
    assert critical_value(design, "load", (100.0, 25e3)).mechanism == "negative_slope"


@pytest.mark.parametrize("reading", ["eq3", "eq3_signed"])
def test_in_these_readings_friction_falling_with_speed_does_not_destabilise(reading: str) -> None:
    """N = n.q of these rows is negative where it meets d = t, so the load study has no onset; said, not hidden."""
    assert critical_value(drum(reading), "load", (100.0, 25e3)).outcome == "no_onset"


def test_damping_induced_flutter_is_flutter_not_negative_slope() -> None:
    onset = critical_value(Hulten(c2=0.002 * W2), "mu", (0.0, 0.6))
    assert onset.mechanism == "flutter"
    assert float(onset.value) < 0.29


def test_a_negative_damper_is_negative_slope() -> None:
    system = System(M=np.eye(2), C=np.diag([-0.1, 0.1]), K=[[1.0, 0.0], [0.0, 2.0]])
    assert mechanism(system).name == "negative_slope"
    assert mechanism(System(M=np.eye(2), C=np.diag([0.1, 0.1]), K=[[1.0, 0.0], [0.0, 2.0]])).name == "stable"


def test_a_soft_spring_is_divergence() -> None:
    onset = critical_value(lambda k: System(M=np.eye(1), C=[[0.1]], K=[[k]]), "k", (-1.0, 2.0))
    assert onset.mechanism == "divergence"
    assert onset.direction == "stabilising"
    assert float(onset.value) == pytest.approx(0.0, abs=1e-9)


def test_every_crossing_of_two_uncoupled_modes_is_found() -> None:
    """Damping 0.1 - p and 0.3 - p of two oscillators vanish at p = 0.1 and 0.3; (p - 0.5)^2 - 1e-6 twice about 0.5."""

    def system(p: float) -> System:
        return System(M=np.eye(3), C=np.diag([0.1 - p, 0.3 - p, (p - 0.5) ** 2 - 1e-6]), K=np.diag([1.0, 4.0, 9.0]))

    found = critical_values(system, "p", (0.0, 1.0), points=201)
    assert found.value == pytest.approx([0.1, 0.3, 0.499, 0.501], abs=1e-10)
    assert list(found.direction) == ["destabilising", "destabilising", "destabilising", "stabilising"] or list(
        found.direction
    ) == ["destabilising", "destabilising", "stabilising", "destabilising"]
    assert list(found.unstable_above) in ([1, 2, 1, 2], [1, 2, 3, 2])


# ----- energy


@pytest.mark.parametrize("reading", ["eq1_printed", "eq3", "eq3_signed", "componentwise", "consistent"])
@pytest.mark.parametrize("index", [0, 1])
def test_powers_add_up_to_the_growth_rate(reading: str, index: int) -> None:
    energy = mode_energy(drum(reading, mu=0.48), index)
    assert energy.residual < ROUND_OFF
    assert energy.growth_rate == pytest.approx(float(np.real(energy.eigenvalue)), abs=1e-10 * 1.3e4)


def test_energy_without_one_contact_does_not_add_up() -> None:
    energy = mode_energy(drum("consistent", mu=0.48))
    short = (np.sum(energy.circulation[1:] + energy.slope) - np.sum(energy.dissipated)) / (2.0 * energy.total)
    assert abs(short - float(np.real(energy.eigenvalue))) > 1.0


def test_energy_of_a_skew_structure_without_contacts() -> None:
    assert mode_energy(Hulten(mu=0.4).system()).residual < ROUND_OFF


def test_an_open_contact_feeds_nothing() -> None:
    contact = Contact(
        [1.0, 0.0], [0.0, 1.0], [0.0, 1.0], -5.0, 1.0, LinearSlope(0.4, -0.1), unilateral=True, normal=[1.0, 0.0]
    )
    system = System(M=np.eye(2), C=0.1 * np.eye(2), K=[[3.0, 0.2], [0.2, 2.0]], load=[0.0, 0.0], contacts=(contact,))
    energy = mode_energy(system)
    assert energy.residual < ROUND_OFF
    assert np.all(energy.circulation == 0.0)


# ----- sensitivity


@pytest.mark.parametrize("reading", ["eq3", "consistent"])
def test_derivatives_against_differences_of_eigenvalues(reading: str) -> None:
    design = drum(reading, mu=0.38)
    names = ["friction.static", "k3", "c1", "theta1", "load1"]
    exact = sensitivity(design, names, 0)

    def value(change: dict[str, float]) -> complex:
        values = spectrum(steady_sliding(design.replace(change)))
        return complex(values[np.argmin(np.abs(values - exact.eigenvalue))])

    for i, name in enumerate(names):
        p = float(design.value_of(name))
        h = 2e-4 * p
        up, down = value({name: p + h}), value({name: p - h})
        far_up, far_down = value({name: p + 2 * h}), value({name: p - 2 * h})
        slope = (8.0 * (up - down) - (far_up - far_down)) / (12.0 * h)
        curve = (16.0 * (up + down) - far_up - far_down - 30.0 * exact.eigenvalue) / (12.0 * h**2)
        size = abs(exact.first[i]) + abs(exact.eigenvalue) / p * 1e-6
        assert abs(exact.first[i] - slope) < 1e-6 * size
        # second differences of eigenvalues good to 1e-12 lose 1e-12 |lambda| / h^2
        noise = 2e-11 * abs(exact.eigenvalue) / h**2
        assert abs(exact.second[i, i] - curve) < 1e-6 * abs(exact.second[i, i]) + noise
    mixed = _mixed_difference(value, {"friction.static": 0.38, "k3": float(design.k3)})
    assert abs(exact.second[0, 1] - mixed) < 1e-6 * abs(mixed)
    assert np.allclose(exact.second, exact.second.T)


def _mixed_difference(value, point: dict[str, float]) -> complex:
    """d2/dp dk by differences over four corners, extrapolated from steps h, 2h and 4h: h^2 and h^4 cancel."""
    (first, p), (second, k) = point.items()
    found = []
    for h in (2e-3, 4e-3, 8e-3):
        corners = [
            a * b * value({first: p * (1.0 + a * h), second: k * (1.0 + b * h)}) for a in (1, -1) for b in (1, -1)
        ]
        found.append(sum(corners) / (4.0 * h**2 * p * k))
    fine, coarse = (4.0 * found[0] - found[1]) / 3.0, (4.0 * found[1] - found[2]) / 3.0
    return (16.0 * fine - coarse) / 15.0


def test_derivatives_with_the_wrong_left_vector_are_wrong() -> None:
    design = Hulten(mu=0.25)
    exact = sensitivity(design, ["mu"], 0)
    u = complex_modes(design).right[:, 0]
    slope = np.array([[0.0, -(W2**2)], [W1**2, 0.0]])
    symmetric = -(np.conj(u) @ slope @ u) / (np.conj(u) @ (2.0 * exact.eigenvalue * np.eye(2)) @ u)
    assert abs(symmetric - exact.first[0]) > 0.1 * abs(exact.first[0])


def test_a_parameter_at_the_end_of_its_range_is_differenced_inwards() -> None:
    found = sensitivity(Hulten(mu=0.0, c1=0.0), ["mu", "c1"], 0)
    assert abs(found.first[1] + 0.5 * abs(found.eigenvalue.imag == W1)) < 0.5  # a damper moves its own mode by -1/2
    assert np.all(np.isfinite(found.second))


def test_near_a_coalescence_derivatives_are_flagged() -> None:
    design = Hulten(mu=(W1**2 - W2**2) / (2.0 * W1 * W2), c1=0.0, c2=0.0)
    assert sensitivity(design, ["mu"], 0).near_defective
    assert not sensitivity(Hulten(mu=0.1), ["mu"], 0).near_defective


# ----- exceptional points and the damping paradox


def test_exceptional_point_of_r1() -> None:
    """(s^2 + c1 s + 2)(s^2 + c2 s + 2) = 1 - D: a double root needs D = 1 and c1 = c2."""

    def system(d: float, c1: float) -> System:
        return System(M=np.eye(2), C=np.diag([c1, 0.1]), K=[[2.0, 1.0 - d], [1.0, 2.0]])

    found = exceptional_points(system, {"D": (0.5, 1.5), "c1": (0.0, 0.3)}, points=15)
    assert found.x == pytest.approx([1.0], abs=1e-8)
    # the squared gap is flat in c1 there, (c1 - 0.1)^2/4 to leading order, so c1 is good to the root of 1e-13
    assert found.y == pytest.approx([0.1], abs=1e-6)
    none = exceptional_points(system, {"D": (1.2, 1.5), "c1": (0.2, 0.3)}, points=9)
    assert none.outcome == "none_found"


def test_damping_paradox_of_r2_and_its_best_split() -> None:
    """With c1 + c2 fixed, mu_H^2 of R2's closed form has its maximum where its derivative in the share vanishes."""
    total = 0.02 * (W1 + W2)
    split = damping_split(Hulten(), ("c1", "c2"), total, "mu", (0.0, 0.6), splits=9)

    def closed(share: float) -> float:
        c1, c2 = share * total, (1.0 - share) * total
        square = (c1 * W2**2 + c2 * W1**2) / (c1 + c2)
        return float(np.sqrt(c1 * c2 * square + (W1**2 - square) * (square - W2**2)) / (W1 * W2))

    shares = np.linspace(0.3, 0.7, 400001)
    c1, c2 = shares * total, (1.0 - shares) * total
    square = (c1 * W2**2 + c2 * W1**2) / total
    best = shares[np.argmax(c1 * c2 * square + (W1**2 - square) * (square - W2**2))]
    assert split.critical == pytest.approx([closed(float(s)) for s in split.share], abs=1e-9)
    assert float(split.best_share) == pytest.approx(best, abs=1e-4)  # flat at the maximum: 1e-8 in the value
    assert float(split.best) == pytest.approx(closed(float(best)), abs=1e-9)
    assert float(split.undamped) == pytest.approx(0.2916667, abs=1e-7)
    assert float(np.min(split.critical)) < 0.5 * float(split.undamped)


# ----- non-normal growth


def test_transient_growth_of_a_normal_system_is_none() -> None:
    found = transient_growth(System(M=np.eye(2), C=0.2 * np.eye(2), K=np.diag([1.0, 4.0])))
    assert float(found.amplification) == pytest.approx(1.0, abs=1e-12)
    assert float(found.numerical_abscissa) == pytest.approx(0.0, abs=1e-12)


def test_transient_growth_of_a_circulatory_system_and_its_start() -> None:
    from scipy.linalg import expm

    system = Hulten(mu=0.27).system()
    found = transient_growth(system)
    assert found.outcome.ok
    assert float(found.amplification) > 1.5
    start = np.concatenate([found.start_q, found.start_qd])
    matrix = np.block([[np.zeros((2, 2)), np.eye(2)], [-system.K, -system.C]])
    after = expm(matrix * float(found.time)) @ start
    symmetric = 0.5 * (system.K + system.K.T)
    energy = [0.5 * x[:2] @ symmetric @ x[:2] + 0.5 * x[2:] @ x[2:] for x in (start, after)]
    assert energy[0] == pytest.approx(1.0)
    assert np.sqrt(energy[1] / energy[0]) == pytest.approx(float(found.amplification), rel=1e-9)
    other = np.roll(start, 1)
    worse = expm(matrix * float(found.time)) @ other
    energies = [0.5 * x[:2] @ symmetric @ x[:2] + 0.5 * x[2:] @ x[2:] for x in (other, worse)]
    assert np.sqrt(energies[1] / energies[0]) < 0.999 * float(found.amplification)


def test_pseudospectrum_vanishes_at_eigenvalues_only() -> None:
    system = Hulten(mu=0.27).system()
    value = complex_modes(system).eigenvalues[0]
    least = pseudospectrum(system, [value.real, value.real + 5.0], [value.imag])
    assert least[0, 0] < 1e-9
    assert 1e-3 < least[0, 1] < 5.0  # at most the distance to the spectrum


# ----- tracking


def test_uncoupled_modes_are_followed_through_their_crossing() -> None:
    values = np.linspace(0.5, 2.0, 16)
    found = tracked_modes(lambda p: System(M=np.eye(2), C=0.01 * np.eye(2), K=np.diag([p, 1.0])), "p", values)
    moving = np.argmax(np.ptp(found.frequency, axis=0))
    assert found.frequency[:, moving] * 2.0 * np.pi == pytest.approx(np.sqrt(values - 0.005**2), abs=1e-12)
    ordered = np.sort(found.frequency, axis=1)
    assert not np.allclose(ordered[:, 0], found.frequency[:, moving])


def test_veering_modes_exchange_their_shapes_and_keep_their_branch() -> None:
    def system(p: float) -> System:
        return System(M=np.eye(2), C=np.zeros((2, 2)), K=[[p, 0.02], [0.02, 1.0]])

    found = tracked_modes(system, "p", np.linspace(0.5, 1.5, 9))
    lower = np.argmin(found.frequency[0] + 1e3 * (found.eigenvalues[0].imag < 0.0))
    assert np.all(found.frequency[:, lower] <= np.min(found.frequency, axis=1) * (1.0 + 1e-12))
    assert np.all(found.clear)


def test_flutter_is_followed_through_the_coalescence() -> None:
    values = np.linspace(0.1, 0.5, 41)
    found = tracked_modes(drum("eq3", alpha=0.0), "friction.static", values)
    step = np.max(np.abs(np.diff(found.eigenvalues, axis=0)))
    assert step < 500.0  # 1/s; a wrong pairing would jump by the distance of the conjugates, 2.6e4


# ----- indices, Routh-Hurwitz


def test_indices_and_their_conversions() -> None:
    modes = complex_modes(drum("eq3", mu=0.45, alpha=0.0))
    found = indices(modes)
    value = modes.eigenvalues[0]
    assert found["unstable_modes"] == 1
    assert found["unstable_in_band"] == 1
    assert indices(modes, (1e4, 2e4))["unstable_in_band"] == 0
    assert found["tendency_of_instability"] == pytest.approx(1e3 * value.real / value.imag)
    ratio = -value.real / abs(value)
    assert damping_ratio_from(squeal_index(value), "squeal_index") == pytest.approx(ratio, rel=1e-14)
    assert damping_ratio_from(2.0 * ratio, "loss_factor") == pytest.approx(ratio)
    assert damping_ratio_from(np.pi * squeal_index(value), "logarithmic_decrement") == pytest.approx(ratio, rel=1e-14)
    with pytest.raises(ValueError, match="expected"):
        damping_ratio_from(0.1, "decibel")


def test_routh_hurwitz_agrees_with_eigenvalues() -> None:
    rng = np.random.default_rng(5)
    system = System(
        M=np.eye(2), C=rng.normal(size=(2000, 2, 2)) + np.eye(2), K=rng.normal(size=(2000, 2, 2)) + 3.0 * np.eye(2)
    )
    by_roots = complex_modes(system).largest_growth_rate < 0.0
    assert np.array_equal(routh_hurwitz(system), by_roots)
    assert 0.05 < np.mean(by_roots) < 0.95


def test_closed_form_of_the_undamped_squares() -> None:
    system = Hulten(mu=0.4, c1=0.0, c2=0.0).system()
    squares = np.array(undamped_squares(steady_sliding(system)))
    values = complex_modes(system).eigenvalues ** 2
    assert np.max(np.min(np.abs(values[:, None] - squares), axis=1)) < 1e-9 * W1**2
