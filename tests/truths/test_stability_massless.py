"""Singular mass matrices: the finite eigenvalues against closed forms."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from squealbox import Coulomb
from squealbox.stability import complex_modes, finite_spectrum
from squealbox.system import System

M2, C0 = np.diag([2.0, 0.0]), np.zeros((2, 2))
ROUND_OFF = 1e-12


def test_an_undamped_massless_freedom_is_condensed_statically() -> None:
    """K_11 - K_12 K_21 / K_22 = 5 - 1.5 * 0.5 / 4 on a mass of 2, also for a non-symmetric K."""
    found = finite_spectrum(System(M=M2, C=C0, K=[[5.0, 1.5], [0.5, 4.0]]))
    omega = np.sqrt((5.0 - 1.5 * 0.5 / 4.0) / 2.0)
    assert found.eigenvalues == pytest.approx([1j * omega, -1j * omega], abs=ROUND_OFF)
    assert found.infinite == 2


def test_a_spring_and_damper_in_series_is_a_cubic() -> None:
    """Mass m on a spring k, and on a spring k1 in series with a damper c; the joint y has no mass.

    m x'' + k x + k1 (x - y) = 0 and c y' = k1 (x - y) give (m l^2 + k + k1)(c l + k1) - k1^2 = 0.
    """
    m, k, k1, c = 2.0, 3.0, 5.0, 0.7
    found = finite_spectrum(System(M=np.diag([m, 0.0]), C=np.diag([0.0, c]), K=[[k + k1, -k1], [-k1, k1]]))
    expected = np.roots([m * c, m * k1, (k + k1) * c, (k + k1) * k1 - k1**2])
    assert np.sort_complex(found.eigenvalues) == pytest.approx(np.sort_complex(expected), abs=1e-11)
    assert found.infinite == 1
    wrong = np.roots([m * c, m * k1, (k + k1) * c, (k + k1) * k1])  # the coupling left out
    assert not np.allclose(np.sort_complex(found.eigenvalues), np.sort_complex(wrong), rtol=1e-3)


def test_a_constraint_in_place_of_a_stiffness() -> None:
    """K = [[5, 1], [1, 0]] with a massless multiplier holds x = 0: nothing moves, all four eigenvalues are infinite."""
    found = finite_spectrum(System(M=M2, C=C0, K=[[5.0, 1.0], [1.0, 0.0]]))
    assert found.outcome.ok
    assert len(found.eigenvalues) == 0
    assert found.infinite == 4


def test_a_motion_without_any_force_has_a_name() -> None:
    found = finite_spectrum(System(M=M2, C=C0, K=[[5.0, 0.0], [0.0, 0.0]]))
    assert found.outcome in ("singular", "singular_pencil")
    assert len(found.eigenvalues) == 0


def test_complex_modes_have_the_finite_ones_and_the_others_as_nan() -> None:
    system = System(M=M2, C=C0, K=[[5.0, 1.5], [0.5, 4.0]])
    modes, found = complex_modes(system), finite_spectrum(system)
    assert modes.outcome.ok
    known = np.isfinite(modes.eigenvalues)
    assert np.sum(~known) == found.infinite
    assert np.sort_complex(modes.eigenvalues[known]) == pytest.approx(np.sort_complex(found.eigenvalues), rel=1e-12)


def test_with_a_regular_mass_it_is_the_whole_spectrum() -> None:
    system = System(M=[[2.0, 0.3], [0.3, 1.0]], C=[[0.1, 0.2], [0.0, 0.3]], K=[[5e6, 1.5e6], [-0.5e6, 4e6]])
    found, whole = finite_spectrum(system), complex_modes(system).eigenvalues
    assert found.infinite == 0
    gap = np.min(np.abs(found.eigenvalues[:, None] - whole), axis=1)
    assert np.max(gap) < 1e-10 * np.max(np.abs(whole))


NUMBERS = st.integers(-20, 20).map(lambda x: 0.25 * x)  # repeated, defective, singular and zero on purpose


@settings(deadline=None, max_examples=150)
@given(st.integers(1, 3), st.data())
def test_each_finite_eigenvalue_makes_the_dynamic_stiffness_singular(size: int, data: st.DataObject) -> None:
    matrix = st.lists(NUMBERS, min_size=size**2, max_size=size**2).map(lambda x: np.reshape(x, (size, size)))
    mass = np.diag(data.draw(st.lists(st.sampled_from([0.0, 0.0, 1.0, 2.0]), min_size=size, max_size=size)))
    damping, stiffness = data.draw(matrix), data.draw(matrix)
    found = finite_spectrum(System(M=mass, C=damping, K=stiffness))
    if not found.outcome.ok:
        assert found.outcome in ("singular", "singular_pencil", "no_convergence")
        return
    assert len(found.eigenvalues) + found.infinite == 2 * size
    for value in found.eigenvalues:
        dynamic = value**2 * mass + value * damping + stiffness
        parts = abs(value) ** 2 * mass, abs(value) * np.abs(damping), np.abs(stiffness)
        largest = max(np.linalg.norm(part) for part in parts)
        # backward error; constraints of nearly parallel rows cost digits
        assert np.linalg.svd(dynamic, compute_uv=False)[-1] <= 1e-7 * largest


@pytest.mark.parametrize("ask", ["harmonic_balance", "hopf_point", "dangerous_push"])
def test_what_needs_a_mass_for_each_freedom_says_so(ask):
    """These have q and q' for their states; a row without mass ended them in "Singular matrix"."""
    from squealbox import limit_cycles
    from squealbox.files.own_brake import OwnBrake, OwnContact
    from squealbox.system import InvalidSystem

    pad = OwnContact(n=[0.0, 0.0], d=[1.0, 0.0])
    brake = OwnBrake(M=np.diag([1.0, 0.0]), C=np.diag([0.05, 0.3]), K=[[2.0, -1.0], [-1.0, 1.0]], normal_force=1.0,
                     friction=Coulomb(0.4, 0.25), contacts=(pad,))  # fmt: skip
    arguments = {"hopf_point": ("sliding_speed", (0.2, 0.3))}.get(ask, ())
    with pytest.raises(InvalidSystem, match=r"rows without mass.*shooting\(\)"):
        getattr(limit_cycles, ask)(brake, *arguments)


def test_a_slow_mode_beside_fast_ones_is_not_taken_for_rigid():
    """A damper that turns one motion's speed into the other's force: m^2 x^4 + m x^2 - 10 x - 1 = 0, with a root near
    -0.1 beside three of 2e4. Without the spring there is a body at rest, and a zero."""
    damping, stiffness = np.zeros((3, 3)), np.array([[0.0, 1.0, 0.0], [1.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
    damping[0, 1] = 10.0
    mass = np.diag([1e-6, 1e-6, 0.0])
    values = complex_modes(System(M=mass, C=damping, K=stiffness)).eigenvalues
    found = values[np.isfinite(values)]
    expected = np.roots([1e-12, 0.0, 1e-6, -10.0, -1.0])
    np.testing.assert_allclose(np.sort(found.real), np.sort(expected.real), rtol=1e-6)
    free = complex_modes(System(M=mass, C=damping, K=np.diag([0.0, 1.0, 1.0])))
    assert np.any(free.eigenvalues == 0.0)
