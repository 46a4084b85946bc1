"""Rigid-body freedoms, points without an answer and scales far apart, against closed forms.

Two bodies free to move together, m1 and m2 on a spring k, with friction between them: the relative motion x has

    mu x'' + N mu'(V) x' + k x = 0,   mu = m1 m2 / (m1 + m2),

so lambda = -N mu'/(2 mu) +- i sqrt(k/mu - (N mu'/(2 mu))^2), beside two zeros of the common motion.
"""

import numpy as np
import pytest

from squealbox import (
    Contact,
    Coulomb,
    MassOnBelt,
    Stribeck,
    System,
    complex_modes,
    critical_value,
    critical_values,
    mode_energy,
    stability_map,
)
from squealbox.limit_cycles import hopf_point, lyapunov_exponents, shooting
from squealbox.stability import tracked_modes
from squealbox.stability.deflation import special_modes
from squealbox.stability.free_bodies import free_body_spectra
from squealbox.system import InvalidSystem, equilibrium

SPRING, FORCE = 1e4, 10.0


def couple(static: float, ground: float = 0.0, masses: tuple[float, float] = (1.0, 2.0), damper: float = 0.0) -> System:
    pair = np.array([[1.0, -1.0], [-1.0, 1.0]])
    law = Stribeck(static, 0.2, 0.3)
    between = Contact(n=[0.0, 0.0], d=[1.0, -1.0], t=[1.0, -1.0], N0=FORCE, V=1.0, law=law)
    return System(np.diag(masses), damper * pair, SPRING * pair + ground * np.eye(2), 0.0, (between,))


def exact(static: float, masses: tuple[float, float] = (1.0, 2.0), damper: float = 0.0) -> complex:
    reduced = masses[0] * masses[1] / sum(masses)
    rate = -(damper - FORCE * (static - 0.2) / 0.3 * np.exp(-1.0 / 0.3)) / (2.0 * reduced)
    return complex(rate, np.sqrt(SPRING / reduced - rate**2))


@pytest.mark.parametrize("masses", [(1.0, 2.0), (3.0, 1e-3)])
@pytest.mark.parametrize("static", [0.1, 0.2, 0.4, 0.9])
def test_free_bodies_have_two_zeros_and_the_mode_of_the_closed_form(static: float, masses: tuple[float, float]) -> None:
    modes = complex_modes(couple(static, masses=masses))
    assert modes.outcome.ok
    assert modes.floating == 1
    assert np.count_nonzero(modes.eigenvalues == 0.0) == 2
    assert modes.most_unstable.eigenvalue == pytest.approx(exact(static, masses), rel=1e-12)
    assert modes.stable == (static <= 0.2)
    assert modes.unstable_modes == (static > 0.2)
    assert modes.largest_growth_rate == pytest.approx(exact(static, masses).real, abs=1e-11)


def test_steady_sliding_is_the_deflection_of_least_length() -> None:
    state = equilibrium(couple(0.4))
    assert state.exists
    assert state.floating == 1
    assert np.sum(state.q) == pytest.approx(0.0, abs=1e-18)
    assert SPRING * (state.q[0] - state.q[1]) == pytest.approx(FORCE * state.friction[0], rel=1e-12)


def test_a_force_along_a_rigid_body_motion_leaves_no_steady_sliding() -> None:
    pushed = couple(0.4).replace(load=[1.0, 0.0])
    assert complex_modes(pushed).outcome == "singular"
    assert "runs away" in complex_modes(pushed).outcome.message


@pytest.mark.parametrize("ground", [0.0, 1e-9, 1e-6, 1e-4])  # a spring under both, on which they stay undamped
@pytest.mark.parametrize("damper", [0.0, 0.05])
def test_onset_of_free_bodies(ground: float, damper: float) -> None:
    """N mu'(V) + c = 0 at static = 0.2 + 0.3 c exp(1/0.3)/N; a ground spring of 1e-9 N/m changes nothing."""
    onset = critical_value(lambda x: couple(x, ground, damper=damper), "static", (0.0, 1.0))
    assert float(onset.value) == pytest.approx(0.2 + 0.3 * damper * np.exp(1.0 / 0.3) / FORCE, rel=1e-9)
    assert onset.direction == "destabilising"
    assert onset.mechanism == "negative_slope"
    assert onset.eigenvalue.imag == pytest.approx(exact(float(onset.value), damper=damper).imag, rel=1e-8)
    shares = [value for _, value in mode_energy(couple(0.4, ground, damper=damper)).shares]
    assert np.all(np.isfinite(shares))


def test_maps_and_tracks_of_free_bodies() -> None:
    def both(static: float, damper: float) -> System:
        return couple(static, damper=damper)

    grid = stability_map(both, {"static": np.linspace(0.1, 0.5, 5), "damper": np.array([0.0, 0.3])})
    assert grid.unstable_modes[:, 0].tolist() == [0, 0, 1, 1, 1]
    path = tracked_modes(lambda x: couple(x, damper=0.05), "static", np.linspace(0.1, 0.9, 5))
    assert np.all(np.isfinite(path.eigenvalues))


@pytest.mark.parametrize("bounds", [(0.0, 1.0), (0.0, 2.0), (-1.0, 1.0), (0.001, 0.9), (-0.7, 2.3), (0.0, 1e3)])
def test_a_crossing_beside_a_value_without_an_answer(bounds: tuple[float, float]) -> None:
    """c + N mu'(V) = 0 at |V| = 0.003; at V = 0 there is no steady sliding."""
    belt = MassOnBelt(c=5.0 * np.exp(-0.15), friction=Stribeck(0.4, 0.3, 0.02))
    found = critical_values(belt, "sliding_speed", bounds)
    expected = [v for v in (-0.003, 0.003) if bounds[0] < v < bounds[1]]
    assert found.value == pytest.approx(expected, rel=1e-9)
    first = critical_value(belt, "sliding_speed", bounds)
    assert float(first.value) == pytest.approx(expected[0], rel=1e-9)


def test_a_range_says_where_there_was_no_answer() -> None:
    belt = MassOnBelt(c=10.0, friction=Stribeck(0.4, 0.3, 0.02))
    found = critical_value(belt, "sliding_speed", (0.0, 2.0))
    assert found.outcome == "no_onset"
    assert found.outcome.evidence["without_answer"] == [[0.0, 0.0]]
    assert "there is no steady sliding at 0" in found.outcome.message


def test_scales_far_apart_are_not_singular() -> None:
    modes = complex_modes(System(np.eye(2), np.zeros((2, 2)), np.diag([1.0, 1e16]), [1.0, 1.0]))
    assert modes.outcome.ok
    assert modes.floating == 0
    assert np.max(modes.angular_frequency) == pytest.approx(1e8, rel=1e-14)


@pytest.mark.parametrize(
    ("wrong", "said"),
    [
        ({"M": np.diag([1.0, -2.0])}, "negative"),
        ({"M": [[1.0, 3.0], [3.0, 1.0]]}, "indefinite"),
        ({"M": [[1e-9, 2e-10], [1e-10, 1e-9]]}, "not symmetric"),
        ({"names": ("a",)}, "expected 2"),
        ({"names": ("a", "a")}, "more than once"),
    ],
)
def test_what_makes_no_system_is_refused(wrong: dict, said: str) -> None:
    with pytest.raises(InvalidSystem, match=said):
        System(**({"M": np.eye(2), "C": np.zeros((2, 2)), "K": np.eye(2)} | wrong))


def test_many_contacts_are_asked_once() -> None:
    """The same force and couplings as one contact of all the force together, with 2000 contacts."""
    count = 2000
    many = tuple(Contact([0.01], [1.0], [1.0], 1.0 / count, 1.0, Coulomb(0.3)) for _ in range(count))
    one = (Contact([0.01 * count], [1.0], [1.0], 1.0, 1.0, Coulomb(0.3)),)
    states = [equilibrium(System([[1.0]], [[0.1]], [[100.0]], 0.0, rows)) for rows in (many, one)]
    assert states[0].q == pytest.approx(states[1].q, rel=1e-12)


def test_cycles_of_free_bodies_are_those_of_their_relative_motion() -> None:
    """x = q1 - q2 obeys mu x'' + k x = F: one mass of mu = m1 m2 / (m1 + m2) on a belt, and m1 q1 + m2 q2 rests."""
    reduced = 2.0 / 3.0
    belt = Contact(n=[0.0], d=[1.0], t=[1.0], N0=FORCE, V=1.0, law=Stribeck(0.4, 0.2, 0.3))
    alone = shooting(System([[reduced]], [[0.0]], [[SPRING]], 0.0, (belt,)))
    free = shooting(couple(0.4))
    assert free.stable
    assert free.period == pytest.approx(float(alone.period), rel=1e-9)
    assert np.sum(free.amplitude) == pytest.approx(float(alone.amplitude[0]), rel=1e-6)
    assert free.amplitude[0] == pytest.approx(2.0 * free.amplitude[1], rel=1e-9)
    assert free.multipliers.shape == (2,)
    assert hopf_point(lambda damper: couple(0.4, damper=damper), "damper", (0.0, 5.0)).value == pytest.approx(
        FORCE * 0.2 / 0.3 * np.exp(-1.0 / 0.3), rel=1e-9
    )
    still = lyapunov_exponents(couple(0.4), free.start, float(free.period), 10)
    assert np.count_nonzero(still == 0.0) == 2


def test_many_free_bodies_are_solved_together_as_one_by_one() -> None:
    chain = SPRING * np.array([[1.0, -1.0, 0.0], [-1.0, 2.0, -1.0], [0.0, -1.0, 1.0]])
    mass = np.diag([1.0, 2.0, 0.3])
    values, answered = free_body_spectra(mass[None], 1e-3 * chain[None], chain[None], np.array([1]))
    assert answered[0]
    one_by_one = special_modes(mass, 1e-3 * chain, chain)
    assert one_by_one is not None
    assert np.sort(values[0]) == pytest.approx(np.sort(one_by_one[0]), rel=1e-12, abs=1e-9)
