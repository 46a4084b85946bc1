"""Compiled spectra beside LAPACK's, on ordinary and on awkward matrices.

Both roads are backward stable: each gives the exact eigenvalues of a matrix within some n eps |A| of the given one
(after balancing). An eigenvalue of condition k may then differ by k n eps |A|, and one in a Jordan block of size m by
(n eps)^(1/m) |A|. These are the tolerances here, with the constants beside them.
"""

from typing import Any

import numpy as np
import pytest
from scipy.optimize import linear_sum_assignment

from squealbox.compiled.sixteen import room
from squealbox.stability import compiled_eigenvalues, spectra
from squealbox.stability.spectra import parts_of, spectra_kernels

EPS = np.finfo(float).eps


def gap(ours: Any, theirs: Any) -> Any:
    """Largest difference of each pair of spectra, paired at best, relative to the largest eigenvalue."""
    worst = []
    for one, other in zip(ours, theirs, strict=True):
        distance = np.abs(one[:, None] - other[None, :])
        worst.append(np.max(distance[linear_sum_assignment(distance)]) / np.max(np.abs(other)))
    return np.array(worst)


def kernel_alone(matrices: Any) -> Any:
    """What the kernel answers itself, NaN where it leaves the matrix to LAPACK."""
    values, n = np.empty(matrices.shape[:2], dtype=complex), matrices.shape[-1]
    rooms = room(n * n), room(n), room(n), room(n)
    spectra_kernels().spectra(np.require(matrices, float, ["C", "W"]), parts_of(values), *rooms)
    return values


def conditions(matrices: Any) -> Any:
    """The largest condition number of an eigenvalue of each matrix, by its eigenvectors."""
    _, right = np.linalg.eig(matrices)
    return np.max(np.linalg.norm(np.linalg.inv(right), axis=-1) * np.linalg.norm(right, axis=-2), axis=-1)


@pytest.mark.parametrize("size", [2, 3, 4, 5, 6, 12, 23])
def test_ordinary_matrices(size: int) -> None:
    matrices = np.random.default_rng(size).normal(size=(331, size, size))  # no multiple of sixteen
    plain, fast = np.linalg.eigvals(matrices), compiled_eigenvalues(matrices)
    allowed = 30.0 * size * EPS * conditions(matrices)
    assert np.all(gap(fast, plain) < allowed)
    assert np.all(gap(compiled_eigenvalues((1.0 + 1e-6) * matrices), plain) > 1e-8)
    assert np.allclose(np.sum(fast, axis=-1), np.trace(matrices, axis1=1, axis2=2), atol=1e-12)
    assert np.array_equal(fast, kernel_alone(matrices))  # none was left to LAPACK


def families(size: int) -> dict[str, Any]:
    """Awkward matrices, and the block size of each one's worst eigenvalue."""
    rng = np.random.default_rng(size)
    plain = rng.normal(size=(48, size, size))
    turn = np.linalg.qr(rng.normal(size=(48, size, size)))[0]
    back = np.swapaxes(turn, -1, -2)
    jordan = 2.0 * np.eye(size) + np.diag(np.ones(size - 1), 1)
    repeated = np.diag(np.where(np.arange(size) < 2, 1.0, 2.0))
    powers = 10.0 ** rng.uniform(-8.0, 8.0, size=(48, size))
    steps = 10.0 ** (-2.0 * np.arange(size))
    shifted = np.broadcast_to(np.eye(size)[:-1], (48, size - 1, size))
    return {
        "unbalanced": (plain * powers[:, :, None] / powers[:, None, :], 1),
        "graded": (plain * steps[:, None] * steps[None, :], 1),
        "repeated": (turn @ repeated @ back, 1),
        "defective": (turn @ jordan @ back, size),
        "symmetric": (plain + np.swapaxes(plain, -1, -2), 1),
        "skew": (plain - np.swapaxes(plain, -1, -2), 1),
        "orthogonal": (turn, 1),
        "rank one": (plain[:, :, :1] * plain[:, :1, :], 2),
        "companion": (np.concatenate([plain[:, :1], shifted], axis=1), 1),
        "permutation": (np.broadcast_to(np.roll(np.eye(size), 1, axis=0), (48, size, size)), 1),
        "small": (1e-200 * plain, 1),
        "large": (1e200 * plain, 1),
    }


@pytest.mark.parametrize("size", [4, 12])
def test_awkward_matrices_are_answered_by_the_kernel(size: int) -> None:
    for name, (matrices, block) in families(size).items():
        fast = kernel_alone(matrices)
        assert not np.any(np.isnan(fast)), name
        # unbalanced and graded matrices are well conditioned once balanced, which both roads do
        allowed = (1e3 * size * EPS) ** (1.0 / block)
        assert np.max(gap(fast, np.linalg.eigvals(matrices))) < allowed, name
        assert np.max(gap(fast, np.linalg.eigvals(1.1 * matrices))) > min(0.05, allowed), name


@pytest.mark.parametrize("size", [4, 12])
def test_balancing_keeps_the_small_eigenvalues_of_a_scaled_matrix(size: int) -> None:
    rng = np.random.default_rng(7)
    values = 10.0 ** np.linspace(-6.0, 6.0, size)
    mixed = np.eye(size) + 0.1 * rng.normal(size=(32, size, size))
    scaled = np.sqrt(values)[:, None] * (mixed @ np.swapaxes(mixed, -1, -2)) * np.sqrt(values)
    fast, plain = (np.sort(np.real(found(scaled))) for found in (kernel_alone, np.linalg.eigvals))
    # QR is accurate to eps of the largest eigenvalue only
    assert np.max(np.abs(fast - plain)) < 100.0 * size * EPS * np.max(plain)
    similar = scaled * (values[:, None] / values[None, :])  # D A D^-1 has the same eigenvalues
    assert np.max(np.abs(np.sort(np.real(kernel_alone(similar))) - plain)) < 100.0 * size * EPS * np.max(plain)


def test_neighbours_do_not_change_an_answer() -> None:
    rng = np.random.default_rng(3)
    matrices = rng.normal(size=(16, 6, 6))
    alone = np.concatenate([compiled_eigenvalues(one[None]) for one in matrices])
    hard = np.concatenate([matrices, 1e-150 * families(6)["defective"][0]])
    assert np.array_equal(alone, compiled_eigenvalues(matrices))
    assert np.array_equal(alone, compiled_eigenvalues(hard[::-1])[::-1][:16])


def test_what_the_kernel_leaves_is_answered_by_lapack(monkeypatch: pytest.MonkeyPatch) -> None:
    awkward = np.zeros((9, 4, 4))
    awkward[1] = np.eye(4)
    awkward[2] = np.diag([1.0, 1.0, 1.0], -1)  # one Jordan block, whose zeros LAPACK finds exactly by permutation
    awkward[3] = np.diag([1e-8, 1.0, 1e8, 0.0])
    awkward[4, 2, 1] = np.nan
    awkward[5, 0, 3] = np.inf
    awkward[6] = 1e305 * np.random.default_rng(1).normal(size=(4, 4))
    awkward[7] = 1e-300 * np.random.default_rng(2).normal(size=(4, 4))
    awkward[8] = np.random.default_rng(3).normal(size=(4, 4))
    assert np.all(np.isnan(kernel_alone(awkward)[:8]))
    handed: list[int] = []
    by_lapack = spectra.by_lapack
    monkeypatch.setattr(spectra, "by_lapack", lambda left: (handed.append(len(left)), by_lapack(left))[1])
    found = compiled_eigenvalues(awkward)
    assert handed == [8]
    assert np.all(found[[0, 2]] == 0.0)
    assert np.all(found[1] == 1.0)
    assert np.array_equal(np.sort(found[3].real), [0.0, 1e-8, 1.0, 1e8])
    assert np.all(np.isnan(found[4:6]))
    for i in (6, 7, 8):
        assert gap(found[i : i + 1], np.linalg.eigvals(awkward[i : i + 1]))[0] < 1e-14


def test_a_matrix_on_which_lapack_fails_has_nan(monkeypatch: pytest.MonkeyPatch) -> None:
    real = np.linalg.eigvals

    def failing(matrices: Any) -> Any:
        if np.any(matrices == 7.0):
            raise np.linalg.LinAlgError("Eigenvalues did not converge")
        return real(matrices)

    monkeypatch.setattr(np.linalg, "eigvals", failing)
    found = compiled_eigenvalues(np.array([np.diag([1.0, 2.0]), np.diag([7.0, 2.0]), np.diag([3.0, 4.0])]))
    assert np.array_equal(found[[0, 2]], [[1.0, 2.0], [3.0, 4.0]])
    assert np.all(np.isnan(found[1]))


@pytest.mark.parametrize("size", [1, 2, 5])
def test_shapes_and_kinds(size: int) -> None:
    matrices = np.random.default_rng(1).normal(size=(3, 2, size, size))
    found = compiled_eigenvalues(matrices)
    assert found.shape == (3, 2, size)
    assert np.array_equal(found[1, 1], compiled_eigenvalues(matrices[1, 1]))
    assert compiled_eigenvalues(np.empty((0, size, size))).shape == (0, size)
    assert compiled_eigenvalues(np.empty((4, 0, 0))).shape == (4, 0)
    assert np.max(np.abs(np.sort(compiled_eigenvalues(np.array([[2, 1], [1, 2]])).real) - [1.0, 3.0])) < 1e-15


@pytest.mark.parametrize("wrong", [np.zeros(3), np.zeros((2, 3)), np.zeros((2, 2), dtype=complex)])
def test_what_is_no_real_square_matrix_is_refused(wrong: Any) -> None:
    with pytest.raises(ValueError, match=r"expected real \(\.\.\., n, n\)"):
        compiled_eigenvalues(wrong)
