"""Whatever the matrices, complex modes give a right answer or a named outcome."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from squealbox.stability import complex_modes, mode_energy
from squealbox.system import InvalidSystem, System

NUMBERS = st.floats(-1e3, 1e3).map(lambda x: 0.0 if abs(x) < 1e-3 else x)  # zeros often, denormals never
SIZES = st.integers(1, 4)


@st.composite
def systems(draw: st.DrawFn) -> System:
    size = draw(SIZES)
    mass = np.diag(draw(arrays(float, size, elements=st.sampled_from([0.0, 1e-6, 1.0, 1.0, 2.0, 1e6]))))
    matrices = [draw(arrays(float, (size, size), elements=NUMBERS)) for _ in range(2)]
    if draw(st.booleans()):  # repeated and defective eigenvalues on purpose
        matrices = [np.triu(np.full((size, size), draw(NUMBERS))), np.triu(np.full((size, size), draw(NUMBERS)))]
    return System(M=mass, C=matrices[0], K=matrices[1])


@settings(deadline=None, max_examples=200)
@given(systems())
def test_every_eigenvalue_makes_the_dynamic_stiffness_singular_or_the_outcome_is_named(system: System) -> None:
    modes = complex_modes(system)
    if not modes.outcome.ok:
        assert modes.outcome in ("singular", "singular_pencil", "not_finite", "no_convergence")
        assert np.all(np.isnan(modes.eigenvalues))
        assert not modes.exists
        assert not modes.stable
        return
    values = modes.eigenvalues
    size = system.size
    finite = values[np.isfinite(values)]  # NaN stands for one at infinity, of a freedom without mass
    inertia = np.abs(np.diag(system.M))
    assert len(finite) == 2 * size or np.any(inertia == 0.0)
    assert len(finite) <= 2 * np.sum(inertia > 0.0) + np.sum(inertia == 0.0)
    scale = np.max(np.abs(finite), initial=0.0)
    mirrored = np.allclose(np.conj(values[:size]), values[size:], equal_nan=True)
    assert mirrored or np.any(finite.imag == 0.0)
    assert np.all(values[:size][np.isfinite(values[:size])].imag >= 0.0)
    for value in finite:
        dynamic = value**2 * system.M + value * system.C + system.K
        parts = abs(value) ** 2 * system.M, abs(value) * np.abs(system.C), np.abs(system.K)
        size_of_parts = max(np.linalg.norm(part) for part in parts)
        least = np.linalg.svd(dynamic, compute_uv=False)[-1]
        # backward error: of the linearised problem, whose norm may exceed that of the parts by the span of M
        span = np.max(inertia) / np.min(inertia[inertia > 0.0], initial=np.inf) if np.any(inertia) else 1.0
        assert least <= 1e-9 * max(size_of_parts, scale**2 * np.max(np.abs(system.M)) / span) * max(1.0, span * 1e-6)


@settings(deadline=None, max_examples=100)
@given(systems())
def test_energy_adds_up_wherever_it_is_positive(system: System) -> None:
    modes = complex_modes(system)
    if not modes.outcome.ok or not np.any(np.abs(modes.eigenvalues.imag) > 0.0):
        return
    if abs(modes.most_unstable.eigenvalue.imag) < 1e-3:
        return
    if modes.condition[modes.most_unstable.index] > 1e4 or np.linalg.cond(system.M) > 1e3:
        return
    energy = mode_energy(system)
    turned_over = np.sum(np.abs(energy.kinetic)) + np.sum(np.abs(energy.strain))
    if abs(energy.total) > 1e-3 * turned_over:
        assert energy.residual < 1e-8  # 1e-10 for well-conditioned modes, times what cancels in the energy


@pytest.mark.parametrize("entry", [np.nan, np.inf])
def test_numbers_that_are_not_finite_are_refused_by_name(entry: float) -> None:
    with pytest.raises(InvalidSystem, match="K holds a value that is not finite"):
        System(M=[[1.0]], C=[[0.0]], K=[[entry]])


def test_overflow_is_a_named_outcome() -> None:
    modes = complex_modes(System(M=[[1e-300]], C=[[0.0]], K=[[1e300]]))
    assert modes.outcome == "not_finite"
    assert not modes.exists


def test_zero_mass_has_its_first_order_mode_and_spares_its_neighbours() -> None:
    """0.1 q' + q = 0: lambda = -10; the other eigenvalue is at infinity."""
    modes = complex_modes(System(M=[[[0.0]], [[1.0]]], C=[[0.1]], K=[[1.0]]))
    assert modes.outcome.ok
    assert modes.eigenvalues[0, 0] == pytest.approx(-10.0, rel=1e-14)
    assert np.isnan(modes.eigenvalues[0, 1])
    assert np.all(np.isfinite(modes.eigenvalues[1]))
    assert list(modes.stable) == [True, True]


def test_a_force_through_a_row_without_mass_is_faster_than_any_spring() -> None:
    """det = L^2 (m^2 L^2 + m + 500), L = lambda: a pair at 22 million rad/s, M and K alone make 1000 rad/s expected."""
    m = 1e-6
    damping, stiffness = np.zeros((3, 3)), np.diag([0.0, 1.0, 1.0])
    damping[0, 1], damping[2, 0], stiffness[1, 2] = 250.0, 2.0, 1.0
    values = complex_modes(System(M=np.diag([m, m, 0.0]), C=damping, K=stiffness)).eigenvalues
    fast = np.sqrt(m + 500.0) / m
    found = np.sort(values[np.isfinite(values)].imag)
    assert found == pytest.approx(np.array([-fast, 0.0, 0.0, fast]), rel=1e-12)
    assert np.nanmax(np.abs(values.real)) < 1e-12 * fast


def test_a_defective_pair_is_right_and_marked() -> None:
    modes = complex_modes(System(M=np.eye(2), C=np.zeros((2, 2)), K=[[2.0, 0.0], [1.0, 2.0]]))
    assert modes.outcome.ok
    assert np.abs(modes.eigenvalues[0] - 1j * np.sqrt(2.0)) < 1e-7  # a double root carries the root of round-off
    assert np.all(modes.near_defective)


def test_repeated_but_not_defective_modes_stay_bi_orthogonal() -> None:
    modes = complex_modes(System(M=np.eye(3), C=0.1 * np.eye(3), K=np.diag([4.0, 4.0, 9.0])))
    values, u, w = modes.eigenvalues, modes.right, modes.left
    product = np.conj(w).T @ (0.1 * np.eye(3)) @ u
    product += (values[:, None] + values[None, :]) * (np.conj(w).T @ u)
    assert np.allclose(product, np.eye(6), atol=1e-10)
    assert not np.any(modes.near_defective)
