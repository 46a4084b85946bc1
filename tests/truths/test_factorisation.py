"""Sparse factors against LAPACK: solutions, inertia, determinant, and what is singular."""

import numpy as np
import pytest
from scipy import sparse

from squealbox.factorisation import SingularMatrix, factor

SIZE = 60


def random_matrix(kind: str, seed: int = 4):
    rng = np.random.default_rng(seed)
    matrix = sparse.random_array((SIZE, SIZE), density=0.1, rng=rng, data_sampler=rng.standard_normal)
    matrix = matrix + sparse.diags_array(rng.choice([-4.0, 4.0], SIZE))
    if "complex" in kind:
        matrix = matrix + 1j * sparse.random_array((SIZE, SIZE), density=0.1, rng=rng)
    return sparse.csc_array(matrix + matrix.T) if "symmetric" in kind else sparse.csc_array(matrix)


@pytest.fixture(params=["superlu", "rslab"])
def library(request):
    if request.param == "rslab":
        pytest.importorskip("rslab")
    return request.param


@pytest.mark.parametrize("kind", ["real", "complex", "real symmetric", "complex symmetric"])
def test_solutions_and_determinant(kind, library):
    matrix = random_matrix(kind)
    found = factor(matrix, library=library)
    assert found.symmetric == ("symmetric" in kind)
    right = np.random.default_rng(5).standard_normal((SIZE, 3)) + 1j
    dense = matrix.toarray()
    np.testing.assert_allclose(found.solve(right), np.linalg.solve(dense, right), rtol=1e-9, atol=1e-11)
    np.testing.assert_allclose(found.solve_many(right, block=2), np.linalg.solve(dense, right), rtol=1e-9, atol=1e-11)
    back = found.solve(right[:, 0], transposed=True)
    np.testing.assert_allclose(back, np.linalg.solve(dense.T, right[:, 0]), rtol=1e-9, atol=1e-11)
    sign, size = np.linalg.slogdet(dense)
    assert found.log_determinant.real == pytest.approx(size, rel=1e-10)
    assert np.exp(1j * found.log_determinant.imag) == pytest.approx(sign, abs=1e-9)


@pytest.mark.parametrize("seed", [1, 2, 3, 4])
def test_inertia_counts_the_signs_of_the_eigenvalues(seed, library):
    matrix = random_matrix("real symmetric", seed)
    values = np.linalg.eigvalsh(matrix.toarray())
    assert factor(matrix, library=library).inertia == (np.sum(values > 0.0), np.sum(values < 0.0), 0)


def test_inertia_wants_a_real_symmetric_matrix():
    with pytest.raises(ValueError, match="not real symmetric"):
        _ = factor(random_matrix("real")).inertia


def test_a_singular_matrix_is_refused(library):
    line = sparse.diags_array([-np.ones(9), np.r_[1.0, np.full(8, 2.0), 1.0], -np.ones(9)], offsets=[-1, 0, 1])
    with pytest.raises(SingularMatrix, match="singular"):
        factor(line, library=library)


@pytest.mark.parametrize(
    ("matrix", "words"), [(np.ones((2, 3)), "square"), ([[np.nan]], "not finite"), (np.eye(2), "library")]
)
def test_bad_input_is_named(matrix, words):
    with pytest.raises(ValueError, match=words):
        factor(matrix, library="mumps" if words == "library" else "auto")


def test_the_order_of_one_factor_serves_another_with_entries_in_its_places():
    pytest.importorskip("rslab")
    matrix = random_matrix("real symmetric")
    first = factor(matrix, True, library="rslab")
    less = sparse.csc_array(matrix + sparse.diags_array(np.full(SIZE, 0.5)))
    pair = next((i, j) for i, j in zip(*less.nonzero(), strict=True) if i < j)
    less = less.tolil()
    less[pair], less[pair[::-1]] = 0.0, 0.0
    less = sparse.csc_array(less)
    less.eliminate_zeros()
    right = np.random.default_rng(6).standard_normal(SIZE)
    second = factor(less, True, library="rslab", order=first.order)
    assert second.order is first.order
    np.testing.assert_allclose(second.solve(right), np.linalg.solve(less.toarray(), right), rtol=1e-9)
    elsewhere = sparse.csc_array(less + sparse.coo_array(([0.1, 0.1], ([0, 40], [40, 0])), shape=(SIZE, SIZE)))
    assert less[0, 40] == 0.0 == matrix[0, 40]
    third = factor(elsewhere, True, library="rslab", order=first.order)
    assert third.order is not first.order
    np.testing.assert_allclose(third.solve(right), np.linalg.solve(elsewhere.toarray(), right), rtol=1e-9)
